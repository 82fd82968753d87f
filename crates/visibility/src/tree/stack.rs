//! What is still to visit.

#![allow(clippy::inline_always, reason = "what is not inlined is compiled for the narrowest vectors")]

/// Entries kept on the machine's stack. A tree of a hundred thousand facets is about six levels
/// deep, and a level leaves seven entries at most.
const ENTRIES_INLINE: usize = 48;

/// A stack that only allocates for trees of unusual depth.
#[derive(Debug)]
pub(crate) struct Stack<T> {
    inline: [T; ENTRIES_INLINE],
    len: usize,
    spill: Vec<T>,
}

impl<T: Copy + Default> Default for Stack<T> {
    #[inline(always)]
    fn default() -> Self {
        Self { inline: [T::default(); ENTRIES_INLINE], len: 0, spill: Vec::new() }
    }
}

impl<T: Copy> Stack<T> {
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub(crate) fn push(&mut self, entry: T) {
        if let Some(slot) = self.inline.get_mut(self.len) {
            *slot = entry;
            self.len += 1;
        } else {
            self.spill.push(entry);
        }
    }

    #[inline(always)]
    pub(crate) fn pop(&mut self) -> Option<T> {
        if self.len == ENTRIES_INLINE
            && let Some(entry) = self.spill.pop()
        {
            return Some(entry);
        }
        self.len = self.len.checked_sub(1)?;
        self.inline.get(self.len).copied()
    }

    /// Sorts the entries from a place on, the least last; those that did not find room stay as they
    /// are.
    #[inline(always)]
    pub(crate) fn sort_from(&mut self, base: usize, less: impl Fn(&T, &T) -> bool) {
        let entries = &mut self.inline[..self.len];
        for i in base + 1..entries.len() {
            let mut k = i;
            while k > base && less(&entries[k - 1], &entries[k]) {
                entries.swap(k - 1, k);
                k -= 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_in_first_out_past_the_inline_part() {
        let mut stack = Stack::default();
        for round in 0..3 {
            (0..100).for_each(|i| stack.push(i + round));
            assert!((0..100).rev().all(|i| stack.pop() == Some(i + round)));
            assert_eq!(stack.pop(), None);
        }
    }

    #[test]
    fn the_least_of_the_last_entries_comes_first() {
        let mut stack = Stack::default();
        for i in [9, 1, 5, 3, 7, 4] {
            stack.push(i);
        }
        stack.sort_from(2, |a, b| a < b);
        let popped: Vec<i32> = std::iter::from_fn(|| stack.pop()).collect();
        assert_eq!(popped, [3, 4, 5, 7, 1, 9]);
    }
}

//! The nodes still to visit.

/// Entries kept on the machine's stack. A tree of a hundred thousand facets is about ten levels deep, and a level
/// leaves three entries at most.
const INLINE: usize = 40;

/// A stack of node indices that only allocates for trees of unusual depth.
#[derive(Debug)]
pub(crate) struct Stack {
    inline: [u32; INLINE],
    len: usize,
    spill: Vec<u32>,
}

impl Default for Stack {
    fn default() -> Self {
        Self { inline: [0; INLINE], len: 0, spill: Vec::new() }
    }
}

impl Stack {
    #[inline]
    pub(crate) fn push(&mut self, node: u32) {
        if let Some(slot) = self.inline.get_mut(self.len) {
            *slot = node;
            self.len += 1;
        } else {
            self.spill.push(node);
        }
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<u32> {
        if self.len == INLINE
            && let Some(node) = self.spill.pop()
        {
            return Some(node);
        }
        self.len = self.len.checked_sub(1)?;
        self.inline.get(self.len).copied()
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
}

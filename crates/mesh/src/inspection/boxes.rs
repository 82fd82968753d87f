//! Which boxes meet: a tree of boxes, halved at the middle box along the longest side of the
//! centres.

use crate::{Bounds, Vec3};

/// Boxes of a leaf, at most.
const BOXES_OF_A_LEAF: usize = 4;

/// A tree over boxes.
pub(super) struct Boxes {
    all: Vec<Bounds>,
    order: Vec<u32>,
    nodes: Vec<Node>,
}

struct Node {
    bounds: Bounds,
    /// First and last places in the order.
    range: [u32; 2],
    /// The second child; the first one follows its parent. 0 for a leaf.
    second: u32,
}

impl Boxes {
    pub fn new(boxes: Vec<Bounds>) -> Self {
        let order = (0..boxes.len() as u32).collect();
        let mut tree = Self { all: boxes, order, nodes: Vec::new() };
        if !tree.all.is_empty() {
            tree.grow(0, tree.all.len());
        }
        tree
    }

    fn grow(&mut self, start: usize, end: usize) {
        let node = self.nodes.len();
        let bounds = self.around(start, end);
        self.nodes.push(Node { bounds, range: [start as u32, end as u32], second: 0 });
        if end - start <= BOXES_OF_A_LEAF {
            return;
        }
        let middles = Bounds::around(self.order[start..end].iter().map(|&k| self.all[k as usize].centre()));
        let size = middles.map_or(Vec3::ZERO, |middles| middles.max - middles.min);
        let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
        let half = usize::midpoint(start, end);
        let place = |k: &u32| self.all[*k as usize].centre()[axis];
        self.order[start..end]
            .select_nth_unstable_by(half - start, |a, b| place(a).total_cmp(&place(b)).then(a.cmp(b)));
        self.grow(start, half);
        self.nodes[node].second = self.nodes.len() as u32;
        self.grow(half, end);
    }

    fn around(&self, start: usize, end: usize) -> Bounds {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &k in &self.order[start..end] {
            min = min.min(self.all[k as usize].min);
            max = max.max(self.all[k as usize].max);
        }
        Bounds { min, max }
    }

    /// Numbers of the boxes that come within `margin` of another, by rising number.
    pub fn near(&self, other: &Bounds, margin: f64) -> Vec<u32> {
        let meets =
            |b: &Bounds| b.min.cmple(other.max + margin).all() && other.min.cmple(b.max + margin).all();
        let (mut found, mut stack) = (Vec::new(), Vec::new());
        if !self.nodes.is_empty() {
            stack.push(0);
        }
        while let Some(index) = stack.pop() {
            let node = &self.nodes[index];
            if !meets(&node.bounds) {
                continue;
            }
            if node.second > 0 {
                stack.extend([index + 1, node.second as usize]);
                continue;
            }
            let [start, end] = node.range.map(|place| place as usize);
            found.extend(self.order[start..end].iter().filter(|&&k| meets(&self.all[k as usize])));
        }
        found.sort_unstable();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_finds_what_a_comparison_of_all_finds() {
        let number = |k: usize, prime: usize| ((k * prime) % 97) as f64 / 97.0;
        let boxes: Vec<Bounds> = (0..200)
            .map(|k| {
                let min = Vec3::new(number(k, 13), number(k, 29), number(k, 53));
                Bounds { min, max: min + 0.1 * number(k, 7) }
            })
            .collect();
        let tree = Boxes::new(boxes.clone());
        for own in &boxes {
            let meets =
                |b: &Bounds| (0..3).all(|a| b.min[a] <= own.max[a] + 0.01 && own.min[a] <= b.max[a] + 0.01);
            let all: Vec<u32> = (0..200).filter(|&k| meets(&boxes[k as usize])).collect();
            assert_eq!(tree.near(own, 0.01), all);
        }
        assert!(Boxes::new(vec![]).near(&boxes[0], 1.0).is_empty());
    }
}

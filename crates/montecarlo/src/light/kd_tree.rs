//! A kd-tree of points: which lie within a distance of a place (J. L. Bentley, Commun. ACM 18
//! (1975) 509, doi:10.1145/361002.361007).
//!
//! The middle of a range of the array is the node, by the axis along which the range is widest;
//! what is below stands before it.

use fredholm_mesh::Vec3;

/// Ranges up to this many points are searched one by one.
const POINTS_OF_A_LEAF: usize = 8;

/// Points with their numbers, in the order of the tree.
#[derive(Clone, Debug, Default)]
pub(crate) struct KdTree {
    points: Vec<(Vec3, u32)>,
    axes: Vec<u8>,
}

impl KdTree {
    pub(crate) fn new(points: impl IntoIterator<Item = Vec3>) -> Self {
        let mut points: Vec<(Vec3, u32)> = points.into_iter().zip(0..).collect();
        let mut axes = vec![0; points.len()];
        build(&mut points, &mut axes);
        Self { points, axes }
    }

    /// Calls `found` with the number of each point within `radius` of `centre`, always in the same
    /// order.
    pub(crate) fn within(&self, centre: Vec3, radius: f64, found: &mut dyn FnMut(u32)) {
        self.search(0, self.points.len(), centre, radius, found);
    }

    fn search(&self, from: usize, to: usize, centre: Vec3, radius: f64, found: &mut dyn FnMut(u32)) {
        if to - from <= POINTS_OF_A_LEAF {
            for (point, number) in &self.points[from..to] {
                if point.distance_squared(centre) <= radius * radius {
                    found(*number);
                }
            }
            return;
        }
        let middle = usize::midpoint(from, to);
        let (point, number) = self.points[middle];
        let axis = usize::from(self.axes[middle]);
        let offset = centre[axis] - point[axis];
        if offset <= radius {
            self.search(from, middle, centre, radius, found);
        }
        if point.distance_squared(centre) <= radius * radius {
            found(number);
        }
        if offset >= -radius {
            self.search(middle + 1, to, centre, radius, found);
        }
    }
}

fn build(points: &mut [(Vec3, u32)], axes: &mut [u8]) {
    if points.len() <= POINTS_OF_A_LEAF {
        return;
    }
    let (low, high) = points
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (p, _)| (low.min(*p), high.max(*p)));
    let size = high - low;
    let axis = if size.x >= size.y.max(size.z) {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let middle = points.len() / 2;
    // Numbers break ties, so that the tree is one of the points alone.
    points.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    axes[middle] = axis as u8;
    let (below, rest) = points.split_at_mut(middle);
    let (axes_below, axes_rest) = axes.split_at_mut(middle);
    build(below, axes_below);
    build(&mut rest[1..], &mut axes_rest[1..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::philox::{philox, unit_pair};

    #[test]
    fn it_finds_what_a_search_of_all_finds() {
        let point = |i: u32| {
            let ([x, y], [z, _]) =
                (unit_pair(philox([i, 0, 0, 0], [1, 1])), unit_pair(philox([i, 1, 0, 0], [1, 1])));
            Vec3::new(x, y, 0.2 * z)
        };
        for n in [0, 1, 9, 500] {
            let points: Vec<Vec3> = (0..n).map(point).collect();
            let tree = KdTree::new(points.iter().copied());
            for (query, radius) in (1000..1040).map(point).zip([0.01, 0.1, 0.3, 2.0].into_iter().cycle()) {
                let mut found = Vec::new();
                tree.within(query, radius, &mut |number| found.push(number));
                found.sort_unstable();
                let near = |i: &u32| points[*i as usize].distance(query) <= radius;
                assert_eq!(found, (0..n).filter(near).collect::<Vec<_>>());
            }
        }
    }
}

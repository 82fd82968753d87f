//! The tree of clusters: boxes of places, halved at the median of their longest side.

use fredholm_mesh::Vec3;
use std::ops::Range;

/// A cluster: a range of the order, its box and its halves.
#[derive(Clone, Debug)]
pub(crate) struct Cluster {
    pub(crate) range: Range<usize>,
    low: Vec3,
    high: Vec3,
    /// The first of two neighbours in the tree.
    pub(crate) halves: Option<usize>,
}

/// The clusters of some places; the first holds all.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) clusters: Vec<Cluster>,
    /// Groups in the order of the clusters.
    pub(crate) order: Vec<usize>,
}

impl Tree {
    /// Halves clusters of more than `largest` groups.
    pub(crate) fn new(places: &[Vec3], largest: usize) -> Self {
        let mut order: Vec<usize> = (0..places.len()).collect();
        let mut clusters = vec![Cluster::around(places, &order, 0..places.len())];
        let mut at = 0;
        while at < clusters.len() {
            let range = clusters[at].range.clone();
            if range.len() > largest {
                let side = clusters[at].high - clusters[at].low;
                let axis = if side.x >= side.y.max(side.z) { 0 } else { 1 + usize::from(side.z > side.y) };
                order[range.clone()]
                    .sort_by(|&a, &b| places[a][axis].total_cmp(&places[b][axis]).then(a.cmp(&b)));
                let middle = range.start.midpoint(range.end);
                clusters[at].halves = Some(clusters.len());
                for half in [range.start..middle, middle..range.end] {
                    clusters.push(Cluster::around(places, &order, half));
                }
            }
            at += 1;
        }
        Self { clusters, order }
    }

    /// The groups of a cluster.
    pub(crate) fn groups(&self, cluster: usize) -> &[usize] {
        &self.order[self.clusters[cluster].range.clone()]
    }

    /// Clusters that are not halved.
    pub(crate) fn leaves(&self) -> Vec<usize> {
        (0..self.clusters.len()).filter(|&at| self.clusters[at].halves.is_none()).collect()
    }

    /// The pairs (row, column) of clusters that cover the matrix, or its lower half, and whether
    /// each is far: the smaller box is no larger than `eta` times the distance.
    pub(crate) fn pairs(&self, eta: f64, lower: bool) -> Vec<(usize, usize, bool)> {
        let (mut pairs, mut waiting) = (Vec::new(), vec![(0, 0)]);
        while let Some((row, column)) = waiting.pop() {
            let [a, b] = [row, column].map(|at| &self.clusters[at]);
            if lower && row != column && a.range.end <= b.range.start {
                continue;
            }
            if row != column && a.size().min(b.size()) <= eta * a.distance(b) {
                pairs.push((row, column, true));
                continue;
            }
            let parts = |cluster: &Cluster, at: usize| {
                cluster.halves.map_or(vec![at], |first| vec![first, first + 1])
            };
            if a.halves.is_none() && b.halves.is_none() {
                pairs.push((row, column, false));
                continue;
            }
            let columns = parts(b, column);
            waiting.extend(parts(a, row).into_iter().flat_map(|row| columns.iter().map(move |&c| (row, c))));
        }
        pairs.sort_unstable_by_key(|&(row, column, _)| {
            (self.clusters[row].range.start, self.clusters[column].range.start)
        });
        pairs
    }
}

impl Cluster {
    fn around(places: &[Vec3], order: &[usize], range: Range<usize>) -> Self {
        let inside = || order[range.clone()].iter().map(|&group| places[group]);
        let low = inside().reduce(Vec3::min).unwrap_or_default();
        let high = inside().reduce(Vec3::max).unwrap_or_default();
        Self { range, low, high, halves: None }
    }

    fn size(&self) -> f64 {
        self.high.distance(self.low)
    }

    fn distance(&self, other: &Self) -> f64 {
        (self.low - other.high).max(other.low - self.high).max(Vec3::ZERO).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_cover_every_entry_once() {
        let places: Vec<Vec3> =
            (0..300).map(|i| Vec3::new(f64::from(i % 17), f64::from(i % 23), f64::from(i) * 0.1)).collect();
        let tree = Tree::new(&places, 8);
        assert!(tree.leaves().iter().all(|&leaf| (4..=8).contains(&tree.groups(leaf).len())));
        let mut count = vec![0; 300 * 300];
        for (row, column, _) in tree.pairs(1.0, false) {
            for &i in tree.groups(row) {
                tree.groups(column).iter().for_each(|&j| count[300 * i + j] += 1);
            }
        }
        assert!(count.iter().all(|&n| n == 1));
        // The lower half in the order of the tree, with all of the blocks on the diagonal.
        let lower: usize =
            tree.pairs(1.0, true).iter().map(|p| tree.groups(p.0).len() * tree.groups(p.1).len()).sum();
        let diagonal: usize = tree.leaves().iter().map(|&leaf| tree.groups(leaf).len().pow(2)).sum();
        assert_eq!(2 * lower, 300 * 300 + diagonal);
        assert!(tree.pairs(1.0, false).iter().any(|pair| pair.2));
    }
}

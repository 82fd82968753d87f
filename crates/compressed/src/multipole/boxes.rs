//! The tree of boxes: cubes of one size a level, those of the next level of twice the side.

use fredholm_mesh::Vec3;
use std::collections::BTreeMap;
use std::ops::Range;

/// A box.
#[derive(Clone, Debug)]
pub(crate) struct Cube {
    pub(crate) cell: [u32; 3],
    /// Of a ball around its middle that holds all supports of its groups, m.
    pub(crate) radius: f64,
    /// Boxes of the finer level; groups in the order of the tree at the finest.
    pub(crate) parts: Range<usize>,
}

/// The boxes of one size.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    /// m.
    pub(crate) side: f64,
    pub(crate) cubes: Vec<Cube>,
}

/// All boxes with something in, the finest level first; the last has one box.
#[derive(Clone, Debug)]
pub(crate) struct Octree {
    origin: Vec3,
    pub(crate) levels: Vec<Level>,
    /// Groups in the order of the boxes.
    pub(crate) order: Vec<usize>,
}

/// The bits of three coordinates, interleaved.
fn code(cell: [u32; 3]) -> u64 {
    (0..21).fold(0, |code, bit| {
        (0..3).fold(code, |code, axis| code | (u64::from(cell[axis] >> bit & 1) << (3 * bit + axis)))
    })
}

impl Octree {
    /// Boxes of a given side, m, around the middle of the places, which are finite. `radii` are
    /// those of the supports around the places.
    pub(crate) fn new(places: &[Vec3], radii: &[f64], side: f64) -> Self {
        let low = places.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = places.iter().copied().reduce(Vec3::max).unwrap_or_default();
        // A sheet lies in the middle of its boxes, and not between two layers of them.
        let counts = ((high - low) / side).to_array().map(|count| (count + 1e-9).ceil().max(1.0));
        let origin = 0.5 * (low + high) - 0.5 * side * Vec3::from_array(counts);
        let cell = |place: Vec3| {
            let at = ((place - origin) / side).to_array();
            std::array::from_fn(|axis| at[axis].clamp(0.0, counts[axis] - 1.0) as u32)
        };
        let mut order: Vec<usize> = (0..places.len()).collect();
        let cells: Vec<[u32; 3]> = places.iter().map(|&place| cell(place)).collect();
        let codes: Vec<u64> = cells.iter().map(|&cell| code(cell)).collect();
        order.sort_by_key(|&group| (codes[group], group));
        let mut tree = Self { origin, levels: Vec::new(), order };
        let mut parts: Vec<[u32; 3]> = tree.order.iter().map(|&group| cells[group]).collect();
        loop {
            let level = tree.levels.len();
            let mut cubes: Vec<Cube> = Vec::new();
            for (at, &cell) in parts.iter().enumerate() {
                match cubes.last_mut() {
                    Some(last) if last.cell == cell => last.parts.end = at + 1,
                    _ => cubes.push(Cube { cell, radius: 0.0, parts: at..at + 1 }),
                }
            }
            parts = cubes.iter().map(|cube| cube.cell.map(|c| c / 2)).collect();
            let done = cubes.len() <= 1;
            tree.levels.push(Level { side: side * f64::from(1_u32 << level), cubes });
            for at in 0..tree.levels[level].cubes.len() {
                let centre = tree.centre(level, at);
                let reach = |&group: &usize| places[group].distance(centre) + radii[group];
                let radius = tree.order[tree.groups(level, at)].iter().map(reach).fold(0.0, f64::max);
                tree.levels[level].cubes[at].radius = radius;
            }
            if done {
                return tree;
            }
        }
    }

    /// The middle of a box, m.
    pub(crate) fn centre(&self, level: usize, at: usize) -> Vec3 {
        let Level { side, cubes } = &self.levels[level];
        let cell = cubes[at].cell.map(|c| f64::from(c) + 0.5);
        self.origin + Vec3::from_array(cell) * *side
    }

    /// The groups of a box, in the order of the tree.
    pub(crate) fn groups(&self, level: usize, at: usize) -> Range<usize> {
        let (mut first, mut last) = (at, at);
        for level in (1..=level).rev() {
            let cubes = &self.levels[level].cubes;
            (first, last) = (cubes[first].parts.start, cubes[last].parts.end - 1);
        }
        let cubes = &self.levels[0].cubes;
        cubes[first].parts.start..cubes[last].parts.end
    }

    /// For every box of every level those that are far from it although their parents are not, and
    /// for every box of the finest level those that are near. `reaches` gives, for a level and the
    /// square of an offset in boxes, the largest sum of two radii that is far, m.
    pub(crate) fn pairs(&self, reaches: impl Fn(usize, u32) -> f64) -> (Vec<Far>, Vec<Vec<usize>>) {
        let mut near = vec![Vec::new(); self.levels[0].cubes.len()];
        let mut far: Vec<Far> =
            self.levels.iter().map(|level| Far { sources: vec![Vec::new(); level.cubes.len()] }).collect();
        let mut known: BTreeMap<(usize, u32), f64> = BTreeMap::new();
        let mut waiting = vec![(0, 0)];
        for level in (0..self.levels.len()).rev() {
            let cubes = &self.levels[level].cubes;
            let mut next = Vec::new();
            for (target, source) in waiting {
                let [a, b] = [&cubes[target], &cubes[source]];
                let square = (0..3).map(|axis| a.cell[axis].abs_diff(b.cell[axis]).pow(2)).sum();
                let reach = *known.entry((level, square)).or_insert_with(|| reaches(level, square));
                if a.radius + b.radius <= reach {
                    far[level].sources[target].push(source);
                } else if level == 0 {
                    near[target].push(source);
                } else {
                    let sources = b.parts.clone();
                    next.extend(a.parts.clone().flat_map(|a| sources.clone().map(move |b| (a, b))));
                }
            }
            waiting = next;
        }
        far.iter_mut()
            .flat_map(|far| &mut far.sources)
            .chain(&mut near)
            .for_each(|list| list.sort_unstable());
        (far, near)
    }
}

/// The far boxes of every box of a level.
#[derive(Clone, Debug)]
pub(crate) struct Far {
    pub(crate) sources: Vec<Vec<usize>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_cover_every_pair_of_groups_once_and_balls_hold_the_supports() {
        let count = 400;
        let places: Vec<Vec3> = (0..count)
            .map(|i| Vec3::new(f64::from(i % 17), f64::from(i % 23) * 0.7, f64::from(i) * 0.02))
            .collect();
        let radii = vec![0.2; places.len()];
        let tree = Octree::new(&places, &radii, 1.0);
        let (far, near) =
            tree.pairs(|level, square| 0.9 * tree.levels[level].side * f64::from(square).sqrt());
        let mut seen = vec![0; places.len() * places.len()];
        let mut count_pairs = |a: Range<usize>, b: Range<usize>| {
            for i in a {
                b.clone().for_each(|j| seen[i * places.len() + j] += 1);
            }
        };
        let mut levels = 0;
        for (level, far) in far.iter().enumerate() {
            for (target, sources) in far.sources.iter().enumerate() {
                let own = tree.groups(level, target);
                for &source in sources {
                    count_pairs(own.clone(), tree.groups(level, source));
                }
                let centre = tree.centre(level, target);
                for &group in &tree.order[own] {
                    let reach = places[group].distance(centre) + 0.2;
                    assert!(reach <= tree.levels[level].cubes[target].radius + 1e-12);
                    let most = 0.5 * 3.0_f64.sqrt() * tree.levels[level].side + 0.2;
                    assert!(reach <= most + 1e-9);
                }
            }
            levels += usize::from(far.sources.iter().any(|list| !list.is_empty()));
        }
        for (target, sources) in near.iter().enumerate() {
            assert!(sources.contains(&target));
            for &source in sources {
                count_pairs(tree.groups(0, target), tree.groups(0, source));
            }
        }
        assert!(seen.iter().all(|&n| n == 1) && levels > 1, "{levels}");
        assert_eq!(tree.levels.last().map(|level| level.cubes.len()), Some(1));
    }
}

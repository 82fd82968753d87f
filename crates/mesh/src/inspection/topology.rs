//! Sides that pieces share: what is open, what hangs together, and which way it is turned.

use std::collections::BTreeMap;

use super::boxes::Boxes;
use crate::weld::Points;
use crate::{Bounds, Patch, Vec3};

/// Height over the longest side below which a piece is a sliver.
const SLIVER_HEIGHT: f64 = 1e-3;

/// Pieces that hang together through sides that two of them share.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Component {
    /// Number of its pieces.
    pub pieces: usize,
    /// Its first piece.
    pub first: u32,
    /// Whether each of its sides is shared by two of its pieces that run along it in opposite
    /// directions.
    pub closed: bool,
    /// Volume enclosed where it is closed, m³; negative where it is lit inside.
    pub volume: f64,
}

/// A piece with the corners of an earlier one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Repeat {
    /// The earlier piece.
    pub first: u32,
    /// The one that repeats it.
    pub second: u32,
    /// Whether it is lit on the other side.
    pub reversed: bool,
}

/// How pieces hang together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    /// The components, by their first pieces.
    pub components: Vec<Component>,
    /// Component of each piece.
    pub component_of: Vec<u32>,
    /// Sides of one piece only, and the piece.
    pub open: Vec<([Vec3; 2], u32)>,
    /// Sides of more than two pieces.
    pub crowded: Vec<[Vec3; 2]>,
    /// Sides along which the two pieces that share them run in the same direction, and the pieces.
    pub clashes: Vec<([Vec3; 2], [u32; 2])>,
    /// Pieces with the corners of others.
    pub repeats: Vec<Repeat>,
    /// Corners of pieces inside open sides of others.
    pub junctions: Vec<Vec3>,
    /// Pieces lower than a thousandth of their longest side.
    pub slivers: Vec<u32>,
}

/// A piece along a side.
#[derive(Clone, Copy)]
struct Use {
    piece: u32,
    /// From the corner with the smaller number to that with the larger one.
    forward: bool,
}

impl Topology {
    /// Welds corners within 1e-9 of the diagonal of all pieces, and compares sides.
    #[must_use]
    pub fn of(pieces: &[Patch]) -> Self {
        let bounds = Bounds::around(pieces.iter().flat_map(|patch| patch.corners().iter().copied()));
        let mut points = Points::new(bounds);
        let numbers: Vec<Vec<u32>> = pieces
            .iter()
            .map(|patch| patch.corners().iter().map(|&p| points.vertex(p, 0, |_| true) as u32).collect())
            .collect();
        let edges = edges(&numbers);
        let (component_of, count) = components(&edges, pieces.len());
        let mut found = Self { component_of, slivers: slivers(pieces), ..Self::default() };
        found.repeats = repeats(&numbers);
        found.components = found.measure(pieces, &edges, count);
        let ends = |edge: &[u32; 2]| edge.map(|corner| points.vertices[corner as usize]);
        for (edge, uses) in &edges {
            match uses[..] {
                [one] => found.open.push((ends(edge), one.piece)),
                [a, b] if a.forward == b.forward => found.clashes.push((ends(edge), [a.piece, b.piece])),
                [_, _] => {}
                _ => found.crowded.push(ends(edge)),
            }
        }
        found.junctions = junctions(&found.open, points.tolerance);
        found
    }

    /// Whether closed components are lit inside.
    pub fn inward(&self) -> impl Iterator<Item = &Component> {
        self.components.iter().filter(|component| component.closed && component.volume < 0.0)
    }

    fn measure(&self, pieces: &[Patch], edges: &[([u32; 2], Vec<Use>)], count: usize) -> Vec<Component> {
        let mut components = vec![Component { closed: true, ..Component::default() }; count];
        for (piece, &own) in self.component_of.iter().enumerate() {
            let component = &mut components[own as usize];
            if component.pieces == 0 {
                component.first = piece as u32;
            }
            component.pieces += 1;
        }
        for (_, uses) in edges {
            let mut balance: BTreeMap<u32, [usize; 2]> = BTreeMap::new();
            for one in uses {
                let own = self.component_of[one.piece as usize];
                balance.entry(own).or_default()[usize::from(one.forward)] += 1;
            }
            for (own, [backward, forward]) in balance {
                components[own as usize].closed &= backward == 1 && forward == 1;
            }
        }
        for (patch, &own) in pieces.iter().zip(&self.component_of) {
            let component = &mut components[own as usize];
            let origin = pieces[component.first as usize].corner(0);
            component.volume += patch.area() * patch.normal().dot(patch.corner(0) - origin) / 3.0;
        }
        components.iter_mut().filter(|component| !component.closed).for_each(|open| open.volume = 0.0);
        components
    }
}

/// Every side with the pieces along it.
fn edges(numbers: &[Vec<u32>]) -> Vec<([u32; 2], Vec<Use>)> {
    let mut uses: Vec<([u32; 2], Use)> = Vec::new();
    for (piece, corners) in numbers.iter().enumerate() {
        for (k, &a) in corners.iter().enumerate() {
            let b = corners[(k + 1) % corners.len()];
            // Corners that are welded to one have no side between them.
            if a != b {
                uses.push(([a.min(b), a.max(b)], Use { piece: piece as u32, forward: a < b }));
            }
        }
    }
    uses.sort_by_key(|(edge, one)| (*edge, one.piece));
    let run = |run: &[([u32; 2], Use)]| (run[0].0, run.iter().map(|(_, one)| *one).collect());
    uses.chunk_by(|a, b| a.0 == b.0).map(run).collect()
}

/// Component of each piece, and how many there are.
fn components(edges: &[([u32; 2], Vec<Use>)], pieces: usize) -> (Vec<u32>, usize) {
    let mut leader: Vec<usize> = (0..pieces).collect();
    for (_, uses) in edges {
        if let [a, b] = uses[..] {
            let (a, b) = (find(&mut leader, a.piece as usize), find(&mut leader, b.piece as usize));
            leader[a.max(b)] = a.min(b);
        }
    }
    let (mut numbers, mut count) = (vec![0; pieces], 0);
    for piece in 0..pieces {
        let first = find(&mut leader, piece);
        numbers[piece] = if first == piece {
            count += 1;
            count - 1
        } else {
            numbers[first]
        };
    }
    (numbers.into_iter().map(|number| number as u32).collect(), count)
}

fn find(leader: &mut [usize], mut k: usize) -> usize {
    while leader[k] != k {
        leader[k] = leader[leader[k]];
        k = leader[k];
    }
    k
}

/// Pieces with the same corners as an earlier one.
fn repeats(numbers: &[Vec<u32>]) -> Vec<Repeat> {
    let sorted = |corners: &Vec<u32>| {
        let mut sorted = corners.clone();
        sorted.sort_unstable();
        sorted
    };
    let mut keys: Vec<(Vec<u32>, u32)> = numbers.iter().map(sorted).zip(0..).collect();
    keys.sort_unstable();
    let mut found = Vec::new();
    for run in keys.chunk_by(|a, b| a.0 == b.0) {
        let first = run[0].1;
        for &(_, second) in &run[1..] {
            let reversed = !same_turn(&numbers[first as usize], &numbers[second as usize]);
            found.push(Repeat { first, second, reversed });
        }
    }
    found.sort_unstable_by_key(|repeat| repeat.second);
    found
}

/// Whether two lists of the same corners run the same way round.
fn same_turn(a: &[u32], b: &[u32]) -> bool {
    let next = |list: &[u32]| {
        let place = list.iter().position(|&corner| corner == a[0]);
        place.map(|place| list[(place + 1) % list.len()])
    };
    next(a) == next(b)
}

fn slivers(pieces: &[Patch]) -> Vec<u32> {
    let thin = |patch: &Patch| {
        let sides = (0..patch.sides()).map(|k| patch.corner(k).distance(patch.corner(k + 1)));
        let longest = sides.fold(0.0, f64::max);
        patch.area() < 0.5 * SLIVER_HEIGHT * longest * longest
    };
    pieces.iter().zip(0..).filter(|(patch, _)| thin(patch)).map(|(_, k)| k).collect()
}

/// Ends of open sides that lie inside other open sides, each once.
fn junctions(open: &[([Vec3; 2], u32)], tolerance: f64) -> Vec<Vec3> {
    let around = |[a, b]: [Vec3; 2]| Bounds { min: a.min(b), max: a.max(b) };
    let tree = Boxes::new(open.iter().map(|(ends, _)| around(*ends)).collect());
    let mut found: Vec<Vec3> = Vec::new();
    for point in open.iter().flat_map(|(ends, _)| ends) {
        let inside = |&side: &u32| {
            let [a, b] = open[side as usize].0;
            let along = b - a;
            let t = (*point - a).dot(along) / along.length_squared();
            let clear = point.distance(a) > tolerance && point.distance(b) > tolerance;
            clear && (0.0..=1.0).contains(&t) && point.distance(a + along * t) <= tolerance
        };
        if tree.near(&around([*point; 2]), tolerance).iter().any(inside) {
            found.push(*point);
        }
    }
    found.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap_or(std::cmp::Ordering::Equal));
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDES: [[usize; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

    fn corner(k: usize) -> Vec3 {
        Vec3::new((k & 1) as f64, ((k >> 1) & 1) as f64, (k >> 2) as f64)
    }

    fn cube() -> Vec<Patch> {
        SIDES.iter().map(|side| Patch::quad(side.map(corner)).unwrap().unwrap()).collect()
    }

    #[test]
    fn a_cube_is_closed_and_lit_outside() {
        let found = Topology::of(&cube());
        let [component] = &found.components[..] else { panic!("{found:?}") };
        assert!(component.closed && (component.volume - 1.0).abs() < 1e-14 && component.pieces == 6);
        let empty = Topology { components: vec![], component_of: vec![], ..found.clone() };
        assert_eq!(empty, Topology::default());
        let inside: Vec<Patch> = cube().iter().map(Patch::flipped).collect();
        assert_eq!(Topology::of(&inside).inward().count(), 1);
    }

    #[test]
    fn a_side_that_is_missing_turned_or_repeated_is_found() {
        let mut pieces = cube();
        pieces.pop();
        let found = Topology::of(&pieces);
        assert!(found.open.len() == 4 && !found.components[0].closed && found.clashes.is_empty());
        let mut pieces = cube();
        pieces[5] = pieces[5].flipped();
        let found = Topology::of(&pieces);
        assert!(found.clashes.len() == 4 && found.open.is_empty() && !found.components[0].closed);
        let mut pieces = cube();
        pieces.extend([pieces[2], pieces[3].flipped()]);
        let found = Topology::of(&pieces);
        let repeats =
            [Repeat { first: 2, second: 6, reversed: false }, Repeat { first: 3, second: 7, reversed: true }];
        assert_eq!((&found.repeats[..], found.crowded.len()), (&repeats[..], 8));
    }

    #[test]
    fn corners_inside_open_sides_and_slivers_are_found() {
        let triangle = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            Patch::triangle([a, b, c].map(|[x, y]| Vec3::new(x, y, 0.0))).unwrap()
        };
        let pieces = [
            triangle([0., 0.], [2., 0.], [0., 1.]),
            triangle([0., 0.], [0., -1.], [1., 0.]),
            triangle([1., 0.], [0., -1.], [2., 0.]),
            triangle([5., 0.], [6., 0.], [5.5, 9e-4]),
        ];
        let found = Topology::of(&pieces);
        assert_eq!(found.junctions, [Vec3::X]);
        assert_eq!(found.slivers, [3]);
    }
}

//! Scenes on an integer grid, where i64 decides every crossing exactly, through edges and corners
//! too.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

use crate::scenes::Random;

type Point = [i64; 3];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn plus(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Sign of the volume spanned by three edges.
fn sign(a: Point, b: Point, c: Point) -> i64 {
    (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0]))
        .signum()
}

/// Whether the open segment crosses the convex polygon, outline included, from one side of its
/// plane to the other.
fn crosses(p: Point, q: Point, corners: &[Point]) -> bool {
    let side = |x| sign(minus(corners[1], corners[0]), minus(corners[2], corners[0]), minus(x, corners[0]));
    let turn = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        sign(minus(q, p), minus(a, p), minus(b, p))
    };
    let turns: Vec<i64> = (0..corners.len()).map(turn).collect();
    let outside = turns.contains(&1) && turns.contains(&-1);
    side(p) * side(q) < 0 && !outside
}

fn vector(p: Point) -> Vec3 {
    Vec3::new(p[0] as f64, p[1] as f64, p[2] as f64)
}

struct Grid {
    random: Random,
    size: i64,
}

impl Grid {
    fn point(&mut self) -> Point {
        [0; 3].map(|_| i64::from(self.random.index(2 * self.size as usize + 1) as u32) - self.size)
    }

    /// A triangle, a parallelogram or a trapezoid.
    fn polygon(&mut self) -> Vec<Point> {
        loop {
            let (a, b, c) = (self.point(), self.point(), self.point());
            let (b, c) = (minus(b, a), minus(c, a));
            let corners = match self.random.index(3) {
                0 => vec![a, plus(a, b), plus(a, c)],
                1 => vec![a, plus(a, b), plus(plus(a, b), c), plus(a, c)],
                _ => vec![a, plus(plus(a, b), b), plus(plus(a, b), c), plus(a, c)],
            };
            if patch(&corners).is_some() {
                return corners;
            }
        }
    }
}

fn patch(corners: &[Point]) -> Option<Patch> {
    match *corners {
        [a, b, c] => Patch::triangle([a, b, c].map(vector)).ok(),
        [a, b, c, d] => Patch::quad([a, b, c, d].map(vector)).ok().flatten(),
        _ => None,
    }
}

/// Compares, and returns how many segments were blocked and how many crossed an outline.
fn compare(seed: u64, size: i64, polygons: usize, segments: usize) -> (usize, usize) {
    let mut grid = Grid { random: Random(seed), size };
    let scene: Vec<Vec<Point>> = (0..polygons).map(|_| grid.polygon()).collect();
    let patches: Vec<Patch> = scene.iter().filter_map(|corners| patch(corners)).collect();
    let occluders = Occluders::new(&patches).unwrap();
    let all: Vec<u32> = (0..patches.len() as u32).collect();
    let (mut blocked, mut touching) = (0, 0);
    for _ in 0..segments {
        let (p, q) = (grid.point(), grid.point());
        let expected = scene.iter().any(|corners| crosses(p, q, corners));
        let (p_real, q_real) = (vector(p), vector(q));
        assert_eq!(occluders.unoccluded(p_real, q_real), !expected, "from {p:?} to {q:?}");
        assert_eq!(occluders.unoccluded_by(p_real, q_real, &all), !expected, "from {p:?} to {q:?}");
        blocked += usize::from(expected);
        touching += usize::from(scene.iter().any(|corners| touches(p, q, corners)));
    }
    (blocked, touching)
}

/// Whether the segment crosses the polygon in a point of its outline.
fn touches(p: Point, q: Point, corners: &[Point]) -> bool {
    let on = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        sign(minus(q, p), minus(a, p), minus(b, p)) == 0
    };
    crosses(p, q, corners) && (0..corners.len()).any(on)
}

#[test]
fn agrees_with_integers_on_coarse_grids() {
    let (mut blocked, mut touching) = (0, 0);
    for seed in 0..400 {
        let (b, t) = compare(seed, 6, 1 + seed as usize % 12, 250);
        blocked += b;
        touching += t;
    }
    assert!((20_000..80_000).contains(&blocked), "{blocked}");
    assert!(touching > 2_000, "{touching}");
}

#[test]
fn agrees_with_integers_on_fine_grids() {
    for seed in 0..20 {
        let (blocked, _) = compare(1_000 + seed, 60, 150, 500);
        assert!(blocked > 0);
    }
}

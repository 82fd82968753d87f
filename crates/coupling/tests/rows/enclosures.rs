//! Closed rooms, furnished or not, of quads that look inwards.

use fredholm_mesh::{Patch, Vec3};

/// Where a scene stands.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// Along the axes.
    Upright,
    /// With no edge parallel to an axis.
    Turned,
    /// Turned, a thousand times its size away from the origin.
    Far,
}

impl Place {
    fn put(self, patches: &[Patch]) -> Vec<Patch> {
        let axes = match self {
            Self::Upright => Vec3::AXES,
            Self::Turned | Self::Far => turned(0.3, 0.2, 0.9),
        };
        let shift = if matches!(self, Self::Far) { Vec3::new(1e3, -7e2, 3e2) } else { Vec3::ZERO };
        let moved = |x: &Vec3| shift + (axes[0] * x.x + axes[1] * x.y + axes[2] * x.z);
        let put = |patch: &Patch| quad(std::array::from_fn(|k| moved(&patch.corner(k))));
        patches.iter().map(put).collect()
    }
}

fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

fn quad(corners: [Vec3; 4]) -> Patch {
    Patch::quad(corners).unwrap().unwrap()
}

/// The axes after turns about z, y and x.
fn turned(a: f64, b: f64, c: f64) -> [Vec3; 3] {
    let (x, y, z) = (v(a.cos(), a.sin(), 0.0), v(-a.sin(), a.cos(), 0.0), Vec3::Z);
    let (x, z) = (x * b.cos() + z * b.sin(), z * b.cos() - x * b.sin());
    [x, y * c.cos() + z * c.sin(), z * c.cos() - y * c.sin()]
}

/// The sides of a box with `n` patches along each edge, seen from inside or outside. Corners that
/// meet have the same bits.
fn sides(corner: Vec3, edges: [Vec3; 3], n: [usize; 3], inward: bool) -> Vec<Patch> {
    let at = |k: [usize; 3]| {
        let [a, b, c] = [0, 1, 2].map(|axis| edges[axis] * (k[axis] as f64 / n[axis] as f64));
        corner + (a + b + c)
    };
    let mut patches = Vec::new();
    for axis in 0..3 {
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        for (far, i, j) in
            [false, true].into_iter().flat_map(|far| grid(n[p], n[q]).map(move |(i, j)| (far, i, j)))
        {
            let place = |i: usize, j: usize| {
                let mut k = [0; 3];
                (k[axis], k[p], k[q]) = (if far { n[axis] } else { 0 }, i, j);
                at(k)
            };
            let cell = quad([place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)]);
            patches.push(if far == inward { cell.flipped() } else { cell });
        }
    }
    patches
}

fn grid(rows: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..rows).flat_map(move |i| (0..columns).map(move |j| (i, j)))
}

/// A unit cube with n × n patches a wall, and a box of side 0.4 in the middle.
pub fn cube_with_a_box(n: usize, place: Place) -> Vec<Patch> {
    let mut patches = sides(Vec3::ZERO, Vec3::AXES, [n; 3], true);
    patches.extend(sides(Vec3::splat(0.3), Vec3::AXES.map(|axis| axis * 0.4), [4; 3], false));
    place.put(&patches)
}

/// A unit cube with n × n patches a wall, and a box that is tilted about all axes.
pub fn cube_with_a_tilted_box(n: usize) -> Vec<Patch> {
    let mut patches = sides(Vec3::ZERO, Vec3::AXES, [n; 3], true);
    let [a, b, c] = turned(0.5, 0.3, 0.7);
    let edges = [a * 0.4, b * 0.35, c * 0.45];
    let middle = v(0.48, 0.53, 0.46);
    patches.extend(sides(middle - 0.5 * (edges[0] + edges[1] + edges[2]), edges, [2; 3], false));
    patches
}

/// A room of 4 m × 3 m × 2 m with a box on the floor, and three more at some angle in the air; 2n
/// patches along its height.
pub fn furnished_room(n: usize) -> Vec<Patch> {
    let mut patches =
        sides(Vec3::ZERO, [Vec3::X * 4.0, Vec3::Y * 3.0, Vec3::Z * 2.0], [4 * n, 3 * n, 2 * n], true);
    let boxes = [
        ([1.0, 1.0, 0.0], [1.0, 1.0, 0.7], 0.0),
        ([2.3, 1.6, 0.5], [0.6, 0.8, 0.9], -0.3),
        ([2.9, 0.2, 0.1], [0.7, 0.6, 1.2], 0.4),
        ([1.2, 2.0, 0.9], [0.5, 0.3, 0.2], 0.9),
    ];
    for (corner, size, turn) in boxes {
        let axes = turned(turn, 0.0, 0.0);
        let edges = std::array::from_fn(|k| axes[k] * size[k]);
        patches.extend(sides(Vec3::from(corner), edges, [2; 3], false));
    }
    patches
}

/// A room with an L as its floor: the two arms see each other past a corner only.
pub fn room_with_a_corner(n: usize, place: Place) -> Vec<Patch> {
    const HEIGHT: f64 = 1.5;
    let outline = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.2], [1.4, 1.2], [1.4, 3.1], [0.0, 3.1]];
    let low = |[x, y]: [f64; 2]| v(x, y, 0.0);
    let high = |[x, y]: [f64; 2]| v(x, y, HEIGHT);
    let mut patches = Vec::new();
    for (k, &a) in outline.iter().enumerate() {
        let b = outline[(k + 1) % outline.len()];
        patches.extend(cells([low(a), high(a), high(b), low(b)], n));
    }
    for [min, max] in [[[0.0, 0.0], [1.4, 1.2]], [[1.4, 0.0], [3.0, 1.2]], [[0.0, 1.2], [1.4, 3.1]]] {
        let corners = [min, [max[0], min[1]], max, [min[0], max[1]]];
        patches.extend(cells(corners.map(low), n));
        patches.extend(cells(corners.map(high), n).iter().map(Patch::flipped));
    }
    place.put(&patches)
}

/// A quad as n × n.
fn cells([a, b, c, d]: [Vec3; 4], n: usize) -> Vec<Patch> {
    let at = |i: usize, j: usize| {
        let (s, t) = (i as f64 / n as f64, j as f64 / n as f64);
        (a * (1.0 - s) + b * s) * (1.0 - t) + (d * (1.0 - s) + c * s) * t
    };
    let cell = |(i, j)| quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
    grid(n, n).map(cell).collect()
}

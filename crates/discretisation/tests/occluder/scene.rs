//! The scene scenes/occluder.toml, a room with a lamp in its ceiling and a plate under the lamp, on
//! meshes that are finer where the walls meet.

use fredholm_discretisation::Light;
use fredholm_linop::MultiVector;
use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Shape, Vec3};
use fredholm_visibility::Occluders;

/// Name, corners, reflectance.
type Piece = (&'static str, [[f64; 3]; 4], f64);

/// The walls are in two pieces, an upper one that the lamp shines on at close range and a lower
/// one.
const PIECES: [Piece; 13] = [
    ("floor", [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]], 0.7),
    ("ceiling", [[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]], 0.7),
    ("wall_xmin", [[0., 0., 0.], [0., 1., 0.], [0., 1., SPLIT], [0., 0., SPLIT]], 0.7),
    ("wall_xmax", [[1., 1., 0.], [1., 0., 0.], [1., 0., SPLIT], [1., 1., SPLIT]], 0.7),
    ("wall_ymin", [[1., 0., 0.], [0., 0., 0.], [0., 0., SPLIT], [1., 0., SPLIT]], 0.7),
    ("wall_ymax", [[0., 1., 0.], [1., 1., 0.], [1., 1., SPLIT], [0., 1., SPLIT]], 0.7),
    ("wall_xmin", [[0., 0., SPLIT], [0., 1., SPLIT], [0., 1., 1.], [0., 0., 1.]], 0.7),
    ("wall_xmax", [[1., 1., SPLIT], [1., 0., SPLIT], [1., 0., 1.], [1., 1., 1.]], 0.7),
    ("wall_ymin", [[1., 0., SPLIT], [0., 0., SPLIT], [0., 0., 1.], [1., 0., 1.]], 0.7),
    ("wall_ymax", [[0., 1., SPLIT], [1., 1., SPLIT], [1., 1., 1.], [0., 1., 1.]], 0.7),
    ("light", [[0.35, 0.35, 1.], [0.35, 0.65, 1.], [0.65, 0.65, 1.], [0.65, 0.35, 1.]], 0.0),
    ("plate_top", [[0.3, 0.3, 0.5], [0.7, 0.3, 0.5], [0.7, 0.7, 0.5], [0.3, 0.7, 0.5]], 0.3),
    ("plate_bottom", [[0.3, 0.3, 0.5], [0.3, 0.7, 0.5], [0.7, 0.7, 0.5], [0.7, 0.3, 0.5]], 0.3),
];

/// Height at which the walls are divided.
const SPLIT: f64 = 0.75;
/// Where the lamp begins.
const LAMP: f64 = 0.35;

/// Elements of equal width up to a line, and their number.
pub type Part = (f64, usize);

/// The lines of the elements. Those along horizontal sides are given up to the middle, and
/// mirrored.
pub struct Cuts {
    pub floor: &'static [Part],
    pub ceiling: &'static [Part],
    /// Along and up the pieces of the walls.
    pub lower: [&'static [Part]; 2],
    pub upper: [&'static [Part]; 2],
    pub lamp: &'static [Part],
    pub plate: &'static [Part],
}

impl Cuts {
    /// The mesh; its pieces are its surfaces.
    pub fn mesh(&self) -> Mesh {
        build(&|piece| match piece {
            "floor" => square(mirrored(self.floor)),
            "ceiling" => square(mirrored(self.ceiling)),
            "light" => square(mirrored(self.lamp)),
            "plate_top" | "plate_bottom" => square(mirrored(self.plate)),
            "upper" => [mirrored(self.upper[0]), lines(self.upper[1])],
            _ => [mirrored(self.lower[0]), lines(self.lower[1])],
        })
    }
}

fn lines(parts: &[Part]) -> Vec<f64> {
    let mut lines = vec![0.0];
    for &(to, count) in parts {
        let from = lines[lines.len() - 1];
        lines.extend((1..=count).map(|i| from + (to - from) * (i as f64 / count as f64)));
    }
    lines
}

/// Lines of the half from 0 to ½ and its mirror image.
fn mirrored(parts: &[Part]) -> Vec<f64> {
    let mut half = lines(parts);
    let other: Vec<f64> = half.iter().rev().skip(1).map(|x| 1.0 - x).collect();
    half.extend(other);
    half
}

fn square(lines: Vec<f64>) -> [Vec<f64>; 2] {
    [lines.clone(), lines]
}

/// The faces of the reference.
pub fn faces() -> Mesh {
    let even = |n: usize| lines(&[(1.0, n)]);
    build(&|piece| match piece {
        "ceiling" => square(mirrored(&[(LAMP, 4), (0.5, 2)])),
        "light" => square(even(4)),
        "plate_top" | "plate_bottom" => square(even(6)),
        "floor" => square(even(12)),
        "upper" => [even(12), even(3)],
        _ => [even(12), even(9)],
    })
}

/// Cuts every surface by the lines along its sides.
fn build(lines: &dyn Fn(&str) -> [Vec<f64>; 2]) -> Mesh {
    let mut builder = MeshBuilder::default();
    for (at, (name, corners, _)) in PIECES.into_iter().enumerate() {
        builder.surface(name, at);
        let upper = name.starts_with("wall") && corners[2][2] > SPLIT;
        let [u, v] = lines(if upper { "upper" } else { name });
        let skip = if name == "ceiling" { hole(&u) } else { Vec::new() };
        let shape = Shape::Quad { corners: corners.map(Vec3::from), skip };
        let lines = Lines::Explicit { u, v };
        builder.add(&shape, &Cutting { lines, ..Cutting::default() }).unwrap();
    }
    builder.build()
}

/// Cells of the ceiling that are the lamp.
fn hole(lines: &[f64]) -> Vec<[usize; 2]> {
    let cells = 0..lines.len() - 1;
    let inside: Vec<usize> =
        cells.filter(|&i| (0.5 * (lines[i] + lines[i + 1]) - 0.5).abs() < 0.5 - LAMP).collect();
    inside.iter().flat_map(|&i| inside.iter().map(move |&j| [i, j])).collect()
}

/// Name of the surface of an element in the reference.
pub fn name(mesh: &Mesh, leaf: usize) -> &'static str {
    PIECES[mesh.surface_of(leaf)].0
}

/// Exitance of an element, W/m².
pub fn exitance(mesh: &Mesh, leaf: usize) -> f64 {
    if name(mesh, leaf) == "light" { 10.0 } else { 0.0 }
}

pub fn light<'a>(mesh: &Mesh, occluders: &'a Occluders) -> Light<'a> {
    let reflectance = MultiVector::from_fn(mesh.len(), 1, |leaf, _| PIECES[mesh.surface_of(leaf)].2);
    let exitance = MultiVector::from_fn(mesh.len(), 1, |leaf, _| exitance(mesh, leaf));
    Light::new(mesh, occluders, reflectance, exitance, 1e-3).unwrap()
}

/// The element of a surface of the reference that holds a point, and the point's parameters there.
pub fn place(mesh: &Mesh, surface: &str, p: Vec3) -> (usize, f64, f64) {
    let held = |leaf: usize| {
        let patch = mesh.patch(leaf);
        let along = |corner: usize| {
            let side = patch.corner(corner) - patch.corner(0);
            (p - patch.corner(0)).dot(side) / side.dot(side)
        };
        let (u, v) = (along(1), along(3));
        let inside = |t: f64| (-1e-12..=1.0 + 1e-12).contains(&t);
        (name(mesh, leaf) == surface && inside(u) && inside(v)).then_some((leaf, u, v))
    };
    (0..mesh.len()).find_map(held).unwrap()
}

//! Surfaces of triangles for shapes with known answers, their edges up to a given length. Metres.
//!
//! The current of a flat sheet grows with the distance d from an open edge as 1/√d along it and
//! falls as √d across it (J. Meixner, IEEE Trans. Antennas Propag. 20 (1972) 442,
//! doi:10.1109/TAP.1972.1140243), which even cells follow slowly. A grading halves the cells
//! towards the edges as often as asked.

use crate::{MomentsError, Surface};
use fredholm_mesh::{Cutting, MeshBuilder, Shape, Vec3};
use fredholm_waves::surface::sphere_segments;

/// How cells are laid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Grading {
    /// How often the cells at an open edge are halved; 0 for even cells.
    pub halvings: usize,
}

fn check(edge: f64) -> Result<(), MomentsError> {
    if edge > 0.0 && edge.is_finite() {
        return Ok(());
    }
    Err(MomentsError::Parameter { what: "the largest edge", value: edge, expected: "finite and above 0" })
}

/// Places from 0 to 1 that cut a side of this length; the steps at both ends are halved `halvings`
/// times.
fn lines(length: f64, edge: f64, halvings: usize) -> Vec<f64> {
    let cells = (length / edge - 1e-9).ceil().max(1.0) as usize;
    let even: Vec<f64> = (0..=cells).map(|i| i as f64 / cells as f64).collect();
    if halvings == 0 || cells < 2 {
        return even;
    }
    let step = 1.0 / cells as f64;
    let fine = |i: usize| step * 0.5_f64.powi(i as i32);
    let mut places = vec![0.0];
    places.extend((1..=halvings).rev().map(fine));
    places.extend(&even[1..cells]);
    places.extend((1..=halvings).map(|i| 1.0 - fine(i)));
    places.push(1.0);
    places
}

/// The flat rectangle with these sides from a corner; its normal is along u × v. Cells are cut into
/// two triangles, with diagonals that alternate. `edge` bounds the sides of the cells.
///
/// # Errors
/// [`MomentsError::Parameter`] for an edge that is none, those of [`Surface::new`] for sides that
/// are none.
pub fn rectangle(
    corner: Vec3,
    u: Vec3,
    v: Vec3,
    edge: f64,
    grading: Grading,
) -> Result<Surface, MomentsError> {
    check(edge)?;
    let [across, up] = [u, v].map(|side| lines(side.length(), edge, grading.halvings));
    let columns = across.len();
    let vertices = up.iter().flat_map(|t| across.iter().map(move |s| corner + *s * u + *t * v)).collect();
    let mut triangles = Vec::new();
    for j in 0..up.len() - 1 {
        for i in 0..columns - 1 {
            let [a, b] = [j * columns + i, j * columns + i + 1].map(|at| at as u32);
            let (c, d) = (b + columns as u32, a + columns as u32);
            let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            triangles.extend(halves);
        }
    }
    Surface::new(vertices, triangles)
}

/// The square of this side in the plane y = 0, centred, its normal along −y.
///
/// # Errors
/// Those of [`rectangle`].
pub fn plate(side: f64, edge: f64, grading: Grading) -> Result<Surface, MomentsError> {
    let corner = Vec3::new(-0.5 * side, 0.0, -0.5 * side);
    rectangle(corner, Vec3::X * side, Vec3::Z * side, edge, grading)
}

/// Two squares of this side at (∓offset, 0, 0) that face each other at a right angle, their normals
/// (±1, −1, 0)/√2.
///
/// # Errors
/// Those of [`rectangle`].
pub fn facing_plates(side: f64, offset: f64, edge: f64, grading: Grading) -> Result<Surface, MomentsError> {
    let plate = |sign: f64| {
        let u = Vec3::new(1.0, sign, 0.0).normalize() * side;
        let z = Vec3::Z * side;
        rectangle(Vec3::X * (-sign * offset) - 0.5 * (u + z), u, z, edge, grading)
    };
    plate(1.0)?.with(&plate(-1.0)?)
}

/// The closed box with these sides along the axes, centred, cells halved towards its edges.
///
/// # Errors
/// Those of [`rectangle`].
pub fn cuboid(sides: Vec3, edge: f64, grading: Grading) -> Result<Surface, MomentsError> {
    let mut whole: Option<Surface> = None;
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let [u, v] = [1, 2].map(|i| Vec3::AXES[(axis + i) % 3] * sides[(axis + i) % 3]);
            let (u, v) = if sign > 0.0 { (u, v) } else { (v, u) };
            let corner = Vec3::AXES[axis] * (0.5 * sign * sides[axis]) - 0.5 * (u + v);
            let face = rectangle(corner, u, v, edge, grading)?;
            whole = Some(whole.map_or_else(|| Ok(face.clone()), |whole| whole.with(&face))?);
        }
    }
    let whole = whole.ok_or(MomentsError::Empty)?;
    whole.welded(1e-9 * sides.length())
}

/// The closed sphere around the origin as a geodesic polyhedron with edges up to `edge`; its area
/// is that of the sphere.
///
/// # Errors
/// [`MomentsError::Wave`] for lengths that are none.
pub fn sphere(radius: f64, edge: f64) -> Result<Surface, MomentsError> {
    let segments = sphere_segments(radius, edge)?;
    let shape = Shape::Sphere { centre: Vec3::ZERO, radius, inward: false, segments };
    let mut builder = MeshBuilder::default();
    builder.surface("", 0);
    builder.add(&shape, &Cutting::default()).map_err(fredholm_waves::WaveError::from)?;
    Surface::from_mesh(&builder.build())
}

/// The closed sphere around the origin in curved triangles with edges up to `edge`, their corners
/// and the middles of their sides on the sphere: for functions of the first full order.
///
/// # Errors
/// Those of [`sphere`].
pub fn curved_sphere(radius: f64, edge: f64) -> Result<Surface, MomentsError> {
    let flat = sphere(radius, edge)?;
    let on = |v: Vec3| v.normalize_or_zero() * radius;
    let vertices: Vec<Vec3> = flat.vertices().iter().map(|&v| on(v)).collect();
    let middle = |side: [u32; 2]| on(vertices[side[0] as usize] + vertices[side[1] as usize]);
    Surface::new(vertices.clone(), flat.triangles().to_vec())?.curved(middle)
}

//! Shapes with closed-form answers, meshed with edges up to a given length (λ/10, say).
//!
//! All are cut by `fredholm_mesh`. Lengths in metres.

use super::{Kind, Scatterer};
use crate::WaveError;
use fredholm_mesh::{Cutting, Lines, MeshBuilder, Shape, Vec3};

fn scatterer(shapes: &[Shape], edge: f64, kind: Kind) -> Result<Scatterer, WaveError> {
    if !(edge > 0.0 && edge.is_finite()) {
        return Err(WaveError::Length { what: "the largest edge", value: edge });
    }
    let cutting = Cutting { lines: Lines::LargestEdge(edge), ..Cutting::default() };
    let mut builder = MeshBuilder::default();
    for shape in shapes {
        builder.surface("", 0);
        builder.add(shape, &cutting)?;
    }
    Scatterer::new(&builder.build(), |_| kind)
}

fn quad(corner: Vec3, u: Vec3, v: Vec3) -> Shape {
    Shape::Quad { corners: [corner, corner + u, corner + u + v, corner + v], skip: Vec::new() }
}

/// The thin rectangle with these sides from a corner; its normal is along u × v.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn rectangle(corner: Vec3, u: Vec3, v: Vec3, edge: f64) -> Result<Scatterer, WaveError> {
    scatterer(&[quad(corner, u, v)], edge, Kind::Sheet)
}

/// The thin square of this side in the plane y = 0, centred, its normal along −y.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn plate(side: f64, edge: f64) -> Result<Scatterer, WaveError> {
    let corner = Vec3::new(-0.5 * side, 0.0, -0.5 * side);
    rectangle(corner, Vec3::X * side, Vec3::Z * side, edge)
}

/// The closed cube of this side, centred, its sides along the axes.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn cube(side: f64, edge: f64) -> Result<Scatterer, WaveError> {
    cuboid(Vec3::splat(side), edge)
}

/// The closed box of these sides along the axes, centred.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn cuboid(sides: Vec3, edge: f64) -> Result<Scatterer, WaveError> {
    let half = 0.5 * sides;
    scatterer(&[Shape::Box { min: -half, max: half, inward: false }], edge, Kind::Closed)
}

/// The closed sphere around the origin as 20 f² triangles with edges up to `edge`; their areas sum
/// to 4π r², and their nodes and normals are those of the sphere.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn sphere(radius: f64, edge: f64) -> Result<Scatterer, WaveError> {
    let segments = sphere_segments(radius, edge)?;
    let shape = Shape::Sphere { centre: Vec3::ZERO, radius, inward: false, segments };
    let mut builder = MeshBuilder::default();
    builder.surface("", 0);
    builder.add(&shape, &Cutting::default())?;
    Ok(Scatterer::new(&builder.build(), |_| Kind::Closed)?.on_sphere(0, Vec3::ZERO, radius))
}

/// Edges around a [`Shape::Sphere`] that keep its edges up to `edge`.
///
/// # Errors
/// [`WaveError::Length`] for an edge that is none.
pub fn sphere_segments(radius: f64, edge: f64) -> Result<usize, WaveError> {
    if !(edge > 0.0 && edge.is_finite()) {
        return Err(WaveError::Length { what: "the largest edge", value: edge });
    }
    // The arc between neighbours of the icosahedron is acos(1/√5); edges exceed their share by less
    // than 1.2 : 1.
    let frequency = (1.2 * radius * 0.2_f64.sqrt().acos() / edge).ceil().clamp(1.0, 1e4);
    Ok(5 * frequency as usize)
}

/// Two thin squares of this side at (∓offset, 0, 0), their normals (±1, −1, 0)/√2: they face each
/// other at a right angle and a wave along +y meets each at 45°.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn facing_plates(side: f64, offset: f64, edge: f64) -> Result<Scatterer, WaveError> {
    let plate = |sign: f64| {
        // Along the plate in the plane z = 0, so that u × z is its normal.
        let u = Vec3::new(1.0, sign, 0.0).normalize() * side;
        let z = Vec3::Z * side;
        quad(Vec3::X * (-sign * offset) - 0.5 * (u + z), u, z)
    };
    scatterer(&[plate(1.0), plate(-1.0)], edge, Kind::Sheet)
}

/// Two thin squares of this side in the planes y = ∓`distance`/2, centred, their normals towards
/// each other.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn parallel_plates(side: f64, distance: f64, edge: f64) -> Result<Scatterer, WaveError> {
    let plate = |sign: f64| {
        let (x, z) = (Vec3::X * (sign * side), Vec3::Z * side);
        quad(Vec3::Y * (0.5 * sign * distance) - 0.5 * (x + z), x, z)
    };
    scatterer(&[plate(1.0), plate(-1.0)], edge, Kind::Sheet)
}

/// Two thin rectangles that share the edge on the z axis, 0 ≤ z ≤ `height`, each `width` wide,
/// `angle` (rad) apart and open towards +x.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn dihedral(width: f64, height: f64, angle: f64, edge: f64) -> Result<Scatterer, WaveError> {
    let side = |half: f64| Vec3::new(half.cos(), half.sin(), 0.0) * width;
    let z = Vec3::Z * height;
    let lower = quad(Vec3::ZERO, z, side(-0.5 * angle));
    let upper = quad(Vec3::ZERO, side(0.5 * angle), z);
    scatterer(&[lower, upper], edge, Kind::Sheet)
}

/// Three thin right triangles in the planes x = 0, y = 0 and z = 0, with sides `side` from the
/// origin along the axes.
///
/// # Errors
/// [`WaveError::Length`] or [`WaveError::Mesh`] for lengths that are none.
pub fn trihedral(side: f64, edge: f64) -> Result<Scatterer, WaveError> {
    let triangle = |u: Vec3, v: Vec3| Shape::Triangle { corners: [Vec3::ZERO, u * side, v * side] };
    let faces = [triangle(Vec3::X, Vec3::Y), triangle(Vec3::Y, Vec3::Z), triangle(Vec3::Z, Vec3::X)];
    scatterer(&faces, edge, Kind::Sheet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn frames_are_orthonormal_and_normals_as_documented() {
        let scatterers = [
            plate(1.0, 0.3).unwrap(),
            cube(1.0, 0.3).unwrap(),
            sphere(1.0, 0.4).unwrap(),
            facing_plates(1.0, 2.0, 0.3).unwrap(),
            dihedral(1.0, 2.0, FRAC_PI_2, 0.5).unwrap(),
            trihedral(1.0, 0.3).unwrap(),
        ];
        for scatterer in &scatterers {
            for facet in scatterer.facets() {
                let [s, t] = facet.tangents;
                assert!((s.cross(t) - facet.normal).length() < 1e-14 && s.dot(t).abs() < 1e-15);
            }
        }
        assert!(scatterers[0].facets().iter().all(|f| (f.normal + Vec3::Y).length() < 1e-15));
        assert!(scatterers[1].facets().iter().all(|f| f.normal.dot(f.centre) > 0.49));
        assert!((scatterers[2].area() - 4.0 * PI).abs() < 1e-12);
        let inward = |f: &super::super::Facet| f.normal.dot(Vec3::new(-f.centre.x, -1.0, 0.0));
        assert!(scatterers[3].facets().iter().all(|f| inward(f) > 0.0));
        let parallel = parallel_plates(1.0, 0.5, 0.3).unwrap();
        assert!(parallel.facets().iter().all(|f| f.normal.y * f.centre.y < -0.24));
        assert!(scatterers[4].facets().iter().all(|f| f.normal.dot(Vec3::X) > 0.7));
        assert!(scatterers[5].facets().iter().all(|f| f.normal.dot(Vec3::ONE) > 0.99));
    }

    #[test]
    fn edges_obey_the_limit() {
        for edge in [0.5, 0.21] {
            for scatterer in [plate(1.0, edge), sphere(1.0, edge), trihedral(1.0, edge)] {
                let longest =
                    scatterer.unwrap().facets().iter().map(super::super::Facet::edge).fold(0.0, f64::max);
                assert!(longest <= edge * (1.0 + 1e-9) && longest > 0.6 * edge, "{longest} of {edge}");
            }
        }
        assert!(matches!(plate(1.0, 0.0), Err(WaveError::Length { .. })));
    }
}

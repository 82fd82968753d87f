//! Faces as files give them, made fit to be meshed: corners that are given twice, faces without
//! area, quads that rounding has bent.

use fredholm_mesh::{Cutting, Flattened, MeshError, Shape, Vec3, flatten};

use crate::check::Finding;

/// Distance of two corners, relative to the longest side, up to which they are one.
const SAME_CORNER_DISTANCE: f64 = 1e-12;
/// Area over the squared longest side up to which a face has none: what is refused as a patch.
const NO_AREA: f64 = 1e-13;

/// Faces fit to be meshed.
#[derive(Debug)]
pub(crate) struct Mended {
    /// The shapes of each face; none of one without area.
    pub shapes: Vec<Vec<Shape>>,
    /// Faces without area, by their numbers.
    pub without_area: Vec<usize>,
    /// What became of faces that are nearly flat.
    pub flattened: Flattened,
}

impl Mended {
    /// Leaves out repeated corners and faces without area, and flattens what is nearly flat.
    pub fn of(mut faces: Vec<Vec<Vec3>>) -> Self {
        faces.iter_mut().for_each(clean);
        let without_area: Vec<usize> = (0..faces.len()).filter(|&k| faces[k].is_empty()).collect();
        let flattened = flatten(&mut faces);
        Self { shapes: faces.iter().map(|corners| shapes(corners)).collect(), without_area, flattened }
    }

    /// Says how many faces were left out, where any was.
    pub fn left_out(&self) -> Option<String> {
        let gone = self.without_area.len();
        (gone > 0).then(|| format!("{gone} faces enclose no area and are left out"))
    }

    /// What became of faces that are nearly flat.
    pub fn findings(&self) -> Vec<Finding> {
        let Flattened { polygons, farthest, left } = self.flattened;
        let moved = format!("now they are flat, and no corner was moved by more than {farthest:.1e} m");
        let bent = "each is two triangles".to_owned();
        let all = [
            Finding { name: "faces that were flat but for rounding", count: polygons, what: moved },
            Finding { name: "nearly flat faces that cannot be flat together", count: left, what: bent },
        ];
        all.into_iter().filter(|finding| finding.count > 0).collect()
    }
}

/// Removes corners that repeat the one before; all of them where what is left encloses no area.
fn clean(corners: &mut Vec<Vec3>) {
    let next = corners.iter().cycle().skip(1);
    let longest = corners.iter().zip(next).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    let same = |a: &Vec3, b: &Vec3| a.distance(*b) <= SAME_CORNER_DISTANCE * longest;
    corners.dedup_by(|b, a| same(a, b));
    while corners.len() > 1 && same(&corners[0], &corners[corners.len() - 1]) {
        corners.pop();
    }
    if is_line(corners, longest) {
        corners.clear();
    }
}

/// Whether all corners lie on one line.
fn is_line(corners: &[Vec3], longest: f64) -> bool {
    let Some(&origin) = corners.first() else { return true };
    let farther = |a: Vec3, b: Vec3| if b.length_squared() > a.length_squared() { b } else { a };
    let along = corners.iter().map(|&p| p - origin).fold(Vec3::ZERO, farther);
    corners.iter().all(|&p| 0.5 * (p - origin).cross(along).length() <= NO_AREA * longest * longest)
}

/// A face as one shape. A convex polygon that is not flat is a fan of triangles.
pub(crate) fn shapes(corners: &[Vec3]) -> Vec<Shape> {
    match *corners {
        [] => vec![],
        [a, b, c] => vec![Shape::Triangle { corners: [a, b, c] }],
        [a, b, c, d] => vec![Shape::Quad { corners: [a, b, c, d], skip: vec![] }],
        _ => {
            let polygon = Shape::Polygon { outline: corners.to_vec(), holes: vec![] };
            match polygon.count(&Cutting::default()) {
                Err(MeshError::NotPlanar { .. }) if is_convex(corners) => fan(corners),
                _ => vec![polygon],
            }
        }
    }
}

fn fan(corners: &[Vec3]) -> Vec<Shape> {
    let triangle = |side: &[Vec3]| Shape::Triangle { corners: [corners[0], side[0], side[1]] };
    corners[1..].windows(2).map(triangle).collect()
}

/// Whether every corner turns left, seen along the area vector.
fn is_convex(corners: &[Vec3]) -> bool {
    let n = corners.len();
    let side = |i: usize| corners[(i + 1) % n] - corners[i % n];
    let normal: Vec3 = (0..n).map(|i| (corners[i] - corners[0]).cross(side(i))).sum();
    (0..n).all(|i| side(i).cross(side(i + 1)).dot(normal) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_corners_go_and_lines_are_left_out() {
        let v = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let faces = vec![
            vec![v(0., 0.), v(0., 0.), v(1., 0.), v(1., 1.)],
            vec![v(0., 0.), v(1., 0.), v(2., 0.), v(3., 0.)],
            vec![v(0., 0.), v(1., 0.), v(1., 0.)],
            vec![v(0., 0.), v(1., 0.), v(1., 1.), v(0., 1.), v(0., 0.)],
            vec![v(0., 0.), v(1., 1.), v(1., 0.), v(0., 1.)],
        ];
        let mended = Mended::of(faces);
        assert_eq!(mended.without_area, [1, 2]);
        assert!(matches!(mended.shapes[0][..], [Shape::Triangle { .. }]));
        assert!(matches!(mended.shapes[3][..], [Shape::Quad { .. }]));
        assert!(mended.shapes[4][0].count(&Cutting::default()).is_err(), "a bow-tie stays to be refused");
        assert_eq!(mended.left_out().as_deref(), Some("2 faces enclose no area and are left out"));
        assert_eq!(mended.findings(), []);
    }
}

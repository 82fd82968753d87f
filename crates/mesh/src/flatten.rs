//! Polygons that are nearly flat, as rounded coordinates make them, become flat.
//!
//! Each corner is moved onto the planes of all flat or nearly flat polygons that share it, by
//! projecting it onto one after the other (S. Kaczmarz, Bull. Int. Acad. Polon. Sci. A 35, 355,
//! 1937), and the planes are fitted anew, until all are flat. Corners at one place move together,
//! so that neighbours stay neighbours, bit for bit. Metres.

use std::collections::HashMap;

use crate::{Bounds, Vec3};

/// Height of a corner over the mean plane, relative to the extent of all polygons, up to which a
/// polygon is nearly flat.
const OF_ALL: f64 = 1e-6;
/// The same, relative to the longest side of the polygon.
const OF_SIDE: f64 = 1e-4;
/// Height, relative to the longest side, up to which a polygon counts as flat: well within what
/// [`Patch`](crate::Patch) asks for.
const FLAT_HEIGHT: f64 = 1e-11;
/// Most fits of the planes, and projections of a corner onto its planes for each.
const MOST_FITS: usize = 200;
const PROJECTIONS_A_FIT: usize = 4;

/// What was done to polygons that are not quite flat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flattened {
    /// Polygons that became flat.
    pub polygons: usize,
    /// Farthest that a corner was moved, m.
    pub farthest: f64,
    /// Nearly flat polygons that could not be made flat together with their neighbours.
    pub left: usize,
}

/// Moves the corners of polygons that are flat within 1e-6 of the extent of all of them, and within
/// 1e-4 of their longest side, so that they are flat to rounding. Corners with the same coordinates
/// stay together. Where nothing is to be done no bit changes.
///
/// ```
/// use fredholm_mesh::{Patch, Vec3, flatten};
///
/// let v = Vec3::new;
/// let mut square = vec![vec![v(0., 0., 0.), v(1., 0., 3e-7), v(1., 1., 0.), v(0., 1., 0.)]];
/// let corners = |polygon: &Vec<Vec3>| [polygon[0], polygon[1], polygon[2], polygon[3]];
/// assert_eq!(Patch::quad(corners(&square[0]))?, None);
/// assert_eq!(flatten(&mut square).polygons, 1);
/// assert!(Patch::quad(corners(&square[0]))?.is_some());
/// # Ok::<(), fredholm_mesh::MeshError>(())
/// ```
pub fn flatten(polygons: &mut [Vec<Vec3>]) -> Flattened {
    let extent = Bounds::around(polygons.iter().flatten().copied()).map_or(0.0, |bounds| bounds.diagonal());
    let forms: Vec<Form> = polygons.iter().map(|polygon| Form::of(polygon, extent)).collect();
    if !forms.contains(&Form::Nearly) {
        return Flattened::default();
    }
    let mut net = Net::new(polygons, &forms);
    let before = net.points.clone();
    net.relax();
    // A corner that runs away from where it was says that no flat shape is near.
    for (was, point) in before.iter().zip(&mut net.points) {
        if was.distance(*point) > 2.0 * OF_ALL * extent {
            *point = *was;
        }
    }
    let moved = before.iter().zip(&net.points).map(|(a, b)| a.distance(*b));
    let mut done = Flattened { farthest: moved.fold(0.0, f64::max), ..Flattened::default() };
    for ((polygon, form), numbers) in polygons.iter_mut().zip(&forms).zip(&net.polygons) {
        for (corner, &number) in polygon.iter_mut().zip(numbers) {
            *corner = net.points[number as usize];
        }
        if *form == Form::Nearly {
            let flat = plane(polygon)
                .is_some_and(|plane| plane.rise(polygon) <= 2.0 * FLAT_HEIGHT * longest(polygon));
            *(if flat { &mut done.polygons } else { &mut done.left }) += 1;
        }
    }
    done
}

/// How flat a polygon is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// A triangle, or a polygon that bends: its corners may be moved as its neighbours need it.
    Free,
    Flat,
    Nearly,
}

impl Form {
    fn of(polygon: &[Vec3], extent: f64) -> Self {
        let Some(plane) = plane(polygon).filter(|_| polygon.len() > 3) else { return Self::Free };
        let (rise, longest) = (plane.rise(polygon), longest(polygon));
        if rise <= FLAT_HEIGHT * longest {
            Self::Flat
        } else if rise <= (OF_ALL * extent).min(OF_SIDE * longest) {
            Self::Nearly
        } else {
            Self::Free
        }
    }
}

/// n·x = c.
struct Plane {
    normal: Vec3,
    offset: f64,
}

impl Plane {
    fn height(&self, point: Vec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// Largest distance of a corner.
    fn rise(&self, polygon: &[Vec3]) -> f64 {
        polygon.iter().map(|&p| self.height(p).abs()).fold(0.0, f64::max)
    }
}

/// The plane through the mean of the corners along the area vector; none where there is no area.
fn plane(polygon: &[Vec3]) -> Option<Plane> {
    let centre = polygon.iter().sum::<Vec3>() / polygon.len() as f64;
    let next = polygon.iter().cycle().skip(1);
    let area: Vec3 = polygon.iter().zip(next).map(|(a, b)| (*a - centre).cross(*b - centre)).sum();
    let normal = area.try_normalize()?;
    Some(Plane { normal, offset: normal.dot(centre) })
}

fn longest(polygon: &[Vec3]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}

/// Polygons over shared corners.
struct Net {
    points: Vec<Vec3>,
    /// Numbers of the corners of every polygon.
    polygons: Vec<Vec<u32>>,
    /// Polygons to be kept or made flat.
    planar: Vec<u32>,
    /// For each corner that may move, its number and those of its polygons among `planar`.
    moving: Vec<(u32, Vec<u32>)>,
}

impl Net {
    fn new(polygons: &[Vec<Vec3>], forms: &[Form]) -> Self {
        let (mut points, mut numbers) = (Vec::new(), HashMap::new());
        let mut number = |point: &Vec3| {
            *numbers.entry((*point + Vec3::ZERO).to_array().map(f64::to_bits)).or_insert_with(|| {
                points.push(*point);
                points.len() as u32 - 1
            })
        };
        let polygons: Vec<Vec<u32>> =
            polygons.iter().map(|polygon| polygon.iter().map(&mut number).collect()).collect();
        // Flat polygons without a corner that moves stay as they are.
        let mut moves = vec![false; points.len()];
        let of = |wanted: Form| forms.iter().zip(&polygons).filter(move |(form, _)| **form == wanted);
        of(Form::Nearly).flat_map(|(_, corners)| corners).for_each(|&corner| moves[corner as usize] = true);
        let mut planar = Vec::new();
        let mut planes_of = vec![Vec::new(); points.len()];
        for (k, corners) in polygons.iter().enumerate() {
            if forms[k] == Form::Free || !corners.iter().any(|&corner| moves[corner as usize]) {
                continue;
            }
            for &corner in corners {
                planes_of[corner as usize].push(planar.len() as u32);
            }
            planar.push(k as u32);
        }
        let moving = planes_of.into_iter().enumerate().filter(|(corner, _)| moves[*corner]);
        let moving = moving.map(|(corner, planes)| (corner as u32, planes)).collect();
        Self { points, polygons, planar, moving }
    }

    fn relax(&mut self) {
        for _ in 0..MOST_FITS {
            let corners = |k: &u32| -> Vec<Vec3> {
                self.polygons[*k as usize].iter().map(|&corner| self.points[corner as usize]).collect()
            };
            let shapes: Vec<Vec<Vec3>> = self.planar.iter().map(corners).collect();
            let planes: Vec<Option<Plane>> = shapes.iter().map(|shape| plane(shape)).collect();
            let flat = |(shape, plane): (&Vec<Vec3>, &Option<Plane>)| {
                plane.as_ref().is_none_or(|plane| plane.rise(shape) <= FLAT_HEIGHT * longest(shape))
            };
            if shapes.iter().zip(&planes).all(flat) {
                return;
            }
            for (corner, own) in &self.moving {
                let point = &mut self.points[*corner as usize];
                for _ in 0..PROJECTIONS_A_FIT {
                    for plane in own.iter().filter_map(|&k| planes[k as usize].as_ref()) {
                        *point -= plane.normal * plane.height(*point);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Patch;

    const SIDES: [[usize; 4]; 6] =
        [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]];

    /// A box turned about an odd axis, its corners rounded to six decimals.
    fn rounded_box(scale: f64) -> Vec<Vec<Vec3>> {
        let turn = glam::DQuat::from_axis_angle(Vec3::new(3.0, -1.0, 2.0).normalize(), 0.7);
        let corner = |k: usize| {
            let p = Vec3::new((k & 1) as f64, 2.0 * ((k >> 1) & 1) as f64, 3.0 * (k >> 2) as f64);
            (turn * (p * scale) * 1e6).round() / 1e6
        };
        SIDES.iter().map(|side| side.iter().map(|&k| corner(k)).collect()).collect()
    }

    fn quad(polygon: &[Vec3]) -> Option<Patch> {
        Patch::quad([polygon[0], polygon[1], polygon[2], polygon[3]]).unwrap()
    }

    #[test]
    fn a_rounded_box_becomes_flat_and_keeps_its_eight_corners() {
        for scale in [0.1, 1.0, 7.3, 1e3] {
            let mut sides = rounded_box(scale);
            let bent = sides.iter().filter(|side| quad(side).is_none()).count();
            assert!(bent >= 4 || scale > 100.0, "{bent}");
            let done = flatten(&mut sides);
            assert!(done.polygons >= bent && done.left == 0 && done.farthest < 2e-6, "{done:?}");
            assert!(sides.iter().all(|side| quad(side).is_some()));
            let mut corners: Vec<[u64; 3]> =
                sides.iter().flatten().map(|p| p.to_array().map(f64::to_bits)).collect();
            corners.sort_unstable();
            corners.dedup();
            assert_eq!(corners.len(), 8);
        }
    }

    #[test]
    fn what_is_flat_or_bends_by_more_keeps_its_bits() {
        let v = Vec3::new;
        let flat = vec![v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.)];
        let bent = vec![v(5., 0., 0.), v(6., 0., 1e-3), v(6., 1., 0.), v(5., 1., 0.)];
        let small = vec![v(9., 0., 0.), v(9.01, 0., 5e-6), v(9.01, 0.01, 0.), v(9., 0.01, 0.)];
        let mut polygons = vec![flat, bent, small];
        let before = polygons.clone();
        assert_eq!(flatten(&mut polygons), Flattened::default());
        assert_eq!(polygons, before);
    }

    #[test]
    fn a_rounded_cylinder_with_polygons_for_caps_stays_closed() {
        let number = 16;
        let point = |i: usize, j: usize| {
            let angle = std::f64::consts::TAU * (i % number) as f64 / number as f64 + 0.1;
            (Vec3::new(
                angle.cos(),
                angle.sin() + 0.312_345_67 * j as f64,
                0.712_345_67 * j as f64 + 0.2 * angle.cos(),
            ) * 1e6)
                .round()
                / 1e6
        };
        let mut sides = vec![
            (0..number).map(|i| point(number - 1 - i, 0)).collect::<Vec<_>>(),
            (0..number).map(|i| point(i, 3)).collect(),
        ];
        for i in 0..number {
            sides.extend(
                (0..3).map(|j| vec![point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]),
            );
        }
        let bent = sides[2..].iter().filter(|side| quad(side).is_none()).count();
        let done = flatten(&mut sides);
        assert!(bent > 10 && done.left == 0 && done.farthest < 3e-6, "{bent} {done:?}");
        assert!(sides[2..].iter().all(|side| quad(side).is_some()));
    }

    #[test]
    fn what_cannot_be_flat_together_is_told() {
        // Two quads over the same four corners, whose planes cross at an angle that is too small to
        // agree on a line.
        let v = Vec3::new;
        let corners = [v(0., 0., 0.), v(1., 0., 1e-7), v(1., 1., 0.), v(0., 1., 2e-7)];
        let mut polygons = vec![corners.to_vec()];
        for (k, apex) in [v(0.5, -1.0, 3e-7), v(2.0, 0.5, 0.0), v(0.5, 2.0, -2e-7)].into_iter().enumerate() {
            polygons.push(vec![corners[k], apex, corners[k + 1], v(0.5, 0.5, 0.0)]);
        }
        let before = polygons.clone();
        let done = flatten(&mut polygons);
        let moved = before.iter().flatten().zip(polygons.iter().flatten()).map(|(a, b)| a.distance(*b));
        assert!(moved.fold(0.0, f64::max) <= done.farthest, "{done:?}");
        assert!(done.farthest < 1e-5 && done.polygons + done.left > 0, "{done:?}");
    }
}

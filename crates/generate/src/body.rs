//! Bodies of flat faces and of curved ones in triangles, and OBJ files of them.

use std::f64::consts::TAU;
use std::fmt::Write;

use glam::{DQuat, DVec3};

use crate::dice::Dice;

/// A body: corners, and faces by the indices of their corners, counter-clockwise seen from outside.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub corners: Vec<DVec3>,
    /// Name of the material of the scene, and corners.
    pub faces: Vec<(&'static str, Vec<usize>)>,
}

impl Body {
    /// A prism over a horizontal quad, counter-clockwise seen from above.
    pub fn prism(base: [DVec3; 4], height: f64, wall: &'static str, top: &'static str) -> Self {
        let up = DVec3::Z * height;
        let corners = base.iter().copied().chain(base.iter().map(|&p| p + up)).collect();
        let mut faces: Vec<_> =
            (0..4).map(|i| (wall, vec![i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4])).collect();
        faces.push((top, vec![4, 5, 6, 7]));
        Self { corners, faces }
    }

    /// A house with a pitched roof over a horizontal quad: the ridge runs between the middles of
    /// the sides 1 and 3.
    pub fn gabled(base: [DVec3; 4], height: f64, rise: f64, wall: &'static str, roof: &'static str) -> Self {
        let mut body = Self::prism(base, height, wall, roof);
        let lift = DVec3::Z * (height + rise);
        body.corners.push(0.5 * (base[1] + base[2]) + lift);
        body.corners.push(0.5 * (base[3] + base[0]) + lift);
        body.faces.pop();
        body.faces[1].1 = vec![1, 2, 6, 8, 5];
        body.faces[3].1 = vec![3, 0, 4, 9, 7];
        body.faces.push((roof, vec![4, 5, 8, 9]));
        body.faces.push((roof, vec![6, 7, 9, 8]));
        body
    }

    /// Closes a prism or a house from below.
    pub fn with_bottom(mut self, material: &'static str) -> Self {
        self.faces.push((material, vec![3, 2, 1, 0]));
        self
    }

    /// A box that is closed from all sides, its sides along the axes.
    pub fn block(size: DVec3, foot: DVec3, material: &'static str) -> Self {
        Self::prism(rectangle(foot, size.x, size.y, 0.0), size.z, material, material).with_bottom(material)
    }

    /// A closed surface of triangles: `rows − 1` rings of `columns` corners between a first and a
    /// last point. `at` gives the corner at a row from 0 to `rows` and a column, and what it gives
    /// runs counter-clockwise with the columns, seen from the last point.
    pub fn round(
        rows: usize,
        columns: usize,
        material: &'static str,
        mut at: impl FnMut(usize, usize) -> DVec3,
    ) -> Self {
        let mut corners = vec![at(0, 0)];
        for row in 1..rows {
            corners.extend((0..columns).map(|column| at(row, column)));
        }
        corners.push(at(rows, 0));
        let ring = |row: usize, column: usize| 1 + (row - 1) * columns + column % columns;
        let last = corners.len() - 1;
        let mut faces = vec![];
        for column in 0..columns {
            faces.push(vec![0, ring(1, column + 1), ring(1, column)]);
            for row in 1..rows - 1 {
                let (a, b) = (ring(row, column), ring(row, column + 1));
                let (c, d) = (ring(row + 1, column + 1), ring(row + 1, column));
                faces.push(vec![a, b, c]);
                faces.push(vec![a, c, d]);
            }
            faces.push(vec![last, ring(rows - 1, column), ring(rows - 1, column + 1)]);
        }
        Self { corners, faces: faces.into_iter().map(|face| (material, face)).collect() }
    }

    /// What a profile of radii and heights sweeps out around the z axis. It begins and ends on the
    /// axis, and what it bounds lies to its left.
    pub fn turned(profile: &[(f64, f64)], columns: usize, material: &'static str) -> Self {
        Self::round(profile.len() - 1, columns, material, |row, column| {
            let (radius, height) = profile[row];
            let (sine, cosine) = (TAU * column as f64 / columns as f64).sin_cos();
            DVec3::new(radius * cosine, radius * sine, height)
        })
    }

    /// A closed tube along a path of at least two points.
    pub fn tube(path: &[DVec3], radius: f64, columns: usize, material: &'static str) -> Self {
        let last = path.len() - 1;
        let along = |i: usize| (path[(i + 1).min(last)] - path[i.saturating_sub(1)]).normalize();
        // A direction across the path that is carried along it, so that the tube is not wrung.
        let mut across = along(0).any_orthonormal_vector();
        let mut frames = vec![];
        for i in 0..=last {
            let axis = along(i);
            across = (across - axis * axis.dot(across)).normalize();
            frames.push((across * radius, axis.cross(across) * radius));
        }
        Self::round(last + 2, columns, material, |row, column| {
            let ring = row.clamp(1, last + 1) - 1;
            if row != ring + 1 {
                return path[ring];
            }
            let (sine, cosine) = (TAU * column as f64 / columns as f64).sin_cos();
            path[ring] + frames[ring].0 * cosine + frames[ring].1 * sine
        })
    }

    /// A cushion: a box of this size about the origin with round edges and corners.
    pub fn cushion(size: DVec3, rows: usize, columns: usize, material: &'static str) -> Self {
        // A superquadric (A. H. Barr, IEEE Computer Graphics and Applications 1, 1981).
        let flat = |x: f64| x.signum() * x.abs().powf(0.35);
        Self::round(rows, columns, material, |row, column| {
            let (sine, cosine) = (TAU * column as f64 / columns as f64).sin_cos();
            let (across, up) = (0.5 * TAU * row as f64 / rows as f64).sin_cos();
            let across = if row == rows { 0.0 } else { flat(across) };
            0.5 * size * DVec3::new(across * flat(cosine), across * flat(sine), -flat(up))
        })
    }

    /// Moves all corners.
    pub fn moved(mut self, to: impl Fn(DVec3) -> DVec3) -> Self {
        for corner in &mut self.corners {
            *corner = to(*corner);
        }
        self
    }

    /// Moves every corner by this length in a random direction. Faces become triangles, since they
    /// are no longer flat.
    pub fn jittered(mut self, length: f64, dice: &mut Dice) -> Self {
        for corner in &mut self.corners {
            *corner += dice.direction() * length;
        }
        self.in_triangles()
    }

    /// Cuts the faces, which are convex, into fans of triangles.
    pub fn in_triangles(mut self) -> Self {
        let fan = |(material, face): &(&'static str, Vec<usize>)| -> Vec<(&'static str, Vec<usize>)> {
            face[1..].windows(2).map(|side| (*material, vec![face[0], side[0], side[1]])).collect()
        };
        self.faces = self.faces.iter().flat_map(fan).collect();
        self
    }
}

/// The corners of a horizontal rectangle about `centre`, its length along the direction at `angle`
/// radians.
pub(crate) fn rectangle(centre: DVec3, length: f64, width: f64, angle: f64) -> [DVec3; 4] {
    let (sine, cosine) = angle.sin_cos();
    let (u, v) = (DVec3::new(cosine, sine, 0.0) * 0.5 * length, DVec3::new(-sine, cosine, 0.0) * 0.5 * width);
    [centre - u - v, centre + u - v, centre + u + v, centre - u + v]
}

/// Turns a point about the z axis, radians, then moves it.
pub(crate) fn placed(p: DVec3, angle: f64, to: DVec3) -> DVec3 {
    DQuat::from_rotation_z(angle) * p + to
}

/// The text of an OBJ file of named objects, each of several bodies; coordinates are rounded to
/// micrometres.
pub(crate) fn wavefront<'a>(objects: impl IntoIterator<Item = (String, &'a [Body])>) -> String {
    let (mut text, mut first) = (String::new(), 1);
    for (name, bodies) in objects {
        let _ = writeln!(text, "o {name}");
        for body in bodies {
            for p in &body.corners {
                let _ = writeln!(text, "v {:.6} {:.6} {:.6}", p.x, p.y, p.z);
            }
        }
        let mut material = "";
        for body in bodies {
            for (own, face) in &body.faces {
                if *own != material {
                    let _ = writeln!(text, "usemtl {own}");
                    material = own;
                }
                let corners: Vec<String> = face.iter().map(|i| (first + i).to_string()).collect();
                let _ = writeln!(text, "f {}", corners.join(" "));
            }
            first += body.corners.len();
        }
    }
    text
}

//! Bodies of flat faces, and OBJ files of them.

use std::fmt::Write;

use glam::DVec3;

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

    /// Moves every corner by this length in a random direction. Faces become fans of triangles,
    /// since they are no longer flat.
    pub fn jittered(mut self, length: f64, dice: &mut Dice) -> Self {
        for corner in &mut self.corners {
            *corner += dice.direction() * length;
        }
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

//! What scenes with furniture share: models in OBJ files, placed many times.

use std::fmt::Write;

use glam::DVec3;

use crate::body::{Body, wavefront};
use crate::files::quad;
use crate::furniture::Piece;

/// A scene file and its models, as they grow.
#[derive(Debug)]
pub(crate) struct Furnished {
    /// Folder of the models beside the scene file.
    folder: &'static str,
    pub scene: String,
    pub models: Vec<(String, String)>,
}

impl Furnished {
    pub fn new(folder: &'static str, head: String) -> Self {
        Self { folder, scene: head, models: vec![] }
    }

    /// Adds a model.
    pub fn model(&mut self, name: &str, piece: Piece) {
        let bodies: Vec<Body> = piece.into_iter().map(Body::in_triangles).collect();
        let text = wavefront([(name.to_owned(), &bodies[..])]);
        self.models.push((format!("{}/{name}.obj", self.folder), text));
    }

    /// Places a model, turned by an angle in degrees about the z axis. `more` has further keys of
    /// the surface, each in a line of its own.
    pub fn place(&mut self, model: &str, name: &str, degrees: f64, to: DVec3, more: &str) {
        let folder = self.folder;
        let turn = if degrees == 0.0 {
            String::new()
        } else {
            format!(" turn = {{ axis = [0, 0, 1], degrees = {} }},", rounded(degrees))
        };
        let to = to.to_array().map(rounded);
        let _ = writeln!(
            self.scene,
            "[[surface]]\nname = \"{name}\"\nobj = {{ file = \"{folder}/{model}.obj\",{turn} translate = {to:?} }}\n{more}"
        );
    }

    /// Adds a rectangle in pieces: counter-clockwise seen from the side that is lit.
    pub fn quad(&mut self, name: &str, material: &str, corners: [DVec3; 4], divide: [usize; 2]) {
        let corners = corners.map(|p| p.to_array().map(rounded));
        let _ = writeln!(self.scene, "{}", quad(name, material, corners, divide));
    }

    /// Adds a wall of height `height` from `from` to `to` on the floor with a window, which lets in
    /// light. It is lit on the left of that way.
    pub fn wall_with_window(&mut self, name: &str, from: DVec3, to: DVec3, height: f64, window: Window) {
        let at = |t: f64, z: f64| (from + (to - from) * t + DVec3::Z * z).to_array().map(rounded);
        let Window { left, right, sill, top } = window;
        // Corners run counter-clockwise as seen from the left.
        let outline = [at(1.0, 0.0), at(0.0, 0.0), at(0.0, height), at(1.0, height)];
        let hole = [at(right, sill), at(right, top), at(left, top), at(left, sill)];
        let _ = writeln!(
            self.scene,
            "[[surface]]\nname = \"{name}\"\nmaterial = \"plaster\"\n\
             polygon = {{ outline = {outline:?}, holes = [{hole:?}] }}\nlargest_edge = 0.8\n"
        );
        let pane = [hole[0], hole[3], hole[2], hole[1]].map(DVec3::from_array);
        self.quad(&format!("{name}_window"), "daylight", pane, [4, 3]);
    }
}

/// Where a window lies in a wall: parts of its length, and heights in m.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub left: f64,
    pub right: f64,
    pub sill: f64,
    pub top: f64,
}

/// To micrometres, so that the text of a number is short.
fn rounded(x: f64) -> f64 {
    (x * 1e6).round() / 1e6 + 0.0
}

/// The materials of furniture and of rooms around it.
pub(crate) const MATERIALS: &str = "\
[materials]
plaster = { reflectance = [0.8, 0.79, 0.76] }
carpet = { reflectance = [0.28, 0.3, 0.34] }
lino = { reflectance = [0.44, 0.42, 0.36] }
oak = { reflectance = [0.55, 0.4, 0.26] }
plywood = { reflectance = [0.62, 0.48, 0.33] }
lacquer = { reflectance = [0.72, 0.72, 0.7] }
steel = { reflectance = [0.5, 0.5, 0.5] }
plastic = { reflectance = [0.08, 0.08, 0.08] }
screen = { reflectance = [0.04, 0.04, 0.05], exitance = [6, 7, 9] }
cloth = { reflectance = [0.12, 0.22, 0.34] }
linen = { reflectance = [0.74, 0.68, 0.56] }
paper = { reflectance = [0.82, 0.81, 0.77] }
red = { reflectance = [0.5, 0.1, 0.08] }
green = { reflectance = [0.12, 0.34, 0.16] }
navy = { reflectance = [0.08, 0.14, 0.32] }
ochre = { reflectance = [0.62, 0.44, 0.14] }
china = { reflectance = [0.78, 0.77, 0.74] }
clay = { reflectance = [0.5, 0.26, 0.16] }
leaf = { reflectance = [0.12, 0.34, 0.08] }
board = { reflectance = [0.05, 0.12, 0.08] }
tube = { reflectance = 0.6, exitance = [170, 165, 150] }
bulb = { reflectance = 0.6, exitance = [900, 700, 420] }
daylight = { reflectance = 0.08, exitance = [20, 24, 30] }
";

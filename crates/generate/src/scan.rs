//! A figure as a scanner gives it: many triangles, creases, noisy normals.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::body::{Body, wavefront};
use crate::dice::Dice;
use crate::files::Files;
use crate::room::shell;

/// Height of the figure, m.
const HEIGHT: f64 = 1.8;
/// Side and height of the room, m.
const ROOM_SIZE: [f64; 3] = [4.0, 4.0, 3.0];

/// A creased figure that stands in a closed room with a lamp.
#[derive(Clone, Debug)]
pub struct Scan {
    /// Most triangles of the figure; as many are made as a grid of rows and columns allows.
    pub triangles: usize,
    /// The same seed gives the same figure.
    pub seed: u64,
    /// How far corners are moved in random directions, in parts of the length of an edge.
    pub noise: f64,
}

impl Default for Scan {
    fn default() -> Self {
        Self { triangles: 20_000, seed: 1, noise: 0.15 }
    }
}

impl Scan {
    /// `scan.toml` and `scan.obj`.
    #[must_use]
    pub fn files(&self) -> Files {
        let figure = self.figure();
        let obj = wavefront([("figure".to_owned(), &[figure][..])]);
        let (triangles, seed, noise) = (self.triangles, self.seed, self.noise);
        let scene = format!(
            "# A generated figure: triangles = {triangles}, seed = {seed}, noise = {noise}.\n\
             title = \"Scanned figure\"\n\n\
             [camera]\neye = [0.4, 0.4, 1.6]\ntarget = [2, 2, 0.9]\nvertical_fov_degrees = 60\n\n\
             [materials.wall]\nreflectance = 0.6\n\n\
             [materials.lamp]\nreflectance = 0.6\nexitance = 20\n\n\
             [materials.plaster]\nreflectance = 0.7\n\n\
             {}\n\
             [[surface]]\nname = \"scan\"\nobj = {{ file = \"scan.obj\" }}\n",
            shell(ROOM_SIZE, 6),
        );
        Files { name: "scan.toml".to_owned(), scene, others: vec![("scan.obj".to_owned(), obj)] }
    }

    fn figure(&self) -> Body {
        let mut dice = Dice::new(self.seed);
        // A closed grid of rows and columns has 2 columns (rows − 1) triangles.
        let columns = ((self.triangles as f64 / 2.0).sqrt() as usize).max(3);
        let rows = (self.triangles / (2 * columns) + 1).max(3);
        let phase = [dice.between(0.0, TAU), dice.between(0.0, TAU)];
        let foot = DVec3::new(0.5 * ROOM_SIZE[0], 0.5 * ROOM_SIZE[1], 0.0);
        let edge = HEIGHT / rows as f64;
        Body::round(rows, columns, "plaster", |row, column| {
            if row == 0 {
                return foot;
            }
            if row == rows {
                return foot + DVec3::Z * HEIGHT;
            }
            let (t, angle) = (row as f64 / rows as f64, TAU * column as f64 / columns as f64);
            let moved = on_figure(t, angle, phase) + dice.direction() * (self.noise * edge);
            // Noise does not push the figure through the floor.
            foot + DVec3::new(moved.x, moved.y, moved.z.max(0.0))
        })
    }
}

/// The figure at a part `t` of its height and an angle, radians: body and head, with folds as of
/// cloth, which are sharp where the absolute value turns.
fn on_figure(t: f64, angle: f64, phase: [f64; 2]) -> DVec3 {
    let bump = |middle: f64, width: f64| (-((t - middle) / width).powi(2)).exp();
    let profile =
        0.24 * bump(0.05, 0.18) + 0.2 * bump(0.35, 0.2) + 0.22 * bump(0.68, 0.1) + 0.12 * bump(0.9, 0.07);
    let closing = (1.0 - (2.0 * t - 1.0).powi(8)).sqrt();
    let upright = (3.5 * angle + phase[0] + 2.0 * (5.0 * t).sin()).sin().abs();
    let slanting = (2.0 * angle + 14.0 * t + phase[1]).sin().abs();
    let radius = profile * closing * (1.0 - 0.2 * upright - 0.15 * slanting);
    DVec3::new(radius * angle.cos(), 0.7 * radius * angle.sin(), HEIGHT * t)
}

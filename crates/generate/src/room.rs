//! Closed rooms, whose balance of energy is known: what is emitted is absorbed, Σ A M = Σ A (1 − ρ)
//! E.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

use glam::DVec3;

use crate::body::{Body, rectangle, wavefront};
use crate::dice::Dice;
use crate::files::Files;

/// Length, width and height, m.
const SIZE: [f64; 3] = [4.0, 3.0, 2.5];
/// Gap between boxes and floor, m: nothing touches, so that nothing but the accuracy disturbs the
/// balance.
const GAP: f64 = 0.1;

/// A closed room with boxes that hover over its floor, all of one reflectance.
#[derive(Clone, Debug)]
pub struct Room {
    /// Reflectance of everything, from 0 to below 1.
    pub reflectance: f64,
    /// Whether everything emits 1 W/m²; then B = M/(1 − ρ) everywhere. Otherwise a lamp in the
    /// ceiling emits.
    pub furnace: bool,
    /// Number of boxes.
    pub boxes: usize,
    /// Pieces along each side of a wall, at least 2.
    pub divide: usize,
    /// The same seed gives the same boxes.
    pub seed: u64,
}

impl Default for Room {
    fn default() -> Self {
        Self { reflectance: 0.9, furnace: false, boxes: 4, divide: 4, seed: 1 }
    }
}

impl Room {
    /// `room.toml`, and `room.obj` where there are boxes.
    #[must_use]
    pub fn files(&self) -> Files {
        let Self { reflectance, furnace, boxes, divide, seed } = *self;
        let exitance = |lamp: f64| if furnace { 1.0 } else { lamp };
        let mut scene = format!(
            "# A generated room: reflectance = {reflectance}, furnace = {furnace}, boxes = {boxes}, divide = {divide}, seed = {seed}.\n\
             title = \"Room\"\n\n\
             [camera]\neye = [0.2, 0.2, 1.6]\ntarget = [2.5, 2, 0.8]\nvertical_fov_degrees = 65\n\n\
             [materials.wall]\nreflectance = {reflectance}\nexitance = {}\n\n\
             [materials.lamp]\nreflectance = {reflectance}\nexitance = {}\n\n{}",
            exitance(0.0),
            exitance(20.0),
            shell(SIZE, divide),
        );
        let mut others = vec![];
        if boxes > 0 {
            scene.push_str("\n[[surface]]\nname = \"boxes\"\nobj = { file = \"room.obj\" }\n");
            others.push(("room.obj".to_owned(), self.boxes()));
        }
        Files { name: "room.toml".to_owned(), scene, others }
    }

    fn boxes(&self) -> String {
        let mut dice = Dice::new(self.seed);
        let across = (self.boxes as f64).sqrt().ceil() as usize;
        let rows = self.boxes.div_ceil(across);
        let cell = (SIZE[0] / across as f64, SIZE[1] / rows as f64);
        let bodies: Vec<Body> = (0..self.boxes)
            .map(|i| {
                let (column, row) = (i % across, i / across);
                let x = (column as f64 + 0.5) * cell.0;
                let y = (row as f64 + 0.5) * cell.1;
                // The diagonal of the base stays within the cell, whatever the turn.
                let diagonal = 0.9 * cell.0.min(cell.1);
                let (sine, cosine) = dice.between(0.3, 1.2).sin_cos();
                let base = rectangle(
                    DVec3::new(x, y, GAP),
                    diagonal * cosine,
                    diagonal * sine,
                    dice.between(0.0, FRAC_PI_2),
                );
                Body::prism(base, dice.between(0.3, 0.8) * (SIZE[2] - GAP), "wall", "wall")
                    .with_bottom("wall")
            })
            .collect();
        wavefront(bodies.iter().enumerate().map(|(i, body)| (format!("box{i}"), std::slice::from_ref(body))))
    }
}

/// The walls of a closed room of the materials `wall` and `lamp`: the lamp is a cell of the
/// ceiling, in its middle.
pub(crate) fn shell(size: [f64; 3], divide: usize) -> String {
    let [x, y, z] = size;
    let walls = [
        ("floor", [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [0.0, y, 0.0]]),
        ("south", [[x, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, z], [x, 0.0, z]]),
        ("east", [[x, y, 0.0], [x, 0.0, 0.0], [x, 0.0, z], [x, y, z]]),
        ("north", [[0.0, y, 0.0], [x, y, 0.0], [x, y, z], [0.0, y, z]]),
        ("west", [[0.0, 0.0, 0.0], [0.0, y, 0.0], [0.0, y, z], [0.0, 0.0, z]]),
        ("ceiling", [[0.0, 0.0, z], [0.0, y, z], [x, y, z], [x, 0.0, z]]),
    ];
    let mut text = String::new();
    for (name, corners) in walls {
        let _ = writeln!(
            text,
            "[[surface]]\nname = \"{name}\"\nmaterial = \"wall\"\nquad = {corners:?}\ndivide = [{divide}, {divide}]"
        );
        let middle = divide / 2;
        let _ = writeln!(
            text,
            "{}",
            if name == "ceiling" { format!("skip = [[{middle}, {middle}]]\n") } else { String::new() }
        );
    }
    let cell = |side: f64, i: usize| side * i as f64 / divide as f64;
    let middle = divide / 2;
    let (west, east) = (cell(x, middle), cell(x, middle + 1));
    let (south, north) = (cell(y, middle), cell(y, middle + 1));
    let lamp = [[west, south, z], [west, north, z], [east, north, z], [east, south, z]];
    let _ = writeln!(text, "[[surface]]\nname = \"lamp\"\nmaterial = \"lamp\"\nquad = {lamp:?}");
    text
}

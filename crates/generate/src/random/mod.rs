//! Random valid input: a scene and a command line for it.
//!
//! The scenes are small but not kind: quads tilted by anything, bodies that touch, coincide and
//! cross, coordinates rounded as files round them, polygons with holes, OBJ files whose quads are
//! not quite flat, several bands, any scale.

mod command;
mod frame;
mod light;
mod shape;
mod waves;

use crate::dice::Dice;
use crate::files::Files;

/// A scene and what is to be done with it.
#[derive(Clone, Debug)]
pub struct Case {
    /// The scene and the files that it names.
    pub files: Files,
    /// Arguments of the program, run in the folder of the files; results go to `out` there.
    pub arguments: Vec<String>,
}

impl Case {
    /// The case of a number.
    #[must_use]
    pub fn random(seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        if dice.chance(0.12) {
            let files = waves::scene(&mut dice);
            let arguments = command::of_waves(&mut dice, &files.name);
            return Self { files, arguments };
        }
        let (files, frame, surfaces) = light::scene(&mut dice);
        let arguments = command::of_light(&mut dice, &files.name, &frame, &surfaces);
        Self { files, arguments }
    }
}

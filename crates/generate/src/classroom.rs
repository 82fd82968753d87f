//! A classroom: rows of desks, chairs of bent tubes, a board, cupboards, radiators and curtains.

use glam::DVec3;

use crate::dice::Dice;
use crate::files::Files;
use crate::furnished::{Furnished, MATERIALS, Window};
use crate::furniture;

/// Length, width and height, m. The board is on the wall at y = 0, windows at x = 0.
const ROOM: DVec3 = DVec3::new(7.0, 8.4, 3.2);

/// A classroom of about 35,000 triangles. Chairs and papers stand a little differently at each
/// desk.
#[derive(Clone, Debug)]
pub struct Classroom {
    /// The same seed gives the same room.
    pub seed: u64,
}

impl Default for Classroom {
    fn default() -> Self {
        Self { seed: 1 }
    }
}

impl Classroom {
    /// `classroom.toml` and the models in `classroom/`.
    #[must_use]
    pub fn files(&self) -> Files {
        let seed = self.seed;
        let mut dice = Dice::new(seed);
        let mut room = Furnished::new(
            "classroom",
            format!(
                "# Shows a classroom with rows of desks and chairs. Made from a number by\n\
                 #     cargo run --release --example generate -- classroom --seed {seed} -o DIR\n\
                 # Lengths in metres, z is up.\n\
                 title = \"Classroom\"\nbands = [\"r\", \"g\", \"b\"]\n\n\
                 [solve]\naccuracy = 0.05\n\n\
                 [camera]\neye = [6.6, 7.9, 1.8]\ntarget = [2.6, 2.6, 0.8]\nvertical_fov_degrees = 60\n\
                 width = 960\nheight = 640\n\n{MATERIALS}\n"
            ),
        );
        models(&mut room, &mut dice);
        shell(&mut room);
        furnish(&mut room, &mut dice);
        Files { name: "classroom.toml".to_owned(), scene: room.scene, others: room.models }
    }
}

fn models(room: &mut Furnished, dice: &mut Dice) {
    room.model("desk", furniture::school_desk());
    room.model("chair", furniture::school_chair());
    room.model("teacher_desk", furniture::desk());
    room.model("teacher_chair", furniture::office_chair());
    room.model("papers", furniture::papers(dice));
    room.model("bookcase", furniture::bookcase(dice));
    room.model("cupboard", furniture::cupboard());
    room.model("globe", furniture::globe());
    room.model("radiator", furniture::radiator());
    room.model("curtain", furniture::curtain());
    room.model("basket", furniture::basket());
    room.model("board", furniture::blackboard());
    room.model("luminaire", furniture::luminaire(0.4));
}

fn shell(room: &mut Furnished) {
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * ROOM;
    let floor = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(1.0, 1.0, 0.0), at(0.0, 1.0, 0.0)];
    room.quad("floor", "lino", floor, [18, 21]);
    let ceiling = [at(0.0, 0.0, 1.0), at(0.0, 1.0, 1.0), at(1.0, 1.0, 1.0), at(1.0, 0.0, 1.0)];
    room.quad("ceiling", "plaster", ceiling, [12, 10]);
    let (south, north) = (
        [at(1.0, 0.0, 0.0), at(0.0, 0.0, 0.0), at(0.0, 0.0, 1.0), at(1.0, 0.0, 1.0)],
        [at(0.0, 1.0, 0.0), at(1.0, 1.0, 0.0), at(1.0, 1.0, 1.0), at(0.0, 1.0, 1.0)],
    );
    room.quad("south", "plaster", south, [12, 6]);
    room.quad("north", "plaster", north, [12, 6]);
    let east = [at(1.0, 1.0, 0.0), at(1.0, 0.0, 0.0), at(1.0, 0.0, 1.0), at(1.0, 1.0, 1.0)];
    room.quad("east", "plaster", east, [14, 6]);
    // Three windows to the west.
    for i in 0..3 {
        let (from, to) = (1.0 - f64::from(i) / 3.0, 1.0 - f64::from(i + 1) / 3.0);
        let window = Window { left: 0.2, right: 0.8, sill: 1.0, top: 2.8 };
        room.wall_with_window(&format!("west_{i}"), at(0.0, from, 0.0), at(0.0, to, 0.0), ROOM.z, window);
    }
}

fn furnish(room: &mut Furnished, dice: &mut Dice) {
    // Pupils look along −y, at the board.
    for row in 0..4 {
        for column in 0..3 {
            let (x, y) = (1.55 + 1.85 * f64::from(column), 2.9 + 1.25 * f64::from(row));
            let name = format!("{row}_{column}");
            room.place("desk", &format!("desk_{name}"), 0.0, DVec3::new(x, y, 0.0), "largest_edge = 0.5\n");
            for (seat, side) in [("left", -1.0), ("right", 1.0)] {
                let to = DVec3::new(
                    x + side * 0.32 + dice.between(-0.05, 0.05),
                    y + 0.42 + dice.between(0.0, 0.15),
                    0.0,
                );
                let turn = dice.between(-15.0, 15.0);
                room.place("chair", &format!("chair_{name}_{seat}"), turn, to, "");
                if dice.chance(0.7) {
                    let to = DVec3::new(x + side * 0.32, y, 0.761);
                    let turn = dice.between(-25.0, 25.0);
                    room.place("papers", &format!("papers_{name}_{seat}"), turn, to, "");
                }
            }
        }
    }
    let half = 180.0;
    let mut put = |model: &str, name: &str, degrees: f64, to: [f64; 3], more: &str| {
        room.place(model, name, degrees, to.into(), more);
    };
    put("teacher_desk", "teacher_desk", half, [5.2, 1.5, 0.0], "largest_edge = 0.5\n");
    put("teacher_chair", "teacher_chair", 12.0, [5.2, 0.75, 0.0], "");
    put("basket", "basket", 0.0, [6.5, 0.5, 0.0], "");
    for (i, y) in [3.3, 4.4, 5.5].into_iter().enumerate() {
        put("bookcase", &format!("bookcase_{i}"), -90.0, [6.82, y, 0.0], "");
    }
    for (i, x) in [1.6, 3.0, 4.4].into_iter().enumerate() {
        put("cupboard", &format!("cupboard_{i}"), 0.0, [x, 8.15, 0.0], "largest_edge = 0.5\n");
    }
    put("board", "board", 180.0, [3.5, 0.0, 0.0], "largest_edge = 0.4\n");
    put("globe", "globe", 0.0, [3.1, 8.12, 1.201], "");
    for i in 0..3 {
        let y = ROOM.y * (f64::from(i) + 0.5) / 3.0;
        put("radiator", &format!("radiator_{i}"), 90.0, [0.12, y, 0.0], "");
        for (side, dy) in [("left", -1.1), ("right", 1.1)] {
            let to = [0.1, y + dy, 0.85];
            put("curtain", &format!("curtain_{i}_{side}"), 90.0, to, "two_sided = true\n");
        }
    }
    for row in 0..4 {
        for column in 0..3 {
            let to = [1.5 + 2.0 * f64::from(column), 1.4 + 1.9 * f64::from(row), ROOM.z - 0.4];
            put("luminaire", &format!("luminaire_{row}_{column}"), 90.0, to, "");
        }
    }
}

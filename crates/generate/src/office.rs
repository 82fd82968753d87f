//! An open-plan office: bays with desks, chairs, shelves of books, plants and lamps.

use glam::DVec3;

use crate::dice::Dice;
use crate::files::Files;
use crate::furnished::{Furnished, MATERIALS, Window};
use crate::furniture;

/// Length, width and height of a bay, m.
const BAY: DVec3 = DVec3::new(7.2, 6.0, 3.0);
/// Different bookcases and plants: bays choose among them.
const KINDS: usize = 3;

/// An open-plan office of equal bays side by side, about 30,000 triangles each. Chairs and lesser
/// things stand a little differently in each bay.
#[derive(Clone, Debug)]
pub struct Office {
    /// Number of bays, at least 1; they fill a rectangle that is as square as may be.
    pub bays: usize,
    /// The same seed gives the same office.
    pub seed: u64,
}

impl Default for Office {
    fn default() -> Self {
        Self { bays: 1, seed: 1 }
    }
}

impl Office {
    /// `office.toml` and the models in `office/`.
    #[must_use]
    pub fn files(&self) -> Files {
        let (bays, seed) = (self.bays.max(1), self.seed);
        let mut dice = Dice::new(seed);
        let across = (bays as f64).sqrt().ceil() as usize;
        let mut office = Furnished::new(
            "office",
            format!(
                "# Shows an open-plan office as programs that model rooms write it. Made from numbers by\n\
                 #     cargo run --release --example generate -- office --bays {bays} --seed {seed} -o DIR\n\
                 # Lengths in metres, z is up.\n\
                 title = \"Office\"\nbands = [\"r\", \"g\", \"b\"]\n\n\
                 [solve]\naccuracy = 0.05\n\n\
                 [camera]\neye = [0.25, 0.3, 1.75]\ntarget = [3.4, 3.1, 0.85]\nvertical_fov_degrees = 62\n\
                 width = 960\nheight = 640\n\n{MATERIALS}\n"
            ),
        );
        models(&mut office, &mut dice);
        for bay in 0..bays {
            let (column, row) = (bay % across, bay / across);
            let corner = DVec3::new(column as f64 * BAY.x, row as f64 * BAY.y, 0.0);
            let name = if bays == 1 { String::new() } else { format!("{bay}_") };
            shell(&mut office, &name, corner);
            // Walls stand where there is no bay beside.
            let walls = [
                ("south", row == 0, [0.0, 0.0], [1.0, 0.0]),
                ("east", column + 1 == across || bay + 1 == bays, [1.0, 0.0], [1.0, 1.0]),
                ("north", bay + across >= bays, [1.0, 1.0], [0.0, 1.0]),
                ("west", column == 0, [0.0, 1.0], [0.0, 0.0]),
            ];
            for (side, stands, from, to) in walls {
                let at = |[x, y]: [f64; 2]| corner + DVec3::new(x * BAY.x, y * BAY.y, 0.0);
                if stands && matches!(side, "east" | "west") {
                    let window = Window { left: 0.25, right: 0.75, sill: 0.9, top: 2.3 };
                    office.wall_with_window(&format!("{name}{side}"), at(from), at(to), BAY.z, window);
                } else if stands {
                    // Seen from inside, the way goes to the right, and the room lies to its left.
                    let (a, b, up) = (at(from), at(to), DVec3::Z * BAY.z);
                    office.quad(&format!("{name}{side}"), "plaster", [b, a, a + up, b + up], [10, 4]);
                }
            }
            furnish(&mut office, &name, corner, &mut dice);
        }
        Files { name: "office.toml".to_owned(), scene: office.scene, others: office.models }
    }
}

fn models(office: &mut Furnished, dice: &mut Dice) {
    office.model("desk", furniture::desk());
    office.model("chair", furniture::office_chair());
    office.model("visitor", furniture::school_chair());
    office.model("table", furniture::round_table());
    office.model("monitor", furniture::monitor());
    office.model("keyboard", furniture::keyboard());
    office.model("mug", furniture::mug());
    office.model("lamp", furniture::desk_lamp());
    office.model("papers", furniture::papers(dice));
    office.model("basket", furniture::basket());
    office.model("luminaire", furniture::luminaire(0.35));
    for kind in 0..KINDS {
        office.model(&format!("bookcase_{kind}"), furniture::bookcase(dice));
        let seed = dice.bits();
        office.model(&format!("pot_{kind}"), furniture::pot(seed));
        office.model(&format!("leaves_{kind}"), furniture::leaves(seed));
    }
}

fn shell(office: &mut Furnished, name: &str, corner: DVec3) {
    let at = |x: f64, y: f64, z: f64| corner + DVec3::new(x * BAY.x, y * BAY.y, z * BAY.z);
    let floor = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(1.0, 1.0, 0.0), at(0.0, 1.0, 0.0)];
    office.quad(&format!("{name}floor"), "carpet", floor, [18, 15]);
    let ceiling = [at(0.0, 0.0, 1.0), at(0.0, 1.0, 1.0), at(1.0, 1.0, 1.0), at(1.0, 0.0, 1.0)];
    office.quad(&format!("{name}ceiling"), "plaster", ceiling, [10, 12]);
}

fn furnish(office: &mut Furnished, bay: &str, corner: DVec3, dice: &mut Dice) {
    let mut put = |model: &str, name: &str, degrees: f64, to: [f64; 3], more: &str| {
        office.place(model, &format!("{bay}{name}"), degrees, corner + DVec3::from_array(to), more);
    };
    // Two desks face two others.
    for (i, (x, y, facing)) in
        [(1.4, 2.55, 0), (3.05, 2.55, 0), (1.4, 3.4, 2), (3.05, 3.4, 2)].iter().enumerate()
    {
        let (x, y, facing) = (*x, *y, *facing);
        let side = if facing == 0 { 1.0 } else { -1.0 };
        let turn = 90.0 * f64::from(facing);
        put("desk", &format!("desk_{i}"), turn, [x, y, 0.0], "largest_edge = 0.5\n");
        let (dx, dy) = (dice.between(-0.15, 0.15), dice.between(0.0, 0.25));
        let chair = [x + dx, y - side * (0.62 + dy), 0.0];
        put("chair", &format!("chair_{i}"), turn + 180.0 + dice.between(-50.0, 50.0), chair, "");
        let top = 0.741;
        let swing = dice.between(-12.0, 12.0);
        put("monitor", &format!("monitor_{i}"), turn + swing, [x, y + side * 0.15, top], "");
        put("keyboard", &format!("keyboard_{i}"), turn, [x, y - side * 0.18, top], "");
        let spot = dice.between(0.42, 0.6);
        put("mug", &format!("mug_{i}"), dice.between(0.0, 360.0), [x + side * spot, y - side * 0.2, top], "");
        let pile = [x - side * 0.55, y - side * 0.1, top];
        put("papers", &format!("papers_{i}"), dice.between(-20.0, 20.0), pile, "");
        if i == 0 || i == 3 {
            let foot = [x - side * 0.6, y + side * 0.2, top];
            put("lamp", &format!("lamp_{i}"), turn + dice.between(-60.0, 20.0), foot, "");
        }
    }
    put("basket", "basket_1", 0.0, [0.42, 2.6, 0.0], "");
    put("basket", "basket_2", 0.0, [4.05, 3.3, 0.0], "");
    // Bookcases stand in a row between the desks and a table with three chairs.
    for i in 0..3 {
        let kind = dice.below(KINDS);
        let to = [4.75, 1.9 + 1.02 * f64::from(i), 0.0];
        put(&format!("bookcase_{kind}"), &format!("bookcase_{i}"), -90.0, to, "");
    }
    let table = [6.1, 3.0];
    put("table", "table", 0.0, [table[0], table[1], 0.0], "");
    for i in 0..3 {
        let angle = 120.0 * f64::from(i) + dice.between(-20.0, 20.0);
        let (sine, cosine) = angle.to_radians().sin_cos();
        let to = [table[0] - 0.72 * sine, table[1] + 0.72 * cosine, 0.0];
        put("visitor", &format!("visitor_{i}"), angle, to, "");
    }
    put("mug", "mug_table", 40.0, [table[0] + 0.2, table[1] - 0.1, 0.736], "");
    for (i, (x, y)) in [(6.7, 0.5), (4.75, 5.4), (0.5, 5.5)].into_iter().enumerate() {
        let (kind, turn) = (dice.below(KINDS), dice.between(0.0, 360.0));
        put(&format!("pot_{kind}"), &format!("pot_{i}"), turn, [x, y, 0.0], "");
        let leaves = "two_sided = true\n";
        put(&format!("leaves_{kind}"), &format!("leaves_{i}"), turn, [x, y, 0.0], leaves);
    }
    for i in 0..3 {
        for (j, y) in [1.2, 4.8].into_iter().enumerate() {
            let to = [1.3 + 2.3 * f64::from(i), y, BAY.z - 0.35];
            put("luminaire", &format!("luminaire_{i}_{j}"), 0.0, to, "");
        }
    }
}

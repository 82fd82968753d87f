//! A city: blocks of houses around courtyards.
//!
//! It has what meshes of real cities have: party walls that coincide, houses that overlap by a
//! little or cross at the corners of a block, sheds that stand turned through the walls of
//! courtyards, walls a hand thick, foundations that go through the ground, some houses closed from
//! below, and with moved corners cracks between everything.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use crate::body::{Body, rectangle, wavefront};
use crate::dice::Dice;
use crate::files::{Files, quad};

/// From the middle of a block to that of the next, m.
const PITCH: f64 = 70.0;
/// Side of a block, m.
const BLOCK: f64 = 54.0;
/// Faces of a block, roughly; it only decides how many blocks stand in a row.
const FACES_OF_A_BLOCK: f64 = 165.0;
/// Height of the sky, m.
const SKY: f64 = 120.0;
/// Faces of the ground and of the sky.
const SURROUNDINGS: usize = 100 + 16 + 4 * 4;

/// A city of touching, overlapping and interpenetrating blocks under a lit sky.
#[derive(Clone, Debug)]
pub struct City {
    /// Most faces in all, sky and ground included; at most six fewer are made.
    pub faces: usize,
    /// The same seed gives the same city.
    pub seed: u64,
    /// How far every corner of a house is moved, m. Above 0, all faces of houses are triangles, and
    /// what touched has cracks between.
    pub jitter: f64,
}

impl Default for City {
    fn default() -> Self {
        Self { faces: 13_000, seed: 1, jitter: 0.0 }
    }
}

impl City {
    /// `city.toml` and `city.obj`.
    #[must_use]
    pub fn files(&self) -> Files {
        let mut dice = Dice::new(self.seed);
        let budget = self.faces.saturating_sub(SURROUNDINGS);
        let faces_of_a_block = if self.jitter > 0.0 { 2.0 } else { 1.0 } * FACES_OF_A_BLOCK;
        let across = ((budget as f64 / faces_of_a_block).sqrt().ceil() as usize).max(1);
        let (mut blocks, mut count, mut full) = (vec![], 0, budget < 6);
        while !full {
            let (row, column) = (blocks.len() / across, blocks.len() % across);
            let middle = DVec3::new(column as f64 + 0.5, row as f64 + 0.5, 0.0) * PITCH;
            let mut bodies = vec![];
            for body in block(middle, &mut dice) {
                let body = if self.jitter > 0.0 { body.jittered(self.jitter, &mut dice) } else { body };
                full = count + body.faces.len() > budget;
                if full {
                    break;
                }
                count += body.faces.len();
                bodies.push(body);
            }
            if !bodies.is_empty() {
                blocks.push(bodies);
            }
        }
        let rows = blocks.len().div_ceil(across).max(1);
        let objects = blocks.iter().enumerate().map(|(i, bodies)| (format!("block{i}"), &bodies[..]));
        let others = vec![("city.obj".to_owned(), wavefront(objects))];
        let has_houses = !blocks.is_empty();
        Files { name: "city.toml".to_owned(), scene: self.scene(across, rows, has_houses), others }
    }

    fn scene(&self, across: usize, rows: usize, has_houses: bool) -> String {
        let (x, y) = (across as f64 * PITCH, rows as f64 * PITCH);
        let houses = if has_houses { HOUSES } else { "" };
        let (faces, seed, jitter) = (self.faces, self.seed, self.jitter);
        format!(
            "# A generated city: faces = {faces}, seed = {seed}, jitter = {jitter}.\n\
             title = \"City\"\n\n\
             [camera]\neye = [{}, {}, 100]\ntarget = [{}, {}, 0]\nvertical_fov_degrees = 55\n\n\
             {MATERIALS}\n\
             {}\n{}\n{}\n{}\n{}\n{}\n{houses}",
            0.05 * x,
            0.05 * y,
            0.6 * x,
            0.6 * y,
            quad("ground", "ground", [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [0.0, y, 0.0]], [10, 10]),
            quad("zenith", "sky", [[0.0, 0.0, SKY], [0.0, y, SKY], [x, y, SKY], [x, 0.0, SKY]], [4, 4]),
            quad("south", "sky", [[x, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, SKY], [x, 0.0, SKY]], [4, 1]),
            quad("east", "sky", [[x, y, 0.0], [x, 0.0, 0.0], [x, 0.0, SKY], [x, y, SKY]], [4, 1]),
            quad("north", "sky", [[0.0, y, 0.0], [x, y, 0.0], [x, y, SKY], [0.0, y, SKY]], [4, 1]),
            quad("west", "sky", [[0.0, 0.0, 0.0], [0.0, y, 0.0], [0.0, y, SKY], [0.0, 0.0, SKY]], [4, 1]),
        )
    }
}

const MATERIALS: &str = "\
[materials.sky]
reflectance = 0
exitance = 1

[materials.ground]
reflectance = 0.2

[materials.plaster]
reflectance = 0.7

[materials.brick]
reflectance = 0.3

[materials.concrete]
reflectance = 0.45

[materials.tiles]
reflectance = 0.25
";

const HOUSES: &str = "[[surface]]\nname = \"houses\"\nobj = { file = \"city.obj\" }\n";

/// The bodies of a block.
fn block(middle: DVec3, dice: &mut Dice) -> Vec<Body> {
    let turn = if dice.chance(0.3) { dice.between(-0.06, 0.06) } else { 0.0 };
    let bottom = dice.chance(0.25);
    let mut bodies: Vec<Body> = (0..4).flat_map(|side| street(middle, turn, side, dice)).collect();
    bodies.extend(courtyard(middle, turn, dice));
    if bottom {
        bodies = bodies.into_iter().map(|body| body.with_bottom("concrete")).collect();
    }
    bodies
}

/// The houses along one side of a block. Those of two sides cross at the corner.
fn street(middle: DVec3, turn: f64, side: usize, dice: &mut Dice) -> Vec<Body> {
    let angle = turn + side as f64 * FRAC_PI_2;
    let (sine, cosine) = angle.sin_cos();
    let (along, inward) = (DVec3::new(cosine, sine, 0.0), DVec3::new(-sine, cosine, 0.0));
    let corner = middle - (along + inward) * 0.5 * BLOCK;
    let (mut houses, mut start) = (vec![], 0.0);
    while start < BLOCK {
        let frontage = dice.between(8.0, 16.0);
        let end = if BLOCK - (start + frontage) < 6.0 { BLOCK } else { start + frontage };
        // Some houses reach a little into the next.
        let reach = if dice.chance(0.4) && end < BLOCK { 0.3 } else { 0.0 };
        let depth = dice.between(10.0, 14.0);
        let length = end + reach - start;
        let centre = corner + along * (start + 0.5 * length) + inward * (0.5 * depth);
        houses.push(house(rectangle(centre, length, depth, angle), dice));
        start = end;
    }
    houses
}

fn house(base: [DVec3; 4], dice: &mut Dice) -> Body {
    let sunk = if dice.chance(0.4) { 0.5 } else { 0.0 };
    let base = base.map(|p| p - DVec3::Z * sunk);
    // Whole storeys: neighbours of the same height have roofs in one plane.
    let height = 3.0 * (3 + dice.below(5)) as f64 + sunk;
    let wall = dice.pick(&["plaster", "brick", "concrete"]);
    if dice.chance(0.4) {
        Body::gabled(base, height, dice.between(2.0, 4.5), wall, "tiles")
    } else {
        Body::prism(base, height, wall, "concrete")
    }
}

/// Thin walls that cut up the courtyard, and sheds that stand in them.
fn courtyard(middle: DVec3, turn: f64, dice: &mut Dice) -> Vec<Body> {
    let mut bodies = vec![];
    for _ in 0..2 + dice.below(4) {
        let angle = turn + dice.below(2) as f64 * FRAC_PI_2;
        let offset = DVec3::new(dice.between(-9.0, 9.0), dice.between(-9.0, 9.0), 0.0);
        let base = rectangle(middle + offset, dice.between(8.0, 26.0), 0.2, angle);
        bodies.push(Body::prism(base, dice.between(1.8, 2.4), "brick", "brick"));
    }
    for _ in 0..=dice.below(2) {
        let offset = DVec3::new(dice.between(-8.0, 8.0), dice.between(-8.0, 8.0), 0.0);
        let (length, width) = (dice.between(3.0, 9.0), dice.between(3.0, 6.0));
        let base = rectangle(middle + offset, length, width, dice.between(0.0, 3.0));
        bodies.push(Body::prism(base, dice.between(2.5, 5.0), "plaster", "tiles"));
    }
    bodies
}

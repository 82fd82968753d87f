//! Random shapes of surfaces, as they are written in scene files, and OBJ files of bodies.

use std::f64::consts::TAU;
use std::fmt::Write;

use glam::{DQuat, DVec3};

use super::frame::{Frame, somewhere, turn};
use crate::dice::Dice;

/// A shape: its key and value, and whether it can be cut by lines, by the same count along both
/// directions, or not.
pub(super) struct Shape {
    pub text: String,
    pub cut: Cut,
    /// Whether it is a thin sheet, which may be lit on both sides.
    pub sheet: bool,
    /// Name and text of the file that it names.
    pub file: Option<(String, String)>,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Cut {
    Lines,
    Counts,
    Triangles,
    No,
}

impl Shape {
    fn new(text: String, cut: Cut, sheet: bool) -> Self {
        Self { text, cut, sheet, file: None }
    }
}

/// A shape that stands in the room; `number` tells its file from others.
pub(super) fn random(dice: &mut Dice, frame: &Frame, on_grid: bool, number: usize) -> Shape {
    match dice.below(12) {
        0..3 => quad(dice, frame, on_grid),
        3 => triangle(dice, frame, on_grid),
        4 => polygon(dice, frame, on_grid),
        5 | 6 => cuboid(dice, frame, on_grid),
        7 => round(dice, frame, on_grid),
        8 => cylinder(dice, frame, on_grid),
        _ => wavefront(dice, frame, on_grid, number),
    }
}

fn size(dice: &mut Dice, on_grid: bool) -> f64 {
    let size = if dice.chance(0.1) { dice.between(1e-3, 0.02) } else { dice.between(0.2, 1.6) };
    if on_grid { (4.0 * size).round().max(1.0) / 4.0 } else { size }
}

/// A tilted parallelogram, sometimes with a corner that is off by a little or by much.
fn quad(dice: &mut Dice, frame: &Frame, on_grid: bool) -> Shape {
    let turn = turn(dice);
    let (a, u, v) = (
        somewhere(dice, on_grid),
        turn * (DVec3::X * size(dice, on_grid)),
        turn * (DVec3::Y * size(dice, on_grid)),
    );
    let mut corners = [a, a + u, a + u + v, a + v];
    if dice.chance(0.3) {
        corners[dice.below(4)] += dice.direction() * 10_f64.powf(dice.between(-10.0, -0.7));
    }
    Shape::new(format!("quad = {}", frame.points(&corners)), Cut::Lines, true)
}

fn triangle(dice: &mut Dice, frame: &Frame, on_grid: bool) -> Shape {
    let a = somewhere(dice, on_grid);
    let corners = [a, a + dice.direction() * size(dice, on_grid), a + dice.direction() * size(dice, on_grid)];
    Shape::new(format!("triangle = {}", frame.points(&corners)), Cut::Triangles, true)
}

/// A star-shaped polygon, sometimes with holes, in a plane along the axes so that rounding leaves
/// it flat.
fn polygon(dice: &mut Dice, frame: &Frame, on_grid: bool) -> Shape {
    let (centre, facing) = (somewhere(dice, on_grid), dice.below(3));
    let axes = [[DVec3::X, DVec3::Y], [DVec3::Y, DVec3::Z], [DVec3::Z, DVec3::X]][facing];
    let radius = size(dice, on_grid);
    let ring = |dice: &mut Dice, middle: DVec3, low: f64, high: f64| -> Vec<DVec3> {
        let count = 3 + dice.below(6);
        let corner = |k: usize| {
            let (sine, cosine) = (TAU * k as f64 / count as f64).sin_cos();
            middle + (axes[0] * cosine + axes[1] * sine) * dice.between(low, high)
        };
        (0..count).map(corner).collect()
    };
    let outline = ring(dice, centre, 0.6 * radius, radius);
    let mut holes = vec![];
    if dice.chance(0.5) {
        holes.push(ring(dice, centre, 0.02 * radius, 0.12 * radius));
    }
    let holes: Vec<String> = holes.iter().map(|hole| frame.points(hole)).collect();
    let text =
        format!("polygon = {{ outline = {}, holes = [{}] }}", frame.points(&outline), holes.join(", "));
    Shape::new(text, Cut::No, true)
}

fn cuboid(dice: &mut Dice, frame: &Frame, on_grid: bool) -> Shape {
    let min = somewhere(dice, on_grid);
    let max = min + DVec3::new(size(dice, on_grid), size(dice, on_grid), size(dice, on_grid));
    let text = format!("box = {{ min = {}, max = {} }}", frame.point(min), frame.point(max));
    Shape::new(text, Cut::Counts, false)
}

fn round(dice: &mut Dice, frame: &Frame, on_grid: bool) -> Shape {
    let (centre, radius) = (frame.point(somewhere(dice, on_grid)), frame.length(0.5 * size(dice, on_grid)));
    let segments = 3 + dice.below(6);
    if dice.chance(0.5) {
        let text =
            format!("sphere = {{ centre = {centre}, radius = {radius:?}, segments = {} }}", segments.min(5));
        return Shape::new(text, Cut::No, false);
    }
    let normal = turn(dice) * DVec3::Z;
    let text = format!(
        "disc = {{ centre = {centre}, normal = {:?}, radius = {radius:?}, segments = {segments} }}",
        normal.to_array()
    );
    Shape::new(text, Cut::No, true)
}

fn cylinder(dice: &mut Dice, frame: &Frame, on_grid: bool) -> Shape {
    let axis = turn(dice) * DVec3::Z * frame.length(size(dice, on_grid));
    let text = format!(
        "cylinder = {{ base = {}, axis = {:?}, radius = {:?}, caps = {}, segments = {} }}",
        frame.point(somewhere(dice, on_grid)),
        axis.to_array(),
        frame.length(0.4 * size(dice, on_grid)),
        dice.chance(0.7),
        3 + dice.below(5),
    );
    Shape::new(text, Cut::No, false)
}

/// An OBJ file of one or two bodies.
fn wavefront(dice: &mut Dice, frame: &Frame, on_grid: bool, number: usize) -> Shape {
    let decimals = dice.pick(&[3, 6, 6, 6, 9]);
    let mut mesh = Mesh { text: String::new(), count: 0, decimals };
    for part in 0..=dice.below(2) {
        let _ = writeln!(mesh.text, "o part{part}");
        let place = Place { centre: somewhere(dice, on_grid), turn: turn(dice) };
        match dice.below(4) {
            0 | 1 => solid(dice, &mut mesh, &place, on_grid),
            2 => soup(dice, &mut mesh, &place),
            _ => sheet(dice, &mut mesh, &place),
        }
    }
    let name = format!("mesh{number}.obj");
    let offset = frame.place(DVec3::ZERO);
    let mut text = format!("obj = {{ file = {name:?}, scale = {:?}, translate = {offset:?}", frame.scale);
    if dice.chance(0.2) {
        let degrees = dice.pick(&[1e-6, 0.001, 30.0, 45.0, 90.0]);
        let _ = write!(text, ", turn = {{ axis = [0, 0.1, 1], degrees = {degrees:?} }}");
    }
    text.push_str(" }");
    Shape { text, cut: Cut::Triangles, sheet: false, file: Some((name, mesh.text)) }
}

struct Place {
    centre: DVec3,
    turn: DQuat,
}

struct Mesh {
    text: String,
    count: usize,
    decimals: usize,
}

impl Mesh {
    fn corner(&mut self, p: DVec3) -> usize {
        let d = self.decimals;
        let _ = writeln!(self.text, "v {:.d$} {:.d$} {:.d$}", p.x, p.y, p.z);
        self.count += 1;
        self.count
    }

    fn face(&mut self, corners: &[usize]) {
        let corners: Vec<String> = corners.iter().map(ToString::to_string).collect();
        let _ = writeln!(self.text, "f {}", corners.join(" "));
    }
}

/// A turned prism of three to six sides, sometimes without a lid, with a face turned round, or a
/// face twice.
fn solid(dice: &mut Dice, mesh: &mut Mesh, place: &Place, on_grid: bool) {
    let sides = dice.pick(&[4, 4, 4, 3, 5, 6]);
    let (radius, height) = (0.6 * size(dice, on_grid), size(dice, on_grid));
    let at = |k: usize, z: f64| {
        let (sine, cosine) = (TAU * (k as f64 + 0.5) / sides as f64).sin_cos();
        place.centre + place.turn * DVec3::new(radius * cosine, radius * sine, z)
    };
    let low: Vec<usize> = (0..sides).map(|k| mesh.corner(at(k, 0.0))).collect();
    let high: Vec<usize> = (0..sides).map(|k| mesh.corner(at(k, height))).collect();
    let mut faces: Vec<Vec<usize>> =
        (0..sides).map(|k| vec![low[k], low[(k + 1) % sides], high[(k + 1) % sides], high[k]]).collect();
    faces.push(high);
    faces.push(low.into_iter().rev().collect());
    if dice.chance(0.15) {
        faces.pop();
    }
    if dice.chance(0.15) {
        let k = dice.below(faces.len());
        faces[k].reverse();
    }
    if dice.chance(0.1) {
        let k = dice.below(faces.len());
        faces.push(faces[k].clone());
    }
    if dice.chance(0.3) {
        let fan = |face: &Vec<usize>| -> Vec<Vec<usize>> {
            face[1..].windows(2).map(|side| vec![face[0], side[0], side[1]]).collect()
        };
        faces = faces.iter().flat_map(fan).collect();
    }
    for face in faces {
        mesh.face(&face);
    }
}

/// Triangles in any position, some of them slivers.
fn soup(dice: &mut Dice, mesh: &mut Mesh, place: &Place) {
    for _ in 0..2 + dice.below(10) {
        let a = place.centre + dice.direction() * 0.5;
        let b = a + dice.direction() * dice.between(0.1, 0.6);
        let thin = 10_f64.powf(dice.between(-5.0, 0.0));
        let c = a.lerp(b, dice.unit()) + dice.direction() * 0.4 * thin;
        let corners = [a, b, c].map(|p| mesh.corner(p));
        mesh.face(&corners);
    }
}

/// A wavy sheet of quads that are not flat.
fn sheet(dice: &mut Dice, mesh: &mut Mesh, place: &Place) {
    let (n, wave) = (2 + dice.below(3), 10_f64.powf(dice.between(-7.0, -0.5)));
    let first = mesh.count + 1;
    for i in 0..=n {
        for j in 0..=n {
            let p = DVec3::new(i as f64, j as f64, 0.0) / n as f64 + DVec3::Z * wave * dice.unit();
            mesh.corner(place.centre + place.turn * p);
        }
    }
    for i in 0..n {
        for j in 0..n {
            let at = |i: usize, j: usize| first + i * (n + 1) + j;
            mesh.face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
}

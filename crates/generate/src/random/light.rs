//! Random scenes of light.

use std::fmt::Write;

use glam::DVec3;

use super::frame::Frame;
use super::shape::{self, Cut, Shape};
use crate::dice::Dice;
use crate::files::Files;

/// Reflectances that rooms have, and those at the ends.
const REFLECTANCES: [f64; 8] = [0.5, 0.2, 0.7, 0.0, 0.9, 0.98, 0.999, 1e-9];

/// A scene, where it stands, and the names of its surfaces.
pub(super) fn scene(dice: &mut Dice) -> (Files, Frame, Vec<String>) {
    let frame = Frame::random(dice);
    let bands = dice.pick(&[1, 1, 1, 2, 3, 16]);
    let mut text = String::new();
    if bands > 1 {
        let names: Vec<String> = (0..bands).map(|band| format!("b{band}")).collect();
        let _ = writeln!(text, "bands = {names:?}");
    }
    if dice.chance(0.2) {
        let _ = writeln!(text, "elements_per_face = {}", dice.pick(&[4, 4, 9]));
    }
    solve(dice, &mut text);
    camera(dice, &frame, &mut text);
    for (name, lit) in [("wall", false), ("thing", false), ("lamp", true)] {
        material(dice, name, lit, bands, &mut text);
    }
    let mut names = vec![];
    let mut others = vec![];
    enclosure(dice, &frame, &mut text, &mut names);
    let on_grid = dice.chance(0.5);
    for number in 0..=dice.below(6) {
        let shape = shape::random(dice, &frame, on_grid, number);
        let name = format!("s{number}");
        let material = if dice.chance(0.25) { "lamp" } else { "thing" };
        surface(dice, &frame, &mut text, (&name, material), &shape);
        // The surfaces of a file have names of their own.
        match shape.file {
            Some(file) => others.push(file),
            None => names.push(name),
        }
    }
    (Files { name: "scene.toml".to_owned(), scene: text, others }, frame, names)
}

fn solve(dice: &mut Dice, text: &mut String) {
    if dice.chance(0.85) {
        return;
    }
    text.push_str("[solve]\n");
    match dice.below(4) {
        0 => text.push_str("accuracy = 0.1\n"),
        1 => text.push_str("form_factor_tolerance = 1e-5\n"),
        2 => text.push_str("solver = \"gmres\"\ntolerance = 1e-6\n"),
        _ => text.push_str("storage = \"f32\"\nmax_iterations = 20\n"),
    }
}

/// A small picture, from inside or outside; sometimes the default.
fn camera(dice: &mut Dice, frame: &Frame, text: &mut String) {
    if dice.chance(0.05) {
        return;
    }
    let eye = DVec3::new(dice.between(-1.0, 5.0), dice.between(-1.0, 4.0), dice.between(-1.0, 4.0));
    let target = DVec3::new(2.0, 1.5, 1.5);
    let _ = writeln!(
        text,
        "[camera]\neye = {}\ntarget = {}\nwidth = {}\nheight = {}\nvertical_fov_degrees = {}",
        frame.point(eye),
        frame.point(target),
        dice.pick(&[32, 24, 1]),
        dice.pick(&[24, 32, 1]),
        dice.pick(&[60.0, 45.0, 2.0, 170.0]),
    );
}

fn material(dice: &mut Dice, name: &str, lit: bool, bands: usize, text: &mut String) {
    let reflectance: Vec<f64> = (0..bands).map(|_| dice.pick(&REFLECTANCES)).collect();
    let _ = writeln!(text, "[materials.{name}]");
    if dice.chance(0.5) {
        let _ = writeln!(text, "reflectance = {:?}", reflectance[0]);
    } else {
        let _ = writeln!(text, "reflectance = {reflectance:?}");
    }
    if lit && dice.chance(0.97) {
        let power = dice.pick(&[1.0, 20.0, 1e-12, 1e9]);
        let exitance: Vec<f64> =
            (0..bands).map(|_| if dice.chance(0.8) { power * dice.unit() } else { 0.0 }).collect();
        let _ = writeln!(text, "exitance = {exitance:?}");
    }
}

/// What closes the scene: mostly a room, with a lamp in it.
fn enclosure(dice: &mut Dice, frame: &Frame, text: &mut String, names: &mut Vec<String>) {
    let (min, max) = (frame.point(DVec3::ZERO), frame.point(DVec3::new(4.0, 3.0, 3.0)));
    let centre = frame.point(DVec3::new(2.0, 1.5, 1.5));
    let mut add = |name: &str, body: String| {
        let _ = writeln!(text, "[[surface]]\nname = \"{name}\"\n{body}");
        names.push(name.to_owned());
    };
    match dice.below(10) {
        0..6 => {
            let divide = 1 + dice.below(3);
            let body = format!(
                "material = \"wall\"\nbox = {{ min = {min}, max = {max}, inward = true }}\ndivide = [{divide}, {divide}]"
            );
            add("room", body);
        }
        6 => {
            let radius = frame.length(3.5);
            let body = format!(
                "material = \"wall\"\nsphere = {{ centre = {centre}, radius = {radius:?}, inward = true, segments = 5 }}"
            );
            add("room", body);
        }
        7 => {
            let corners =
                [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
            add("floor", format!("material = \"wall\"\nquad = {}\ndivide = [3, 2]", frame.points(&corners)));
        }
        8 => {
            let axis = [0.0, 0.0, frame.length(3.0)];
            let radius = frame.length(3.0);
            let base = frame.point(DVec3::new(2.0, 1.5, 0.0));
            let body = format!(
                "material = \"wall\"\ncylinder = {{ base = {base}, axis = {axis:?}, radius = {radius:?}, inward = true, segments = 8 }}"
            );
            add("room", body);
        }
        _ => {}
    }
    // A lamp just below the ceiling, or in its plane.
    let height = dice.pick(&[2.9, 3.0, 2.999_999, 2.5]);
    let corners = [[1.5, 1.0], [1.5, 2.0], [2.5, 2.0], [2.5, 1.0]].map(|[x, y]| DVec3::new(x, y, height));
    add("ceiling_lamp", format!("material = \"lamp\"\nquad = {}", frame.points(&corners)));
}

fn surface(dice: &mut Dice, frame: &Frame, text: &mut String, (name, material): (&str, &str), shape: &Shape) {
    let _ = writeln!(text, "[[surface]]\nname = \"{name}\"\nmaterial = \"{material}\"\n{}", shape.text);
    let n = 1 + dice.below(3);
    match (shape.cut, dice.below(6)) {
        (Cut::Lines, 0) => {
            let _ = writeln!(text, "u_lines = [0, {:?}, 1]", dice.between(0.001, 0.999));
        }
        (Cut::Lines, 1) => text.push_str("divide = [2, 2]\nskip = [[1, 0]]\n"),
        (Cut::Lines, 2) => {
            let _ = writeln!(text, "divide = [{n}, {}]", 1 + dice.below(4));
        }
        (Cut::Counts | Cut::Triangles, 3) => {
            let _ = writeln!(text, "divide = [{n}, {n}]");
        }
        (Cut::Lines | Cut::Counts, 4) => {
            let _ = writeln!(text, "largest_edge = {:?}", frame.length(0.6));
        }
        _ => {}
    }
    if shape.sheet && dice.chance(0.3) {
        text.push_str("two_sided = true\n");
    }
}

//! Random scenes of waves.

use std::fmt::Write;

use glam::DVec3;

use super::frame::turn;
use crate::dice::Dice;
use crate::files::Files;

/// A scene of one or two bodies of a few wavelengths at most, 0.3 m each.
pub(super) fn scene(dice: &mut Dice) -> Files {
    let mut text = String::from("[wave]\nfrequencies_hz = [1e9]\n");
    let closed = dice.chance(0.5);
    let method = if closed {
        dice.pick(&[
            "shadows = \"geometric\"",
            "shadows = \"radiated\"",
            "method = \"mfie\"",
            "method = \"dual-surface-mfie\"",
            "method = \"thesis\"",
        ])
    } else {
        dice.pick(&["shadows = \"geometric\"", "shadows = \"radiated\""])
    };
    let _ = writeln!(text, "{method}");
    match dice.below(3) {
        0 => {
            let _ = writeln!(text, "bounces = {}", 1 + dice.below(3));
        }
        1 => {
            let solver = dice.pick(&["gmres", "neumann", "bicgstab", "lu", "gauss-seidel"]);
            let _ = writeln!(text, "solver = \"{solver}\"\nmax_iterations = 60");
        }
        _ => {}
    }
    if dice.chance(0.2) {
        text.push_str("edge_currents = true\n");
    }
    if dice.chance(0.15) {
        text.push_str("estimate_errors = true\n");
    }
    text.push_str("[materials.coat]\nimpedance_ohm = [50, 20]\n");
    text.push_str("[materials.wall]\nlayers = [{ itu = \"concrete\", thickness_m = 0.1 }]\n");
    for _ in 0..=dice.below(2) {
        source(dice, &mut text);
    }
    for number in 0..=dice.below(2) {
        surface(dice, &mut text, number, closed);
    }
    receivers(dice, &mut text);
    Files { name: "scene.toml".to_owned(), scene: text, others: vec![] }
}

fn source(dice: &mut Dice, text: &mut String) {
    let far = (dice.direction() * dice.between(0.8, 2.0)).to_array();
    let axis = dice.pick(&[DVec3::X, DVec3::Z, DVec3::new(1.0, 1.0, 0.3)]).to_array();
    let _ = match dice.below(5) {
        0 | 1 => writeln!(
            text,
            "[[source]]\nkind = \"plane-wave\"\nfrom_theta_degrees = {:?}\nfrom_phi_degrees = {:?}\npolarisation = \"{}\"",
            dice.between(0.0, 180.0).round(),
            dice.between(0.0, 360.0).round(),
            dice.pick(&["theta", "phi"]),
        ),
        2 => {
            writeln!(text, "[[source]]\nkind = \"plane-wave\"\ntravel = [0, 1, 0]\npolarisation = [0, 0, 1]")
        }
        3 => writeln!(
            text,
            "[[source]]\nkind = \"half-wave-dipole\"\nposition = {far:?}\naxis = {axis:?}\ncurrent_a = 0.1"
        ),
        _ => writeln!(
            text,
            "[[source]]\nkind = \"hertzian-dipole\"\nposition = {far:?}\naxis = {axis:?}\nmoment_a_m = 0.01"
        ),
    };
}

fn surface(dice: &mut Dice, text: &mut String, number: usize, closed: bool) {
    let (middle, size) = (dice.direction() * dice.between(0.0, 0.4), dice.between(0.05, 0.3));
    let edge = dice.pick(&["lambda/4", "lambda/6", "lambda/3"]);
    let _ = writeln!(text, "[[surface]]\nname = \"s{number}\"\nedge = \"{edge}\"");
    if !closed || dice.chance(0.2) {
        let material = dice.pick(&["conductor", "conductor", "coat", "wall"]);
        let _ = writeln!(text, "material = \"{material}\"");
    }
    let half = DVec3::splat(size);
    if closed && dice.chance(0.4) {
        let _ = writeln!(text, "sphere = {{ centre = {:?}, radius = {size:?} }}", middle.to_array());
    } else if closed {
        let (min, max) = ((middle - half).to_array(), (middle + half).to_array());
        let _ = writeln!(text, "box = {{ min = {min:?}, max = {max:?} }}");
    } else {
        let turn = turn(dice);
        let (u, v) = (turn * (DVec3::X * size), turn * (DVec3::Y * 0.7 * size));
        let corners = [middle - u - v, middle + u - v, middle + u + v, middle - u + v].map(|p| p.to_array());
        let _ = writeln!(text, "quad = {corners:?}");
    }
}

fn receivers(dice: &mut Dice, text: &mut String) {
    for number in 0..=dice.below(3) {
        let _ = writeln!(text, "[[receiver]]\nname = \"r{number}\"");
        let _ = match dice.below(6) {
            0 => writeln!(text, "points = [[0, -1, 0], {:?}]", (dice.direction() * 0.3).to_array()),
            1 => writeln!(text, "line = {{ from = [-1, 0.01, 0], to = [1, 0.02, 0.1], points = 9 }}"),
            2 => writeln!(
                text,
                "circle = {{ centre = [0, 0, 0], radius = 3, normal = [0, 0, 1], start = [1, 0, 0], points = 12 }}"
            ),
            3 => writeln!(
                text,
                "grid = {{ corner = [-0.5, -0.5, 0.1], u = [1, 0, 0], v = [0, 1, 0], columns = 6, rows = 5 }}"
            ),
            4 => writeln!(
                text,
                "far = {{ theta_degrees = 90, phi_degrees = {{ from = 0, to = 350, points = 12 }} }}"
            ),
            _ => writeln!(
                text,
                "monostatic = {{ theta_degrees = [60, 90], phi_degrees = {{ from = 0, to = 90, points = 3 }} }}"
            ),
        };
    }
}

//! Runs by defaults beside exact answers that had no part in the calibration, and the NASA almond
//! by every method.
//!
//!     cargo test --release -p fredholm-study --test known_answers -- --ignored --nocapture

#![allow(clippy::unwrap_used, reason = "tests may panic")]

mod known;

use std::fs;
use std::path::Path;

use fredholm_generate::{Almond, Dice};
use fredholm_mesh::Vec3;
use fredholm_study::{Quiet, SolvedWaves, WaveOptions, waves};

use known::wave_cases::{Body, Case, error};
use known::{directions, far, scene, solved};

/// A direction, all equally likely.
fn direction(dice: &mut Dice) -> Vec3 {
    loop {
        let p = Vec3::new(dice.between(-1.0, 1.0), dice.between(-1.0, 1.0), dice.between(-1.0, 1.0));
        if p.length_squared() > 0.01 && p.length_squared() < 1.0 {
            return p.normalize();
        }
    }
}

/// Two directions across each other.
fn frame(dice: &mut Dice) -> [Vec3; 2] {
    let u = direction(dice);
    [u, direction(dice).reject_from(u).normalize()]
}

/// A rectangle at a place, turned at random; sides in wavelengths.
fn plate(dice: &mut Dice, corner: Vec3) -> [Vec3; 3] {
    let [u, v] = frame(dice);
    [corner, u * dice.between(0.3, 1.4), v * dice.between(0.3, 1.4)]
}

/// A body of one of five kinds, and its name.
fn body(dice: &mut Dice, kind: usize) -> (&'static str, Body) {
    match kind {
        0 => ("plate", Body::Plates(vec![plate(dice, Vec3::ZERO)])),
        1 => {
            // The second plate opens from the first one's side by 40° to 140°.
            let [corner, along, across] = plate(dice, Vec3::ZERO);
            let (sin, cos) = dice.between(40.0, 140.0).to_radians().sin_cos();
            let normal = along.cross(across).normalize();
            let size = dice.between(0.3, 1.4);
            let other = (across.normalize() * cos + normal * sin) * size;
            ("dihedral", Body::Plates(vec![[corner, along, across], [corner, other, along]]))
        }
        2 => {
            let first = plate(dice, Vec3::ZERO);
            // Apart by more than the two reach.
            let away = first[1].cross(first[2]).normalize() * dice.between(0.3, 1.0);
            let [u, v] = [first[1].normalize(), first[2].normalize()];
            let second =
                [away + u * dice.between(-0.5, 0.5), u * dice.between(0.3, 1.4), v * dice.between(0.3, 1.4)];
            ("pair of plates", Body::Plates(vec![first, second]))
        }
        3 => (
            "box",
            Body::Box(Vec3::new(dice.between(0.3, 1.0), dice.between(0.3, 1.0), dice.between(0.3, 1.0))),
        ),
        _ => ("sphere", Body::Sphere(dice.between(0.15, 0.7))),
    }
}

/// 60 random bodies in random waves, with nothing said but the body: the stated error beside the
/// true one.
#[test]
#[ignore = "takes minutes"]
fn stated_errors_hold_by_defaults() {
    let mut dice = Dice::new(2_026);
    let folder = tempfile::tempdir().unwrap();
    let u = directions();
    let mut ratios = Vec::new();
    for run in 0..60 {
        let (name, body) = body(&mut dice, run % 5);
        let [travel, along] = frame(&mut dice);
        let case = Case { name, body, travel, polarisation: along };
        let (per, halvings) = if matches!(case.body, Body::Box(_)) { (14.0, 1) } else { (12.0, 2) };
        let truth = case.truth(&u, per, halvings);
        let found = solved(folder.path(), &scene(&case, ""));
        let stated = found.stated_errors()[0].relative;
        let truth = error(&far(&found), &truth);
        println!("{name:<15} {:<30} stated {stated:.4} true {truth:.4}", found.method());
        ratios.push(stated / truth);
    }
    ratios.sort_by(f64::total_cmp);
    let held = ratios.iter().filter(|&&ratio| ratio >= 1.0).count();
    println!(
        "{held} of {} hold, median {:.2}, least {:.2}",
        ratios.len(),
        ratios[ratios.len() / 2],
        ratios[0]
    );
    assert!(20 * held >= 19 * ratios.len() && ratios[ratios.len() / 2] < 4.0);
}

/// S_θθ and S_φφ (m) of the 181 angles.
struct Sweep {
    scattering: [Vec<[f64; 2]>; 2],
    stated: Option<f64>,
}

impl Sweep {
    fn of(found: &SolvedWaves<'_>) -> Self {
        let pick = |part: usize| found.monostatic().iter().map(|row| row.scattering[part]).collect();
        let stated = found.stated_errors().first().map(|error| error.relative);
        Self { scattering: [pick(0), pick(3)], stated }
    }

    /// (a − b)/(q − 1) beyond a: what the finer of two meshes whose errors are as q : 1 tends to.
    fn beyond(&self, coarse: &Self, q: f64) -> Self {
        let part = |i: usize| {
            let pairs = self.scattering[i].iter().zip(&coarse.scattering[i]);
            pairs.map(|(a, b)| [0, 1].map(|c| a[c] + (a[c] - b[c]) / (q - 1.0))).collect()
        };
        Self { scattering: [part(0), part(1)], stated: None }
    }

    /// ‖a − b‖₂/‖b‖₂ and the largest difference of σ (dB) where it is above −60 dBsm, of a
    /// polarisation.
    fn gap(&self, truth: &Self, part: usize) -> (f64, f64) {
        let (mut gap, mut size, mut most) = (0.0, 0.0, 0.0_f64);
        for (a, b) in self.scattering[part].iter().zip(&truth.scattering[part]) {
            gap += (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
            size += b[0] * b[0] + b[1] * b[1];
            if level(*b) > -60.0 {
                most = most.max((level(*a) - level(*b)).abs());
            }
        }
        ((gap / size).sqrt(), most)
    }
}

/// σ, dBsm.
fn level([re, im]: [f64; 2]) -> f64 {
    10.0 * (4.0 * std::f64::consts::PI * (re * re + im * im)).log10()
}

/// The almond by a method, with edges of so many mm, in one sweep.
fn almond(folder: &Path, frequency: f64, edge: f64, method: &str) -> Sweep {
    let files = Almond { frequency, edge: Some(1e-3 * edge) }.files();
    let path = files.write(folder).unwrap();
    if !method.is_empty() {
        let text = files.scene.replacen("[wave]", &format!("[wave]\nmethod = \"{method}\""), 1);
        fs::write(&path, text).unwrap();
    }
    let found = waves(&path, &WaveOptions { no_report: true, ..WaveOptions::default() }, &Quiet).unwrap();
    println!("  {method} {edge} mm: {}, reciprocity {:.1e}", found.method(), found.reciprocity()[0].defect);
    Sweep::of(&found)
}

/// Every method on the NASA almond, against two formulations on two meshes each, extrapolated.
fn almond_by_every_method(frequency: f64, [coarse, fine]: [f64; 2]) {
    let folder = tempfile::tempdir().unwrap();
    // Facets inside the surface, and currents constant along them: second order in the edge.
    let q = (coarse / fine) * (coarse / fine);
    println!("{} GHz", frequency / 1e9);
    let run = |edge: f64, method: &str| almond(folder.path(), frequency, edge, method);
    let [electric, combined] = ["efie", "cfie"].map(|method| [coarse, fine].map(|edge| run(edge, method)));
    let truth = electric[1].beyond(&electric[0], q);
    let tell = |name: &str, sweep: &Sweep| {
        let [vv, hh] = [0, 1].map(|part| sweep.gap(&truth, part));
        let stated = sweep.stated.map(|stated| format!(", stated {stated:.4}")).unwrap_or_default();
        println!("  {name}: VV {:.4} {:.2} dB, HH {:.4} {:.2} dB{stated}", vv.0, vv.1, hh.0, hh.1);
        vv.0.max(hh.0)
    };
    let apart = tell("cfie, extrapolated", &combined[1].beyond(&combined[0], q));
    for (name, pair) in [("efie", &electric), ("cfie", &combined)] {
        tell(&format!("{name}, {coarse} mm"), &pair[0]);
        tell(&format!("{name}, {fine} mm"), &pair[1]);
    }
    for method in ["dual-surface-mfie", "mfie", "physical-optics", ""] {
        let name = if method.is_empty() { "unasked" } else { method };
        tell(&format!("{name}, {coarse} mm"), &run(coarse, method));
    }
    for angle in [0, 45, 90, 135, 180] {
        let [vv, hh] = [0, 1].map(|part| level(truth.scattering[part][angle]));
        println!("  {angle}°: {vv:.1} {hh:.1} dBsm");
    }
    // The two formulations, extrapolated, are one answer.
    assert!(apart < 0.05, "{apart}");
}

#[test]
#[ignore = "takes minutes"]
fn almond_at_1_ghz() {
    almond_by_every_method(1e9, [8.0, 5.5]);
}

#[test]
#[ignore = "takes minutes"]
fn almond_at_3_5_ghz() {
    almond_by_every_method(3.5e9, [8.0, 5.5]);
}

/// The wavelength is 43 mm here, so that the meshes are finer.
#[test]
#[ignore = "takes some ten minutes"]
fn almond_at_7_ghz() {
    almond_by_every_method(7e9, [5.5, 4.0]);
}

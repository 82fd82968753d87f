//! Random command lines: every command, with switches that suit it.

use glam::DVec3;

use super::frame::{Frame, somewhere};
use crate::dice::Dice;

const SOLVERS: [&str; 28] = [
    "gauss-seidel",
    "neumann",
    "jacobi",
    "sor",
    "sur",
    "ssor",
    "southwell",
    "progressive",
    "group-shooting",
    "block-jacobi",
    "block-gauss-seidel",
    "cg-psi",
    "cg-theta",
    "pcg-jacobi",
    "pcg-ssor",
    "pcg-ic",
    "chebyshev",
    "minres",
    "gmres",
    "bicgstab",
    "anderson",
    "hgs1",
    "hgs2",
    "hybrid",
    "lu",
    "lu-mixed",
    "ldlt",
    "cholesky",
];

const DISCRETISATIONS: [&str; 17] = [
    "galerkin-0",
    "galerkin-1",
    "galerkin-1-conforming",
    "galerkin-2",
    "galerkin-2-conforming",
    "collocation-0",
    "collocation-1",
    "collocation-2",
    "nystrom-1",
    "nystrom-2",
    "nystrom-3",
    "least-squares-0",
    "least-squares-1",
    "least-squares-2",
    "degenerate-kernel-0",
    "degenerate-kernel-1",
    "degenerate-kernel-2",
];

/// Methods of form factors, with settings that are quick.
const METHODS: [(&str, Option<&str>); 10] = [
    ("centre", None),
    ("disc", None),
    ("area-gauss", Some("2")),
    ("nystrom", Some("2")),
    ("contour", Some("1e-3")),
    ("point-polygon", Some("1e-3")),
    ("schroeder-hanrahan", None),
    ("monte-carlo", Some("16")),
    ("hemicube", Some("16")),
    ("auto", None),
];

const TRACERS: [&str; 7] =
    ["path", "light", "bidirectional", "photon", "walk-gathering", "walk-shooting", "jacobi"];

/// A command line in the making.
struct Line(Vec<String>);

impl Line {
    fn new(verb: &str, scene: &str) -> Self {
        Self(vec![verb.to_owned(), scene.to_owned()])
    }

    fn with(&mut self, words: &[&str]) {
        self.0.extend(words.iter().map(|&word| word.to_owned()));
    }
}

/// A command for a scene of light.
pub(super) fn of_light(dice: &mut Dice, scene: &str, frame: &Frame, surfaces: &[String]) -> Vec<String> {
    let verb = match dice.below(20) {
        0..4 => "solve",
        4..10 => return to_accuracy(dice, scene, frame, surfaces).0,
        10..13 => return view_factors(dice, scene, frame).0,
        13 | 14 => "shoot",
        15 => "trace",
        16 => dice.pick(&["crosscheck", "reference"]),
        17 => "converge",
        18 => "compare",
        _ => dice.pick(&["check", "spectrum"]),
    };
    let mut line = Line::new(verb, scene);
    if verb != "check" {
        line.with(&["-o", "out"]);
    }
    match verb {
        "solve" => {
            problem(dice, &mut line);
            line.with(&["--max-iterations", "300"]);
            places(dice, frame, &mut line);
        }
        "shoot" => line.with(&["--share", dice.pick(&["90%", "99%", "0.5"]), "--max-shots", "400"]),
        "trace" => {
            line.with(&["--method", dice.pick(&TRACERS), "--samples", "8", "--seed", "7"]);
            if dice.chance(0.2) {
                line.with(&[
                    "--points",
                    dice.pick(&["independent", "jittered", "n-rooks", "multi-jittered"]),
                ]);
            }
        }
        "crosscheck" => line.with(&["--method", dice.pick(&TRACERS), "--samples", "16"]),
        "reference" => line.with(&["--samples", "8"]),
        "converge" => line.with(&["--levels", "2"]),
        "compare" => {
            let solvers = format!("{},{},gauss-seidel", dice.pick(&SOLVERS), dice.pick(&SOLVERS));
            line.with(&["--solvers", &solvers, "--max-iterations", "200"]);
        }
        "check" => problem(dice, &mut line),
        _ => line.with(&["--dense", dice.pick(&["0", "500"]), "--steps", "20"]),
    }
    if verb != "compare" && dice.chance(0.03) {
        line.with(&["--memory", dice.pick(&["15MB", "40MB", "100MB"])]);
    }
    threads(dice, &mut line);
    line.0
}

fn threads(dice: &mut Dice, line: &mut Line) {
    line.with(&["--threads", dice.pick(&["1", "1", "2"])]);
}

/// Switches of the problem of a matrix.
fn problem(dice: &mut Dice, line: &mut Line) {
    if dice.chance(0.4) {
        line.with(&["--solver", dice.pick(&SOLVERS)]);
    }
    if dice.chance(0.3) {
        line.with(&["--discretisation", dice.pick(&DISCRETISATIONS)]);
    }
    if dice.chance(0.3) {
        line.with(&["--form-factor-tolerance", dice.pick(&["1e-1", "1e-2", "1e-4"])]);
    }
    if dice.chance(0.2) {
        line.with(&["--storage", "f32"]);
    }
}

fn to_accuracy(dice: &mut Dice, scene: &str, frame: &Frame, surfaces: &[String]) -> Line {
    let mut line = Line::new("solve", scene);
    line.with(&["-o", "out", "--accuracy", dice.pick(&["50%", "20%", "20%", "10%"])]);
    if dice.chance(0.4) {
        line.with(&["--discontinuity"]);
    }
    if dice.chance(0.3) {
        line.with(&["--final-gather"]);
    }
    if dice.chance(0.15) {
        line.with(&["--goal", &surfaces[dice.below(surfaces.len())]]);
    }
    if dice.chance(0.05) {
        line.with(&["--memory", dice.pick(&["15MB", "40MB"])]);
    }
    places(dice, frame, &mut line);
    threads(dice, &mut line);
    line
}

/// Places where the irradiance is gathered, some of them on walls and in corners.
fn places(dice: &mut Dice, frame: &Frame, line: &mut Line) {
    if dice.chance(0.8) {
        return;
    }
    let on_grid = dice.chance(0.5);
    let point = if dice.chance(0.3) { DVec3::new(0.0, 1.0, 0.0) } else { somewhere(dice, on_grid) };
    let normal = if dice.chance(0.5) { DVec3::Z } else { dice.direction() };
    let numbers = frame.place(point).into_iter().chain(normal.to_array()).map(|x| x.to_string());
    line.with(&["--point", &numbers.collect::<Vec<_>>().join(",")]);
    let corner = frame.place(somewhere(dice, on_grid));
    let (u, v) = ([frame.length(1.0), 0.0, 0.0], [0.0, frame.length(0.5), 0.0]);
    let numbers = corner.into_iter().chain(u).chain(v).map(|x| x.to_string());
    line.with(&["--plane", &format!("{},3,2", numbers.collect::<Vec<_>>().join(","))]);
}

fn view_factors(dice: &mut Dice, scene: &str, frame: &Frame) -> Line {
    let mut line = Line::new("viewfactors", scene);
    line.with(&["-o", dice.pick(&["out/F.npz", "out/F.csv", "out/F.txt"])]);
    if dice.chance(0.5) {
        let (method, setting) = dice.pick(&METHODS);
        line.with(&["--method", method]);
        if let Some(setting) = setting {
            line.with(&["--setting", setting]);
        }
    } else {
        line.with(&["--tolerance", dice.pick(&["1e-1", "1e-2", "1e-3", "1e-4"])]);
    }
    line.with(&["--rows", dice.pick(&["element", "face", "surface"])]);
    if dice.chance(0.25) {
        line.with(&["--close"]);
    }
    if dice.chance(0.25) {
        line.with(&["--sky"]);
    }
    if dice.chance(0.2) {
        line.with(&["--threshold", "1e-4"]);
    }
    places(dice, frame, &mut line);
    threads(dice, &mut line);
    line
}

/// A command for a scene of waves.
pub(super) fn of_waves(dice: &mut Dice, scene: &str) -> Vec<String> {
    let verb = dice.pick(&["waves", "waves", "waves", "waves", "trace", "crosscheck"]);
    let mut line = Line::new(verb, scene);
    line.with(&["-o", "out"]);
    match verb {
        "waves" if dice.chance(0.2) => {
            line.with(&["--compare", "gmres,neumann,bicgstab", "--max-iterations", "50"]);
        }
        "waves" => {}
        _ => {
            let method = dice.pick(&["surface-sampling", "field-particles", "amplitude-particles"]);
            line.with(&["--method", method, "--samples", "4096"]);
        }
    }
    threads(dice, &mut line);
    line.0
}

//! Curved objects of many triangles in a room, as scene files.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// A place on a surface, m, from two parameters in [0, 1].
type Surface = fn(f64, f64) -> [f64; 3];

/// A ball of radius 0.5 m with bumps of a twentieth of that.
fn ball(u: f64, v: f64) -> [f64; 3] {
    let (longitude, colatitude) = (TAU * u, PI * v);
    let radius = 0.5 * (1.0 + 0.05 * (6.0 * longitude).sin() * (5.0 * colatitude).sin() * colatitude.sin());
    let across = radius * colatitude.sin();
    [across * longitude.cos(), across * longitude.sin(), radius * colatitude.cos()]
}

/// A ring of radii 0.6 m and 0.2 m, tilted: parts of it see each other.
fn ring(u: f64, v: f64) -> [f64; 3] {
    let (long, short) = (TAU * u, -TAU * v);
    let across = 0.6 + 0.2 * short.cos();
    let [x, y, z] = [across * long.cos(), across * long.sin(), 0.2 * short.sin()];
    [x, 0.8 * y - 0.6 * z, 0.6 * y + 0.8 * z]
}

/// A bowl, open above: half a hollow ball of radius 0.6 m, its walls 0.06 m thick.
fn bowl(u: f64, v: f64) -> [f64; 3] {
    let (longitude, around) = (TAU * u, 2.0 * v);
    let (radius, colatitude) =
        if around < 1.0 { (0.54, PI * (1.0 - 0.5 * around)) } else { (0.6, 0.5 * PI * around) };
    let across = radius * colatitude.sin();
    [across * longitude.cos(), across * longitude.sin(), 0.3 + radius * colatitude.cos()]
}

/// A named object as a Wavefront OBJ of about `count` triangles; none of another name.
pub fn object(name: &str, count: usize) -> Option<String> {
    let surface: Surface = match name {
        "ball" => ball,
        "ring" => ring,
        "bowl" => bowl,
        _ => return None,
    };
    let rows = ((count as f64 / 4.0).sqrt().round() as usize).max(3);
    let columns = 2 * rows;
    let mut text = String::new();
    for i in 0..=rows {
        for j in 0..columns {
            let [x, y, z] = surface(j as f64 / columns as f64, i as f64 / rows as f64);
            let _ = writeln!(text, "v {x:.12} {y:.12} {z:.12}");
        }
    }
    let corner = |i: usize, j: usize| i * columns + j % columns + 1;
    for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        // At a pole a row of corners is one point.
        let (north, south) = (name != "ring" && i == 0, name != "ring" && i + 1 == rows);
        if !south {
            let _ = writeln!(text, "f {a} {b} {c}");
        }
        if !north {
            let _ = writeln!(text, "f {a} {c} {d}");
        }
    }
    Some(text)
}

/// A room of 4 × 4 × 3 m with a bright ceiling and the object of a file in it.
pub fn room_with(file: &str) -> String {
    let wall = |name: &str, material: &str, corners: &str, divide: &str| {
        format!(
            "[[surface]]\nname = \"{name}\"\nmaterial = \"{material}\"\nquad = {corners}\ndivide = {divide}\n"
        )
    };
    [
        "bands = [\"grey\"]\n[materials.wall]\nreflectance = 0.6\n[materials.clay]\nreflectance = 0.5\n\
         [materials.lamp]\nreflectance = 0.2\nexitance = 10\n"
            .to_owned(),
        wall("floor", "wall", "[[-2,-2,-1],[2,-2,-1],[2,2,-1],[-2,2,-1]]", "[8, 8]"),
        wall("ceiling", "lamp", "[[-2,-2,2],[-2,2,2],[2,2,2],[2,-2,2]]", "[8, 8]"),
        wall("south", "wall", "[[2,-2,-1],[-2,-2,-1],[-2,-2,2],[2,-2,2]]", "[8, 6]"),
        wall("north", "wall", "[[-2,2,-1],[2,2,-1],[2,2,2],[-2,2,2]]", "[8, 6]"),
        wall("west", "wall", "[[-2,-2,-1],[-2,2,-1],[-2,2,2],[-2,-2,2]]", "[8, 6]"),
        wall("east", "wall", "[[2,2,-1],[2,-2,-1],[2,-2,2],[2,2,2]]", "[8, 6]"),
        format!("[[surface]]\nname = \"object\"\nmaterial = \"clay\"\nobj = {{ file = \"{file}\" }}\n"),
    ]
    .concat()
}

//! The NASA almond, a body for radar cross-sections: pointed at one end, smooth elsewhere.
//!
//! With d = 252.374 mm (9.936 inches), x = d t, and the half axes of the ellipse across x
//!
//! ```text
//! −5/12 < t < 0:  y = 0.193333 d √(1 − (t/0.416667)²),           z = y/3
//! 0 < t < 7/12:   y = 4.83345 d (√(1 − (t/2.08335)²) − 0.96),    z = y/3
//! ```
//!
//! (A. C. Woo, H. T. G. Wang, M. J. Schuh, M. L. Sanders, IEEE Antennas Propag. Mag. 35(1) (1993)
//! 84, doi:10.1109/74.210840).

use std::f64::consts::TAU;

use glam::DVec3;

use crate::body::{Body, wavefront};
use crate::files::Files;

/// Length d of the body, m.
const LENGTH: f64 = 0.252_374;
/// t of the blunt end and of the tip.
const ENDS: [f64; 2] = [-0.416_667, 0.583_33];
/// Speed of light, m/s.
const SPEED_OF_LIGHT: f64 = 299_792_458.0;
/// Longest edge unless asked for, m: a third of the half thickness.
const USUAL_EDGE: f64 = 0.006;
/// Edges a wavelength unless asked for.
const PER_WAVELENGTH: f64 = 10.0;
/// Steps by which lengths of arcs are found.
const STEPS: usize = 4000;

/// The almond as an OBJ, and a scene of waves with a monostatic sweep of 181 angles around it.
#[derive(Clone, Debug)]
pub struct Almond {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Length of the edges, m. Default: a tenth of the wavelength, at most 6 mm.
    pub edge: Option<f64>,
}

impl Default for Almond {
    fn default() -> Self {
        Self { frequency: 1e9, edge: None }
    }
}

impl Almond {
    /// `almond.toml` and `almond.obj`.
    #[must_use]
    pub fn files(&self) -> Files {
        let wavelength = SPEED_OF_LIGHT / self.frequency;
        let edge = self.edge.unwrap_or(USUAL_EDGE.min(wavelength / PER_WAVELENGTH));
        let body = body(edge);
        let obj = wavefront([("almond".to_owned(), &[body][..])]);
        let scene = format!(
            "# The NASA almond with edges of {:.2} mm. 0° is the tip.\n\
             title = \"NASA almond\"\n\n\
             [wave]\nfrequencies_hz = [{:?}]\n\n\
             # The triangles of the file are taken as they are: none is longer than this.\n\
             [[surface]]\nname = \"almond\"\nmesh = {{ file = \"almond.obj\" }}\nedge = {:.6}\n\n\
             [[receiver]]\nname = \"back\"\n\
             monostatic = {{ theta_degrees = 90, phi_degrees = {{ from = 0, to = 180, points = 181 }} }}\n",
            1e3 * edge,
            self.frequency,
            2.0 * edge,
        );
        Files { name: "almond.toml".to_owned(), scene, others: vec![("almond.obj".to_owned(), obj)] }
    }
}

/// The larger half axis of the ellipse at t, m.
fn half_axis(t: f64) -> f64 {
    let root = |share: f64| (1.0 - share * share).max(0.0).sqrt();
    if t < 0.0 {
        0.193_333 * LENGTH * root(t / -ENDS[0])
    } else {
        (4.833_45 * LENGTH * (root(t / 2.083_35) - 0.96)).max(0.0)
    }
}

/// Even places along a curve over [0, 1], as its parameters: so many steps, both ends included.
fn even(curve: impl Fn(f64) -> [f64; 2], count: usize) -> Vec<f64> {
    let mut lengths = vec![0.0];
    let at = |i: usize| curve(i as f64 / STEPS as f64);
    for i in 0..STEPS {
        let ([ax, ay], [bx, by]) = (at(i), at(i + 1));
        lengths.push(lengths[i] + (bx - ax).hypot(by - ay));
    }
    let place = |step: usize| {
        let wanted = lengths[STEPS] * step as f64 / count as f64;
        let i = lengths.partition_point(|&length| length < wanted).clamp(1, STEPS);
        let share = (wanted - lengths[i - 1]) / (lengths[i] - lengths[i - 1]);
        (i as f64 - 1.0 + share) / STEPS as f64
    };
    (0..=count).map(place).collect()
}

/// The length of a curve over [0, 1], m.
fn length(curve: impl Fn(f64) -> [f64; 2]) -> f64 {
    let at = |i: usize| curve(i as f64 / STEPS as f64);
    let step = |i: usize| {
        let ([ax, ay], [bx, by]) = (at(i), at(i + 1));
        (bx - ax).hypot(by - ay)
    };
    (0..STEPS).map(step).sum()
}

/// t of a share of the way from the blunt end to the tip; near the blunt end steps of t are small.
fn along(share: f64) -> f64 {
    // The quarter of an ellipse by its angle, then evenly.
    let turn = 0.4;
    if share < turn {
        ENDS[0] * (0.25 * TAU * share / turn).cos()
    } else {
        ENDS[1] * (share - turn) / (1.0 - turn)
    }
}

/// Rings of an even number of corners, joined by triangles.
fn body(edge: f64) -> Body {
    let profile = |share: f64| [LENGTH * along(share), half_axis(along(share))];
    let rings = ((length(profile) / edge).ceil() as usize).max(4);
    let places = even(profile, rings);
    let mut corners = vec![DVec3::X * (LENGTH * ENDS[0])];
    let mut rows: Vec<Vec<usize>> = vec![vec![0]];
    for &share in &places[1..rings] {
        let (x, y) = (LENGTH * along(share), half_axis(along(share)));
        let ellipse = |turn: f64| [y * (TAU * turn).cos(), y / 3.0 * (TAU * turn).sin()];
        let count = 2 * ((length(ellipse) / (2.0 * edge)).round() as usize).max(3);
        let turns = even(ellipse, count);
        let first = corners.len();
        corners.extend(turns[..count].iter().map(|&turn| {
            let [y, z] = ellipse(turn);
            DVec3::new(x, y, z)
        }));
        rows.push((first..first + count).collect());
    }
    corners.push(DVec3::X * (LENGTH * ENDS[1]));
    rows.push(vec![corners.len() - 1]);
    let faces = rows.windows(2).flat_map(|pair| strip(&pair[0], &pair[1])).map(|face| ("", face));
    let faces = faces.collect();
    Body { corners, faces }
}

/// The triangles between two rings, counter-clockwise seen from outside where `next` is towards +x.
fn strip(ring: &[usize], next: &[usize]) -> Vec<Vec<usize>> {
    let sides = |ring: &[usize]| if ring.len() > 1 { ring.len() } else { 0 };
    let (n, m) = (sides(ring), sides(next));
    let (mut i, mut j) = (0, 0);
    let mut faces = Vec::with_capacity(n + m);
    let corner = |ring: &[usize], i: usize| ring[i % ring.len()];
    while i < n || j < m {
        // Whichever side ends first along the turn.
        let here = i < n && (j >= m || (i + 1) * m <= (j + 1) * n);
        if here {
            faces.push(vec![corner(ring, i), corner(ring, i + 1), corner(next, j)]);
            i += 1;
        } else {
            faces.push(vec![corner(ring, i), corner(next, j + 1), corner(next, j)]);
            j += 1;
        }
    }
    faces
}

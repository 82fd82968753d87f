//! The NASA almond, a conducting body whose radar cross section has been measured.
//!
//! With the length d and a parameter t along the axis (A. C. Woo, H. T. G. Wang, M. J. Schuh, M. L. Sanders, Benchmark radar
//! targets for the validation of computational electromagnetics programs, IEEE Antennas Propag. Mag. 35(1) (1993) 84,
//! doi:10.1109/74.210840):
//!
//! ```text
//! y = 3 r(t) cos ψ,  z = r(t) sin ψ,  x = d t
//! r = 0.064444 d √(1 − (t/0.416667)²)               −0.416667 ≤ t ≤ 0
//! r = 1.61115 d [√(1 − (t/2.08335)²) − 0.96]        0 ≤ t ≤ 0.583333
//! ```
//!
//! The tip points along x.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::body::{Body, wavefront};
use crate::files::Files;

/// The ends of t.
const ENDS: [f64; 2] = [-0.416_667, 0.583_333];
/// Width over height.
const ASPECT: f64 = 3.0;
/// Steps in which lengths along curves are added up.
const STEPS: usize = 4000;

/// The almond in a monostatic sweep around the tip, both polarisations, on the plane of its width.
#[derive(Clone, Debug)]
pub struct Almond {
    /// Length d, m; 9.936 inches is that of the measured one.
    pub length: f64,
    /// Edge that triangles have about, m.
    pub edge: f64,
    /// Frequency of the sweep, Hz.
    pub frequency: f64,
}

impl Default for Almond {
    /// The measured one at 7 GHz, with edges of a tenth of the wavelength.
    fn default() -> Self {
        Self { length: 0.252_374, edge: 0.004_28, frequency: 7e9 }
    }
}

impl Almond {
    /// `almond.toml`, a scene of waves with 181 angles from the tip to the blunt end, and `almond.obj`.
    #[must_use]
    pub fn files(&self) -> Files {
        let Self { length, edge, frequency } = self;
        let scene = format!(
            "# The NASA almond: length = {length}, edge = {edge}.\n\
             title = \"NASA almond\"\n\n\
             [wave]\nfrequencies_hz = [{frequency:e}]\nmethod = \"cfie\"\n\n\
             [[surface]]\nname = \"almond\"\nmesh = {{ file = \"almond.obj\" }}\nedge = {}\n\n\
             [[receiver]]\nname = \"sweep\"\n\
             monostatic = {{ theta_degrees = 90, phi_degrees = {{ from = 0, to = 180, points = 181 }} }}\n",
            2.0 * edge,
        );
        let obj = wavefront([("almond".to_owned(), &[self.body()][..])]);
        Files { name: "almond.toml".to_owned(), scene, others: vec![("almond.obj".to_owned(), obj)] }
    }

    /// Half the height at t, m.
    fn radius(&self, t: f64) -> f64 {
        let share = |root: f64| (1.0 - (t / root).powi(2)).max(0.0).sqrt();
        let blunt = if t < 0.0 { 0.064_444 * share(0.416_667) } else { 1.61115 * (share(2.083_35) - 0.96) };
        self.length * blunt.max(0.0)
    }

    /// Rings of about the same distance along the widest outline, with corners of about the same distance along each.
    fn body(&self) -> Body {
        let at = |share: f64| ENDS[0] + share * (ENDS[1] - ENDS[0]);
        let outline = evenly(|share| {
            let t = at(share);
            [self.length * t, ASPECT * self.radius(t)]
        });
        let around = evenly(|share| [ASPECT * (TAU * share).cos(), (TAU * share).sin()]);
        let rings = ((outline.length / (0.87 * self.edge)).ceil() as usize).max(4);
        let place = |t: f64, share: f64| {
            let (sine, cosine) = (TAU * around.share(share)).sin_cos();
            let radius = self.radius(t);
            DVec3::new(self.length * t, ASPECT * radius * cosine, radius * sine)
        };
        let mut body = Body { corners: vec![DVec3::X * (self.length * ENDS[0])], faces: Vec::new() };
        let mut before = 0..1;
        for ring in 1..=rings {
            let t = at(outline.share(ring as f64 / rings as f64));
            let count = if ring == rings {
                1
            } else {
                ((around.length * self.radius(t) / self.edge).round() as usize).max(5)
            };
            let first = body.corners.len();
            if count == 1 {
                body.corners.push(DVec3::X * (self.length * ENDS[1]));
            } else {
                body.corners.extend((0..count).map(|i| place(t, i as f64 / count as f64)));
            }
            stitch(before, first..first + count, &mut body.faces);
            before = first..first + count;
        }
        body
    }
}

/// Triangles between two rings: the one whose next corner comes first goes on.
fn stitch(
    one: std::ops::Range<usize>,
    other: std::ops::Range<usize>,
    faces: &mut Vec<(&'static str, Vec<usize>)>,
) {
    let (n, m) = (one.len(), other.len());
    let (mut i, mut j) = (0, 0);
    // A ring of one corner does not go on.
    let ends = [if n == 1 { 0 } else { n }, if m == 1 { 0 } else { m }];
    while i < ends[0] || j < ends[1] {
        let [a, b] = [one.start + i % n, other.start + j % m];
        // (i + 1)/n against (j + 1)/m, in whole numbers.
        if j == ends[1] || (i < ends[0] && (2 * i + 1) * m <= (2 * j + 1) * n) {
            i += 1;
            faces.push(("conductor", vec![a, one.start + i % n, b]));
        } else {
            j += 1;
            faces.push(("conductor", vec![a, other.start + j % m, b]));
        }
    }
}

/// Lengths along a plane curve.
struct Lengths {
    /// From the beginning to the end of each step.
    sums: Vec<f64>,
    length: f64,
}

/// The lengths along a curve over 0 to 1.
fn evenly(curve: impl Fn(f64) -> [f64; 2]) -> Lengths {
    let (mut sums, mut length) = (vec![0.0], 0.0);
    for step in 0..STEPS {
        let [from, to] = [step, step + 1].map(|step| curve(step as f64 / STEPS as f64));
        length += (to[0] - from[0]).hypot(to[1] - from[1]);
        sums.push(length);
    }
    Lengths { sums, length }
}

impl Lengths {
    /// Where this share of the length is reached.
    fn share(&self, of_length: f64) -> f64 {
        let wanted = of_length * self.length;
        let step = self.sums.partition_point(|&sum| sum <= wanted).clamp(1, STEPS);
        let (low, high) = (self.sums[step - 1], self.sums[step]);
        let within = if high > low { ((wanted - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        ((step - 1) as f64 + within) / STEPS as f64
    }
}

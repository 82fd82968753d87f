//! The parts that stand for a bent cluster, and a function over it from its values at them.
//!
//! The function is fitted by 1 + g·(x − c) times its mean in space, not in a plane: on a smooth
//! surface that is linear in the normal too. What it leaves of the values at the parts, or at real
//! members if that is more, is the rest. Lengths in metres.

use super::scattered::place;
use super::side::{POINTS_OF_THE_MEAN, Points, Side};
use crate::tree::{Node, Tree};
use fredholm_mesh::{Patch, Vec3};

/// Part of the variance of places that is added in all directions before a linear function is
/// fitted.
const RIDGE_SHARE: f64 = 1e-3;

/// Radius of a flat part, over that of the cluster, from which on its quarters stand for it.
const LARGE_PART_RADIUS: f64 = 0.5;
/// Least samples of a bent cluster.
const LEAST_SAMPLES: usize = 8;
/// Numbers that are fitted to the samples.
const FITTED_NUMBERS: usize = 4;
/// A part of a bent cluster.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Centre of area.
    pub centre: Vec3,
    /// Σ A n, m².
    pub vector: Vec3,
    /// Σ A, m².
    pub area: f64,
    /// Place and normal of one of its elements near the centre.
    pub member: [Vec3; 2],
    /// The node of the part, and which quarter of a flat one it is.
    part: u32,
    quarter: Option<usize>,
}

/// The parts of a bent node; quarters of flat ones that are few or large.
pub(super) fn samples(tree: &Tree, index: u32) -> Vec<Sample> {
    let parts = tree.parts(index);
    let large = LARGE_PART_RADIUS * tree.nodes()[index as usize].cone().radius;
    let mut samples = Vec::with_capacity(LEAST_SAMPLES);
    for &part in &parts {
        let node = &tree.nodes()[part as usize];
        match node.patch() {
            Some(patch) if parts.len() < LEAST_SAMPLES || node.cone().radius > large => {
                quarters(patch, part, &mut samples);
            }
            Some(patch) => samples.push(Sample::of(part, node, node.centre(), patch.normal())),
            None => {
                let middle = &tree.nodes()[node.middle() as usize];
                let normal = middle.area_vector().normalize_or_zero();
                samples.push(Sample::of(part, node, middle.centre(), normal));
            }
        }
    }
    samples
}

fn quarters(patch: &Patch, part: u32, samples: &mut Vec<Sample>) {
    let area = patch.area() / POINTS_OF_THE_MEAN as f64;
    let quarter = |(k, &x): (usize, &Vec3)| Sample {
        centre: x,
        vector: patch.normal() * area,
        area,
        member: [x, patch.normal()],
        part,
        quarter: Some(k),
    };
    samples.extend(Points::of(patch).at[..POINTS_OF_THE_MEAN].iter().enumerate().map(quarter));
}

impl Sample {
    fn of(part: u32, node: &Node, place: Vec3, normal: Vec3) -> Self {
        Self {
            centre: node.centre(),
            vector: node.area_vector(),
            area: node.area(),
            member: [place, normal],
            part,
            quarter: None,
        }
    }

    /// A place on one of the elements of the part.
    pub fn place(&self, tree: &Tree, (member, on): (f64, [f64; 2])) -> Vec3 {
        match (tree.member(self.part, member), self.quarter) {
            (Some(patch), Some(k)) => Points::of(patch).within(k, on),
            (Some(patch), None) => place(patch, on),
            (None, _) => self.member[0],
        }
    }
}

/// The linear function in space through the values of parts, and what is left of it at members.
pub(super) fn fit(samples: &[Sample], values: &[f64], probes: &[f64]) -> Side {
    let area: f64 = samples.iter().map(|s| s.area).sum();
    let over =
        |f: &dyn Fn(usize) -> f64| (0..samples.len()).map(|k| samples[k].area * f(k)).sum::<f64>() / area;
    let mean = over(&|k| values[k]);
    if mean <= 0.0 {
        return Side::default();
    }
    let centre = samples.iter().map(|s| s.centre * s.area).sum::<Vec3>() / area;
    let offsets: Vec<Vec3> = samples.iter().map(|s| s.centre - centre).collect();
    let gradient = limited(slope(samples, &offsets, |k| values[k] / mean - 1.0), &offsets);
    let linear = |x: Vec3| 1.0 + gradient.dot(x - centre);
    let parts = over(&|k| (values[k] / mean - linear(samples[k].centre)).powi(2));
    let members = over(&|k| (probes[k] / mean - linear(samples[k].member[0])).powi(2));
    let freedom = samples.len() as f64 / (samples.len() - FITTED_NUMBERS) as f64;
    let rest = (parts * freedom).max(members).sqrt();
    let explained = over(&|k| gradient.dot(offsets[k]).powi(2));
    Side { mean, gradient, deviation: rest.hypot(explained.sqrt()), rest }
}

/// The gradient that fits values best; directions in which the parts hardly extend count little.
fn slope(samples: &[Sample], offsets: &[Vec3], value: impl Fn(usize) -> f64) -> Vec3 {
    let (mut square, mut moment) = (glam::DMat3::ZERO, Vec3::ZERO);
    for (k, &x) in offsets.iter().enumerate() {
        let weighted = x * samples[k].area;
        square += glam::DMat3::from_cols(weighted * x.x, weighted * x.y, weighted * x.z);
        moment += weighted * value(k);
    }
    let trace = square.x_axis.x + square.y_axis.y + square.z_axis.z;
    let ridged = square + glam::DMat3::from_diagonal(Vec3::splat(RIDGE_SHARE * trace));
    if trace > 0.0 { ridged.inverse() * moment } else { Vec3::ZERO }
}

/// How far members lie beyond the centres of the parts.
const MEMBERS_BEYOND_CENTRES: f64 = 1.6;

/// The gradient, shortened where the linear function would be negative.
fn limited(gradient: Vec3, offsets: &[Vec3]) -> Vec3 {
    let least = offsets.iter().map(|x| MEMBERS_BEYOND_CENTRES * gradient.dot(*x)).fold(0.0, f64::min);
    if least < -1.0 { gradient / -least } else { gradient }
}

//! The walk down the tree for one point.

use super::shadows::{Covers, FLAT_HEIGHT, Shadows};
use super::{Gather, Senders};
use crate::tree::Node;
use fredholm_coupling::Receiver;
use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_coupling::kernel::lambert;
use fredholm_coupling::polygon::{HalfSpace, clip, folded};
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::PI;
use std::ops::Range;

/// Bodies in a scene up to which their shadows are cut out exactly; behind more of them segments to
/// points of a node are tested.
const MOST_EXACT_BODIES: usize = 256;
/// Bodies in a scene up to which those before strong senders are looked for.
const MOST_BODIES: usize = 10_000;
/// Part of the irradiance above which a node behind some of many bodies is cut exactly.
const LEAST_EXACT_SHARE: f64 = 0.02;
/// Points along a side of the grid on a node that brings all of the irradiance.
const MOST_POINTS_ALONG_SIDE: f64 = 8.0;
/// Deviation of the kernel over its mean, for a node of radius r at distance d, over r/d.
const KERNEL_DEVIATION: f64 = 2.0;

/// Gathers for one thread; buffers are kept from point to point.
#[derive(Debug)]
pub struct Gatherer<'g> {
    gather: &'g Gather<'g>,
    receiver: Receiver,
    /// Irradiance that is expected, and error that a node may leave, of each band, W/m².
    expected: Vec<f64>,
    allowed: Vec<f64>,
    shadows: Shadows,
    /// Shadows that may matter to a node, one list behind the other.
    lists: Vec<u32>,
    polygon: Vec<Vec3>,
    front: Vec<Vec3>,
    sum: Vec<f64>,
}

impl<'g> Gatherer<'g> {
    pub(super) fn new(gather: &'g Gather<'g>) -> Self {
        let bands = gather.floor.len();
        Self {
            gather,
            receiver: Receiver { point: Vec3::ZERO, normal: Vec3::Z },
            expected: vec![0.0; bands],
            allowed: vec![0.0; bands],
            shadows: Shadows::default(),
            lists: Vec::new(),
            polygon: Vec::new(),
            front: Vec::new(),
            sum: vec![0.0; bands],
        }
    }

    /// Irradiance of a receiver, of each band, W/m². `expected` is about what it will be, W/m²:
    /// errors are relative to it.
    pub fn irradiance(&mut self, receiver: &Receiver, expected: &[f64]) -> &[f64] {
        let Gather { share, floor, bodies, .. } = self.gather;
        self.receiver = *receiver;
        for (band, (e, floor)) in expected.iter().zip(floor).enumerate() {
            self.expected[band] = e.max(*floor);
            self.allowed[band] = share * self.expected[band];
        }
        self.sum.fill(0.0);
        self.lists.clear();
        if self.is_exact() {
            let Receiver { point, normal } = *receiver;
            self.shadows.cast(point, normal, bodies.as_slice().iter(), bodies.tolerance());
            self.lists.extend(0..self.shadows.len() as u32);
        }
        self.visit(0, 0..self.lists.len());
        &self.sum
    }

    fn is_exact(&self) -> bool {
        self.gather.bodies.as_slice().len() <= MOST_EXACT_BODIES
    }

    fn node(&self, index: u32) -> &'g Node {
        &self.gather.tree.nodes()[index as usize]
    }

    fn senders(&self) -> &'g Senders {
        &self.gather.senders
    }

    /// Adds what comes from a node behind some of the shadows.
    fn visit(&mut self, index: u32, among: Range<usize>) {
        let (centre, radius) = self.senders().ball(index);
        let to = centre - self.receiver.point;
        if self.receiver.normal.dot(to) <= -radius || self.senders().is_dark(index) {
            return;
        }
        let start = self.lists.len();
        let flat = FLAT_HEIGHT * (to.length() + radius);
        let seen = match self.node(index).patch() {
            Some(patch) => {
                self.face(patch, flat)
                    && self.keep(among, |view, k| view.shadows.covers(k, &view.polygon, flat))
            }
            None => self.keep(among, |view, k| view.shadows.covers_ball(k, to, radius)),
        };
        let own = start..self.lists.len();
        if seen {
            self.take_or_part(index, own, flat);
        }
        self.lists.truncate(start);
    }

    /// Looks at a patch: whether it faces the point. Its corners are then those relative to the
    /// point.
    fn face(&mut self, patch: &Patch, flat: f64) -> bool {
        let x = self.receiver.point;
        self.polygon.clear();
        self.polygon.extend(patch.corners().iter().map(|&y| y - x));
        self.polygon[0].dot(patch.normal()) < -flat
    }

    /// Appends the shadows that cover a part of what is looked at; false where one covers all of
    /// it.
    fn keep(&mut self, among: Range<usize>, covers: impl Fn(&Self, u32) -> Covers) -> bool {
        for k in among {
            let shadow = self.lists[k];
            match covers(self, shadow) {
                Covers::Nothing => {}
                Covers::Part => self.lists.push(shadow),
                Covers::All => return false,
            }
        }
        true
    }

    /// Takes a node as a whole, or its children.
    fn take_or_part(&mut self, index: u32, own: Range<usize>, flat: f64) {
        let node = self.node(index);
        let open = own.is_empty() && self.is_exact();
        if node.patch().is_some() && (node.is_leaf() || self.is_even(index, open)) {
            return self.take(index, own, flat);
        }
        for &child in node.children() {
            self.visit(child, own.clone());
        }
    }

    /// Whether a node may be taken as a whole.
    fn is_even(&self, index: u32, open: bool) -> bool {
        let (centre, radius) = self.senders().ball(index);
        let (factor, bend) = self.bound(centre - self.receiver.point, radius, self.node(index).area());
        let error = factor * if open { bend } else { 1.0 };
        let deviations = self.senders().deviation(index).iter();
        deviations.zip(&self.allowed).all(|(deviation, allowed)| error * deviation <= *allowed)
    }

    /// Bounds of the factor of some area in a ball, and of the relative deviation of the kernel
    /// over it.
    fn bound(&self, to: Vec3, radius: f64, area: f64) -> (f64, f64) {
        let distance = to.length();
        if distance <= radius {
            return (1.0, 1.0);
        }
        let (nearest, sine) = (distance - radius, radius / distance);
        let cosine = ((self.receiver.normal.dot(to) + radius) / nearest).clamp(0.0, 1.0);
        let factor = (sine * sine).min(cosine * area / (PI * nearest * nearest));
        (factor, (KERNEL_DEVIATION * sine).min(1.0))
    }

    /// Adds what comes from a node, of one radiosity.
    fn take(&mut self, index: u32, own: Range<usize>, flat: f64) {
        let normal = self.receiver.normal;
        self.front.clear();
        clip(&self.polygon, HalfSpace { normal, offset: 0.0 }, flat, &mut self.front);
        if self.front.len() < 3 {
            return;
        }
        let open = || point_to_polygon(normal, self.front.iter().copied()).max(0.0);
        let factor = match (self.is_exact(), own.is_empty()) {
            (true, true) => open(),
            (true, false) => {
                self.shadows.turn(&self.front);
                self.shadows.factor(normal, &self.front, &self.lists[own], flat)
            }
            (false, _) => {
                let open = open();
                self.behind_many(index, open, flat)
            }
        };
        let mean = self.senders().mean(index);
        self.sum.iter_mut().zip(mean).for_each(|(sum, b)| *sum += factor * b);
    }

    /// Factor of a node with the factor `open` if nothing stood between: exact where it brings
    /// much.
    fn behind_many(&mut self, index: u32, open: f64, flat: f64) -> f64 {
        let Some(patch) = self.node(index).patch() else { return open };
        let expected = self.expected.iter().zip(self.senders().mean(index));
        let part = expected.map(|(e, b)| if *e > 0.0 { open * b / e } else { 0.0 }).fold(0.0, f64::max);
        let exact = if part > LEAST_EXACT_SHARE { self.cut(patch, flat) } else { None };
        exact.unwrap_or_else(|| open * self.sampled(patch, part))
    }

    /// Factor of what the bodies between leave of the polygon looked at; none where they are many.
    fn cut(&mut self, patch: &Patch, flat: f64) -> Option<f64> {
        let Gather { occluders, bodies, .. } = self.gather;
        let Receiver { point, normal } = self.receiver;
        if bodies.as_slice().len() > MOST_BODIES {
            return None;
        }
        let shaft = occluders.shaft_from(point, patch);
        let reaching = shaft.iter().flat_map(|shaft| occluders.reaching(bodies, shaft));
        let reaching = reaching.map(|(_, body)| body);
        self.shadows.cast_on(&self.front, (point, normal), reaching, bodies.tolerance());
        let all: Vec<u32> = (0..self.shadows.len() as u32).collect();
        (all.len() <= MOST_EXACT_BODIES).then(|| self.shadows.factor(normal, &self.front, &all, flat))
    }

    /// Share of what comes from a grid of points on a node that is seen; the grid is finer on nodes
    /// that bring a larger part of the irradiance.
    fn sampled(&self, patch: &Patch, part: f64) -> f64 {
        let side = (MOST_POINTS_ALONG_SIDE * part.sqrt()).ceil().clamp(1.0, MOST_POINTS_ALONG_SIDE) as usize;
        let middle = |k: usize| (k as f64 + 0.5) / side as f64;
        let place = |k: usize| folded(patch, middle(k / side), middle(k % side));
        let Receiver { point, normal } = self.receiver;
        let weigh = |[all, seen]: [f64; 2], k: usize| {
            let (u, v) = place(k);
            let y = patch.point(u, v);
            let weight = lambert(point, normal, y, patch.normal());
            let open = weight > 0.0 && self.gather.occluders.unoccluded(point, y);
            [all + weight, seen + if open { weight } else { 0.0 }]
        };
        let [all, seen] = (0..side * side).fold([0.0; 2], weigh);
        if all > 0.0 { seen / all } else { 1.0 }
    }
}

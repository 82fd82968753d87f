//! The links of one element: the elements and clusters from which it and all that it is a part of
//! receive their light.
//!
//! Each linked node is outlined and tinted by the share of the irradiance that it brings, on a
//! logarithmic scale; lines go from the receiver to the middles of the nodes. Outlines and lines
//! have the colour of the level on which the link arrives: orange for the element itself, then
//! through green to blue for what it is a part of.

use fredholm_mesh::{Patch, Vec3};

use super::elements::{blend, cover};
use super::{Overlay, Picture, Sample, Viewer};
use crate::Field;
use crate::colour::Rgb;
use crate::tone::{encode, luminance};

/// A node that sends to the receiver.
#[derive(Clone, Debug)]
pub struct Link {
    /// The polygon of the node, or `None` for elements that bend.
    pub patch: Option<Patch>,
    /// Its middle, m.
    pub centre: Vec3,
    /// Levels from the receiver up to the node at which the link arrives.
    pub level: usize,
    /// Share of the irradiance of the receiver that it brings, in the band where it is most.
    pub share: f64,
}

/// The links of one element.
#[derive(Clone, Debug)]
pub struct Linked {
    /// What is linked.
    pub links: Vec<Link>,
    /// For each element of the field the link that it sends by, as a place in `links`.
    pub link_of: Vec<Option<usize>>,
}

/// Half the widths of an outline and of the receiver's outline, pixels.
const HALF_LINE_WIDTH: f64 = 0.6;
const HALF_RECEIVER_LINE_WIDTH: f64 = 1.6;
/// Share of the picture that is left under the tints.
const SHARE_UNDER_TINTS: f64 = 0.35;
/// Least share of the irradiance that is told from nothing.
const LEAST_SHARE: f64 = 1e-4;
/// Colour of the receiver.
const RECEIVER_COLOUR: Rgb = [1.0, 0.02, 0.02];
/// Colours of levels, linear.
const LEVEL_COLOURS: [Rgb; 5] =
    [[0.95, 0.30, 0.02], [0.75, 0.55, 0.02], [0.10, 0.50, 0.12], [0.04, 0.35, 0.70], [0.22, 0.12, 0.60]];

pub(super) struct LinkOverlay<'a> {
    field: Field<'a>,
    receiver: usize,
    linked: Linked,
}

impl<'a> LinkOverlay<'a> {
    /// The links of the element in the middle of the picture, or of the first one where nothing is
    /// there.
    pub fn new(view: &Viewer<'a>, field: &Field<'a>, links: &(dyn Fn(usize) -> Linked + Sync)) -> Self {
        let camera = view.eye.camera();
        let middle = [camera.width, camera.height].map(|side| 0.5 * f64::from(side));
        let receiver = view.eye.hit(middle[0], middle[1]).map_or(0, |(leaf, _)| leaf);
        Self { field: *field, receiver, linked: links(receiver) }
    }
}

/// How much of a colour a share has, in [0, 1].
fn strength(share: f64) -> f64 {
    1.0 - (share.clamp(LEAST_SHARE, 1.0).ln() / LEAST_SHARE.ln())
}

impl Overlay for LinkOverlay<'_> {
    fn colour(&self, view: &Viewer<'_>, sample: &Sample, under: Rgb) -> Rgb {
        let mesh = self.field.mesh();
        if sample.leaf == self.receiver {
            return RECEIVER_COLOUR;
        }
        let mut colour = [SHARE_UNDER_TINTS * luminance(under); 3];
        if let Some(link) = self.linked.link_of[sample.leaf].map(|k| &self.linked.links[k]) {
            let own = LEVEL_COLOURS[link.level.min(LEVEL_COLOURS.len() - 1)];
            let lines = link.patch.map_or(0.0, |patch| cover(view, &patch, sample, HALF_LINE_WIDTH));
            colour = blend(blend(colour, own, 0.6 * strength(link.share)), own, lines);
        }
        if mesh.surface_of(sample.leaf) == mesh.surface_of(self.receiver) {
            let lines = cover(view, mesh.patch(self.receiver), sample, HALF_RECEIVER_LINE_WIDTH);
            colour = blend(colour, RECEIVER_COLOUR, lines);
        }
        colour
    }

    /// Lines from the receiver to the middles of the nodes, the strongest last.
    fn finish(&self, view: &Viewer<'_>, picture: &mut Picture) {
        let from = self.field.mesh().patch(self.receiver).centroid();
        let mut links: Vec<&Link> = self.linked.links.iter().collect();
        links.sort_by(|a, b| a.share.total_cmp(&b.share));
        for link in links {
            let colour = LEVEL_COLOURS[link.level.min(LEVEL_COLOURS.len() - 1)].map(encode);
            if let [Some(a), Some(b)] = [from, link.centre].map(|end| view.project(end)) {
                line(picture, [a, b], (colour, 0.15 + 0.7 * strength(link.share)));
            }
        }
    }
}

/// Draws a line of one pixel over a picture, between places in pixels; `cover` is how much of its
/// colour it has.
pub(super) fn line(picture: &mut Picture, [a, b]: [(f64, f64); 2], (colour, cover): ([u8; 3], f64)) {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let steps = dx.abs().max(dy.abs()).ceil().clamp(1.0, f64::from(picture.width + picture.height));
    for step in 0..=steps as u32 {
        let t = f64::from(step) / steps;
        let (x, y) = (a.0 + t * dx - 0.5, a.1 + t * dy - 0.5);
        let across = if dx.abs() >= dy.abs() { (0.0, 1.0) } else { (1.0, 0.0) };
        // Two pixels across the line share it.
        let part = if across.0 > 0.0 { x - x.floor() } else { y - y.floor() };
        let place = |k: f64| {
            if across.0 > 0.0 { (x.floor() + k, y.round()) } else { (x.round(), y.floor() + k) }
        };
        dot(picture, place(0.0), colour, cover * (1.0 - part));
        dot(picture, place(1.0), colour, cover * part);
    }
}

fn dot(picture: &mut Picture, (x, y): (f64, f64), colour: [u8; 3], cover: f64) {
    let inside = x >= 0.0 && y >= 0.0 && x < f64::from(picture.width) && y < f64::from(picture.height);
    if !inside {
        return;
    }
    let at = 3 * (y as usize * picture.width as usize + x as usize);
    for (pixel, colour) in picture.pixels[at..at + 3].iter_mut().zip(colour) {
        let (old, new) = (f64::from(*pixel), f64::from(colour));
        *pixel = (old + cover * (new - old)).round() as u8;
    }
}

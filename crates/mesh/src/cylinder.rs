//! Cylinders: a regular prism, closed by the polygons of discs where it has caps.
//!
//! Side and caps share one polygon of radius R. With n segments, height h and true radius r, the
//! total area
//!
//! 2 n R h sin(π/n) + c n R² sin(2π/n) = 2π r h + 2π c r²,  c = 1 with caps and 0 without,
//!
//! gives R as the positive root, in the form that loses no digits (and serves c = 0). Metres.

use std::f64::consts::PI;

use crate::cutting::Form;
use crate::disc::{Rings, check, direction, frame};
use crate::facet::{Facet, Group};
use crate::{MeshError, Patch, Vec3};

/// A regular prism, standing for a cylinder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prism {
    base: Rings,
    top: Rings,
    caps: bool,
}

impl Prism {
    /// The prism that has the area of a cylinder.
    pub fn new(base: Vec3, axis: Vec3, radius: f64, segments: usize, caps: bool) -> Result<Self, MeshError> {
        check(base, radius, segments)?;
        let normal = direction(axis, "the cylinder's axis")?;
        let radius = polygon_radius(radius, axis.length(), segments, caps);
        let base = Rings { centre: base, normal, across: frame(normal), radius, segments };
        Ok(Self { base, top: Rings { centre: base.centre + axis, ..base }, caps })
    }

    /// One group for the side, one for both caps.
    pub fn groups(&self) -> Vec<Group> {
        let edge = |a: Vec3, b: Vec3| a.distance(b);
        let around = edge(self.base.border(0), self.base.border(1));
        let along = edge(self.base.border(0), self.top.border(0));
        let side = Form::Quad { u: around, v: along, flat: true };
        let mut groups = vec![Group { form: side, number: self.base.segments as u128 }];
        if self.caps {
            let cap = self.base.group();
            groups.push(Group { number: 2 * cap.number, ..cap });
        }
        groups
    }

    /// The side, then the cap at the base, then that at the top; lit outside.
    pub fn facets(&self) -> Result<Vec<Facet>, MeshError> {
        let mut facets: Vec<_> = self.side()?.into_iter().map(Facet::Flat).collect();
        if self.caps {
            facets.extend(self.base.facets()?.iter().map(Facet::flipped));
            facets.extend(self.top.facets()?);
        }
        Ok(facets)
    }

    /// The side's quads, and the caps as few convex pieces.
    pub fn blockers(&self) -> Result<Vec<Patch>, MeshError> {
        let mut blockers = self.side()?;
        if self.caps {
            blockers.extend(self.base.blockers()?.iter().map(Patch::flipped));
            blockers.extend(self.top.blockers()?);
        }
        Ok(blockers)
    }

    fn side(&self) -> Result<Vec<Patch>, MeshError> {
        let (base, top) = (&self.base, &self.top);
        let quad = |k| {
            let corners = [base.border(k), base.border(k + 1), top.border(k + 1), top.border(k)];
            let outward = (corners[1] - corners[0]).cross(base.normal).normalize_or_zero();
            Patch::piece(corners, 4, outward)
        };
        (0..base.segments).map(quad).collect()
    }
}

fn polygon_radius(radius: f64, height: f64, segments: usize, caps: bool) -> f64 {
    let n = segments as f64;
    let caps = if caps { 1.0 } else { 0.0 };
    let area = 2.0 * PI * radius * (height + caps * radius);
    let (linear, square) = (2.0 * n * height * (PI / n).sin(), caps * n * (2.0 * PI / n).sin());
    2.0 * area / (linear + (linear * linear + 4.0 * square * area).sqrt())
}

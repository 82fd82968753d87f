//! The set of patches that block the view.

use std::ops::Range;

use fredholm_mesh::{Patch, Vec3};

use crate::VisibilityError;
use crate::exact::line_crosses;
use crate::facet::{Crossing, Facet, Meeting, Slopes};
use crate::frame::Frame;
use crate::packet::Packet;
use crate::probe::Probe;
use crate::tree::{Built, Tree, bounds};

/// Facets are counted in 31 bits, and a patch may need two.
const MOST_FACETS: usize = (u32::MAX / 4) as usize;
/// A quad this close to a parallelogram, over the tolerance of length, is tested as one.
const SKEW: f64 = 1e-2;

/// Patches that block the view from both sides, prepared for queries.
#[derive(Clone, Debug)]
pub struct Occluders {
    pub(crate) frame: Frame,
    pub(crate) patches: Vec<Patch>,
    /// In the order of the leaves of the tree.
    pub(crate) facets: Vec<Facet>,
    /// In the same order.
    pub(crate) slopes: Vec<Slopes>,
    pub(crate) tree: Tree,
    /// The facets of each leaf of the tree.
    pub(crate) packets: Vec<Packet>,
    /// The corners of each facet, local; a triangle repeats its last.
    pub(crate) outlines: Vec<[Vec3; 4]>,
    /// Where the facets of each patch are; the two places are the same where it has only one.
    pub(crate) places: Vec<[u32; 2]>,
}

impl Occluders {
    /// Prepares the patches for queries. Later answers name a patch by its index in the slice. An
    /// empty slice is legal: nothing blocks.
    ///
    /// # Errors
    /// [`VisibilityError::TooMany`] past 2³⁰ − 1 patches; [`VisibilityError::Span`] for a scene
    /// larger than 1e50 m or smaller than 1e-50 m.
    pub fn new(patches: &[Patch]) -> Result<Self, VisibilityError> {
        if patches.len() > MOST_FACETS {
            return Err(VisibilityError::TooMany { count: patches.len(), limit: MOST_FACETS });
        }
        let frame = Frame::around(patches)?;
        let pieces: Vec<Piece> =
            patches.iter().zip(0..).flat_map(|(patch, index)| pieces(patch, index, &frame)).collect();
        let boxes: Vec<_> = pieces.iter().map(|piece| bounds(&piece.outline)).collect();
        let Built { tree, order, leaves } = Tree::over(&boxes);
        let ordered = || order.iter().map(|&i| &pieces[i as usize]);
        let facets: Vec<Facet> = ordered().map(|piece| piece.facet).collect();
        let slopes: Vec<Slopes> = ordered().map(|piece| piece.slopes).collect();
        let outlines = ordered().map(|piece| piece.outline).collect();
        let packet =
            |leaf: Range<usize>| Packet::new(&facets[leaf.clone()], &slopes[leaf.clone()], leaf.start as u32);
        let packets = leaves.into_iter().map(packet).collect();
        let places = places(&facets, patches.len());
        Ok(Self { frame, patches: patches.to_vec(), facets, slopes, outlines, tree, packets, places })
    }

    /// The patches, as they were given.
    #[must_use]
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// Number of patches.
    #[must_use]
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Whether there is nothing that could block.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// Length up to which two places count as one, m: 1e-9 of the longest side of the bounding box,
    /// and no less than 16 units in the last place of the largest coordinate.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.frame.metres(self.frame.tolerance)
    }

    /// Where the probe crosses the facet of a place, or `None` where it does not.
    #[inline]
    pub(crate) fn crossing(&self, place: usize, probe: &Probe) -> Option<Meeting> {
        let facet = &self.facets[place];
        match facet.crossing(&self.slopes[place], probe) {
            Crossing::Miss => None,
            Crossing::Hit(meeting) => Some(meeting),
            Crossing::Doubt(meeting) => self.line_crosses(facet, probe).then_some(meeting),
        }
    }

    #[cold]
    fn line_crosses(&self, facet: &Facet, probe: &Probe) -> bool {
        let [p, q] = probe.ends;
        line_crosses(p, q, self.patches[facet.patch as usize].corners())
    }
}

/// A facet, and the corners of its outline, local.
struct Piece {
    facet: Facet,
    slopes: Slopes,
    outline: [Vec3; 4],
}

/// A triangle is one facet, and so is a quad that is a parallelogram; any other quad is two
/// triangles.
///
/// Edges are differences of the corners as given: those of local coordinates lose digits of small
/// patches.
fn pieces(patch: &Patch, index: u32, frame: &Frame) -> impl Iterator<Item = Piece> + use<> {
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| patch.corner(i.min(patch.sides() - 1)));
    let [to_b, to_c, to_d] = [b, c, d].map(|corner| frame.edge(corner - a));
    let [a, b, c, d] = [a, b, c, d].map(|corner| frame.local(corner));
    let skew = (to_b + to_d - to_c).length();
    let piece = |(facet, slopes), outline| Some(Piece { facet, slopes, outline });
    let first = piece(Facet::triangle(a, [to_b, to_c], index), [a, b, c, c]);
    let pieces = if patch.sides() == 3 {
        [first, None]
    } else if skew <= SKEW * frame.tolerance {
        [piece(Facet::parallelogram(a, [to_b, to_d], skew, index), [a, b, c, d]), None]
    } else {
        [first, piece(Facet::triangle(a, [to_c, to_d], index), [a, c, d, d])]
    };
    pieces.into_iter().flatten()
}

fn places(facets: &[Facet], patches: usize) -> Vec<[u32; 2]> {
    let mut places = vec![[u32::MAX; 2]; patches];
    for (place, facet) in facets.iter().enumerate() {
        let [first, last] = &mut places[facet.patch as usize];
        *first = (*first).min(place as u32);
        *last = place as u32;
    }
    places
}

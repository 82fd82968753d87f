//! The undivided pieces of the surfaces of a scene, and what of them lies on each other.

use std::sync::Arc;

use fredholm_mesh::{Contacts, MeshError, Overlap, Patch};

use crate::part::{Origin, Part};

/// The flat pieces of all fronts; the light around a mesh file is none of them.
#[derive(Debug, Default)]
pub(crate) struct Pieces {
    pub patches: Vec<Patch>,
    /// Part of each piece.
    pub part_of: Vec<usize>,
    /// For each part, whether it has a back.
    pub two_sided: Vec<bool>,
    pub contacts: Contacts,
    /// Whether pieces lie on each other that are lit on the same side.
    pub overlap: bool,
}

impl Pieces {
    /// The pieces of all parts, or the part of which the shape makes none.
    pub fn of(parts: &[Part]) -> Result<Self, (&Part, MeshError)> {
        let mut pieces = Self { two_sided: two_sided(parts), ..Self::default() };
        let counts = |part: &Part| !part.cutting.flipped && part.origin != Origin::Sky;
        for (number, part) in parts.iter().enumerate().filter(|(_, part)| counts(part)) {
            for shape in part.shapes.iter() {
                pieces.patches.extend(shape.blockers(&part.cutting).map_err(|error| (part, error))?);
            }
            pieces.part_of.resize(pieces.patches.len(), number);
        }
        pieces.contacts = Contacts::of(&pieces.patches);
        let overlap = pieces.doubled().next().is_some();
        Ok(Self { overlap, ..pieces })
    }

    /// What would be counted twice: pieces that lie on each other and are lit on the same side,
    /// backs included.
    pub fn doubled(&self) -> impl Iterator<Item = &Overlap> {
        let has_back = |piece: &u32| self.two_sided[self.part_of[*piece as usize]];
        self.contacts.overlaps.iter().filter(move |o| o.same_side || o.pieces.iter().any(has_back))
    }

    /// Part of a piece.
    pub fn part(&self, piece: u32) -> usize {
        self.part_of[piece as usize]
    }
}

/// Which parts have a back: those of which the shapes are those of a part that is flipped.
fn two_sided(parts: &[Part]) -> Vec<bool> {
    let backs: Vec<_> = parts.iter().filter(|part| part.cutting.flipped).map(|part| &part.shapes).collect();
    let has_back =
        |part: &Part| !part.cutting.flipped && backs.iter().any(|back| Arc::ptr_eq(back, &part.shapes));
    parts.iter().map(has_back).collect()
}

//! The state between two rounds as bytes, little-endian: what was split, the links, the radiosity,
//! the goal with the importance, and the rounds. Floating-point numbers keep their bits.
//!
//! The tree is not saved but grown again: the same splits of the same mesh give the same tree.

use crate::driver::{Problem, Round, Stated};
use crate::{HierarchyError, Link, State, Tree};
use fredholm_linop::MultiVector;
use std::io::{self, Read, Write};
use std::sync::Arc;

/// First bytes of a state.
const MARK: &[u8; 8] = b"FREDHR02";
/// Bytes of a link.
const BYTES_A_LINK: usize = 4 + 4 + 8 + 6 * 4 + 6 * 4 + 1;
/// Most elements of a list that are believed before they have been read.
const MOST_ELEMENTS_BELIEVED: u64 = 1 << 20;

impl State {
    /// Writes the state.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(MARK)?;
        list(out, self.goal.iter().map(|&surface| (surface as u64).to_le_bytes()))?;
        list(out, self.tree.splits().iter().map(|split| split.to_le_bytes()))?;
        list(out, self.links.iter().map(link_bytes))?;
        numbers(out, self.radiosity.as_slice())?;
        numbers(out, self.importance.as_slice())?;
        numbers(out, &self.faces)?;
        out.write_all(&self.threshold.to_le_bytes())?;
        list(out, self.rounds.iter().map(round_bytes))?;
        let none = Stated { relative_l2: Vec::new(), largest: Vec::new() };
        let error = self.error.as_ref().unwrap_or(&none);
        numbers(out, &error.relative_l2)?;
        numbers(out, &error.largest)?;
        out.write_all(&[u8::from(self.limited)])
    }

    /// Reads the state of a problem.
    ///
    /// # Errors
    /// [`HierarchyError::State`] for bytes that are damaged or belong to another problem.
    pub fn read(problem: &Problem, bytes: &mut dyn Read) -> Result<Self, HierarchyError> {
        let mut source = Source(bytes);
        if source.array()? != *MARK {
            return Err(HierarchyError::State { why: "is none of this version" });
        }
        let mut state = Self::new(problem, 0.0)?;
        if source.list(|s| Ok(u64::from_le_bytes(s.array()?) as usize))? != state.goal {
            return Err(HierarchyError::State { why: "belongs to another goal" });
        }
        for split in source.list(|s| Ok(u32::from_le_bytes(s.array()?)))? {
            grow(&mut state.tree, split)?;
        }
        state.links = Arc::new(source.list(Source::link)?);
        let (bands, leaves) = (state.radiosity.rhs_count(), state.tree.leaves().len());
        let foreign = |_| HierarchyError::State { why: "belongs to another scene" };
        state.radiosity = MultiVector::from_vec(leaves, bands, source.numbers()?).map_err(foreign)?;
        let bands = state.importance.rhs_count();
        state.importance = MultiVector::from_vec(leaves, bands, source.numbers()?).map_err(foreign)?;
        state.faces = source.numbers()?;
        state.threshold = source.number()?;
        state.rounds = source.list(Source::round)?;
        let (relative_l2, largest) = (source.numbers()?, source.numbers()?);
        state.error = (!relative_l2.is_empty()).then_some(Stated { relative_l2, largest });
        state.limited = source.array::<1>()? == [1];
        state.checked(problem)
    }

    /// Refuses what does not fit its tree.
    fn checked(self, problem: &Problem) -> Result<Self, HierarchyError> {
        let nodes = self.tree.nodes();
        let known = |index: u32| (index as usize) < nodes.len();
        let faces = problem.mesh.faces().len() * self.radiosity.rhs_count();
        let fits = self.links.iter().all(|link| known(link.a) && known(link.b) && link.open.is_finite())
            && (self.faces.len() == faces || self.rounds.is_empty())
            && self.radiosity.not_finite().is_none()
            && self.importance.not_finite().is_none();
        if fits { Ok(self) } else { Err(HierarchyError::State { why: "belongs to another scene" }) }
    }
}

fn grow(tree: &mut Tree, split: u32) -> Result<(), HierarchyError> {
    let leaf = tree.nodes().get(split as usize).is_some_and(|node| node.is_leaf() && node.patch().is_some());
    if leaf { tree.split(split) } else { Err(HierarchyError::State { why: "belongs to another scene" }) }
}

fn list<const N: usize>(
    out: &mut dyn Write,
    items: impl ExactSizeIterator<Item = [u8; N]>,
) -> io::Result<()> {
    out.write_all(&(items.len() as u64).to_le_bytes())?;
    items.into_iter().try_for_each(|item| out.write_all(&item))
}

fn numbers(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    list(out, values.iter().map(|value| value.to_le_bytes()))
}

fn link_bytes(link: &Link) -> [u8; BYTES_A_LINK] {
    let mut bytes = [0; BYTES_A_LINK];
    let singles = [link.share, link.doubt, link.deviation[0], link.deviation[1], link.rest[0], link.rest[1]];
    let gradients = link.gradient.iter().flat_map(glam::Vec3::to_array);
    bytes[..4].copy_from_slice(&link.a.to_le_bytes());
    bytes[4..8].copy_from_slice(&link.b.to_le_bytes());
    bytes[8..16].copy_from_slice(&link.open.to_le_bytes());
    for (place, single) in
        bytes[16..BYTES_A_LINK - 1].chunks_exact_mut(4).zip(singles.into_iter().chain(gradients))
    {
        place.copy_from_slice(&single.to_le_bytes());
    }
    bytes[BYTES_A_LINK - 1] = u8::from(link.partly);
    bytes
}

fn round_bytes(round: &Round) -> [u8; 32] {
    let mut bytes = [0; 32];
    let change = round.change.unwrap_or(f64::NAN);
    bytes[..8].copy_from_slice(&round.threshold.to_le_bytes());
    bytes[8..16].copy_from_slice(&(round.elements as u64).to_le_bytes());
    bytes[16..24].copy_from_slice(&(round.links as u64).to_le_bytes());
    bytes[24..].copy_from_slice(&change.to_le_bytes());
    bytes
}

/// Bytes to be read.
struct Source<'a>(&'a mut dyn Read);

impl Source<'_> {
    fn array<const N: usize>(&mut self) -> Result<[u8; N], HierarchyError> {
        let mut bytes = [0; N];
        let short = |_| HierarchyError::State { why: "is cut short" };
        self.0.read_exact(&mut bytes).map_err(short)?;
        Ok(bytes)
    }

    fn number(&mut self) -> Result<f64, HierarchyError> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    fn single(&mut self) -> Result<f32, HierarchyError> {
        Ok(f32::from_le_bytes(self.array()?))
    }

    fn numbers(&mut self) -> Result<Vec<f64>, HierarchyError> {
        self.list(Self::number)
    }

    fn list<T>(
        &mut self,
        mut item: impl FnMut(&mut Self) -> Result<T, HierarchyError>,
    ) -> Result<Vec<T>, HierarchyError> {
        let count = u64::from_le_bytes(self.array()?);
        let mut items = Vec::with_capacity(count.min(MOST_ELEMENTS_BELIEVED) as usize);
        for _ in 0..count {
            items.push(item(self)?);
        }
        Ok(items)
    }

    fn link(&mut self) -> Result<Link, HierarchyError> {
        let (a, b) = (u32::from_le_bytes(self.array()?), u32::from_le_bytes(self.array()?));
        let open = self.number()?;
        let (share, doubt) = (self.single()?, self.single()?);
        let (deviation, rest) = ([self.single()?, self.single()?], [self.single()?, self.single()?]);
        let gradient = [self.vector()?, self.vector()?];
        let partly = self.array::<1>()? == [1];
        Ok(Link { a, b, open, share, doubt, deviation, rest, gradient, partly })
    }

    fn vector(&mut self) -> Result<glam::Vec3, HierarchyError> {
        Ok(glam::Vec3::new(self.single()?, self.single()?, self.single()?))
    }

    fn round(&mut self) -> Result<Round, HierarchyError> {
        let threshold = self.number()?;
        let elements = u64::from_le_bytes(self.array()?) as usize;
        let links = u64::from_le_bytes(self.array()?) as usize;
        let change = self.number()?;
        Ok(Round { threshold, elements, links, change: (!change.is_nan()).then_some(change) })
    }
}

//! Element trees: splitting leaves, and walking from parent to children.
//!
//! A split replaces a leaf by four similar elements in its place, so that the leaves of a face stay
//! together and the order of the unknowns does not depend on the order of the splits.

use std::iter::successors;
use std::ops::Range;

use crate::builder::MOST_ELEMENTS;
use crate::mesh::Element;
use crate::{Mesh, MeshError, Patch};

impl Mesh {
    /// Splits a leaf into four elements at the middles of its sides and returns their indices in
    /// [`elements`](Self::elements). Its unknown is replaced by four; the unknowns behind it move
    /// by three.
    ///
    /// # Errors
    /// [`MeshError::NotALeaf`] for an element that has children or does not exist;
    /// [`MeshError::NoArea`] where the pieces would be too small for the precision of their
    /// coordinates; [`MeshError::TooLarge`] past 2³² − 1 elements.
    pub fn split(&mut self, element: usize) -> Result<[usize; 4], MeshError> {
        let leaf = self.leaf_of(element).ok_or(MeshError::NotALeaf { element })?;
        let pieces = self.elements[element].patch.split()?;
        let first = self.add_children(element, &pieces)?;
        self.leaves.splice(leaf..=leaf, first..first + 4);
        Ok([first, first + 1, first + 2, first + 3])
    }

    /// Gives an element four children, the first of which is returned.
    fn add_children(&mut self, element: usize, pieces: &[Patch; 4]) -> Result<usize, MeshError> {
        let Element { face, level, .. } = self.elements[element];
        let first = self.elements.len();
        if first + 4 > MOST_ELEMENTS {
            return Err(MeshError::TooLarge { limit: MOST_ELEMENTS });
        }
        let child = |patch| Element { patch, face, parent: Some(element), children: None, level: level + 1 };
        self.elements.extend(pieces.iter().copied().map(child));
        self.elements[element].children = Some(first);
        Ok(first)
    }

    /// Splits all leaves that are chosen, by the number of their unknown, each as
    /// [`split`](Self::split) does. A leaf whose pieces would be too small for the precision of
    /// their coordinates stays whole.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] past 2³² − 1 elements.
    pub fn split_leaves(&mut self, chosen: impl Fn(usize) -> bool) -> Result<(), MeshError> {
        let mut leaves = Vec::with_capacity(self.leaves.len());
        for unknown in 0..self.leaves.len() {
            let element = self.leaves[unknown];
            let patch = self.elements[element].patch;
            match chosen(unknown).then(|| patch.split().ok()).flatten() {
                Some(pieces) => {
                    let first = self.add_children(element, &pieces)?;
                    leaves.extend(first..first + 4);
                }
                None => leaves.push(element),
            }
        }
        self.leaves = leaves;
        Ok(())
    }

    /// The unknown that lives on an element; none where the element is not a leaf.
    #[must_use]
    pub fn leaf_of(&self, element: usize) -> Option<usize> {
        let range = self.leaves_of_face(self.elements.get(element)?.face);
        let place = self.leaves[range.clone()].iter().position(|&leaf| leaf == element)?;
        Some(range.start + place)
    }

    /// The unknowns of a face; none for a face that does not exist.
    #[must_use]
    pub fn leaves_of_face(&self, face: usize) -> Range<usize> {
        let before =
            |limit: usize| self.leaves.partition_point(|&element| self.elements[element].face < limit);
        before(face)..before(face.saturating_add(1))
    }

    /// The elements that a face was given, before any split; none for a face that does not exist.
    #[must_use]
    pub fn roots_of_face(&self, face: usize) -> Range<usize> {
        let roots = &self.elements[..self.elements.partition_point(|element| element.parent.is_none())];
        let before = |limit: usize| roots.partition_point(|element| element.face < limit);
        before(face)..before(face.saturating_add(1))
    }

    /// The four children of an element; none for a leaf or an element that does not exist.
    #[must_use]
    pub fn children(&self, element: usize) -> Range<usize> {
        self.elements.get(element).and_then(|e| e.children).map_or(0..0, |first| first..first + 4)
    }

    /// The parent of an element, its parent, and so on up to the root.
    pub fn ancestors(&self, element: usize) -> impl Iterator<Item = usize> {
        let parent = |element: usize| self.elements.get(element).and_then(|e| e.parent);
        successors(parent(element), move |&element| parent(element))
    }
}

//! Puts a mesh together: from shapes, or face by face.

use std::ops::Range;

use crate::facet::Facet;
use crate::mesh::{Cut, Element, Face, Mesh, Surface};
use crate::solid::Solid;
use crate::{Cutting, MeshError, Patch, Shape, Vec3};

/// Largest number of elements: indices are stored in 32 bits.
pub(crate) const MOST_ELEMENTS: usize = u32::MAX as usize;

/// Collects surfaces, faces and occluders into a [`Mesh`].
///
/// ```
/// use fredholm_mesh::{Cutting, Lines, MeshBuilder, Shape, Vec3};
///
/// let mut builder = MeshBuilder::default();
/// builder.surface("room", 0);
/// let room = Shape::Box { min: Vec3::ZERO, max: Vec3::new(4.0, 5.0, 3.0), inward: true };
/// let faces = builder.add(&room, &Cutting { lines: Lines::LargestEdge(1.0), ..Cutting::default() })?;
/// let mesh = builder.build();
/// assert_eq!(faces, 0..2 * (4 * 5 + 5 * 3 + 3 * 4));
/// assert_eq!(mesh.occluders().len(), 6);
/// # Ok::<(), fredholm_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct MeshBuilder {
    mesh: Mesh,
}

impl MeshBuilder {
    /// Starts a surface; the faces that follow belong to it.
    pub fn surface(&mut self, name: impl Into<String>, material: usize) -> usize {
        self.mesh.surfaces.push(Surface { name: name.into(), material });
        self.mesh.surfaces.len() - 1
    }

    /// Adds an undivided piece of geometry that blocks the view.
    pub fn occluder(&mut self, patch: Patch) {
        self.mesh.occluders.push(patch);
    }

    /// Adds a face of the last surface, computed on the given root elements, and returns its index.
    ///
    /// # Errors
    /// [`MeshError::NoSurface`] before the first surface; [`MeshError::TooLarge`] past 2³² − 1
    /// elements; [`MeshError::NoArea`] for a face of no element.
    pub fn face(&mut self, roots: &[Patch]) -> Result<usize, MeshError> {
        let surface = self.mesh.surfaces.len().checked_sub(1).ok_or(MeshError::NoSurface)?;
        let (area, centroid) = mean(roots)?;
        self.check_room(roots.len() as u128)?;
        let face = self.mesh.faces.len();
        self.mesh.faces.push(Face { surface, area, centroid });
        for &patch in roots {
            self.mesh.leaves.push(self.mesh.elements.len());
            self.mesh.elements.push(Element { patch, face, parent: None, children: None, level: 0 });
        }
        Ok(face)
    }

    /// Cuts a shape into faces of the last surface, adds what it blocks, and returns the indices of
    /// the faces.
    ///
    /// The undivided flat pieces of the shape become occluders, unless the cutting is flipped. On
    /// an error nothing is added.
    ///
    /// # Errors
    /// [`MeshError::NoSurface`] before the first surface; [`MeshError::TooLarge`] past 2³² − 1
    /// elements, before memory is taken; any other [`MeshError`] for a shape that encloses no area
    /// or crosses itself, or lines that do not fit it.
    pub fn add(&mut self, shape: &Shape, cutting: &Cutting) -> Result<Range<usize>, MeshError> {
        let solid = Solid::new(shape)?;
        self.check_room(solid.count(cutting)?)?;
        let (faces, elements) = (self.mesh.faces.len(), self.mesh.elements.len());
        let occluders = self.mesh.occluders.len();
        let outcome = self.cut(&solid, cutting, shape.is_inward() != cutting.flipped);
        if outcome.is_err() {
            self.mesh.faces.truncate(faces);
            self.mesh.elements.truncate(elements);
            self.mesh.leaves.truncate(elements);
        }
        outcome?;
        let faces = faces..self.mesh.faces.len();
        let occluders = occluders..self.mesh.occluders.len();
        self.mesh.shapes.push(Cut { faces: faces.clone(), occluders });
        Ok(faces)
    }

    /// The finished mesh.
    #[must_use]
    pub fn build(self) -> Mesh {
        self.mesh
    }

    fn cut(&mut self, solid: &Solid, cutting: &Cutting, reversed: bool) -> Result<(), MeshError> {
        let facets = solid.facets()?;
        if solid.is_one_face(&cutting.lines) {
            let pieces: Vec<Patch> = facets.iter().filter_map(Facet::flat).copied().collect();
            self.pieces(&pieces, cutting.elements_per_side, reversed)?;
        } else {
            self.faces(solid, &facets, cutting, reversed)?;
        }
        if !cutting.flipped {
            let blockers = solid.blockers(&facets, &cutting.lines)?;
            self.mesh.occluders.extend(blockers.iter().map(|patch| turned(patch, reversed)));
        }
        Ok(())
    }

    fn faces(
        &mut self,
        solid: &Solid,
        facets: &[Facet],
        cutting: &Cutting,
        reversed: bool,
    ) -> Result<(), MeshError> {
        let mut rest = facets.iter();
        for group in solid.groups() {
            let grid = cutting.lines.grid(group.form)?;
            let skipped = solid.skipped(grid)?;
            for facet in rest.by_ref().take(group.number as usize) {
                for index in grid.kept(&skipped) {
                    self.pieces(&facet.face(grid, index)?, cutting.elements_per_side, reversed)?;
                }
            }
        }
        Ok(())
    }

    /// Adds a face of flat pieces, each divided into n² elements.
    fn pieces(&mut self, pieces: &[Patch], n: usize, reversed: bool) -> Result<usize, MeshError> {
        let elements = pieces.iter().flat_map(|piece| (0..n * n).map(move |index| piece.piece_of(n, index)));
        let roots: Vec<Patch> =
            elements.map(|e| e.map(|e| turned(&e, reversed))).collect::<Result<_, _>>()?;
        self.face(&roots)
    }

    fn check_room(&self, more: u128) -> Result<(), MeshError> {
        let total = more.saturating_add(self.mesh.elements.len() as u128);
        if total > MOST_ELEMENTS as u128 { Err(MeshError::TooLarge { limit: MOST_ELEMENTS }) } else { Ok(()) }
    }
}

fn turned(patch: &Patch, reversed: bool) -> Patch {
    if reversed { patch.flipped() } else { *patch }
}

fn mean(roots: &[Patch]) -> Result<(f64, Vec3), MeshError> {
    let area: f64 = roots.iter().map(Patch::area).sum();
    if roots.is_empty() || !area.is_finite() {
        return Err(MeshError::NoArea { area, longest: 0.0 });
    }
    let centroid = roots.iter().map(|p| p.centroid() * (p.area() / area)).sum();
    Ok((area, centroid))
}

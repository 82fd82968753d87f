//! How the surfaces are cut into facets for a wavelength.

use std::f64::consts::TAU;

use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, MeshError, Shape};
use fredholm_waves::material::Material;
use fredholm_waves::surface::sphere_segments;
use fredholm_waves::{Kind, Scatterer, WaveError};

use super::scene::{WaveScene, refused};
use super::surface::{Edge, Part, meshing};
use crate::error::{ErrorKind, SceneError};

/// Most facets of a scene.
const MOST_FACETS: u128 = 5_000_000;

/// How fine the facets are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuts {
    /// The wavelength that parts of it refer to, m.
    pub wavelength: f64,
    /// Factor on all edges.
    pub stretch: f64,
    /// Whether surfaces without edges of their own may be left whole.
    pub whole: bool,
}

/// Surfaces that are ready to be meshed.
#[derive(Debug)]
pub struct Cut<'a> {
    scene: &'a WaveScene,
    /// The shapes of every part with how each is cut.
    parts: Vec<Vec<(Shape, Cutting)>>,
    facets: u128,
}

impl WaveScene {
    /// Finds how the surfaces are cut, and into how many facets.
    ///
    /// # Errors
    /// [`SceneError`] with the surface that cannot be cut so, or into more facets than there may
    /// be.
    pub fn cut(&self, cuts: Cuts) -> Result<Cut<'_>, SceneError> {
        let whole = cuts.whole && self.is_one_convex_shape();
        let (mut parts, mut facets) = (vec![], 0_u128);
        for part in self.parts() {
            let mut shapes = vec![];
            for shape in &part.shapes {
                let (shape, cutting) = self.ready(part, shape, cuts, whole)?;
                let count = shape.count(&cutting);
                let count = count.map_err(|error| self.unmeshable(part, &error))?;
                facets = facets.saturating_add(count);
                shapes.push((shape, cutting));
            }
            if facets > MOST_FACETS {
                let what = format!("the scene would have {facets} facets, more than {MOST_FACETS}");
                let span = part.edge_span.clone();
                return Err(self.source().error(ErrorKind::TooLarge, span, what, "take longer edges; or are the lengths not in metres? mesh = { …, scale = 0.001 } takes millimetres"));
            }
            parts.push(shapes);
        }
        Ok(Cut { scene: self, parts, facets })
    }

    /// Whether nothing can hide a part of anything: one flat plate, or one box.
    fn is_one_convex_shape(&self) -> bool {
        match self.parts() {
            [Part { shapes, .. }] => matches!(
                shapes.as_slice(),
                [Shape::Quad { .. } | Shape::Triangle { .. } | Shape::Box { inward: false, .. }]
            ),
            _ => false,
        }
    }

    /// A shape with its segments, and how it is cut.
    fn ready(
        &self,
        part: &Part,
        shape: &Shape,
        cuts: Cuts,
        whole: bool,
    ) -> Result<(Shape, Cutting), SceneError> {
        if whole && part.edge == Edge::Unsaid {
            return Ok((shape.clone(), Cutting::default()));
        }
        let edge = cuts.stretch * part.edge.metres(cuts.wavelength);
        let lines = Cutting { lines: Lines::LargestEdge(edge), ..Cutting::default() };
        if !part.follows_edge {
            return Ok((shape.clone(), lines));
        }
        let around = |radius: f64| (TAU * radius / edge).ceil().clamp(6.0, 1e9) as usize;
        let mut shape = shape.clone();
        match &mut shape {
            Shape::Sphere { radius, segments, .. } => {
                *segments = sphere_segments(*radius, edge)
                    .map_err(|error| refused(self.source(), part.span.clone(), &error))?;
                // The triangles of the sphere are the facets.
                return Ok((shape, Cutting::default()));
            }
            Shape::Disc { radius, segments, .. } => *segments = around(*radius),
            Shape::Cylinder { base, axis, radius, caps, segments, .. } => {
                *segments = around(*radius);
                let cap = Shape::Disc { centre: *base, normal: *axis, radius: *radius, segments: *segments };
                if *caps {
                    *segments = uncut(cap, &lines).unwrap_or(*segments);
                }
            }
            _ => {}
        }
        Ok((shape, lines))
    }

    fn unmeshable(&self, part: &Part, error: &MeshError) -> SceneError {
        meshing(self.source(), part, error, (self.source(), part.span.clone()))
    }
}

/// Segments of a disc, those that it has or more, with which none of its triangles is longer than
/// asked for: cut triangles of a cap would have vertices within the edges of the side. Where there
/// would be more facets than there may be, these are refused later.
fn uncut(mut cap: Shape, lines: &Cutting) -> Option<usize> {
    loop {
        let Shape::Disc { segments, .. } = &cap else { return None };
        let segments = *segments;
        let whole = cap.count(&Cutting::default()).ok().filter(|&count| count <= MOST_FACETS)?;
        if whole == cap.count(lines).ok()? {
            return Some(segments);
        }
        if let Shape::Disc { segments, .. } = &mut cap {
            *segments += 1 + *segments / 25;
        }
    }
}

impl Cut<'_> {
    /// Number of facets, known without making them.
    #[must_use]
    pub fn facets(&self) -> u128 {
        self.facets
    }

    /// The mesh; a surface of it is a part of the scene.
    ///
    /// # Errors
    /// [`SceneError`] with the surface that cannot be meshed.
    pub fn mesh(&self) -> Result<Mesh, SceneError> {
        let mut builder = MeshBuilder::default();
        for (number, (part, shapes)) in self.scene.parts().iter().zip(&self.parts).enumerate() {
            builder.surface(part.name.clone(), number);
            for (shape, cutting) in shapes {
                builder.add(shape, cutting).map_err(|error| self.scene.unmeshable(part, &error))?;
            }
        }
        Ok(builder.build())
    }
}

impl WaveScene {
    /// Whether each surface is a sheet or a part of a closed body.
    #[must_use]
    pub fn kinds(&self) -> Vec<Kind> {
        self.parts().iter().map(|part| part.kind).collect()
    }

    /// The shape of each surface, where it is one alone.
    pub fn single_shapes(&self) -> impl Iterator<Item = Option<&Shape>> {
        self.parts().iter().map(|part| match part.shapes.as_slice() {
            [shape] => Some(shape),
            _ => None,
        })
    }

    /// The scatterer of a mesh of this scene, made of these materials (those of
    /// [`materials`](Self::materials)).
    ///
    /// # Errors
    /// [`WaveError`] for a mesh without facets, or one too large or too small.
    pub fn scatterer(&self, mesh: &Mesh, materials: &[Material]) -> Result<Scatterer, WaveError> {
        let of_parts = self.parts().iter().map(|part| materials[part.material].clone()).collect();
        let kind = |surface: usize| self.parts().get(surface).map_or(Kind::Sheet, |part| part.kind);
        let mut scatterer = Scatterer::new(mesh, kind)?.made_of(of_parts)?;
        for (surface, shape) in self.single_shapes().enumerate() {
            if let Some(Shape::Sphere { centre, radius, .. }) = shape {
                scatterer = scatterer.on_sphere(surface, *centre, *radius);
            }
        }
        Ok(scatterer)
    }
}

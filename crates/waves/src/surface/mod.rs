//! The meshed scatterer: facets with centre, normal and tangents.
//!
//! Facet q carries the frame (t₁, t₂, n), right-handed: n = t₁ × t₂ is the normal of its patch,
//! which of a closed body points outwards; t₁ runs along the first side. A tangential vector is x =
//! x₁ t₁ + x₂ t₂. Lengths in metres.

mod shapes;

pub use shapes::{
    cube, cuboid, dihedral, facing_plates, parallel_plates, plate, rectangle, sphere, sphere_segments,
    trihedral,
};

use crate::material::Material;
use crate::source::Origin;
use crate::{Wave, WaveError};
use fredholm_mesh::{Mesh, Patch, Vec3};
use fredholm_visibility::Occluders;

/// Cosine between a direction and a normal up to which the direction lies in the plane.
pub(crate) const GRAZING_COSINE: f64 = 1e-9;

/// What a facet is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The surface of a closed body: only the side of the normal is outside.
    Closed,
    /// A sheet without thickness: both sides are outside.
    Sheet,
}

/// A flat piece of the scatterer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Its outline, m.
    pub patch: Patch,
    /// Where its node is, m: the centroid, or the place on the curved surface that it stands for.
    pub centre: Vec3,
    /// Unit normal n at the node.
    pub normal: Vec3,
    /// Unit tangents t₁, t₂ with t₁ × t₂ = n.
    pub tangents: [Vec3; 2],
    /// Area it stands for, m².
    pub area: f64,
    /// Longest side or diagonal, m.
    pub diameter: f64,
    /// What it is part of.
    pub kind: Kind,
    /// Surface of the mesh it is part of.
    pub surface: usize,
}

impl Facet {
    /// The facet of a patch.
    #[must_use]
    pub fn new(patch: &Patch, kind: Kind) -> Self {
        let first = (patch.corner(1) - patch.corner(0)).normalize_or_zero();
        let normal = patch.normal();
        // Exact orthogonality: the side is in the plane of a quad up to rounding only.
        let first = (first - normal * first.dot(normal)).normalize_or_zero();
        Self {
            patch: *patch,
            centre: patch.centroid(),
            normal,
            tangents: [first, normal.cross(first)],
            area: patch.area(),
            diameter: patch.diameter(),
            kind,
            surface: 0,
        }
    }

    /// Longest side, m.
    #[must_use]
    pub fn edge(&self) -> f64 {
        let sides = 0..self.patch.sides();
        sides.map(|i| self.patch.corner(i).distance(self.patch.corner(i + 1))).fold(0.0, f64::max)
    }

    /// +1 if `towards` (unit vector from the facet) is on the side of the normal; −1 behind a
    /// sheet, 0 behind a closed body and, whatever rounding says, in the plane of the facet.
    #[must_use]
    pub fn side(&self, towards: Vec3) -> f64 {
        let height = self.normal.dot(towards);
        if height > GRAZING_COSINE {
            1.0
        } else if self.kind == Kind::Sheet && height < -GRAZING_COSINE {
            -1.0
        } else {
            0.0
        }
    }
}

/// All facets, and what blocks the view.
#[derive(Clone, Debug)]
pub struct Scatterer {
    facets: Vec<Facet>,
    occluders: Occluders,
    extent: f64,
    /// Per surface; perfect conductors beyond the end.
    materials: Vec<Material>,
    /// Centres and radii of spheres that faces stand for.
    spheres: Vec<(Vec3, f64)>,
}

impl Scatterer {
    /// Takes the leaves of a mesh; `kind` says what each of its surfaces (by index) is.
    ///
    /// # Errors
    /// [`WaveError::NoFacets`] for an empty mesh, [`WaveError::Visibility`] for one too large or
    /// too small.
    pub fn new(mesh: &Mesh, kind: impl Fn(usize) -> Kind) -> Result<Self, WaveError> {
        let Some(bounds) = mesh.bounds() else { return Err(WaveError::NoFacets) };
        let surfaces = (0..mesh.len()).map(|leaf| mesh.surface_of(leaf));
        let facet = |(patch, surface)| Facet { surface, ..Facet::new(patch, kind(surface)) };
        let facets = mesh.patches().zip(surfaces).map(facet).collect();
        let occluders = Occluders::new(mesh.occluders())?;
        let extent = bounds.max.distance(bounds.min);
        Ok(Self { facets, occluders, extent, materials: Vec::new(), spheres: Vec::new() })
    }

    /// The same of these materials, one a surface of the mesh; it is a perfect conductor before.
    ///
    /// # Errors
    /// [`WaveError::Material`] for a material that gives energy away.
    pub fn made_of(mut self, materials: Vec<Material>) -> Result<Self, WaveError> {
        for (surface, material) in materials.iter().enumerate() {
            material.check(&format!("of surface {surface}"))?;
        }
        self.materials = materials;
        Ok(self)
    }

    /// The material of a facet.
    #[must_use]
    pub fn material(&self, facet: &Facet) -> &Material {
        self.materials.get(facet.surface).unwrap_or(&Material::Conductor)
    }

    /// Refuses other materials than perfect conductors.
    ///
    /// # Errors
    /// [`WaveError::NotConductor`] with the first facet of another one.
    pub fn check_conductor(&self, what: &'static str) -> Result<(), WaveError> {
        let other = |facet: &Facet| *self.material(facet) != Material::Conductor;
        match self.facets.iter().position(other) {
            Some(facet) => Err(WaveError::NotConductor { what, facet }),
            None => Ok(()),
        }
    }

    /// Moves the nodes and normals of a surface of the mesh to the sphere that it stands for: the
    /// equation for currents at the nodes then has the curvature right. Normals keep their side.
    #[must_use]
    pub fn on_sphere(mut self, surface: usize, centre: Vec3, radius: f64) -> Self {
        for facet in self.facets.iter_mut().filter(|facet| facet.surface == surface) {
            let out = (facet.centre - centre).normalize_or(facet.normal);
            facet.centre = centre + out * radius;
            facet.normal = out * out.dot(facet.normal).signum();
            let first = facet.tangents[0] - facet.normal * facet.normal.dot(facet.tangents[0]);
            let first = first.normalize_or_zero();
            facet.tangents = [first, facet.normal.cross(first)];
        }
        self.spheres.push((centre, radius));
        self
    }

    /// Whether a face stands for a part of a sphere.
    #[must_use]
    pub fn is_curved(&self, face: &Patch) -> bool {
        let on = |&(centre, radius): &(Vec3, f64)| {
            face.corners().iter().all(|p| (p.distance(centre) - radius).abs() <= 1e-9 * radius)
        };
        self.spheres.iter().any(on)
    }

    /// The facets.
    #[must_use]
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// What blocks the view.
    #[must_use]
    pub fn occluders(&self) -> &Occluders {
        &self.occluders
    }

    /// Whether nothing blocks the way from the point `p` of the surface to a source.
    #[must_use]
    pub fn sees(&self, p: Vec3, origin: Origin) -> bool {
        let end = match origin {
            Origin::Point(source) => source,
            // Twice the extent away, everything lies behind.
            Origin::Direction(travel) => p - travel * (2.0 * self.extent),
        };
        self.occluders.unoccluded(p, end)
    }

    /// Diagonal of the smallest box around everything, m.
    #[must_use]
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// Sum of the areas, m².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.facets.iter().map(|facet| facet.area).sum()
    }

    /// Refuses facets with edges above λ/2, on which a wave cannot be told from its alias.
    ///
    /// # Errors
    /// [`WaveError::Coarse`] with the first such facet.
    pub fn check_resolution(&self, wave: &Wave) -> Result<(), WaveError> {
        let wavelength = wave.wavelength();
        // Meshing rounds edges; λ/2 itself is allowed.
        let coarse = |facet: &Facet| facet.edge() > 0.5 * wavelength * (1.0 + 1e-9);
        match self.facets.iter().position(coarse) {
            Some(facet) => Err(WaveError::Coarse { facet, edge: self.facets[facet].edge(), wavelength }),
            None => Ok(()),
        }
    }
}

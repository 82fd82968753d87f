//! Surfaces and materials of a scene.

use std::collections::BTreeMap;

use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Shape};
use fredholm_waves::material::{Layer, Material, itu_permittivity};
use fredholm_waves::surface::sphere_segments;
use fredholm_waves::{Complex64, Kind, Scatterer, Wave, WaveError};
use toml::Spanned;

use super::format::{DielectricEntry, EdgeEntry, MaterialEntry, SceneEntry, SphereEntry, SurfaceEntry};
use super::located::SceneText;
use super::sources::vector;
use crate::error::Error;

/// Most facets of a scene.
const MOST: u128 = 5_000_000;

/// Edges a wavelength where the scene does not say.
const PER_WAVELENGTH: f64 = 10.0;

/// The meshed surfaces: what they are, before their materials, which depend on the frequency.
pub(crate) struct Geometry {
    pub(crate) mesh: Mesh,
    kinds: Vec<Kind>,
    spheres: Vec<Option<SphereEntry>>,
}

impl Geometry {
    /// Cuts the surfaces for the shortest wavelength, with edges `stretch` times as long as the
    /// scene says, where `admit` allows so many facets.
    pub(super) fn new(
        scene: &SceneText,
        entry: SceneEntrySurfaces<'_>,
        wavelength: f64,
        stretch: f64,
        admit: &dyn Fn(u128) -> Result<(), Error>,
    ) -> Result<Self, Error> {
        if entry.is_empty() {
            let help = "add a [[surface]] with a name and quad, triangle, box or sphere";
            return Err(scene.fault(scene.end(), "the scene has no surface", help));
        }
        let refused =
            |surface: &Spanned<SurfaceEntry>, error: WaveError| scene.refused(surface.span(), &error);
        let (mut facets, mut shapes) = (0_u128, Vec::new());
        for surface in entry {
            let (shape, cutting) = shape(scene, surface, (wavelength, stretch))?;
            facets += shape.count(&cutting).map_err(|error| refused(surface, error.into()))?;
            if facets > MOST {
                let what = format!("the scene would have {facets} facets, more than {MOST}");
                return Err(scene.fault(surface.span(), what, "take longer edges"));
            }
            shapes.push((shape, cutting));
        }
        admit(facets)?;
        let (mut builder, mut kinds, mut spheres) = (MeshBuilder::default(), Vec::new(), Vec::new());
        for (index, (surface, (shape, cutting))) in entry.iter().zip(&shapes).enumerate() {
            builder.surface(surface.get_ref().name.clone(), index);
            builder.add(shape, cutting).map_err(|error| refused(surface, error.into()))?;
            kinds.push(kind(surface.get_ref()));
            spheres.push(
                surface.get_ref().sphere.as_ref().map(|s| SphereEntry { centre: s.centre, radius: s.radius }),
            );
        }
        Ok(Self { mesh: builder.build(), kinds, spheres })
    }

    /// What each surface is part of.
    pub(super) fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// The scatterer at one frequency.
    pub(crate) fn scatterer(&self, materials: Vec<Material>) -> Result<Scatterer, WaveError> {
        let mut scatterer = Scatterer::new(&self.mesh, |surface| self.kinds[surface])?.made_of(materials)?;
        for (surface, sphere) in self.spheres.iter().enumerate() {
            if let Some(SphereEntry { centre, radius }) = sphere {
                scatterer = scatterer.on_sphere(surface, vector(centre), *radius);
            }
        }
        Ok(scatterer)
    }
}

type SceneEntrySurfaces<'a> = &'a [Spanned<SurfaceEntry>];

fn kind(entry: &SurfaceEntry) -> Kind {
    let solid = entry.cuboid.is_some() || entry.sphere.is_some();
    if entry.closed.unwrap_or(solid) { Kind::Closed } else { Kind::Sheet }
}

fn shape(
    scene: &SceneText,
    surface: &Spanned<SurfaceEntry>,
    (wavelength, stretch): (f64, f64),
) -> Result<(Shape, Cutting), Error> {
    let entry = surface.get_ref();
    let edge = stretch * edge(scene, entry, wavelength)?;
    let lines = Cutting { lines: Lines::LargestEdge(edge), ..Cutting::default() };
    match (&entry.quad, &entry.triangle, &entry.cuboid, &entry.sphere) {
        (Some(corners), None, None, None) => {
            Ok((Shape::Quad { corners: corners.map(|c| vector(&c)), skip: Vec::new() }, lines))
        }
        (None, Some(corners), None, None) => {
            Ok((Shape::Triangle { corners: corners.map(|c| vector(&c)) }, lines))
        }
        (None, None, Some(cuboid), None) => {
            let (min, max) = (vector(&cuboid.min), vector(&cuboid.max));
            Ok((Shape::Box { min, max, inward: cuboid.inward }, lines))
        }
        (None, None, None, Some(SphereEntry { centre, radius })) => {
            let segments =
                sphere_segments(*radius, edge).map_err(|error| scene.refused(surface.span(), &error))?;
            let shape = Shape::Sphere { centre: vector(centre), radius: *radius, inward: false, segments };
            Ok((shape, Cutting::default()))
        }
        _ => {
            let what = format!("the surface `{}` needs exactly one shape", entry.name);
            Err(scene.fault(surface.span(), what, "give one of quad, triangle, box, sphere"))
        }
    }
}

/// The longest edge, m.
fn edge(scene: &SceneText, entry: &SurfaceEntry, wavelength: f64) -> Result<f64, Error> {
    let Some(given) = &entry.edge else { return Ok(wavelength / PER_WAVELENGTH) };
    let length = match given.get_ref() {
        EdgeEntry::Metres(length) => Some(*length),
        EdgeEntry::Text(text) if text == "lambda" => Some(wavelength),
        EdgeEntry::Text(text) => {
            text.strip_prefix("lambda/").and_then(|n| n.parse::<f64>().ok()).map(|n| wavelength / n)
        }
    };
    length.filter(|length| *length > 0.0 && length.is_finite()).ok_or_else(|| {
        let help = "write a length in metres above 0, or a part of the wavelength such as \"lambda/10\"";
        scene.fault(given.span(), "this is no edge", help)
    })
}

/// The material of every surface at one frequency.
pub(super) fn materials(scene: &SceneText, entry: &SceneEntry, wave: &Wave) -> Result<Vec<Material>, Error> {
    let mut known = BTreeMap::from([("conductor", Material::Conductor)]);
    for (name, entry) in &entry.materials {
        let found = material(scene, entry, wave)?;
        found.check(name).map_err(|error| scene.refused(entry.span(), &error))?;
        known.insert(name, found);
    }
    let of = |surface: &Spanned<SurfaceEntry>| {
        let Some(name) = &surface.get_ref().material else { return Ok(Material::Conductor) };
        known.get(name.get_ref().as_str()).cloned().ok_or_else(|| {
            let names: Vec<&str> = known.keys().copied().collect();
            let what = format!("there is no material `{}`", name.get_ref());
            scene.fault(name.span(), what, format!("known materials: {}", names.join(", ")))
        })
    };
    entry.surface.iter().map(of).collect()
}

fn material(scene: &SceneText, entry: &Spanned<MaterialEntry>, wave: &Wave) -> Result<Material, Error> {
    let MaterialEntry { impedance_ohm, half_space, layers } = entry.get_ref();
    match (impedance_ohm, half_space, layers) {
        (Some([re, im]), None, None) => Ok(Material::Impedance(Complex64::new(*re, *im))),
        (None, Some(DielectricEntry { permittivity, itu }), None) => {
            Ok(Material::HalfSpace(dielectric(scene, entry, (*permittivity, itu.as_deref()), wave)?))
        }
        (None, None, Some(layers)) => {
            let layer = |layer: &super::format::LayerEntry| {
                let given = (layer.permittivity, layer.itu.as_deref());
                let permittivity = dielectric(scene, entry, given, wave)?;
                Ok(Layer { permittivity, thickness: layer.thickness_m })
            };
            Ok(Material::Slab(layers.iter().map(layer).collect::<Result<_, Error>>()?))
        }
        _ => {
            let help = "give exactly one of impedance_ohm, half_space, layers";
            Err(scene.fault(entry.span(), "a material is made of one thing", help))
        }
    }
}

fn dielectric(
    scene: &SceneText,
    entry: &Spanned<MaterialEntry>,
    given: (Option<[f64; 2]>, Option<&str>),
    wave: &Wave,
) -> Result<Complex64, Error> {
    match given {
        (Some([re, im]), None) => Ok(Complex64::new(re, im)),
        (None, Some(name)) => {
            itu_permittivity(name, wave.frequency()).map_err(|error| scene.refused(entry.span(), &error))
        }
        _ => {
            let help = "give permittivity = [ε′, −ε″] or itu = \"concrete\", and not both";
            Err(scene.fault(entry.span(), "a dielectric needs one permittivity", help))
        }
    }
}

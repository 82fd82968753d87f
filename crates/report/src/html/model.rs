//! The elements of a mesh and what is known on them, packed for a page.
//!
//! Positions are 16-bit codes along each axis of the box around the mesh; a corner of an element is
//! its vertex as the distance from the next one that has not occurred, which is 0 for a new vertex
//! and small for a neighbour. Irradiance E is stored for each band. Radiosity B = M + ρ E needs no
//! bytes where exitance M and reflectance ρ are those of the whole surface; where this law does not
//! give B back, B is stored too.

use std::io::{self, Write};

use fredholm_mesh::{Anchored, Mesh, Vec3};
use serde::Serialize;

use super::pack::{Scale, differences, packed, varints, words};
use crate::colour::Colouring;
use crate::mean::Means;
use crate::nodal::SMOOTH_WELD;
use crate::{Camera, Exposure, Field, View};

/// Largest code of a position.
const LARGEST_CODE: f64 = 65_535.0;
/// Relative error up to which the law B = M + ρ E stands for the radiosity: below that of 16-bit
/// codes.
const LAW_TOLERANCE: f64 = 2e-5;

/// A quantity on the elements, one number each.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementValues {
    /// What it is called.
    pub name: String,
    /// Its symbol.
    pub symbol: String,
    /// Its unit.
    pub unit: String,
    /// Whether it has either sign, and colours about zero.
    pub diverging: bool,
    /// A number for each leaf.
    pub values: Vec<f64>,
}

/// A complex quantity on the elements, as phasors with the time factor e^{+jωt}.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementPhasors {
    /// What it is called.
    pub name: String,
    /// Its symbol.
    pub symbol: String,
    /// The symbol of the component whose phase is shown.
    pub component: String,
    /// Its unit.
    pub unit: String,
    /// Real and imaginary part for each leaf.
    pub values: Vec<[f64; 2]>,
    /// Magnitude for each leaf, of all components where the quantity has more than one.
    pub magnitude: Vec<f64>,
}

/// The field at a step on the way to the solution.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldStep {
    /// What the step is called.
    pub label: String,
    /// Irradiance, leaf-major, W/m².
    pub irradiance: Vec<f64>,
}

/// What lights the elements most.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ElementLinks {
    /// Middles of what sends light, m.
    pub centres: Vec<Vec3>,
    /// For each element numbers of senders with their shares of its irradiance, the largest first.
    pub links: Vec<Vec<(u32, f64)>>,
}

/// What is shown in three dimensions.
#[derive(Clone, Copy)]
pub struct ReportModel<'a> {
    /// The elements.
    pub mesh: &'a Mesh,
    /// Light on them.
    pub field: Option<&'a Field<'a>>,
    /// Where the scene is seen from.
    pub view: Option<&'a View>,
    /// The field on the way to the solution.
    pub steps: &'a [FieldStep],
    /// What the steps are, such as `Bounces`.
    pub steps_title: &'a str,
    /// Further quantities.
    pub values: &'a [ElementValues],
    /// Complex quantities.
    pub phasors: &'a [ElementPhasors],
    /// What lights the elements most, where that is known.
    pub links: Option<&'a ElementLinks>,
}

impl<'a> ReportModel<'a> {
    /// A mesh of which nothing but its surfaces is known.
    #[must_use]
    pub fn bare(mesh: &'a Mesh) -> Self {
        let (steps, values, phasors) = (&[], &[], &[]);
        Self { mesh, field: None, view: None, steps, steps_title: "", values, phasors, links: None }
    }

    /// A field of light, seen from where the scene is seen from.
    #[must_use]
    pub fn lit(field: &'a Field<'a>, view: &'a View) -> Self {
        Self { field: Some(field), view: Some(view), ..Self::bare(field.mesh()) }
    }
}

/// What a page tells of a model.
#[derive(Debug, Serialize)]
pub(super) struct Described {
    elements: usize,
    vertices: usize,
    low: [f64; 3],
    high: [f64; 3],
    positions: String,
    sides: String,
    corners: String,
    hanging: String,
    hanging_count: usize,
    faces: String,
    surface_of_face: String,
    area: Packed,
    exposed: Option<String>,
    colours: Vec<[f64; 3]>,
    exposure: Option<f64>,
    camera: Option<Seen>,
    surfaces: Vec<Surface>,
    irradiance: Vec<Packed>,
    radiosity: Vec<Option<Packed>>,
    steps: Vec<Step>,
    steps_title: String,
    scalars: Vec<Scalar>,
    phasors: Vec<Phasor>,
    links: Option<Links>,
}

/// Links in elements of the page: middles of the senders as positions, how many links each element
/// has, the numbers of their senders, and 255 times their shares.
#[derive(Debug, Serialize)]
struct Links {
    senders: usize,
    centres: String,
    counts: String,
    total: usize,
    from: String,
    shares: String,
}

/// Values in an element of the page.
#[derive(Clone, Debug, Serialize)]
struct Packed {
    blob: String,
    scale: Scale,
}

#[derive(Debug, Serialize)]
struct Seen {
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    vertical_fov_degrees: f64,
    width: u32,
    height: u32,
}

#[derive(Debug, Serialize)]
struct Surface {
    name: String,
    elements: usize,
    area: f64,
    reflectance: Vec<Option<f64>>,
    exitance: Option<Vec<f64>>,
    irradiance: Vec<f64>,
    radiosity: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct Step {
    label: String,
    irradiance: Vec<Packed>,
}

#[derive(Debug, Serialize)]
struct Scalar {
    name: String,
    symbol: String,
    unit: String,
    diverging: bool,
    values: Packed,
}

#[derive(Debug, Serialize)]
struct Phasor {
    name: String,
    symbol: String,
    component: String,
    unit: String,
    real: Packed,
    imaginary: Packed,
    magnitude: Packed,
}

impl From<&Camera> for Seen {
    fn from(camera: &Camera) -> Self {
        Self {
            eye: camera.eye.to_array(),
            target: camera.target.to_array(),
            up: camera.up.to_array(),
            vertical_fov_degrees: camera.vertical_fov_degrees,
            width: camera.width,
            height: camera.height,
        }
    }
}

impl Described {
    /// Largest relative error of a value that is read back.
    pub(super) fn error(&self) -> f64 {
        let scalars = self.scalars.iter().map(|scalar| &scalar.values);
        let phasors = self.phasors.iter().flat_map(|p| [&p.real, &p.imaginary, &p.magnitude]);
        let light = self.irradiance.iter().chain(self.radiosity.iter().flatten());
        let all = light.chain(scalars).chain(phasors);
        all.map(|values| values.scale.error()).fold(0.0, f64::max)
    }

    /// Width of a step of the positions along the longest side of the box, m.
    pub(super) fn grain(&self) -> f64 {
        (0..3).map(|axis| (self.high[axis] - self.low[axis]) / LARGEST_CODE).fold(0.0, f64::max)
    }
}

/// Writes the arrays of a model, and tells where they are.
pub(super) fn write_model(model: &ReportModel<'_>, out: &mut dyn Write) -> io::Result<Described> {
    let Anchored { leaves, hanging, .. } = model.mesh.anchored(SMOOTH_WELD);
    let bounds = model.mesh.bounds();
    let (low, high) = bounds.map_or((Vec3::ZERO, Vec3::ZERO), |bounds| (bounds.min, bounds.max));
    let mut blobs = Blobs { out, count: 0 };
    let mesh = model.mesh;
    let positions = blobs.positions(&leaves.vertices, low, high)?;
    let sides = blobs.add(|out| {
        leaves.patches().try_for_each(|patch| out.write_all(&[u8::try_from(patch.len()).unwrap_or(u8::MAX)]))
    })?;
    let mut fresh = 0_u32;
    let distance = |&vertex: &usize| {
        // Modulo 2³², as it is read: any numbering of the vertices comes back.
        let distance = fresh.wrapping_sub(vertex as u32);
        fresh += u32::from(distance == 0);
        distance
    };
    let corners = blobs.add(|out| varints(out, leaves.patches().flatten().map(distance)))?;
    let ends = hanging.iter().flat_map(|h| [h.vertex, h.ends[0], h.ends[1]]).map(|vertex| vertex as u32);
    let (hanging_count, hanging) = (hanging.len(), blobs.add(|out| differences(out, ends))?);
    let faces = blobs.add(|out| differences(out, (0..mesh.len()).map(|leaf| mesh.face_of(leaf) as u32)))?;
    let surface_of_face = blobs.add(|out| {
        mesh.faces().iter().try_for_each(|face| out.write_all(&(face.surface as u32).to_le_bytes()))
    })?;
    let area = blobs.values((0..mesh.len()).map(|leaf| mesh.patch(leaf).area()))?;
    let light = model.field.map(|field| blobs.light(field, model.steps)).transpose()?.unwrap_or_default();
    let scalars = model.values.iter().map(|values| blobs.scalar(values)).collect::<io::Result<_>>()?;
    let phasors = model.phasors.iter().map(|values| blobs.phasor(values)).collect::<io::Result<_>>()?;
    let links = model.links.map(|links| blobs.links(links, low, high)).transpose()?;
    Ok(Described {
        elements: mesh.len(),
        vertices: leaves.vertices.len(),
        low: low.to_array(),
        high: high.to_array(),
        positions,
        sides,
        corners,
        hanging,
        hanging_count,
        faces,
        surface_of_face,
        area,
        exposed: light.exposed,
        colours: model
            .field
            .map(|field| Colouring::new(field.bands()).columns().to_vec())
            .unwrap_or_default(),
        exposure: model.view.and_then(|view| match view.exposure {
            Exposure::Auto => None,
            Exposure::Fixed(value) => Some(value),
        }),
        camera: model.view.map(|view| Seen::from(&view.camera)),
        surfaces: model.field.map_or_else(|| bare_surfaces(mesh), surfaces),
        irradiance: light.irradiance,
        radiosity: light.radiosity,
        steps: light.steps,
        steps_title: model.steps_title.to_owned(),
        scalars,
        phasors,
        links,
    })
}

/// The packed light of a field.
#[derive(Default)]
struct Light {
    exposed: Option<String>,
    irradiance: Vec<Packed>,
    radiosity: Vec<Option<Packed>>,
    steps: Vec<Step>,
}

/// Writes arrays as elements of the page.
struct Blobs<'a> {
    out: &'a mut dyn Write,
    count: usize,
}

impl Blobs<'_> {
    /// Writes an array, and returns its name.
    fn add(&mut self, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<String> {
        let name = format!("data-{}", self.count);
        self.count += 1;
        write!(self.out, "<script type=\"application/octet-stream\" id=\"{name}\">")?;
        packed(self.out, fill)?;
        writeln!(self.out, "</script>")?;
        Ok(name)
    }

    fn positions(&mut self, vertices: &[Vec3], low: Vec3, high: Vec3) -> io::Result<String> {
        let code = move |axis: usize, vertex: &Vec3| {
            let extent = high[axis] - low[axis];
            let share = if extent > 0.0 { (vertex[axis] - low[axis]) / extent } else { 0.0 };
            (LARGEST_CODE * share.clamp(0.0, 1.0)).round() as u16
        };
        let codes = (0..3).flat_map(move |axis| vertices.iter().map(move |vertex| code(axis, vertex)));
        self.add(|out| words(out, &codes, vertices.len().max(1)))
    }

    fn links(&mut self, links: &ElementLinks, low: Vec3, high: Vec3) -> io::Result<Links> {
        let all = || links.links.iter().flatten();
        let mut used: Vec<u32> = all().map(|link| link.0).collect();
        used.sort_unstable();
        used.dedup();
        let centres: Vec<Vec3> = used.iter().map(|&sender| links.centres[sender as usize]).collect();
        let number = |sender: u32| used.binary_search(&sender).unwrap_or(0) as u32;
        let counts = links.links.iter().map(|own| u8::try_from(own.len()).unwrap_or(u8::MAX));
        let share = |&(_, share): &(u32, f64)| (255.0 * share.clamp(0.0, 1.0)).round() as u8;
        Ok(Links {
            senders: centres.len(),
            centres: self.positions(&centres, low, high)?,
            counts: self.add(|out| out.write_all(&counts.collect::<Vec<_>>()))?,
            total: all().count(),
            from: self.add(|out| varints(out, all().map(|link| number(link.0))))?,
            shares: self.add(|out| out.write_all(&all().map(share).collect::<Vec<_>>()))?,
        })
    }

    fn values(&mut self, values: impl Iterator<Item = f64> + Clone) -> io::Result<Packed> {
        let scale = Scale::new(values.clone());
        let blob = self.add(|out| words(out, &values.map(|value| scale.code(value)), usize::MAX))?;
        Ok(Packed { blob, scale })
    }

    fn light(&mut self, field: &Field<'_>, steps: &[FieldStep]) -> io::Result<Light> {
        let bands = field.bands().len();
        let laws = laws(field);
        let lawful = (0..bands).all(|band| holds(field, &laws, band));
        let mut light = Light { exposed: self.exposed(field)?, ..Light::default() };
        for band in 0..bands {
            light.irradiance.push(self.values(of_band(field.irradiance(), band, bands))?);
            let stored = !lawful && !holds(field, &laws, band);
            let radiosity =
                stored.then(|| self.values(of_band(field.radiosity(), band, bands))).transpose()?;
            light.radiosity.push(radiosity);
        }
        // Only the law gives the radiosity of a step.
        let fits = |step: &&FieldStep| lawful && step.irradiance.len() == field.irradiance().len();
        for step in steps.iter().filter(fits) {
            let packed = (0..bands).map(|band| self.values(of_band(&step.irradiance, band, bands)));
            light
                .steps
                .push(Step { label: step.label.clone(), irradiance: packed.collect::<io::Result<_>>()? });
        }
        Ok(light)
    }

    fn exposed(&mut self, field: &Field<'_>) -> io::Result<Option<String>> {
        let shares = (0..field.mesh().len()).map(|leaf| field.exposed(leaf));
        if shares.clone().all(|share| share >= 1.0) {
            return Ok(None);
        }
        let codes = shares.map(|share| (LARGEST_CODE * share.clamp(0.0, 1.0)).round() as u16);
        self.add(|out| words(out, &codes, usize::MAX)).map(Some)
    }

    fn scalar(&mut self, values: &ElementValues) -> io::Result<Scalar> {
        let ElementValues { name, symbol, unit, diverging, values } = values;
        let values = self.values(values.iter().copied())?;
        let [name, symbol, unit] = [name, symbol, unit].map(Clone::clone);
        Ok(Scalar { name, symbol, unit, diverging: *diverging, values })
    }

    fn phasor(&mut self, phasor: &ElementPhasors) -> io::Result<Phasor> {
        let ElementPhasors { name, symbol, component, unit, .. } = phasor;
        let [name, symbol, component, unit] = [name, symbol, component, unit].map(Clone::clone);
        let real = self.values(phasor.values.iter().map(|value| value[0]))?;
        let imaginary = self.values(phasor.values.iter().map(|value| value[1]))?;
        let magnitude = self.values(phasor.magnitude.iter().copied())?;
        Ok(Phasor { name, symbol, component, unit, real, imaginary, magnitude })
    }
}

/// One band of leaf-major values.
fn of_band(values: &[f64], band: usize, bands: usize) -> impl Iterator<Item = f64> + Clone + '_ {
    values.iter().skip(band).step_by(bands.max(1)).copied()
}

/// Exitance and reflectance of a surface in each band.
#[derive(Clone, Debug)]
struct Law {
    exitance: Option<Vec<f64>>,
    reflectance: Vec<Option<f64>>,
}

/// What each surface emits and reflects, as far as the field tells: M where it is the same on all
/// its elements, and ρ = Σ A (B − M) / Σ A E.
fn laws(field: &Field<'_>) -> Vec<Law> {
    let (mesh, bands) = (field.mesh(), field.bands().len());
    let surfaces = mesh.surfaces().len();
    let Some(exitance) = field.exitance() else {
        return vec![Law { exitance: None, reflectance: vec![None; bands] }; surfaces];
    };
    let means = |values| Means::new(field, values, surfaces, |leaf| mesh.surface_of(leaf));
    let [e, b, m] = [field.irradiance(), field.radiosity(), exitance].map(means);
    let mut own: Vec<Option<&[f64]>> = vec![None; surfaces];
    let mut even = vec![true; surfaces];
    for leaf in 0..mesh.len() {
        let (surface, row) = (mesh.surface_of(leaf), field.row(exitance, leaf));
        even[surface] &= **own[surface].get_or_insert(row) == *row;
    }
    let reflectance = |surface: usize, band: usize| {
        let received = e.integral(surface, band);
        (received > 0.0).then(|| (b.integral(surface, band) - m.integral(surface, band)) / received)
    };
    (0..surfaces)
        .map(|surface| Law {
            exitance: own[surface].filter(|_| even[surface]).map(<[f64]>::to_vec),
            reflectance: (0..bands).map(|band| reflectance(surface, band)).collect(),
        })
        .collect()
}

/// Whether B = M + ρ E gives back the radiosity of every element in a band.
fn holds(field: &Field<'_>, laws: &[Law], band: usize) -> bool {
    (0..field.mesh().len()).all(|leaf| {
        let law = &laws[field.mesh().surface_of(leaf)];
        let Some(exitance) = &law.exitance else { return false };
        let [e, b] = [field.irradiance(), field.radiosity()].map(|values| field.row(values, leaf)[band]);
        let found = exitance[band] + law.reflectance[band].unwrap_or(0.0) * e;
        (found - b).abs() <= LAW_TOLERANCE * b.abs()
    })
}

fn surfaces(field: &Field<'_>) -> Vec<Surface> {
    let (mesh, bands) = (field.mesh(), field.bands().len());
    let means = |values| Means::new(field, values, mesh.surfaces().len(), |leaf| mesh.surface_of(leaf));
    let [e, b] = [field.irradiance(), field.radiosity()].map(means);
    let all = |means: &Means, surface| (0..bands).map(|band| means.mean(surface, band)).collect();
    let laws = laws(field).into_iter();
    let known = bare_surfaces(mesh).into_iter().zip(laws).enumerate();
    known
        .map(|(i, (surface, Law { exitance, reflectance }))| Surface {
            exitance,
            reflectance,
            irradiance: all(&e, i),
            radiosity: all(&b, i),
            ..surface
        })
        .collect()
}

/// Names, elements and areas.
fn bare_surfaces(mesh: &Mesh) -> Vec<Surface> {
    let named = |surface: &fredholm_mesh::Surface| Surface {
        name: surface.name.clone(),
        elements: 0,
        area: 0.0,
        reflectance: Vec::new(),
        exitance: None,
        irradiance: Vec::new(),
        radiosity: Vec::new(),
    };
    let mut found: Vec<Surface> = mesh.surfaces().iter().map(named).collect();
    for (leaf, patch) in mesh.patches().enumerate() {
        let surface = &mut found[mesh.surface_of(leaf)];
        surface.elements += 1;
        surface.area += patch.area();
    }
    found
}

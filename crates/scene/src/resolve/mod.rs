//! From what is written in a scene file to what it means: ranges, names and geometry are checked
//! here.

mod bands;
mod camera;
mod cutting;
mod faces;
mod library;
mod material;
mod number;
pub(crate) mod obj;
pub(crate) mod shape;
mod solve;
mod surface;
mod turned;

use std::collections::BTreeSet;
use std::ops::Range;

use crate::check::{Finding, Warning};
use crate::error::{ErrorKind, SceneError};
use crate::files::Files;
use crate::format::{At, SceneEntry, SurfaceEntry};
use crate::part::Part;
use crate::source::Source;

pub(crate) use faces::{Mended, shapes as face_shapes};
pub(crate) use library::{USUAL_REFLECTANCE, colours, load as load_library, own as own_library};
pub(crate) use number::LARGEST_COORDINATE;

pub use camera::Camera;
pub use material::Material;
pub use solve::{SolveDefaults, Storage};

/// Most elements of a scene: about 20 GB of mesh, and well below the 2³² − 1 that an index can
/// hold.
pub(crate) const MOST_ELEMENTS: u128 = 100_000_000;

/// The meaning of a scene file.
#[derive(Debug)]
pub(crate) struct Resolved {
    pub bands: Vec<String>,
    pub solve: SolveDefaults,
    /// Where the name of the solver stands.
    pub solver: Option<Range<usize>>,
    /// Where the name of the discretisation stands.
    pub discretisation: Option<Range<usize>>,
    pub camera: Option<Camera>,
    pub materials: Vec<Material>,
    pub parts: Vec<Part>,
    /// What was read from material libraries and what was mended.
    pub notes: Vec<Warning>,
    /// What was found in mesh files while they were read.
    pub findings: Vec<Finding>,
}

/// A scene file being read with the files that it names, and what was found in them.
pub(crate) struct Reading<'a> {
    pub source: &'a Source,
    pub files: &'a mut Files,
    /// What was read from material libraries and what was mended.
    pub notes: Vec<Warning>,
    /// What was found in mesh files while they were read.
    pub findings: Vec<Finding>,
}

impl<'a> Reading<'a> {
    pub fn new(source: &'a Source, files: &'a mut Files) -> Self {
        Self { source, files, notes: vec![], findings: vec![] }
    }
}

/// What the meaning of a surface depends on.
struct Context<'a> {
    reading: Reading<'a>,
    scene: &'a SceneEntry,
    bands: &'a [String],
    /// Those of the scene, then those of material libraries.
    materials: Vec<Material>,
    /// How many of them are the scene's.
    own: usize,
    /// What faces are made of that have no material, where a mesh file stands for a scene; none in
    /// a scene.
    fallback: Option<usize>,
}

impl Context<'_> {
    /// The materials of the scene itself.
    fn own(&self) -> &[Material] {
        &self.materials[..self.own]
    }
}

/// Finds the meaning of a scene. `fallback` is the material of faces without one, where a mesh file
/// stands for a scene.
pub(crate) fn resolve(
    source: &Source,
    scene: &SceneEntry,
    files: &mut Files,
    fallback: Option<usize>,
) -> Result<Resolved, SceneError> {
    let bands = bands::bands(source, scene)?;
    let materials = material::materials(source, scene, &bands)?;
    let solve = scene.solve.as_ref().map(|entry| solve::solve(source, entry)).transpose()?;
    let camera = scene.camera.as_ref().map(|entry| camera::camera(source, entry)).transpose()?;
    let (own, reading) = (materials.len(), Reading::new(source, files));
    let mut context = Context { reading, scene, bands: &bands, materials, own, fallback };
    let parts = parts(&mut context)?;
    let Context { materials, reading: Reading { notes, findings, .. }, .. } = context;
    let named = scene.solve.as_ref();
    let solver = named.and_then(|entry| entry.solver.as_ref()).map(At::span);
    let discretisation = named.and_then(|entry| entry.discretisation.as_ref()).map(At::span);
    let solve = solve.unwrap_or_default();
    Ok(Resolved { bands, solve, solver, discretisation, camera, materials, parts, notes, findings })
}

fn parts(context: &mut Context) -> Result<Vec<Part>, SceneError> {
    let (source, scene) = (context.reading.source, context.scene);
    if scene.surface.is_empty() {
        let help = "add a [[surface]] with a name, a material and a shape";
        let end = source.text.len();
        return Err(source.error(ErrorKind::Empty, end..end, "the scene has no surface", help));
    }
    let mut parts: Vec<Part> = vec![];
    let mut names = BTreeSet::new();
    let mut elements = 0_u128;
    for entry in &scene.surface {
        for part in surface::parts(context, entry)? {
            check_name(source, &entry.name, &part.name, &mut names)?;
            elements = elements.saturating_add(part.elements);
            check_number(source, entry, &part, elements)?;
            parts.push(part);
        }
    }
    Ok(parts)
}

/// Refuses names of surfaces that are none or given twice; `given` is what stands in the file.
pub(crate) fn check_name(
    source: &Source,
    given: &At<String>,
    name: &str,
    names: &mut BTreeSet<String>,
) -> Result<(), SceneError> {
    let at_name = |what: String, help| source.error(ErrorKind::Name, given.span(), what, help);
    if name.is_empty() || name.chars().any(char::is_control) {
        return Err(at_name(
            format!("{name:?} is no name for a surface"),
            "write a name of visible characters",
        ));
    }
    if names.insert(name.to_owned()) {
        return Ok(());
    }
    Err(at_name(format!("two surfaces are called `{name}`"), "give every surface a name of its own"))
}

/// Refuses what could not be meshed, before any memory is taken for it.
fn check_number(source: &Source, entry: &SurfaceEntry, part: &Part, total: u128) -> Result<(), SceneError> {
    if total <= MOST_ELEMENTS {
        return Ok(());
    }
    let (name, elements) = (&part.name, part.elements);
    let what = if elements > MOST_ELEMENTS {
        format!("the surface `{name}` would have {elements} elements, more than the limit of {MOST_ELEMENTS}")
    } else {
        format!("with the surface `{name}` the scene would have {total} elements, more than {MOST_ELEMENTS}")
    };
    let help = "divide it into fewer pieces, or lower elements_per_face";
    Err(source.error(ErrorKind::TooLarge, cutting::density(entry), what, help))
}

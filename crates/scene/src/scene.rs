//! A scene: what a file describes, ready to be meshed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fredholm_mesh::{Cutting, Mesh, MeshBuilder, MeshError};

use crate::bare;
use crate::check::{Finding, Pieces, Warning};
use crate::error::{ErrorKind, SceneError};
use crate::files::Files;
use crate::import::is_mesh;
use crate::parse::parse;
use crate::part::Part;
use crate::resolve::{Camera, Material, Resolved, SolveDefaults, resolve};
use crate::source::Source;
use crate::suggest::among;

/// A scene file and the files it names, read and checked. Lengths in metres, exitance in W/m².
///
/// ```
/// use fredholm_scene::Scene;
///
/// let text = r#"
///     [materials.wall]
///     reflectance = 0.5
///     exitance = 1
///
///     [[surface]]
///     name = "room"
///     material = "wall"
///     box = { min = [0, 0, 0], max = [1, 1, 1], inward = true }
///     divide = [4, 4]
/// "#;
/// let scene = Scene::from_str(text, "room.toml")?;
/// assert_eq!(scene.predicted_elements(), 96);
/// assert_eq!(scene.predicted_faces(), scene.face_mesh()?.faces().len() as u128);
/// let mesh = scene.mesh()?;
/// assert_eq!(mesh.len(), 96);
/// assert!(scene.check(&mesh)?.is_empty());
/// assert_eq!(scene.reflectance(&mesh), [0.5; 96]);
/// # Ok::<(), fredholm_scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct Scene {
    source: Source,
    title: Option<String>,
    meaning: Resolved,
    sha256: String,
    pieces: Pieces,
}

impl Scene {
    /// Reads a scene file and the files it names, or a mesh file (OBJ, STL, PLY, glTF, Gmsh,
    /// Radiance, Mitsuba, View3D, known by the ending of its name) that stands for a scene: with
    /// the materials of its libraries, and evenly lit from all sides where none of them emits.
    ///
    /// # Errors
    /// [`SceneError`], with file and line, for anything that is wrong with them.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        if is_mesh(path) {
            let mut files = Files::beside(path);
            let (source, meaning) = bare::meaning(path, &mut files)?;
            return Self::new(source, None, meaning, &files);
        }
        Self::from_source(Source::load(path)?)
    }

    /// Reads a scene from text. Files that it names are looked for in the folder of `path`.
    ///
    /// # Errors
    /// [`SceneError`], with file and line, for anything that is wrong with it.
    pub fn from_str(text: &str, path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::from_source(Source::of(path.as_ref(), text.to_owned()))
    }

    /// Reads a scene from text, and the files that it names from memory: bytes by the name that the
    /// text has for the file. Other files are looked for in the folder of `path`.
    ///
    /// ```
    /// use fredholm_scene::Scene;
    ///
    /// let text = r#"
    ///     [materials.lamp]
    ///     reflectance = 0.5
    ///     exitance = 1
    ///
    ///     [[surface]]
    ///     name = "tile"
    ///     material = "lamp"
    ///     obj = { file = "tile.obj" }
    /// "#;
    /// let tile = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec();
    /// let scene = Scene::from_memory(text, "tile.toml", [("tile.obj".into(), tile)].into())?;
    /// assert_eq!(scene.predicted_faces(), 1);
    /// # Ok::<(), fredholm_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`], with file and line, for anything that is wrong with them.
    pub fn from_memory(
        text: &str,
        path: impl AsRef<Path>,
        files: BTreeMap<PathBuf, Vec<u8>>,
    ) -> Result<Self, SceneError> {
        let source = Source { path: path.as_ref().to_owned(), text: text.to_owned(), binary: false };
        let files = Files::beside(&source.path).with(files);
        Self::from_files(source, files)
    }

    fn from_source(source: Source) -> Result<Self, SceneError> {
        let files = Files::beside(&source.path);
        Self::from_files(source, files)
    }

    fn from_files(source: Source, mut files: Files) -> Result<Self, SceneError> {
        let entry = parse(&source)?;
        let meaning = resolve(&source, &entry, &mut files, None)?;
        Self::new(source, entry.title, meaning, &files)
    }

    fn new(
        source: Source,
        title: Option<String>,
        meaning: Resolved,
        files: &Files,
    ) -> Result<Self, SceneError> {
        let sha256 = files.fingerprint(&source.text);
        let pieces = Pieces::default();
        let mut scene = Self { source, title, meaning, sha256, pieces };
        scene.pieces = Pieces::of(scene.parts()).map_err(|(part, error)| scene.unmeshable(part, &error))?;
        Ok(scene)
    }

    /// The scene file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.source.path
    }

    /// What the scene is called.
    #[must_use]
    pub fn title(&self) -> Option<&str> {
        self.title.as_deref()
    }

    /// Names of the bands, at least one.
    #[must_use]
    pub fn bands(&self) -> &[String] {
        &self.meaning.bands
    }

    /// The materials, by name; the surfaces of the mesh refer to them by index.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.meaning.materials
    }

    /// The camera, where the scene has one.
    #[must_use]
    pub fn camera(&self) -> Option<&Camera> {
        self.meaning.camera.as_ref()
    }

    /// How to solve, where the command line does not say.
    #[must_use]
    pub fn solve(&self) -> &SolveDefaults {
        &self.meaning.solve
    }

    /// The error of a scene whose solver is none of those in `known`.
    #[must_use]
    pub fn unknown_solver(&self, known: &[&str]) -> SceneError {
        let name = self.solve().solver.as_deref().unwrap_or_default();
        let span = self.meaning.solver.clone().unwrap_or(0..0);
        let help = among(name, known.iter().copied(), "solvers");
        self.source.error(ErrorKind::Name, span, format!("there is no solver `{name}`"), help)
    }

    /// The error of a scene whose discretisation is none of those in `known`.
    #[must_use]
    pub fn unknown_discretisation(&self, known: &[&str]) -> SceneError {
        let name = self.solve().discretisation.as_deref().unwrap_or_default();
        let span = self.meaning.discretisation.clone().unwrap_or(0..0);
        let help = among(name, known.iter().copied(), "discretisations");
        self.source.error(ErrorKind::Name, span, format!("there is no discretisation `{name}`"), help)
    }

    /// SHA-256 of the scene file and the files it names, in hexadecimal.
    #[must_use]
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// Number of elements that the mesh will have, known without making it.
    #[must_use]
    pub fn predicted_elements(&self) -> u128 {
        self.parts().iter().map(|part| part.elements).sum()
    }

    /// Number of faces that the mesh will have, known without making it.
    #[must_use]
    pub fn predicted_faces(&self) -> u128 {
        let faces = |part: &Part| {
            let side = part.cutting.elements_per_side.max(1) as u128;
            part.elements.div_ceil(side * side)
        };
        self.parts().iter().map(faces).sum()
    }

    /// Cuts the surfaces into faces and elements.
    ///
    /// # Errors
    /// [`SceneError`] with the line of a surface that cannot be meshed.
    pub fn mesh(&self) -> Result<Mesh, SceneError> {
        self.refined_mesh(1)
    }

    /// Cuts the surfaces into the same faces as [`mesh`](Self::mesh), and every element of those
    /// into `refinement` × `refinement`.
    ///
    /// # Errors
    /// [`SceneError`] with the line of a surface that cannot be meshed, or would have more elements
    /// than an index can hold.
    pub fn refined_mesh(&self, refinement: usize) -> Result<Mesh, SceneError> {
        self.mesh_with(|per_side| per_side.saturating_mul(refinement))
    }

    /// Cuts the surfaces into the same faces as [`mesh`](Self::mesh), and those into as few
    /// elements as they are flat pieces.
    ///
    /// # Errors
    /// [`SceneError`] with the line of a surface that cannot be meshed, or would have more elements
    /// than an index can hold.
    pub fn face_mesh(&self) -> Result<Mesh, SceneError> {
        self.mesh_with(|_| 1)
    }

    fn mesh_with(&self, per_side: impl Fn(usize) -> usize) -> Result<Mesh, SceneError> {
        let mut builder = MeshBuilder::default();
        for part in self.parts() {
            builder.surface(part.name.as_str(), part.material);
            let elements_per_side = per_side(part.cutting.elements_per_side);
            let cutting = Cutting { elements_per_side, ..part.cutting.clone() };
            for shape in part.shapes.iter() {
                builder.add(shape, &cutting).map_err(|error| self.unmeshable(part, &error))?;
            }
        }
        let mesh = builder.build();
        if !self.pieces.overlap {
            return Ok(mesh);
        }
        let emits = |surface: usize| self.emits(mesh_material(&mesh, surface));
        let emitting: Vec<bool> = (0..mesh.surfaces().len()).map(emits).collect();
        mesh.without_covered(|surface| emitting[surface]).map_err(|error| {
            SceneError::new(ErrorKind::TooLarge, &self.source.path, error.to_string(), error.help())
        })
    }

    /// Whether a material emits in any band.
    pub(crate) fn emits(&self, material: usize) -> bool {
        self.materials()[material].exitance.iter().any(|&exitance| exitance > 0.0)
    }

    /// Reflectance of every leaf of a mesh of this scene, leaf-major: that of leaf i in band l is
    /// at i × bands + l.
    #[must_use]
    pub fn reflectance(&self, mesh: &Mesh) -> Vec<f64> {
        self.per_leaf(mesh, |material| &material.reflectance)
    }

    /// Exitance of every leaf of a mesh of this scene, W/m², leaf-major: that of leaf i in band l
    /// is at i × bands + l.
    #[must_use]
    pub fn exitance(&self, mesh: &Mesh) -> Vec<f64> {
        self.per_leaf(mesh, |material| &material.exitance)
    }

    fn per_leaf(&self, mesh: &Mesh, values: impl Fn(&Material) -> &Vec<f64>) -> Vec<f64> {
        let material = |leaf| &self.materials()[mesh.surfaces()[mesh.surface_of(leaf)].material];
        (0..mesh.len()).flat_map(|leaf| values(material(leaf)).iter().copied()).collect()
    }

    /// The undivided pieces of the surfaces.
    pub(crate) fn pieces(&self) -> &Pieces {
        &self.pieces
    }

    /// What was found in mesh files while they were read.
    pub(crate) fn findings(&self) -> &[Finding] {
        &self.meaning.findings
    }

    /// What was read from material libraries and what was mended. [`check`](Self::check) tells it,
    /// too.
    #[must_use]
    pub fn notes(&self) -> &[Warning] {
        &self.meaning.notes
    }

    pub(crate) fn source(&self) -> &Source {
        &self.source
    }

    pub(crate) fn parts(&self) -> &[Part] {
        &self.meaning.parts
    }

    /// Whether some pieces lie on others.
    pub(crate) fn overlaps(&self) -> bool {
        self.pieces.overlap
    }

    pub(crate) fn unmeshable(&self, part: &Part, error: &MeshError) -> SceneError {
        let what = format!("surface `{}`: {error}", part.name);
        self.source.error(ErrorKind::Geometry, part.span.clone(), what, error.help())
    }
}

/// Index of the material of a surface.
fn mesh_material(mesh: &Mesh, surface: usize) -> usize {
    mesh.surfaces()[surface].material
}

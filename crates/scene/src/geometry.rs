//! Geometry for a view-factor matrix: from a scene, or from a bare mesh file whose faces are the
//! patches.
//!
//! A bare file has no materials: faces are lit on the side from which their corners run
//! counter-clockwise. In a View3D file surfaces may be combined into one (the combine column), lie
//! within another (the base column: the base is what is left around them) and block the view
//! without radiating. Metres.

use std::path::Path;
use std::sync::Arc;

use fredholm_mesh::{Contacts, Cutting, Mesh, MeshBuilder, MeshError, Shape, Vec3};

use crate::error::{ErrorKind, SceneError};
use crate::files::Files;
use crate::import::vs3::{self, Radiating, View3d};
use crate::import::{Imported, ending, import, is_mesh};
use crate::resolve::{LARGEST_COORDINATE, Mended, face_shapes};
use crate::scene::Scene;
use crate::source::{Source, read};

/// What is asked of subsurfaces.
const SUBSURFACES_HELP: &str = "subsurfaces must lie flat inside their base and touch neither its border nor each other; \
                           otherwise describe the base as pieces around them, put together by the combine column";

/// What a row of a view-factor matrix stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// An element of the mesh.
    Element,
    /// A face of the input; in a View3D file, a surface with what is combined with it.
    Face,
    /// A named surface.
    Surface,
}

/// A scene or a mesh file, read and checked.
///
/// ```
/// use fredholm_scene::{By, Geometry};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("corner.obj");
/// std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no floor\nf 1 2 3\no wall\nf 1 3 4\n")?;
/// let surfaces = Geometry::load(&path)?.surfaces()?;
/// assert_eq!(surfaces.rows(By::Face).names, ["floor", "wall"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Geometry {
    origin: Origin,
    sha256: String,
}

#[derive(Debug)]
enum Origin {
    Scene(Arc<Scene>),
    File(MeshFile),
}

/// A mesh file on its own.
#[derive(Debug)]
struct MeshFile {
    source: Arc<Source>,
    title: Option<String>,
    surfaces: Vec<Input>,
    obstructions: Vec<InputFace>,
    tolerance: Option<f64>,
    warnings: Vec<String>,
}

/// A surface of a mesh file.
#[derive(Debug)]
struct Input {
    name: String,
    emissivity: Option<f64>,
    faces: Vec<InputFace>,
    /// One row for all faces.
    whole: bool,
}

#[derive(Debug)]
struct InputFace {
    shapes: Vec<Shape>,
    span: std::ops::Range<usize>,
}

/// The meshed surfaces, and what is known of them.
#[derive(Debug)]
pub struct Surfaces {
    /// The mesh; its occluders include what does not radiate.
    pub mesh: Mesh,
    /// Input face of every face of the mesh.
    input_face: Vec<usize>,
    /// Emissivity of every surface of the mesh.
    emissivity: Option<Vec<f64>>,
}

/// The rows of a matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// Row of every leaf element, counted from 0 without gaps.
    pub row_of: Vec<usize>,
    /// Name of every row.
    pub names: Vec<String>,
    /// Emissivity of every row, where the file tells, dimensionless in [0, 1].
    pub emissivity: Option<Vec<f64>>,
}

impl Geometry {
    /// Reads a scene (.toml) or a mesh file, known by the ending of its name.
    ///
    /// # Errors
    /// [`SceneError`], with file and line, for anything that is wrong with it.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        match ending(path).as_str() {
            "vs3" => Self::file(path, |bytes, _| view3d(vs3::parse(Source::decode(path, bytes)?)?)),
            _ if is_mesh(path) => Self::file(path, |bytes, files| {
                let name = Path::new(path.file_name().unwrap_or_default());
                import(name, bytes, files)
                    .map_or_else(|| Err(empty(&Source::binary(path))), |read| mesh_file(read?))
            }),
            _ => Ok(Self::from(Arc::new(Scene::load(path)?))),
        }
    }

    fn file(
        path: &Path,
        parse: impl FnOnce(Vec<u8>, &mut Files) -> Result<MeshFile, SceneError>,
    ) -> Result<Self, SceneError> {
        let unreadable = |error| {
            let what = format!("cannot read the file: {error}");
            SceneError::new(ErrorKind::Io, path, what, "correct the name of the file, or its permissions")
                .caused_by(error)
        };
        let bytes = read(path).map_err(unreadable)?;
        let mut files = Files::beside(path);
        let file = parse(bytes, &mut files)?;
        if file.source.binary {
            let name = Path::new(path.file_name().unwrap_or_default());
            files.load(name).map_err(unreadable)?;
        }
        let sha256 = files.fingerprint(&file.source.text);
        Ok(Self { origin: Origin::File(file), sha256 })
    }

    /// What the geometry is called.
    #[must_use]
    pub fn title(&self) -> Option<&str> {
        match &self.origin {
            Origin::Scene(scene) => scene.title(),
            Origin::File(file) => file.title.as_deref(),
        }
    }

    /// SHA-256 of the file and the files it names, in hexadecimal.
    #[must_use]
    pub fn sha256(&self) -> &str {
        &self.sha256
    }

    /// Tolerance of the form factors that the file asks for.
    #[must_use]
    pub fn tolerance(&self) -> Option<f64> {
        match &self.origin {
            Origin::Scene(scene) => scene.solve().form_factor_tolerance,
            Origin::File(file) => file.tolerance,
        }
    }

    /// What the file asks for and does not get.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        match &self.origin {
            Origin::Scene(_) => &[],
            Origin::File(file) => &file.warnings,
        }
    }

    /// Number of elements of a scene, known without meshing it; of a mesh file, the number of its
    /// faces, of which some may have several elements.
    #[must_use]
    pub fn predicted_elements(&self) -> u128 {
        match &self.origin {
            Origin::Scene(scene) => scene.predicted_elements(),
            Origin::File(file) => file.surfaces.iter().map(|surface| surface.faces.len() as u128).sum(),
        }
    }

    /// Meshes the surfaces.
    ///
    /// # Errors
    /// [`SceneError`] with the line of a surface that cannot be meshed.
    pub fn surfaces(&self) -> Result<Surfaces, SceneError> {
        match &self.origin {
            Origin::Scene(scene) => {
                let mesh = scene.mesh()?;
                let input_face = (0..mesh.faces().len()).collect();
                Ok(Surfaces { mesh, input_face, emissivity: None })
            }
            Origin::File(file) => file.surfaces(),
        }
    }
}

impl From<Arc<Scene>> for Geometry {
    fn from(scene: Arc<Scene>) -> Self {
        let sha256 = scene.sha256().to_owned();
        Self { origin: Origin::Scene(scene), sha256 }
    }
}

impl MeshFile {
    fn surfaces(&self) -> Result<Surfaces, SceneError> {
        let mut builder = MeshBuilder::default();
        let (mut input_face, mut inputs) = (vec![], 0);
        for (number, surface) in self.surfaces.iter().enumerate() {
            builder.surface(surface.name.as_str(), number);
            for face in &surface.faces {
                inputs += usize::from(!surface.whole);
                for shape in &face.shapes {
                    let added =
                        builder.add(shape, &Cutting::default()).map_err(|e| self.unmeshable(face, &e))?;
                    input_face.extend(added.map(|_| inputs));
                }
            }
            inputs += usize::from(surface.whole);
        }
        for occluder in self.occluders()? {
            builder.occluder(occluder);
        }
        let emissivity = self.surfaces.iter().map(|surface| surface.emissivity).collect();
        Ok(Surfaces { mesh: builder.build(), input_face, emissivity })
    }

    /// The flat pieces of what does not radiate.
    fn occluders(&self) -> Result<Vec<fredholm_mesh::Patch>, SceneError> {
        let mut builder = MeshBuilder::default();
        builder.surface("obstructions", 0);
        for face in &self.obstructions {
            for shape in &face.shapes {
                builder.add(shape, &Cutting::default()).map_err(|error| self.unmeshable(face, &error))?;
            }
        }
        Ok(builder.build().occluders().to_vec())
    }

    fn unmeshable(&self, face: &InputFace, error: &MeshError) -> SceneError {
        let has_holes = |shape: &Shape| matches!(shape, Shape::Polygon { holes, .. } if !holes.is_empty());
        let help = if face.shapes.iter().any(has_holes) { SUBSURFACES_HELP } else { error.help() };
        self.source.error(ErrorKind::Geometry, face.span.clone(), error.to_string(), help)
    }
}

impl Surfaces {
    /// The rows of a matrix by elements, faces or surfaces. A row that is alone in its surface has
    /// the surface's name, others have a number behind it.
    #[must_use]
    pub fn rows(&self, by: By) -> Rows {
        let mesh = &self.mesh;
        let key = |leaf: usize| match by {
            By::Element => leaf,
            By::Face => self.input_face[mesh.face_of(leaf)],
            By::Surface => mesh.surface_of(leaf),
        };
        let (mut row_of, mut surface_of, mut last) = (vec![], vec![], None);
        for leaf in 0..mesh.len() {
            if last != Some(key(leaf)) {
                surface_of.push(mesh.surface_of(leaf));
                last = Some(key(leaf));
            }
            row_of.push(surface_of.len() - 1);
        }
        let emissivity = self.emissivity.as_ref().map(|of| surface_of.iter().map(|&s| of[s]).collect());
        Rows { row_of, names: self.names(&surface_of), emissivity }
    }

    fn names(&self, surface_of: &[usize]) -> Vec<String> {
        let surfaces = self.mesh.surfaces();
        let mut counts = vec![0; surfaces.len()];
        for &surface in surface_of {
            counts[surface] += 1;
        }
        let mut numbers = vec![0; surfaces.len()];
        let name = |&surface: &usize| {
            numbers[surface] += 1;
            let name = &surfaces[surface].name;
            if counts[surface] == 1 { name.clone() } else { format!("{name}/{}", numbers[surface]) }
        };
        surface_of.iter().map(name).collect()
    }
}

/// Says that a file holds nothing.
fn empty(source: &Source) -> SceneError {
    let end = source.text.len();
    let help = "give a file with faces (lines that begin with f in an OBJ)";
    source.error(ErrorKind::Empty, end..end, "the file holds no face", help)
}

/// Every face of a mesh file.
fn mesh_file(imported: Imported) -> Result<MeshFile, SceneError> {
    let source = imported.source;
    let path = source.path.clone();
    let faces = imported.groups.iter().flat_map(|group| &group.faces);
    let mended = Mended::of(faces.map(|face| face.corners.clone()).collect());
    let found = mended.findings();
    let words =
        mended.left_out().into_iter().chain(found.iter().map(ToString::to_string)).chain(doubled(&mended));
    let at = |span: &std::ops::Range<usize>| source.place(span.clone());
    let notes =
        imported.notes.iter().map(|note| format!("{}:{}: {}", path.display(), at(&note.span), note.what));
    let notes: Vec<String> = notes.collect();
    let warnings = words.map(|what| format!("{}: {what}", path.display())).chain(notes).collect();
    let mut shapes = mended.shapes.into_iter();
    let mut surfaces = vec![];
    for group in imported.groups {
        let material = group.material.map(|name| name.text);
        let name = group.object.or(material).unwrap_or_else(|| "face".to_owned());
        let mut faces = vec![];
        for face in &group.faces {
            within_reach(&source, &face.corners, &face.span)?;
            let Some(shapes) = shapes.next().filter(|shapes| !shapes.is_empty()) else { continue };
            faces.push(InputFace { shapes, span: face.span.clone() });
        }
        if !faces.is_empty() {
            surfaces.push(Input { name, emissivity: None, faces, whole: false });
        }
    }
    if surfaces.is_empty() {
        return Err(empty(&source));
    }
    Ok(MeshFile { source, title: None, surfaces, obstructions: vec![], tolerance: None, warnings })
}

/// Says where faces lie on each other and are lit on the same side: each has its row, and light is
/// counted twice.
fn doubled(mended: &Mended) -> Option<String> {
    let blockers = |shape: &Shape| shape.blockers(&Cutting::default()).unwrap_or_default();
    // What makes no blockers is refused when it is meshed.
    let pieces: Vec<_> = mended.shapes.iter().flatten().flat_map(blockers).collect();
    let contacts = Contacts::of(&pieces);
    let mut same_side = contacts.overlaps.iter().filter(|overlap| overlap.same_side);
    let first = same_side.next()?;
    Some(format!(
        "{} pairs of faces lie on each other, lit on the same side, the first at {} m: light is counted twice there; \
         remove one of each pair, or put the file into a scene, where one is left out",
        1 + same_side.count(),
        first.place
    ))
}

fn input_face(
    source: &Source,
    corners: &[Vec3],
    span: std::ops::Range<usize>,
) -> Result<InputFace, SceneError> {
    let shapes = within_reach(source, corners, &span).map(face_shapes)?;
    Ok(InputFace { shapes, span })
}

/// Refuses corners too far away.
fn within_reach<'a>(
    source: &Source,
    corners: &'a [Vec3],
    span: &std::ops::Range<usize>,
) -> Result<&'a [Vec3], SceneError> {
    if corners.iter().all(|p| p.abs().max_element() <= LARGEST_COORDINATE) {
        return Ok(corners);
    }
    let what = format!("this face lies farther away than {LARGEST_COORDINATE:e} m");
    Err(source.error(ErrorKind::Value, span.clone(), what, "scale the coordinates down"))
}

/// The surfaces of a View3D file: combined ones are one surface, subsurfaces are cut out of their
/// base.
fn view3d(file: View3d) -> Result<MeshFile, SceneError> {
    let mut surfaces: Vec<Input> = vec![];
    let mut place = vec![0; file.surfaces.len()];
    let mut obstructions = vec![];
    for (index, surface) in file.surfaces.iter().enumerate() {
        let face = remainder(&file, index)?;
        let Some(Radiating { combined, emissivity, name, .. }) = &surface.radiates else {
            obstructions.push(face);
            continue;
        };
        if let Some(target) = *combined {
            surfaces[place[target]].faces.push(face);
        } else {
            place[index] = surfaces.len();
            surfaces.push(Input {
                name: name.clone(),
                emissivity: Some(*emissivity),
                faces: vec![face],
                whole: true,
            });
        }
    }
    let warnings = warnings(&file);
    let View3d { source, title, control, .. } = file;
    let source = Arc::new(source);
    Ok(MeshFile { source, title, surfaces, obstructions, tolerance: control.tolerance, warnings })
}

/// A surface without the subsurfaces that lie in it.
fn remainder(file: &View3d, index: usize) -> Result<InputFace, SceneError> {
    let surface = &file.surfaces[index];
    let inner = |other: &&vs3::Surface| other.radiates.as_ref().is_some_and(|r| r.base == Some(index));
    let mut holes = vec![];
    for other in file.surfaces.iter().filter(inner) {
        if area_vector(&other.corners).dot(area_vector(&surface.corners)) <= 0.0 {
            let what = format!("this subsurface faces away from its base, surface {}", index + 1);
            return Err(file.source.error(
                ErrorKind::Geometry,
                other.span.clone(),
                what,
                "reverse the order of its vertices",
            ));
        }
        holes.push(within_reach(&file.source, &other.corners, &other.span)?.to_vec());
    }
    // An obstruction blocks the view whole, whatever lies on it.
    if holes.is_empty() || surface.radiates.is_none() {
        return input_face(&file.source, &surface.corners, surface.span.clone());
    }
    let outline = within_reach(&file.source, &surface.corners, &surface.span)?.to_vec();
    Ok(InputFace { shapes: vec![Shape::Polygon { outline, holes }], span: surface.span.clone() })
}

/// Twice the area times the normal.
fn area_vector(corners: &[Vec3]) -> Vec3 {
    corners.windows(2).map(|side| (side[0] - corners[0]).cross(side[1] - corners[0])).sum()
}

fn warnings(file: &View3d) -> Vec<String> {
    let path = file.source.path.display();
    let emit = file.control.emittances.then(|| {
        format!("{path}: emit=1 asks for interchange factors with reflections; what is computed are plain view factors")
    });
    let enclosure = file.control.enclosure.then(|| {
        format!("{path}: encl=1 asks for adjusted row sums; they are adjusted with --close only, and the change is stated")
    });
    emit.into_iter().chain(enclosure).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loaded(name: &str, text: &str) -> Result<Geometry, SceneError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        Geometry::load(path)
    }

    const SQUARES: &str =
        "F 3\nV 1 0 0 0\nV 2 4 0 0\nV 3 4 4 0\nV 4 0 4 0\nV 5 1 1 0\nV 6 3 1 0\nV 7 3 3 0\nV 8 1 3 0\n";

    #[test]
    fn a_subsurface_is_cut_out_of_its_base() {
        let text = format!("{SQUARES}S 1 1 2 3 4 0 0 0.8 wall\nS 2 5 6 7 8 1 0 0.9 window\n");
        let surfaces = loaded("a.vs3", &text).unwrap().surfaces().unwrap();
        let rows = surfaces.rows(By::Face);
        assert_eq!((rows.names.join(" "), rows.emissivity), ("wall window".to_owned(), Some(vec![0.8, 0.9])));
        let mut areas = [0.0; 2];
        surfaces.mesh.patches().zip(&rows.row_of).for_each(|(patch, &row)| areas[row] += patch.area());
        assert!((areas[0] - 12.0).abs() < 1e-12 && (areas[1] - 4.0).abs() < 1e-12, "{areas:?}");
    }

    #[test]
    fn combined_surfaces_are_one_row_and_obstructions_none() {
        let text = format!(
            "{SQUARES}S 1 1 2 3 0 0 0 0.8 a\nS 2 5 6 7 8 0 0 0.9 b\nS 3 1 3 4 0 0 1 0.5 c\nO 4 8 7 6 5\n"
        );
        let surfaces = loaded("a.vs3", &text).unwrap().surfaces().unwrap();
        let rows = surfaces.rows(By::Face);
        assert_eq!((rows.row_of, rows.names), (vec![0, 0, 1], vec!["a".to_owned(), "b".to_owned()]));
        assert_eq!((surfaces.mesh.occluders().len(), surfaces.mesh.len()), (4, 3));
    }

    #[test]
    fn a_subsurface_that_faces_away_or_lies_outside_is_refused() {
        for window in ["S 2 8 7 6 5 1 0 0.9 w", "S 2 2 3 7 6 1 0 0.9 w"] {
            let text = format!("{SQUARES}S 1 1 2 3 4 0 0 0.8 wall\n{window}\n");
            let error = loaded("a.vs3", &text).and_then(|g| g.surfaces()).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Geometry, "{error}");
        }
    }

    #[test]
    fn faces_of_a_mesh_file_are_numbered_within_their_object() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.3\nf 1 2 3\no a\nf 1 2 3 4\nf 1 2 4\n";
        let surfaces = loaded("a.obj", text).unwrap().surfaces().unwrap();
        let rows = surfaces.rows(By::Face);
        assert_eq!(rows.names, ["face", "a/1", "a/2"]);
        assert_eq!(rows.row_of, [0, 1, 1, 2], "a quad that is not flat is two triangles and one row");
        assert_eq!(surfaces.rows(By::Surface).names, ["face", "a"]);
        assert_eq!(surfaces.rows(By::Element).names, ["face", "a/1", "a/2", "a/3"]);
    }
}

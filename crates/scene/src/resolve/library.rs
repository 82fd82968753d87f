//! Materials from mesh files and their libraries: a reflectance, and the exitance π L of a radiance
//! L (in a material library Kd and Ke, as renderers take them).
//!
//! A colour goes to the bands r, g, b (or red, green, blue); a grey one to any bands, and any to a
//! single band as its luminance 0.2126 r + 0.7152 g + 0.0722 b (ITU-R BT.709).

use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use super::number::short;
use super::{Context, Material};
use crate::check::Warning;
use crate::error::{ErrorKind, SceneError};
use crate::format::MeshFileEntry;
use crate::import::{Imported, MeshMaterial, Name, ending, mesh_materials};
use crate::source::Source;

/// Shares of red, green and blue in a luminance.
const LUMINANCE_WEIGHTS: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// What a library's reflectance of 1 is lowered to: nothing reflects all light.
const MOST_REFLECTANCE: f64 = 0.95;
/// Reflectance where a library does not say.
pub(crate) const USUAL_REFLECTANCE: f64 = 0.5;
/// Names of bands for red, green and blue.
const COLOUR_BANDS: [[&str; 3]; 2] = [["r", "g", "b"], ["red", "green", "blue"]];

/// A material library that was read.
#[derive(Debug)]
pub(crate) struct Library {
    pub source: Arc<Source>,
    pub materials: Vec<MeshMaterial>,
    terms: Terms,
}

/// What a format calls what is taken over.
#[derive(Clone, Copy, Debug)]
struct Terms {
    library: &'static str,
    reflectance: &'static str,
    radiance: &'static str,
}

const MTL_TERMS: Terms = Terms { library: "library", reflectance: "Kd", radiance: "Ke" };

/// The words of a format that holds its materials itself.
fn terms(path: &Path) -> Terms {
    let (reflectance, radiance) = match ending(path).as_str() {
        "gltf" | "glb" => ("baseColorFactor", "emissiveFactor"),
        "xml" => ("reflectance", "radiance"),
        _ => ("colour", "radiance"),
    };
    Terms { library: "file", reflectance, radiance }
}

/// The materials that a mesh file defines itself.
pub(crate) fn own(imported: &Imported) -> Library {
    let (source, materials) = (Arc::clone(&imported.source), imported.materials.clone());
    let terms = terms(&source.path);
    Library { source, materials, terms }
}

/// Reads the libraries of a mesh file; with `lenient`, those that cannot be read are told and
/// passed over.
pub(super) fn read(
    context: &mut Context,
    file: &MeshFileEntry,
    imported: &Imported,
) -> Result<Vec<Library>, SceneError> {
    let lenient = context.fallback.is_some();
    let mut libraries = vec![];
    if !imported.materials.is_empty() {
        libraries.push(own(imported));
    }
    for library in &imported.libraries {
        match load(context.reading.files, Path::new(file.file.as_str()), imported, library) {
            Err(error) if lenient && error.is_io() => {
                let (file, place) =
                    (imported.source.path.clone(), imported.source.place(library.span.clone()));
                let (what, help) = (error.what().to_owned(), "put it beside the mesh file".to_owned());
                context.reading.notes.push(Warning { file, place, what, help });
            }
            read => libraries.push(read?),
        }
    }
    Ok(libraries)
}

/// Reads a library beside the mesh file called `beside`.
pub(crate) fn load(
    files: &mut crate::files::Files,
    beside: &Path,
    imported: &Imported,
    library: &Name,
) -> Result<Library, SceneError> {
    let name = beside.with_file_name(&library.text);
    let bytes = files.load(&name).map_err(|error| {
        let what = format!("cannot read the material library `{}`: {error}", library.text);
        let help =
            "put it beside the OBJ file, or name a material of the scene for every usemtl: materials = { … }";
        imported.source.error(ErrorKind::Io, library.span.clone(), what, help).caused_by(error)
    })?;
    let source = Source::decode_mesh(&files.path(&name), bytes)?;
    let materials = mesh_materials(&source)?;
    Ok(Library { source: Arc::new(source), materials, terms: MTL_TERMS })
}

/// Index of the material that a library defines by this name; it is added where it is new. None
/// where no library says anything of it.
pub(super) fn find(
    context: &mut Context,
    libraries: &[Library],
    name: &str,
) -> Result<Option<usize>, SceneError> {
    let defines = |library: &&Library| library.materials.iter().any(|material| material.name == name);
    let Some(library) = libraries.iter().find(defines) else { return Ok(None) };
    let Some(entry) = library.materials.iter().find(|material| material.name == name) else {
        return Ok(None);
    };
    if entry.diffuse.is_none() && entry.emission.is_none() {
        return Ok(None);
    }
    let (material, lowered) = material(context.bands, library, entry)?;
    let old = context.materials[context.own..].iter().position(|known| *known == material);
    if let Some(place) = old {
        return Ok(Some(context.own + place));
    }
    tell(context, library, entry, &material, lowered);
    context.materials.push(material);
    Ok(Some(context.materials.len() - 1))
}

/// Says what a library's material was taken for.
fn tell(context: &mut Context, library: &Library, entry: &MeshMaterial, material: &Material, lowered: bool) {
    let list = |values: &[f64]| {
        let mut words: Vec<String> = values.iter().map(|v| short((1e4 * v).round() / 1e4)).collect();
        if words.windows(2).all(|pair| pair[0] == pair[1]) {
            words.truncate(1);
        }
        words.join(" ")
    };
    let Terms { library: kind, reflectance, radiance } = library.terms;
    let known = list(&material.reflectance);
    let mut what = format!("`{}` is read from this {kind}: reflectance {known}", entry.name);
    // Writing to a string cannot fail.
    if lowered {
        let _ = write!(
            what,
            ", lowered to {MOST_REFLECTANCE} where {reflectance} is 1, since nothing reflects all light"
        );
    }
    if entry.diffuse.is_none() {
        let _ = write!(what, ", since it has no {reflectance}");
    }
    if material.exitance.iter().any(|&m| m > 0.0) {
        let _ = write!(what, ", exitance π {radiance} = {} W/m²", list(&material.exitance));
    }
    if let Some(picture) = &entry.picture {
        let _ = write!(what, "; its picture `{picture}` is not read");
    }
    let help = format!("another one is given by [materials.\"{}\"] in a scene file", entry.name);
    let (file, place) = (library.source.path.clone(), library.source.place(entry.span.clone()));
    context.reading.notes.push(Warning { file, place, what, help });
}

/// The material, and whether its reflectance was lowered.
fn material(
    bands: &[String],
    library: &Library,
    entry: &MeshMaterial,
) -> Result<(Material, bool), SceneError> {
    let source = &library.source;
    let refuse = |span: &std::ops::Range<usize>, what: String, help: &str| {
        Err(source.error(ErrorKind::Value, span.clone(), what, help))
    };
    let (mut diffuse, mut lowered) = ([USUAL_REFLECTANCE; 3], false);
    if let Some((kd, span)) = &entry.diffuse {
        if kd.iter().any(|value| !(0.0..=1.0).contains(value)) {
            let what =
                format!("the reflectance {} of `{}` is out of range", library.terms.reflectance, entry.name);
            let help = "write numbers from 0 to below 1: no surface reflects more than it receives; or give the material in a scene file";
            return refuse(span, what, help);
        }
        diffuse = kd.map(|value| if value < 1.0 { value } else { MOST_REFLECTANCE });
        lowered = kd.iter().any(|value| *value >= 1.0);
    }
    let mut emission = [0.0; 3];
    if let Some((ke, span)) = &entry.emission {
        if ke.iter().any(|value| !(0.0..=1e99).contains(value)) {
            let what = format!("the emission {} of `{}` is out of range", library.terms.radiance, entry.name);
            return refuse(span, what, "write numbers from 0 to 1e99");
        }
        emission = ke.map(|value| PI * value);
    }
    let convert = |colour: [f64; 3]| {
        to_bands(colour, bands).ok_or_else(|| {
            let what = format!(
                "the colour of `{}` cannot be told from red, green and blue in the bands {}",
                entry.name,
                bands.join(", ")
            );
            let help = format!("give its values in the scene: [materials.\"{}\"]", entry.name);
            source.error(ErrorKind::Value, entry.span.clone(), what, help)
        })
    };
    let (reflectance, exitance) = (convert(diffuse)?, convert(emission)?);
    Ok((Material { name: entry.name.clone(), reflectance, exitance }, lowered))
}

/// Whether red, green and blue differ.
fn is_coloured(colour: &[f64; 3]) -> bool {
    colour.windows(2).any(|pair| pair[0].to_bits() != pair[1].to_bits())
}

/// Red, green and blue of a value in each band; none where the bands are no colours.
pub(crate) fn colours(bands: &[String], values: &[f64]) -> Option<[f64; 3]> {
    if let [grey] = values {
        return Some([*grey; 3]);
    }
    let of = |names: &[&str; 3]| {
        let at = |name: &str| bands.iter().position(|band| band == name).map(|k| values[k]);
        Some([at(names[0])?, at(names[1])?, at(names[2])?])
    };
    COLOUR_BANDS.iter().find_map(of).filter(|_| bands.len() == 3)
}

/// A colour in the bands of a scene.
fn to_bands(colour: [f64; 3], bands: &[String]) -> Option<Vec<f64>> {
    if !is_coloured(&colour) {
        return Some(vec![colour[0]; bands.len()]);
    }
    if bands.len() == 1 {
        return Some(vec![colour.iter().zip(LUMINANCE_WEIGHTS).map(|(c, share)| c * share).sum()]);
    }
    let place =
        |band: &String| COLOUR_BANDS.iter().find_map(|names| names.iter().position(|name| name == band));
    bands.iter().map(|band| place(band).map(|k| colour[k])).collect()
}

impl Library {
    /// Whether one of its materials is not grey.
    pub fn is_coloured(&self) -> bool {
        let of = |material: &MeshMaterial| {
            let colours = [&material.diffuse, &material.emission];
            colours.into_iter().flatten().any(|(colour, _)| is_coloured(colour))
        };
        self.materials.iter().any(of)
    }
}

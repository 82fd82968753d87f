//! Materials of a scene, which depend on the frequency.

use fredholm_waves::material::{Layer, Material, conductor_impedance, itu_permittivity, sheet_impedance};
use fredholm_waves::medium::IMPEDANCE;
use fredholm_waves::{Complex64, Wave};

use super::choices::ResistanceEntry;
use super::format::{FilmEntry, LayerEntry, MaterialEntry, SceneEntry};
use super::scene::refused;
use crate::error::{ErrorKind, SceneError};
use crate::format::At;
use crate::source::Source;
use crate::suggest::among;

/// Surface impedance over that of free space from which on a conductor is not a good one: the wave
/// inside may then be 6° off the normal.
const MOST_OF_FREE_SPACE: f64 = 0.1;
/// The material that is always there.
pub(super) const CONDUCTOR: &str = "conductor";

/// The materials at one frequency: the conductor, then those of the scene by name.
pub(super) fn materials(
    source: &Source,
    scene: &SceneEntry,
    wave: &Wave,
) -> Result<Vec<Material>, SceneError> {
    let mut materials = vec![Material::Conductor];
    for (name, entry) in &scene.materials {
        let found = material(source, entry, wave)?;
        found.check(name).map_err(|error| refused(source, entry.span(), &error))?;
        materials.push(found);
    }
    Ok(materials)
}

/// Number of the material of this name in [`materials`].
pub(super) fn number(scene: &SceneEntry, name: &str) -> Option<usize> {
    let own = scene.materials.keys().position(|known| known.as_str() == name);
    own.map(|own| own + 1).or_else(|| (name == CONDUCTOR).then_some(0))
}

/// The same, or the error of a name that is unknown.
pub(super) fn find(source: &Source, scene: &SceneEntry, name: &At<String>) -> Result<usize, SceneError> {
    number(scene, name).ok_or_else(|| {
        let what = format!("there is no material `{}`", **name);
        source.error(ErrorKind::Name, name.span(), what, known(scene, name))
    })
}

/// The names of all materials, the nearest to `name` first.
pub(super) fn known(scene: &SceneEntry, name: &str) -> String {
    let names = scene.materials.keys().map(|name| name.as_str());
    among(name, [CONDUCTOR].into_iter().chain(names), "materials")
}

fn material(source: &Source, entry: &At<MaterialEntry>, wave: &Wave) -> Result<Material, SceneError> {
    let MaterialEntry { impedance_ohm, conductivity_s_per_m, half_space, layers, sheet } = &**entry;
    let dielectric = |permittivity: Option<[f64; 2]>, itu: &Option<String>| {
        dielectric(source, entry, (permittivity, itu.as_deref()), wave)
    };
    match (impedance_ohm, conductivity_s_per_m, half_space, layers, sheet) {
        (Some([re, im]), None, None, None, None) => Ok(Material::Impedance(Complex64::new(*re, *im))),
        (None, Some(conductivity), None, None, None) => {
            good_conductor(source, entry, *conductivity, wave).map(Material::Impedance)
        }
        (None, None, Some(half), None, None) => {
            Ok(Material::HalfSpace(dielectric(half.permittivity, &half.itu)?))
        }
        (None, None, None, Some(layers), None) => {
            let layer = |layer: &LayerEntry| {
                let permittivity = dielectric(layer.permittivity, &layer.itu)?;
                Ok(Layer { permittivity, thickness: layer.thickness_m })
            };
            Ok(Material::Slab(layers.iter().map(layer).collect::<Result<_, SceneError>>()?))
        }
        (None, None, None, None, Some(film)) => sheet_of(source, entry, film, wave).map(Material::Sheet),
        _ => {
            let help = "give exactly one of impedance_ohm, conductivity_s_per_m, half_space, layers, sheet";
            Err(source.error(ErrorKind::Value, entry.span(), "a material is made of one thing", help))
        }
    }
}

/// The surface impedance of a good conductor, Ω.
fn good_conductor(
    source: &Source,
    entry: &At<MaterialEntry>,
    conductivity: f64,
    wave: &Wave,
) -> Result<Complex64, SceneError> {
    let z = conductor_impedance(conductivity, wave);
    if conductivity.is_finite() && z.norm() < MOST_OF_FREE_SPACE * IMPEDANCE {
        return Ok(z);
    }
    let what = format!(
        "a conductivity of {conductivity} S/m is that of no good conductor at {} Hz",
        wave.frequency()
    );
    let help = "give a larger conductivity, or half_space = { permittivity = [ε′, −ε″] } with ε″ = σ/(ωε₀)";
    Err(source.error(ErrorKind::Value, entry.span(), what, help))
}

/// The impedance of a thin sheet, Ω.
fn sheet_of(
    source: &Source,
    entry: &At<MaterialEntry>,
    film: &FilmEntry,
    wave: &Wave,
) -> Result<Complex64, SceneError> {
    let FilmEntry { resistance_ohm, permittivity, itu, thickness_m } = film;
    match (resistance_ohm, thickness_m) {
        (Some(ResistanceEntry([re, im])), None) if permittivity.is_none() && itu.is_none() => {
            Ok(Complex64::new(*re, *im))
        }
        (None, Some(thickness)) => {
            let permittivity = dielectric(source, entry, (*permittivity, itu.as_deref()), wave)?;
            let layer = Layer { permittivity, thickness: *thickness };
            let sane = Material::Slab(vec![layer]).check("a sheet");
            sane.map_err(|error| refused(source, entry.span(), &error))?;
            Ok(sheet_impedance(permittivity, *thickness, wave))
        }
        _ => {
            let help = "give resistance_ohm, or permittivity = [ε′, −ε″] or itu = \"glass\" with thickness_m";
            Err(source.error(ErrorKind::Value, entry.span(), "a sheet is made of one thing", help))
        }
    }
}

fn dielectric(
    source: &Source,
    entry: &At<MaterialEntry>,
    given: (Option<[f64; 2]>, Option<&str>),
    wave: &Wave,
) -> Result<Complex64, SceneError> {
    match given {
        (Some([re, im]), None) => Ok(Complex64::new(re, im)),
        (None, Some(name)) => {
            itu_permittivity(name, wave.frequency()).map_err(|error| refused(source, entry.span(), &error))
        }
        _ => {
            let help = "give permittivity = [ε′, −ε″] or itu = \"concrete\", and not both";
            Err(source.error(ErrorKind::Value, entry.span(), "a dielectric needs one permittivity", help))
        }
    }
}

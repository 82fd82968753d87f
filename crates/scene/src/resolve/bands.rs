//! Names of the bands.

use std::collections::BTreeSet;

use crate::error::{ErrorKind, SceneError};
use crate::format::{At, SceneEntry};
use crate::source::Source;

/// The band of a scene that names none.
const GREY_BAND: &str = "grey";

pub(super) fn bands(source: &Source, entry: &SceneEntry) -> Result<Vec<String>, SceneError> {
    let Some(list) = &entry.bands else { return Ok(vec![GREY_BAND.to_owned()]) };
    if list.is_empty() {
        let help = "name at least one band, or leave the key out for the one band `grey`";
        return Err(source.value_error(list, "the list of bands is empty".to_owned(), help));
    }
    let mut seen = BTreeSet::new();
    for band in list.iter() {
        check_name(source, band)?;
        if !seen.insert(band.as_str()) {
            let what = format!("the band `{}` is named twice", **band);
            let help = "give every band a name of its own";
            return Err(source.error(ErrorKind::Name, band.span(), what, help));
        }
    }
    Ok(list.iter().map(|band| String::clone(band)).collect())
}

/// Band names become columns of tables, so they hold no separators.
fn check_name(source: &Source, band: &At<String>) -> Result<(), SceneError> {
    let allowed = |c: char| c.is_alphanumeric() || "_-.+".contains(c);
    if !band.is_empty() && band.chars().all(allowed) {
        return Ok(());
    }
    let what = format!("the band name {:?} cannot head a column of a table", **band);
    Err(source.value_error(band, what, "use letters, digits and `_ - . +` only"))
}

//! Objects of a file that are lit on both sides: those whose faces are turned inconsistently, since
//! nobody knows which side is meant, and those that the file says to be two-sided, unless they are
//! closed: nobody sees the inside.

use fredholm_mesh::{Patch, Topology};

use super::Context;
use super::surface::geometry;
use crate::check::Warning;
use crate::error::SceneError;
use crate::format::SurfaceEntry;
use crate::part::Part;

/// Names that are listed.
const MOST_NAMES_LISTED: usize = 4;

/// Which of the parts of one file have neighbouring faces that run along their common side in the
/// same direction, or have two sides as the file `said` and an open border.
pub(super) fn two_sided(
    context: &mut Context,
    entry: &SurfaceEntry,
    parts: &[Part],
    said: &[bool],
) -> Result<Vec<bool>, SceneError> {
    let (source, mut pieces, mut part_of): (_, Vec<Patch>, Vec<usize>) =
        (context.reading.source, vec![], vec![]);
    for (number, part) in parts.iter().enumerate() {
        for shape in part.shapes.iter() {
            let own = shape.blockers(&part.cutting);
            let own = own.map_err(|error| geometry(source, entry, &error, (source, part.span.clone())))?;
            part_of.resize(part_of.len() + own.len(), number);
            pieces.extend(own);
        }
    }
    let topology = Topology::of(&pieces);
    let mut sides = vec![false; parts.len()];
    for &(_, clash) in &topology.clashes {
        for piece in clash {
            sides[part_of[piece as usize]] = true;
        }
    }
    let inconsistent = sides.clone();
    for (piece, &component) in topology.component_of.iter().enumerate() {
        let part = part_of[piece];
        sides[part] |= said.get(part) == Some(&true) && !topology.components[component as usize].closed;
    }
    if let Some(([from, to], _)) = topology.clashes.first() {
        let names: Vec<&str> = parts
            .iter()
            .zip(&inconsistent)
            .filter(|(_, two)| **two)
            .map(|(part, _)| part.name.as_str())
            .collect();
        let count = topology.clashes.len();
        let what = format!(
            "the faces of {} are turned inconsistently: the two that share a side run along it in the same direction at \
             {count} sides, the first from {from} to {to} m; lit on both sides",
            listed(&names)
        );
        let help = "turn the faces one way in the program that made the file, or set two_sided = false to light fronts only";
        let (file, place) = (source.path.clone(), source.place(entry.name.span()));
        context.reading.notes.push(Warning { file, place, what, help: help.to_owned() });
    }
    Ok(sides)
}

/// The first names, and how many more.
fn listed(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().take(MOST_NAMES_LISTED).map(|name| format!("`{name}`")).collect();
    match names.len().saturating_sub(MOST_NAMES_LISTED) {
        0 => quoted.join(", "),
        more => format!("{} and {more} more", quoted.join(", ")),
    }
}

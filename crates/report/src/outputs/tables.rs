//! Tables of a solution.

use std::io::{self, Write};

use super::{Contents, Extras, LIGHT_COMMANDS, OutputFile, Wanted};
use crate::catalogue::{CataloguedFile, file};
use crate::{write_faces_csv, write_false_colour_csv, write_field_csv, write_points_csv, write_surfaces_csv};

/// A row an element.
pub(super) struct Elements;

impl OutputFile for Elements {
    fn name(&self) -> &'static str {
        "field.csv"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            LIGHT_COMMANDS,
            "a row an element",
            &[
                ("element", "", "number of the unknown, from 0"),
                ("face", "", "number of its input face"),
                ("surface", "", "name"),
                ("cx, cy, cz", "m", "centroid"),
                ("nx, ny, nz", "1", "unit normal to the lit side"),
                ("area", "m²", "of the whole element"),
                ("irradiance_BAND", "W/m²", "mean over the whole element"),
                ("radiosity_BAND", "W/m²", "the same"),
            ],
        ))
    }

    fn is_wanted(&self, _: &Wanted) -> bool {
        true
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_field_csv(contents.field, out)
    }
}

/// A row an input face.
pub(super) struct Faces;

impl OutputFile for Faces {
    fn name(&self) -> &'static str {
        "faces.csv"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve, resume, shoot",
            "a row an input face: area means over its elements",
            &[
                ("face", "", "number, from 0"),
                ("surface", "", "name"),
                ("cx, cy, cz", "m", "centroid"),
                ("area", "m²", ""),
                ("irradiance_BAND", "W/m²", "mean"),
                ("radiosity_BAND", "W/m²", "mean"),
            ],
        ))
    }

    fn is_wanted(&self, _: &Wanted) -> bool {
        true
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_faces_csv(contents.field, out)
    }
}

/// A row a named surface.
pub(super) struct Surfaces;

impl OutputFile for Surfaces {
    fn name(&self) -> &'static str {
        "surfaces.csv"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            LIGHT_COMMANDS,
            "a row a named surface",
            &[
                ("surface", "", "name"),
                ("faces, elements", "1", "numbers of them"),
                ("area", "m²", ""),
                ("irradiance_BAND, radiosity_BAND", "W/m²", "area means"),
                ("emitted_BAND", "W", "Σ A M"),
                ("reflected_BAND", "W", "Σ A (B − M)"),
                ("absorbed_BAND", "W", "Σ A (E − (B − M))"),
            ],
        ))
    }

    fn is_wanted(&self, _: &Wanted) -> bool {
        true
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_surfaces_csv(contents.field, out)
    }
}

/// The irradiance of points.
pub(super) struct Points;

impl OutputFile for Points {
    fn name(&self) -> &'static str {
        "points.csv"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --point, --plane",
            "a row a point",
            &[
                ("x, y, z", "m", ""),
                ("nx, ny, nz", "1", "unit normal"),
                ("irradiance_BAND", "W/m²", "gathered from the solution"),
            ],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.points
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.points.is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        let points = contents.more.points.as_ref();
        points.map_or(Ok(()), |table| write_points_csv(table, contents.field.bands(), out))
    }
}

/// The numbers of the picture in false colour.
pub(super) struct FalseColours;

impl OutputFile for FalseColours {
    fn name(&self) -> &'static str {
        "false_colour.csv"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --false-colour",
            "a row a number of the picture",
            &[
                ("column, row", "", "of the pixel, from the upper left, from 0"),
                ("element, face", "", "numbers, from 0"),
                ("surface", "", "name"),
                ("x, y, z", "m", "the point seen through the middle of the pixel"),
                ("irradiance", "W/m²", "there, in the band of the picture or in all bands together"),
            ],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.false_colour
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.false_colour.is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        let drawn = contents.more.false_colour.as_ref();
        drawn.map_or(Ok(()), |drawn| write_false_colour_csv(contents.field.mesh(), &drawn.numbers, out))
    }
}

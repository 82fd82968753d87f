//! The elements of a solution for other programs.

use std::io::{self, Write};

use super::{Contents, Extras, FIELD_GLB, FIELD_PLY, OutputFile, Wanted};
use crate::catalogue::{CataloguedFile, file};
use crate::{write_field_glb, write_field_ply, write_npz, write_shadows_vtu, write_vtu};

/// The elements for ParaView.
pub(super) struct Vtu;

impl OutputFile for Vtu {
    fn name(&self) -> &'static str {
        "field.vtu"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve, resume, shoot",
            "the elements for ParaView, points in m; cell data",
            &[
                ("element, face, surface", "", "numbers, from 0"),
                ("area", "m²", ""),
                ("exposed", "1", "share that is not buried"),
                ("irradiance_BAND, radiosity_BAND", "W/m²", ""),
            ],
        ))
    }

    fn is_wanted(&self, _: &Wanted) -> bool {
        true
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_vtu(contents.field, out)
    }
}

/// The elements as NumPy arrays.
pub(super) struct Npz;

impl OutputFile for Npz {
    fn name(&self) -> &'static str {
        "field.npz"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve, resume, shoot",
            "the elements as NumPy arrays",
            &[
                ("irradiance, radiosity", "W/m²", "f64, elements × bands"),
                ("area", "m²", "f64, elements"),
                ("exposed", "1", "f64, elements: share that is not buried"),
                ("centroid", "m", "f64, elements × 3"),
                ("normal", "1", "f64, elements × 3"),
                (
                    "face, surface",
                    "",
                    "i64, elements: numbers, from 0; names of surfaces are in surfaces.csv",
                ),
                ("bands", "", "text, bands: their names"),
            ],
        ))
    }

    fn is_wanted(&self, _: &Wanted) -> bool {
        true
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_npz(contents.field, out)
    }
}

/// The elements cut along the borders of shadows.
pub(super) struct Shadows;

impl OutputFile for Shadows {
    fn name(&self) -> &'static str {
        "shadows.vtu"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --discontinuity",
            "triangles cut along the borders of shadows, points in m",
            &[
                ("irradiance_BAND", "W/m²", "at the corners"),
                ("element", "", "the element that the triangle is a part of"),
            ],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.shadows
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.shadows.is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        let shadows = contents.more.shadows.as_ref();
        shadows.map_or(Ok(()), |mesh| write_shadows_vtu(mesh, contents.field.bands(), out))
    }
}

/// The elements with colours, as PLY.
pub(super) struct Ply;

impl OutputFile for Ply {
    fn name(&self) -> &'static str {
        FIELD_PLY
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --also ply",
            "the elements with colours at their corners (sRGB); of each",
            &[
                ("element, face, surface", "", "numbers, from 0"),
                ("irradiance_BAND, radiosity_BAND", "W/m²", ""),
            ],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.also.contains(&FIELD_PLY)
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.also.contains(&FIELD_PLY)
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_field_ply(contents.field, contents.more.exposure, out)
    }
}

/// The same as binary glTF.
pub(super) struct Glb;

impl OutputFile for Glb {
    fn name(&self) -> &'static str {
        FIELD_GLB
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --also glb",
            "the same as binary glTF, with the radiosity (W/m²) at the corners",
            &[],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.also.contains(&FIELD_GLB)
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.also.contains(&FIELD_GLB)
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_field_glb(contents.field, contents.more.exposure, out)
    }
}

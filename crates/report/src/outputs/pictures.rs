//! Pictures of a solution.

use std::io::{self, Cursor, Write};

use ndarray::ArrayView3;
use ndarray_npy::NpzWriter;

use super::{
    Contents, Extras, FALSE_COLOUR, FIELD_EXR, IMAGE, LINKS_PICTURE, MESH_PICTURE, OutputFile, Wanted,
};
use crate::catalogue::{CataloguedFile, file};
use crate::{PIXELS, Picture};

/// One of the further pictures, by its name.
fn drawn<'a>(more: &'a Extras<'_>, name: &str) -> Option<&'a Picture> {
    more.pictures.iter().find(|(drawn, _)| *drawn == name).map(|(_, picture)| picture)
}

fn png(picture: Option<&Picture>, out: &mut dyn Write) -> io::Result<()> {
    picture.map_or(Ok(()), |picture| picture.write_png(out))
}

/// The picture.
pub(super) struct Image;

impl OutputFile for Image {
    fn name(&self) -> &'static str {
        IMAGE
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(self.name(), "solve, resume, shoot, trace", "the picture", &[]))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.image
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.image.is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        png(contents.more.image.as_ref(), out)
    }
}

/// Its linear colours.
pub(super) struct Exr;

impl OutputFile for Exr {
    fn name(&self) -> &'static str {
        FIELD_EXR
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --also exr",
            "linear colours of the picture before exposure: radiosity as linear sRGB, W/m²",
            &[],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.image && wanted.also.contains(&FIELD_EXR)
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.image.is_some() && more.also.contains(&FIELD_EXR)
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        let more = contents.more;
        more.image.as_ref().map_or(Ok(()), |picture| picture.write_exr(&more.linear, out))
    }
}

/// The elements.
pub(super) struct Mesh;

impl OutputFile for Mesh {
    fn name(&self) -> &'static str {
        MESH_PICTURE
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            "mesh.png, links.png",
            "solve --accuracy",
            "the elements, and from where one of them receives light",
            &[],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.links
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        drawn(more, MESH_PICTURE).is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        png(drawn(contents.more, MESH_PICTURE), out)
    }
}

/// From where an element receives light; told with [`Mesh`].
pub(super) struct Links;

impl OutputFile for Links {
    fn name(&self) -> &'static str {
        LINKS_PICTURE
    }

    fn about(&self) -> Option<CataloguedFile> {
        None
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.links
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        drawn(more, LINKS_PICTURE).is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        png(drawn(contents.more, LINKS_PICTURE), out)
    }
}

/// The colours of a picture whose light was gathered, and their errors.
pub(super) struct Pixels;

impl OutputFile for Pixels {
    fn name(&self) -> &'static str {
        PIXELS
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --final-gather",
            "the pixels of the picture, rows from the top; that of a traced picture has other arrays",
            &[
                (
                    "colour",
                    "W/m²",
                    "f32, height × width × 3: radiosity as linear sRGB, 0 where nothing is seen",
                ),
                (
                    "standard_error",
                    "W/m²",
                    "f32, the same shape: of the gathered light at the middle of the pixel, without the errors of the solution; no number where light is interpolated between elements",
                ),
            ],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.gather
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.image.is_some() && !more.standard_error.is_empty()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        let more = contents.more;
        let Some(picture) = &more.image else { return Ok(()) };
        let shape = (picture.height as usize, picture.width as usize, 3);
        let mut npz = NpzWriter::new(Cursor::new(Vec::new()));
        for (name, values) in [("colour", &more.linear), ("standard_error", &more.standard_error)] {
            let values = ArrayView3::from_shape(shape, values.as_flattened()).map_err(io::Error::other)?;
            npz.add_array(name, &values).map_err(io::Error::other)?;
        }
        out.write_all(npz.finish().map_err(io::Error::other)?.get_ref())
    }
}

/// The irradiance in false colour.
pub(super) struct FalseColours;

impl OutputFile for FalseColours {
    fn name(&self) -> &'static str {
        FALSE_COLOUR
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --false-colour",
            "irradiance in false colour, with lines of equal irradiance and numbers, W/m²",
            &[],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.false_colour
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.false_colour.is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        png(contents.more.false_colour.as_ref().map(|drawn| &drawn.picture), out)
    }
}

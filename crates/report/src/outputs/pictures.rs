//! Pictures of a solution.

use std::io::{self, Write};

use super::{
    Contents, Extras, FALSE_COLOUR, FIELD_EXR, GATHER, IMAGE, LINKS_PICTURE, MESH_PICTURE, OutputFile, Wanted,
};
use crate::Picture;
use crate::catalogue::{CataloguedFile, file};

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
            "linear colours of the picture, radiance in W/(m² sr) before exposure",
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

/// The picture for which every pixel gathers its light.
pub(super) struct Gathered;

impl OutputFile for Gathered {
    fn name(&self) -> &'static str {
        GATHER
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(
            self.name(),
            "solve --final-gather",
            "the picture for which every pixel gathers its light",
            &[],
        ))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.gather
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        drawn(more, GATHER).is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        png(drawn(contents.more, GATHER), out)
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

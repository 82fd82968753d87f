//! Where two solutions differ: pictures in the colours of the score z, with their bar.
//!
//! Nearly white is agreement, red is where what was traced is the brighter, blue where it is the
//! darker; full at |z| = 5.

use fredholm_mesh::Mesh;

use crate::picture::{BACKGROUND, supersampled};
use crate::plot::{Annotated, ColourBar, Scale, diverging};
use crate::tone::decode;
use crate::{Camera, Eye, Field, Picture, ReportError};

/// Score of the full colour.
const FULL_COLOUR_SCORE: f64 = 5.0;

/// Draws the scores of the faces, the worst band of each, under a title.
///
/// # Errors
/// [`ReportError::Length`] where there is not one score a face, [`ReportError::Camera`] for
/// settings that make no picture, [`ReportError::Visibility`] where the surfaces cannot be prepared
/// for ray casting, [`ReportError::Drawing`] where the plotting library fails.
pub fn score_map(
    mesh: &Mesh,
    scores: &[f64],
    camera: Option<&Camera>,
    title: &str,
) -> Result<Picture, ReportError> {
    let (expected, found) = (mesh.faces().len(), scores.len());
    if found != expected {
        return Err(ReportError::Length { what: "the scores of faces", expected, found });
    }
    let (bands, dark) = (["z".to_owned()], vec![0.0; mesh.len()]);
    let field = Field::new(mesh, &bands, &dark, &dark)?;
    let camera = camera.copied().unwrap_or_else(|| Camera::framing(&field)).enlarged();
    let eye = Eye::new(mesh, &camera)?;
    // Of every face its own colour: scores are not interpolated.
    let picture = supersampled(&camera, |x, y| {
        let colour = |(leaf, _)| score_colour(scores[mesh.face_of(leaf)]).map(decode);
        eye.hit(x, y).map_or([BACKGROUND; 3], colour)
    });
    with_score_bar(title, &picture)
}

/// A picture of scores with a title, and the colours of the scores beside it.
pub(crate) fn with_score_bar(title: &str, picture: &Picture) -> Result<Picture, ReportError> {
    let scale = Scale::linear(-FULL_COLOUR_SCORE, FULL_COLOUR_SCORE);
    let bar = ColourBar { label: "score z of the worst band", scale, colour: diverging };
    Annotated { title, picture, bar: Some(bar), isolines: &[], numbers: &[] }.drawn()
}

/// The colour of a score.
pub(crate) fn score_colour(z: f64) -> [u8; 3] {
    diverging(0.5 + 0.5 * z / FULL_COLOUR_SCORE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::grid;
    use fredholm_mesh::{MeshBuilder, Vec3};

    #[test]
    fn brighter_is_red_and_darker_is_blue() {
        let mut builder = MeshBuilder::default();
        builder.surface("wall", 0);
        grid(&mut builder, &[0.0, 1.0], &[0.0, 1.0]);
        let mesh = builder.build();
        let camera = Camera {
            eye: Vec3::new(0.5, 0.5, 2.0),
            target: Vec3::new(0.5, 0.5, 0.0),
            up: Vec3::Y,
            vertical_fov_degrees: 10.0,
            width: 2,
            height: 2,
        };
        // The picture stands below a title of one line, within the border.
        let pixel = |z: f64| {
            let picture = score_map(&mesh, &[z], Some(&camera), "a wall").unwrap();
            let at = 3 * (45 * picture.width as usize + 14);
            [picture.pixels[at], picture.pixels[at + 1], picture.pixels[at + 2]]
        };
        let (red, white, blue) = (pixel(9.0), pixel(0.0), pixel(-9.0));
        assert!(
            red[0] > 100 && red[1] < red[0] / 2 && blue[2] > 100 && blue[0] < blue[2] / 2,
            "{red:?} {blue:?}"
        );
        assert!(white[0] == white[1] && white[1] == white[2]);
        assert!(score_map(&mesh, &[], None, "a wall").is_err());
    }
}

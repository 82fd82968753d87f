//! Where two solutions differ: a picture of the scene in the colours of z.
//!
//! White is agreement, red is where the stochastic solution is the brighter, blue where it is the
//! darker; full at |z| = 5.

use fredholm_mesh::Mesh;

use crate::{Camera, Exposure, Field, Picture, ReportError, render};

/// Score of the full colour.
const FULL_COLOUR_SCORE: f64 = 5.0;
/// Brightness of white.
const WHITE_BRIGHTNESS: f64 = 1.0;

/// Draws the scores of the faces, the worst band of each.
///
/// # Errors
/// [`ReportError::Length`] where there is not one score a face, and those of [`render`].
pub fn score_map(mesh: &Mesh, scores: &[f64], camera: Option<&Camera>) -> Result<Picture, ReportError> {
    let (expected, found) = (mesh.faces().len(), scores.len());
    if found != expected {
        return Err(ReportError::Length { what: "the scores of faces", expected, found });
    }
    let bands = ["r", "g", "b"].map(str::to_owned);
    let colours: Vec<f64> =
        (0..mesh.len()).flat_map(|leaf| score_colour(scores[mesh.face_of(leaf)])).collect();
    let field = Field::new(mesh, &bands, &colours, &colours)?;
    let camera = camera.copied().unwrap_or_else(|| Camera::framing(&field));
    render(&field, &camera, Exposure::Fixed(1.0))
}

/// The linear colour of a score.
pub(crate) fn score_colour(z: f64) -> [f64; 3] {
    let share = (z / FULL_COLOUR_SCORE).clamp(-1.0, 1.0);
    let faded = WHITE_BRIGHTNESS * (1.0 - share.abs());
    if share > 0.0 { [WHITE_BRIGHTNESS, faded, faded] } else { [faded, faded, WHITE_BRIGHTNESS] }
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
        let pixel = |z: f64| {
            let picture = score_map(&mesh, &[z], Some(&camera)).unwrap();
            [picture.pixels[0], picture.pixels[1], picture.pixels[2]]
        };
        let (red, white, blue) = (pixel(9.0), pixel(0.0), pixel(-9.0));
        assert!(
            red[0] > 100 && red[1] < red[0] / 2 && blue[2] > 100 && blue[0] < blue[2] / 2,
            "{red:?} {blue:?}"
        );
        assert!(white[0] == white[1] && white[1] == white[2]);
        assert!(score_map(&mesh, &[], None).is_err());
    }
}

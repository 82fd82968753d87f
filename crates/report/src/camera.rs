//! A pinhole camera.
//!
//! The ray through the picture at (x, y), from −1 to 1, y upwards, goes along d = f + x tan(α/2)
//! (width/height) r + y tan(α/2) u, with the unit vectors forward f, right r, up u and the vertical
//! field of view α.

use fredholm_mesh::{Patch, Vec3};

use crate::{Field, ReportError};

/// Largest width or height, pixels.
const MOST_PIXELS_A_SIDE: u32 = 16_384;
/// Cosine above which the direction of view counts as vertical.
const VERTICAL_COSINE: f64 = 0.9;
/// Share of the total area below which the openings of a scene do not decide where it is seen from.
const MOST_OPEN_SHARE: f64 = 1e-3;
/// Cosine above which the direction of view is turned to an axis.
const ALIGNED_COSINE: f64 = 0.8;
/// Tangent of the angle at which a scene is looked down on.
const TILT_TANGENT: f64 = 0.12;
/// Cosine to the direction of view below which a point is not before the eye.
const LEAST_VIEW_COSINE: f64 = 1e-3;
/// Pixels in a row from which on a picture has room for a title.
pub(crate) const LEAST_WRITTEN_WIDTH: u32 = 480;
/// Room left around a framed scene.
const FRAME_MARGIN: f64 = 1.02;

/// Where a picture is taken from. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position of the eye.
    pub eye: Vec3,
    /// Point in the middle of the picture.
    pub target: Vec3,
    /// Direction that is up in the picture.
    pub up: Vec3,
    /// Field of view from the lower to the upper edge, degrees.
    pub vertical_fov_degrees: f64,
    /// Pixels in a row.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
}

/// The unit vectors of a checked camera, right and up already scaled to the edges of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axes {
    forward: Vec3,
    right: Vec3,
    up: Vec3,
}

/// Width and height of the picture of a scene without a camera of its own, pixels.
pub const USUAL_PIXELS: [u32; 2] = [800, 600];

impl Camera {
    /// A camera that sees the whole scene: through its opening, or through a wall where it is
    /// closed, since walls are invisible from behind. Up is opposite to where the lamps shine, else
    /// y.
    #[must_use]
    pub fn framing(field: &Field<'_>) -> Self {
        let up = upward(field);
        let forward = view(field, up);
        let camera = Self {
            eye: Vec3::ZERO,
            target: field.mesh().bounds().map_or(Vec3::ZERO, |bounds| bounds.centre()),
            up,
            vertical_fov_degrees: 40.0,
            width: USUAL_PIXELS[0],
            height: USUAL_PIXELS[1],
        };
        let distance = FRAME_MARGIN * reach(field, &camera, forward);
        Self { eye: camera.target - forward * distance, ..camera }
    }

    /// The axes of the camera.
    ///
    /// # Errors
    /// [`ReportError::Camera`] for numbers that are not finite, an eye at the target, an up along
    /// the direction of view, a field of view outside 0 to 180 degrees, or a size of 0 or above
    /// 16,384 pixels.
    pub(crate) fn axes(&self) -> Result<Axes, ReportError> {
        self.fault().map_or_else(
            || Ok(self.axes_along((self.target - self.eye).normalize())),
            |why| Err(ReportError::Camera { why }),
        )
    }

    fn fault(&self) -> Option<String> {
        let forward = self.target - self.eye;
        let (width, height, fov) = (self.width, self.height, self.vertical_fov_degrees);
        if ![self.eye, self.target, self.up].iter().all(|v| v.is_finite()) {
            Some("eye, target and up must be finite numbers".to_owned())
        } else if forward.try_normalize().is_none() {
            Some("eye and target are the same point; move one of them".to_owned())
        } else if forward.normalize().cross(self.up.normalize_or_zero()).length() < 1e-9 {
            Some("up is along the direction of view; choose another up".to_owned())
        } else if !(fov > 0.0 && fov < 180.0) {
            Some(format!("vertical_fov_degrees is {fov}; it must lie between 0 and 180"))
        } else if ![width, height].iter().all(|side| (1..=MOST_PIXELS_A_SIDE).contains(side)) {
            Some(format!(
                "the picture is {width} × {height} pixels; each must be from 1 to {MOST_PIXELS_A_SIDE}"
            ))
        } else {
            None
        }
    }

    fn axes_along(&self, forward: Vec3) -> Axes {
        let right = forward.cross(self.up).normalize();
        let tangent = (0.5 * self.vertical_fov_degrees.to_radians()).tan();
        let aspect = f64::from(self.width) / f64::from(self.height);
        Axes { forward, right: right * (tangent * aspect), up: right.cross(forward) * tangent }
    }

    /// The unit directions of rays through places of the picture: column and row from the upper
    /// left, in pixels.
    ///
    /// # Errors
    /// [`ReportError::Camera`] for settings that make no picture.
    pub fn rays(&self) -> Result<impl Fn(f64, f64) -> Vec3 + Send + Sync + use<>, ReportError> {
        let (camera, axes) = (*self, self.axes()?);
        Ok(move |x, y| camera.direction(&axes, x, y))
    }

    /// Unit direction of the ray through the picture at column `x`, row `y` from the upper left, in
    /// pixels.
    pub(crate) fn direction(&self, axes: &Axes, x: f64, y: f64) -> Vec3 {
        let (x, y) = (2.0 * x / f64::from(self.width) - 1.0, 1.0 - 2.0 * y / f64::from(self.height));
        (axes.forward + axes.right * x + axes.up * y).normalize()
    }
}

impl Camera {
    /// The same view in a picture that is wide enough for what is written above it: of as many
    /// pixels, or a multiple of it along both sides as far as they may be so long.
    pub(crate) fn enlarged(self) -> Self {
        let possible = MOST_PIXELS_A_SIDE / self.height.max(1);
        let times = LEAST_WRITTEN_WIDTH.div_ceil(self.width.max(1)).min(possible).max(1);
        Self { width: self.width * times, height: self.height * times, ..self }
    }

    /// Column and row from the upper left, in pixels, at which a point is seen; none for one that
    /// is not before the eye.
    pub(crate) fn place(&self, axes: &Axes, point: Vec3) -> Option<(f64, f64)> {
        let line = point - self.eye;
        let depth = line.dot(axes.forward);
        let along = |axis: Vec3| line.dot(axis) / (depth * axis.length_squared());
        let (x, y) = (along(axes.right), along(axes.up));
        let place = (0.5 * (1.0 + x) * f64::from(self.width), 0.5 * (1.0 - y) * f64::from(self.height));
        (depth > LEAST_VIEW_COSINE * line.length()).then_some(place)
    }
}

fn corners<'a>(field: &Field<'a>) -> impl Iterator<Item = Vec3> + use<'a> {
    field.mesh().patches().flat_map(|patch| patch.corners().iter().copied())
}

/// Axis opposite to the mean direction of the lamps.
fn upward(field: &Field<'_>) -> Vec3 {
    let lamps = field.mesh().patches().enumerate().filter(|&(leaf, _)| field.emits(leaf));
    let (net, area) = lamps.fold((Vec3::ZERO, 0.0), |(net, area), (_, patch)| {
        (net + patch.normal() * patch.area(), area + patch.area())
    });
    if net.length() <= 0.5 * area { Vec3::Y } else { -nearest_axis(net) }
}

fn nearest_axis(v: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    let axes = [Vec3::Y, Vec3::Z, Vec3::X];
    let axis = axes.into_iter().find(|axis| axis.dot(v).abs() >= largest).unwrap_or(Vec3::Y);
    axis * axis.dot(v).signum()
}

/// Direction of view: against the net area vector Σ A n, which points out of the opening of a
/// scene, and a little downwards, so that level plates are not seen edge-on.
fn view(field: &Field<'_>, up: Vec3) -> Vec3 {
    let total: f64 = field.mesh().patches().map(Patch::area).sum();
    let net: Vec3 = field.mesh().patches().map(|patch| patch.normal() * patch.area()).sum();
    let level = if up.z.abs() > VERTICAL_COSINE { Vec3::Y } else { Vec3::Z };
    if net.length() <= MOST_OPEN_SHARE * total {
        return (level - TILT_TANGENT * up).normalize();
    }
    let forward = -net.normalize();
    let axis = nearest_axis(forward);
    let forward = if axis.dot(forward) > ALIGNED_COSINE { axis } else { forward };
    let steep = forward.dot(up).abs() > VERTICAL_COSINE;
    if steep { (forward + level).normalize() } else { (forward - TILT_TANGENT * up).normalize() }
}

/// Distance from the target at which every corner lies in the picture.
fn reach(field: &Field<'_>, camera: &Camera, forward: Vec3) -> f64 {
    let axes = camera.axes_along(forward);
    let needed = |p: Vec3| {
        let offset = p - camera.target;
        let across = offset.dot(axes.right).abs() / axes.right.length_squared();
        let along = offset.dot(axes.up).abs() / axes.up.length_squared();
        across.max(along) - offset.dot(forward)
    };
    let distance = corners(field).map(needed).fold(0.0, f64::max);
    if distance > 0.0 { distance } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::names;
    use fredholm_mesh::{Mesh, MeshBuilder};

    /// A box from (0, 0, 0) to (3, 2, 4), lit inside, with the walls wanted of x0, x1, y0, y1, z0,
    /// z1.
    fn room(walls: &[usize]) -> Mesh {
        let v = |i: usize| {
            Vec3::new(3.0 * (i & 1) as f64, 2.0 * ((i >> 1) & 1) as f64, 4.0 * ((i >> 2) & 1) as f64)
        };
        let rings = [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]];
        let mut builder = MeshBuilder::default();
        builder.surface("room", 0);
        for &wall in walls {
            builder.face(&[Patch::quad(rings[wall].map(v)).unwrap().unwrap()]).unwrap();
        }
        builder.build()
    }

    fn framed(mesh: &Mesh, lamp: Option<usize>) -> Camera {
        let (bands, zero) = (names(&["grey"]), vec![0.0; mesh.len()]);
        let mut exitance = zero.clone();
        if let Some(leaf) = lamp {
            exitance[leaf] = 1.0;
        }
        let field = Field::new(mesh, &bands, &zero, &zero).unwrap().with_exitance(&exitance).unwrap();
        Camera::framing(&field)
    }

    #[test]
    fn an_open_room_is_seen_through_its_opening() {
        let camera = framed(&room(&[0, 1, 2, 3, 5]), Some(3));
        assert_eq!((camera.up, camera.target), (Vec3::Y, Vec3::new(1.5, 1.0, 2.0)));
        let direction = Vec3::new(0.0, 0.12, -1.0).normalize();
        assert!((camera.eye - camera.target).normalize().distance(direction) < 1e-12);
    }

    #[test]
    fn a_framed_scene_just_fits() {
        for walls in [&[0, 1, 2, 3, 5][..], &[2, 5], &[0, 1, 2, 3, 4, 5], &[2]] {
            let mesh = room(walls);
            let camera = framed(&mesh, None);
            let forward = (camera.target - camera.eye).normalize();
            let right = forward.cross(camera.up).normalize();
            let tangent = 20.0_f64.to_radians().tan();
            // Place in the picture by similar triangles: 1 is the edge.
            let place = |p: Vec3| {
                let (offset, up) = (p - camera.eye, right.cross(forward));
                let scale = offset.dot(forward) * tangent;
                (offset.dot(right) / (scale * 4.0 / 3.0)).abs().max((offset.dot(up) / scale).abs())
            };
            let corners = mesh.patches().flat_map(|patch| patch.corners().iter().copied());
            let largest = corners.map(place).fold(0.0, f64::max);
            assert!(largest < 1.0 && largest > 0.94, "{walls:?}: {largest}");
        }
    }

    #[test]
    fn lamps_tell_which_way_is_up() {
        let camera = framed(&room(&[0, 1, 2, 3, 4, 5]), Some(5));
        assert_eq!(camera.up, Vec3::Z);
        let direction = Vec3::new(0.0, -1.0, 0.12).normalize();
        assert!((camera.eye - camera.target).normalize().distance(direction) < 1e-12);
        assert_eq!(framed(&room(&[0, 1, 2, 3, 4, 5]), None).up, Vec3::Y);
    }

    #[test]
    fn a_floor_is_seen_from_above() {
        let camera = framed(&room(&[2]), None);
        assert!(camera.eye.y > 1.0 && camera.axes().is_ok());
        assert!(framed(&room(&[]), None).axes().is_ok());
    }

    #[test]
    fn rays_pass_through_the_picture() {
        let camera = Camera {
            eye: Vec3::new(0.0, 0.0, 2.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov_degrees: 90.0,
            width: 200,
            height: 100,
        };
        let axes = camera.axes().unwrap();
        let at = |x, y| camera.direction(&axes, x, y);
        assert!(at(100.0, 50.0).distance(-Vec3::Z) < 1e-15);
        assert!(at(0.0, 0.0).distance(Vec3::new(-2.0, 1.0, -1.0).normalize()) < 1e-15);
        assert!(at(200.0, 50.0).distance(Vec3::new(2.0, 0.0, -1.0).normalize()) < 1e-15);
    }

    #[test]
    fn faults_are_named() {
        let good = framed(&room(&[0, 1, 2, 3, 4, 5]), None);
        let faults = [
            (Camera { eye: good.target, ..good }, "same point"),
            (Camera { up: good.target - good.eye, ..good }, "up is along"),
            (Camera { up: Vec3::ZERO, ..good }, "up is along"),
            (Camera { vertical_fov_degrees: 180.0, ..good }, "between 0 and 180"),
            (Camera { vertical_fov_degrees: f64::NAN, ..good }, "between 0 and 180"),
            (Camera { width: 0, ..good }, "0 × 600"),
            (Camera { height: 1_000_000, ..good }, "800 × 1000000"),
            (Camera { eye: Vec3::new(f64::NAN, 0.0, 0.0), ..good }, "finite"),
        ];
        for (camera, expected) in faults {
            let text = camera.axes().unwrap_err().to_string();
            assert!(text.contains(expected), "{text}");
        }
    }
}

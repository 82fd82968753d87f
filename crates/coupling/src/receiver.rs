//! What a point with a normal sees: F_j = ∫_j cosθ cosθ' V / (π r²) dA', the share of its
//! hemisphere, weighted by the cosine, that patch j covers. Dimensionless.
//!
//! Closed form: Lambert's sum over the edges of what is visible of the polygon
//! ([`point_to_polygon`](crate::form_factor::point_to_polygon); P. Schröder & P. Hanrahan, SIGGRAPH
//! 1993, doi:10.1145/166117.166138), less what convex bodies hide of them, exactly. Nothing is
//! integrated numerically: a point inside a closed room has Σ_j F_j = 1 up to rounding.
//!
//! The sky is a box around everything: what a point or a patch sees of it is what no surface
//! covers.

use crate::CouplingError;
use crate::form_factor::{Exchange, Hiding, PairIntegrator, Workspace, point_to_polygon};
use crate::polygon::{HalfSpace, clip};
use fredholm_linop::{LinopError, PackedSymmetric, Steps, Watch};
use fredholm_mesh::{Bounds, MeshError, Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, Body, Screen};
use rayon::prelude::*;

/// Heights below this part of the distance to the patch count as 0.
const ZERO_HEIGHT: f64 = 1e-12;
/// Part by which cones are wider than what they hold: far more than rounding.
const CONE_MARGIN: f64 = 1e-9;
/// Room between the scene and the sky, in diagonals of the scene.
const SKY_MARGIN: f64 = 0.5;

/// A place that receives, and the direction it looks in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Where it is, m.
    pub point: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

impl Receiver {
    /// A receiver at `point`; `None` where a coordinate is not finite or the normal has no
    /// direction.
    #[must_use]
    pub fn new(point: Vec3, normal: Vec3) -> Option<Self> {
        let normal = normal.try_normalize()?;
        point.is_finite().then_some(Self { point, normal })
    }

    /// The middles of `counts[0]` × `counts[1]` cells of the parallelogram spanned by `u` and `v`
    /// at `origin`, row by row along `u`; the normal is that of u × v.
    #[must_use]
    pub fn plane(origin: Vec3, [u, v]: [Vec3; 2], counts: [usize; 2]) -> Option<Vec<Self>> {
        let middle = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
        let cells = (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| (i, j)));
        let at = |(i, j)| origin + u * middle(i, counts[0]) + v * middle(j, counts[1]);
        cells.map(|cell| Self::new(at(cell), u.cross(v))).collect()
    }
}

/// What receivers look at: patches, several of which may count as one row, and what may hide them.
#[derive(Clone, Copy, Debug)]
pub struct Targets<'a> {
    /// The patches.
    pub patches: &'a [&'a Patch],
    /// Row of every patch, below `rows`.
    pub row_of: &'a [usize],
    /// Number of rows.
    pub rows: usize,
    /// What blocks the view.
    pub occluders: &'a Occluders,
}

impl Targets<'_> {
    /// Form factors from every receiver to every row, receivers × rows.
    ///
    /// A receiver sees a patch from its lit side only; one that lies in the plane of a patch sees
    /// nothing of it. `watch` is asked before every receiver whether to go on.
    ///
    /// # Errors
    /// [`CouplingError::Interrupted`] where the watch stops it.
    pub fn factors(&self, receivers: &[Receiver], watch: &dyn Watch) -> Result<Vec<f64>, CouplingError> {
        let points: Vec<Vec3> = receivers.iter().map(|receiver| receiver.point).collect();
        let bodies = Bodies::new(self.occluders, self.patches, &points);
        let steps = Steps::new(watch, receivers.len() as u64, "points");
        let row = |receiver: &Receiver| steps.begin().is_continue().then(|| self.row(receiver, &bodies));
        let rows: Vec<Option<Vec<f64>>> = receivers.par_iter().map(row).collect();
        let (done, total) = (rows.iter().flatten().count(), rows.len());
        let rows: Option<Vec<Vec<f64>>> = rows.into_iter().collect();
        let stopped = CouplingError::Interrupted { done: done as u64, total: total as u64 };
        rows.map(|rows| rows.concat()).ok_or(stopped)
    }

    /// The form factors of one receiver, behind these bodies of the occluders.
    pub(crate) fn row(&self, receiver: &Receiver, bodies: &Bodies) -> Vec<f64> {
        let cones = bodies.as_slice().iter().map(|body| Cone::around(receiver.point, body.corners()));
        let mut sight = Sight { cones: cones.collect(), ..Sight::default() };
        let mut row = vec![0.0; self.rows];
        for (patch, &at) in self.patches.iter().zip(self.row_of) {
            row[at] += sight.factor(receiver, patch, self.occluders, bodies);
        }
        row
    }
}

/// A cone from a point around some others, and the distances between which they are, m.
#[derive(Clone, Copy, Debug)]
struct Cone {
    axis: Vec3,
    /// Cosine and sine of half the angle, below a right one; none where the point is among the
    /// others.
    half: Option<[f64; 2]>,
    near: f64,
    far: f64,
}

impl Cone {
    fn around(apex: Vec3, corners: &[Vec3]) -> Self {
        let centre = corners.iter().sum::<Vec3>() / corners.len().max(1) as f64;
        let square = corners.iter().map(|corner| corner.distance_squared(centre)).fold(0.0, f64::max);
        let (radius, way) = (square.sqrt() * (1.0 + CONE_MARGIN), centre - apex);
        let distance = way.length();
        let sine = radius / distance;
        let half = (sine < 1.0).then(|| [(1.0 - sine * sine).sqrt(), sine]);
        Self { axis: way.normalize_or_zero(), half, near: distance - radius, far: distance + radius }
    }

    /// Whether no segment from the apex to what is in `target` meets what is in this one.
    fn is_beside(&self, target: &Self) -> bool {
        let (Some([cos, sin]), Some([other_cos, other_sin])) = (self.half, target.half) else { return false };
        let apart = self.axis.dot(target.axis) < cos * other_cos - sin * other_sin - CONE_MARGIN;
        apart || self.near > target.far
    }
}

/// Buffers of one receiver.
#[derive(Default)]
struct Sight {
    /// Around the bodies.
    cones: Vec<Cone>,
    target: Vec<Vec3>,
    hiding: Hiding,
}

impl Sight {
    fn factor(&mut self, receiver: &Receiver, patch: &Patch, occluders: &Occluders, bodies: &Bodies) -> f64 {
        let Receiver { point, normal } = *receiver;
        let plane = HalfSpace::through(patch.centroid(), patch.normal());
        let flat = ZERO_HEIGHT * (point.distance(patch.centroid()) + patch.diameter());
        if plane.height(point) <= flat {
            return 0.0;
        }
        let horizon = HalfSpace::through(point, normal);
        self.target.clear();
        clip(patch.corners(), horizon, flat, &mut self.target);
        if self.target.len() < 3 {
            return 0.0;
        }
        let whole = point_to_polygon(normal, self.target.iter().map(|&x| x - point));
        if bodies.as_slice().is_empty() {
            return whole;
        }
        let around = Cone::around(point, patch.corners());
        let may = |(body, cone)| (!Cone::is_beside(cone, &around)).then_some(body);
        let mut near = bodies.as_slice().iter().zip(&self.cones).filter_map(may).peekable();
        if near.peek().is_none() {
            return whole.max(0.0);
        }
        let shaft = occluders.shaft_from(point, patch);
        let reaches = |body: &&Body| shaft.as_ref().is_some_and(|shaft| occluders.reaches(body, shaft));
        let screen = |body| Screen::new(body, &[point], &self.target, bodies.tolerance());
        let between: Vec<Screen> = near.filter(reaches).map(screen).collect();
        let hidden = self.hiding.hidden_factor(point, normal, &self.target, between.iter().enumerate());
        (whole - hidden).max(0.0)
    }
}

/// Six patches around everything within `bounds`, lit inside: the sky. Every ray that leaves the
/// scene ends on one of them, so that F_i,sky is found as any other form factor, from what nothing
/// covers, and not as what the others leave of 1.
///
/// # Errors
/// [`MeshError`] for bounds that are not finite or hold a single point.
pub fn sky(bounds: Bounds) -> Result<Vec<Patch>, MeshError> {
    let room = Vec3::splat(SKY_MARGIN * bounds.diagonal());
    let (low, high) = (bounds.min - room, bounds.max + room);
    let corner = |k: usize| {
        let pick = |bit: usize, low: f64, high: f64| if k & bit == 0 { low } else { high };
        Vec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z))
    };
    // Corner k has bit 1 for high x, 2 for high y, 4 for high z; counter-clockwise seen from
    // inside.
    let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let quads = faces.map(|face| Patch::quad(face.map(corner)));
    quads.into_iter().filter_map(Result::transpose).collect()
}

/// What each of the first `surfaces` patches of `integrator` exchanges with the others, those of
/// the sky: Σ_k A_i F_ik and its stated error, m².
///
/// The outer integral goes over the surface: the sky is large, and most of it sees nothing of a
/// surface among others, so that points on it would miss what little there is.
///
/// # Errors
/// [`CouplingError::Interrupted`] where the watch, asked before every patch, stops it.
pub fn sky_exchanges(
    integrator: &PairIntegrator,
    surfaces: usize,
    watch: &dyn Watch,
) -> Result<Vec<[f64; 2]>, CouplingError> {
    let steps = Steps::new(watch, surfaces as u64, "elements");
    let sum = |work: &mut Workspace, i: usize| {
        steps.begin().is_continue().then(|| {
            let parts = (surfaces..integrator.len()).map(|k| integrator.exchange_of_a_row(i, k, work));
            parts.fold([0.0; 2], |[value, error], part: Exchange| [value + part.value, error + part.stated()])
        })
    };
    let found: Vec<Option<[f64; 2]>> =
        (0..surfaces).into_par_iter().map_init(Workspace::default, sum).collect();
    let done = found.iter().flatten().count() as u64;
    let stopped = CouplingError::Interrupted { done, total: surfaces as u64 };
    found.into_iter().collect::<Option<_>>().ok_or(stopped)
}

/// The matrix with a last row for the sky, which exchanges `sky[i]` (m²) with row i and nothing
/// with itself.
///
/// # Errors
/// [`LinopError::Length`] unless `sky` has an entry a row.
pub fn with_sky(matrix: &PackedSymmetric<f64>, sky: &[f64]) -> Result<PackedSymmetric<f64>, LinopError> {
    let mut packed = Vec::new();
    (0..matrix.dim()).for_each(|i| packed.extend_from_slice(matrix.packed_row(i)));
    packed.extend_from_slice(sky);
    packed.push(0.0);
    PackedSymmetric::new(matrix.dim() + 1, packed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_linop::Quiet;
    use fredholm_mesh::{Cutting, Lines, Mesh, MeshBuilder, Shape};
    use std::ops::ControlFlow;

    /// Whoever wants nothing.
    struct Cancelled;

    impl Watch for Cancelled {
        fn go_on(&self) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }

    fn room(boxes: &[[Vec3; 2]]) -> Mesh {
        let mut builder = MeshBuilder::default();
        builder.surface("room", 0);
        let cut = Cutting { lines: Lines::Counts { u: 3, v: 3 }, ..Cutting::default() };
        builder.add(&Shape::Box { min: Vec3::ZERO, max: Vec3::ONE, inward: true }, &cut).unwrap();
        for [min, max] in boxes {
            builder.add(&Shape::Box { min: *min, max: *max, inward: false }, &cut).unwrap();
        }
        builder.build()
    }

    fn factors(mesh: &Mesh, more: &[Patch], receivers: &[Receiver]) -> Vec<f64> {
        let occluders = Occluders::new(mesh.occluders()).unwrap();
        let patches: Vec<&Patch> = mesh.patches().chain(more).collect();
        let row_of: Vec<usize> = (0..patches.len()).map(|i| usize::from(i >= mesh.len())).collect();
        let targets = Targets { patches: &patches, row_of: &row_of, rows: 2, occluders: &occluders };
        targets.factors(receivers, &Quiet).unwrap()
    }

    fn receivers() -> Vec<Receiver> {
        let places =
            [[0.5, 0.5, 0.5], [0.05, 0.9, 0.31], [0.21, 0.13, 0.77], [0.999, 0.001, 0.5]].map(Vec3::from);
        let normals = [Vec3::Z, Vec3::NEG_X, Vec3::new(1.0, -2.0, 0.3), Vec3::new(-0.1, 0.2, -1.0)];
        places.iter().flat_map(|&p| normals.iter().filter_map(move |&n| Receiver::new(p, n))).collect()
    }

    #[test]
    fn a_point_in_a_closed_room_sees_all_of_it_once() {
        let boxes =
            [[Vec3::splat(0.55), Vec3::splat(0.8)], [Vec3::new(0.3, 0.2, 0.0), Vec3::new(0.4, 0.5, 0.6)]];
        for mesh in [room(&[]), room(&boxes)] {
            for (row, receiver) in factors(&mesh, &[], &receivers()).chunks(2).zip(receivers()) {
                assert!((row[0] - 1.0).abs() < 1e-12, "{receiver:?}: {:e}", row[0] - 1.0);
            }
        }
    }

    #[test]
    fn a_square_overhead_has_its_closed_form() {
        // Howell B-3, four times: a unit square at height 1 above its middle.
        let mut builder = MeshBuilder::default();
        builder.surface("lamp", 0);
        let lamp = [[-0.5, -0.5], [-0.5, 0.5], [0.5, 0.5], [0.5, -0.5]].map(|[x, y]| Vec3::new(x, y, 1.0));
        builder.add(&Shape::Quad { corners: lamp, skip: vec![] }, &Cutting::default()).unwrap();
        let s = 0.5 / 1.25_f64.sqrt();
        let exact = 4.0 * s * s.atan() / std::f64::consts::PI;
        let up = Receiver::new(Vec3::ZERO, Vec3::Z).unwrap();
        let down = Receiver::new(Vec3::ZERO, Vec3::NEG_Z).unwrap();
        let found = factors(&builder.build(), &[], &[up, down]);
        assert!((found[0] - exact).abs() < 1e-15 && found[2] == 0.0, "{found:?} {exact}");
    }

    #[test]
    fn the_sky_is_what_nothing_covers() {
        // A room without its ceiling: what was seen of the ceiling is seen of the sky.
        let whole = room(&[]);
        let up = Receiver::new(Vec3::new(0.3, 0.6, 0.25), Vec3::Z).unwrap();
        let is_ceiling = |patch: &Patch| patch.normal().z < -0.5;
        let mut builder = MeshBuilder::default();
        builder.surface("room", 0);
        let kept = whole.patches().filter(|patch| !is_ceiling(patch));
        kept.for_each(|patch| {
            builder.face(&[*patch]).unwrap();
            builder.occluder(*patch);
        });
        let open = builder.build();
        let sky = sky(open.bounds().unwrap()).unwrap();
        let found = factors(&open, &sky, &[up]);
        let ceiling: Vec<Patch> = whole.patches().filter(|patch| is_ceiling(patch)).copied().collect();
        let expected = factors(&open, &ceiling, &[up]);
        assert!((found[1] - expected[1]).abs() < 1e-13 && found[1] > 0.1, "{found:?} {expected:?}");
        assert!((found[0] + found[1] - 1.0).abs() < 1e-13);
    }

    #[test]
    fn walls_of_a_court_see_the_sky_as_a_lid() {
        // The open room of above, one patch a wall: what a wall exchanges with the sky it exchanged
        // with the lid (Howell C-11, C-14).
        let whole = Shape::Box { min: Vec3::ZERO, max: Vec3::ONE, inward: true };
        let mut builder = MeshBuilder::default();
        builder.surface("room", 0);
        builder.add(&whole, &Cutting::default()).unwrap();
        let room = builder.build();
        let walls: Vec<Patch> = room.patches().filter(|patch| patch.normal().z > -0.5).copied().collect();
        let sky = sky(room.bounds().unwrap()).unwrap();
        let occluders = Occluders::new(&walls).unwrap();
        let integrator = PairIntegrator::new(walls.iter().chain(&sky), &occluders, 1e-6);
        let found = sky_exchanges(&integrator, walls.len(), &Quiet).unwrap();
        for (wall, [value, error]) in walls.iter().zip(&found) {
            let exact = if wall.normal().z > 0.5 { 0.199_824_895_698_387_5 } else { 0.200_043_776_075_403_1 };
            assert!((value - exact).abs() < 1e-5 && *error < 2e-5, "{:e} {error:e}", value - exact);
        }
        let stopped = sky_exchanges(&integrator, walls.len(), &Cancelled);
        assert_eq!(stopped, Err(CouplingError::Interrupted { done: 0, total: 5 }));
    }

    #[test]
    fn the_row_of_the_sky_is_the_last() {
        let matrix = PackedSymmetric::new(2, vec![0.0, 0.5, 0.0]).unwrap();
        let found = with_sky(&matrix, &[0.1, 0.2]).unwrap();
        assert_eq!(found, PackedSymmetric::new(3, vec![0.0, 0.5, 0.0, 0.1, 0.2, 0.0]).unwrap());
        assert!(with_sky(&matrix, &[0.1]).is_err());
    }

    #[test]
    fn a_plane_is_a_grid_of_middles() {
        let plane = Receiver::plane(Vec3::ZERO, [Vec3::X * 2.0, Vec3::Y], [2, 1]).unwrap();
        assert_eq!(
            plane.iter().map(|r| r.point.to_array()).collect::<Vec<_>>(),
            [[0.5, 0.5, 0.0], [1.5, 0.5, 0.0]]
        );
        assert!(plane.iter().all(|r| r.normal == Vec3::Z));
        assert_eq!(Receiver::plane(Vec3::ZERO, [Vec3::X, Vec3::X], [1, 1]), None);
        assert_eq!(Receiver::new(Vec3::NAN, Vec3::Z), None);
    }

    #[test]
    fn stopping_leaves_no_partial_result() {
        let mesh = room(&[]);
        let occluders = Occluders::new(mesh.occluders()).unwrap();
        let patches: Vec<&Patch> = mesh.patches().collect();
        let row_of = vec![0; patches.len()];
        let targets = Targets { patches: &patches, row_of: &row_of, rows: 1, occluders: &occluders };
        let result = targets.factors(&receivers(), &Cancelled);
        assert_eq!(result, Err(CouplingError::Interrupted { done: 0, total: 16 }));
    }
}

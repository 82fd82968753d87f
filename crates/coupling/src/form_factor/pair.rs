//! A_i F_ij of any pair of patches: the cheapest method whose error estimate meets the tolerance.
//!
//! | the pair | method |
//! |---|---|
//! | one behind the other, or one body across all segments | 0, exactly |
//! | nothing between, apart | Gauss points along the edges ([`Unoccluded`]) |
//! | nothing between, close, touching or crossing each other's plane | contour integral on the parts that face each other |
//! | bodies between | the unoccluded value less its hidden part: exact shadows inside, rules between critical lines outside |
//! | many bodies between | sampled share of the unoccluded value, where that is exact enough |
//! | bodies between, in rows that have a budget | share from segments, as few as the row allows, or exact shadows where these are quicker |
//!
//! The tolerance T is relative to the exchange the two patches would have squarely facing each
//! other, A_i A_j / (π d²), or the smaller area where that is less: stated errors of a row of F
//! then add up to about 2 T. It is rounded down to a power of ten, but in rows with a budget: a little
//! more accuracy asked for then never gives a little less.
//!
//! In the assembly of a matrix, rows may have a [budget](PairIntegrator::with_row_budget): a pair
//! behind bodies then gets as many segments as it contributes to the row of its smaller patch, and
//! exact shadows where these are cheaper. With n = λp segments for a pair of form factor p, the
//! variance of a row is s² Σ p²/n = s² Σ p/λ ≤ s²/λ, with s² ≤ ¼ that of one segment.

use super::hidden::{HiddenWork, Occluded, hidden_exchange};
use super::rung::rung;
use super::sampled::sampled;
use super::segments::{Blockers, Wanted};
use super::small_receiver::small_receiver;
use super::{ErrorModel, Side, Unoccluded, Work, facing_exchange, front};
use crate::occlusion::{Clusters, Sight};
use crate::polygon::HalfSpace;
use fredholm_mesh::{Patch, Vec3};
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, Body, Face, Screen, Shadow, ShadowVolume};

/// Bodies up to which exact shadows are cheaper than sampling.
const MOST_EXACT_BODIES: usize = 128;

/// Independent segments of a pair over its form factor times the square of T: three standard errors
/// of a row are then about T where a third of it is behind bodies.
const SEGMENTS_OF_A_ROW: f64 = 0.35;
/// Variance of a pair over its form factor times the square of T, for the same.
const VARIANCE_OF_A_ROW: f64 = 0.29;
/// Independent segments of a pair at least, and so many that they are out of the question.
const LEAST_SEGMENTS: f64 = 8.0;
const ENDLESS: f64 = 1e12;
/// Segments that a pair gets at most: a second's worth.
const MOST_SEGMENTS: f64 = 4e6;
/// Segments that take about as long as exact shadows to T = 1e-3, for each face of the bodies up to
/// so many faces; behind more they are as many more (measured in a furnished room and on a scanned
/// figure of 1,000 triangles).
const SEGMENTS_OF_A_FACE: f64 = 100.0;
const FACES_OF_A_LINE: f64 = 32.0;
/// The power of 1/T with which the time of exact shadows grows.
const POWER_OF_SHADOWS: f64 = 0.4;
/// Standard errors that are stated.
pub(crate) const STANDARD_ERRORS: f64 = 3.0;
/// Bodies behind which exact shadows take a hundredth of a second at most.
const QUICK_BODIES: usize = 32;

/// Tolerance of exchanges with nothing between, in T: a digit more costs them next to nothing.
const OPEN_TOLERANCE: f64 = 0.1;

/// Distance of a small patch from a large one, in diameters of the large one, and its own diameter,
/// up to which points of the small one are cheaper than points along the edges.
const CLOSE_DISTANCE: f64 = 1.0;
const SMALL_DIAMETER: f64 = 0.1;

/// Relative difference of two quantities that count as equal.
const TIE_TOLERANCE: f64 = 1e-6;

/// How an exchange was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// One patch is behind the other, or one body hides it wholly.
    Hidden,
    /// Contour integral by Gauss points along the edges.
    Gauss,
    /// Contour integral of the parts that face each other, closed where edges touch.
    Contour,
    /// Exact shadows.
    Clipped,
    /// Sampled visibility.
    Sampled,
    /// Visibility of segments, their errors independent between pairs.
    Segments,
}

/// A_i F_ij, how wrong it may be, and where it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    /// A_i F_ij, m².
    pub value: f64,
    /// Estimated absolute error, m²; errors of a row add up.
    pub error: f64,
    /// Standard error of a part that is independent of all other pairs, m², as in rows that have a
    /// [budget](PairIntegrator::with_row_budget): of a row the squares add up.
    pub deviation: f64,
    /// Method.
    pub method: Method,
}

impl Exchange {
    /// Nothing is exchanged.
    pub const NONE: Self = Self { value: 0.0, error: 0.0, deviation: 0.0, method: Method::Hidden };

    /// A factor is not negative: rounding below 0 becomes 0 and is added to the error.
    pub(super) fn new(method: Method, estimate: Estimate) -> Self {
        let below = (-estimate.value).max(0.0);
        Self { value: estimate.value.max(0.0), error: estimate.error + below, deviation: 0.0, method }
    }

    /// The error that is stated for it alone, m²: with three standard errors.
    #[must_use]
    pub fn stated(&self) -> f64 {
        self.error + STANDARD_ERRORS * self.deviation
    }
}

/// Buffers of one thread.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    front: [Vec<Vec3>; 2],
    volume: ShadowVolume,
    open: Work,
    hidden: HiddenWork,
}

impl Workspace {
    /// Points at which the part behind bodies was asked for, of all exchanges so far: what they
    /// cost.
    #[must_use]
    pub fn points_behind_bodies(&self) -> u64 {
        self.hidden.points()
    }
}

/// Which patch the outer integral goes over.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Outer {
    /// The one that the occluders stand farther from. One that stands on a patch makes the outer
    /// integrand jump there, but not the inner integral.
    Clearer,
    /// The first.
    First,
}

/// Computes exchanges between patches of one scene.
#[derive(Debug)]
pub struct PairIntegrator<'a> {
    patches: Vec<&'a Patch>,
    sides: Vec<Side<'a>>,
    open: Unoccluded<'a>,
    occluders: &'a Occluders,
    bodies: Bodies,
    tolerance: f64,
    /// T as it was given, if that is not finer than the finest.
    asked: f64,
    /// Bodies up to which exact shadows come first.
    few: usize,
    model: ErrorModel,
    /// What rows have a budget by.
    rows: Option<Rows>,
}

/// The budget of rows.
#[derive(Debug)]
struct Rows {
    blockers: Blockers,
    /// T, which is not rounded here.
    tolerance: f64,
}

impl Rows {
    /// How exact the share of a pair is wanted, of a form factor from the smaller patch and behind
    /// some bodies.
    fn wanted(&self, factor: f64, bodies: &[u32]) -> Wanted {
        let square = self.tolerance * self.tolerance;
        let (faces, finer) =
            (self.blockers.faces(bodies) as f64, (1e-3 / self.tolerance).powf(POWER_OF_SHADOWS));
        let most = SEGMENTS_OF_A_FACE * faces * (faces / FACES_OF_A_LINE).max(1.0) * finer;
        Wanted {
            independent: (SEGMENTS_OF_A_ROW * factor / square).clamp(LEAST_SEGMENTS, ENDLESS) as usize,
            deviation: (VARIANCE_OF_A_ROW * square / factor).sqrt(),
            most: most.min(MOST_SEGMENTS) as usize,
        }
    }
}

impl<'a> PairIntegrator<'a> {
    /// Prepares the patches; `occluders` are what may stand between them, `tolerance` is T of the
    /// module's text.
    pub fn new(
        patches: impl IntoIterator<Item = &'a Patch>,
        occluders: &'a Occluders,
        tolerance: f64,
    ) -> Self {
        Self::with_groups(patches.into_iter().collect(), [], occluders, tolerance)
    }

    /// As [`new`](Self::new), and prepares patches that stand for several of `patches`; their
    /// numbers follow.
    pub(crate) fn with_groups(
        mut patches: Vec<&'a Patch>,
        groups: impl IntoIterator<Item = &'a Patch>,
        occluders: &'a Occluders,
        tolerance: f64,
    ) -> Self {
        let bodies = Bodies::new(occluders, &patches, &[]);
        let (asked, tolerance) = (tolerance.max(rung(tolerance)), rung(tolerance));
        patches.extend(groups);
        let open = Unoccluded::new(&patches, OPEN_TOLERANCE * tolerance);
        let sides = patches.iter().map(|patch| Side::of(patch)).collect();
        Self {
            patches,
            sides,
            open,
            occluders,
            bodies,
            tolerance,
            asked,
            few: MOST_EXACT_BODIES,
            model: ErrorModel::FITTED,
            rows: None,
        }
    }

    /// Lets the assembly spend on a pair behind bodies what it contributes to its rows: T is then
    /// the error of a row, not of each pair.
    #[must_use]
    pub fn with_row_budget(self) -> Self {
        Self { rows: Some(Rows { blockers: Blockers::new(&self.bodies), tolerance: self.asked }), ..self }
    }

    /// Computes exact shadows behind any number of bodies.
    pub(crate) fn without_sampling(self) -> Self {
        Self { few: usize::MAX, ..self }
    }

    /// States errors behind bodies by another model than the fitted one.
    #[must_use]
    pub fn with_error_model(self, model: ErrorModel) -> Self {
        Self { model, ..self }
    }

    /// Number of patches.
    #[must_use]
    pub fn len(&self) -> usize {
        self.patches.len()
    }

    /// Whether there are no patches.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// The smaller of two areas, m².
    #[must_use]
    pub fn smaller_area(&self, i: usize, j: usize) -> f64 {
        self.patches[i].area().min(self.patches[j].area())
    }

    /// Whether exact shadows of a pair are quick, or what the assembly asks of it anyway.
    pub(crate) fn is_quickly_exact(&self, i: usize, j: usize) -> bool {
        let between = || self.between(self.patches[i], self.patches[j]).len();
        self.rows.is_none() || between() <= QUICK_BODIES
    }

    /// A_i F_ij of patches i and j.
    pub fn exchange(&self, i: usize, j: usize, work: &mut Workspace) -> Exchange {
        self.compute(i, j, Outer::Clearer, work)
    }

    /// A_i F_ij with the outer integral, where there is one, over patch i: against the same of (j,
    /// i) it tests reciprocity.
    pub fn exchange_from(&self, i: usize, j: usize, work: &mut Workspace) -> Exchange {
        self.compute(i, j, Outer::First, work)
    }

    /// A_i F_ij with the outer integral, where there is one, over patch i; where rows have a budget,
    /// as exactly as it matters to them.
    pub(crate) fn exchange_of_a_row(&self, i: usize, j: usize, work: &mut Workspace) -> Exchange {
        let found = self.in_view(i, j, work);
        found.map_or(Exchange::NONE, |(open, bodies)| {
            self.behind_in_a_row([i, j], Outer::First, &bodies, open, work)
        })
    }

    fn compute(&self, i: usize, j: usize, outer: Outer, work: &mut Workspace) -> Exchange {
        let found = self.in_view(i, j, work);
        found.map_or(Exchange::NONE, |(open, bodies)| {
            let bodies = self.listed(&bodies);
            self.behind_bodies([self.side(i), self.side(j)], outer, &bodies, open, work)
        })
    }

    /// The exchange with nothing between, and the bodies that may come between; `None` where
    /// nothing is exchanged.
    fn in_view(&self, i: usize, j: usize, work: &mut Workspace) -> Option<(Exchange, Vec<u32>)> {
        let (a, b) = (self.side(i), self.side(j));
        let flat = a.flat(&b);
        if i == j || !rises(b.patch, a.plane, flat) || !rises(a.patch, b.plane, flat) {
            return None;
        }
        let (bodies, nothing) = (self.between(a.patch, b.patch), self.bodies.tolerance());
        let listed = self.listed(&bodies);
        if listed.iter().any(|body| blocks(body, a.patch, b.patch, nothing, &mut work.volume)) {
            return None;
        }
        let mut open = [Exchange::NONE];
        self.open.row(i, &[j as u32], &mut work.open, &mut open);
        Some((open[0], bodies))
    }

    fn listed(&self, bodies: &[u32]) -> Vec<&Body> {
        bodies.iter().map(|&k| &self.bodies.as_slice()[k as usize]).collect()
    }

    /// Groups of patches, for the assembly.
    pub(crate) fn clusters(&self) -> Clusters {
        Clusters::new(&self.patches, self.bodies.tolerance())
    }

    /// What decides about the visibility of groups.
    pub(crate) fn sight<'b>(&'b self, clusters: &'b Clusters) -> Sight<'b> {
        Sight { clusters, occluders: self.occluders, bodies: &self.bodies }
    }

    /// The exchanges of patch i with patches that nothing hides.
    pub(crate) fn open_row(&self, i: usize, columns: &[u32], work: &mut Workspace, row: &mut Vec<Exchange>) {
        row.clear();
        row.resize(columns.len(), Exchange::NONE);
        self.open.row(i, columns, &mut work.open, row);
    }

    /// As [`open_row`](Self::open_row) for a patch that is large beside the others.
    pub(crate) fn open_column(
        &self,
        j: usize,
        rows: &[u32],
        work: &mut Workspace,
        column: &mut Vec<Exchange>,
    ) {
        let found: Vec<Option<Exchange>> = rows.iter().map(|&i| self.small_receiver(j, i as usize)).collect();
        let rest: Vec<u32> =
            rows.iter().zip(&found).filter_map(|(&i, found)| found.is_none().then_some(i)).collect();
        let mut others = Vec::new();
        self.open_row(j, &rest, work, &mut others);
        let mut others = others.into_iter();
        column.clear();
        column.extend(found.into_iter().filter_map(|found| found.or_else(|| others.next())));
    }

    fn small_receiver(&self, large: usize, small: usize) -> Option<Exchange> {
        let (large, small) = (self.patches[large], self.patches[small]);
        // Far away, or of like size, few points along the edges are cheaper.
        let size = large.diameter();
        if large.centroid().distance(small.centroid()) > CLOSE_DISTANCE * size
            || small.diameter() > SMALL_DIAMETER * size
        {
            return None;
        }
        let goal = OPEN_TOLERANCE * self.tolerance * facing_exchange(large, small);
        Some(Exchange::new(Method::Gauss, small_receiver(large, small, goal)?))
    }

    /// What is left of an exchange behind bodies given by their numbers.
    pub(crate) fn behind(
        &self,
        [i, j]: [usize; 2],
        bodies: &[u32],
        open: Exchange,
        work: &mut Workspace,
    ) -> Exchange {
        self.behind_in_a_row([i, j], Outer::Clearer, bodies, open, work)
    }

    fn behind_in_a_row(
        &self,
        [i, j]: [usize; 2],
        outer: Outer,
        bodies: &[u32],
        open: Exchange,
        work: &mut Workspace,
    ) -> Exchange {
        if open.method == Method::Hidden || bodies.is_empty() {
            return open;
        }
        let sides = [self.side(i), self.side(j)];
        let Some(rows) = &self.rows else {
            return self.behind_bodies(sides, outer, &self.listed(bodies), open, work);
        };
        let wanted = rows.wanted(open.value / self.smaller_area(i, j), bodies);
        self.by_segments(rows, [i, j], bodies, wanted, open).unwrap_or_else(|| {
            let goal = rows.tolerance * sides[0].facing_exchange(&sides[1]);
            self.to_goal(sides, outer, (&self.listed(bodies), goal), open, work)
        })
    }

    fn behind_bodies(
        &self,
        sides: [Side; 2],
        outer: Outer,
        bodies: &[&Body],
        open: Exchange,
        work: &mut Workspace,
    ) -> Exchange {
        let [a, b] = sides;
        self.to_goal(sides, outer, (bodies, self.tolerance * a.facing_exchange(&b)), open, work)
    }

    /// The share or exact shadows, to an absolute goal (m²).
    fn to_goal(
        &self,
        sides: [Side; 2],
        outer: Outer,
        (bodies, goal): (&[&Body], f64),
        open: Exchange,
        work: &mut Workspace,
    ) -> Exchange {
        let [a, b] = sides;
        if bodies.is_empty() {
            return open;
        }
        let share = if bodies.len() > self.few { self.share(sides, open, goal) } else { None };
        share.unwrap_or_else(|| {
            let sides = if outer == Outer::First || clearer(a, b, bodies) { [a, b] } else { [b, a] };
            self.behind_all(sides, bodies, open, goal, work)
        })
    }

    /// The share from segments, where that takes less time than exact shadows.
    fn by_segments(
        &self,
        rows: &Rows,
        [i, j]: [usize; 2],
        bodies: &[u32],
        wanted: Wanted,
        open: Exchange,
    ) -> Option<Exchange> {
        let names = [i.min(j), i.max(j)];
        let pair = names.map(|name| self.patches[name]);
        let share = rows.blockers.share(pair, (bodies, self.occluders), wanted, names)?;
        Some(Exchange {
            value: open.value * share.value,
            error: open.error * share.value,
            deviation: open.value * share.deviation,
            method: Method::Segments,
        })
    }

    fn side(&self, i: usize) -> Side<'_> {
        self.sides[i]
    }

    /// The bodies that may come between two patches, by their numbers.
    fn between(&self, a: &Patch, b: &Patch) -> Vec<u32> {
        let Some(shaft) = self.occluders.shaft_between(a, b) else { return Vec::new() };
        self.occluders.reaching(&self.bodies, &shaft).map(|(number, _)| number).collect()
    }

    /// The sampled share, where it meets the tolerance.
    fn share(&self, [a, b]: [Side; 2], open: Exchange, tolerance: f64) -> Option<Exchange> {
        let open = Estimate { value: open.value, error: open.error };
        let sees = |p, q| self.occluders.unoccluded(p, q);
        let found = sampled(a.patch, b.patch, open, tolerance, sees);
        (found.error <= tolerance).then(|| Exchange::new(Method::Sampled, found))
    }

    /// What is left of the open exchange: the hidden part goes over the points of `a`.
    fn behind_all(
        &self,
        [a, b]: [Side; 2],
        bodies: &[&Body],
        open: Exchange,
        goal: f64,
        work: &mut Workspace,
    ) -> Exchange {
        let flat = a.flat(&b);
        let [front_a, front_b] = &mut work.front;
        front(a.patch, b.plane, flat, front_a);
        front(b.patch, a.plane, flat, front_b);
        let tolerance = self.bodies.tolerance();
        let cut: Vec<Option<Body>> = bodies.iter().map(|body| between(body, a, b, tolerance)).collect();
        let whole = cut.iter().zip(bodies).map(|(cut, whole)| cut.as_ref().unwrap_or(whole));
        let screens: Vec<Screen> = whole.map(|body| Screen::new(body, front_a, front_b, tolerance)).collect();
        let scene = Occluded {
            source: front_a,
            normal: a.patch.normal(),
            target: front_b,
            screens: &screens,
            open: open.value,
            tolerance,
        };
        let hidden = hidden_exchange(&scene, &self.model, goal, &mut work.hidden);
        let left = Estimate { value: open.value - hidden.value, error: open.error + hidden.error };
        Exchange::new(Method::Clipped, left)
    }
}

/// The part of a body in front of both patches, or `None` where that is the whole body.
fn between(body: &Body, a: Side, b: Side, tolerance: f64) -> Option<Body> {
    let [first, second] = [a, b].map(|side| Face { normal: side.plane.normal, offset: side.plane.offset });
    let part = body.in_front(&first, tolerance);
    part.as_ref().unwrap_or(body).in_front(&second, tolerance).or(part)
}

/// Whether a body blocks every segment between two patches. The points that a body hides from a
/// point make a convex set, on either side: what holds for the corners holds for all.
pub(crate) fn blocks(body: &Body, a: &Patch, b: &Patch, tolerance: f64, volume: &mut ShadowVolume) -> bool {
    a.corners().iter().all(|&x| match body.shadow(x, tolerance, volume) {
        Shadow::Nothing => false,
        Shadow::Volume => b.corners().iter().all(|&y| volume.holds(&[y - x])),
    })
}

fn rises(patch: &Patch, plane: HalfSpace, flat: f64) -> bool {
    patch.corners().iter().any(|&x| plane.height(x) > flat)
}

/// Whether the bodies stand farther from the first patch. Ties are broken by place, so that neither
/// the numbers of the patches nor rounding decide.
fn clearer(a: Side, b: Side, bodies: &[&Body]) -> bool {
    let [here, there] = [clearance(a, bodies), clearance(b, bodies)];
    if (here - there).abs() > TIE_TOLERANCE * here.abs().max(there.abs()).max(1.0) {
        return here > there;
    }
    let way = a.centroid - b.centroid;
    let decides = |coordinate: &f64| coordinate.abs() > TIE_TOLERANCE * way.length();
    way.to_array().into_iter().find(decides).is_none_or(|coordinate| coordinate < 0.0)
}

/// Smallest height of the bodies over a patch, in its diameters.
fn clearance(side: Side, bodies: &[&Body]) -> f64 {
    let heights = bodies.iter().flat_map(|body| body.corners()).map(|&x| side.plane.height(x));
    heights.fold(f64::INFINITY, f64::min) / side.diameter
}

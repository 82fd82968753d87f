//! Where on a source patch the hidden part of a target is not a smooth function: critical lines.
//!
//! Seen from a point x, the shadow of a convex body on a polygon changes its kind where a corner of the body lines up with an edge of the target, an edge of the body
//! with a corner of the target, or a face of the body turns edge-on. Each of these happens on a plane, which meets the source in a line:
//! vertex–edge, edge–vertex and face events. C. Campbell & D. Fussell, "An analytic approach to illumination with area light sources" (1991);
//! G. Drettakis & E. Fiume, SIGGRAPH 1994, doi:10.1145/192161.192207. The same happens between two bodies. Events
//! of three edges are curves and not listed.

use super::spans::Spans;
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{ODD, Screen};

/// Squared sine below which a corner and an edge span no plane.
const SLIM: f64 = 1e-24;

/// Part of an edge by which a point must be inside its ends to meet it: in scenes with right angles lines often go exactly through corners.
const MARGIN: f64 = 1e-7;
/// Lines that are listed at most: among many, most do not show, and a part that any of them cuts counts as not smooth.
const LINES: usize = 40;

/// Part of a chord that is left out at its ends, where lines of sight are often exactly parallel to the edge.
const INSIDE: f64 = 1e-6;

/// A plane n·x = c with a unit normal.
pub(crate) type Plane = (Vec3, f64);

/// Critical planes, and buffers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Critical {
    found: Vec<Plane>,
    keyed: Vec<(f64, Plane)>,
    spans: Spans,
    /// Corners that can show in the outlines, body after body, and where those of each body end.
    corners: Vec<Vec3>,
    ends: Vec<usize>,
    sides: Vec<[Vec3; 2]>,
}

impl Critical {
    /// Finds the planes of the events of `screens` before `target` that cut the `source` polygon. Those of single bodies come first, long ones before short
    /// ones, and at most [`LINES`] are kept. Lengths below `flat` (m) count as 0.
    pub(crate) fn planes(
        &mut self,
        source: &[Vec3],
        target: &[Vec3],
        screens: &[Screen],
        flat: f64,
    ) -> &[Plane] {
        let Self { found, keyed, spans, corners, ends, sides } = self;
        found.clear();
        let mut search = Search { source, target, flat, found, keyed, spans };
        search.turning(screens);
        list_corners(screens, corners, ends);
        sides.clear();
        sides.extend(sides_of(target));
        let whole = Outline { corners: target, edges: sides };
        search.all(&Outlines { screens, corners, ends }, &whole);
        &self.found
    }
}

/// Lists the ends of the edges that may cut the target.
fn list_corners(screens: &[Screen], corners: &mut Vec<Vec3>, ends: &mut Vec<usize>) {
    corners.clear();
    ends.clear();
    for screen in screens {
        let start = corners.len();
        for &end in screen.edges().iter().flatten() {
            if !corners[start..].contains(&end) {
                corners.push(end);
            }
        }
        ends.push(corners.len());
    }
}

/// What can show in the outline of a body, or of the target.
#[derive(Clone, Copy)]
struct Outline<'a> {
    corners: &'a [Vec3],
    edges: &'a [[Vec3; 2]],
}

/// The outlines of all bodies.
struct Outlines<'a> {
    screens: &'a [Screen<'a>],
    corners: &'a [Vec3],
    ends: &'a [usize],
}

impl<'a> Outlines<'a> {
    fn get(&self, k: usize) -> Outline<'a> {
        let start = if k == 0 { 0 } else { self.ends[k - 1] };
        Outline { corners: &self.corners[start..self.ends[k]], edges: self.screens[k].edges() }
    }
}

fn pairs(first: usize, second: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..first).flat_map(move |k| (0..second).map(move |l| (k, l)))
}

fn sides_of(corners: &[Vec3]) -> impl Iterator<Item = [Vec3; 2]> + '_ {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}

struct Search<'a> {
    source: &'a [Vec3],
    target: &'a [Vec3],
    flat: f64,
    found: &'a mut Vec<Plane>,
    keyed: &'a mut Vec<(f64, Plane)>,
    spans: &'a mut Spans,
}

impl Search<'_> {
    /// Faces that turn edge-on are events themselves.
    fn turning(&mut self, screens: &[Screen]) {
        for face in screens.iter().flat_map(Screen::turning) {
            self.add((face.normal, face.offset));
        }
    }

    fn all(&mut self, outlines: &Outlines, target: &Outline) {
        let count = outlines.ends.len();
        for k in 0..count {
            self.events(&outlines.get(k), target, false);
        }
        self.sort(0);
        let single = self.found.len();
        if single >= LINES {
            return self.found.truncate(LINES);
        }
        for (k, l) in pairs(count, count).filter(|(k, l)| k != l) {
            self.events(&outlines.get(k), &outlines.get(l), true);
        }
        self.sort(single);
        self.found.truncate(LINES);
    }

    /// Events where the outline `near` lines up with `far` behind it. Those of two bodies matter only in front of the target.
    fn events(&mut self, near: &Outline, far: &Outline, before: bool) {
        let within = |t: f64| MARGIN < t && t < 1.0 - MARGIN;
        // Most planes miss the source.
        self.spans.ask(near.edges, far.corners, self.source);
        for (k, l) in pairs(near.edges.len(), far.corners.len()) {
            if self.spans.passes(k, l) {
                let (ends, w) = (near.edges[k], far.corners[l]);
                self.event(w, ends, before, |c, n| meeting(c, w - c, ends, n), within);
            }
        }
        self.spans.ask(far.edges, near.corners, self.source);
        for (k, l) in pairs(near.corners.len(), far.edges.len()) {
            if self.spans.passes(l, k) {
                let (v, ends) = (near.corners[k], far.edges[l]);
                self.event(v, ends, before, |c, n| meeting(c, v - c, ends, n), |t| t > 1.0 + MARGIN);
            }
        }
    }

    fn event(
        &mut self,
        corner: Vec3,
        [a, b]: [Vec3; 2],
        before: bool,
        meeting: impl Fn(Vec3, Vec3) -> (f64, f64),
        order: impl Fn(f64) -> bool,
    ) {
        let Some(plane) = spanned(corner, a, b, self.flat) else { return };
        let height = |x: Vec3| plane.0.dot(x) - plane.1;
        if self.lit(height) != Lit::Partly {
            return;
        }
        let Some([first, last]) = chord(self.source, plane) else { return };
        let inner = [first.lerp(last, INSIDE), last.lerp(first, INSIDE)];
        let shows = !before || lit(self.target, self.flat, height) == Lit::Partly;
        if shows && lines_up(inner.map(|c| meeting(c, plane.0)), order) {
            self.add(plane);
        }
    }

    /// Each line once: parallel edges give the same plane many times.
    fn add(&mut self, plane: Plane) {
        let same = |other: &Plane| {
            self.source.iter().all(|x| {
                let [h, g] = [plane, *other].map(|(n, c)| n.dot(*x) - c);
                let turned = if plane.0.dot(other.0) < 0.0 { -g } else { g };
                (h - turned).abs() <= self.flat
            })
        };
        if !self.found.iter().any(same) {
            self.found.push(plane);
        }
    }

    /// Sorts the lines from `start` on, long ones first: the order of bodies and of their corners has no say in which are used.
    fn sort(&mut self, start: usize) {
        let source = self.source;
        let key = |plane: &Plane| {
            let [a, b] = chord(source, *plane).unwrap_or_default();
            a.distance(b) + 1e-3 * (0.5 * (a + b) - source[0]).dot(ODD)
        };
        self.keyed.clear();
        self.keyed.extend(self.found[start..].iter().map(|plane| (key(plane), *plane)));
        self.keyed.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        self.found.truncate(start);
        self.found.extend(self.keyed.iter().map(|(_, plane)| *plane));
    }

    fn lit(&self, height: impl Fn(Vec3) -> f64) -> Lit {
        lit(self.source, self.flat, height)
    }
}

/// The two ends of the line in which a plane cuts a convex polygon.
fn chord(polygon: &[Vec3], (n, c): Plane) -> Option<[Vec3; 2]> {
    let height = |x: Vec3| n.dot(x) - c;
    let mut ends = [Vec3::ZERO; 2];
    let mut count = 0;
    for (&p, &q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (from, to) = (height(p), height(q));
        if (from >= 0.0) != (to >= 0.0) && count < 2 {
            ends[count] = p + (q - p) * (from / (from - to));
            count += 1;
        }
    }
    (count == 2).then_some(ends)
}

/// Whether a plane has corners in front of it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Lit {
    Wholly,
    Partly,
    Never,
}

fn lit(corners: &[Vec3], flat: f64, height: impl Fn(Vec3) -> f64) -> Lit {
    let (low, high) = range(corners, height);
    match (high > flat, low < -flat) {
        (true, true) => Lit::Partly,
        (true, false) => Lit::Wholly,
        _ => Lit::Never,
    }
}

/// The least and the largest of the heights.
fn range(corners: &[Vec3], height: impl Fn(Vec3) -> f64) -> (f64, f64) {
    corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
        let height = height(x);
        (low.min(height), high.max(height))
    })
}

fn spanned(v: Vec3, a: Vec3, b: Vec3, flat: f64) -> Option<Plane> {
    let (edge, arm) = (b - a, v - a);
    let normal = edge.cross(arm);
    let enough =
        normal.length_squared() > edge.length_squared() * (SLIM * arm.length_squared()).max(flat * flat);
    let n = enough.then(|| normal.normalize())?;
    Some((n, n.dot(a)))
}

/// Where the line c + t d meets the line of an edge, all in the plane with normal n: t, and the place along the edge from 0 to 1.
fn meeting(c: Vec3, d: Vec3, [a, b]: [Vec3; 2], n: Vec3) -> (f64, f64) {
    let e = b - a;
    let across = d.cross(e).dot(n);
    ((a - c).cross(e).dot(n) / across, (a - c).cross(d).dot(n) / across)
}

/// Whether the edge may be met from a point of the chord: both ends meet its line in the right order and on different sides of it, or one end does
/// not meet it so.
fn lines_up([first, last]: [(f64, f64); 2], order: impl Fn(f64) -> bool) -> bool {
    match (order(first.0), order(last.0)) {
        (true, true) => first.1.min(last.1) < 1.0 - MARGIN && first.1.max(last.1) > MARGIN,
        (false, false) => false,
        _ => true,
    }
}

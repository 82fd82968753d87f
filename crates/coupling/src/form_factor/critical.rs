//! Where on a source patch the hidden part of a target is not a smooth function: critical lines.
//!
//! Seen from a point x, the shadow of a convex body on a polygon changes its topology where a
//! corner of the body lines up with an edge of the target, an edge of the body with a corner of the
//! target, or a face of the body turns edge-on. Each of these happens on a plane, which meets the
//! source in a line: vertex–edge, edge–vertex and face events. C. Campbell & D. Fussell, "An
//! analytic approach to illumination with area light sources" (1991); G. Drettakis & E. Fiume,
//! SIGGRAPH 1994, doi:10.1145/192161.192207. The same happens between two bodies. Events of three
//! edges are curves and not listed.

use super::ev_batch::{Aligned, EdgeVertexBatch, Region};
use super::ev_events::{CriticalPlane, EdgeVertexEvent, EdgeVertexEvents, chord};
use fredholm_mesh::Vec3;
use fredholm_visibility::body::{GENERIC_DIRECTION, Screen};

/// Lines that are listed at most: among many, most are not active, and a part that any of them cuts
/// counts as not smooth.
const MOST_LINES: usize = 400;

/// A plane n·x = c with a unit normal.
pub(crate) type Plane = (Vec3, f64);

/// Corners of a source of which heights are kept: a patch that is cut by a plane has at most five.
const MOST_CORNERS: usize = 8;

/// A plane that cuts the source, and the heights of the corners of the source over it.
#[derive(Clone, Copy, Debug)]
struct Line {
    event: CriticalPlane,
    heights: [f64; MOST_CORNERS],
}

/// Critical planes, and buffers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Critical {
    events: Vec<CriticalPlane>,
    ev_events: EdgeVertexEvents,
    found: Vec<Line>,
    keyed: Vec<(f64, Line)>,
    batch: EdgeVertexBatch,
    /// Corners that can show in the outlines, body after body, and where those of each body end.
    corners: Vec<Vec3>,
    ends: Vec<usize>,
    sides: Vec<[Vec3; 2]>,
}

impl Critical {
    /// Finds the events of `screens` before `target` on planes that cut the `source` polygon. Those
    /// of single bodies come first, long ones before short ones, and at most [`MOST_LINES`] are
    /// kept. Lengths below `flat` (m) count as 0.
    pub(crate) fn events(
        &mut self,
        source: &[Vec3],
        target: &[Vec3],
        screens: &[Screen],
        flat: f64,
    ) -> (&[CriticalPlane], &EdgeVertexEvents) {
        let Self { events, ev_events, found, keyed, batch, corners, ends, sides } = self;
        found.clear();
        ev_events.clear();
        let mut search = Search { source, target, flat, ev_events, found, keyed, batch };
        search.turning(screens);
        list_corners(screens, corners, ends);
        sides.clear();
        sides.extend(sides_of(target));
        let whole = Outline { corners: target, edges: sides, screen: None };
        search.all(&Outlines { screens, corners, ends }, &whole);
        events.clear();
        events.extend(found.iter().map(|line| line.event));
        (events, ev_events)
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
    /// The body.
    screen: Option<&'a Screen<'a>>,
}

impl Outline<'_> {
    /// Whether an edge shows from all points of the source.
    fn is_sure(&self, edge: usize) -> bool {
        self.screen.is_none_or(|screen| screen.is_fixed(edge))
    }

    /// Whether a corner does.
    fn is_sure_corner(&self, corner: Vec3) -> bool {
        self.edges.iter().enumerate().any(|(k, ends)| ends.contains(&corner) && self.is_sure(k))
    }
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
        let screen = &self.screens[k];
        Outline { corners: &self.corners[start..self.ends[k]], edges: screen.edges(), screen: Some(screen) }
    }
}

fn sides_of(corners: &[Vec3]) -> impl Iterator<Item = [Vec3; 2]> + '_ {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(&a, &b)| [a, b])
}

struct Search<'a> {
    source: &'a [Vec3],
    target: &'a [Vec3],
    flat: f64,
    ev_events: &'a mut EdgeVertexEvents,
    found: &'a mut Vec<Line>,
    keyed: &'a mut Vec<(f64, Line)>,
    batch: &'a mut EdgeVertexBatch,
}

impl Search<'_> {
    /// Faces that turn edge-on are events themselves.
    fn turning(&mut self, screens: &[Screen]) {
        for (face, cuts) in screens.iter().flat_map(Screen::turning) {
            let plane = (face.normal, face.offset);
            let line =
                self.line(if cuts { CriticalPlane::always(plane) } else { CriticalPlane::perhaps(plane) });
            if self.known(&line).is_none() {
                self.found.push(line);
            }
        }
    }

    fn all(&mut self, outlines: &Outlines, target: &Outline) {
        let count = outlines.ends.len();
        for k in 0..count {
            self.events(&outlines.get(k), target, false);
        }
        self.sort(0);
        let single = self.found.len();
        if single >= MOST_LINES {
            return self.found.truncate(MOST_LINES);
        }
        for k in 0..count {
            for l in (0..count).filter(|&l| l != k) {
                self.events(&outlines.get(k), &outlines.get(l), true);
            }
        }
        self.sort(single);
        self.found.truncate(MOST_LINES);
    }

    /// Events where the outline `near` lines up with `far` behind it. Those of two bodies matter
    /// only in front of the target.
    fn events(&mut self, near: &Outline, far: &Outline, before: bool) {
        self.batch.clear();
        for &edge in near.edges {
            for &corner in far.corners {
                self.batch.push(&EdgeVertexEvent { corner, edge, behind: false });
            }
        }
        let edges = near.edges.len() * far.corners.len();
        for &corner in near.corners {
            for &edge in far.edges {
                self.batch.push(&EdgeVertexEvent { corner, edge, behind: true });
            }
        }
        let target = before.then_some(self.target);
        self.batch.ask(Region { source: self.source, target, flat: self.flat });
        for k in 0..self.batch.found().len() {
            let Aligned { pair, plane } = self.batch.found()[k];
            let sure = !before
                && match pair.checked_sub(edges) {
                    None => near.is_sure(pair / far.corners.len()),
                    Some(pair) => near.is_sure_corner(near.corners[pair / far.edges.len()]),
                };
            self.event(self.batch.get(pair), plane, sure);
        }
    }

    fn event(&mut self, ev_event: EdgeVertexEvent, plane: Plane, sure: bool) {
        let mut line = self.line(CriticalPlane::new(plane));
        let known = self.known(&line);
        let event = known.map_or(&mut line.event, |k| &mut self.found[k].event);
        self.ev_events.add(event, ev_event, sure);
        if known.is_none() {
            self.found.push(line);
        }
    }

    fn line(&self, event: CriticalPlane) -> Line {
        let mut heights = [0.0; MOST_CORNERS];
        for (height, x) in heights.iter_mut().zip(self.source) {
            *height = event.plane.0.dot(*x) - event.plane.1;
        }
        Line { event, heights }
    }

    /// The place of the same line among those found: parallel edges give the same plane many times.
    fn known(&self, line: &Line) -> Option<usize> {
        let corners = self.source.len().min(MOST_CORNERS);
        let near = |a: &f64, b: f64| (a - b).abs() <= self.flat;
        let same = |other: &Line| {
            let turned = if line.event.plane.0.dot(other.event.plane.0) < 0.0 { -1.0 } else { 1.0 };
            line.heights[..corners].iter().zip(&other.heights).all(|(h, g)| near(h, turned * g))
        };
        self.found.iter().position(same)
    }

    /// Sorts the lines from `start` on, long ones first: the order of bodies and of their corners
    /// has no say in which are used.
    fn sort(&mut self, start: usize) {
        if self.found.len() < start + 2 {
            return;
        }
        self.keyed.clear();
        for line in &self.found[start..] {
            let [a, b] = self.chord(line).unwrap_or_default();
            let key = a.distance(b) + 1e-3 * (0.5 * (a + b) - self.source[0]).dot(GENERIC_DIRECTION);
            self.keyed.push((key, *line));
        }
        self.keyed.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        self.found.truncate(start);
        self.found.extend(self.keyed.iter().map(|(_, line)| *line));
    }

    /// The two ends of a line on the source.
    fn chord(&self, line: &Line) -> Option<[Vec3; 2]> {
        let corners = &self.source[..self.source.len().min(MOST_CORNERS)];
        chord(corners, |k| line.heights[k])
    }
}

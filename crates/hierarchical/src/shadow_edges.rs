//! Lines on a polygon along which shadows begin and end: the irradiance from a polygonal lamp, or
//! its derivative, jumps or bends there.
//!
//! A corner of the lamp and an edge of a body, or an edge of the lamp and a corner of a body, span
//! a plane; where the part of it behind the body meets the polygon, the lamp begins or ceases to be
//! seen in part. An edge that lies on the polygon is the line where body and polygon meet. P.
//! Heckbert, *Discontinuity meshing for radiosity*, Eurographics Workshop on Rendering 1992; D.
//! Lischinski, F. Tampieri, D. P. Greenberg, IEEE Comput. Graph. Appl. 12(6) 1992,
//! doi:10.1109/38.163622. Lines that three edges make are left out. Metres.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::body::{Bodies, Body, Edge, Face};

/// Height of what casts a shadow, over that of the corner of the lamp, at most.
const MOST_CASTER_HEIGHT: f64 = 1.0 - 1e-6;
/// Difference of heights, over that of the corner of the lamp, below which an edge is level.
const LEVEL_HEIGHT: f64 = 1e-14;

/// The lines that lamps and bodies make on the plane of `onto`; they may lie outside of it, or
/// where another body hides the lamp.
#[must_use]
pub fn shadow_edges(lamps: &[Patch], bodies: &Bodies, onto: &Patch) -> Vec<[Vec3; 2]> {
    let (plane, flat) = (Face::through(onto.corner(0), onto.normal()), bodies.tolerance());
    let mut lines = Vec::new();
    for body in bodies.as_slice() {
        let on = |x: Vec3| plane.height(x).abs() <= flat;
        lines.extend(
            body.edges().iter().map(|edge| body.ends(edge)).filter(|ends| ends.iter().all(|&x| on(x))),
        );
        for lamp in lamps {
            for k in 0..lamp.sides() {
                let ends = [lamp.corner(k), lamp.corner(k + 1)];
                lines.extend(
                    body.edges().iter().filter_map(|edge| of_corner(&plane, ends[0], body, edge, flat)),
                );
                lines.extend(body.corners().iter().filter_map(|&c| of_edge(&plane, ends, c)));
            }
        }
    }
    lines
}

/// The shadow of an edge from a corner of a lamp, where it is on the outline.
fn of_corner(plane: &Face, lamp: Vec3, body: &Body, edge: &Edge, flat: f64) -> Option<[Vec3; 2]> {
    let looks = edge.faces.map(|face| body.faces()[face as usize].height(lamp) > flat);
    let [a, b] = between(plane, body.ends(edge), MOST_CASTER_HEIGHT * plane.height(lamp))?;
    (looks[0] != looks[1]).then_some(())?;
    Some([project(plane, lamp, a)?, project(plane, lamp, b)?])
}

/// The shadow of a corner from an edge of a lamp.
fn of_edge(plane: &Face, lamp: [Vec3; 2], corner: Vec3) -> Option<[Vec3; 2]> {
    let [from, to] = lamp.map(|end| project(plane, end, corner));
    Some([from?, to?])
}

/// Where the line from a corner of a lamp through a point below it meets the plane; none for a
/// point that is not between, or a lamp in the plane.
fn project(plane: &Face, lamp: Vec3, x: Vec3) -> Option<Vec3> {
    let (high, low) = (plane.height(lamp), plane.height(x));
    (high > 0.0 && low >= 0.0 && low <= MOST_CASTER_HEIGHT * high).then(|| lamp.lerp(x, high / (high - low)))
}

/// The part of a segment from height 0 up to some height.
fn between(plane: &Face, [a, b]: [Vec3; 2], most: f64) -> Option<[Vec3; 2]> {
    let (from, to) = (plane.height(a), plane.height(b));
    let at = |height: f64| ((height - from) / (to - from)).clamp(0.0, 1.0);
    if most <= 0.0 || from.max(to) <= 0.0 || from.min(to) >= most {
        return None;
    }
    // Rounding must not put the ends beyond the heights that were asked for.
    let inside = |x: Vec3| x + plane.normal * (plane.height(x).clamp(0.0, most) - plane.height(x));
    if (to - from).abs() <= LEVEL_HEIGHT * most {
        return Some([a, b].map(inside));
    }
    let (low, high) = (at(0.0).min(at(most)), at(0.0).max(at(most)));
    Some([low, high].map(|t| inside(a.lerp(b, t))))
}

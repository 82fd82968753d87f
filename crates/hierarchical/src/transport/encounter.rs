//! What two nodes exchange of which at least one is bent, or a bent one with itself: apart, near,
//! touching, or hardly in sight of each other. Exchanges in m².

use super::bent::{End, Meeting, exact, meet};
use super::side::Side;
use super::sight::Viewer;
use super::spread::{CLOSE_DEVIATION, CLOSE_DISTANCE};
use crate::tree::{Node, Tree};

/// What two linkable nodes exchange.
pub(crate) fn encounter(tree: &Tree, indices: [u32; 2], viewer: &mut Viewer) -> Meeting {
    let [p, q] = indices.map(|index| &tree.nodes()[index as usize]);
    let ends = indices.map(|index| End::of(tree, index));
    let ends = [&ends[0], &ends[1]];
    let met = if touching(p, q) {
        let same = indices[0] == indices[1];
        touch(viewer, ends, bound(p, q, same), same)
    } else {
        meet(viewer, ends, near(p, q))
    };
    if met.open > 0.0 { met } else { grazing(p, q) }
}

/// Whether the ball round a bent node reaches the other one.
fn touching(p: &Node, q: &Node) -> bool {
    match (p.patch(), q.patch()) {
        (Some(patch), _) => q.cone().distance(patch) <= q.cone().radius,
        (_, Some(patch)) => p.cone().distance(patch) <= p.cone().radius,
        _ => p.cone().centre.distance(q.cone().centre) <= p.cone().radius + q.cone().radius,
    }
}

/// Whether points of the larger node are too coarse for the smaller one.
fn near(p: &Node, q: &Node) -> bool {
    p.cone().centre.distance(q.cone().centre) < CLOSE_DISTANCE * (p.cone().radius + q.cone().radius)
}

/// Share of what two nodes would exchange face to face that they may exchange where no part of one
/// is seen from the parts of the other, but some members may be.
const GRAZING_SHARE: f64 = 0.02;

/// Nodes that hardly see each other.
fn grazing(p: &Node, q: &Node) -> Meeting {
    let distance = p.cone().centre.distance(q.cone().centre);
    let open = GRAZING_SHARE * p.area() * q.area() / (std::f64::consts::PI * distance * distance);
    let side = Side::default().at_least(CLOSE_DEVIATION);
    Meeting { open: open.min(p.area()).min(q.area()), share: 0.0, sides: [side; 2], doubt: 1.0 }
}

/// The exchange of two sides that touch or are one, which no sampling resolves: at most `bound`, (A + A' − |a + a'|)/2. For every direction, what leaves one member along it and meets another is at most the smaller
/// one of the projected areas that face forward and backward; their difference is a·ω, their sum Σ A |n·ω|, and the integral of the smaller over all directions is that bound.
/// A link of a node with itself counts twice.
fn touch(viewer: &mut Viewer, ends: [&End; 2], bound: f64, same: bool) -> Meeting {
    let exact = exact(ends);
    let open = ends[exact].open(ends[1 - exact], &mut viewer.front);
    let half = if same { 0.5 } else { 1.0 };
    let guess = half * ends[exact].side(&open, &open).mean * ends[exact].area();
    let side = Side::default().at_least(CLOSE_DEVIATION);
    let share = if bound > 0.0 { (guess / bound).min(1.0) } else { 0.0 };
    Meeting { open: bound, share, sides: [side; 2], doubt: 1.0 }
}

/// Most that two nodes can exchange, or half of what one does with itself, m².
fn bound(a: &Node, b: &Node, same: bool) -> f64 {
    let areas = a.area() + b.area();
    let most = 0.5 * (areas - (a.area_vector() + b.area_vector()).length()).max(0.0);
    if same { 0.5 * most } else { most.min(a.area()).min(b.area()) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

    use super::*;
    use crate::transport::Sight;
    use crate::transport::side::Points;
    use fredholm_coupling::form_factor::contour_integral;
    use fredholm_mesh::{MeshBuilder, Patch, Vec3};
    use fredholm_visibility::Occluders;
    use fredholm_visibility::body::Bodies;

    /// A mesh of a hill of some height over the unit square, 0 at its border; a basin where the
    /// height is negative.
    fn hill(height: f64) -> Tree {
        let n = 12;
        let at = |i: usize, j: usize| {
            let (x, y) = (i as f64 / n as f64, j as f64 / n as f64);
            Vec3::new(x, y, 16.0 * height * x * (1.0 - x) * y * (1.0 - y))
        };
        let mut builder = MeshBuilder::default();
        builder.surface("hill", 0);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for corners in [[a, b, c], [a, c, d]] {
                builder.face(&[Patch::triangle(corners).unwrap()]).unwrap();
            }
        }
        Tree::new(&builder.build(), 1e-9).unwrap()
    }

    fn plate(z: f64) -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(x, y, z);
        Patch::quad([corner(-0.5, 0.), corner(-0.5, 1.), corner(1., 1.), corner(1., 0.)]).unwrap().unwrap()
    }

    fn with_viewer<T>(f: impl FnOnce(&mut Viewer) -> T) -> T {
        let (occluders, bodies) = (Occluders::new(&[]).unwrap(), Bodies::default());
        f(&mut Viewer::new(Sight { occluders: &occluders, bodies: &bodies, many: false }))
    }

    #[test]
    fn a_hill_receives_what_its_base_would() {
        // What the parts do not resolve of curvature times gradient falls with the distance.
        for (distance, tolerance) in [(3.0, 1.5e-2), (9.0, 5e-3)] {
            let (tree, plate, base) = (hill(0.15), plate(distance), plate_under());
            let exact = contour_integral(base.corners(), plate.corners(), 1e-10).value;
            let ends = [End::of(&tree, 0), End::Flat(&plate, Points::of(&plate))];
            for pair in [[&ends[0], &ends[1]], [&ends[1], &ends[0]]] {
                let found = with_viewer(|viewer| meet(viewer, pair, false));
                assert!((found.open / exact - 1.0).abs() < tolerance, "{} {exact}", found.open);
                assert!(found.share >= 1.0 && found.sides.iter().all(|side| side.rest < 0.1), "{found:?}");
            }
        }
    }

    /// The unit square, looking up.
    fn plate_under() -> Patch {
        let corner = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        Patch::quad([corner(0., 0.), corner(1., 0.), corner(1., 1.), corner(0., 1.)]).unwrap().unwrap()
    }

    #[test]
    fn a_basin_sees_itself_as_its_opening_says_and_a_hill_does_not() {
        // Of a basin that sees nothing else, all that does not leave through the opening reaches
        // the basin: A − 1.
        let basin = hill(-0.2);
        let node = &basin.nodes()[0];
        let most = bound(node, node, true);
        assert!((2.0 * most - (node.area() - 1.0)).abs() < 1e-12 && most > 0.01, "{most}");
        let own = |tree: &Tree, most: f64| {
            let ends = [End::of(tree, 0), End::of(tree, 0)];
            with_viewer(|viewer| touch(viewer, [&ends[0], &ends[1]], most, true)).share
        };
        assert!((own(&basin, most) - 1.0).abs() < 0.4, "{}", own(&basin, most));
        assert!(own(&hill(0.2), most) < 0.1, "{}", own(&hill(0.2), most));
    }

    #[test]
    fn no_two_squares_exchange_more_than_the_bound() {
        // Unit squares at right angles with a common edge: 0.20004, Howell's catalogue C-14.
        let wall = |corners: [[f64; 3]; 4]| Patch::quad(corners.map(Vec3::from)).unwrap().unwrap();
        let mut builder = MeshBuilder::default();
        builder.surface("squares", 0);
        for corners in [
            [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
            [[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]],
        ] {
            builder.face(&[wall(corners)]).unwrap();
        }
        let tree = Tree::new(&builder.build(), 1e-9).unwrap();
        let [a, b] = [0, 1].map(|root: usize| &tree.nodes()[tree.roots()[root] as usize]);
        let most = bound(a, b, false);
        assert!(most > 0.200_043 && (most - (1.0 - 0.5f64.sqrt())).abs() < 1e-12, "{most}");
    }
}

//! Bodies put together from patches, and their shadows compared with segments.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;
use fredholm_visibility::body::{Bodies, Body, Face, Screen, Shadow, ShadowVolume};

use crate::scenes::{Random, cuboid, quad, triangulated};

fn bodies(occluders: &[Patch], elements: &[Patch], points: &[Vec3]) -> Bodies {
    let elements: Vec<&Patch> = elements.iter().collect();
    Bodies::new(&Occluders::new(occluders).unwrap(), &elements, points)
}

/// Every patch as n × n ones.
fn cut(patches: &[Patch], n: usize) -> Vec<Patch> {
    let at = |patch: &Patch, i: usize, j: usize| patch.point(i as f64 / n as f64, j as f64 / n as f64);
    let cell = |patch: &Patch, i, j| {
        quad([at(patch, i, j), at(patch, i + 1, j), at(patch, i + 1, j + 1), at(patch, i, j + 1)])
    };
    let cells = |patch: &Patch| (0..n * n).map(|k| cell(patch, k / n, k % n)).collect::<Vec<_>>();
    patches.iter().flat_map(cells).collect()
}

fn room() -> Vec<Patch> {
    cuboid(Vec3::ZERO, Vec3::splat(2.0), 0.0, true)
}

fn counts(body: &Body) -> [usize; 3] {
    [body.faces().len(), body.edges().len(), body.corners().len()]
}

#[test]
fn the_walls_of_a_room_block_nothing_and_a_box_in_it_is_one_solid() {
    let block = cuboid(Vec3::ZERO, Vec3::splat(0.5), 0.0, false);
    for parts in [block.clone(), cut(&block, 4), triangulated(&block)] {
        let all: Vec<Patch> = room().into_iter().chain(parts).collect();
        let found = bodies(&all, &all, &[]);
        assert_eq!(found.as_slice().len(), 1);
        assert!(found.as_slice()[0].is_solid());
        assert_eq!(counts(&found.as_slice()[0]), [6, 12, 8]);
    }
}

/// Corners on a side that is at right angles to the axis by which they are sorted differ by
/// rounding alone.
#[test]
fn a_turned_box_of_small_patches_is_one_solid_in_a_turned_room_and_before_large_walls() {
    for k in 1..12 {
        let turn = 0.547 * f64::from(k);
        let block = cuboid(Vec3::new(0.2, -0.1, 0.3), Vec3::new(0.9, 0.7, 0.8), turn, false);
        let upright = room();
        let along = cuboid(Vec3::ZERO, Vec3::splat(2.0), turn, true);
        for walls in [upright.clone(), cut(&upright, 2), cut(&along, 3)] {
            let all: Vec<Patch> = walls.into_iter().chain(cut(&block, 4)).collect();
            let found = bodies(&all, &all, &[]);
            assert_eq!(found.as_slice().len(), 1, "turned by {turn}");
            assert_eq!(counts(&found.as_slice()[0]), [6, 12, 8]);
        }
    }
}

/// A patch that no face of a box has wholly before it, but of which nothing is in the box, leaves
/// it a solid; one that reaches into it does not.
#[test]
fn a_patch_beside_an_edge_of_a_box_leaves_it_a_solid() {
    let block = cuboid(Vec3::ZERO, Vec3::splat(0.5), 0.0, false);
    let beside = |near: f64| {
        let corner = |u: f64, z: f64| Vec3::new(near + u, near - u, z);
        quad([corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)])
    };
    let count = |near: f64| {
        let all: Vec<Patch> = block.iter().copied().chain([beside(near)]).collect();
        bodies(&all, &all, &[]).as_slice().iter().filter(|body| body.is_solid()).count()
    };
    assert_eq!([0.51, 0.500_001].map(count), [1, 1]);
    assert_eq!([0.49, 0.0].map(count), [0, 0]);
}

#[test]
fn a_box_without_its_bottom_is_a_solid_with_a_lid_unless_one_looks_out_of_it() {
    let block = cuboid(Vec3::new(0.0, 0.0, -1.5), Vec3::splat(0.5), 0.0, false);
    let open: Vec<Patch> = block.iter().filter(|p| p.normal().z > -0.5).copied().collect();
    assert_eq!(open.len(), 5);
    let all: Vec<Patch> = room().into_iter().chain(open.clone()).collect();
    let whole = bodies(&all, &all, &[]);
    assert_eq!((whole.as_slice().len(), counts(&whole.as_slice()[0])), (1, [6, 12, 8]));
    // Lit on the inside too, its faces see each other and look out of it.
    let two_sided: Vec<Patch> = all.iter().copied().chain(open.iter().map(Patch::flipped)).collect();
    assert_eq!(bodies(&all, &two_sided, &[]).as_slice().len(), 5);
    let inside = [Vec3::new(0.0, 0.0, -1.5)];
    assert_eq!(bodies(&all, &all, &inside).as_slice().len(), 5);
}

#[test]
fn a_leg_between_floor_and_table_is_a_solid_and_an_open_shaft_is_four_walls() {
    let table = cuboid(Vec3::new(0.0, 0.0, -0.9), Vec3::new(1.0, 1.0, 0.1), 0.0, false);
    let leg = cuboid(Vec3::new(0.3, 0.2, -1.5), Vec3::new(0.1, 0.1, 0.5), 0.0, false);
    let sides: Vec<Patch> = leg.into_iter().filter(|p| p.normal().z.abs() < 0.5).collect();
    let below: Vec<Patch> = room().into_iter().chain(sides.clone()).chain(table).collect();
    let found = bodies(&below, &below, &[]);
    assert!(found.as_slice().len() == 2 && found.as_slice().iter().all(Body::is_solid));
    assert!(found.as_slice().iter().all(|body| counts(body) == [6, 12, 8]));
    let open: Vec<Patch> = room().into_iter().chain(sides).collect();
    assert_eq!(bodies(&open, &open, &[]).as_slice().len(), 4, "its floor is seen from above");
}

#[test]
fn an_angled_floor_becomes_few_convex_polygons() {
    let cell = |i: usize, j: usize| {
        let corner = Vec3::new(i as f64, j as f64, 0.0);
        quad([corner, corner + Vec3::X, corner + Vec3::X + Vec3::Y, corner + Vec3::Y])
    };
    let cells = (0..16).map(|k| (k / 4, k % 4)).filter(|(i, j)| *i < 2 || *j < 2);
    let floor: Vec<Patch> = cells.map(|(i, j)| cell(i, j)).collect();
    let both_sides = [Vec3::new(1.0, 1.0, 1.0), Vec3::new(1.0, 1.0, -1.0)];
    let found = bodies(&floor, &floor, &both_sides);
    assert_eq!(found.as_slice().len(), 2, "a rectangle of 4 × 2 cells and a square of 2 × 2");
    let area = |body: &Body| {
        let corners = body.corners();
        let fan = (2..corners.len()).map(|k| (corners[k - 1] - corners[0]).cross(corners[k] - corners[0]));
        0.5 * fan.sum::<Vec3>().length()
    };
    assert!((found.as_slice().iter().map(area).sum::<f64>() - 12.0).abs() < 1e-12);
}

fn shaded(body: &Body, x: Vec3, y: Vec3) -> bool {
    let mut volume = ShadowVolume::default();
    body.shadow(x, 1e-9, &mut volume) == Shadow::Volume && volume.holds(&[y - x])
}

#[test]
fn a_shadow_holds_what_segments_do_not_reach() {
    let mut random = Random(3);
    let (mut hidden, mut seen) = (0, 0);
    for k in 0..60 {
        let half = Vec3::splat(0.3) + random.cube().abs() * 0.5;
        let block = cuboid(random.cube() * 0.3, half, f64::from(k), false);
        let parts = if k % 2 == 0 { block.clone() } else { block[..1].to_vec() };
        let occluders = Occluders::new(&parts).unwrap();
        let points: Vec<Vec3> = (0..40).map(|_| random.cube() * 2.0).collect();
        let all = Bodies::new(&occluders, &[], &points);
        for pair in points.windows(2) {
            let blocked = !occluders.unoccluded(pair[0], pair[1]);
            let inside = |x: Vec3| block.iter().all(|p| (x - p.corner(0)).dot(p.normal()) < 0.0);
            if all.as_slice().len() == 1 && !inside(pair[0]) && !inside(pair[1]) {
                assert_eq!(shaded(&all.as_slice()[0], pair[0], pair[1]), blocked, "{k} {pair:?}");
                hidden += usize::from(blocked);
                seen += usize::from(!blocked);
            }
        }
    }
    assert!(hidden > 100 && seen > 300, "{hidden} {seen}");
}

#[test]
fn the_part_of_a_body_in_front_of_a_plane_shades_the_same_there() {
    let mut random = Random(4);
    let (mut tested, mut cut_off) = (0, 0);
    for k in 0..60 {
        let block = cuboid(random.cube() * 0.3, Vec3::new(0.5, 0.3, 0.7), f64::from(k), false);
        let parts = if k % 3 == 0 { block[..1].to_vec() } else { block };
        let far =
            [Vec3::splat(3.0), Vec3::splat(-3.0), Vec3::new(3.0, -3.0, 3.0), Vec3::new(-3.0, 3.0, -3.0)];
        let all = bodies(&parts, &[], &far);
        let Some(body) = all.as_slice().first() else { continue };
        let plane = Face::through(random.cube() * 0.4, random.cube().normalize());
        let Some(part) = body.in_front(&plane, 1e-9) else { continue };
        cut_off += 1;
        for _ in 0..200 {
            let [x, y] = [0, 1].map(|_| random.cube() * 2.0);
            let inside = body.faces().iter().all(|face| face.height(x) <= 0.0);
            if plane.height(x) > 0.0 && plane.height(y) > 0.0 && !inside {
                assert_eq!(shaded(&part, x, y), shaded(body, x, y), "{k}: {x} {y}");
                tested += 1;
            }
        }
    }
    assert!(cut_off > 20 && tested > 500, "{cut_off} {tested}");
}

#[test]
fn a_screen_hides_of_the_target_what_its_body_does() {
    let mut random = Random(5);
    let (mut hidden, mut seen, mut fewer, mut turning) = (0, 0, 0, 0);
    for k in 0..160 {
        let block = cuboid(random.cube() * 0.2, Vec3::new(0.4, 0.2, 0.3), f64::from(k), false);
        let z = random.unit();
        let square = |z: f64, size: f64, centre: Vec3| {
            [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)]
                .map(|(u, v)| Vec3::new(centre.x + u * size, centre.y + v * size, z))
        };
        // Faces of the block turn on a large source.
        let (low, size) = if k < 80 { (-1.5, 0.4) } else { (-0.9, 2.0) };
        let (source, target) = (square(low, size, random.cube()), square(1.0 + z, 0.25, random.cube()));
        let elements = [quad(source), quad(target)];
        let all = bodies(&block, &elements, &[]);
        let [body] = all.as_slice() else { continue };
        let screen = Screen::new(body, &source, &target, 1e-9);
        fewer += usize::from(screen.edges().len() < 4);
        turning += usize::from(screen.turning().next().is_some());
        let mut volume = ShadowVolume::default();
        for _ in 0..50 {
            let (x, y) = (random.on(&elements[0]), random.on(&elements[1]));
            let dark = screen.shadow(x, &mut volume) == Shadow::Volume && volume.holds(&[y - x]);
            assert_eq!(dark, shaded(body, x, y), "{k}: {x} {y}");
            hidden += usize::from(dark);
            seen += usize::from(!dark);
        }
    }
    assert!(hidden > 200 && seen > 200 && fewer > 3 && turning > 40, "{hidden} {seen} {fewer} {turning}");
}

/// Two pyramids with n sides on one base, turned so that one face is level below.
fn spindle(n: usize, radius: f64, half: f64) -> Vec<Patch> {
    let (slope, first) = (half / radius, std::f64::consts::PI / n as f64);
    let turn = (slope / first.cos()).atan();
    let turned = |x: Vec3| {
        let (sine, cosine) = turn.sin_cos();
        Vec3::new(cosine * x.x + sine * x.z, x.y, cosine * x.z - sine * x.x)
    };
    let at = |k: usize| {
        let angle = first * (2 * (k % n) + 1) as f64;
        turned(Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0))
    };
    let [top, bottom] = [half, -half].map(|z| turned(Vec3::Z * z));
    let up = |k: usize| Patch::triangle([at(k), at(k + 1), top]).unwrap();
    let down = |k: usize| Patch::triangle([at(k + 1), at(k), bottom]).unwrap();
    (0..n).flat_map(|k| [up(k), down(k)]).collect()
}

#[test]
fn a_body_of_more_turning_faces_than_are_told_apart_hides_the_same() {
    let square = |z: f64, size: f64| {
        [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(u, v)| Vec3::new(u * size, v * size, z))
    };
    let (source, target) = (square(-1.0, 100.0), square(1.0, 0.8));
    let mut random = Random(6);
    for (n, least) in [(20, 30), (50, 80), (100, 150)] {
        let elements = [quad(source), quad(target)];
        let all = bodies(&spindle(n, 0.4, 0.3), &elements, &[]);
        let [body] = all.as_slice() else { panic!("{} bodies of {n} sides", all.as_slice().len()) };
        let screen = Screen::new(body, &source, &target, 1e-9);
        assert!(screen.turning().count() > least, "{}", screen.turning().count());
        let (mut hidden, mut volume) = (0, ShadowVolume::default());
        for _ in 0..200 {
            let (x, y) = (random.on(&elements[0]) * Vec3::new(0.02, 0.02, 1.0), random.on(&elements[1]));
            let dark = screen.shadow(x, &mut volume) == Shadow::Volume && volume.holds(&[y - x]);
            assert_eq!(dark, shaded(body, x, y), "{n}: {x} {y}");
            hidden += usize::from(dark);
        }
        assert!((10..190).contains(&hidden), "{n}: {hidden}");
    }
}

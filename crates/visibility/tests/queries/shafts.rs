//! Candidates between two patches, compared with segments between their points.

use fredholm_mesh::{Patch, Vec3};
use fredholm_visibility::Occluders;

use crate::scenes::{Random, cuboid, furnished, quad, sphere, triangle, triangulated, turned};

/// Which patches block the segment, each asked alone.
fn blockers(alone: &[Occluders], p: Vec3, q: Vec3) -> Vec<u32> {
    (0..alone.len() as u32).filter(|&c| !alone[c as usize].unoccluded(p, q)).collect()
}

/// Sorted, without repetition.
fn rises(list: &[u32]) -> bool {
    list.windows(2).all(|pair| pair[0] < pair[1])
}

fn faces(patch: &Patch, point: Vec3) -> bool {
    patch.normal().dot(point - patch.corner(0)) > 0.0
}

/// Samples segments between the patches; every blocker must be in the list, and the list must
/// decide visibility. Returns the number of blocked segments.
fn check(
    scene: &Occluders,
    alone: &[Occluders],
    [a, b]: [&Patch; 2],
    random: &mut Random,
    samples: usize,
) -> usize {
    let mut list = Vec::new();
    scene.shaft(a, b, &mut list);
    assert!(rises(&list));
    let mut blocked = 0;
    for _ in 0..samples {
        let (p, q) = (random.on(a), random.on(b));
        if !faces(a, q) || !faces(b, p) {
            continue;
        }
        let found = blockers(alone, p, q);
        assert!(found.iter().all(|c| list.contains(c)), "{found:?} not in {list:?}\n{a:?}\n{b:?}");
        assert_eq!(scene.unoccluded_by(p, q, &list), scene.unoccluded(p, q));
        blocked += usize::from(!found.is_empty());
    }
    blocked
}

/// A patch of random kind, place and size.
fn any_patch(random: &mut Random, size: f64) -> Patch {
    let centre = random.cube();
    loop {
        let [u, v] = [0, 1].map(|_| random.cube() * size);
        let patch = match random.index(3) {
            0 => Patch::triangle([centre, centre + u, centre + v]).ok(),
            1 => Patch::quad([centre, centre + u, centre + u + v, centre + v]).ok().flatten(),
            _ => Patch::quad([centre, centre + u, centre + u + 0.4 * v, centre + v]).ok().flatten(),
        };
        if let Some(patch) = patch {
            return patch;
        }
    }
}

#[test]
fn every_blocker_between_random_patches_is_listed() {
    let mut random = Random(17);
    let (mut blocked, mut empty, mut named) = (0, 0, 0);
    for _ in 0..120 {
        let patches: Vec<Patch> = (0..12).map(|_| any_patch(&mut random, 0.6)).collect();
        let scene = Occluders::new(&patches).unwrap();
        let alone: Vec<Occluders> = patches.iter().map(|p| Occluders::new(&[*p]).unwrap()).collect();
        for a in 0..12 {
            for b in 0..a {
                blocked += check(&scene, &alone, [&patches[a], &patches[b]], &mut random, 24);
                let mut list = Vec::new();
                scene.shaft(&patches[a], &patches[b], &mut list);
                empty += usize::from(list.is_empty());
                named += list.len();
            }
        }
    }
    assert!(blocked > 4_000, "{blocked}");
    // The test is sharp only where the lists are short: 12 patches, 7920 pairs.
    assert!(empty > 2_000 && named < 7_920 * 3, "{empty} empty, {named} named");
}

#[test]
fn every_blocker_in_a_furnished_room_is_listed() {
    let mut random = Random(19);
    for patches in [furnished(), triangulated(&furnished())] {
        let scene = Occluders::new(&patches).unwrap();
        let alone: Vec<Occluders> = patches.iter().map(|p| Occluders::new(&[*p]).unwrap()).collect();
        let mut blocked = 0;
        for a in &patches {
            for b in &patches {
                blocked += check(&scene, &alone, [a, b], &mut random, 40);
            }
        }
        assert!(blocked > 400, "{blocked}");
    }
}

#[test]
fn a_list_that_ends_early_says_so() {
    let mut patches = cuboid(Vec3::ZERO, Vec3::ONE, 0.0, true);
    let walls = [patches[0], patches[1]];
    patches.extend(sphere(3).iter().map(|t| triangle(t.map(|p| p * 0.4))));
    let scene = Occluders::new(&patches).unwrap();
    let (mut all, mut some) = (Vec::new(), Vec::new());
    let [a, b] = walls;
    scene.shaft(&a, &b, &mut all);
    assert!(all.len() > 100, "{}", all.len());
    assert!(!scene.shaft_up_to(&a, &b, 20, &mut some) && some.len() > 20 && some.len() < all.len());
    assert!(some.iter().all(|k| all.binary_search(k).is_ok()));
    assert!(scene.shaft_up_to(&a, &b, all.len(), &mut some) && some == all);
}

#[test]
fn every_blocker_among_thousands_is_listed() {
    let mut random = Random(23);
    let mut patches = cuboid(Vec3::ZERO, Vec3::ONE, 0.0, true);
    patches.extend(sphere(3).iter().map(|t| triangle(t.map(|p| p * 0.4))));
    let scene = Occluders::new(&patches).unwrap();
    let mut blocked = 0;
    let mut list = Vec::new();
    for _ in 0..400 {
        let [a, b] = [0, 1].map(|_| patches[random.index(patches.len())]);
        scene.shaft(&a, &b, &mut list);
        assert!(rises(&list));
        for _ in 0..20 {
            let (p, q) = (random.on(&a), random.on(&b));
            if faces(&a, q) && faces(&b, p) {
                let free = scene.unoccluded(p, q);
                assert_eq!(scene.unoccluded_by(p, q, &list), free);
                blocked += usize::from(!free);
            }
        }
    }
    // From any part of the room the outer hemisphere is in view, so only walls hide behind the
    // sphere.
    let (left, right) = (patches[0], patches[3]);
    scene.shaft(&left, &right, &mut list);
    assert!(list.len() > 1_000, "{}", list.len());
    assert!(blocked < 8_000);
}

#[test]
fn nothing_comes_between_the_walls_of_an_empty_room() {
    for (scale, centre, turn) in [
        (1.0, Vec3::ZERO, 0.0),
        (1e-3, Vec3::ONE, 0.0),
        (1.0, Vec3::splat(1000.0), 0.5),
        (10.0, Vec3::ZERO, 0.5),
    ] {
        let walls = cuboid(centre, Vec3::new(1.0, 1.5, 0.7) * scale, turn, true);
        for patches in [walls.clone(), triangulated(&walls)] {
            let scene = Occluders::new(&patches).unwrap();
            let elements: Vec<Patch> = patches.iter().flat_map(quarters).collect();
            let mut list = Vec::new();
            for a in &elements {
                for b in &elements {
                    scene.shaft(a, b, &mut list);
                    assert_eq!(list, [], "scale {scale}, turn {turn}");
                }
                scene.shaft_point(centre, a, &mut list);
                assert_eq!(list, []);
            }
        }
    }
}

/// Quads around the corners of a patch.
fn quarters(patch: &Patch) -> Vec<Patch> {
    let n = patch.sides();
    let middle = |i: usize| 0.5 * (patch.corner(i) + patch.corner(i + 1));
    (0..n).map(|i| quad([patch.corner(i), middle(i), patch.centroid(), middle(i + n - 1)])).collect()
}

#[test]
fn what_only_touches_is_not_listed() {
    // A box that stands on the floor: from its side to the floor in front of it nothing is in the
    // way.
    let floor = quad([(-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)].map(|(x, y)| Vec3::new(x, y, 0.0)));
    let mut patches = cuboid(Vec3::new(0.0, 0.0, 1.0), Vec3::ONE, 0.0, false);
    patches.push(floor);
    let scene = Occluders::new(&patches).unwrap();
    let mut list = vec![1, 2, 3];
    for side in &patches[..6] {
        for part in quarters(&floor) {
            scene.shaft(side, &part, &mut list);
            assert_eq!(list, [], "{side:?} {part:?}");
        }
    }
}

/// A square around (x, 0, z) that faces up, turned about the origin.
fn square(x: f64, z: f64, half: f64, turn: f64) -> Patch {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    quad(corners.map(|(u, v)| turned(Vec3::new(x + half * u, half * v, z), turn)))
}

#[test]
fn a_screen_is_listed_where_it_is_in_between() {
    let (low, high) = (square(0.0, 0.0, 1.0, 0.0), square(0.0, 2.0, 1.0, 0.0).flipped());
    let screens = [(0.0, 1.0), (1.4, 1.0), (1.5, 1.0), (0.0, 3.0)].map(|(x, z)| square(x, z, 0.5, 0.0));
    let scene = Occluders::new(&screens).unwrap();
    let mut list = Vec::new();
    scene.shaft(&low, &high, &mut list);
    assert_eq!(list, [0, 1]);
    scene.shaft_point(Vec3::ZERO, &high, &mut list);
    assert_eq!(list, [0]);
    scene.shaft_point(Vec3::X, &high, &mut list);
    assert_eq!(list, [0, 1]);
    // Back to back, or from behind, there is nothing to ask.
    scene.shaft(&low.flipped(), &high, &mut list);
    assert_eq!(list, []);
    scene.shaft_point(Vec3::new(0.0, 0.0, 2.5), &high, &mut list);
    assert_eq!(list, []);
}

#[test]
fn a_screen_that_touches_is_not_listed_and_one_that_reaches_in_is() {
    let mut list = Vec::new();
    for k in 0..50 {
        let turn = 0.1 * f64::from(k);
        let (low, high) = (square(0.0, 0.0, 1.0, turn), square(0.0, 2.0, 1.0, turn).flipped());
        for (reach, listed) in [(-1e-7, false), (0.0, false), (1e-7, true), (1e-5, true)] {
            let scene = Occluders::new(&[square(1.5 - reach, 1.0, 0.5, turn)]).unwrap();
            scene.shaft(&low, &high, &mut list);
            assert_eq!(list.len(), usize::from(listed), "reaches {reach} into the shaft, turned by {turn}");
        }
    }
}

#[test]
fn points_see_no_more_blockers_than_shafts_from_them_name() {
    let mut random = Random(29);
    let mut blocked = 0;
    for _ in 0..150 {
        let patches: Vec<Patch> = (0..12).map(|_| any_patch(&mut random, 0.6)).collect();
        let scene = Occluders::new(&patches).unwrap();
        let alone: Vec<Occluders> = patches.iter().map(|p| Occluders::new(&[*p]).unwrap()).collect();
        let mut list = Vec::new();
        for b in &patches {
            let p = random.cube();
            scene.shaft_point(p, b, &mut list);
            for _ in 0..20 {
                let q = random.on(b);
                if faces(b, p) {
                    let found = blockers(&alone, p, q);
                    assert!(
                        rises(&list) && found.iter().all(|c| list.contains(c)),
                        "{found:?} not in {list:?}"
                    );
                    blocked += usize::from(!found.is_empty());
                }
            }
        }
    }
    assert!(blocked > 1_000, "{blocked}");
}

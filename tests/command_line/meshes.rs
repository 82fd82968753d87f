//! Meshes with one defect each: the report names it, and the answer is that of the mended mesh, or
//! the mesh is refused with a cure.

use std::fmt::Write;
use std::fs;

use crate::support::{Bench, Run, column};

/// A room of 3 × 3 faces a wall with a lamp, and an object from a file.
fn scene(keys: &str) -> String {
    format!(
        "[solve]\nform_factor_tolerance = 1e-5\n\
         [materials.wall]\nreflectance = 0.5\n[materials.lamp]\nreflectance = 0\nexitance = 10\n\
         [[surface]]\nname = \"room\"\nmaterial = \"wall\"\nbox = {{ min = [0, 0, 0], max = [1, 1, 1], inward = true }}\ndivide = [3, 3]\n\
         [[surface]]\nname = \"lamp\"\nmaterial = \"lamp\"\nquad = [[0.4, 0.4, 0.95], [0.4, 0.6, 0.95], [0.6, 0.6, 0.95], [0.6, 0.4, 0.95]]\n\
         [[surface]]\nname = \"x\"\nmaterial = \"wall\"\nobj = {{ file = \"x.obj\"{keys}\n"
    )
}

/// A box in the words of an OBJ file; its corners are 1 to 8, x fastest, then y, then z.
struct Object {
    corners: Vec<[f64; 3]>,
    faces: Vec<Vec<usize>>,
}

const SIDES: [[usize; 4]; 6] =
    [[1, 5, 7, 3], [2, 4, 8, 6], [1, 2, 6, 5], [3, 7, 8, 4], [1, 3, 4, 2], [5, 6, 8, 7]];
const TOP: usize = 5;

impl Object {
    fn new() -> Self {
        Self { corners: vec![], faces: vec![] }
    }

    /// Adds a box, lit outside, turned about the vertical.
    fn add(mut self, min: [f64; 3], max: [f64; 3], degrees: f64) -> Self {
        let first = self.corners.len();
        let (sine, cosine) = f64::to_radians(degrees).sin_cos();
        for k in 0..8 {
            let [x, y, z] = [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { max[axis] } else { min[axis] });
            let (u, v) = (x - 0.5, y - 0.5);
            self.corners.push([0.5 + cosine * u - sine * v, 0.5 + sine * u + cosine * v, z]);
        }
        self.faces.extend(SIDES.map(|side| side.map(|corner| first + corner).to_vec()));
        self
    }

    /// Adds corners and faces of them, which are counted from 1 among the new ones.
    fn with(mut self, corners: &[[f64; 3]], faces: &[&[usize]]) -> Self {
        let first = self.corners.len();
        self.corners.extend(corners);
        self.faces.extend(faces.iter().map(|face| face.iter().map(|corner| first + corner).collect()));
        self
    }

    fn change(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    fn text(&self, digits: usize) -> String {
        let mut text = String::new();
        for [x, y, z] in &self.corners {
            writeln!(text, "v {x:.digits$} {y:.digits$} {z:.digits$}").unwrap();
        }
        for face in &self.faces {
            let words: Vec<String> = face.iter().map(ToString::to_string).collect();
            writeln!(text, "f {}", words.join(" ")).unwrap();
        }
        text
    }
}

const LOW: [f64; 3] = [0.3, 0.35, 0.2];
const HIGH: [f64; 3] = [0.6, 0.7, 0.6];

/// A box over the floor.
fn block() -> Object {
    Object::new().add(LOW, HIGH, 0.0)
}

fn check(obj: &str, keys: &str) -> Run {
    let bench = Bench::new(&scene(keys));
    fs::write(bench.path("x.obj"), obj).unwrap();
    bench.run(&["check", "scene.toml"])
}

/// Power that falls on each face of the room, and on the object, W.
fn solution(obj: &str, keys: &str) -> (Vec<f64>, f64) {
    let bench = Bench::new(&scene(keys));
    fs::write(bench.path("x.obj"), obj).unwrap();
    bench.solve(&["--no-pictures"]);
    let table = bench.path("out/scene/faces.csv");
    let text = fs::read_to_string(&table).unwrap();
    let names = text.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().to_owned());
    let values = column(&table, "area").into_iter().zip(column(&table, "irradiance_grey"));
    let (mut room, mut power) = (Vec::new(), 0.0);
    for (name, (area, irradiance)) in names.zip(values) {
        if name == "room" {
            room.push(area * irradiance);
        } else if name.starts_with('x') {
            power += area * irradiance;
        }
    }
    (room, power)
}

const PLAIN: &str = " }";

/// What is found is named, and the light is that of the mended mesh.
fn assert_mended(defect: &Object, mended: &Object, named: &str) {
    assert_same((&defect.text(6), PLAIN), (&mended.text(6), PLAIN), named);
}

fn assert_same(defect: (&str, &str), mended: (&str, &str), named: &str) {
    let report = check(defect.0, defect.1);
    assert!(report.code == 0 && report.stdout.contains(named), "{report:?}");
    assert!(!check(mended.0, mended.1).stdout.contains(named), "{named}");
    let ((room, power), (expected, total)) = (solution(defect.0, defect.1), solution(mended.0, mended.1));
    let scale = expected.iter().copied().fold(0.0, f64::max);
    let worst = room.iter().zip(&expected).map(|(a, b)| (a - b).abs() / scale).fold(0.0, f64::max);
    assert!(room.len() == expected.len() && worst < 6e-3, "{named}: {worst:.1e} in the room");
    assert!((power - total).abs() < 5e-3 * total, "{named}: {power} instead of {total} W on the object");
}

/// Refused with the words of the reason and of the cure.
fn assert_refused(obj: &str, reason: &str, cure: &str) {
    let report = check(obj, PLAIN);
    assert!(report.code == 2 && report.stderr.contains(reason) && report.stderr.contains(cure), "{report:?}");
    assert!(report.stderr.contains("x.obj:"), "{report:?}");
}

#[test]
fn an_open_bottom_on_the_floor_changes_nothing() {
    let standing = || Object::new().add([0.3, 0.35, 0.0], HIGH, 0.0);
    // Four of them are those of the lamp.
    assert_mended(&standing().change(|o| drop(o.faces.remove(4))), &standing(), "8 open sides");
}

#[test]
fn a_face_that_is_turned_makes_both_sides_lit() {
    for turned in [0, TOP] {
        let defect = block().change(|o| o.faces[turned].reverse());
        assert_mended(&defect, &block(), "sides with neighbours turned differently");
    }
    let kept = check(&block().change(|o| o.faces[TOP].reverse()).text(6), " }\ntwo_sided = false");
    assert!(kept.code == 0 && !kept.stdout.contains("lit on both sides;"), "{kept:?}");
}

#[test]
fn an_object_turned_inside_out_is_told_and_can_be_lit_on_both_sides() {
    let defect = block().change(|o| o.faces.iter_mut().for_each(|face| face.reverse()));
    let report = check(&defect.text(6), PLAIN);
    assert!(report.stdout.contains("lit inside and hold no lamp"), "{report:?}");
    assert!(report.stdout.contains("set two_sided = true"), "{report:?}");
    assert_same((&defect.text(6), " }\ntwo_sided = true"), (&block().text(6), PLAIN), "2 objects lit inside");
}

#[test]
fn a_repeated_face_counts_once() {
    let defect = block().change(|o| o.faces.push(o.faces[TOP].clone()));
    assert_mended(&defect, &block(), "1 repeated faces");
}

#[test]
fn a_face_repeated_in_reverse_is_black_inside() {
    let reversed = |o: &mut Object| o.faces.push(o.faces[TOP].iter().rev().copied().collect());
    assert_mended(&block().change(reversed), &block(), "1 faces repeated in reverse");
}

#[test]
fn an_object_given_twice_counts_once() {
    assert_mended(&block().add(LOW, HIGH, 0.0), &block(), "6 repeated faces");
}

#[test]
fn corners_inside_sides_let_no_light_through() {
    let split = |o: &mut Object| {
        o.corners.extend([[0.45, 0.35, 0.6], [0.45, 0.7, 0.6]]);
        o.faces[TOP] = vec![5, 9, 10, 7];
        o.faces.push(vec![9, 6, 8, 10]);
    };
    assert_mended(&block().change(split), &block(), "2 corners inside sides of others");
}

#[test]
fn slivers_do_no_harm() {
    let split = |o: &mut Object| {
        o.corners.push([0.45, 0.3501, 0.6]);
        o.faces.remove(TOP);
        o.faces.extend([vec![5, 6, 9], vec![6, 8, 9], vec![8, 7, 9], vec![7, 5, 9]]);
    };
    let cut = |o: &mut Object| {
        o.corners.push([0.45, 0.525, 0.6]);
        o.faces.remove(TOP);
        o.faces.extend([vec![5, 6, 9], vec![6, 8, 9], vec![8, 7, 9], vec![7, 5, 9]]);
    };
    assert_mended(&block().change(split), &block().change(cut), "1 slivers");
}

#[test]
fn faces_without_area_are_left_out() {
    let line = |o: &mut Object| {
        o.corners.push([0.45, 0.35, 0.6]);
        o.faces.extend([vec![5, 9, 6], vec![5, 5, 6]]);
    };
    assert_mended(&block().change(line), &block(), "2 faces enclose no area and are left out");
}

#[test]
fn a_quad_with_a_corner_given_twice_is_a_triangle() {
    let triangles = |o: &mut Object| o.faces.splice(TOP.., [vec![5, 6, 8], vec![5, 8, 7]]).for_each(drop);
    let doubled = |o: &mut Object| o.faces.splice(TOP.., [vec![5, 6, 6, 8], vec![5, 8, 7, 7]]).for_each(drop);
    let (defect, mended) = (block().change(doubled), block().change(triangles));
    assert_eq!(solution(&defect.text(6), PLAIN), solution(&mended.text(6), PLAIN));
}

#[test]
fn what_crosses_an_object_is_black_inside() {
    let pole = |from: f64| block().add([0.4, 0.45, from], [0.45, 0.5, 0.8], 0.0);
    assert_mended(&pole(0.3), &pole(0.6), "pairs of faces that cross");
}

#[test]
fn faces_that_lie_on_each_other_in_part_count_once() {
    let plate = [[0.25, 0.4, 0.6], [0.5, 0.4, 0.6], [0.5, 0.6, 0.6], [0.25, 0.6, 0.6]];
    let rest = [[0.25, 0.4, 0.6], [0.3, 0.4, 0.6], [0.3, 0.6, 0.6], [0.25, 0.6, 0.6]];
    assert_mended(
        &block().with(&plate, &[&[1, 2, 3, 4]]),
        &block().with(&rest, &[&[1, 2, 3, 4]]),
        "faces on each other, lit on the same side",
    );
}

#[test]
fn a_face_inside_an_object_is_buried() {
    let inner = [[0.4, 0.4, 0.4], [0.5, 0.4, 0.4], [0.5, 0.6, 0.4], [0.4, 0.6, 0.4]];
    let defect = block().with(&inner, &[&[1, 2, 3, 4]]);
    assert_mended(&defect, &block(), "1 buried faces");
}

#[test]
fn objects_that_share_a_side_are_told_and_right() {
    let two = |gap: f64| block().add([0.6 + gap, 0.7 + gap, 0.2], [0.8, 0.9, 0.6], 0.0);
    assert_mended(&two(0.0), &two(1e-5), "1 sides of more than two faces");
}

#[test]
fn objects_that_touch_are_one() {
    let two = Object::new().add(LOW, [0.45, 0.7, 0.6], 0.0).add([0.45, 0.35, 0.2], HIGH, 0.0);
    assert_mended(&two, &block(), "sides of more than two faces");
}

#[test]
fn rounded_quads_are_one_flat_face_each() {
    let turned = || {
        Object::new().add([0.3, 0.35, 0.2], [0.6, 0.7, 0.6], 17.0).change(|o| {
            // About a horizontal axis, too.
            let (sine, cosine) = f64::to_radians(23.0).sin_cos();
            for [_, y, z] in &mut o.corners {
                (*y, *z) = (
                    0.5 + cosine * (*y - 0.5) - sine * (*z - 0.4),
                    0.4 + sine * (*y - 0.5) + cosine * (*z - 0.4),
                );
            }
        })
    };
    let (rounded, exact) = (turned().text(6), turned().text(17));
    assert_same((&rounded, PLAIN), (&exact, PLAIN), "faces that were flat but for rounding");
    let report = check(&rounded, PLAIN);
    assert!(report.stdout.contains("61 elements"), "six faces of one element each: {report:?}");
}

#[test]
fn millimetres_are_told() {
    let large = block().change(|o| o.corners.iter_mut().flatten().for_each(|x| *x *= 1e4));
    let bench = Bench::new("");
    fs::write(bench.path("x.obj"), large.text(6)).unwrap();
    let report = bench.run(&["check", "x.obj"]);
    assert!(report.code == 0 && report.stdout.contains("unusual size"), "{report:?}");
    let metres = (&*large.text(6), ", scale = 1e-4 }");
    assert_eq!(solution(metres.0, metres.1).0.len(), 54);
    assert!(!check(metres.0, metres.1).stdout.contains("unusual size"));
}

#[test]
fn a_quad_that_crosses_itself_is_refused() {
    let defect = block().change(|o| o.faces[TOP].swap(1, 2));
    assert_refused(&defect.text(6), "sides of the quad cross", "list its corners in order");
}

#[test]
fn a_bent_quad_is_two_triangles() {
    let bent = |o: &mut Object| o.corners[7][2] += 0.05;
    let by_hand = |o: &mut Object| {
        bent(o);
        o.faces.splice(TOP.., [vec![5, 6, 7], vec![6, 8, 7]]).for_each(drop);
    };
    let (room, power) = solution(&block().change(bent).text(6), PLAIN);
    let (expected, total) = solution(&block().change(by_hand).text(6), PLAIN);
    let worst = room.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-3 && (power - total).abs() < 5e-3 * total, "{worst} {power} {total}");
}

#[test]
fn faces_of_corners_that_are_not_there_are_refused() {
    let defect = block().change(|o| o.faces[TOP][2] = 9);
    assert_refused(&defect.text(6), "there is no corner 9", "use indices from 1 to 8");
    assert_refused("v 0 0 0\nv 1 0 0\nv 0 1 nan\nf 1 2 3\n", "not a finite number", "write a number");
}

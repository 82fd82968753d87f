//! Furniture, as programs that model rooms write it: triangles, round parts in many small ones,
//! parts that touch and go through each other. Each piece stands at the origin on z = 0 and looks
//! along −y, if it looks anywhere.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use crate::body::{Body, placed};
use crate::dice::Dice;

/// Parts of one piece.
pub(crate) type Piece = Vec<Body>;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn board(size: [f64; 3], foot: [f64; 3], material: &'static str) -> Body {
    Body::block(size.into(), foot.into(), material)
}

/// A desk of 1.6 m × 0.8 m with a frame of steel and drawers. Who sits at it sits at y < 0.
pub(crate) fn desk() -> Piece {
    let mut parts = vec![board([1.6, 0.8, 0.025], [0.0, 0.0, 0.715], "oak")];
    for side in [-1.0, 1.0] {
        let x = 0.74 * side;
        let path = [
            v(x, -0.36, 0.0),
            v(x, -0.36, 0.66),
            v(x, -0.34, 0.69),
            v(x, 0.34, 0.69),
            v(x, 0.36, 0.66),
            v(x, 0.36, 0.0),
        ];
        parts.push(Body::tube(&path, 0.02, 12, "steel"));
    }
    parts.push(board([1.44, 0.02, 0.35], [0.0, 0.3, 0.36], "oak"));
    parts.push(board([0.4, 0.6, 0.55], [0.48, 0.02, 0.06], "lacquer"));
    for drawer in 0..3 {
        let z = 0.08 + 0.18 * f64::from(drawer);
        parts.push(board([0.38, 0.015, 0.165], [0.48, -0.2875, z], "lacquer"));
        let handle = [v(0.4, -0.32, z + 0.12), v(0.56, -0.32, z + 0.12)];
        parts.push(Body::tube(&handle, 0.006, 8, "steel"));
    }
    parts
}

/// A chair on five castors.
pub(crate) fn office_chair() -> Piece {
    let mut parts = vec![];
    for i in 0..5 {
        let angle = TAU * f64::from(i) / 5.0;
        let at = |p: DVec3| placed(p, angle, DVec3::ZERO);
        parts.push(Body::tube(&[at(v(0.0, 0.0, 0.13)), at(v(0.3, 0.0, 0.08))], 0.018, 8, "plastic"));
        let castor = Body::cushion(v(0.06, 0.04, 0.06), 6, 10, "plastic");
        parts.push(castor.moved(|p| placed(p + v(0.3, 0.0, 0.031), angle, DVec3::ZERO)));
    }
    parts.push(Body::tube(&[v(0.0, 0.0, 0.1), v(0.0, 0.0, 0.42)], 0.03, 16, "steel"));
    let seat = Body::cushion(v(0.5, 0.48, 0.09), 12, 28, "cloth");
    // It sinks a little in the middle and hangs down in front.
    parts.push(
        seat.moved(|p| p + v(0.0, 0.0, 0.46 + 0.12 * p.x * p.x - 0.9 * (-0.12 - p.y).max(0.0).powi(2))),
    );
    let back = Body::cushion(v(0.44, 0.07, 0.56), 16, 28, "cloth");
    parts.push(back.moved(|p| p + v(0.0, 0.25 - 0.7 * p.x * p.x + 0.3 * p.z * p.z, 0.84)));
    let spine = [v(0.0, 0.1, 0.42), v(0.0, 0.26, 0.44), v(0.0, 0.31, 0.55), v(0.0, 0.3, 0.8)];
    parts.push(Body::tube(&spine, 0.02, 10, "plastic"));
    for side in [-1.0, 1.0] {
        let x = 0.29 * side;
        let post = [v(0.2 * side, 0.05, 0.43), v(x, 0.05, 0.45), v(x, 0.05, 0.66)];
        parts.push(Body::tube(&post, 0.013, 8, "plastic"));
        parts.push(Body::cushion(v(0.07, 0.26, 0.03), 6, 16, "plastic").moved(|p| p + v(x, 0.02, 0.67)));
    }
    parts
}

/// A chair of bent tubes with a seat and a back of plywood, as classrooms have it.
pub(crate) fn school_chair() -> Piece {
    let mut parts = vec![];
    for side in [-1.0, 1.0] {
        let x = 0.19 * side;
        let front = [v(x, -0.2, 0.0), v(x, -0.17, 0.4), v(x, -0.14, 0.43), v(x, 0.15, 0.43)];
        parts.push(Body::tube(&front, 0.011, 8, "steel"));
        let rear = [v(x, 0.26, 0.0), v(x, 0.17, 0.4), v(x, 0.17, 0.5), v(x, 0.23, 0.82)];
        parts.push(Body::tube(&rear, 0.011, 8, "steel"));
    }
    parts.push(Body::tube(&[v(-0.19, 0.16, 0.43), v(0.19, 0.16, 0.43)], 0.011, 8, "steel"));
    let seat = Body::cushion(v(0.4, 0.4, 0.016), 8, 28, "plywood");
    parts
        .push(seat.moved(|p| p + v(0.0, 0.0, 0.452 + 0.3 * p.x * p.x - 0.8 * (-0.1 - p.y).max(0.0).powi(2))));
    let back = Body::cushion(v(0.4, 0.016, 0.2), 8, 24, "plywood");
    parts.push(back.moved(|p| p + v(0.0, 0.2 + 0.17 * p.z - 0.6 * p.x * p.x, 0.72)));
    parts
}

/// A double desk of 1.3 m × 0.5 m for pupils.
pub(crate) fn school_desk() -> Piece {
    let mut parts = vec![board([1.3, 0.5, 0.022], [0.0, 0.0, 0.738], "plywood")];
    parts.push(board([1.2, 0.4, 0.012], [0.0, 0.03, 0.6], "lacquer"));
    for side in [-1.0, 1.0] {
        let x = 0.6 * side;
        parts.push(Body::tube(&[v(x, -0.22, 0.02), v(x, 0.22, 0.02)], 0.018, 10, "steel"));
        parts.push(Body::tube(&[v(x, 0.0, 0.02), v(x, 0.0, 0.738)], 0.02, 12, "steel"));
        parts.push(Body::tube(&[v(x, -0.2, 0.72), v(x, 0.2, 0.72)], 0.015, 10, "steel"));
        let hook = [v(x + 0.07 * side, 0.0, 0.66), v(x, 0.0, 0.66)];
        parts.push(Body::tube(&hook, 0.006, 6, "steel"));
    }
    parts
}

/// A bookcase of 1 m × 0.3 m × 2 m with five shelves, filled by chance.
pub(crate) fn bookcase(dice: &mut Dice) -> Piece {
    const SHELVES: usize = 5;
    let mut parts = vec![board([0.96, 0.01, 2.0], [0.0, 0.145, 0.0], "lacquer")];
    for side in [-1.0, 1.0] {
        parts.push(board([0.02, 0.3, 2.0], [0.49 * side, 0.0, 0.0], "oak"));
    }
    for shelf in 0..=SHELVES {
        let z = 0.05 + (2.0 - 0.07) * shelf as f64 / SHELVES as f64 - if shelf == 0 { 0.0 } else { 0.02 };
        parts.push(board([0.96, 0.28, 0.02], [0.0, 0.0, z], "oak"));
        if shelf < SHELVES {
            parts.extend(books(0.94, z + 0.02, dice));
        }
    }
    parts
}

/// Books side by side on a board at the height `z`, which is `width` wide. Some lean, and some room
/// is left.
fn books(width: f64, z: f64, dice: &mut Dice) -> Piece {
    let (mut parts, mut x, end) = (vec![], -0.5 * width, 0.5 * width);
    loop {
        let (thick, high, deep) =
            (dice.between(0.012, 0.05), dice.between(0.2, 0.31), dice.between(0.15, 0.23));
        let lean = if dice.chance(0.08) { dice.between(0.05, 0.2) } else { 0.0 };
        let needs = thick + high * lean.sin() + dice.between(0.0005, 0.003);
        if x + needs > end {
            return parts;
        }
        let cover = dice.pick(&["red", "green", "navy", "ochre", "paper"]);
        // Its pages are paper on three sides, behind its back.
        let book = board([thick, deep, high], [0.0, 0.12 - 0.5 * deep, 0.0], cover);
        // It turns about its lower right edge, which stays on the board.
        let (sine, cosine) = lean.sin_cos();
        let right = 0.5 * thick;
        parts.push(book.moved(|p| {
            let (across, up) = (p.x - right, p.z);
            let turned = v(across * cosine + up * sine, p.y, up * cosine - across * sine);
            turned + v(x + thick, 0.0, z)
        }));
        x += needs;
        if dice.chance(0.06) {
            x += dice.between(0.03, 0.12);
        }
    }
}

/// A screen on a foot.
pub(crate) fn monitor() -> Piece {
    let foot = Body::turned(&[(0.0, 0.0), (0.11, 0.0), (0.11, 0.012), (0.0, 0.02)], 24, "plastic");
    vec![
        foot,
        Body::tube(&[v(0.0, 0.0, 0.015), v(0.0, 0.02, 0.2), v(0.0, -0.02, 0.3)], 0.016, 10, "steel"),
        board([0.62, 0.03, 0.37], [0.0, -0.03, 0.14], "plastic"),
        board([0.6, 0.004, 0.35], [0.0, -0.048, 0.15], "screen"),
    ]
}

/// A keyboard with five rows of keys.
pub(crate) fn keyboard() -> Piece {
    let mut parts = vec![board([0.42, 0.13, 0.015], [0.0, 0.0, 0.0], "plastic")];
    for row in 0..5 {
        for column in 0..13 {
            let (x, y) = (-0.192 + 0.032 * f64::from(column), -0.048 + 0.024 * f64::from(row));
            parts.push(board([0.026, 0.018, 0.007], [x, y, 0.015], "lacquer"));
        }
    }
    parts
}

/// A mug with a handle, hollow.
pub(crate) fn mug() -> Piece {
    let cup = [
        (0.0, 0.0),
        (0.036, 0.0),
        (0.04, 0.01),
        (0.041, 0.095),
        (0.038, 0.095),
        (0.036, 0.012),
        (0.0, 0.008),
    ];
    let handle: Vec<DVec3> = (0..=8)
        .map(|i| {
            let (sine, cosine) = (-FRAC_PI_2 + TAU * f64::from(i) / 16.0).sin_cos();
            v(0.039 + 0.026 * cosine, 0.0, 0.05 + 0.03 * sine)
        })
        .collect();
    vec![Body::turned(&cup, 24, "china"), Body::tube(&handle, 0.005, 8, "china")]
}

/// A lamp on an arm. Its lamp, a disc of the material `bulb`, shines downwards.
pub(crate) fn desk_lamp() -> Piece {
    let foot = Body::turned(&[(0.0, 0.0), (0.09, 0.0), (0.085, 0.02), (0.0, 0.025)], 24, "lacquer");
    let arm = [v(0.0, 0.0, 0.02), v(0.0, 0.12, 0.28), v(0.0, -0.1, 0.48)];
    // A shade with an inside, that ends at the lamp.
    let shade = [(0.0, 0.02), (0.03, 0.02), (0.085, -0.07), (0.09, -0.07), (0.035, 0.03), (0.0, 0.035)];
    let bulb = [(0.0, 0.0), (0.026, 0.0), (0.026, 0.019), (0.0, 0.019)];
    let mut bulb = Body::turned(&bulb, 16, "lacquer");
    // Its first ring of faces looks down.
    for (material, corners) in &mut bulb.faces {
        if corners.contains(&0) {
            *material = "bulb";
        }
    }
    let head = v(0.0, -0.12, 0.47);
    vec![
        foot,
        Body::tube(&arm, 0.007, 8, "steel"),
        Body::turned(&shade, 24, "lacquer").moved(|p| p + head),
        bulb.moved(|p| p + head),
    ]
}

/// Sheets of paper, a little turned against each other.
pub(crate) fn papers(dice: &mut Dice) -> Piece {
    let stack = (0..5).map(|i| {
        let sheet = Body::block(v(0.21, 0.297, 0.004), DVec3::ZERO, "paper");
        let angle = dice.between(-0.15, 0.15);
        sheet.moved(|p| placed(p, angle, v(0.0, 0.0, 0.0045 * f64::from(i))))
    });
    stack.collect()
}

/// A round table.
pub(crate) fn round_table() -> Piece {
    let top = [(0.0, 0.71), (0.5, 0.71), (0.51, 0.72), (0.5, 0.735), (0.0, 0.735)];
    let foot = [(0.0, 0.0), (0.3, 0.0), (0.29, 0.015), (0.04, 0.04), (0.035, 0.71), (0.0, 0.715)];
    vec![Body::turned(&top, 40, "oak"), Body::turned(&foot, 24, "steel")]
}

/// A basket for waste, hollow.
pub(crate) fn basket() -> Piece {
    let side = [(0.0, 0.0), (0.11, 0.0), (0.15, 0.32), (0.145, 0.32), (0.105, 0.01), (0.0, 0.01)];
    vec![Body::turned(&side, 28, "plastic")]
}

/// A pot with earth and the stems of a plant; its leaves are `leaves` of the same seed.
pub(crate) fn pot(seed: u64) -> Piece {
    let pot = [(0.0, 0.0), (0.13, 0.0), (0.18, 0.3), (0.165, 0.3), (0.155, 0.26), (0.0, 0.27)];
    let mut parts = vec![Body::turned(&pot, 28, "clay")];
    parts.extend(stems(seed).iter().map(|stem| Body::tube(stem, 0.006, 6, "leaf")));
    parts
}

/// The leaves of a plant, which have no thickness and are meant to be lit from both sides.
pub(crate) fn leaves(seed: u64) -> Piece {
    let mut dice = Dice::new(seed ^ 0x1eaf);
    let mut parts = vec![];
    for stem in stems(seed) {
        for (i, &joint) in stem.iter().enumerate().skip(1) {
            let angle = 2.4 * i as f64 + dice.between(-0.3, 0.3);
            let (length, rise) = (dice.between(0.16, 0.3), dice.between(0.2, 0.9));
            parts.push(leaf(length, rise, dice.between(0.06, 0.12)).moved(|p| placed(p, angle, joint)));
        }
    }
    parts
}

/// The joints of the stems of a plant.
fn stems(seed: u64) -> Vec<Vec<DVec3>> {
    let mut dice = Dice::new(seed);
    let stem = |i: usize| {
        let angle = TAU * i as f64 / 7.0 + dice.between(-0.3, 0.3);
        let (lean, joints) = (dice.between(0.1, 0.45), 8 + dice.below(4));
        let base = placed(v(0.06, 0.0, 0.255), angle, DVec3::ZERO);
        let joint = |j: usize| {
            let t = j as f64 / joints as f64;
            base + placed(v(lean * t * t + 0.05 * t, 0.02 * (9.0 * t).sin(), 1.2 * t), angle, DVec3::ZERO)
        };
        (0..=joints).map(joint).collect()
    };
    (0..7).map(stem).collect()
}

/// A leaf that starts at the origin along +x, rises and hangs over: two rows of triangles, folded
/// along its middle.
fn leaf(length: f64, rise: f64, width: f64) -> Body {
    const STEPS: usize = 6;
    let spine = |t: f64| v(t * length * (1.0 - 0.2 * t), 0.0, length * (rise * t - 0.9 * t * t));
    let mut corners = vec![spine(0.0)];
    for i in 1..STEPS {
        let t = i as f64 / STEPS as f64;
        let half = 0.5 * width * (0.5 * TAU * t.powf(0.8)).sin();
        corners.extend([spine(t), spine(t) + v(0.0, half, 0.3 * half), spine(t) + v(0.0, -half, 0.3 * half)]);
    }
    corners.push(spine(1.0));
    let (middle, left, right) = (|i: usize| 3 * i - 2, |i: usize| 3 * i - 1, |i: usize| 3 * i);
    let tip = corners.len() - 1;
    let mut faces = vec![vec![0, middle(1), left(1)], vec![0, right(1), middle(1)]];
    for i in 1..STEPS - 1 {
        faces.push(vec![middle(i), middle(i + 1), left(i + 1)]);
        faces.push(vec![middle(i), left(i + 1), left(i)]);
        faces.push(vec![middle(i), right(i), right(i + 1)]);
        faces.push(vec![middle(i), right(i + 1), middle(i + 1)]);
    }
    faces.push(vec![middle(STEPS - 1), tip, left(STEPS - 1)]);
    faces.push(vec![middle(STEPS - 1), right(STEPS - 1), tip]);
    Body { corners, faces: faces.into_iter().map(|face| ("leaf", face)).collect() }
}

/// A lamp that hangs from two wires, 1.2 m long: it is seen from below, and its wires end at
/// `ceiling` above its underside.
pub(crate) fn luminaire(ceiling: f64) -> Piece {
    let mut housing = board([1.2, 0.22, 0.05], [0.0, 0.0, 0.006], "lacquer");
    housing.faces.pop();
    // The diffuser under the housing is as wide, and its sides do not shine.
    let mut diffuser = board([1.2, 0.22, 0.006], [0.0, 0.0, 0.0], "lacquer");
    diffuser.faces.remove(4);
    if let Some((material, _)) = diffuser.faces.last_mut() {
        *material = "tube";
    }
    let mut parts = vec![housing, diffuser];
    for x in [-0.5, 0.5] {
        parts.push(Body::tube(&[v(x, 0.0, 0.05), v(x, 0.0, ceiling)], 0.003, 5, "steel"));
    }
    parts
}

/// A radiator of 1.6 m with columns.
pub(crate) fn radiator() -> Piece {
    let mut parts = vec![];
    for i in 0..20 {
        let x = -0.76 + 0.08 * f64::from(i);
        let column = [v(x, 0.0, 0.12), v(x, 0.0, 0.72)];
        parts.push(Body::tube(&column, 0.025, 10, "lacquer"));
    }
    for z in [0.16, 0.68] {
        parts.push(Body::tube(&[v(-0.8, 0.0, z), v(0.8, 0.0, z)], 0.02, 10, "lacquer"));
    }
    parts
}

/// A globe on a foot.
pub(crate) fn globe() -> Piece {
    let ball = Body::round(16, 32, "navy", |row, column| {
        let (across, up) = (0.5 * TAU * row as f64 / 16.0).sin_cos();
        let (sine, cosine) = (TAU * column as f64 / 32.0).sin_cos();
        let across = if row == 16 { 0.0 } else { across };
        v(across * cosine, across * sine, -up) * 0.16 + v(0.0, 0.0, 0.26)
    });
    let foot = [(0.0, 0.0), (0.1, 0.0), (0.09, 0.015), (0.012, 0.03), (0.01, 0.11), (0.0, 0.115)];
    vec![ball, Body::turned(&foot, 20, "oak")]
}

/// A curtain of 0.55 m × 2.2 m in folds, without thickness.
pub(crate) fn curtain() -> Piece {
    const COLUMNS: usize = 32;
    const ROWS: usize = 6;
    let mut corners = vec![];
    for row in 0..=ROWS {
        let z = 2.2 * row as f64 / ROWS as f64;
        for column in 0..=COLUMNS {
            let t = column as f64 / COLUMNS as f64;
            let fold = (0.02 + 0.015 * (1.0 - z / 2.2)) * (6.0 * TAU * t).sin();
            corners.push(v(0.55 * (t - 0.5), fold, z));
        }
    }
    let at = |row: usize, column: usize| row * (COLUMNS + 1) + column;
    let mut faces = vec![];
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column + 1), at(row + 1, column));
            faces.extend([("linen", vec![a, b, c]), ("linen", vec![a, c, d])]);
        }
    }
    vec![Body { corners, faces }]
}

/// A cupboard of 1.2 m × 0.45 m × 1.2 m with two doors.
pub(crate) fn cupboard() -> Piece {
    let mut parts = vec![board([1.2, 0.43, 1.2], [0.0, 0.01, 0.0], "lacquer")];
    for side in [-1.0, 1.0] {
        parts.push(board([0.58, 0.02, 1.1], [0.295 * side, -0.215, 0.05], "plywood"));
        let handle = [v(0.05 * side, -0.24, 0.6), v(0.05 * side, -0.24, 0.75)];
        parts.push(Body::tube(&handle, 0.007, 8, "steel"));
    }
    parts
}

/// A blackboard of 4 m × 1.2 m with a frame and a ledge, on a wall at y = 0.
pub(crate) fn blackboard() -> Piece {
    let mut parts = vec![board([4.0, 0.02, 1.2], [0.0, -0.012, 0.95], "board")];
    for side in [-1.0, 1.0] {
        parts.push(board([0.04, 0.04, 1.28], [2.021 * side, -0.022, 0.91], "oak"));
    }
    parts.push(board([4.0, 0.04, 0.04], [0.0, -0.022, 2.151], "oak"));
    parts.push(board([4.0, 0.08, 0.02], [0.0, -0.042, 0.929], "oak"));
    parts
}

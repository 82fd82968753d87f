//! Rows from rays against closed forms: form factors, furnaces, and what lamps send.

use fredholm_linop::{LinearOperator, MultiVector, Quiet};
use fredholm_mesh::{Patch, Vec3};
use fredholm_montecarlo::Enclosure;
use fredholm_montecarlo::rows::{Family, Looks, REPLICATES, RowSampler, Rows};

/// Both kinds of looks.
const LOOKS: [Looks; 2] = [Looks::Checked(2), Looks::Everywhere];

fn square(corners: [[f64; 3]; 4]) -> Patch {
    Patch::quad(corners.map(Vec3::from)).ok().flatten().expect("the corners are a square")
}

/// The six sides of the unit cube, seen from within.
fn cube() -> Vec<Patch> {
    vec![
        square([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]),
        square([[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]]),
        square([[0., 0., 0.], [0., 0., 1.], [1., 0., 1.], [1., 0., 0.]]),
        square([[0., 1., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.]]),
        square([[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]]),
        square([[1., 0., 0.], [1., 0., 1.], [1., 1., 1.], [1., 1., 0.]]),
    ]
}

/// Patches cut into four each, and their families.
fn cut(whole: &[Patch]) -> (Vec<Patch>, Vec<Family>) {
    let parts = whole.iter().flat_map(|patch| patch.split().expect("the patch is large")).collect();
    let family = |(k, &whole): (usize, &Patch)| Family { whole, parts: 4 * k..4 * k + 4, stream: k as u32 };
    (parts, whole.iter().enumerate().map(family).collect())
}

fn rows(scene: &Enclosure, families: &[Family], looks: Looks, count: u32) -> Rows {
    rows_of_all(scene, families, (looks, false), count)
}

fn rows_of_all(scene: &Enclosure, families: &[Family], (looks, is_dark): (Looks, bool), count: u32) -> Rows {
    let sampler = RowSampler::new(scene, families, 1);
    let mut rows = sampler.start(looks, 0, vec![is_dark; families.len()]);
    assert!(sampler.prolong(&mut rows, &vec![count; families.len()], &Quiet));
    rows
}

/// E of the solution of the rows by simple iteration.
fn solved(rows: &Rows, rho: f64, looks: Looks) -> [MultiVector<f64>; REPLICATES] {
    let [direct, reflected] = rows.lamplight();
    let zero = MultiVector::zeros(rows.dim(), 1);
    let (mut sent, mut product) = (zero.clone(), zero);
    for _ in 0..200 {
        rows.apply(&sent, &mut product);
        for i in 0..rows.dim() {
            let own = if looks == Looks::Everywhere { 0.0 } else { direct.row(i)[0] };
            sent.row_mut(i)[0] = rho * (own + reflected.row(i)[0] + product.row(i)[0]);
        }
    }
    rows.replicates(&sent)
}

#[test]
fn rows_are_form_factors() {
    // Far patches: a floor and the two halves of a ceiling at a distance of 8.
    let floor = square([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]);
    let ceiling = square([[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]]);
    let (parts, families) = cut(&[floor, ceiling]);
    let scene = Enclosure::new(parts, 1, vec![0.5; 8], vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]).unwrap();
    let rows = rows(&scene, &families, Looks::Checked(2), 4096);
    // Parallel unit squares at distance 1: F = 0.199825 (J. R. Howell, configuration C-11).
    let [direct, _] = rows.lamplight();
    let mean = |first: usize| (first..first + 4).map(|part| direct.row(part)[0]).sum::<f64>() / 4.0;
    assert!((mean(0) - 0.199_825).abs() < 2e-4, "{}", mean(0));
    assert!(mean(4).abs() < 1e-15, "lamps do not light themselves");
    let lit = rows.closure();
    let met = (0..4).map(|part| lit[part]).sum::<f64>() / 4.0;
    assert!((met - 0.199_825).abs() < 1e-3, "{met}");
    assert_eq!(rows.rays(), 8 * 4096 * REPLICATES as u64);
}

/// A closed cube that emits M everywhere and reflects ρ: E = M/(1 − ρ). Neighbours are near, so rays
/// go on from them.
#[test]
fn furnaces_are_met_within_their_standard_errors() {
    let (parts, families) = cut(&cube());
    for rho in [0.3, 0.8] {
        let scene = Enclosure::new(parts.clone(), 1, vec![rho; 24], vec![1.0; 24]).unwrap();
        for looks in LOOKS {
            let rows = rows(&scene, &families, looks, 512);
            assert!(rows.closure().iter().all(|&sum| (sum - 1.0).abs() < 1e-12));
            let replicates = solved(&rows, rho, looks);
            let of = |y: &MultiVector<f64>| y.as_slice().iter().sum::<f64>() / 24.0;
            let means = replicates.each_ref().map(of);
            let mean = means.iter().sum::<f64>() / 4.0;
            let error = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 12.0).sqrt();
            let exact = 1.0 / (1.0 - rho);
            assert!((mean - exact).abs() < 6.0 * error + 1e-3 * exact, "{rho}, {looks:?}: {mean} ± {error}");
            assert!(error < 0.01 * exact);
        }
    }
}

/// Rays from dark families go on further: fewer end on what is near, and the light is the same.
#[test]
fn from_dark_families_rays_go_on_further() {
    let (parts, families) = cut(&cube());
    let exitance = (0..24).map(|part| if part < 4 { 1.0 } else { 0.0 }).collect();
    let scene = Enclosure::new(parts, 1, vec![0.5; 24], exitance).unwrap();
    let [usual, dark] = [false, true].map(|is_dark| {
        let looks = Looks::Checked(2);
        let rows = rows_of_all(&scene, &families, (looks, is_dark), 1024);
        let mut kept = MultiVector::zeros(24, 1);
        rows.apply(&MultiVector::from_fn(24, 1, |_, _| 1.0), &mut kept);
        // Of each side of the cube: the mean and the square of its standard error.
        let replicates = solved(&rows, 0.5, looks);
        let side = |k: usize| {
            let of = |y: &MultiVector<f64>| (4 * k..4 * k + 4).map(|part| y.row(part)[0]).sum::<f64>() / 4.0;
            let means = replicates.each_ref().map(of);
            let mean = means.iter().sum::<f64>() / 4.0;
            [mean, means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 12.0]
        };
        (kept.as_slice().iter().sum::<f64>() / 24.0, [0, 1, 2, 3, 4, 5].map(side))
    });
    assert!(dark.0 < 0.5 * usual.0, "{} of {}", dark.0, usual.0);
    for ([a, of_a], [b, of_b]) in usual.1.into_iter().zip(dark.1) {
        assert!((a - b).abs() < 6.0 * (of_a + of_b).sqrt() + 2e-3 * a, "{a} and {b}");
        assert!(of_a.sqrt().max(of_b.sqrt()) < 0.02 * a, "{a}: {of_a} and {of_b}");
    }
}

/// Rows are prolonged by further points of their sequences: errors fall, and the same rays give the
/// same bits however they were come to.
#[test]
fn longer_rows_are_more_exact() {
    let (parts, families) = cut(&cube());
    let exitance = (0..24).map(|part| if part < 4 { 1.0 } else { 0.0 }).collect();
    let scene = Enclosure::new(parts, 1, vec![0.0; 24], exitance).unwrap();
    let mut errors = Vec::new();
    // The ceiling opposite to the lamp, and the four walls (configurations C-11 and C-14).
    let exact = |part: usize| match part / 4 {
        0 => 0.0,
        1 => 0.199_825,
        _ => 0.200_044,
    };
    for count in [16, 64, 256, 1024] {
        let rows = rows(&scene, &families, Looks::Checked(4), count);
        let [direct, _] = rows.lamplight();
        let mean = |family: usize| (4 * family..4 * family + 4).map(|p| direct.row(p)[0]).sum::<f64>() / 4.0;
        let square: f64 = (0..6).map(|family| (mean(family) - exact(4 * family)).powi(2)).sum();
        errors.push((square / 6.0).sqrt());
    }
    assert!(errors[3] < 1e-3 && errors[3] < errors[0] / 10.0, "faster than 1/√N: {errors:?}");
    let sampler = RowSampler::new(&scene, &families, 1);
    let start = || sampler.start(Looks::Checked(4), 0, vec![false; families.len()]);
    let mut grown = start();
    for count in [2, 8, 16] {
        assert!(sampler.prolong(&mut grown, &vec![count; families.len()], &Quiet));
    }
    let mut again = start();
    for count in [2, 4, 16] {
        assert!(sampler.prolong(&mut again, &vec![count; families.len()], &Quiet));
    }
    assert_eq!(grown.lamplight(), again.lamplight());
}

/// A lamp that lights half of a floor, seen by a ceiling: what the floor sends as a whole leaves
/// something out only where points differ from it.
#[test]
fn checks_find_what_elements_leave_out() {
    // A wall in the middle hides a lamp from half of the floor, and from all of the ceiling that
    // looks at the other half.
    let floor = square([[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]]);
    let screen = square([[0.02, -1., 0.], [0.02, 1., 0.], [0.02, 1., 2.9], [0.02, -1., 2.9]]);
    let back = screen.flipped();
    let lamp = square([[-4., -0.5, 1.], [-4., 0.5, 1.], [-4., 0.5, 2.], [-4., -0.5, 2.]]);
    let eye = square([[-0.6, -0.2, 3.], [-0.6, 0.2, 3.], [-0.4, 0.2, 3.], [-0.4, -0.2, 3.]]);
    let patches = [floor, screen, back, lamp, eye];
    let families: Vec<Family> = patches
        .iter()
        .enumerate()
        .map(|(k, &whole)| Family { whole, parts: k..k + 1, stream: k as u32 })
        .collect();
    let rho = vec![0.8, 0.0, 0.0, 0.0, 0.0];
    let scene = Enclosure::new(patches.to_vec(), 1, rho, vec![0.0, 0.0, 0.0, 1.0, 0.0]).unwrap();
    let checked = rows(&scene, &families, Looks::Checked(1), 16_384);
    let everywhere = rows(&scene, &families, Looks::Everywhere, 16_384);
    let [direct, near] = checked.lamplight();
    let sent = MultiVector::from_fn(5, 1, |part, _| if part == 0 { 0.8 * direct.row(0)[0] } else { 0.0 });
    let mut whole = MultiVector::zeros(5, 1);
    checked.apply(&sent, &mut whole);
    let as_whole = near.row(4)[0] + whole.row(4)[0];
    let exact = everywhere.lamplight()[1].row(4)[0];
    let left_out = 0.5 * (checked.left_out(false, &sent).row(4)[0] + checked.left_out(true, &sent).row(4)[0]);
    assert!(exact > 1.1 * as_whole, "{exact} {as_whole}");
    assert!((as_whole + left_out - exact).abs() < 0.03 * exact, "{as_whole} + {left_out} is not {exact}");
}

/// A floor on both sides of a wall, under a row of lamps on one side and of brighter ones on the
/// other: what few looks have found lets the same number of rays find the light of the first with
/// less noise.
#[test]
fn lamps_behind_a_wall_are_looked_at_less() {
    let (side, lamps) = (16_usize, 8_usize);
    let at = |k: usize| [(k % side) as f64 / 4.0 - 2.0, (k / side) as f64 / 4.0 - 2.0];
    let tile = |k: usize| {
        let [x, y] = at(k);
        square([[x, y, 0.], [x + 0.25, y, 0.], [x + 0.25, y + 0.25, 0.], [x, y + 0.25, 0.]])
    };
    let lamp = |k: usize| {
        let [x, y] = [if k.is_multiple_of(2) { -1.5 } else { 1.3 }, (k / 2) as f64 - 1.8];
        square([[x, y, 2.], [x, y + 0.2, 2.], [x + 0.2, y + 0.2, 2.], [x + 0.2, y, 2.]])
    };
    let wall = square([[0., -2., 0.], [0., 2., 0.], [0., 2., 2.2], [0., -2., 2.2]]);
    let floor = side * side;
    let mut patches: Vec<Patch> = (0..floor).map(tile).chain((0..lamps).map(lamp)).collect();
    patches.extend([wall, wall.flipped()]);
    let n = patches.len();
    let family = |(k, &whole): (usize, &Patch)| Family { whole, parts: k..k + 1, stream: k as u32 };
    let families: Vec<Family> = patches.iter().enumerate().map(family).collect();
    let mut exitance = vec![0.0; n];
    (0..lamps).for_each(|k| exitance[floor + k] = if k.is_multiple_of(2) { 1.0 } else { 5.0 });
    let scene = Enclosure::new(patches, 1, vec![0.0; n], exitance).unwrap();
    let cast = |sampler: &RowSampler, stage: u32, count: u32| {
        let mut rows = sampler.start(Looks::Checked(4), stage, vec![false; n]);
        assert!(sampler.prolong(&mut rows, &vec![count; n], &Quiet));
        rows
    };
    let mut sampler = RowSampler::new(&scene, &families, 1);
    let exact = cast(&sampler, 0, 4096).lamplight()[0].clone();
    let square_error = |rows: &Rows| -> f64 {
        let found = &rows.lamplight()[0];
        let dim = (0..floor).filter(|&k| at(k)[0] < 0.0);
        dim.map(|k| (found.row(k)[0] - exact.row(k)[0]).powi(2)).sum()
    };
    let by_bounds = cast(&sampler, 1, 16);
    let few = cast(&sampler, 2, 4);
    sampler.learn(&few);
    let learned = cast(&sampler, 3, 16);
    let ratio = square_error(&learned) / square_error(&by_bounds);
    assert!(ratio < 0.7, "{ratio}");
    // Every tile by itself, by what its replicates differ: no light is lost or found twice.
    let many = cast(&sampler, 4, 256);
    let replicates = many.direct_replicates();
    let scores = (0..floor).map(|k| {
        let means = replicates.each_ref().map(|y| y.row(k)[0]);
        let mean = means.iter().sum::<f64>() / 4.0;
        let square = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 12.0;
        [(mean - exact.row(k)[0]).powi(2), square]
    });
    let [errors, squares] = scores.fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    assert!((0.3..2.0).contains(&(errors / squares)), "{errors} and {squares}");
}

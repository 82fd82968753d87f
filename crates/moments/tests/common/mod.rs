//! The stored references, how results are compared with them, and how systems are solved.

#![allow(dead_code, reason = "every test file and example uses its part")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use fredholm_direct::{DenseLdlt, DenseLu};
use fredholm_linop::{LinearOperator, MultiVector, Quiet, SecondKind, Solver, Stop, StopReason, Symmetry};
use fredholm_mesh::Vec3;
use fredholm_moments::{Basis, Conductor, Currents, Imperfect};
use fredholm_waves::source::PlaneWave;
use fredholm_waves::{Complex64, ConductingSphere, Field, Source, Wave};
use std::path::Path;

/// λ at 1 GHz, m.
pub const WAVELENGTH: f64 = 0.299_792_458;

/// The wave of the references.
pub fn wave() -> Wave {
    Wave::new(1e9).unwrap()
}

/// Its source: E = ẑ e^{−jky}.
pub fn source() -> PlaneWave {
    PlaneWave::new(Vec3::Y, Vec3::Z, 1.0.into()).unwrap()
}

/// The receivers: 25 m away, a degree apart.
pub fn circle() -> Vec<Vec3> {
    let point = |degree: i32| {
        let (sin, cos) = f64::from(degree).to_radians().sin_cos();
        Vec3::new(25.0 * cos, 25.0 * sin, 0.0)
    };
    (0..360).map(point).collect()
}

/// Column `mom` of a reference; `tests/data/README.md` has its origin.
pub fn reference(name: &str) -> Vec<Complex64> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/wave").join(name);
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let [re, im] =
        ["mom_re_Ez", "mom_im_Ez"].map(|name| header.iter().position(|title| *title == name).unwrap());
    let value = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        Complex64::new(numbers[re], numbers[im])
    };
    lines.map(value).collect()
}

/// E_z of a conducting sphere on the circle.
pub fn mie(radius: f64) -> Vec<Complex64> {
    let ball = ConductingSphere::new(radius).unwrap();
    circle().iter().map(|&p| ball.scattered(&wave(), &source(), p).components()[2]).collect()
}

/// E_z of fields.
pub fn vertical(fields: &[Field]) -> Vec<Complex64> {
    fields.iter().map(|field| field.e.components()[2]).collect()
}

/// ‖a − b‖₂/‖b‖₂.
pub fn relative_error(a: &[Complex64], b: &[Complex64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let difference: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr()).sum();
    (difference / b.iter().map(Complex64::norm_sqr).sum::<f64>()).sqrt()
}

/// Z x = b, with K = 1 − Z.
pub fn solved(k: &dyn LinearOperator<Complex64>, b: &MultiVector<Complex64>) -> MultiVector<Complex64> {
    let ones = MultiVector::from_fn(b.dim(), b.rhs_count(), |_, _| Complex64::ONE);
    let a = SecondKind::new(k, ones).unwrap();
    let mut x = MultiVector::zeros(b.dim(), b.rhs_count());
    let stop = Stop { tolerance: 1e-9, max_iterations: 1 };
    let symmetric = k.symmetry() == Symmetry::Symmetric;
    let solver: &dyn Solver<Complex64> = if symmetric { &DenseLdlt } else { &DenseLu };
    let report = solver.solve(&a, b, &mut x, &stop, &mut Quiet).unwrap();
    assert_eq!(report.reason, StopReason::Converged);
    x
}

/// The currents of a conductor in the wave of the references.
pub fn currents<'a>(conductor: &Conductor<'a>, basis: &'a Basis) -> Currents<'a> {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let b = conductor.right_hand_side(&[&sources]);
    let x = solved(&conductor.operator().coupling().unwrap(), &b);
    Currents::new(basis, conductor.wave(), &x.vector(0), None)
}

/// The currents on what is no perfect conductor.
pub fn currents_on<'a>(body: &Imperfect<'a>) -> Currents<'a> {
    let source = source();
    let sources: [&dyn Source; 1] = [&source];
    let b = body.right_hand_side(&[&sources]);
    body.currents(&solved(&body.operator().coupling().unwrap(), &b).vector(0))
}

//! What holds for every body, and helpers of the tests beside it.

use super::*;
use crate::medium::SPEED_OF_LIGHT;
use std::f64::consts::TAU;

pub(super) fn wave_of(k: f64) -> Wave {
    Wave::new(k * SPEED_OF_LIGHT / TAU).unwrap()
}

pub(super) fn from(travel: [f64; 3], polarisation: [f64; 3]) -> PlaneWave {
    PlaneWave::new(Vec3::from(travel), Vec3::from(polarisation), Complex64::new(0.8, -0.6)).unwrap()
}

/// Half a wave from a third of a turn, along all axes.
pub(super) fn oblique() -> PlaneWave {
    from([-0.6, -0.5, 0.4], [0.3, -0.2, 0.9])
}

/// How far curl E = −jkη H and curl H = jk/η E are missed, relative to the fields, by
/// differences of the sixth order.
pub(super) fn maxwell_gap(medium: &Medium, p: Vec3, field: impl Fn(Vec3) -> Field) -> f64 {
    let step = 0.02 / medium.wavenumber().norm();
    let slope = |axis: Vec3| {
        [(1.0, 45.0), (2.0, -9.0), (3.0, 1.0)]
            .map(|(i, weight)| {
                let offset = axis * (step * i);
                (field(p + offset) - field(p - offset)) * (weight / (60.0 * step))
            })
            .into_iter()
            .sum::<Field>()
    };
    let slopes = [(Vec3::X, slope(Vec3::X)), (Vec3::Y, slope(Vec3::Y)), (Vec3::Z, slope(Vec3::Z))];
    let curl = |of: fn(&Field) -> ComplexVector| {
        slopes.iter().map(|(axis, slope)| of(slope).crossed_by(*axis)).sum::<ComplexVector>()
    };
    let (here, k, eta) = (field(p), medium.wavenumber() * Complex64::I, medium.impedance());
    let gaps =
        [(curl(|f| f.e) + here.h * (k * eta)).norm(), ((curl(|f| f.h) - here.e * (k / eta)) * eta).norm()];
    gaps[0].max(gaps[1]) / (k.norm() * (here.e.norm() + (here.h * eta).norm()))
}

#[test]
fn a_plane_wave_obeys_maxwell_in_any_medium() {
    let lossy = Medium::of(&wave_of(3.0), Complex64::new(2.5, -1.5)).unwrap();
    let gap = maxwell_gap(&lossy, Vec3::new(0.3, -0.4, 0.2), |p| lossy.incident(&oblique(), p));
    assert!(gap < 1e-11, "{gap:e}");
    let free = Medium::free_space(&wave_of(3.0));
    assert_eq!(Medium::of(&wave_of(3.0), Complex64::ONE).unwrap(), free);
    for (k, eta) in [(Complex64::new(1.0, 0.1), 377.0), (Complex64::ZERO, 377.0), (Complex64::ONE, -1.0)] {
        assert!(matches!(Medium::new(k, eta.into()), Err(WaveError::Material { .. })), "{k} {eta}");
    }
    assert!(Medium::of(&wave_of(3.0), Complex64::new(2.0, 0.1)).is_err());
}

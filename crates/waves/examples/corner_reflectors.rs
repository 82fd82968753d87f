//! Backscatter of a square dihedral (two bounces) and a triangular trihedral (three) beside their
//! closed forms 8πa²b²/λ² and 4πa⁴/(3λ²):
//! `cargo run --release -p fredholm-waves --example corner_reflectors -- 6 12 24`, sides in
//! wavelengths.

use fredholm_linop::MultiVector;
use fredholm_mesh::Vec3;
use fredholm_waves::source::PlaneWave;
use fredholm_waves::surface::{dihedral, trihedral};
use fredholm_waves::{
    Complex64, PhysicalOptics, Scatterer, Shadow, Source, System, Wave, WaveError, cross_section,
};
use std::f64::consts::{FRAC_PI_2, PI};

/// σ (m²) straight back towards `from` after so many bounces.
fn backscatter(scatterer: &Scatterer, wave: Wave, from: Vec3, bounces: usize) -> Result<f64, WaveError> {
    let source = PlaneWave::new(-from, Vec3::Z, 1.0.into())?;
    let sources: [&dyn Source; 1] = [&source];
    let first = PhysicalOptics::new(scatterer, wave, &sources, Shadow::Geometric)?;
    let system = System::lazy(scatterer, wave, Shadow::Geometric)?;
    let b = system.right_hand_side(&[&first]);
    let mut x = b.clone();
    for _ in 1..bounces {
        let mut product: MultiVector<Complex64> = MultiVector::zeros(x.dim(), 1);
        system.coupling().apply(&x, &mut product);
        x = MultiVector::from_fn(x.dim(), 1, |i, l| b.row(i)[l] + product.row(i)[l]);
    }
    let currents = system.currents(&x, 0);
    let far = system.radiator(&currents).far_field(&[from])?;
    Ok(cross_section(far[0].amplitude.dot(source.polarisation()), source.amplitude()))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wave = Wave::new(1e9)?;
    let wavelength = wave.wavelength();
    println!("side/λ  dihedral dB  trihedral dB");
    for argument in std::env::args().skip(1) {
        let side = argument.parse::<f64>()? * wavelength;
        let pair = dihedral(side, side, FRAC_PI_2, wavelength / 6.0)?;
        let two = backscatter(&pair, wave, Vec3::X, 2)? / (8.0 * PI * (side * side / wavelength).powi(2));
        let triple = trihedral(side, wavelength / 4.0)?;
        let closed = 4.0 * PI / 3.0 * (side * side / wavelength).powi(2);
        let three = backscatter(&triple, wave, Vec3::ONE.normalize(), 3)? / closed;
        println!("{argument:>6}  {:>11.2}  {:>12.2}", 10.0 * two.log10(), 10.0 * three.log10());
    }
    Ok(())
}

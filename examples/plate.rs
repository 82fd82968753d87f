//! The waves that a conducting plate scatters: `cargo run --release --example plate`.
//!
//! Seen squarely, the radar cross-section of a plate of area A is 4πA²/λ² by physical optics
//! (Knott, Shaeffer and Tuley, Radar Cross Section, 2004, section 5.3).

use std::error::Error;
use std::f64::consts::PI;

use fredholm::study::{Quiet, ResultFolder, WaveOptions, waves};
use fredholm::waves::medium::SPEED_OF_LIGHT;

/// Side of the plate of the scene, m.
const SIDE: f64 = 1.498_962_29;

fn main() -> Result<(), Box<dyn Error>> {
    let mut solved = waves("scenes/waves/plate.toml", &WaveOptions::default(), &Quiet)?;
    for found in solved.frequencies() {
        println!("{} MHz: {} facets, {}", found.frequency / 1e6, found.facets, solved.method());
    }
    let sections = solved.far().iter().filter_map(|row| Some((row, row.cross_section?)));
    let strongest = sections.max_by(|a, b| a.1[0].total_cmp(&b.1[0])).ok_or("there is no far field")?;
    let (row, [theta, _]) = strongest;
    let wavelength = SPEED_OF_LIGHT / row.frequency;
    let expected = 4.0 * PI * SIDE.powi(4) / (wavelength * wavelength);
    println!("strongest at φ = {}°: {theta:.2} m², squarely {expected:.2} m²", row.phi_degrees);
    let folder = std::env::temp_dir().join("fredholm-plate");
    solved.write(&ResultFolder::claim(&folder)?)?;
    println!("written to {}", folder.display());
    Ok(())
}

//! A closed room of one material: radiosity B = M/(1 − ρ) on every element.

use crate::support::{Bench, column, furnace};

#[test]
fn radiosity_is_exitance_over_absorptance() {
    let reflectance = [0.1, 0.5, 0.9, 0.99];
    let bench = Bench::new(&furnace(4, &reflectance));
    bench.solve(&["--tolerance", "1e-12", "--max-iterations", "2000", "--form-factor-tolerance", "1e-9"]);
    for (band, rho) in reflectance.into_iter().enumerate() {
        let radiosity = column(&bench.path("out/scene/field.csv"), &format!("radiosity_b{band}"));
        assert_eq!(radiosity.len(), 96);
        let exact = 1.0 / (1.0 - rho);
        let worst = radiosity.iter().map(|b| (b / exact - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-9, "ρ = {rho}: {worst:e}");
    }
}

#[test]
fn row_sums_are_one() {
    let bench = Bench::new(&furnace(4, &[0.5]));
    bench.solve(&["--form-factor-tolerance", "1e-9"]);
    let closure = bench.record("out/scene")["closure"]["max"].as_f64().unwrap();
    assert!(closure < 1e-9, "{closure:e}");
}

//! Measures the order of every discretisation on the manufactured problems and prints the table of docs/discretisations.md.

use fredholm_discretisation::manufactured::{Errors, manufactured, measure};
use fredholm_discretisation::{DiscretisationError, discretisations};
use fredholm_iterative::GaussSeidel;

fn main() -> Result<(), DiscretisationError> {
    let filter: Vec<String> = std::env::args().skip(1).collect();
    for problem in manufactured() {
        for method in discretisations() {
            let label = format!("{} {}", problem.name, method.name());
            if !filter.iter().all(|word| label.contains(word)) {
                continue;
            }
            let mut levels: Vec<(usize, Errors)> = Vec::new();
            for n in [2, 3, 4, 6, 8] {
                levels.push((n, measure(&problem, &*method, n, 7, &GaussSeidel)?));
            }
            print!("{label:55}");
            for pair in levels.windows(2) {
                let ratio = (pair[1].0 as f64 / pair[0].0 as f64).ln();
                let order = |f: fn(&Errors) -> f64| (f(&pair[0].1) / f(&pair[1].1)).ln() / ratio;
                print!(" | {:.2} {:.2}", order(|e| e.own), order(|e| e.iterated));
            }
            let last = levels[levels.len() - 1].1;
            println!(" | {:.1e} {:.1e} {:.1e} {}", last.own, last.iterated, last.stated, last.unknowns);
        }
    }
    Ok(())
}

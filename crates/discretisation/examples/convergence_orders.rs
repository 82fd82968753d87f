//! Measures the order of every discretisation on the manufactured problems and prints the tables of docs/discretisations.md.
//!
//! Words on the command line choose the lines that hold all of them.

use fredholm_discretisation::manufactured::{Errors, Manufactured, manufactured, measure};
use fredholm_discretisation::{Discretisation, DiscretisationError, discretisations};
use fredholm_iterative::GaussSeidel;

/// Gauss points along the sides of an element.
const POINTS: usize = 6;

fn main() -> Result<(), DiscretisationError> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    println!("| problem | method | orders of x_h | orders of the iterated solution | errors | unknowns |");
    println!("|---|---|---|---|---|---|");
    for problem in manufactured() {
        for method in discretisations() {
            let label = format!("| {} | {} |", problem.name, method.name());
            if words.iter().all(|word| label.contains(word.as_str())) {
                println!("{label} {}", line(&problem, &*method)?);
            }
        }
    }
    Ok(())
}

/// Elements along the sides of a piece. Closed surfaces have three or six times the elements.
fn meshes(problem: &Manufactured) -> [usize; 5] {
    if problem.name.starts_with("inside") { [1, 2, 3, 4, 5] } else { [2, 3, 4, 6, 8] }
}

fn line(problem: &Manufactured, method: &dyn Discretisation) -> Result<String, DiscretisationError> {
    let meshes = meshes(problem);
    let measured = |n: usize| measure(problem, method, n, POINTS, &GaussSeidel);
    let levels = meshes.iter().map(|&n| measured(n)).collect::<Result<Vec<Errors>, _>>()?;
    let orders = |of: fn(&Errors) -> f64| {
        let pairs = levels.windows(2).zip(meshes.windows(2));
        let order = |(e, n): (&[Errors], &[usize])| {
            format!("{:.2}", (of(&e[0]) / of(&e[1])).ln() / (n[1] as f64 / n[0] as f64).ln())
        };
        pairs.map(order).collect::<Vec<_>>().join(", ")
    };
    let last = levels.last().copied().unwrap_or_default();
    let errors = format!("{:.1e}, {:.1e}", last.own, last.iterated);
    let (own, iterated) = (orders(|e| e.own), orders(|e| e.iterated));
    Ok(format!("{own} | {iterated} | {errors} | {} |", last.unknowns))
}

//! Measures the order of every discretisation on the manufactured problems and prints the tables of
//! docs/notes/discretisations.md.
//!
//! Words on the command line choose the lines that hold all of them.

use fredholm_discretisation::manufactured::{Errors, Manufactured, manufactured, measure, orders};
use fredholm_discretisation::{Discretisation, DiscretisationError, discretisations};
use fredholm_iterative::GaussSeidel;

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
    match problem.name {
        "smooth kernel on a sphere" => [3, 4, 5, 6, 7],
        name if name.starts_with("inside") => [1, 2, 3, 4, 5],
        _ => [6, 7, 8, 9, 10],
    }
}

/// Gauss points along the sides of an element: their error is far below that of the method.
/// Lambert's kernel inside a tube needs the most.
fn points(problem: &Manufactured, method: &dyn Discretisation) -> usize {
    let number = method.name().chars().find_map(|c| c.to_digit(10)).unwrap_or(2) as usize;
    let degree = if method.name().starts_with("nystrom") { number - 1 } else { number };
    if problem.name.starts_with("inside") { 6 } else { degree + 3 }
}

fn line(problem: &Manufactured, method: &dyn Discretisation) -> Result<String, DiscretisationError> {
    let meshes = meshes(problem);
    let measured = |n: usize| measure(problem, method, n, points(problem, method), &GaussSeidel);
    let levels = meshes.iter().map(|&n| measured(n)).collect::<Result<Vec<Errors>, _>>()?;
    let orders = |of: fn(&Errors) -> f64| {
        let errors: Vec<f64> = levels.iter().map(of).collect();
        orders(&errors, &meshes).iter().map(|order| format!("{order:.2}")).collect::<Vec<_>>().join(", ")
    };
    let last = levels.last().copied().unwrap_or_default();
    let errors = format!("{:.1e}, {:.1e}", last.own, last.iterated);
    let (own, iterated) = (orders(|e| e.own), orders(|e| e.iterated));
    Ok(format!("{own} | {iterated} | {errors} | {} |", last.unknowns))
}

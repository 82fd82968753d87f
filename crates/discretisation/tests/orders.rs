//! Measured orders of convergence on smooth problems with a known solution, flat and curved, against theory.
//!
//! Five meshes, four refinements; the order of the last refinement must be within 0.15 of theory.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use fredholm_discretisation::manufactured::{
    Errors, Manufactured, facing_squares, facing_triangles, inside_of_a_sphere, measure, two_cylinders,
};
use fredholm_discretisation::{Discretisation, discretisations};
use fredholm_iterative::GaussSeidel;

/// Gauss points along an element's side.
const POINTS: usize = 5;
/// Errors below this are rounding.
const ROUNDING: f64 = 2e-12;

/// Orders of the own and of the iterated solution.
fn theory(name: &str) -> (f64, f64) {
    let number = name.chars().find(char::is_ascii_digit).and_then(|c| c.to_digit(10)).unwrap();
    if name.starts_with("nystrom") {
        return (f64::from(2 * number), f64::from(2 * number));
    }
    (f64::from(number + 1), f64::from(2 * number + 2))
}

fn levels(problem: &Manufactured, method: &dyn Discretisation, meshes: &[usize]) -> Vec<Errors> {
    meshes.iter().map(|&n| measure(problem, method, n, POINTS, &GaussSeidel).unwrap()).collect()
}

fn orders(errors: &[f64], meshes: &[usize]) -> Vec<f64> {
    let pairs = errors.windows(2).zip(meshes.windows(2));
    pairs.map(|(e, n)| (e[0] / e[1]).ln() / (n[1] as f64 / n[0] as f64).ln()).collect()
}

fn check(label: &str, errors: &[f64], meshes: &[usize], theory: f64) {
    let orders = orders(errors, meshes);
    println!("{label:60} {orders:.2?}, errors to {:.1e}", errors[errors.len() - 1]);
    let last = orders[orders.len() - 1];
    let at_rounding = errors[errors.len() - 1] < ROUNDING;
    assert!(at_rounding || (last - theory).abs() <= 0.15, "{label}: {orders:?}, theory {theory}");
}

fn check_all(problem: &Manufactured, of: impl Fn(&str) -> bool, meshes: &[usize]) {
    let mut tested = 0;
    for method in discretisations().iter().filter(|method| of(method.name())) {
        let (name, own, iterated) = (method.name(), theory(method.name()).0, theory(method.name()).1);
        let levels = levels(problem, &**method, meshes);
        let errors = |of: fn(&Errors) -> f64| levels.iter().map(of).collect::<Vec<f64>>();
        check(&format!("{}, {name}", problem.name), &errors(|e| e.own), meshes, own);
        // The superconvergence of conforming quadratics sets in late: it is shown in the documentation only.
        if name != "galerkin-2-conforming" {
            check(&format!("{}, {name}, iterated", problem.name), &errors(|e| e.iterated), meshes, iterated);
        }
        tested += 1;
    }
    assert!(tested > 0);
}

fn constant(name: &str) -> bool {
    name.ends_with("-0") || name == "nystrom-1"
}

fn linear(name: &str) -> bool {
    (name.contains("-1") && name != "nystrom-1") || name == "nystrom-2"
}

fn quadratic(name: &str) -> bool {
    !constant(name) && !linear(name)
}

#[test]
fn constants_have_order_one_and_two() {
    for problem in [facing_squares(), facing_triangles(), two_cylinders()] {
        check_all(&problem, constant, &[2, 3, 4, 5, 6]);
    }
    check_all(&inside_of_a_sphere(), constant, &[2, 3, 4, 5, 6]);
}

#[test]
fn linear_functions_have_order_two_and_four() {
    check_all(&facing_squares(), linear, &[2, 3, 4, 5, 6]);
    check_all(&facing_triangles(), |name| linear(name) && !name.contains("least"), &[2, 3, 4, 5, 6]);
    check_all(&two_cylinders(), |name| linear(name) && !name.contains("least"), &[2, 3, 4, 5, 6]);
}

#[test]
fn quadratic_functions_have_order_three_and_six() {
    let meshes = [2, 3, 4, 5, 6];
    check_all(&facing_squares(), |name| quadratic(name) && !name.contains("conforming"), &meshes);
    check_all(&facing_squares(), |name| name == "galerkin-2-conforming", &[4, 5, 6, 8, 10]);
    check_all(&two_cylinders(), |name| name == "galerkin-2" || name == "nystrom-3", &meshes);
}

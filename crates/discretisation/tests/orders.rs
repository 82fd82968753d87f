//! Measured orders of convergence on smooth problems with a known solution, flat and curved,
//! against theory.
//!
//! Three meshes, two refinements; the order of each must be within 0.15 of theory. The meshes begin
//! where the first term of the error rules: on coarser ones the second term, smaller by h or h²,
//! shows. What is run by hand takes five meshes.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

use fredholm_discretisation::manufactured::{
    Errors, Manufactured, facing_squares, facing_triangles, inside_of_a_cylinder, inside_of_a_sphere,
    measure, orders, smooth_kernel_on_a_sphere, two_cylinders,
};
use fredholm_discretisation::{Discretisation, discretisations};
use fredholm_iterative::GaussSeidel;

/// Parts along the side of a square, fine enough for every method.
const MESHES: [usize; 3] = [6, 7, 8];
/// Enough for constants and linear functions, and for quadratics that are not conforming.
const COARSE_MESHES: [usize; 3] = [4, 5, 6];
const MIDDLE_MESHES: [usize; 3] = [5, 6, 7];
/// Closed surfaces have three or six times the elements.
const CLOSED_MESHES: [usize; 3] = [3, 4, 5];
/// Those of what is run by hand.
const FINE_MESHES: [usize; 5] = [6, 7, 8, 9, 10];
const FINE_CLOSED_MESHES: [usize; 5] = [3, 4, 5, 6, 7];
/// Gauss points along the sides of an element inside the sphere and the tube: the error of fewer
/// shows beside that of the methods.
const POINTS_INSIDE: usize = 6;
/// Errors below this are rounding, and have no order.
const ROUNDING: f64 = 1e-12;
/// Farthest from theory that an order may be.
const MOST_ORDER_DEFECT: f64 = 0.15;

/// Degree of the polynomials on an element.
fn degree(name: &str) -> usize {
    let number = name.chars().find_map(|c| c.to_digit(10)).unwrap() as usize;
    if name.starts_with("nystrom") { number - 1 } else { number }
}

/// Orders of the own and of the iterated solution.
fn theory(name: &str) -> [f64; 2] {
    let k = degree(name) as f64;
    let own = if name.starts_with("nystrom") { 2.0 * k + 2.0 } else { k + 1.0 };
    [own, 2.0 * k + 2.0]
}

/// Errors of the own and of the iterated solution on every mesh.
fn errors(problem: &Manufactured, method: &dyn Discretisation, meshes: &[usize]) -> [Vec<f64>; 2] {
    // Gauss points whose error is far below that of the method.
    let points = if problem.name.starts_with("inside") { POINTS_INSIDE } else { degree(method.name()) + 3 };
    let measured = |&n: &usize| measure(problem, method, n, points, &GaussSeidel).unwrap();
    let levels: Vec<Errors> = meshes.iter().map(measured).collect();
    [levels.iter().map(|e| e.own).collect(), levels.iter().map(|e| e.iterated).collect()]
}

fn check(label: &str, errors: &[f64], meshes: &[usize], theory: f64) {
    let orders = orders(errors, meshes);
    println!("{label:60} {orders:.2?}, errors to {:.1e}", errors[errors.len() - 1]);
    let above_rounding = orders.iter().zip(&errors[1..]).filter(|(_, error)| **error > ROUNDING);
    for (order, _) in above_rounding {
        assert!((order - theory).abs() <= MOST_ORDER_DEFECT, "{label}: {orders:?}, theory {theory}");
    }
}

/// Checks the methods that `of` chooses, by name.
fn check_all(problem: &Manufactured, of: impl Fn(&str) -> bool, meshes: &[usize]) {
    let chosen: Vec<_> = discretisations().into_iter().filter(|method| of(method.name())).collect();
    assert!(!chosen.is_empty());
    for method in chosen {
        let name = method.name();
        let [own, iterated] = errors(problem, &*method, meshes);
        let label = format!("{}, {name}", problem.name);
        check(&label, &own, meshes, theory(name)[0]);
        if name == "galerkin-2-conforming" {
            check_layer(&label, &iterated, meshes);
        } else {
            check(&format!("{label}, iterated"), &iterated, meshes, theory(name)[1]);
        }
    }
}

/// Conforming quadratics err less in the layer of elements along the border of a face, where fewer
/// neighbours bind them: the error is C h⁶ (1 − c h), and the orders are 6 − c h. Continued to h =
/// 0 they must come to 6.
fn check_layer(label: &str, errors: &[f64], meshes: &[usize]) {
    let orders = orders(errors, meshes);
    let middle = |at: usize| 2.0 / (meshes[at] + meshes[at + 1]) as f64;
    let last = orders.len() - 1;
    let slope = (orders[last] - orders[0]) / (middle(0) - middle(last));
    let limit = orders[last] + slope * middle(last);
    println!("{label}, iterated: {orders:.2?}, continued to {limit:.2}");
    assert!(orders.is_sorted() && (limit - 6.0).abs() <= MOST_ORDER_DEFECT, "{label}: {orders:?}, {limit}");
}

#[test]
fn constants_have_order_one_and_two() {
    for problem in [facing_squares(), facing_triangles()] {
        check_all(&problem, |name| degree(name) == 0, &COARSE_MESHES);
    }
}

#[test]
fn linear_functions_have_order_two_and_four() {
    for problem in [facing_squares(), facing_triangles()] {
        check_all(&problem, |name| degree(name) == 1, &COARSE_MESHES);
    }
}

fn conforming(name: &str) -> bool {
    name.ends_with("conforming")
}

#[test]
fn quadratic_functions_have_order_three_and_six() {
    check_all(&facing_squares(), |name| degree(name) == 2 && conforming(name), &MESHES);
    check_all(&facing_squares(), |name| degree(name) == 2 && !conforming(name), &MIDDLE_MESHES);
}

#[test]
fn quadratic_functions_have_order_three_and_six_on_triangles() {
    check_all(
        &facing_triangles(),
        |name| ["galerkin-2", "collocation-2", "nystrom-3"].contains(&name),
        &COARSE_MESHES,
    );
}

#[test]
fn conforming_quadratics_have_order_three_and_six_on_triangles() {
    check_all(&facing_triangles(), |name| name == "galerkin-2-conforming", &MESHES);
}

#[test]
fn curved_surfaces_keep_the_orders_of_constants_and_linear_functions() {
    check_all(&two_cylinders(), |name| degree(name) < 2, &COARSE_MESHES);
    check_all(&smooth_kernel_on_a_sphere(), |name| name == "galerkin-0", &CLOSED_MESHES);
}

/// Lambert's kernel is constant there and lies in every basis: Galerkin's iterated solution is
/// exact, and has no order.
#[test]
fn galerkin_has_its_order_inside_a_sphere() {
    for name in ["galerkin-0", "galerkin-1"] {
        let method = discretisations().into_iter().find(|method| method.name() == name).unwrap();
        let [own, iterated] = errors(&inside_of_a_sphere(), &*method, &CLOSED_MESHES);
        check(&format!("inside of a sphere, {name}"), &own, &CLOSED_MESHES, theory(name)[0]);
        // On the first mesh the error of the rule for areas is as large as rounding may be.
        assert!(iterated[1..].iter().all(|error| *error <= ROUNDING), "{name}: {iterated:?}");
    }
}

#[test]
fn points_have_their_orders_inside_a_sphere() {
    check_all(&inside_of_a_sphere(), |name| ["collocation-0", "nystrom-1"].contains(&name), &MIDDLE_MESHES);
}

#[test]
fn constants_have_order_one_and_two_inside_a_cylinder() {
    let chosen = |name: &str| ["galerkin-0", "collocation-0"].contains(&name);
    check_all(&inside_of_a_cylinder(), chosen, &CLOSED_MESHES);
}

#[test]
fn linear_functions_have_order_two_and_four_inside_a_cylinder() {
    check_all(&inside_of_a_cylinder(), |name| name == "collocation-1", &CLOSED_MESHES);
}

#[test]
#[ignore = "takes minutes"]
fn higher_degrees_have_their_orders_on_triangles() {
    check_all(&facing_triangles(), |name| degree(name) > 0, &FINE_MESHES);
}

#[test]
#[ignore = "takes minutes"]
fn curved_surfaces_keep_the_orders() {
    check_all(&two_cylinders(), |name| name != "galerkin-2-conforming", &FINE_MESHES);
    let plain = |name: &str| name.starts_with("galerkin") && !conforming(name);
    check_all(&smooth_kernel_on_a_sphere(), plain, &FINE_CLOSED_MESHES);
}

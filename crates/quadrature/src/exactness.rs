//! What the tests of every rule share: all monomials of its degree to 1e-14, and a polynomial of
//! the next degree that it misses.
//!
//! The bound is relative to the measure times the largest value of the monomial, which is what
//! rounding is relative to. Beyond the degree Chebyshev polynomials are tried: on a monomial the
//! error of a good rule falls like 4^(−degree) and soon drowns in rounding.

use crate::{IntervalRule, PlanePoint, gauss_legendre};

/// Rounding allowed.
pub const ROUNDING_ALLOWED: f64 = 1e-14;
/// An error that is not rounding.
pub const LEAST_WRONG_ERROR: f64 = 10.0 * ROUNDING_ALLOWED;

/// An integrand on [0, 1], and one on the square or the triangle.
pub type Curve<'a> = &'a dyn Fn(f64) -> f64;
pub type Surface<'a> = &'a dyn Fn(f64, f64) -> f64;

/// Asserts the degree of a rule on [0, 1].
pub fn interval_degree(rule: &IntervalRule) {
    let label = format!("{} points", rule.points.len());
    interval_degree_of(&label, rule.degree, |f| rule.integrate(0.0, 1.0, f));
}

/// Asserts the degree of anything that integrates over [0, 1].
pub fn interval_degree_of(label: &str, degree: usize, integrate: impl Fn(Curve) -> f64) {
    for power in 0..=degree {
        let error = (integrate(&|x| x.powi(power as i32)) - 1.0 / (power + 1) as f64).abs();
        assert!(error <= ROUNDING_ALLOWED, "{label}, x^{power}: {error:e}");
    }
    let next = degree + 1;
    let beyond = (integrate(&|x| chebyshev(next, x)) - chebyshev_integral(next)).abs();
    assert!(beyond > LEAST_WRONG_ERROR, "{label}: degree {next} is off by only {beyond:e}");
}

/// T_m on [0, 1].
pub fn chebyshev(m: usize, x: f64) -> f64 {
    (m as f64 * (2.0 * x - 1.0).acos()).cos()
}

/// ∫₀¹ T_m = 1/(1 − m²) for even m, 0 for odd.
pub fn chebyshev_integral(m: usize) -> f64 {
    if m % 2 == 1 { 0.0 } else { 1.0 / (1.0 - (m * m) as f64) }
}

/// Σ w f(u, v).
pub fn plane_sum(points: &[PlanePoint], f: Surface) -> f64 {
    points.iter().map(|p| p.weight * f(p.u, p.v)).sum()
}

fn monomial(a: usize, b: usize) -> impl Fn(f64, f64) -> f64 {
    move |u, v| u.powi(a as i32) * v.powi(b as i32)
}

/// Asserts the degree, in u and in v, of anything that integrates over the unit square.
pub fn square_degree_of(label: &str, degree: usize, integrate: impl Fn(Surface) -> f64) {
    for (a, b) in (0..=degree).flat_map(|a| (0..=degree).map(move |b| (a, b))) {
        let error = (integrate(&monomial(a, b)) - 1.0 / ((a + 1) * (b + 1)) as f64).abs();
        assert!(error <= ROUNDING_ALLOWED, "{label}, u^{a} v^{b}: {error:e}");
    }
    let exact = chebyshev_integral(degree + 1);
    let in_u = (integrate(&|u, _| chebyshev(degree + 1, u)) - exact).abs();
    let in_v = (integrate(&|_, v| chebyshev(degree + 1, v)) - exact).abs();
    assert!(
        in_u.min(in_v) > LEAST_WRONG_ERROR,
        "{label}: degree {} is off by only {in_u:e}, {in_v:e}",
        degree + 1
    );
}

/// ∫ u^a v^b over the unit triangle, a! b! / (a + b + 2)!.
pub fn triangle_moment(a: usize, b: usize) -> f64 {
    let inverse_binomial: f64 = (1..=b).map(|k| k as f64 / (a + k) as f64).product();
    inverse_binomial / ((a + b + 1) * (a + b + 2)) as f64
}

/// Asserts the total degree of a rule on the unit triangle.
pub fn triangle_degree(points: &[PlanePoint], degree: usize) {
    triangle_degree_of(&format!("{} points", points.len()), degree, |f| plane_sum(points, f));
}

/// Asserts the total degree of anything that integrates over the unit triangle.
pub fn triangle_degree_of(label: &str, degree: usize, integrate: impl Fn(Surface) -> f64) {
    for (a, b) in (0..=degree).flat_map(|a| (0..=degree - a).map(move |b| (a, b))) {
        let error = (integrate(&monomial(a, b)) - triangle_moment(a, b)).abs() / (0.5 * peak(a, b));
        assert!(error <= ROUNDING_ALLOWED, "{label}, u^{a} v^{b}: {error:e}");
    }
    let next = degree + 1;
    let error = |a: usize| {
        let got = integrate(&|u, v| chebyshev(a, u) * chebyshev(next - a, v));
        (got - triangle_chebyshev(a, next - a)).abs()
    };
    let beyond = (0..=next).map(error).fold(0.0, f64::max);
    assert!(beyond > LEAST_WRONG_ERROR, "{label}: degree {next} is off by only {beyond:e}");
}

/// ∫ Tₐ(u) T_b(v) over the unit triangle, collapsed, by a Gauss–Legendre rule that is exact.
pub fn triangle_chebyshev(a: usize, b: usize) -> f64 {
    let rule = gauss_legendre(usize::midpoint(a, b) + 2);
    let across = |s: f64| rule.integrate(0.0, 1.0, |t| chebyshev(b, (1.0 - s) * t));
    rule.integrate(0.0, 1.0, |s| (1.0 - s) * chebyshev(a, s) * across(s))
}

/// The largest value of u^a v^b on the unit triangle, at u = a/(a + b).
pub fn peak(a: usize, b: usize) -> f64 {
    let share = |k: usize| (k as f64 / ((a + b).max(1)) as f64).powi(k as i32);
    share(a) * share(b)
}

//! The catalogued pairs.

use crate::cases::{Case, cases};
use crate::open;
use fredholm_coupling::method::{Evaluated, FormFactorMethod, Setting, methods};

/// Relative error.
fn off(case: &Case, got: &Evaluated) -> f64 {
    (got.value / case.a.area() / case.factor - 1.0).abs()
}

#[test]
fn the_closed_form_has_twelve_digits() {
    for case in cases() {
        let got = open("schroeder-hanrahan", &[case.a, case.b], Setting::Fixed);
        println!("{:<32} off by {:.1e}, stated {:.1e}", case.name, off(&case, &got), got.error / got.value);
        assert!(off(&case, &got) < 1e-12 && got.error < 1e-12 * got.value, "{}: {got:?}", case.name);
    }
}

#[test]
fn every_convergent_method_has_ten_digits_at_its_own_setting() {
    let fine = |method: &dyn FormFactorMethod, case: &Case| match method.default_setting() {
        Setting::Tolerance(_) => Setting::Tolerance(1e-11),
        Setting::Order(_) => Setting::Order(case.order),
        other => other,
    };
    let convergent: Vec<_> = methods().into_iter().filter(|method| method.convergent()).collect();
    assert_eq!(convergent.len(), 5);
    for case in cases() {
        for method in &convergent {
            let got = open(method.name(), &[case.a, case.b], fine(method.as_ref(), &case));
            assert!(off(&case, &got) < 1e-10, "{} {}: {:e}", case.name, method.name(), off(&case, &got));
        }
    }
}

#[test]
fn the_stated_errors_cover_the_catalogue() {
    for case in cases() {
        for method in methods() {
            let got = open(method.name(), &[case.a, case.b], method.default_setting());
            let error = off(&case, &got) * case.factor * case.a.area();
            let allowed = if method.name() == "monte-carlo" { 4.0 } else { 1.0 } * got.error;
            assert!(
                error <= allowed + 1e-13 * got.value,
                "{} {}: {error:e} > {got:?}",
                case.name,
                method.name()
            );
        }
    }
}

//! Every form-factor method on the catalogued pairs: relative error, stated error, evaluations and CPU time, as Markdown.
//!
//!     cargo run --release -p fredholm-coupling --example method_table

// An example that cannot run should stop.
#![allow(clippy::unwrap_used)]

#[allow(dead_code, reason = "the tests need more of it")]
#[path = "../tests/methods/cases.rs"]
mod cases;

use cases::{Case, cases};
use fredholm_coupling::method::{Evaluated, FormFactorMethod, Setting, methods};
use fredholm_visibility::Occluders;
use std::time::Instant;

fn main() {
    println!("| case | method | setting | relative error | stated | evaluations | CPU µs |");
    println!("|---|---|---|---|---|---|---|");
    for case in cases() {
        for method in methods() {
            row(&case, method.as_ref());
        }
    }
}

fn row(case: &Case, method: &dyn FormFactorMethod) {
    let nothing = Occluders::new(&[]).unwrap();
    let setting = setting(method, case);
    let run = || method.exchange(&case.a, &case.b, &nothing, setting).unwrap();
    let (got, time) = timed(run);
    let exact = case.factor * case.a.area();
    println!(
        "| {} | {} | {setting} | {:+.1e} | {:.1e} | {} | {:.1} |",
        case.name,
        method.name(),
        got.value / exact - 1.0,
        got.error / exact,
        got.evaluations,
        1e6 * time,
    );
}

/// Ten digits where the method can give them, else its usual setting.
fn setting(method: &dyn FormFactorMethod, case: &Case) -> Setting {
    match method.default_setting() {
        Setting::Tolerance(_) => Setting::Tolerance(1e-11),
        Setting::Order(_) if method.convergent() => Setting::Order(case.order),
        other => other,
    }
}

/// A result and the seconds it takes on one thread: the best of ten rounds of about a millisecond. Rounds as short as that are seldom
/// interrupted, so that the best of them is CPU time.
fn timed(run: impl Fn() -> Evaluated) -> (Evaluated, f64) {
    let start = Instant::now();
    let got = run();
    let rounds = (1e-3 / start.elapsed().as_secs_f64()).clamp(1.0, 1e3) as usize;
    let round = |_| {
        let start = Instant::now();
        for _ in 0..rounds {
            std::hint::black_box(run());
        }
        start.elapsed().as_secs_f64() / rounds as f64
    };
    (got, (0..10).map(round).fold(f64::INFINITY, f64::min))
}

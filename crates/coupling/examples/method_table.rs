//! Every form-factor method on the catalogued pairs: relative error, evaluations and CPU time, as Markdown.
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
    let cases = cases();
    println!("| method | {} |", cases.iter().map(|case| case.name.as_str()).collect::<Vec<_>>().join(" | "));
    println!("|---{}|", "|---".repeat(cases.len()));
    for method in methods() {
        let cells: Vec<String> = cases.iter().map(|case| cell(case, method.as_ref())).collect();
        println!("| `{}` | {} |", method.name(), cells.join(" | "));
    }
}

/// Relative error; evaluations; time. Orders are given, since they differ.
fn cell(case: &Case, method: &dyn FormFactorMethod) -> String {
    let nothing = Occluders::new(&[]).unwrap();
    let setting = setting(method, case);
    let (got, time) = timed(|| method.exchange(&case.a, &case.b, &nothing, setting).unwrap());
    let error = (got.value / case.a.area() / case.factor - 1.0).abs();
    let error = if error > 0.01 { format!("{:.0} %", 100.0 * error) } else { format!("{error:.0e}") };
    let order = if let Setting::Order(order) = setting { format!("n = {order}: ") } else { String::new() };
    format!("{order}{error}; {}; {}", got.evaluations, micros(time))
}

fn micros(seconds: f64) -> String {
    let micros = 1e6 * seconds;
    if micros < 10.0 { format!("{micros:.1} µs") } else { format!("{micros:.0} µs") }
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

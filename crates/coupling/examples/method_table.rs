//! Every form-factor method on the catalogued pairs: relative error, evaluations and CPU time, as
//! Markdown.
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
use std::sync::LazyLock;
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

/// CPU seconds over which a time is taken, twenty ticks.
const LEAST_TIMED_SECONDS: f64 = 0.2;

/// A result and the CPU seconds it takes: the mean over as many rounds as last long enough.
fn timed(run: impl Fn() -> Evaluated) -> (Evaluated, f64) {
    let mut rounds = 1u32;
    loop {
        let start = cpu_seconds();
        (0..rounds).for_each(|_| {
            std::hint::black_box(run());
        });
        let time = cpu_seconds() - start;
        if time >= LEAST_TIMED_SECONDS {
            return (run(), time / f64::from(rounds));
        }
        rounds *= 2;
    }
}

/// CPU time of this process where the system tells it (in ticks of 10 ms), else the time passed.
fn cpu_seconds() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let told = std::fs::read_to_string("/proc/self/stat").ok();
    let ticks = told.and_then(|line| {
        let fields = line.rsplit(')').next()?.split_whitespace();
        fields.skip(11).take(2).map(|field| field.parse::<f64>().ok()).sum::<Option<f64>>()
    });
    ticks.map_or_else(|| START.elapsed().as_secs_f64(), |ticks| 0.01 * ticks)
}

//! The program on random valid input and on damaged files: it answers or refuses, and never
//! crashes.
//!
//! Here it runs for about twenty seconds. By hand it runs for as long as is wanted; what is found is told
//! with the number that makes it again, and its files are kept in the folder named:
//!
//!     FREDHOLM_CASES=5000 FREDHOLM_FIRST=1 FREDHOLM_KEEP=/tmp/finds \
//!         cargo test --release --test robustness random -- --nocapture
//!     FREDHOLM_MUTANTS=20000 FREDHOLM_FIRST=1 cargo test --release --test robustness damaged -- --nocapture

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod mutants;
#[cfg(unix)]
mod random;
mod settings;

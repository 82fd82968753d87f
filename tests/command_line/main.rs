//! The program as its users meet it: verbs, messages, exit codes, result files.

// A test that cannot run should panic, in its helpers too.
#![allow(clippy::unwrap_used)]

mod accuracy;
mod converge;
mod determinism;
mod discretisations;
mod exit_codes;
mod false_colour;
mod first_contact;
mod folders;
mod formats;
mod furnace;
mod help;
mod hostile;
mod hostile_waves;
mod info;
#[cfg(unix)]
mod interrupt;
#[cfg(unix)]
mod memory;
mod meshes;
mod methods;
mod results;
mod results_page;
mod shoot;
mod stochastic;
mod support;
mod viewfactors;
mod waves;

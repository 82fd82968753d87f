//! The program as its users meet it: verbs, messages, exit codes, result files.

mod determinism;
mod exit_codes;
mod furnace;
mod help;
mod hostile;
#[cfg(unix)]
mod interrupt;
#[cfg(unix)]
mod memory;
mod results;
mod support;

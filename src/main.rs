//! The `fredholm` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    fredholm_cli::run()
}

//! The command line of Fredholm: arguments, the console, and exit codes. What is computed and
//! written is [`fredholm_study`].
//!
//! [`run`] reads the arguments, carries out the verb and returns the exit code: 0 done, 2 bad input
//! or usage, 3 not converged (the results are written all the same), 4 resources refused, 5 a file
//! could not be read or written, 6 two solutions or a tracer disagree, 130 interrupted. Standard
//! output carries results and summaries, standard error progress, warnings and errors.

mod args;
mod commands;
mod console;
mod duration;
mod ending;
mod heap;
mod interrupt;
mod output;
mod start;
mod terminal;

use std::process::ExitCode;

use args::Cli;
use ending::{Ending, present};

/// Runs the program on the arguments of the process.
#[must_use]
pub fn run() -> ExitCode {
    heap::share();
    match Cli::read(std::env::args_os()) {
        Ok(cli) => carry_out(&cli),
        Err(usage) => {
            // Help for a reader that has gone away needs no answer.
            let _ = usage.print();
            u8::try_from(usage.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from)
        }
    }
}

fn carry_out(cli: &Cli) -> ExitCode {
    match commands::execute(&cli.command) {
        Ok(ending) => ending.into(),
        Err(error) => {
            present(&error, cli.command.log());
            Ending::from(error.kind()).into()
        }
    }
}

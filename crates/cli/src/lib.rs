//! The command line of Fredholm; no mathematics.
//!
//! [`run`] reads the arguments, carries out the verb and returns the exit code: 0 done, 2 bad input or usage, 3 not
//! converged (the results are written all the same), 4 resources refused, 5 a file could not be read or written,
//! 6 two solutions disagree, 130 interrupted. Standard output carries results and summaries, standard error progress, warnings and errors.

mod args;
mod checkpoint;
mod choice;
mod commands;
mod console;
mod discretised;
mod duration;
mod failure;
mod folder;
mod hierarchical;
mod interrupt;
mod memory;
mod mesh_error;
mod options;
mod output;
mod pictures;
mod prediction;
mod problem;
mod record;
mod registry;
mod sample;
mod shadows;
mod size;
mod solution;
mod stages;
mod start;
mod stochastic;
mod summary;
mod threads;
mod trial;
mod watcher;
mod waves;

use std::process::ExitCode;

use args::Cli;

/// Runs the program on the arguments of the process.
#[must_use]
pub fn run() -> ExitCode {
    memory::share_one_heap();
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
        Err(failure) => {
            failure.present(cli.command.log());
            failure.ending.into()
        }
    }
}

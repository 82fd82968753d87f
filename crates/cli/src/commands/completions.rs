//! `fredholm completions`.

use clap::CommandFactory;
use fredholm_study::Error;

use crate::args::{Cli, CompletionsArgs};
use crate::ending::Ending;
use crate::output;

/// Prints the completions of a shell.
pub(crate) fn completions(args: &CompletionsArgs) -> Result<Ending, Error> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "fredholm", &mut script);
    output::print(&String::from_utf8_lossy(&script))?;
    Ok(Ending::Done)
}

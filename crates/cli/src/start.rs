//! How a verb that computes and writes begins: signals, a folder that can be written to, the
//! console, threads.

use std::path::{Path, PathBuf};

use fredholm_study::{
    Bytes, Error, ResultFolder, claim_folder, claim_folder_to_add, less_than_asked, peak_memory, thread_pool,
};
use serde_json::{Value, json};

use crate::args::{LogArgs, ProblemArgs};
use crate::ending::Ending;
use crate::terminal::Terminal;

/// What the command line says of it.
pub(crate) struct Start<'a> {
    pub(crate) scene: &'a Path,
    pub(crate) output: Option<&'a PathBuf>,
    /// What the name of the usual folder ends in, so that no verb removes the results of another;
    /// empty for `solve`.
    pub(crate) verb: &'static str,
    pub(crate) threads: Option<u16>,
    pub(crate) memory: Option<Bytes>,
    pub(crate) log: LogArgs,
}

impl<'a> Start<'a> {
    /// That of a verb with the options of a problem.
    pub(crate) fn of(
        problem: &'a ProblemArgs,
        output: Option<&'a PathBuf>,
        verb: &'static str,
        log: LogArgs,
    ) -> Self {
        let ProblemArgs { scene, threads, memory, .. } = problem;
        Self { scene, output, verb, threads: *threads, memory: *memory, log }
    }

    /// Runs a verb on its threads, with the folder for its results.
    pub(crate) fn run(
        &self,
        verb: impl FnOnce(&ResultFolder, &Terminal) -> Result<Ending, Error> + Send,
    ) -> Result<Ending, Error> {
        self.run_in(claim_folder, verb)
    }

    /// Runs a verb whose files are added to a folder.
    pub(crate) fn run_beside(
        &self,
        verb: impl FnOnce(&ResultFolder, &Terminal) -> Result<Ending, Error> + Send,
    ) -> Result<Ending, Error> {
        self.run_in(claim_folder_to_add, verb)
    }

    fn run_in(
        &self,
        claim: impl FnOnce(&Path, &str) -> Result<ResultFolder, Error>,
        verb: impl FnOnce(&ResultFolder, &Terminal) -> Result<Ending, Error> + Send,
    ) -> Result<Ending, Error> {
        let terminal = Terminal::new(self.log)?;
        let folder = claim(&folder(self.output, self.scene, self.verb), "-o DIR")?;
        run(&terminal, self.threads, self.memory, || verb(&folder, &terminal))
    }
}

/// Runs a verb on so many threads.
pub(crate) fn run(
    terminal: &Terminal,
    threads: Option<u16>,
    memory: Option<Bytes>,
    verb: impl FnOnce() -> Result<Ending, Error> + Send,
) -> Result<Ending, Error> {
    if let Some((asked, limit)) = memory.and_then(|asked| Some((asked, less_than_asked(asked)?))) {
        let text = format!("--memory {asked} is more than there may be: the limit is {limit}");
        terminal.console.warn(&text);
    }
    let ended = terminal.interrupt.ended(thread_pool(threads)?.install(verb), &*terminal.console);
    if let Some(peak) = peak_memory() {
        terminal.console.held(peak);
    }
    ended
}

/// The folder asked for, or `out/` and the name of the scene file without its ending, and then the
/// verb.
fn folder(output: Option<&PathBuf>, scene: &Path, verb: &str) -> PathBuf {
    let mut name = scene.file_stem().unwrap_or_else(|| "scene".as_ref()).to_owned();
    if !verb.is_empty() {
        name.push("-");
        name.push(verb);
    }
    output.cloned().unwrap_or_else(|| Path::new("out").join(name))
}

/// How the program was asked to show what goes on, for the record.
pub(crate) fn recorded(log: LogArgs) -> fredholm_study::Recorded {
    let LogArgs { log, quiet, time_limit } = log;
    let limit = time_limit.map(|limit| ("time_limit_s".to_owned(), json!(limit.as_secs_f64())));
    let shown = [("log".to_owned(), json!(log)), ("quiet".to_owned(), Value::Bool(quiet))];
    shown.into_iter().chain(limit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_go_to_a_folder_of_the_name_of_the_scene() {
        assert_eq!(folder(None, Path::new("a/b.toml"), ""), Path::new("out/b"));
        assert_eq!(folder(None, Path::new("a/b.toml"), "trace"), Path::new("out/b-trace"));
        assert_eq!(folder(Some(&"c".into()), Path::new("a/b.toml"), "trace"), Path::new("c"));
    }
}

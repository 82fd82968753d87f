//! How a verb that computes and writes begins: signals, a folder that can be written to, the console, threads.

use std::path::{Path, PathBuf};

use crate::args::LogArgs;
use crate::failure::{Ending, Failure};
use crate::interrupt::Interrupt;
use crate::size::Bytes;
use crate::stages::Stages;
use crate::{console, folder, memory, threads};

/// What the command line says of it.
pub(crate) struct Start<'a> {
    pub(crate) scene: &'a Path,
    pub(crate) output: Option<&'a PathBuf>,
    pub(crate) threads: Option<u16>,
    pub(crate) memory: Option<Bytes>,
    pub(crate) log: LogArgs,
}

impl Start<'_> {
    /// Runs a verb on its threads, with the folder for its results.
    pub(crate) fn run(
        &self,
        verb: impl FnOnce(&Path, &mut Stages) -> Result<Ending, Failure> + Send,
    ) -> Result<Ending, Failure> {
        let interrupt = Interrupt::install(self.log.log)?;
        let folder = folder::of(self.output, self.scene);
        folder::probe(&folder, "-o DIR")?;
        let console = console::choose(self.log);
        let mut stages = Stages::new(&*console, &interrupt);
        memory::tell(self.memory, &*console);
        let ended = threads::pool(self.threads)?.install(|| verb(&folder, &mut stages));
        memory::conclude(&*console);
        ended
    }

    /// As [`run`](Self::run), for a verb whose stages are of no use without the others: what is interrupted leaves nothing.
    pub(crate) fn run_whole(
        &self,
        name: &str,
        verb: impl FnOnce(&Path, &mut Stages) -> Result<Ending, Failure> + Send,
    ) -> Result<Ending, Failure> {
        self.run(|folder, stages| verb(folder, &mut Stages::part(stages.console, stages.interrupt, name)))
    }
}

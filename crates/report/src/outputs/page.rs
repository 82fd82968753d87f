//! How a solution was found: the record, its plot and the page.

use std::io::{self, Write};

use super::{Contents, Extras, LIGHT_COMMANDS, OutputFile, REPORT, RUN, Wanted};
use crate::catalogue::{CataloguedFile, file};
use crate::{write_convergence, write_run};

/// Residuals over iterations and seconds.
pub(super) struct Convergence;

impl OutputFile for Convergence {
    fn name(&self) -> &'static str {
        "convergence.svg"
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(self.name(), LIGHT_COMMANDS, "residuals over iterations and seconds", &[]))
    }

    fn is_wanted(&self, _: &Wanted) -> bool {
        true
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_convergence(contents.run, out)
    }
}

/// The result on one page.
pub(super) struct Page;

impl OutputFile for Page {
    fn name(&self) -> &'static str {
        REPORT
    }

    fn about(&self) -> Option<CataloguedFile> {
        Some(file(self.name(), "most commands", "the result on one page for the browser", &[]))
    }

    fn is_wanted(&self, wanted: &Wanted) -> bool {
        wanted.page
    }

    fn is_ready(&self, more: &Extras<'_>) -> bool {
        more.report.is_some()
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        contents.page.as_ref().map_or(Ok(()), |page| page.write(out))
    }
}

/// The record.
pub(super) struct Record;

impl OutputFile for Record {
    fn name(&self) -> &'static str {
        RUN
    }

    fn about(&self) -> Option<CataloguedFile> {
        None
    }

    fn is_wanted(&self, _: &Wanted) -> bool {
        true
    }

    fn write(&self, contents: &Contents<'_>, out: &mut dyn Write) -> io::Result<()> {
        write_run(contents.run, out)
    }
}

//! `fredholm view`.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;
use fredholm_report::REPORT;
use fredholm_study::{Error, ErrorKind};

use crate::ending::Ending;
use crate::output;

pub(crate) const EXAMPLES: &str = "\
Examples:
  fredholm view out/cornell_box
  fredholm view out/cornell_box/report.html
  fredholm view F.npz

Where there is no display, the path is printed.";

/// Options of `view`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ViewArgs {
    /// Result folder, or a file in one; or a matrix of view factors
    pub(crate) path: PathBuf,
}

/// Opens the page of a result, or prints where it is.
pub(crate) fn view(args: &ViewArgs) -> Result<Ending, Error> {
    let page = page(&args.path)?;
    if !(has_display() && open(&page)) {
        output::print(&format!("{}\n", page.display()))?;
    }
    Ok(Ending::Done)
}

/// The page of a folder, or of the folder of a file.
fn page(path: &Path) -> Result<PathBuf, Error> {
    let named = path.extension().is_some_and(|ending| ending == "html") && path.is_file();
    let folder = if path.is_dir() { path } else { path.parent().unwrap_or(path) };
    let beside = path.with_extension("html");
    // The page of a matrix has its name.
    let own = path.is_file() && beside.is_file();
    let page = if named {
        path.to_owned()
    } else if own {
        beside
    } else {
        folder.join(REPORT)
    };
    if page.is_file() {
        return Ok(std::path::absolute(&page).unwrap_or(page));
    }
    let text = format!("there is no {REPORT} in {}", folder.display());
    let help = "compute the results again, without --no-report";
    Err(Error::new(ErrorKind::Files, text).with_help(help))
}

/// Whether there is a screen to open a page on.
fn has_display() -> bool {
    let set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    cfg!(any(windows, target_os = "macos")) || set("DISPLAY") || set("WAYLAND_DISPLAY")
}

/// Hands the page to what the system opens pages with, and tells whether there is such a thing.
fn open(page: &Path) -> bool {
    let mut opener = if cfg!(windows) {
        let mut start = Command::new("explorer");
        start.arg(page);
        start
    } else {
        let mut start = Command::new(if cfg!(target_os = "macos") { "open" } else { "xdg-open" });
        start.arg(page);
        start
    };
    let status = opener.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    // The file manager of Windows ends with 1 where it has done what it was asked for.
    status.is_ok_and(|status| status.success() || cfg!(windows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_and_its_files_lead_to_the_page() {
        let folder = tempfile::tempdir().unwrap();
        let expected = folder.path().join(REPORT);
        let refused = page(folder.path()).unwrap_err();
        assert_eq!(refused.kind(), ErrorKind::Files);
        std::fs::write(&expected, "x").unwrap();
        std::fs::write(folder.path().join("run.json"), "{}").unwrap();
        let matrix = folder.path().join("F.npz");
        std::fs::write(&matrix, "x").unwrap();
        assert_eq!(page(&matrix).unwrap(), expected);
        std::fs::write(folder.path().join("F.html"), "x").unwrap();
        assert_eq!(page(&matrix).unwrap(), folder.path().join("F.html"));
        for path in [folder.path().to_owned(), expected.clone(), folder.path().join("run.json")] {
            assert_eq!(page(&path).unwrap(), expected);
        }
    }
}

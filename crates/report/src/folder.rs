//! The place that the files of one run go to: locked while it runs, rid of what earlier runs have
//! left.
//!
//! A hidden file, `.fredholm`, lists the files that runs have written into the folder, and carries
//! the lock of the run that writes. The lock is the system's (`flock`, `LockFileEx`), so that it
//! ends with the process that holds it, however that ends. Before its first file a run removes all
//! that is listed: a record never stands beside the files of another run. What is not listed is
//! left alone; where it has the name of a result, the folder is refused before anything is
//! computed.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::mem;
use std::path::{Component, Path, PathBuf};
use std::process;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use crate::ReportError;
use crate::atomic::{TEMPORARY_ENDING, write_with_prefix};
use crate::names::is_result;
use crate::viewfactors::ViewFactorFiles;

/// Name of the list of a folder, and ending of the lists of single files.
const LIST_NAME: &str = ".fredholm";

/// What this process has claimed, for [`exit`].
static CLAIMS: Mutex<Vec<Weak<Claim>>> = Mutex::new(Vec::new());

/// A folder, or the name of a matrix, that one run writes to. All clones are the same run; the lock
/// is released with the last of them. One to which nothing was written leaves nothing behind.
///
/// # Examples
/// ```
/// use fredholm_report::{ReportError, ResultFolder};
/// let base = tempfile::tempdir()?;
/// let folder = ResultFolder::claim(base.path().join("new"))?;
/// assert!(matches!(ResultFolder::claim(base.path().join("new")), Err(ReportError::Busy { .. })));
/// folder.write("note.txt", |out| writeln!(out, "whole"))?;
/// drop(folder);
/// // The next run removes what this one has written.
/// ResultFolder::claim(base.path().join("new"))?.begin()?;
/// assert!(!base.path().join("new/note.txt").exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ResultFolder(Arc<Claim>);

#[derive(Debug)]
struct Claim {
    folder: PathBuf,
    /// Path of the list, and the open file that carries the lock.
    list: PathBuf,
    file: File,
    /// Whether files are added beside the result that may be there.
    adds: bool,
    /// Folders that were made for this run, the deepest first.
    made: Vec<PathBuf>,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    listed: BTreeSet<String>,
    kept: BTreeSet<String>,
    begun: bool,
}

impl ResultFolder {
    /// Claims a folder for a run; it is made where it does not exist.
    ///
    /// # Errors
    /// [`ReportError::Busy`] while another run writes there, [`ReportError::Occupied`] for a folder
    /// with a file of the name of a result that no run is known to have written,
    /// [`ReportError::Write`] where nothing can be written.
    pub fn claim(folder: impl AsRef<Path>) -> Result<Self, ReportError> {
        let claim = Claim::lock(folder.as_ref(), LIST_NAME.into(), false)?;
        let entries = fs::read_dir(&claim.folder).map_err(read_failure(&claim.folder))?;
        let names = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
        claim.refuse(names.filter(|name| is_result(name)))?;
        Ok(Self(claim))
    }

    /// Claims the names of a matrix of view factors and of what comes beside it; other files of the
    /// folder are free.
    ///
    /// # Errors
    /// As [`claim`](Self::claim).
    pub fn of_matrix(files: &ViewFactorFiles) -> Result<Self, ReportError> {
        let stem = files.matrix.file_stem().unwrap_or_default();
        let mut list = OsString::from(".");
        list.push(stem);
        list.push(LIST_NAME);
        let claim = Claim::lock(folder_of(&files.matrix), list, false)?;
        let all = [&files.matrix, &files.picture, &files.histogram, &files.page, &files.record];
        let name = |path: &PathBuf| Some(path.file_name()?.to_string_lossy().into_owned());
        claim.refuse(all.into_iter().filter(|path| path.exists()).filter_map(name))?;
        let ours: BTreeSet<String> = all.into_iter().filter_map(name).collect();
        let mut state = claim.state();
        // The same matrix in another form stays.
        state.kept = state.listed.difference(&ours).cloned().collect();
        drop(state);
        Ok(Self(claim))
    }

    /// Claims a folder to add files that are no result: nothing there is removed, and the files of
    /// a result are not replaced.
    ///
    /// # Errors
    /// [`ReportError::Busy`] and [`ReportError::Write`] as for [`claim`](Self::claim).
    pub fn to_add(folder: impl AsRef<Path>) -> Result<Self, ReportError> {
        Ok(Self(Claim::lock(folder.as_ref(), LIST_NAME.into(), true)?))
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0.folder
    }

    /// Keeps a file of an earlier run, which this one goes on with.
    pub fn keep(&self, name: &str) {
        self.0.state().kept.insert(name.to_owned());
    }

    /// Removes what earlier runs have left, the records first. What this run writes itself stays:
    /// only the first call does anything, and [`write`](Self::write) makes it.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the file that could not be removed.
    pub fn begin(&self) -> Result<(), ReportError> {
        let mut state = self.0.state();
        if state.begun || self.0.adds {
            return Ok(());
        }
        let mut old: Vec<&String> = state.listed.difference(&state.kept).collect();
        old.sort_by_key(|name| !is_record(name));
        // One that cannot be removed keeps no other from being so.
        let removed: Vec<_> = old.into_iter().map(|name| self.0.remove(name)).collect();
        removed.into_iter().collect::<Result<(), _>>()?;
        if state.kept.is_empty() {
            self.0.file.set_len(0).map_err(write_failure(&self.0.list))?;
            state.listed.clear();
        }
        state.begun = true;
        Ok(())
    }

    /// Writes a file whole or not at all; `fill` writes the contents. Folders that its name goes
    /// through are made. Returns its path.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path, [`ReportError::Occupied`] for a file that is added
    /// where a result has one.
    pub fn write<F>(&self, name: &str, fill: F) -> Result<PathBuf, ReportError>
    where
        F: FnOnce(&mut dyn Write) -> io::Result<()>,
    {
        self.begin()?;
        let path = self.0.folder.join(name);
        self.0.list(name)?;
        if let Some(parent) = Path::new(name).parent().filter(|parent| !parent.as_os_str().is_empty()) {
            let parent = self.0.folder.join(parent);
            fs::create_dir_all(&parent).map_err(write_failure(&parent))?;
        }
        write_with_prefix(&path, &self.0.prefix(), fill)?;
        Ok(path)
    }

    /// Removes a file of this run, if it is there.
    ///
    /// # Errors
    /// [`ReportError::Write`] with the path.
    pub fn remove(&self, name: &str) -> Result<(), ReportError> {
        self.0.remove(name)
    }
}

impl Claim {
    /// Makes the folder, locks its list and reads it; files that a killed run has not finished are
    /// removed.
    fn lock(folder: &Path, list: OsString, adds: bool) -> Result<Arc<Self>, ReportError> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let made: Vec<PathBuf> = folder
            .ancestors()
            .take_while(|above| !above.as_os_str().is_empty() && !above.exists())
            .map(Path::to_owned)
            .collect();
        let list = folder.join(list);
        let file = locked(folder, &list)?;
        let (folder, state) = (folder.to_owned(), Mutex::default());
        let claim = Arc::new(Self { folder, list, file, adds, made, state });
        let mut claims = CLAIMS.lock().unwrap_or_else(PoisonError::into_inner);
        claims.retain(|known| known.strong_count() > 0);
        claims.push(Arc::downgrade(&claim));
        drop(claims);
        let mut text = String::new();
        (&claim.file).read_to_string(&mut text).map_err(read_failure(&claim.list))?;
        claim.state().listed = text.lines().filter(|name| is_inside(name)).map(str::to_owned).collect();
        claim.sweep()?;
        Ok(claim)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How the names of unfinished files of this place begin.
    fn prefix(&self) -> String {
        self.list.file_name().map_or_else(String::new, |name| format!("{}-", name.to_string_lossy()))
    }

    /// Removes unfinished files: whoever began them is gone, else the lock would be taken.
    fn sweep(&self) -> Result<(), ReportError> {
        let prefix = self.prefix();
        let below: BTreeSet<PathBuf> = self
            .state()
            .listed
            .iter()
            .filter_map(|name| Some(self.folder.join(Path::new(name).parent()?)))
            .collect();
        for folder in std::iter::once(self.folder.clone()).chain(below) {
            for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
                let name = entry.file_name().to_string_lossy().into_owned();
                if name.starts_with(&prefix) && name.ends_with(TEMPORARY_ENDING) {
                    removed(&entry.path())?;
                }
            }
        }
        Ok(())
    }

    /// Refuses the first of some names that is not listed.
    fn refuse(&self, names: impl Iterator<Item = String>) -> Result<(), ReportError> {
        let state = self.state();
        match names.filter(|name| !state.listed.contains(name)).min() {
            Some(name) => Err(ReportError::Occupied { path: self.folder.join(name) }),
            None => Ok(()),
        }
    }

    /// Lists a name before its file is there. What is added beside a result is not listed, and may
    /// not replace it.
    fn list(&self, name: &str) -> Result<(), ReportError> {
        let mut state = self.state();
        if self.adds {
            let taken = state.listed.contains(name) && self.folder.join(name).exists();
            return if taken { Err(ReportError::Occupied { path: self.folder.join(name) }) } else { Ok(()) };
        }
        if state.listed.insert(name.to_owned()) {
            let written = (&self.file).write_all(format!("{name}\n").as_bytes());
            written.and_then(|()| self.file.sync_data()).map_err(write_failure(&self.list))?;
        }
        Ok(())
    }

    /// Leaves a place that nothing was written to as it was found.
    fn leave(&self, state: &State) {
        // Elsewhere a list that is waited for could not be told from a new one.
        if cfg!(unix) && state.listed.is_empty() {
            let _ = fs::remove_file(&self.list);
            self.made.iter().for_each(|made| drop(fs::remove_dir(made)));
        }
    }

    /// Removes a file, and the folders within this one that it leaves empty.
    fn remove(&self, name: &str) -> Result<(), ReportError> {
        removed(&self.folder.join(name))?;
        let within = Path::new(name).ancestors().skip(1).filter(|within| !within.as_os_str().is_empty());
        within.for_each(|within| drop(fs::remove_dir(self.folder.join(within))));
        Ok(())
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        self.leave(&self.state());
    }
}

/// Ends the process at once, with this exit code, while other threads may still compute. Places
/// that nothing was written to are left as they were found, which their claims would do if they
/// were dropped.
pub fn exit(code: i32) -> ! {
    let claims = CLAIMS.lock().unwrap_or_else(PoisonError::into_inner);
    for claim in claims.iter().filter_map(Weak::upgrade) {
        // Where the state is in use, a file is just being listed, and there is something to keep.
        if let Ok(state) = claim.state.try_lock() {
            claim.leave(&state);
            // Nothing is written there any more: whoever would list a file waits for the end.
            mem::forget(state);
        }
        // The last one would wait for the state.
        mem::forget(claim);
    }
    process::exit(code)
}

/// The list, locked. Where the file system knows no locks nothing keeps two runs apart.
fn locked(folder: &Path, list: &Path) -> Result<File, ReportError> {
    loop {
        fs::create_dir_all(folder).map_err(write_failure(folder))?;
        let opened = OpenOptions::new().read(true).append(true).create(true).open(list);
        let file = match opened {
            // A run that wrote nothing has just removed the folder that it had made.
            Err(error) if error.kind() == io::ErrorKind::NotFound && !folder.exists() => continue,
            opened => opened.map_err(write_failure(list))?,
        };
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            return Err(ReportError::Busy { path: folder.to_owned() });
        }
        if is_at(&file, list) {
            return Ok(file);
        }
    }
}

/// Whether a file is still the one at a path, from which the run before may have removed it.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |found: io::Result<fs::Metadata>| found.map(|found| (found.dev(), found.ino())).ok();
    let open = id(file.metadata());
    open.is_some() && open == id(fs::metadata(path))
}

#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

fn is_record(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending == "json")
}

/// Whether a name is that of something within the folder.
fn is_inside(name: &str) -> bool {
    let mut parts = Path::new(name).components().peekable();
    parts.peek().is_some() && parts.all(|part| matches!(part, Component::Normal(_)))
}

/// Removes a file, if it is there.
fn removed(path: &Path) -> Result<(), ReportError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(write_failure(path)(source)),
        _ => Ok(()),
    }
}

fn write_failure(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_owned();
    |source| ReportError::Write { path, source }
}

fn read_failure(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_owned();
    |source| ReportError::Read { path, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn put(folder: &ResultFolder, name: &str) {
        folder.write(name, |out| out.write_all(name.as_bytes())).unwrap();
    }

    #[test]
    fn a_run_removes_what_others_wrote_and_nothing_else() {
        let base = tempfile::tempdir().unwrap();
        let first = ResultFolder::claim(base.path()).unwrap();
        for name in ["run.json", "a.svg", "below/b.ply"] {
            put(&first, name);
        }
        drop(first);
        fs::write(base.path().join("mine.txt"), "x").unwrap();
        let second = ResultFolder::claim(base.path()).unwrap();
        assert!(base.path().join("run.json").exists(), "nothing is removed before the first file");
        put(&second, "c.csv");
        put(&second, "run.json");
        assert_eq!(entries(base.path()), [".fredholm", "c.csv", "mine.txt", "run.json"]);
    }

    #[test]
    fn what_a_run_goes_on_with_stays() {
        let base = tempfile::tempdir().unwrap();
        let first = ResultFolder::claim(base.path()).unwrap();
        for name in ["trace.json", "a.svg"] {
            put(&first, name);
        }
        drop(first);
        let second = ResultFolder::claim(base.path()).unwrap();
        second.keep("trace.json");
        put(&second, "b.csv");
        drop(second);
        assert_eq!(entries(base.path()), [".fredholm", "b.csv", "trace.json"]);
        // It is still known as the file of a run.
        ResultFolder::claim(base.path()).unwrap().begin().unwrap();
        assert_eq!(entries(base.path()), [""; 0]);
    }

    #[test]
    fn one_run_at_a_time() {
        let base = tempfile::tempdir().unwrap();
        let first = ResultFolder::claim(base.path()).unwrap();
        let clone = first.clone();
        drop(first);
        let busy = |found| matches!(found, Err(ReportError::Busy { .. }));
        assert!(busy(ResultFolder::claim(base.path())) && busy(ResultFolder::to_add(base.path())));
        drop(clone);
        assert!(ResultFolder::claim(base.path()).is_ok());
    }

    #[test]
    fn a_place_without_files_is_left_as_it_was() {
        let base = tempfile::tempdir().unwrap();
        drop(ResultFolder::claim(base.path().join("a/b")).unwrap());
        drop(ResultFolder::to_add(base.path()).unwrap());
        assert_eq!(entries(base.path()), [""; 0]);
    }

    #[test]
    fn unfinished_files_are_removed() {
        let base = tempfile::tempdir().unwrap();
        let (left, other) = (base.path().join(".fredholm-x1.tmp"), base.path().join(".F.fredholm-x1.tmp"));
        for path in [&left, &other] {
            fs::write(path, "x").unwrap();
        }
        drop(ResultFolder::claim(base.path()).unwrap());
        assert!(!left.exists() && other.exists(), "a matrix beside may be in the making");
    }

    #[test]
    fn results_of_no_known_run_are_not_overwritten() {
        for name in ["faces.csv", "shot_00010.png", "trace.json"] {
            let base = tempfile::tempdir().unwrap();
            fs::write(base.path().join(name), "x").unwrap();
            let error = ResultFolder::claim(base.path()).unwrap_err();
            assert!(
                matches!(error, ReportError::Occupied { .. }) && error.to_string().contains(name),
                "{error}"
            );
            assert_eq!(entries(base.path()), [name]);
        }
    }

    #[test]
    fn a_file_is_added_beside_a_result_but_not_in_its_place() {
        let base = tempfile::tempdir().unwrap();
        put(&ResultFolder::claim(base.path()).unwrap(), "field.ply");
        let added = ResultFolder::to_add(base.path()).unwrap();
        put(&added, "scene.ply");
        assert!(matches!(added.write("field.ply", |_| Ok(())), Err(ReportError::Occupied { .. })));
        drop(added);
        ResultFolder::claim(base.path()).unwrap().begin().unwrap();
        assert_eq!(entries(base.path()), ["scene.ply"]);
    }

    #[test]
    fn a_list_reaches_no_file_elsewhere() {
        let base = tempfile::tempdir().unwrap();
        let (folder, outside) = (base.path().join("a"), base.path().join("outside.txt"));
        fs::create_dir(&folder).unwrap();
        fs::write(&outside, "x").unwrap();
        fs::write(folder.join(LIST_NAME), format!("../outside.txt\n{}\n\n", outside.display())).unwrap();
        ResultFolder::claim(&folder).unwrap().begin().unwrap();
        assert!(outside.exists());
    }
}

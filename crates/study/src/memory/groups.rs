//! What the control groups of this process leave it (Linux, Documentation/admin-guide/cgroup-v2.rst
//! and cgroup-v1/memory.rst).
//!
//! A group holds no more than each of the groups above it may. What files are cached counts as used
//! there, but is given back when memory is short, so that it is not taken off the limit.

use std::fs;
use std::path::{Path, PathBuf};

/// Files of one version.
struct Version {
    second: bool,
    limits: &'static [&'static str],
    used: &'static str,
    /// Lines of `memory.stat` with the bytes of cached files.
    cached: [&'static str; 2],
}

const SECOND_VERSION: Version = Version {
    second: true,
    limits: &["memory.max", "memory.high"],
    used: "memory.current",
    cached: ["active_file", "inactive_file"],
};
const FIRST_VERSION: Version = Version {
    second: false,
    limits: &["memory.limit_in_bytes"],
    used: "memory.usage_in_bytes",
    cached: ["total_active_file", "total_inactive_file"],
};

/// The least that any group may still take, bytes; none where no group has a limit.
pub(super) fn left(root: &Path) -> Option<u128> {
    let read = |path: &str| fs::read_to_string(root.join(path)).unwrap_or_default();
    let (groups, mounts) = (read("proc/self/cgroup"), read("proc/self/mountinfo"));
    let hierarchies = mounts.lines().filter_map(|line| {
        let (version, within, point) = mount(line)?;
        let group = group_of(&groups, version.second)?;
        Some((version, within, point, group))
    });
    hierarchies
        .filter_map(|(version, within, point, group)| {
            let top = root.join(point.trim_start_matches('/'));
            // In a container the group may lie outside of what is mounted: then the mount is the
            // group.
            let below =
                group.strip_prefix(within.trim_end_matches('/')).unwrap_or("").trim_start_matches('/');
            let mut folder = top.join(below);
            if !folder.is_dir() {
                folder.clone_from(&top);
            }
            upwards(&folder, &top).filter_map(|folder| version.left(&folder)).min()
        })
        .min()
}

/// A folder and those above it, up to the top.
fn upwards(folder: &Path, top: &Path) -> impl Iterator<Item = PathBuf> {
    let all: Vec<PathBuf> =
        folder.ancestors().take_while(|f| f.starts_with(top)).map(Path::to_owned).collect();
    all.into_iter()
}

/// Version, root and mount point of a mounted hierarchy that rules over memory.
fn mount(line: &str) -> Option<(&'static Version, &str, &str)> {
    let (place, kind) = line.split_once(" - ")?;
    let place: Vec<&str> = place.split(' ').collect();
    let (root, point) = (*place.get(3)?, *place.get(4)?);
    let mut kind = kind.split(' ');
    match kind.next()? {
        "cgroup2" => Some((&SECOND_VERSION, root, point)),
        "cgroup" if kind.nth(1)?.split(',').any(|option| option == "memory") => {
            Some((&FIRST_VERSION, root, point))
        }
        _ => None,
    }
}

/// The group of this process, from lines `number:controllers:path`.
fn group_of(groups: &str, second: bool) -> Option<&str> {
    groups.lines().find_map(|line| {
        let mut parts = line.splitn(3, ':');
        let (_, controllers, path) = (parts.next()?, parts.next()?, parts.next()?);
        let wanted =
            if second { controllers.is_empty() } else { controllers.split(',').any(|name| name == "memory") };
        wanted.then_some(path)
    })
}

impl Version {
    /// What one group may still take.
    fn left(&self, folder: &Path) -> Option<u128> {
        let text = |name: &str| fs::read_to_string(folder.join(name)).ok();
        let number = |name: &str| text(name)?.trim().parse::<u128>().ok();
        let limit = self.limits.iter().filter_map(|name| number(name)).min()?;
        let stat = text("memory.stat").unwrap_or_default();
        let cached = |name: &&str| {
            let line = stat.lines().find_map(|line| line.strip_prefix(*name)?.strip_prefix(' '));
            line.and_then(|number| number.trim().parse::<u128>().ok()).unwrap_or(0)
        };
        let used = number(self.used)?.saturating_sub(self.cached.iter().map(cached).sum());
        Some(limit.saturating_sub(used))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file system with these files.
    fn system(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    #[test]
    fn the_least_of_a_group_and_those_above_it_is_left() {
        let mounts = "31 23 0:28 / /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw\n";
        let root = system(&[
            ("proc/self/cgroup", "0::/a/b\n"),
            ("proc/self/mountinfo", mounts),
            ("sys/fs/cgroup/a/memory.max", "1000\n"),
            ("sys/fs/cgroup/a/memory.high", "900\n"),
            ("sys/fs/cgroup/a/memory.current", "800\n"),
            ("sys/fs/cgroup/a/memory.stat", "anon 5\nactive_file 300\ninactive_file 100\n"),
            ("sys/fs/cgroup/a/b/memory.max", "max\n"),
            ("sys/fs/cgroup/a/b/memory.current", "700\n"),
        ]);
        assert_eq!(left(root.path()), Some(500), "900 of which 400 are in use and 400 are caches");
        fs::write(root.path().join("sys/fs/cgroup/a/b/memory.max"), "710\n").unwrap();
        assert_eq!(left(root.path()), Some(10));
        fs::write(root.path().join("sys/fs/cgroup/a/b/memory.max"), "1\n").unwrap();
        assert_eq!(left(root.path()), Some(0));
    }

    #[test]
    fn the_first_version_is_read_where_memory_is_ruled_by_it() {
        let mounts = "32 31 0:29 / /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu\n\
             35 31 0:32 /box /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n";
        let root = system(&[
            ("proc/self/cgroup", "4:memory:/box\n1:cpu:/other\n0::/\n"),
            ("proc/self/mountinfo", mounts),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "4096\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "1024\n"),
            ("sys/fs/cgroup/memory/memory.stat", "total_active_file 20\ntotal_inactive_file 4\n"),
        ]);
        assert_eq!(left(root.path()), Some(4096 - 1000));
        // A group outside of what is mounted.
        fs::write(root.path().join("proc/self/cgroup"), "4:memory:/elsewhere/deep\n").unwrap();
        assert_eq!(left(root.path()), Some(4096 - 1000));
    }

    #[test]
    fn no_limit_is_none() {
        assert_eq!(left(system(&[]).path()), None);
        let mounts = "31 23 0:28 / /sys/fs/cgroup rw - cgroup2 cgroup2 rw\n";
        let root = system(&[("proc/self/cgroup", "0::/\n"), ("proc/self/mountinfo", mounts)]);
        assert_eq!(left(root.path()), None);
    }
}

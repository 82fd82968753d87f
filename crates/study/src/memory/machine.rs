//! What memory the system has and what it lets this process have, from Linux's `/proc` and `/sys`.

use std::fs;
use std::path::Path;

use super::groups;
use crate::size::Bytes;

/// What was there when the process looked first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Machine {
    /// Resident memory of this process.
    pub(super) resident: u128,
    /// What all processes may still take.
    pub(super) available: Option<u128>,
    /// What the control group may still take.
    pub(super) group: Option<u128>,
    /// What this process may still map (`ulimit -v`).
    pub(super) address_space: Option<u128>,
    /// What this process may still map for data (`ulimit -d`).
    pub(super) data: Option<u128>,
}

impl Machine {
    /// Reads the files below `root`, which is `/` but for tests. What the system does not tell is
    /// left out.
    pub(super) fn read(root: &Path) -> Self {
        let text = |path: &str| fs::read_to_string(root.join(path)).unwrap_or_default();
        let (status, limits) = (text("proc/self/status"), text("proc/self/limits"));
        let held = |name| field(&status, name).map_or(0, |Bytes(bytes)| bytes);
        let left = |name, mapped| soft(&limits, name).map(|limit| limit.saturating_sub(held(mapped)));
        Self {
            resident: held("VmRSS"),
            available: field(&text("proc/meminfo"), "MemAvailable").map(|Bytes(bytes)| bytes),
            group: groups::left(root),
            address_space: left("Max address space", "VmSize"),
            data: left("Max data size", "VmData"),
        }
    }
}

/// Finds the line `name:  number kB`, where kB means 1024 bytes.
pub(super) fn field(text: &str, name: &str) -> Option<Bytes> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    let kilobytes: u128 = rest.split_whitespace().next()?.parse().ok()?;
    Some(Bytes(kilobytes * 1024))
}

/// The soft limit of a line of `/proc/self/limits`, bytes; none where there is none.
fn soft(text: &str, name: &str) -> Option<u128> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    rest.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_named_line_is_read() {
        let text = "MemTotal:  9 kB\nMemAvailable:    1024 kB\nBroken: x kB\n";
        assert_eq!(field(text, "MemAvailable"), Some(Bytes(1 << 20)));
        assert_eq!(field(text, "Mem"), None);
        assert_eq!(field(text, "Broken"), None);
    }

    #[test]
    fn what_is_mapped_already_is_taken_off_the_limits() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("proc/self");
        fs::create_dir_all(&folder).unwrap();
        fs::write(root.path().join("proc/meminfo"), "MemAvailable:  9000 kB\n").unwrap();
        fs::write(folder.join("status"), "VmSize:\t 100 kB\nVmRSS:\t 10 kB\nVmData:\t 20 kB\n").unwrap();
        let limits = "Limit                     Soft Limit           Hard Limit           Units     \n\
             Max data size             20480                unlimited            bytes     \n\
             Max address space         204800               unlimited            bytes     \n";
        fs::write(folder.join("limits"), limits).unwrap();
        let expected = Machine {
            resident: 10 << 10,
            available: Some(9000 << 10),
            group: None,
            address_space: Some(100 << 10),
            data: Some(0),
        };
        assert_eq!(Machine::read(root.path()), expected);
        fs::write(folder.join("limits"), limits.replace("20480 ", "unlimited ")).unwrap();
        assert_eq!(Machine::read(root.path()).data, None);
        assert_eq!(Machine::read(&root.path().join("none")), Machine::default());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_machine_has_memory() {
        let machine = Machine::read(Path::new("/"));
        assert!(machine.resident > 100_000 && machine.available > Some(1_000_000), "{machine:?}");
    }
}

//! What memory the system has and what this process took of it, from Linux's `/proc`.

use std::fs;

use crate::size::Bytes;

/// Share of the available memory that is used where no limit is given.
const SHARE: f64 = 0.8;
/// Limit where the system does not tell what is available.
const FALLBACK: Bytes = Bytes(4 << 30);

/// The limit where none is given: 80 % of what is available.
pub(crate) fn default_limit() -> Bytes {
    let available = field("/proc/meminfo", "MemAvailable");
    available.map_or(FALLBACK, |Bytes(bytes)| Bytes((bytes as f64 * SHARE) as u128))
}

/// Largest memory this process has held so far, where the system tells.
pub(crate) fn peak() -> Option<Bytes> {
    field("/proc/self/status", "VmHWM")
}

fn field(path: &str, name: &str) -> Option<Bytes> {
    parse(&fs::read_to_string(path).ok()?, name)
}

/// Finds the line `name:  number kB`, where kB means 1024 bytes.
fn parse(text: &str, name: &str) -> Option<Bytes> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'))?;
    let kilobytes: u128 = rest.split_whitespace().next()?.parse().ok()?;
    Some(Bytes(kilobytes * 1024))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_named_line_is_read() {
        let text = "MemTotal:  9 kB\nMemAvailable:    1024 kB\nBroken: x kB\n";
        assert_eq!(parse(text, "MemAvailable"), Some(Bytes(1 << 20)));
        assert_eq!(parse(text, "Mem"), None);
        assert_eq!(parse(text, "Broken"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn this_process_has_a_peak_below_what_there_is() {
        let peak = peak().unwrap();
        assert!(peak > Bytes(100_000) && default_limit() > Bytes(0));
    }
}

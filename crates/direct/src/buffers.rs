//! The buffers in which faer puts blocks together for its products.
//!
//! Every thread that multiplies keeps two of them for good, each as large as the last cache
//! (private-gemm-x86, `gemm` in src/lib.rs). It touches only what a product packs: half a thousand
//! rows or columns at a time.

use std::fs;
use std::path::{Path, PathBuf};

/// Rows or columns that are packed at a time.
const ROWS_PACKED: u64 = 512;
/// Least size that faer takes the last cache for, and its multiple of the one before.
const LEAST_CACHE_BYTES: u64 = 2 << 20;
const LEAST_CACHE_RATIO: u64 = 4;

/// Bytes that products of matrices with `dim` rows of entries of `entry` bytes touch.
pub(crate) fn touched(dim: usize, entry: usize) -> u64 {
    (dim as u64).saturating_mul(ROWS_PACKED * entry as u64)
}

/// Bytes of addresses that every thread sets aside for products of dense matrices, and hardly
/// touches.
#[must_use]
pub fn thread_addresses() -> u64 {
    2 * last_cache(Path::new("/sys/devices/system/cpu"))
}

/// Bytes of all last caches of the machine together, as faer counts them.
fn last_cache(folder: &Path) -> u64 {
    let caches: Vec<PathBuf> =
        folders(folder, "cpu").flat_map(|cpu| folders(&cpu.join("cache"), "index")).collect();
    let of = |level: u64| caches.iter().filter_map(move |cache| sizes(cache, level));
    let last: u64 = of(3).map(|[size, sharing]| size / sharing).sum();
    let second = of(2).map(|[size, _]| size).max().unwrap_or(0);
    last.max(LEAST_CACHE_RATIO * second).max(LEAST_CACHE_BYTES)
}

/// Bytes of a cache of this level, and how many processors share it.
fn sizes(cache: &Path, level: u64) -> Option<[u64; 2]> {
    let text = |name: &str| fs::read_to_string(cache.join(name)).ok();
    if text("level")?.trim().parse() != Ok(level) {
        return None;
    }
    let size = text("size")?;
    let size = size.trim();
    let (number, unit) = match size.strip_suffix(['K', 'M', 'G']) {
        Some(number) => (number, size.chars().last()),
        None => (size, None),
    };
    let shift = match unit {
        Some('K') => 10,
        Some('M') => 20,
        Some(_) => 30,
        None => 0,
    };
    Some([number.parse::<u64>().ok()? << shift, processors(&text("shared_cpu_list")?).max(1)])
}

/// Number of processors in a list such as `0-3,8`.
fn processors(list: &str) -> u64 {
    let count = |part: &str| match part.split_once('-') {
        Some((first, last)) => {
            let (first, last): (u64, u64) = (first.parse().ok()?, last.parse().ok()?);
            Some((last + 1).saturating_sub(first))
        }
        None => part.parse::<u64>().ok().map(|_| 1),
    };
    list.trim().split(',').filter_map(count).sum()
}

/// Folders with numbers behind such a name.
fn folders(within: &Path, name: &'static str) -> impl Iterator<Item = PathBuf> + use<> {
    let entries = fs::read_dir(within).into_iter().flatten().filter_map(Result::ok);
    entries.map(|entry| entry.path()).filter(move |path| {
        let found = path.file_name().and_then(|found| found.to_str()).unwrap_or_default();
        let number = found.strip_prefix(name).unwrap_or_default();
        !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processors_are_counted_in_lists() {
        assert_eq!((processors("0-3,8\n"), processors("5"), processors("")), (5, 1, 0));
    }

    #[test]
    fn caches_are_added_up_over_the_processors() {
        let root = std::env::temp_dir().join(format!("fredholm-caches-{}", std::process::id()));
        for cpu in 0..4 {
            let cache = root.join(format!("cpu{cpu}/cache/index3"));
            fs::create_dir_all(&cache).unwrap();
            fs::write(cache.join("level"), "3\n").unwrap();
            fs::write(cache.join("size"), "16M\n").unwrap();
            fs::write(cache.join("shared_cpu_list"), if cpu < 2 { "0-1\n" } else { "2,3\n" }).unwrap();
        }
        let found = last_cache(&root);
        fs::remove_dir_all(&root).unwrap();
        assert_eq!(found, 32 << 20);
        assert_eq!(last_cache(&root), LEAST_CACHE_BYTES);
    }
}

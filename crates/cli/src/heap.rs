//! One heap for all threads where the address space is limited.
//!
//! The C library reserves 64 MiB of addresses for the heap of every thread but the first (glibc,
//! `HEAP_MAX_SIZE` in malloc/arena.c). Under a tight `ulimit -v` that fails, and from then on the
//! thread maps a page or more for every value that it allocates, however small, until the addresses
//! are used up. The library reads how many heaps it may have when the process begins, so that the
//! program has to begin anew to tell it.

/// Number of heaps, as the C library reads it from the environment.
const HEAPS_VARIABLE: &str = "MALLOC_ARENA_MAX";

/// Replaces this process by the same program with one heap where `ulimit -v` is in force. Where
/// that fails the program goes on as it is.
#[cfg(target_os = "linux")]
pub(crate) fn share() {
    use std::os::unix::process::CommandExt;
    use std::process::Command;

    if std::env::var_os(HEAPS_VARIABLE).is_some() || !fredholm_study::addresses_are_limited() {
        return;
    }
    let Ok(program) = std::env::current_exe() else { return };
    let mut arguments = std::env::args_os();
    let mut again = Command::new(program);
    if let Some(name) = arguments.next() {
        again.arg0(name);
    }
    // It returns only where it failed.
    let _ = again.args(arguments).env(HEAPS_VARIABLE, "1").exec();
}

/// Elsewhere nothing is known of the heaps.
#[cfg(not(target_os = "linux"))]
pub(crate) fn share() {}

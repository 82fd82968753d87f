//! The `fredholm` program.

fn main() {}

//! The command line of Fredholm; no mathematics.

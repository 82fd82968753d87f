//! Iterative solvers of (I - K) x = b, one algorithm a file.

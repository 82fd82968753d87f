//! Direct solvers of (I - K) x = b.

//! The contract between couplings and solvers: scalars, multivectors, operators, solvers.

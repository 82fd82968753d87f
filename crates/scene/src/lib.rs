//! Scene files: from TOML and OBJ to a meshed problem.

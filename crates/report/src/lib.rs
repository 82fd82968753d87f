//! What people look at: tables, VTU, NPZ, pictures and plots.

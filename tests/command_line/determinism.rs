//! The same bits with any number of threads.

use std::fs;

use serde_json::Value;

use crate::support::{Bench, room};

const SAME: [&str; 6] = ["field.csv", "faces.csv", "surfaces.csv", "field.vtu", "field.npz", "image.png"];

/// The record without what may differ: times, memory, and the options that say where and by how
/// many.
fn timeless(bench: &Bench, folder: &str) -> Value {
    let mut record = bench.record(folder);
    for key in ["timings", "peak_memory_bytes"] {
        assert!(record.as_object_mut().unwrap().remove(key).is_some(), "{key}");
    }
    for (table, key) in [("history", "seconds"), ("options", "threads"), ("options", "output")] {
        assert!(record[table].as_object_mut().unwrap().remove(key).is_some(), "{key}");
    }
    record
}

/// The curves over iterations: they come before those over seconds. Axes and legend are of another
/// width.
fn curves(bench: &Bench, folder: &str) -> Vec<String> {
    let svg = fs::read_to_string(bench.path(folder).join("convergence.svg")).unwrap();
    let curve = |line: &&str| line.starts_with("<polyline") && line.contains("stroke-width=\"18\"");
    // What is dashed beside them, the tolerance, has the grey of the axes.
    let own = |line: &&str| !line.contains("#626870");
    let curves: Vec<String> = svg.lines().filter(curve).filter(own).map(str::to_owned).collect();
    assert_eq!(curves.len(), 4, "two bands in two panels");
    curves[..2].to_vec()
}

/// A room with a block, a two-sided lamp and a pyramid from a mesh file.
fn furnished() -> Bench {
    let bench = Bench::new(
        &(room(8)
            + "[[surface]]\nname = \"pyramid\"\nmaterial = \"wall\"\n\
               obj = { file = \"pyramid.obj\", scale = 0.4, translate = [1.4, 1.4, 0.2] }\ndivide = [2, 2]\n"),
    );
    let pyramid = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 1\n\
                   f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    fs::write(bench.path("pyramid.obj"), pyramid).unwrap();
    bench
}

#[test]
fn every_file_is_the_same_with_1_2_and_4_threads() {
    for solver in ["gauss-seidel", "southwell", "lu"] {
        let bench = furnished();
        for threads in ["1", "2", "4"] {
            bench.solve(&["--solver", solver, "--threads", threads, "-o", threads]);
            for name in SAME {
                let [one, many] =
                    ["1", threads].map(|folder| fs::read(bench.path(folder).join(name)).unwrap());
                assert!(one == many, "{name} differs with {threads} threads and {solver}");
            }
            // Lines of sight that are free, cut and blocked have all been met.
            let pairs = &bench.record(threads)["pairs"];
            assert!(["gauss", "clipped", "hidden"].iter().all(|kind| pairs[kind].as_u64() > Some(0)));
            assert_eq!(timeless(&bench, "1"), timeless(&bench, threads));
            assert_eq!(curves(&bench, "1"), curves(&bench, threads));
        }
    }
}

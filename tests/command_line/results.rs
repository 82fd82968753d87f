//! The result folder, the summary and what `info` and `check` tell.

use std::fs;

use crate::support::{Bench, furnace, room};

#[test]
fn every_file_is_written_and_info_knows_them() {
    let bench = Bench::new(&room(3));
    let run = bench.solve(&["--quiet"]);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    for name in crate::support::usual_files() {
        let file = format!("out/scene/{name}");
        assert!(fs::metadata(bench.path(&file)).unwrap().len() > 100, "{name}");
        let info = bench.run(&["info", &file]);
        assert_eq!(info.code, 0, "{}", info.stderr);
        assert_eq!(info.stdout, bench.run(&["info", "out/scene"]).stdout);
        assert!(info.stdout.contains("80 elements") && info.stdout.contains("gauss-seidel"));
    }
}

#[test]
fn the_record_is_complete() {
    let bench = Bench::new(&room(3));
    bench.solve(&["--tolerance", "1e-8", "--solver", "southwell", "-o", "here", "--memory", "1GiB"]);
    let record = bench.record("here");
    let expected = serde_json::json!({
        "discretisation": "galerkin-0", "solver": "southwell", "tolerance": 1e-8, "max_iterations": 1000, "form_factor_tolerance": 1e-3,
        "storage": "f64", "threads": record["options"]["threads"], "memory_limit_bytes": 1 << 30,
        "output": "here", "log": "plain", "quiet": false,
    });
    assert_eq!(record["options"], expected);
    assert_eq!(record["counts"]["elements"], 80);
    assert_eq!(
        (&record["counts"]["unknowns"], &record["discretisation"]),
        (&80.into(), &"galerkin-0".into())
    );
    assert_eq!(record["counts"]["matrix_entries"], 80 * 81 / 2);
    assert_eq!(record["scene_sha256"].as_str().unwrap().len(), 64);
    let stages: Vec<_> =
        record["timings"].as_array().unwrap().iter().map(|t| t["stage"].as_str().unwrap()).collect();
    assert_eq!(stages, ["scene", "mesh", "visibility", "assembly", "exposure", "solution", "errors"]);
}

#[test]
fn paths_may_hold_spaces_and_any_letters() {
    let bench = Bench::new("");
    let folder = bench.path("été à Bâle/модели");
    fs::create_dir_all(&folder).unwrap();
    let scene = "[materials.wall]\nreflectance = 0.5\nexitance = 1.0\n[[surface]]\nname = \"Wände, \\\"alle\\\"\"\n\
                 material = \"wall\"\nobj = { file = \"mein haus.obj\" }\ntwo_sided = true\n";
    let walls = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n";
    fs::write(folder.join("ein raum.toml"), scene).unwrap();
    fs::write(folder.join("mein haus.obj"), walls).unwrap();
    let run = bench.run(&["solve", "été à Bâle/модели/ein raum.toml"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let info = bench.run(&["info", "out/ein raum/field.vtu"]);
    assert!(info.stdout.contains("été à Bâle/модели/ein raum.toml"), "{}", info.stdout);
    let surfaces = fs::read_to_string(bench.path("out/ein raum/surfaces.csv")).unwrap();
    assert!(surfaces.contains("\"Wände, \"\"alle\"\"\""), "{surfaces}");
}

#[test]
fn a_second_run_replaces_the_first() {
    let bench = Bench::new(&furnace(1, &[0.5]));
    bench.solve(&[]);
    fs::write(bench.path("out/scene/notes.txt"), "mine").unwrap();
    fs::write(bench.path("scene.toml"), furnace(1, &[0.75])).unwrap();
    bench.solve(&[]);
    let radiosity = crate::support::column(&bench.path("out/scene/field.csv"), "radiosity_b0");
    assert!(radiosity.iter().all(|b| (b - 4.0).abs() < 1e-3), "{radiosity:?}");
    assert_eq!(fs::read(bench.path("out/scene/notes.txt")).unwrap(), b"mine");
    let files = fs::read_dir(bench.path("out/scene")).unwrap().count();
    assert_eq!(files, crate::support::usual_files().count() + 2, "the files, their list and the note");
}

#[test]
fn energy_is_conserved_in_a_closed_room() {
    let bench = Bench::new(&room(3));
    bench.solve(&[]);
    for energy in bench.record("out/scene")["energy"].as_array().unwrap() {
        let [emitted, absorbed, escaped] =
            ["emitted", "absorbed", "escaped"].map(|key| energy[key].as_f64().unwrap());
        assert!((absorbed + escaped - emitted).abs() < 1e-9 * emitted, "{energy}");
        assert!(escaped.abs() < 1e-3 * emitted, "{energy}");
    }
}

#[test]
fn the_solvers_agree() {
    let bench = Bench::new(&room(3));
    let radiosity = |solver| {
        bench.solve(&["--solver", solver]);
        crate::support::column(&bench.path("out/scene/field.csv"), "radiosity_g")
    };
    let reference = radiosity("lu");
    for solver in ["gauss-seidel", "southwell"] {
        for (x, exact) in radiosity(solver).iter().zip(&reference) {
            assert!((x - exact).abs() < 1e-8 * exact, "{solver}: {x} {exact}");
        }
    }
}

#[test]
fn check_predicts_and_writes_nothing() {
    let bench = Bench::new(&furnace(4, &[0.5]));
    let run = bench.run(&["check", "scene.toml"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    for figure in ["96 elements", "memory", "time"] {
        assert!(run.stdout.contains(figure), "no {figure}: {}", run.stdout);
    }
    assert_eq!(fs::read_dir(bench.folder.path()).unwrap().count(), 1);
}

#[test]
fn progress_stays_on_standard_error() {
    let bench = Bench::new(&room(3));
    let plain = bench.solve(&[]);
    assert!(plain.stdout.contains("image.png") && plain.stderr.contains("assembly: done in"));
    let json = bench.solve(&["--log", "json"]);
    let lines = json.stderr.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    assert!(lines.filter(|line| line["event"] == "end").count() >= 6);
}

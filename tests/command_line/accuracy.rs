//! Runs to an accuracy: results as of any other run, an error that is stated and held, the same
//! bits for any number of threads and after a stop.

use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::support::{Bench, column, furnace, program, room};

const SAME: [&str; 10] = [
    "field.csv",
    "faces.csv",
    "surfaces.csv",
    "field.vtu",
    "field.npz",
    "image.png",
    "mesh.png",
    "links.png",
    "pixels.npz",
    "points.csv",
];

/// What is gathered.
const GATHER: [&str; 3] = ["--final-gather", "--point", "1,1.3,0.1,0.2,-0.3,0.9"];

fn same(bench: &Bench, one: &str, other: &str) {
    for name in SAME {
        let [a, b] = [one, other].map(|folder| fs::read(bench.path(folder).join(name)).unwrap());
        assert!(a == b, "{name} of {one} and {other}");
    }
    let [a, b] = [one, other].map(|folder| bench.record(folder)["hierarchy"].clone());
    assert!(a == b && a["rounds"].as_array().unwrap().len() >= 2);
}

#[test]
fn an_accuracy_is_reached_and_stated() {
    let bench = Bench::new(&room(8));
    bench.solve(&["--accuracy", "2%", "-o", "out"]);
    let record = bench.record("out");
    let stated = record["hierarchy"]["stated"].as_f64().unwrap();
    assert!(stated > 0.0 && stated <= 0.02, "{stated}");
    assert_eq!(record["discretisation"], "hierarchical");
    assert_eq!(record["options"]["accuracy"], 0.02);
    assert!(!bench.path("out").join("checkpoint.bin").exists());
    for energy in record["energy"].as_array().unwrap() {
        let number = |name: &str| energy[name].as_f64().unwrap();
        let balance = (number("absorbed") + number("escaped")) / number("emitted") - 1.0;
        assert!(balance.abs() < stated, "{energy}");
    }
}

#[test]
fn rays_reach_an_accuracy_with_the_error_that_they_state() {
    let bench = Bench::new(&room(4));
    bench.solve(&["--accuracy", "0.5%", "--way", "links", "-o", "links"]);
    for threads in ["1", "2", "4"] {
        bench.solve(&["--accuracy", "2%", "--way", "rays", "--threads", threads, "-o", threads]);
        for name in ["field.csv", "faces.csv", "image.png"] {
            let [one, other] = ["1", threads].map(|folder| fs::read(bench.path(folder).join(name)).unwrap());
            assert!(one == other, "{name} with {threads} threads");
        }
    }
    let record = bench.record("1");
    assert!(record["choice"].as_str().unwrap().starts_with("rays"), "{}", record["choice"]);
    for (band, name) in ["irradiance_r", "irradiance_g"].iter().enumerate() {
        let stated = record["mesh_error"]["relative_l2"][band].as_f64().unwrap();
        assert!(stated > 0.0 && stated <= 0.02, "{stated}");
        let [areas, found] = ["area", name].map(|name| column(&bench.path("1/faces.csv"), name));
        let known = column(&bench.path("links/faces.csv"), name);
        let sum = |of: &dyn Fn(usize) -> f64| (0..areas.len()).map(|k| areas[k] * of(k)).sum::<f64>();
        let error = (sum(&|k| (found[k] - known[k]).powi(2)) / sum(&|k| known[k].powi(2))).sqrt();
        assert!(error < stated && error > 1e-4, "{error}, stated {stated}");
    }
    for wrong in [&["--way", "rays"][..], &["--accuracy", "1%", "--way", "rays", "--goal", "lamp"]] {
        let run = bench.run(&[&["solve", "scene.toml"], wrong].concat());
        assert!(run.code == 2 && run.stderr.contains("help: "), "{}", run.stderr);
    }
}

#[test]
fn the_scene_may_ask_for_an_accuracy() {
    let bench = Bench::new(&(room(4) + "[solve]\naccuracy = 0.05\n"));
    bench.solve(&["-o", "out"]);
    assert_eq!(bench.record("out")["hierarchy"]["accuracy"], 0.05);
}

#[test]
fn results_are_the_same_with_1_2_and_4_threads() {
    let bench = Bench::new(&room(8));
    for threads in ["1", "2", "4"] {
        bench.solve(&[&["--accuracy", "0.02", "--threads", threads, "-o", threads], &GATHER[..]].concat());
        same(&bench, "1", threads);
    }
}

/// Starts a run and kills it a while after its first checkpoint; whether the run was still under
/// way.
fn killed_after_a_round(bench: &Bench, more: &[&str], pause: Duration) -> bool {
    let mut command = Command::new(program());
    command.current_dir(bench.folder.path()).args([
        "solve",
        "scene.toml",
        "--accuracy",
        "1%",
        "-o",
        "killed",
    ]);
    command.args(GATHER).args(more);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let checkpoint = bench.path("killed").join("checkpoint.bin");
    while !checkpoint.exists() && child.try_wait().unwrap().is_none() {
        sleep(Duration::from_millis(1));
    }
    sleep(pause);
    let _ = child.kill();
    child.wait().unwrap();
    checkpoint.exists()
}

#[test]
fn a_killed_run_is_resumed_to_the_same_bits() {
    let bench = Bench::new(&room(8));
    for (more, pauses) in [(&[][..], &[0, 0, 10, 40][..]), (&["--goal", "block"], &[0, 10])] {
        bench.solve(&[&["--accuracy", "1%", "-o", "whole"], &GATHER[..], more].concat());
        let mut resumed = 0;
        for &pause in pauses {
            if killed_after_a_round(&bench, more, Duration::from_millis(pause)) {
                assert_eq!(bench.run(&["resume", "killed"]).code, 0);
                same(&bench, "whole", "killed");
                resumed += 1;
            }
            fs::remove_dir_all(bench.path("killed")).unwrap();
        }
        assert!(resumed >= 1, "no run was killed between two rounds");
    }
}

#[test]
fn what_does_not_go_with_an_accuracy_is_refused() {
    let bench = Bench::new(&room(4));
    let run = bench.run(&["solve", "scene.toml", "--accuracy", "0"]);
    assert!(run.code == 2 && run.stderr.contains("such as 1% or 0.01"), "{}", run.stderr);
    for (more, text) in [
        (&["--solver", "lu"][..], "cg-theta"),
        (&["--storage", "f32"][..], "does not go with an accuracy"),
        (&["--discretisation", "nystrom-2"][..], "does not go with an accuracy"),
    ] {
        let run = bench.run(&[&["solve", "scene.toml", "--accuracy", "1%"][..], more].concat());
        assert!(run.code == 2 && run.stderr.contains(text), "{}", run.stderr);
    }
    let run = bench.run(&["resume", "nowhere"]);
    assert!(run.code == 5 && run.stderr.contains("checkpoint"), "{}", run.stderr);
}

#[test]
fn pictures_of_the_elements_and_links_are_among_the_results() {
    let bench = Bench::new(&room(8));
    bench.solve(&["--accuracy", "5%", "--final-gather", "-o", "out"]);
    let listed = bench.record("out")["files"].clone();
    for name in ["mesh.png", "links.png"] {
        assert!(listed.as_array().unwrap().iter().any(|file| file == name), "{listed}");
        let file = fs::read(bench.path("out").join(name)).unwrap();
        assert!(
            file.starts_with(b"\x89PNG") && file != fs::read(bench.path("out").join("image.png")).unwrap()
        );
    }
    let picture = bench.record("out")["picture"].to_string();
    assert!(
        picture.contains("gathered at") && listed.to_string().contains("pixels.npz"),
        "{picture} {listed}"
    );
    let info = bench.run(&["info", "out/links.png"]);
    assert!(
        info.code == 0 && info.stdout.contains("mesh.png, links.png, pixels.npz, field.csv"),
        "{}",
        info.stdout
    );
    // What another result left does not stay.
    bench.solve(&["-o", "out"]);
    assert!(
        ["mesh.png", "links.png", "pixels.npz"].iter().all(|name| !bench.path("out").join(name).exists())
    );
}

#[test]
fn points_gather_their_irradiance() {
    // In a room of one reflectance and exitance, E = M/(1 − ρ) everywhere; from outside nothing is
    // seen.
    let bench = Bench::new(&furnace(4, &[0.5, 0.9]));
    for accuracy in [&[][..], &["--accuracy", "1%"]] {
        let places = ["--point", "0.2,0.3,0.4,1,-2,3", "--plane", "0,0,0,1,0,0,0,1,0,3,2", "-o", "out"];
        bench.solve(&[accuracy, &places].concat());
        let path = bench.path("out").join("points.csv");
        for (band, exact) in [("b0", 2.0), ("b1", 10.0)] {
            let found = column(&path, &format!("irradiance_{band}"));
            assert_eq!(found.len(), 7);
            assert!(found.iter().all(|e| (e / exact - 1.0).abs() < 1e-2), "{found:?}");
        }
        assert_eq!(column(&path, "x")[..2], [0.2, 1.0 / 6.0]);
    }
    let run = bench.run(&["solve", "scene.toml", "--point", "1,2,3"]);
    assert!(run.code == 2 && run.stderr.contains("6 finite numbers"), "{}", run.stderr);
}

#[test]
fn the_cheaper_way_to_an_accuracy_is_taken_and_named() {
    let solve = |scene: &str| {
        let bench = Bench::new(scene);
        let run = bench.solve(&["--accuracy", "1%", "-o", "out"]);
        let record = bench.record("out");
        let way = record["choice"].as_str().unwrap().to_owned();
        assert!(run.stdout.contains("way "), "{}", run.stdout);
        (way, record)
    };
    // 24 faces of 4 elements in a furnace: 4,656 pairs, and no error of the mesh.
    let small = furnace(2, &[0.5]).replace("divide = [2, 2]", "divide = [2, 2]\nelements_per_face = 4");
    let (way, record) = solve(&small);
    assert!(way.starts_with("the matrix of the scene's elements, since 4.7e3 pairs"), "{way}");
    assert_eq!(
        (record["discretisation"].as_str(), record["options"]["accuracy"].as_f64()),
        (Some("galerkin-0"), Some(0.01))
    );
    assert!(record["mesh_error"]["relative_l2"][0].as_f64().unwrap() <= 0.01);
    // A lamp and a block: 2 × 2 elements a face leave more than that.
    let shaded = room(1)
        .replace("divide = [1, 1]", "elements_per_face = 4")
        .replace("divide = [2, 2]", "elements_per_face = 4");
    let shaded = shaded.replace("two_sided", "elements_per_face = 4\ntwo_sided");
    let (way, record) = solve(&shaded);
    assert!(way.contains("was cheaper but left an error of"), "{way}");
    assert_eq!(record["discretisation"], "hierarchical");
    let (way, _) = solve(&room(8));
    assert!(way.starts_with("hierarchical, since"), "{way}");
}

#[test]
fn elements_are_cut_along_shadows() {
    let bench = Bench::new(&room(4));
    let mut files = Vec::new();
    for threads in ["1", "3"] {
        bench.solve(&["--accuracy", "5%", "--discontinuity", "--threads", threads, "-o", "out"]);
        files.push(fs::read(bench.path("out").join("shadows.vtu")).unwrap());
    }
    assert!(files[0] == files[1], "threads change no bit");
    let text = String::from_utf8_lossy(&files[0]);
    let start = text.find("NumberOfCells=\"").unwrap() + 15;
    let cells: usize = text[start..].split('"').next().unwrap().parse().unwrap();
    let elements = bench.record("out")["counts"]["elements"].as_u64().unwrap() as usize;
    // Two triangles an element, and more where lines of shadows or corners of neighbours are on it.
    assert!(cells > 2 * elements + 100, "{cells} triangles, {elements} elements");
    assert!(text.contains("irradiance_g") && bench.record("out")["options"]["discontinuity"] == true);
}

#[test]
fn a_goal_alone_has_the_accuracy_and_the_result_says_so() {
    let bench = Bench::new(&room(8));
    let run = bench.solve(&["--accuracy", "3%", "--goal", "block,lamp", "-o", "out"]);
    let said = "of the mean irradiance of block, lamp (L2, worst band; estimate; 3.0 % was asked for)";
    assert!(run.stdout.contains(said) && run.stdout.contains("only that was asked for"), "{}", run.stdout);
    let record = bench.record("out");
    let goal = &record["hierarchy"]["goal"];
    assert_eq!((&goal["surfaces"][1], &record["options"]["goal"][0]), (&"lamp".into(), &"block".into()));
    let stated = record["hierarchy"]["stated"].as_f64().unwrap();
    assert!(stated > 0.0 && stated <= 0.03 && record["mesh_error"].is_null(), "{stated}");
    assert!(goal["relative_error"].as_array().unwrap().iter().any(|error| error.as_f64() == Some(stated)));
    // The mean over both surfaces, by their powers and areas.
    let surfaces = bench.path("out").join("surfaces.csv");
    let (areas, means) = (column(&surfaces, "area"), column(&surfaces, "irradiance_g"));
    let mean = (areas[1] * means[1] + areas[2] * means[2]) / (areas[1] + areas[2]);
    let found = goal["irradiance"][1].as_f64().unwrap();
    assert!((found / mean - 1.0).abs() < 1e-9, "{found} {mean}");
    let run = bench.run(&["solve", "scene.toml", "--accuracy", "3%", "--goal", "blok"]);
    assert!(
        run.code == 2 && run.stderr.contains("\"blok\"; choose among walls, block, lamp"),
        "{}",
        run.stderr
    );
    let run = bench.run(&["solve", "scene.toml", "--goal", "block"]);
    assert!(run.code == 2 && run.stderr.contains("a goal needs an accuracy"), "{}", run.stderr);
}

#[test]
fn what_memory_ends_says_so_and_states_no_error_that_is_not_known() {
    let bench = Bench::new(include_str!("../../scenes/leblond_furnished.toml"));
    let mut unknown = 0;
    for memory in ["30MB", "60MB"] {
        let asked = ["solve", "scene.toml", "--accuracy", "0.3%", "--no-pictures", "-o", "out"];
        let run = bench.run(&[&asked[..], &["--memory", memory]].concat());
        assert!(run.code == 3 && run.stderr.contains("the memory did not allow"), "{memory}: {}", run.stderr);
        let hierarchy = bench.record("out")["hierarchy"].clone();
        assert_eq!(hierarchy["limited"], true, "{memory}");
        if let Some(stated) = hierarchy["stated"].as_f64() {
            assert!(stated > 0.003, "{memory}: {stated}");
        } else {
            let why =
                "not known: that of the irradiance of the faces takes the change from one round to the next";
            assert!(run.stdout.contains(why), "{memory}: {}", run.stdout);
            unknown += 1;
        }
    }
    assert!(unknown > 0);
}

#[test]
fn nearly_white_rooms_keep_their_energy_within_the_stated_error() {
    for rho in ["0.99", "0.999", "0.9999"] {
        let bench =
            Bench::new(&room(2).replace("reflectance = [0.7, 0.5]", &format!("reflectance = [{rho}, 0.5]")));
        for accuracy in ["5%", "1%"] {
            bench.solve(&["--accuracy", accuracy, "--no-pictures", "--no-report", "-o", "out"]);
            let record = bench.record("out");
            let stated = record["hierarchy"]["stated"].as_f64().unwrap();
            let [emitted, absorbed] =
                ["emitted", "absorbed"].map(|power| record["energy"][0][power].as_f64().unwrap());
            let off = (absorbed / emitted - 1.0).abs();
            assert!(off < stated, "{rho} at {accuracy}: {off:.1e} off, {stated:.1e} stated");
        }
    }
}

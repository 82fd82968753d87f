//! Random paths: traced, checked against solutions, and as references.

use std::fs;

use serde_json::Value;

use crate::support::{Bench, PLATE, fredholm_in, furnace, room, without_solvers};

fn text(bench: &Bench, path: &str) -> String {
    fs::read_to_string(bench.path(path)).unwrap()
}

fn trace(bench: &Bench, arguments: &[&str]) {
    let run = bench.run(&[&["trace", "scene.toml", "--quiet"], arguments].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
}

#[test]
fn traced_results_are_the_same_with_any_number_of_threads_and_in_two_goes() {
    let bench = Bench::new(&room(3));
    for (method, batch, some, all) in [("path", "4", "64", "144"), ("jacobi", "1250", "16000", "40000")] {
        let go = |samples: &str, folder: &str, more: &[&str]| {
            let wanted = ["--method", method, "--samples", samples, "--batch", batch, "-o", folder];
            trace(&bench, &[&wanted, more].concat());
        };
        for threads in ["1", "2", "4"] {
            go(all, threads, &["--threads", threads]);
            for name in ["faces.csv", "image.png"] {
                let [one, many] =
                    ["1", threads].map(|folder| fs::read(bench.path(folder).join(name)).unwrap());
                assert!(one == many, "{name} differs with {threads} threads and {method}");
            }
        }
        go(some, "twice", &[]);
        assert!(text(&bench, "twice/faces.csv") != text(&bench, "1/faces.csv"));
        go(all, "twice", &["--continue"]);
        assert!(text(&bench, "twice/faces.csv") == text(&bench, "1/faces.csv"), "{method}");
    }
    // A run with other switches or by another method cannot go on with it.
    let run = bench.run(&["trace", "scene.toml", "--no-roulette", "-o", "twice", "--continue"]);
    assert!(run.code == 2 && run.stderr.contains("--no-roulette"), "{}", run.stderr);
    let run = bench.run(&[
        "trace",
        "scene.toml",
        "--method",
        "light",
        "--batch",
        "1250",
        "-o",
        "twice",
        "--continue",
    ]);
    assert!(run.code == 2 && run.stderr.contains("the method differs"), "{}", run.stderr);
}

#[test]
fn every_method_finds_the_furnace_within_its_errors() {
    let bench = Bench::new(&furnace(1, &[0.5, 0.8]));
    for method in ["path", "light", "bidirectional", "photon", "walk-gathering", "walk-shooting", "jacobi"] {
        trace(&bench, &["--method", method, "--to", "3%", "-o", method]);
        for row in text(&bench, &format!("{method}/faces.csv")).lines().skip(1) {
            let numbers: Vec<f64> = row.split(',').skip(6).map(|x| x.parse().unwrap()).collect();
            for (found, exact) in numbers.chunks(2).zip([2.0, 5.0]) {
                assert!((found[0] - exact).abs() < 5.0 * found[1] && found[1] > 0.0, "{method}: {row}");
            }
        }
        assert_eq!(bench.record(method)["solver"], method);
    }
}

fn crosscheck(bench: &Bench, arguments: &[&str]) -> (i32, String, Value) {
    let run = bench.run(&[&["crosscheck", "scene.toml", "-o", "checked"], arguments].concat());
    assert!([0, 3, 6].contains(&run.code), "{}{}", run.stdout, run.stderr);
    let record = serde_json::from_str(&text(bench, "checked/crosscheck.json")).unwrap();
    (run.code, format!("{}{}", run.stdout, run.stderr), record)
}

#[test]
fn a_right_scene_agrees_and_says_what_would_have_been_found() {
    let bench = Bench::new(&room(4));
    let (code, said, record) = crosscheck(&bench, &["--to", "2%"]);
    assert!(
        code == 0 && said.contains("they agree: 0 of") && said.contains("nine times out of ten"),
        "{said}"
    );
    assert_eq!((&record["verdict"], &record["significant"]), (&"agree".into(), &0.into()));
    assert_eq!(record["method"], "light");
    let [whole, face] = ["whole", "face"].map(|name| record["power"][name].as_f64().unwrap());
    assert!([whole, face].iter().all(|power| *power > 0.0 && *power < 1.0), "{whole} {face}");
    assert!(text(&bench, "checked/crosscheck.csv").lines().count() > 10);
    assert!(fs::read(bench.path("checked/crosscheck.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn what_is_checked_is_what_solve_answers_and_the_mesh_is_seen() {
    // One element a wall is far off, and says so.
    let bench = Bench::new(&room(1));
    let (code, said, _) = crosscheck(&bench, &["--to", "1%"]);
    assert_eq!(code, 0, "{said}");
    // With an accuracy links are checked.
    let (code, said, record) = crosscheck(&bench, &["--accuracy", "3%", "--to", "1%"]);
    assert_eq!(code, 0, "{said}");
    assert_eq!(record["solver"], "cg-theta", "{said}");
}

#[test]
fn too_few_samples_are_no_agreement() {
    let bench = Bench::new(&room(2));
    let (code, said, record) = crosscheck(&bench, &["--samples", "8", "--batch", "4"]);
    assert!(code == 3 && said.contains("undecided") && record["verdict"] == "undecided", "{said}");
}

#[test]
fn a_reference_holds_the_exact_values_of_a_furnace() {
    let bench = Bench::new(&furnace(2, &[0.5]));
    let run = bench.run(&["reference", "scene.toml", "-o", "bundle", "--size", "4x3"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let rows = text(&bench, "bundle/reference.csv");
    assert!(
        rows.starts_with("face,surface,cx,cy,cz,area,E_b0,E_error_b0,E_deterministic_b0,B_b0,rho_b0,M_b0\n")
    );
    for row in rows.lines().skip(1) {
        let numbers: Vec<f64> = row.split(',').skip(6).map(|x| x.parse().unwrap()).collect();
        assert!((numbers[0] - 2.0).abs() <= 5.0 * numbers[1] && numbers[1] < 0.01, "{row}");
    }
    assert!(text(&bench, "bundle/patches.obj").lines().filter(|line| line.starts_with("f ")).count() == 24);
    let record: Value = serde_json::from_str(&text(&bench, "bundle/reference.json")).unwrap();
    assert_eq!(record["format"], "fredholm-reference-3");
    assert_eq!((&record["pixels"]["width"], &record["pixels"]["chosen"]), (&4.into(), &true.into()));
}

/// An eye behind a wall is moved into the room, where every pixel is M/(1 − ρ).
#[test]
fn pixels_of_a_furnace_are_exact_and_other_tracers_are_judged_by_them() {
    let bench = Bench::new(&furnace(2, &[0.5]));
    let go = |folder: &str, more: &[&str]| {
        let usual = ["reference", "scene.toml", "--size", "8x6", "--spp", "256", "--to", "5%", "-o", folder];
        let run = bench.run(&[&usual, more].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        serde_json::from_str::<Value>(&text(&bench, &format!("{folder}/reference.json"))).unwrap()
    };
    let record = go("bundle", &["--threads", "1"]);
    assert_eq!(record["pixels"]["chosen"], true);
    let error = record["pixels"]["relative_error"].as_f64().unwrap();
    assert!(error > 0.0 && error < 0.02, "{error}");
    // The values are the same with any number of threads.
    go("again", &["--threads", "2"]);
    let [one, two] = ["bundle", "again"].map(|name| fs::read(bench.path(name).join("pixels.npz")).unwrap());
    assert!(one == two);
    // Other paths agree with it, and so does the closed form; what is 10 % brighter does not.
    go("other", &["--seed", "2"]);
    let judge = |found: &str, more: &[&str]| {
        let run = bench.run(&[&["judge", "bundle", found, "-o", "judged"], more].concat());
        (run.code, format!("{}{}", run.stdout, run.stderr))
    };
    let (code, said) = judge("other/pixels.npz", &[]);
    assert!(code == 0 && said.contains("agrees: 0 of 50 places apart"), "{said}");
    let table = |e: f64| (0..24).fold("face,value\n".to_owned(), |rows, face| format!("{rows}{face},{e}\n"));
    for (irradiance, code, verdict) in [(2.0, 0, "agrees"), (2.2, 6, "disagrees")] {
        fs::write(bench.path("found.csv"), table(irradiance)).unwrap();
        let (found, said) = judge("found.csv", &["--exact"]);
        assert!(found == code && said.contains(verdict) && said.contains("nine times out of ten"), "{said}");
        let record: Value = serde_json::from_str(&text(&bench, "judged/judge.json")).unwrap();
        assert_eq!((&record["format"], &record["seeds"]), (&"fredholm-judge-1".into(), &1.into()));
    }
    let (code, said) = judge("found.csv", &[]);
    assert!(code == 2 && said.contains("random error of the tracer is not known"), "{said}");
    let (code, said) = judge("none.npy", &[]);
    assert!(code == 5 && said.contains("cannot read none.npy"), "{said}");
}

/// The plate seen from three points.
fn plate() -> String {
    let points = PLATE.replace("[[0, -1, 0]]", "[[0, -2, 0], [1, -2, 0.5], [0, 2, 1]]");
    // What is sampled: without the edge currents that the plate has unasked.
    points.replace("[wave]", "[wave]\nbounces = 1")
}

/// The numbers of the columns whose titles begin with `sca_e` or are the standard error.
fn fields(table: &str) -> Vec<Vec<f64>> {
    let titles: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let wanted = |at: usize| titles[at].starts_with("sca_e") || titles[at] == "standard_error";
    let row = |line: &str| {
        let cells = line.split(',').enumerate().filter(|(at, _)| wanted(*at));
        cells.map(|(_, cell)| cell.parse().unwrap()).collect()
    };
    table.lines().skip(1).map(row).collect()
}

#[test]
fn sampled_waves_agree_with_the_radiation_integral() {
    let bench = Bench::new(&plate());
    let run = bench.run(&["waves", "scene.toml", "-o", "solved", "--quiet"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let exact = fields(&text(&bench, "solved/receivers.csv"));
    for method in
        ["surface-sampling", "field-particles", "field-particles-von-mises-fisher", "amplitude-particles"]
    {
        trace(&bench, &["--method", method, "--samples", "131072", "--batch", "4096", "-o", method]);
        for (found, exact) in fields(&text(&bench, &format!("{method}/receivers.csv"))).iter().zip(&exact) {
            let gap = found.iter().zip(exact).take(6).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            let size = exact.iter().take(6).map(|x| x * x).sum::<f64>().sqrt();
            // The radiation integral is asked for to 1e-3; cells have a bias.
            let allowed = if method == "amplitude-particles" { 0.03 } else { 2e-3 } * size;
            assert!(gap < 4.0 * found[6] + allowed && found[6] < 0.1 * size, "{method}: {gap:e} {found:?}");
        }
    }
}

/// An error, a time and two goes; what is another run is refused with what to do.
#[test]
fn sampled_waves_stop_where_they_should_and_go_on() {
    let bench = Bench::new(&plate());
    let wave = ["--method", "surface-sampling", "--batch", "256"];
    let go = |folder: &str, more: &[&str]| trace(&bench, &[&wave, more, &["-o", folder]].concat());
    go("exact", &["--to", "3%"]);
    let ending = bench.record("exact")["stop_reason"].as_str().unwrap().to_owned();
    assert!(ending.starts_with("converged, one bounce"), "{ending}");
    go("timed", &["--seconds", "0.2", "--samples", "1000000000"]);
    let ending = bench.record("timed")["stop_reason"].as_str().unwrap().to_owned();
    assert!(ending.starts_with("time spent"), "{ending}");
    go("once", &["--samples", "20480", "--threads", "1"]);
    go("twice", &["--samples", "8192"]);
    assert!(text(&bench, "twice/receivers.csv") != text(&bench, "once/receivers.csv"));
    go("twice", &["--samples", "20480", "--continue", "--threads", "2"]);
    assert!(text(&bench, "twice/receivers.csv") == text(&bench, "once/receivers.csv"));
    let refused = |more: &[&str], what: &str| {
        let run = bench.run(&[&["trace", "scene.toml", "-o", "twice"], more].concat());
        assert!(run.code == 2 && run.stderr.contains(what), "{}", run.stderr);
    };
    refused(&["--method", "surface-sampling", "--continue"], "the number of samples of a batch differs");
    refused(&[&wave[..], &["--seed", "2", "--continue"]].concat(), "the seed differs; start anew");
    refused(&[&wave[..], &["--points", "jittered"]].concat(), "neither --points");
    fs::write(bench.path("scene.toml"), plate().replace("1e9", "1.1e9")).unwrap();
    refused(&[&wave[..], &["--continue"]].concat(), "the scene file differs; start anew");
}

#[test]
fn sampled_waves_are_checked_against_computed_ones() {
    let bench = Bench::new(&plate());
    for method in [&[][..], &["--method", "field-particles"]] {
        let check = [&["crosscheck", "scene.toml", "--to", "2%", "-o", "checked"], method].concat();
        let run = bench.run(&check);
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        assert!(run.stdout.contains("they agree: 0 of 18"), "{}", run.stdout);
        assert_eq!(text(&bench, "checked/crosscheck.csv").lines().count(), 19);
    }
}

/// Every pixel traced by itself shows what the solution shows, up to its noise and to the elements
/// of the solution.
#[test]
fn traced_pixels_show_what_the_solution_shows() {
    let bench = Bench::new(&room(6).replace("height = 48\n", "height = 48\nexposure = 1.0\n"));
    bench.solve(&["--quiet"]);
    let picture = |path: &str| image::open(bench.path(path)).unwrap().to_rgb8().into_raw();
    let solved = picture("out/scene/image.png");
    for method in ["path", "bidirectional"] {
        let go = |folder: &str, threads: &str| {
            let wanted = ["--method", method, "--to", "10%", "--spp", "128", "--threads", threads];
            trace(&bench, &[&wanted[..], &["-o", folder]].concat());
        };
        go("one", "1");
        go("two", "2");
        assert!(
            fs::read(bench.path("one/image.png")).unwrap() == fs::read(bench.path("two/image.png")).unwrap()
        );
        assert!(fs::read(bench.path("one/pixels.npz")).unwrap().starts_with(b"PK"));
        let traced = picture("one/image.png");
        let gaps = solved.iter().zip(&traced).map(|(a, b)| f64::from(a.abs_diff(*b)));
        let mean = gaps.sum::<f64>() / solved.len() as f64;
        let contrast = solved.iter().map(|&a| f64::from(a)).fold(0.0, f64::max);
        println!("{method}: mean difference {mean:.2} of 255");
        assert!(mean < 6.0 && contrast > 150.0, "{method}: {mean}, {contrast}");
    }
    let refused = bench.run(&["trace", "scene.toml", "--method", "light", "--spp", "8"]);
    assert!(refused.code == 2 && refused.stderr.contains("--method path or"), "{}", refused.stderr);
}

#[test]
fn the_verbs_explain_themselves() {
    for verb in ["trace", "crosscheck", "reference", "judge"] {
        let run = fredholm_in(std::path::Path::new("."), &[verb, "--help"]);
        assert_eq!(run.code, 0);
        insta::assert_snapshot!(format!("help-{verb}"), without_solvers(&run.stdout));
    }
}

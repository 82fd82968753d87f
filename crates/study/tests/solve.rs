//! A study without a command line: solved, asked, written, cancelled.

use std::ops::ControlFlow;
use std::path::Path;

use fredholm_scene::{Scene, SceneError};
use fredholm_study::{Checkpoint, Ended, ErrorKind, Quiet, ResultFolder, SolveOptions, Watch, solve};

/// A closed room of one material: the irradiance is M/(1 − ρ) everywhere.
const FURNACE: &str = r#"
    [materials.wall]
    reflectance = 0.75
    exitance = 1
    [[surface]]
    name = "room"
    material = "wall"
    box = { min = [0, 0, 0], max = [1, 1, 1], inward = true }
    divide = [2, 2]
"#;

fn furnace() -> Result<Scene, SceneError> {
    Scene::from_str(FURNACE, "furnace.toml")
}

#[test]
fn the_irradiance_of_a_surface_is_right_within_its_stated_error() {
    for accuracy in [None, Some(0.01)] {
        let options = SolveOptions { accuracy, ..SolveOptions::default() };
        let solved = solve(furnace().unwrap(), &options, &Quiet).unwrap();
        let room = solved.surface("room").unwrap();
        let error = (room.irradiance[0] - 4.0).abs();
        assert!(error <= room.error[0] + 1e-9 && room.error[0] < 0.04, "{error} {room:?}");
        assert_eq!((solved.ended(), solved.surface("cellar")), (Ended::Done, None));
        assert_eq!(solved.irradiance().dim(), solved.mesh().len());
        assert!(solved.relative_error().unwrap() < 0.01);
    }
}

#[test]
fn a_folder_is_written_without_a_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let mut solved = solve(furnace().unwrap(), &SolveOptions::default(), &Quiet).unwrap();
    let record = solved.write(&ResultFolder::claim(folder.path()).unwrap()).unwrap();
    assert!(record.files.iter().all(|name| folder.path().join(name).is_file()));
    assert_eq!(record.options["output"], folder.path().display().to_string());
    assert!(record.timings.iter().any(|timing| timing.stage == "results"));
}

/// Whoever cancels before anything is there.
struct Cancelled;

impl Watch for Cancelled {
    fn go_on(&self) -> ControlFlow<()> {
        ControlFlow::Break(())
    }
}

#[test]
fn what_is_wrong_has_its_kind_and_its_help() {
    let kind = |accuracy, watch: &dyn Watch| {
        let options = SolveOptions { accuracy, ..SolveOptions::default() };
        let error = solve(furnace().unwrap(), &options, watch).err().unwrap();
        (error.kind(), error.help().is_some())
    };
    assert_eq!(kind(None, &Cancelled), (ErrorKind::Interrupted, false));
    assert_eq!(kind(Some(0.05), &Cancelled), (ErrorKind::Interrupted, false));
    for accuracy in [0.0, 1.0, f64::NAN] {
        assert_eq!(kind(Some(accuracy), &Quiet), (ErrorKind::Input, true));
    }
    let goal = SolveOptions { goal: vec!["room".to_owned()], ..SolveOptions::default() };
    let error = solve(furnace().unwrap(), &goal, &Quiet).err().unwrap();
    assert!(error.help().is_some_and(|help| help.contains("--accuracy")), "{error}");
    let missing = solve(Path::new("none.toml"), &SolveOptions::default(), &Quiet).err().unwrap();
    assert_eq!(missing.kind(), ErrorKind::Files);
    assert_eq!(Checkpoint::read("nowhere").err().unwrap().kind(), ErrorKind::Files);
}

//! Scenes that are wrong: each is refused with the file, the place, the offending text and what to
//! do.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fmt::Write;
use std::path::{Path, PathBuf};

use fredholm_mesh::Mesh;
use fredholm_scene::{ErrorKind, Geometry, Scene, SceneError, Warning};

fn solvable(path: &Path) -> Result<(Mesh, Vec<Warning>), SceneError> {
    let scene = Scene::load(path)?;
    let mesh = scene.mesh()?;
    let warnings = scene.check(&mesh)?;
    Ok((mesh, warnings))
}

fn files(folder: &str) -> Vec<PathBuf> {
    files_ending_in("toml", folder)
}

fn files_ending_in(ending: &str, folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|e| e == ending)).collect();
    files.sort();
    files
}

fn error(name: &str) -> SceneError {
    solvable(&Path::new("tests/hostile").join(name)).unwrap_err()
}

#[test]
fn every_hostile_scene_is_refused_with_place_and_help() {
    let files = files("tests/hostile");
    assert!(files.len() >= 70, "{}", files.len());
    for file in files {
        let error = solvable(&file).expect_err(&file.display().to_string());
        assert!(error.place().is_some() && !error.help().is_empty(), "{error}");
        insta::assert_snapshot!(file.file_stem().unwrap().to_str().unwrap(), error.to_string());
    }
}

#[test]
fn files_that_cannot_be_read_are_told_from_files_that_are_wrong() {
    for name in ["obj_missing.toml", "obj_missing_mtl.toml", "obj_folder.toml", "no_such_scene.toml", ""] {
        assert!(error(name).is_io(), "{name}");
    }
    for name in ["not_utf8.toml", "empty_file.toml", "obj_truncated.toml", "obj_format.toml"] {
        assert!(!error(name).is_io(), "{name}");
    }
}

#[test]
fn kinds_tell_what_is_wrong() {
    let kinds = [
        ("truncated.toml", ErrorKind::Syntax),
        ("not_utf8.toml", ErrorKind::Format),
        ("unknown_key.toml", ErrorKind::UnknownKey),
        ("missing_reflectance.toml", ErrorKind::MissingKey),
        ("wrong_type.toml", ErrorKind::Type),
        ("too_large_number.toml", ErrorKind::Value),
        ("duplicate_name.toml", ErrorKind::Name),
        ("bow_tie.toml", ErrorKind::Geometry),
        ("huge_divide.toml", ErrorKind::TooLarge),
        ("empty_scene.toml", ErrorKind::Empty),
        ("inverted_room.toml", ErrorKind::Inverted),
    ];
    for (name, kind) in kinds {
        assert_eq!(error(name).kind(), kind, "{name}");
    }
}

/// Text that differs from a scene in one place, in many ways.
fn damaged(text: &str) -> impl Iterator<Item = String> + '_ {
    let cuts = (0..text.len()).step_by(23).filter(|&i| text.is_char_boundary(i));
    cuts.flat_map(move |i| {
        let (head, tail) = text.split_at(i);
        let put = ["", "-", "[", "nan", "1e400", "\"", "\u{0}", "=", "99999999999999999999"];
        let damaged = put.into_iter().map(move |piece| format!("{head}{piece}{tail}"));
        damaged.chain([head.to_owned()])
    })
}

#[test]
fn no_damage_makes_the_reader_panic() {
    let (mut read, mut refused) = (0, 0);
    for file in files("../../scenes").into_iter().chain(files("tests/hostile")) {
        let Ok(text) = std::fs::read_to_string(&file) else { continue };
        for text in damaged(&text[..text.floor_char_boundary(2500)]) {
            match Scene::from_str(&text, &file) {
                Ok(_) => read += 1,
                Err(error) => refused += usize::from(error.to_string().contains("help: ")),
            }
        }
    }
    assert!(read > 100 && refused > 5_000, "{read} read, {refused} refused");
}

#[test]
fn no_damage_makes_the_obj_reader_panic() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let text = "[materials.clay]\nreflectance = 0.5\n[[surface]]\nname = \"a\"\nobj = { file = \"a.obj\" }\n";
    let obj = std::fs::read_to_string("../../scenes/studio/vase.obj").unwrap().replace("mtllib", "#");
    let (mut read, mut refused) = (0, 0);
    for damaged in damaged(&obj) {
        std::fs::write(folder.path().join("a.obj"), damaged).unwrap();
        match Scene::from_str(text, &scene) {
            Ok(_) => read += 1,
            Err(_) => refused += 1,
        }
    }
    assert!(read > 100 && refused > 100, "{read} read, {refused} refused");
}

#[test]
fn every_hostile_view3d_file_is_refused_with_place_and_help() {
    let files = files_ending_in("vs3", "tests/hostile/vs3");
    assert!(files.len() >= 30, "{}", files.len());
    let mut messages = String::new();
    for file in files {
        let read = Geometry::load(&file).and_then(|geometry| geometry.surfaces());
        let error = read.expect_err(&file.display().to_string());
        assert!(error.place().is_some() && !error.help().is_empty(), "{error}");
        writeln!(messages, "{error}").unwrap();
    }
    insta::assert_snapshot!("view3d", messages);
}

#[test]
fn no_damage_makes_the_view3d_reader_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.vs3");
    let text = "T box\nC eps=1e-4 encl=1\nF 3\nV 1 0 0 0\nV 2 4 0 0\nV 3 4 4 0\nV 4 0 4 0\nV 5 1 1 0\nV 6 3 1 0\nV 7 3 3 0\n\
                S 1 1 2 3 4 0 0 0.8 wall\nS 2 5 6 7 0 1 0 0.9 window\nS 3 1 2 3 0 0 1 0.9 more\nO 4 1 2 3 0\nEnd of data\n";
    let (mut read, mut refused) = (0, 0);
    for cut in 0..text.len() {
        for put in [
            "",
            " ",
            "-",
            "nan",
            "1e400",
            "0",
            "9",
            "\u{0}",
            "=",
            "!",
            "*",
            "S",
            "\n",
            "99999999999999999999",
        ] {
            std::fs::write(
                &path,
                format!("{}{put}{}", &text[..cut], &text[cut + usize::from(put.is_empty())..]),
            )
            .unwrap();
            match Geometry::load(&path).and_then(|geometry| geometry.surfaces()) {
                Ok(_) => read += 1,
                Err(error) => refused += usize::from(error.to_string().contains("help: ")),
            }
        }
    }
    assert!(read > 100 && refused > 1000, "{read} read, {refused} refused");
}

#[test]
fn a_view3d_file_goes_into_a_scene_unless_a_scene_cannot_express_it() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "[materials.clay]\nreflectance = 0.5\n[[surface]]\nname = \"a\"\nmaterial = \"clay\"\nobj = { file = \"a.vs3\" }\n";
    let load = |surface: &str| {
        let text = format!("F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 0 1 0\nS 1 1 2 3 0 0 0 0.9 floor\n{surface}\n");
        std::fs::write(folder.path().join("a.vs3"), text).unwrap();
        Scene::from_str(scene, folder.path().join("scene.toml"))
    };
    assert_eq!(load("").unwrap().mesh().unwrap().surfaces()[0].name, "a/floor");
    let error = load("O 2 1 2 3 0").unwrap_err();
    assert!(error.kind() == ErrorKind::Value && error.file().ends_with("a.vs3"), "{error}");
}

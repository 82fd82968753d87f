//! Scenes that are wrong: each is refused with the file, the place, the offending text and what to do.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use fredholm_mesh::Mesh;
use fredholm_scene::{ErrorKind, Scene, SceneError, Warning};

fn solvable(path: &Path) -> Result<(Mesh, Vec<Warning>), SceneError> {
    let scene = Scene::load(path)?;
    let mesh = scene.mesh()?;
    let warnings = scene.check(&mesh)?;
    Ok((mesh, warnings))
}

fn files(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
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

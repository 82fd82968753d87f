//! Scenes that are wrong: each ends with a message that says where, and the right exit code.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::support::{Run, fredholm_in};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/scene/tests/hostile")
}

fn scenes() -> Vec<String> {
    let entries =
        fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> =
        entries.filter(|name| Path::new(name).extension() == Some("toml".as_ref())).collect();
    names.sort();
    names
}

fn attempt(verb: &str, scene: &str) -> Run {
    let output = tempfile::tempdir().unwrap();
    let results = output.path().join("results");
    let mut arguments = vec![verb, scene];
    if verb == "solve" {
        arguments.extend(["-o", results.to_str().unwrap()]);
    }
    let started = Instant::now();
    let run = fredholm_in(&folder(), &arguments);
    assert!(started.elapsed() < Duration::from_secs(2), "{scene} took {:?}", started.elapsed());
    assert!(!results.exists(), "{scene} wrote something");
    run
}

#[test]
fn every_hostile_scene_ends_with_a_message() {
    let scenes = scenes();
    assert!(scenes.len() >= 30, "only {} scenes", scenes.len());
    let mut messages = String::new();
    for scene in &scenes {
        let run = attempt("solve", scene);
        assert!([2, 4, 5].contains(&run.code), "{scene} ends with {}: {}", run.code, run.stderr);
        assert!(!run.stderr.contains("panicked"), "{scene}: {}", run.stderr);
        assert_eq!(run.stdout, "", "{scene}");
        let (_, message) =
            run.stderr.split_once("error: ").unwrap_or_else(|| panic!("{scene}: {}", run.stderr));
        assert!(is_placed(message), "{scene}: {message}");
        writeln!(messages, "── {scene}, exit code {}\n{message}", run.code).unwrap();
    }
    insta::assert_snapshot!(messages);
}

/// Whether a message begins with a file, and a line and column or a byte in it.
fn is_placed(message: &str) -> bool {
    let Some((file, place)) = message.split_once(':') else { return false };
    let number = |text: &str| text.parse::<u64>().is_ok();
    let mut parts = place.split(':');
    let (first, second) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    let known =
        ["toml", "obj", "mtl"].iter().any(|ending| Path::new(file).extension() == Some(ending.as_ref()));
    known && (number(first) && number(second) || first.strip_prefix(" byte ").is_some_and(number))
}

#[test]
fn places_are_told_from_other_text() {
    assert!(is_placed("a.toml:3:14: wrong") && is_placed("b.obj: byte 7: wrong"));
    for text in ["a.toml: wrong", "a.toml:3: wrong", "wrong: 3:4", "a.toml:x:4: wrong", ""] {
        assert!(!is_placed(text), "{text}");
    }
}

#[test]
fn check_says_the_same_as_solve() {
    for scene in &scenes() {
        let [solved, checked] = ["solve", "check"].map(|verb| attempt(verb, scene));
        let error = |run: &Run| run.stderr.split_once("error: ").map(|(_, message)| message.to_owned());
        assert_eq!((solved.code, error(&solved)), (checked.code, error(&checked)), "{scene}");
    }
}

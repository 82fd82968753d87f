//! The help of every verb, word for word.

use crate::support::{fredholm_in, without_solvers};
use std::path::Path;

fn help(arguments: &[&str]) -> String {
    let run = fredholm_in(Path::new("."), arguments);
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{arguments:?}");
    run.stdout
}

#[test]
fn every_verb_explains_itself() {
    insta::assert_snapshot!("help", help(&["--help"]));
    for verb in [
        "solve",
        "resume",
        "check",
        "converge",
        "viewfactors",
        "waves",
        "view",
        "export",
        "convert",
        "info",
        "schema",
        "completions",
        "solvers",
        "discretisations",
    ] {
        insta::assert_snapshot!(format!("help-{verb}"), without_solvers(&help(&[verb, "--help"])));
    }
}

#[test]
fn the_version_is_that_of_the_package() {
    assert_eq!(help(&["--version"]), format!("fredholm {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn the_schema_is_json_with_a_title() {
    let schema: serde_json::Value = serde_json::from_str(&help(&["schema"])).unwrap();
    assert!(schema["title"].is_string() && schema["properties"]["surface"].is_object());
}

#[test]
fn completions_know_the_verbs() {
    for shell in ["bash", "zsh", "fish"] {
        let script = help(&["completions", shell]);
        assert!(script.contains("solve") && script.contains("gauss-seidel"), "{shell}");
    }
}

#[test]
fn solvers_are_listed_with_a_line_each() {
    let list = help(&["solvers"]);
    for name in ["gauss-seidel", "southwell", "lu"] {
        let line = list.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
        assert!(line.len() > name.len() + 20, "{line}");
    }
}

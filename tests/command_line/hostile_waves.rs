//! Scenes of waves that are wrong or make no sense: each ends with an error or a warning that says
//! what, where, and what helps.
//!
//! The first line of each says how: `# exit CODE: WORDS`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::fredholm_in;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hostile_waves")
}

#[test]
fn every_senseless_scene_is_refused_or_warned_about() {
    let scenes = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<PathBuf> = scenes.filter(|path| path.extension() == Some("toml".as_ref())).collect();
    scenes.sort();
    assert!(scenes.len() >= 40, "only {} scenes", scenes.len());
    for path in &scenes {
        let name = path.file_name().unwrap().to_str().unwrap();
        let text = fs::read_to_string(path).unwrap();
        let expected = text.lines().next().and_then(|line| line.strip_prefix("# exit ")).unwrap();
        let (code, words) = expected.split_once(": ").unwrap();
        assert!(words.len() > 5, "{name}");
        let output = tempfile::tempdir().unwrap();
        let results = output.path().join("results");
        let arguments = ["waves", name, "--no-report", "--memory", "4GiB", "-o", results.to_str().unwrap()];
        let run = fredholm_in(&folder(), &arguments);
        assert_eq!(run.code, code.parse::<i32>().unwrap(), "{name}: {}", run.stderr);
        assert!(!run.stderr.contains("panicked"), "{name}: {}", run.stderr);
        let told = |line: &str| {
            line.contains(words) && (line.starts_with("error: ") || line.starts_with("warning: "))
        };
        let line = run.stderr.lines().find(|line| told(line));
        let line = line.unwrap_or_else(|| panic!("{name}: {}", run.stderr));
        // What helps: of a warning behind its last semicolon, of an error in a line of its own.
        let helps =
            if line.starts_with("error: ") { run.stderr.contains("help: ") } else { line.contains(';') };
        assert!(helps, "{name}: {line}");
        assert_eq!(results.join("run.json").exists(), run.code == 0, "{name}");
    }
}

//! The pages of results, opened in a headless browser: an element is picked and compared with
//! faces.csv, every control is moved, and nothing may be asked of the network.
//!
//! Skipped where `FREDHOLM_SKIP_BROWSER` is set, and where there is no Node, no Chromium, or no
//! package of `npm ci --ignore-scripts` in crates/report/viewer; the reason is printed.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::{Path, PathBuf};
use std::process::Command;

use assert_cmd::Command as Program;

/// Where the page comes from.
fn viewer() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/report/viewer")
}

/// Why no page can be opened here.
fn missing() -> Option<&'static str> {
    let chromium = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
    let has_browser = std::env::var_os("FREDHOLM_CHROMIUM").is_some()
        || chromium.iter().any(|path| Path::new(path).exists());
    if std::env::var_os("FREDHOLM_SKIP_BROWSER").is_some() {
        Some("FREDHOLM_SKIP_BROWSER is set")
    } else if Command::new("node").arg("--version").output().is_err() {
        Some("there is no Node")
    } else if !viewer().join("node_modules/playwright-core").is_dir() {
        Some("crates/report/viewer has no packages; run npm ci --ignore-scripts there")
    } else if !has_browser {
        Some("there is no Chromium")
    } else {
        None
    }
}

fn fredholm(arguments: &[&str]) {
    Program::new(assert_cmd::cargo::cargo_bin!("fredholm"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(arguments)
        .assert()
        .success();
}

#[test]
fn pages_of_light_and_of_waves_can_be_used() {
    let kinds: [&[&str]; 2] = [
        &["solve", "scenes/cornell_box.toml", "--accuracy", "20%"],
        &["waves", "scenes/waves/two_plates.toml"],
    ];
    let Some(said) = used(&kinds, &[]) else { return };
    assert!(said.contains("a phase"), "{said}");
}

#[test]
fn pages_of_studies_can_be_used_and_large_ones_be_opened() {
    let folder = tempfile::tempdir().unwrap();
    let large = large_room(folder.path());
    let kinds: [&[&str]; 3] = [
        &["compare", "scenes/leblond_room.toml"],
        &["converge", "scenes/leblond_room.toml", "--levels", "3", "--form-factor-tolerance", "1e-2"],
        &["crosscheck", "scenes/leblond_room.toml", "--to", "5%"],
    ];
    used(&kinds, &[&["solve", &large, "--accuracy", "50%", "--way", "rays"]]);
}

/// Runs commands, and tries all that their pages have, or only picks from them: what was said; none
/// where no page can be opened.
fn used(all: &[&[&str]], picked: &[&[&str]]) -> Option<String> {
    if let Some(why) = missing() {
        eprintln!("skipped: {why}");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut tried = Command::new("node");
    tried.current_dir(viewer()).arg("test/open.mjs");
    for (k, arguments) in all.iter().chain(picked).enumerate() {
        let out = folder.path().join(k.to_string()).to_str().unwrap().to_owned();
        fredholm(&[*arguments, &["-o", &out, "--quiet"]].concat());
        if k == all.len() {
            tried.arg("--pick");
        }
        tried.arg(out);
    }
    let tried = tried.output().unwrap();
    let said = String::from_utf8_lossy(&tried.stdout).into_owned() + &String::from_utf8_lossy(&tried.stderr);
    assert!(tried.status.success() && said.contains("all is well"), "{said}");
    Some(said)
}

/// The white room with 123,002 faces, as a file.
fn large_room(folder: &Path) -> String {
    let room = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/white_room.toml");
    let text = std::fs::read_to_string(room).unwrap();
    let text = text.replace("divide = [4, 4]", "divide = [140, 140]");
    let path = folder.join("room.toml");
    std::fs::write(&path, text.replace("divide = [2, 2]", "divide = [30, 30]")).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn without_a_report_there_is_none_and_view_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_str().unwrap();
    fredholm(&["solve", "scenes/leblond_room.toml", "-o", path, "--quiet"]);
    let page = folder.path().join("report.html");
    let run = std::fs::read_to_string(folder.path().join("run.json")).unwrap();
    assert!(page.is_file() && run.contains("\"report.html\""));
    let mut view = Program::new(assert_cmd::cargo::cargo_bin!("fredholm"));
    let view = view.args(["view", path]).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
    let told = view.assert().success().get_output().stdout.clone();
    assert!(String::from_utf8(told).unwrap().trim().ends_with("report.html"));
    fredholm(&["solve", "scenes/leblond_room.toml", "-o", path, "--quiet", "--no-report"]);
    assert!(!page.exists(), "the page of an older result is left");
    let refused =
        Program::new(assert_cmd::cargo::cargo_bin!("fredholm")).args(["view", path]).assert().failure();
    assert!(String::from_utf8_lossy(&refused.get_output().stderr).contains("--no-report"));
}

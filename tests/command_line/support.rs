//! Running the program on scenes in temporary folders.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// Path of the program.
pub fn program() -> &'static Path {
    assert_cmd::cargo::cargo_bin!("fredholm")
}

/// What one run came to.
#[derive(Debug)]
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code().unwrap(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }
}

/// Runs the program in a folder.
pub fn fredholm_in(folder: &Path, arguments: &[&str]) -> Run {
    let mut command = Command::new(program());
    command.current_dir(folder).args(arguments).env_remove("COLUMNS").stdin(Stdio::null());
    command.output().unwrap().into()
}

/// A temporary folder with a scene in it.
pub struct Bench {
    pub folder: TempDir,
}

impl Bench {
    pub fn new(scene: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.toml"), scene).unwrap();
        Self { folder }
    }

    pub fn run(&self, arguments: &[&str]) -> Run {
        fredholm_in(self.folder.path(), arguments)
    }

    /// Solves the scene into `out/scene` and expects success.
    pub fn solve(&self, arguments: &[&str]) -> Run {
        let run = self.run(&[&["solve", "scene.toml"], arguments].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        run
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn record(&self, folder: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(folder).join("run.json")).unwrap()).unwrap()
    }
}

/// A small picture, so that it is not what takes the time.
const CAMERA: &str =
    "[camera]\neye = [0.5, 0.5, 3]\ntarget = [0.5, 0.5, 0]\nup = [0, 1, 0]\nwidth = 64\nheight = 48\n";

/// A closed unit room of one material, its walls cut `n` × `n`.
pub fn furnace(n: usize, reflectance: &[f64]) -> String {
    let bands: Vec<String> = (0..reflectance.len()).map(|band| format!("b{band}")).collect();
    format!(
        "bands = {bands:?}\n\
         [materials.wall]\nreflectance = {reflectance:?}\nexitance = 1.0\n\
         [[surface]]\nname = \"walls\"\nmaterial = \"wall\"\n\
         box = {{ min = [0, 0, 0], max = [1, 1, 1], inward = true }}\ndivide = [{n}, {n}]\n\
         {CAMERA}"
    )
}

/// A closed room with a lamp and a block in it, so that there are shadows.
pub fn room(n: usize) -> String {
    format!(
        "bands = [\"r\", \"g\"]\n\
         [materials.wall]\nreflectance = [0.7, 0.5]\n\
         [materials.lamp]\nreflectance = 0.2\nexitance = [10.0, 8.0]\n\
         [[surface]]\nname = \"walls\"\nmaterial = \"wall\"\n\
         box = {{ min = [0, 0, 0], max = [2, 2, 2], inward = true }}\ndivide = [{n}, {n}]\n\
         [[surface]]\nname = \"block\"\nmaterial = \"wall\"\n\
         box = {{ min = [0.5, 0.5, 0.3], max = [1.1, 1.2, 0.9] }}\ndivide = [2, 2]\n\
         [[surface]]\nname = \"lamp\"\nmaterial = \"lamp\"\n\
         quad = [[0.7, 0.7, 1.9], [0.7, 1.3, 1.9], [1.3, 1.3, 1.9], [1.3, 0.7, 1.9]]\n\
         two_sided = true\nback_material = \"wall\"\n\
         {CAMERA}"
    )
}

/// A square plate of two wavelengths, lit squarely, seen from one point: a scene of waves.
pub const PLATE: &str = r#"
[wave]
frequencies_hz = [1e9]

[[source]]
kind = "plane-wave"
travel = [0, 1, 0]
polarisation = [0, 0, 1]

[[surface]]
name = "plate"
quad = [[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]]

[[receiver]]
name = "point"
points = [[0, -1, 0]]
"#;

/// A table with a header: its columns by name.
pub fn column(csv: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(csv).unwrap();
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|title| title == name).unwrap();
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

/// The files that a solution has without further wishes.
pub fn usual_files() -> impl Iterator<Item = &'static str> {
    use fredholm::report::{Wanted, wanted_files};
    let wanted = Wanted { image: true, page: true, ..Wanted::default() };
    wanted_files(&wanted).collect::<Vec<_>>().into_iter()
}

/// A help text without the list of all solvers, which a new one makes longer.
pub fn without_solvers(help: &str) -> String {
    const LIST: &str = "[possible values: gauss-seidel,";
    let Some((before, list)) = help.split_once(LIST) else { return help.to_owned() };
    let (_, after) = list.split_once(']').unwrap();
    format!("{before}[possible values: the solvers]{}", without_solvers(after))
}

//! Damaged scenes and mesh files through all that `check` does before it computes: reading,
//! meshing, checks of the whole.

use std::any::Any;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fredholm::mesh::Quality;
use fredholm::scene::{Geometry, Scene, SceneError};
use fredholm::visibility::Occluders;
use fredholm::visibility::body::Bodies;
use fredholm_generate::{Case, mutated};

use crate::settings::{first, keep, number};

/// Mutants where no number is given.
const USUAL_MUTANTS: u64 = 2_000;
/// Elements up to which a mesh is made: a damaged number may ask for any.
const ELEMENTS: u128 = 20_000;
/// Longest time for one.
const LONGEST_RUN: Duration = Duration::from_mins(1);

const VIEW3D: &str = "T box\nC eps=1e-4 encl=1\nF 3\nV 1 0 0 0\nV 2 4 0 0\nV 3 4 4 0\nV 4 0 4 0\nV 5 1 1 0\nV 6 3 1 0\nV 7 3 3 0\n\
    V 8 0 0 2\nV 9 4 0 2\nS 1 1 2 3 4 0 0 0.8 wall\nS 2 5 6 7 0 1 0 0.9 window\nS 3 1 2 9 8 0 0 0.9 side\nO 4 1 2 3 0\nEnd of data\n";

const OF_MATERIALS: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0.5\nv 0.5 0.5 2\no a\nusemtl clay\nf 1 2 3 4\nusemtl brass\nf 1/1/1 2/1/1 5//2\n\
    f -2 -3 -1\n";
const MATERIALS: &str =
    "# two\nnewmtl clay\nKd 0.5 0.4 0.3\nKe 0 0 0\nillum 1\nnewmtl brass\nKa 0 0 0\nKd 0.7 0.6 0.3\nd 1\n";
const SCENE: &str = "[materials.clay]\nreflectance = 0.5\n[materials.brass]\nreflectance = 0.5\nexitance = 1\n[[surface]]\nname = \"a\"\n\
    obj = { file = \"a.obj\" }\n";

/// A file to be damaged in a folder with the others, and the one that is opened.
struct Original {
    files: Vec<(String, String)>,
    damaged: usize,
    opened: String,
}

/// Whatever has a format: the scenes that are shipped, random ones with their OBJ files, an OBJ
/// with its materials, a View3D file.
fn original(seed: u64, shipped: &[(String, String)]) -> Original {
    let of = |files: Vec<(String, String)>, damaged: usize| {
        let opened = files[0].0.clone();
        Original { files, damaged, opened }
    };
    let own = |name: &str, text: &str| (name.to_owned(), text.to_owned());
    match seed % 8 {
        0 => of(vec![shipped[(seed / 8) as usize % shipped.len()].clone()], 0),
        1 => of(vec![own("a.vs3", VIEW3D)], 0),
        2 | 3 => {
            let files = vec![own("a.toml", SCENE), own("a.obj", OF_MATERIALS), own("a.mtl", MATERIALS)];
            of(files, 1 + (seed % 2) as usize)
        }
        4 => of(vec![own("a.obj", OF_MATERIALS), own("a.mtl", MATERIALS)], 0),
        part => {
            let files = Case::random(seed / 8).files;
            let mut all = vec![(files.name, files.scene)];
            all.extend(files.others);
            let damaged = if part == 5 { all.len() - 1 } else { 0 };
            of(all, damaged)
        }
    }
}

fn shipped() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    paths.iter().map(|path| ("shipped.toml".to_owned(), fs::read_to_string(path).unwrap())).collect()
}

/// What `check` does before it computes.
fn checked(path: &Path) -> Result<(), SceneError> {
    let mesh = if path.extension().is_some_and(|ending| ending == "toml") {
        let scene = Scene::load(path)?;
        if scene.predicted_elements() > ELEMENTS {
            return Ok(());
        }
        let mesh = scene.mesh()?;
        scene.check(&mesh)?;
        mesh
    } else {
        let geometry = Geometry::load(path)?;
        if geometry.predicted_elements() > ELEMENTS {
            return Ok(());
        }
        geometry.surfaces()?.mesh
    };
    let _ = Quality::of(&mesh);
    if let Ok(occluders) = Occluders::new(mesh.occluders()) {
        let patches: Vec<_> = mesh.patches().collect();
        let _ = Bodies::new(&occluders, &patches, &[]);
    }
    Ok(())
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without a message")
}

/// What is wrong with how a file was taken.
fn fault(path: &Path) -> (bool, Option<String>) {
    let started = Instant::now();
    let outcome = catch_unwind(AssertUnwindSafe(|| checked(path)));
    let spent = started.elapsed();
    let fault = match &outcome {
        Err(panic) => Some(format!("panicked: {}", message(&**panic))),
        Ok(_) if spent > LONGEST_RUN => Some(format!("took {spent:.1?}")),
        Ok(Err(error)) if error.help().is_empty() || error.what().is_empty() => {
            Some(format!("a refusal without a reason: {error}"))
        }
        Ok(_) => None,
    };
    (matches!(outcome, Ok(Ok(()))), fault)
}

#[test]
fn damaged_files_are_read_or_refused() {
    let shipped = shipped();
    let asked = number("FREDHOLM_MUTANTS").unwrap_or(USUAL_MUTANTS);
    let (mut faults, mut read) = (vec![], 0);
    for seed in first()..first() + asked {
        let mut original = original(seed, &shipped);
        let text = &mut original.files[original.damaged].1;
        *text = mutated(text, seed);
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in &original.files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        let (accepted, fault) = fault(&folder.path().join(&original.opened));
        read += u64::from(accepted);
        if let Some(fault) = fault {
            println!("mutant {seed}: {fault}");
            faults.push(format!("mutant {seed}: {fault}"));
            if let Some(keep) = keep() {
                let kept = keep.join(format!("mutant{seed}"));
                fs::create_dir_all(&kept).unwrap();
                original.files.iter().for_each(|(name, text)| fs::write(kept.join(name), text).unwrap());
            }
        }
    }
    println!("{asked} damaged files, {read} read, {} refused, {} faults", asked - read, faults.len());
    assert!(faults.is_empty(), "{} of {asked}:\n{}", faults.len(), faults.join("\n"));
    assert!(10 * read > asked && 10 * (asked - read) > asked, "{read} of {asked} were read");
}

//! `docs/results.md`: it is what its source makes, and names all columns, arrays and keys that the
//! commands write.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use fredholm::report::{catalogue, results_page};

use crate::support::{Bench, PLATE, room};

#[test]
fn the_page_is_what_its_source_makes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/results.md");
    if std::env::var_os("FREDHOLM_WRITE").is_some() {
        fs::write(&path, results_page()).unwrap();
    }
    let help = "write it anew: FREDHOLM_WRITE=1 cargo test --test command_line results_page";
    assert!(fs::read_to_string(&path).unwrap_or_default() == results_page(), "{help}");
}

/// What the catalogue has of a file.
fn listed(command: &str, file: &str) -> BTreeSet<String> {
    let found = catalogue().filter(|known| known.name.split(", ").any(|name| name == file));
    let found = found.filter(|known| known.by.split(", ").any(|by| by.split(' ').next() == Some(command)));
    let values = found.flat_map(|known| known.values).flat_map(|(names, _, _)| names.split(", "));
    values.map(str::to_owned).collect()
}

/// Columns without the names of bands and surfaces.
fn of_any_band(name: &str) -> String {
    let name = ["r", "g"]
        .iter()
        .find_map(|band| name.strip_suffix(&format!("_{band}")))
        .map_or_else(|| name.to_owned(), |stem| format!("{stem}_BAND"));
    let surface =
        ["walls", "block", "lamp/back", "lamp"].iter().find(|surface| name.contains(&format!("_{surface}")));
    surface.map_or(name.clone(), |surface| name.replace(surface, "SURFACE"))
}

fn columns(path: &Path) -> BTreeSet<String> {
    let text = fs::read_to_string(path).unwrap();
    text.lines().next().unwrap().split(',').map(of_any_band).collect()
}

/// Names in the directory of an archive: a signature, 24 bytes, the length of the name, 16 bytes
/// more, the name.
fn arrays(path: &Path) -> BTreeSet<String> {
    let bytes = fs::read(path).unwrap();
    let starts = (0..bytes.len() - 4).filter(|&at| bytes[at..at + 4] == *b"PK\x01\x02");
    let name = |at: usize| {
        let length = usize::from(u16::from_le_bytes([bytes[at + 28], bytes[at + 29]]));
        String::from_utf8(bytes[at + 46..at + 46 + length].to_vec()).unwrap()
    };
    starts.map(name).map(|name| name.trim_end_matches(".npy").to_owned()).collect()
}

fn of_grid(path: &Path) -> BTreeSet<String> {
    let bytes = fs::read(path).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let data = text.split("<CellData").nth(1).unwrap().split("</CellData").next().unwrap();
    data.split("Name=\"").skip(1).map(|rest| of_any_band(rest.split('"').next().unwrap())).collect()
}

#[test]
fn every_column_and_array_that_is_written_is_listed_and_no_other() {
    let bench = Bench::new("");
    fs::write(bench.path("room.toml"), room(2)).unwrap();
    fs::write(bench.path("plate.toml"), PLATE).unwrap();
    for (line, files) in [
        ("solve room.toml", &["field.csv", "faces.csv", "surfaces.csv", "field.npz", "field.vtu"][..]),
        ("trace room.toml --samples 64 --spp 1", &["faces.csv", "pixels.npz"]),
        ("shoot room.toml", &["faces.csv", "field.npz", "field.vtu", "shots.csv"]),
        ("compare room.toml --solvers gauss-seidel,lu", &["compare.csv", "compare_history.csv"]),
        ("spectrum room.toml", &["spectrum.csv"]),
        ("converge room.toml --levels 2", &["converge.csv"]),
        ("crosscheck room.toml --samples 64", &["crosscheck.csv"]),
        ("reference room.toml --samples 64 --size 8x6", &["reference.csv", "pixels.npz"]),
        ("waves plate.toml", &["receivers.csv", "receivers.npz"]),
    ] {
        let mut words: Vec<&str> = line.split(' ').collect();
        words.extend(["-o", words[0]]);
        let run = bench.run(&words);
        assert!([0, 3, 6].contains(&run.code), "{line}: {}", run.stderr);
        for file in files {
            let path = bench.path(words[0]).join(file);
            let written = match path.extension().and_then(|ending| ending.to_str()) {
                Some("csv") => columns(&path),
                Some("npz") => arrays(&path),
                _ => of_grid(&path),
            };
            assert_eq!(written, listed(words[0], file), "{line}: {file}");
        }
    }
}

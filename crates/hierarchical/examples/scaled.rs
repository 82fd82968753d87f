//! Writes a scene with the counts of every `divide` multiplied: the same room of more faces.
//! `cargo run --release -p fredholm-hierarchical --example scaled -- SCENE.toml FACTOR OUT.toml`.

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, factor, out] = &arguments[..] else {
        return Err("give a scene, a factor and a file to be written".into());
    };
    let factor: u64 = factor.parse()?;
    let lines: Vec<String> =
        std::fs::read_to_string(scene)?.lines().map(|line| scaled(line, factor)).collect();
    std::fs::write(out, lines.join("\n"))?;
    Ok(())
}

/// A line, with the numbers of a `divide` multiplied.
fn scaled(line: &str, factor: u64) -> String {
    let Some(counts) = line.strip_prefix("divide = [").and_then(|rest| rest.strip_suffix(']')) else {
        return line.to_owned();
    };
    let count =
        |count: &str| count.trim().parse::<u64>().map_or(count.to_owned(), |n| (n * factor).to_string());
    format!("divide = [{}]", counts.split(',').map(count).collect::<Vec<_>>().join(", "))
}

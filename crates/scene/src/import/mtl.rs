//! Wavefront material libraries (.mtl): names, diffuse colours (`Kd`) and emission (`Ke`).
//!
//! Format: Wavefront Technologies, Advanced Visualizer Manual, appendix B2; `Ke` is a later custom.
//! Everything else, such as gloss, transparency and pictures, does not apply to diffuse surfaces
//! and is passed over; pictures are told.

use std::ops::Range;

use crate::error::{ErrorKind, SceneError};
use crate::source::Source;

/// A material of a library.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MeshMaterial {
    pub name: String,
    /// Diffuse reflectance of red, green and blue, and where it stands; none where the library does
    /// not say.
    pub diffuse: Option<([f64; 3], Range<usize>)>,
    /// Emitted red, green and blue, and where they stand.
    pub emission: Option<([f64; 3], Range<usize>)>,
    /// A picture that would replace the diffuse colour.
    pub picture: Option<String>,
    /// Its name in the library.
    pub span: Range<usize>,
}

/// The materials of a library, in its order.
pub(crate) fn mesh_materials(source: &Source) -> Result<Vec<MeshMaterial>, SceneError> {
    let mut materials: Vec<MeshMaterial> = vec![];
    let mut start = 0;
    for line in source.text.split_inclusive('\n') {
        let content = line.split('#').next().unwrap_or_default();
        let statement = content.trim();
        let begin = start + (content.len() - content.trim_start().len());
        let span = begin..begin + statement.len();
        start += line.len();
        let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
        if keyword == "newmtl" {
            let name = rest.trim().to_owned();
            materials.push(MeshMaterial { name, diffuse: None, emission: None, picture: None, span });
            continue;
        }
        let Some(material) = materials.last_mut() else { continue };
        match keyword {
            "Kd" => material.diffuse = Some((colour(source, rest, &span)?, span)),
            "Ke" => material.emission = Some((colour(source, rest, &span)?, span)),
            "map_Kd" => material.picture = Some(rest.trim().to_owned()),
            _ => {}
        }
    }
    Ok(materials)
}

/// Red, green and blue; one number stands for all three.
fn colour(source: &Source, rest: &str, span: &Range<usize>) -> Result<[f64; 3], SceneError> {
    let number = |word: &str| word.parse::<f64>().ok().filter(|x| x.is_finite());
    let numbers: Option<Vec<f64>> = rest.split_whitespace().map(number).collect();
    match numbers.as_deref() {
        Some([grey]) => Ok([*grey; 3]),
        Some([r, g, b]) => Ok([*r, *g, *b]),
        _ => {
            let help = "write three numbers, for red, green and blue";
            Err(source.error(ErrorKind::Syntax, span.clone(), "this is no colour", help))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<MeshMaterial>, SceneError> {
        mesh_materials(&Source::of("a.mtl".as_ref(), text.to_owned()))
    }

    #[test]
    fn names_and_colours_are_found_among_other_statements() {
        let text = "# newmtl no\r\nnewmtl  oak wood\r\nKd 1 .5 0.25\nillum 2\n\tnewmtl\tb\n Ke 3 # bright\nnewmtlx c\nmap_Kd b.png\n";
        let found = read(text).unwrap();
        let names: Vec<&str> = found.iter().map(|material| material.name.as_str()).collect();
        assert_eq!(names, ["oak wood", "b"]);
        assert_eq!(found[0].diffuse, Some(([1.0, 0.5, 0.25], 31..43)));
        assert_eq!(found[0].emission, None);
        let (emission, span) = found[1].emission.clone().unwrap();
        assert_eq!((emission, &text[span]), ([3.0; 3], "Ke 3"));
        assert_eq!(found[1].picture.as_deref(), Some("b.png"));
    }

    #[test]
    fn what_is_no_colour_is_refused_at_its_line() {
        for line in ["Kd 1 2", "Ke x 0 0", "Kd nan 0 0", "Kd", "Kd xyz 0.1 0.2 0.3"] {
            let error = read(&format!("newmtl a\n{line}\n")).unwrap_err();
            assert!(error.to_string().starts_with("a.mtl:2:1: this is no colour"), "{error}");
        }
    }
}

//! Radiance scenes (.rad): polygons and the materials plastic, light and glow.
//!
//! Format: G. Ward, The RADIANCE 5.1 Synthetic Imaging System, Reference Manual. A primitive is a
//! modifier, a type, an identifier, and three lists, each a count with as many arguments: words,
//! whole numbers and numbers. The reflectance of plastic is its colour times 1 − specularity; light
//! and glow have a radiance and reflect nothing. Polygons are lit on the side from which their
//! corners run counter-clockwise. What is round is refused, since how finely it is to be cut is not
//! in the file; so are other materials and commands.

use std::collections::HashMap;
use std::ops::Range;

use fredholm_mesh::Vec3;

use super::{Group, Imported, ImportedFace, MeshMaterial, Name, Note, check_corners};
use crate::error::{ErrorKind, SceneError};
use crate::source::Source;

/// Materials whose reflection is diffuse but for the part that is specular.
const REFLECTING_MATERIALS: [&str; 1] = ["plastic"];
const EMITTING_MATERIALS: [&str; 2] = ["light", "glow"];
/// Surfaces that are no polygons.
const ROUND_SURFACES: [&str; 8] = ["sphere", "bubble", "cone", "cup", "cylinder", "tube", "ring", "instance"];

pub(super) fn import(source: Source) -> Result<Imported, SceneError> {
    let mut reader = Reader { words: Words { source: &source, at: 0 }, ..Reader::new(&source) };
    while let Some(modifier) = reader.words.next() {
        reader.primitive(&modifier)?;
    }
    let Reader { groups, materials, notes, .. } = reader;
    Ok(Imported { materials, notes, ..Imported::new(source, groups) })
}

/// The words of the text without comments.
struct Words<'a> {
    source: &'a Source,
    at: usize,
}

impl Words<'_> {
    fn next(&mut self) -> Option<Name> {
        let text = &self.source.text;
        loop {
            let rest = &text[self.at..];
            let start = self.at + rest.find(|c: char| !c.is_whitespace())?;
            let word = &text[start..];
            if word.starts_with('#') {
                self.at = start + word.find('\n').unwrap_or(word.len());
                continue;
            }
            let end = start + word.find(char::is_whitespace).unwrap_or(word.len());
            self.at = end;
            return Some(Name { text: text[start..end].to_owned(), span: start..end });
        }
    }
}

/// What a name of a material stands for.
#[derive(Clone)]
enum Known {
    /// Index of a material.
    Material(usize),
    /// A type that is not read.
    Other(String),
}

struct Reader<'a> {
    source: &'a Source,
    words: Words<'a>,
    known: HashMap<String, Known>,
    materials: Vec<MeshMaterial>,
    groups: Vec<Group>,
    numbers: HashMap<(String, String), usize>,
    notes: Vec<Note>,
}

/// A type and its arguments.
struct Primitive {
    kind: Name,
    name: Name,
    reals: Vec<f64>,
    span: Range<usize>,
}

impl<'a> Reader<'a> {
    fn new(source: &'a Source) -> Self {
        let (words, known, numbers) = (Words { source, at: 0 }, HashMap::new(), HashMap::new());
        Self { source, words, known, materials: vec![], groups: vec![], numbers, notes: vec![] }
    }

    fn error(&self, span: &Range<usize>, what: impl AsRef<str>, help: &str) -> SceneError {
        self.source.error(ErrorKind::Syntax, span.clone(), what, help)
    }

    fn word(&mut self, what: &str) -> Result<Name, SceneError> {
        self.words.next().ok_or_else(|| {
            let end = self.source.text.len();
            let help = "the file was cut short: copy or write it anew";
            self.error(&(end..end), format!("the file ends where {what} should be"), help)
        })
    }

    fn primitive(&mut self, modifier: &Name) -> Result<(), SceneError> {
        if modifier.text.starts_with('!') {
            let help = "let Radiance carry the commands out first: xform -e scene.rad > flat.rad";
            return Err(self.error(&modifier.span, "commands are not carried out", help));
        }
        let (kind, name) = (self.word("a type")?, self.word("an identifier")?);
        if kind.text == "alias" {
            let of = self.word("the name that the alias stands for")?;
            let meant = self.meaning(&of)?;
            self.known.insert(name.text, meant);
            return Ok(());
        }
        let words = self.count("the number of words")?;
        for _ in 0..words {
            self.word("a word")?;
        }
        for _ in 0..self.count("the number of whole numbers")? {
            self.number()?;
        }
        let mut reals = vec![];
        for _ in 0..self.count("the number of numbers")? {
            reals.push(self.number()?);
        }
        let span = modifier.span.start..self.words.at;
        let primitive = Primitive { kind, name, reals, span };
        match primitive.kind.text.as_str() {
            "polygon" => self.polygon(modifier, primitive),
            kind if REFLECTING_MATERIALS.contains(&kind) || EMITTING_MATERIALS.contains(&kind) => {
                self.material(modifier, primitive)
            }
            kind if ROUND_SURFACES.contains(&kind) => {
                let what = format!("a {kind} is not read");
                let help = "cut it into polygons, such as with gensurf, or make it a sphere, disc or cylinder of a scene file";
                Err(self.error(&primitive.kind.span, what, help))
            }
            "mesh" | "source" => {
                let help = "leave it out, or write it as polygons";
                Err(self.error(&primitive.kind.span, format!("a {} is not read", primitive.kind.text), help))
            }
            kind => {
                self.known.insert(primitive.name.text.clone(), Known::Other(kind.to_owned()));
                Ok(())
            }
        }
    }

    fn count(&mut self, what: &str) -> Result<u64, SceneError> {
        let word = self.word(what)?;
        word.text.parse().map_err(|_| {
            let text = format!("`{}` stands where {what} should be", word.text);
            self.error(&word.span, text, "write a whole number, then as many arguments")
        })
    }

    fn number(&mut self) -> Result<f64, SceneError> {
        let word = self.word("a number")?;
        word.text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
            let what = format!("`{}` is not a finite number", word.text);
            self.error(&word.span, what, "write a number; the count before the arguments may be wrong")
        })
    }

    fn meaning(&self, name: &Name) -> Result<Known, SceneError> {
        self.known.get(&name.text).cloned().ok_or_else(|| {
            let what = format!("there is no material `{}` above this line", name.text);
            self.error(&name.span, what, "define it first, or mend its name")
        })
    }

    fn material(&mut self, modifier: &Name, primitive: Primitive) -> Result<(), SceneError> {
        let Primitive { kind, name, reals, span } = primitive;
        if modifier.text != "void" {
            let what = format!("the pattern or texture `{}` of `{}` is not read", modifier.text, name.text);
            let help = "the colour of the material is taken as it stands".to_owned();
            self.notes.push(Note { span: modifier.span.clone(), what, help });
        }
        let is_light = EMITTING_MATERIALS.contains(&kind.text.as_str());
        let (colour, specular) = match reals[..] {
            [r, g, b, specular, _] if !is_light => ([r, g, b], specular),
            [r, g, b] | [r, g, b, _] if is_light => ([r, g, b], 0.0),
            _ => {
                let what = format!("{} numbers for a material of type {}", reals.len(), kind.text);
                let help = "plastic has 5: red, green, blue, specularity, roughness; light has 3 and glow 4";
                return Err(self.error(&span, what, help));
            }
        };
        if !(0.0..=1.0).contains(&specular) {
            let help = "write a specularity from 0 to 1";
            return Err(self.error(&span, format!("the specularity {specular} is out of range"), help));
        }
        if specular > 0.0 {
            let what = format!(
                "the share {specular} of what `{}` reflects is specular, and not taken over",
                name.text
            );
            let help = "its reflectance is the colour times 1 − specularity".to_owned();
            self.notes.push(Note { span: span.clone(), what, help });
        }
        let (diffuse, emission) = if is_light {
            (Some(([0.0; 3], span.clone())), Some((colour, span.clone())))
        } else {
            (Some((colour.map(|c| c * (1.0 - specular)), span.clone())), None)
        };
        self.known.insert(name.text.clone(), Known::Material(self.materials.len()));
        let same = self.materials.iter().filter(|other| other.name == name.text).count();
        let text = if same == 0 { name.text } else { format!("{} {}", name.text, self.materials.len()) };
        self.materials.push(MeshMaterial { name: text, diffuse, emission, picture: None, span });
        Ok(())
    }

    fn polygon(&mut self, modifier: &Name, primitive: Primitive) -> Result<(), SceneError> {
        let Primitive { name, reals, span, .. } = primitive;
        if reals.len() % 3 != 0 {
            let what = format!("{} coordinates for a polygon", reals.len());
            return Err(self.error(&span, what, "write three numbers a corner"));
        }
        check_corners(self.source, reals.len() / 3, span.clone())?;
        let index = match self.meaning(modifier)? {
            Known::Material(index) => index,
            Known::Other(kind) => {
                let what = format!("a material of type {kind}, which is not diffuse, is not read");
                return Err(self.error(&modifier.span, what, "use plastic, light or glow"));
            }
        };
        let object = object(&name.text);
        let material = self.materials[index].name.clone();
        let next = self.groups.len();
        let at = *self.numbers.entry((object.clone(), material.clone())).or_insert(next);
        if at == next {
            let material = Some(Name { text: material, span: modifier.span.clone() });
            self.groups.push(Group { object: Some(object), material, ..Group::default() });
        }
        let corners = reals.chunks_exact(3).map(Vec3::from_slice).collect();
        self.groups[at].faces.push(ImportedFace { corners, span });
        Ok(())
    }
}

/// The object of a polygon: its identifier up to the number that programs put behind it.
fn object(identifier: &str) -> String {
    match identifier.rsplit_once('.') {
        Some((object, number)) if !object.is_empty() && number.chars().all(|c| c.is_ascii_digit()) => {
            object.to_owned()
        }
        _ => identifier.to_owned(),
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;
    use crate::Place;

    const TEXT: &str = "# two\nvoid plastic clay\n0\n0\n5 .5 .4 .3 0.1 0\nvoid light lamp\n0\n0\n3 2 3 4\nvoid alias brick clay\n\
        brick polygon wall.1\n0\n0\n9 0 0 0 1 0 0 0 1 0\nbrick polygon wall.2\n0 0 9\n 0 0 1 # z\n 1 0 1 0 1 1\n\
        lamp polygon top\n0 0 12 0 0 2 0 1 2 1 1 2 1 0 2\n";

    fn read(text: &str) -> Result<Imported, SceneError> {
        import(Source::of("a.rad".as_ref(), text.to_owned()))
    }

    #[test]
    fn polygons_and_materials_are_found() {
        let found = read(TEXT).unwrap();
        let shape: Vec<_> = found
            .groups
            .iter()
            .map(|g| {
                (g.object.as_deref().unwrap(), g.material.as_ref().unwrap().text.as_str(), g.faces.len())
            })
            .collect();
        assert_eq!(shape, [("wall", "clay", 2), ("top", "lamp", 1)]);
        let diffuse = found.materials[0].diffuse.as_ref().unwrap().0;
        assert!((diffuse[0] - 0.45).abs() < 1e-15, "{diffuse:?}");
        assert_eq!(found.materials[1].emission.as_ref().unwrap().0, [2.0, 3.0, 4.0]);
        assert!(found.notes[0].what.contains("the share 0.1"));
    }

    #[test]
    fn errors_name_the_line() {
        for (from, to, line) in [
            ("5 .5", "6 .5", 6),
            ("brick polygon wall.1", "steel polygon wall.1", 11),
            ("polygon top", "sphere top", 18),
            ("9 0 0 0 1", "10 0 0 0 1", 15),
            ("1 0 2\n", "1 0\n", 20),
            ("plastic clay", "glass clay", 10),
            ("# two", "!genbox", 1),
            ("1 0 1 0 1 1", "1 0 nan 0 1 1", 18),
        ] {
            let error = read(&TEXT.replacen(from, to, 1)).unwrap_err();
            assert!(
                matches!(error.place(), Some(Place::Line { line: found, .. }) if found.abs_diff(line) <= 1),
                "{line}: {error}"
            );
        }
    }
}

//! View3D geometry (.vs3), vertices and surfaces (`F 3`): what radiates, what only blocks the view,
//! what is combined.
//!
//! Format: G. N. Walton, *Calculation of Obstructed View Factors by Adaptive Integration*, NISTIR
//! 6925, 2002, and the View3D user manual, version 3.3. A record is a line; its first letter, in
//! either case, says which:
//!
//! | record | contents |
//! |---|---|
//! | `T` | title |
//! | `C` | controls, `name=value` |
//! | `F` | form of the geometry: `3` |
//! | `V` | number, x, y, z |
//! | `S` | number, four vertices (the fourth 0 for a triangle), base, combine, emittance, name |
//! | `O` | number, four vertices: blocks the view and does not radiate |
//! | `!`, `/` | comment |
//! | `E`, `*` | end |
//!
//! Vertices run counter-clockwise seen from the front. Masks (`M`), null surfaces (`N`) and the
//! form `3a` are refused.

use std::ops::Range;

use fredholm_mesh::Vec3;

use super::{Group, Imported, ImportedFace};
use crate::error::{ErrorKind, SceneError};
use crate::source::Source;
use crate::suggest::among;

/// Controls that View3D knows. Those that no function here reads steer how View3D integrates or
/// what it prints.
const CONTROLS: [&str; 13] =
    ["eps", "encl", "emit", "out", "list", "maxu", "maxo", "mino", "maxd", "maxv", "row", "col", "prjd"];

/// A surface of the file.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    pub corners: Vec<Vec3>,
    /// `None` for one that does not radiate.
    pub radiates: Option<Radiating>,
    pub span: Range<usize>,
}

/// What a radiating surface has besides its corners.
#[derive(Clone, Debug)]
pub(crate) struct Radiating {
    /// Index of the surface that it is a part of.
    pub base: Option<usize>,
    /// Index of the surface that it is added to.
    pub combined: Option<usize>,
    pub emissivity: f64,
    pub name: String,
}

/// What the control record says that matters here.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Control {
    pub tolerance: Option<f64>,
    pub enclosure: bool,
    pub emittances: bool,
}

/// A file of View3D.
#[derive(Debug)]
pub(crate) struct View3d {
    pub source: Source,
    pub title: Option<String>,
    pub control: Control,
    pub surfaces: Vec<Surface>,
}

/// Reads a file.
pub(crate) fn parse(source: Source) -> Result<View3d, SceneError> {
    let mut reader = Reader {
        source: &source,
        vertices: vec![],
        surfaces: vec![],
        title: None,
        control: Control::default(),
    };
    for record in records(&source.text) {
        reader.record(&record)?;
    }
    let Reader { surfaces, title, control, .. } = reader;
    if surfaces.iter().all(|surface| surface.radiates.is_none()) {
        let end = source.text.len();
        let help = "add records S; if the file ends early, it was cut short";
        return Err(source.error(ErrorKind::Empty, end..end, "the file holds no radiating surface", help));
    }
    Ok(View3d { source, title, control, surfaces })
}

/// The faces for a scene, grouped by name. What a scene cannot express is refused.
pub(super) fn import(source: Source) -> Result<Imported, SceneError> {
    let View3d { source, surfaces, .. } = parse(source)?;
    let mut groups: Vec<Group> = vec![];
    for surface in &surfaces {
        let Some(name) = scene_name(&surfaces, surface) else {
            let help = "leave it out of the scene's file, or give the file itself to `fredholm viewfactors`";
            let what = "a scene has neither obstructions nor subsurfaces";
            return Err(source.error(ErrorKind::Value, surface.span.clone(), what, help));
        };
        let face = ImportedFace { corners: surface.corners.clone(), span: surface.span.clone() };
        match groups.iter_mut().find(|group| group.object.as_ref() == Some(name)) {
            Some(group) => group.faces.push(face),
            None => groups.push(Group { object: Some(name.clone()), faces: vec![face], ..Group::default() }),
        }
    }
    Ok(Imported::new(source, groups))
}

/// The name under which a surface goes into a scene: that of the one it is combined with.
fn scene_name<'a>(surfaces: &'a [Surface], surface: &'a Surface) -> Option<&'a String> {
    let radiating = surface.radiates.as_ref().filter(|radiating| radiating.base.is_none())?;
    let target = radiating.combined.and_then(|index| surfaces[index].radiates.as_ref());
    Some(&target.unwrap_or(radiating).name)
}

/// A line with at least one word.
struct Record<'a> {
    words: Vec<(&'a str, Range<usize>)>,
    /// The line behind its first word, comment included.
    rest: &'a str,
    span: Range<usize>,
}

/// The records up to the end of data.
fn records(text: &str) -> impl Iterator<Item = Record<'_>> {
    let mut start = 0;
    let lines = text.split_inclusive('\n').map(move |line| {
        start += line.len();
        (start - line.len(), line)
    });
    lines
        .filter_map(|(start, line)| record(start, line))
        .take_while(|record| !matches!(initial(record.words[0].0), 'E' | '*'))
}

fn record(start: usize, line: &str) -> Option<Record<'_>> {
    let content = line.split('!').next().unwrap_or_default();
    let mut words = vec![];
    let mut at = 0;
    for piece in content.split_inclusive(is_space) {
        let word = piece.trim_end_matches(is_space);
        if !word.is_empty() {
            words.push((word, start + at..start + at + word.len()));
        }
        at += piece.len();
    }
    let (first, span) = words.first()?;
    if first.starts_with('/') {
        return None;
    }
    let rest = line[span.end - start..].trim();
    let span = span.start..words.last()?.1.end;
    Some(Record { words, rest, span })
}

fn is_space(c: char) -> bool {
    c.is_whitespace() || c == ','
}

fn initial(word: &str) -> char {
    word.chars().next().unwrap_or_default().to_ascii_uppercase()
}

/// What has been read so far.
struct Reader<'a> {
    source: &'a Source,
    vertices: Vec<Vec3>,
    surfaces: Vec<Surface>,
    title: Option<String>,
    control: Control,
}

impl Reader<'_> {
    fn record(&mut self, record: &Record) -> Result<(), SceneError> {
        match initial(record.words[0].0) {
            'T' => self.title = Some(record.rest.to_owned()),
            'C' => self.control(record)?,
            'F' => self.form(record)?,
            'V' => self.vertex(record)?,
            'S' | 'O' => self.surface(record)?,
            letter => return Err(self.unknown(record, letter)),
        }
        Ok(())
    }

    fn error(&self, kind: ErrorKind, span: &Range<usize>, what: impl AsRef<str>, help: &str) -> SceneError {
        self.source.error(kind, span.clone(), what, help)
    }

    fn unknown(&self, record: &Record, letter: char) -> SceneError {
        let span = &record.words[0].1;
        let (what, help) = match letter {
            'M' | 'N' => (
                format!("mask and null surfaces (`{letter}`) are not read"),
                "cut the covered part out of its base; parts are put together by the combine column",
            ),
            'X' => (
                "coordinate transformations (`X`) are not read".to_owned(),
                "transform the vertices and leave it out",
            ),
            _ => (
                format!("unknown record `{}`", record.words[0].0),
                "records begin with T, C, F, V, S, O, E, or ! for a comment; mend the line if it is damaged",
            ),
        };
        self.error(ErrorKind::Syntax, span, what, help)
    }

    fn form(&self, record: &Record) -> Result<(), SceneError> {
        match record.words.get(1) {
            Some((word, _)) if *word == "3" => Ok(()),
            Some((word, span)) => {
                let what = format!("the geometry `{word}` is not read");
                let help = "write the geometry as vertices and surfaces, `F 3`";
                Err(self.error(ErrorKind::Value, span, what, help))
            }
            None => Err(self.error(
                ErrorKind::Syntax,
                &record.span,
                "the form of the geometry is missing",
                "write `F 3`",
            )),
        }
    }

    /// Pairs of a name and a value, with `=`, blanks or commas between them.
    fn control(&mut self, record: &Record) -> Result<(), SceneError> {
        let mut words = vec![];
        for (word, span) in &record.words[1..] {
            let mut at = span.start;
            for piece in word.split_inclusive('=') {
                let text = piece.trim_end_matches('=');
                if !text.is_empty() {
                    words.push((text, at..at + text.len()));
                }
                at += piece.len();
            }
        }
        words.chunks(2).try_for_each(|pair| self.setting(pair))
    }

    fn setting(&mut self, pair: &[(&str, Range<usize>)]) -> Result<(), SceneError> {
        let [(name, span), value @ ..] = pair else { return Ok(()) };
        let known = name.to_ascii_lowercase();
        if !CONTROLS.contains(&known.as_str()) {
            let help = among(&known, CONTROLS, "controls");
            return Err(self.error(ErrorKind::UnknownKey, span, format!("unknown control `{name}`"), &help));
        }
        let Some((text, place)) = value.first() else {
            let what = format!("the control `{name}` has no value");
            return Err(self.error(ErrorKind::MissingKey, span, what, "write name=value, such as encl=1"));
        };
        let number = self.number(text, place, "the control")?;
        match known.as_str() {
            "eps" if number > 0.0 && number < 1.0 => self.control.tolerance = Some(number),
            "eps" => {
                let what = format!("eps is {text}, outside its range");
                return Err(self.error(ErrorKind::Value, place, what, "write a number above 0 and below 1"));
            }
            "encl" => self.control.enclosure = number != 0.0,
            "emit" => self.control.emittances = number != 0.0,
            _ => {}
        }
        Ok(())
    }

    fn vertex(&mut self, record: &Record) -> Result<(), SceneError> {
        self.numbered(record, self.vertices.len(), "vertex")?;
        let mut vertex = [0.0; 3];
        for (value, at) in vertex.iter_mut().zip(2..) {
            let (word, span) = self.word(record, at, "a vertex has a number and three coordinates")?;
            *value = self.number(word, span, "the coordinate")?;
        }
        self.vertices.push(Vec3::from_array(vertex));
        Ok(())
    }

    fn surface(&mut self, record: &Record) -> Result<(), SceneError> {
        self.numbered(record, self.surfaces.len(), "surface")?;
        let corners = self.corners(record)?;
        let blocks = initial(record.words[0].0) == 'O';
        let radiates = if blocks { None } else { Some(self.radiating(record)?) };
        self.surfaces.push(Surface { corners, radiates, span: record.span.clone() });
        Ok(())
    }

    fn corners(&self, record: &Record) -> Result<Vec<Vec3>, SceneError> {
        let count = self.vertices.len();
        let mut corners = vec![];
        for at in 2..6 {
            let (word, span) =
                self.word(record, at, "a surface has a number and four vertices, the last 0 for a triangle")?;
            match self.whole(word, span)? {
                0 if at == 5 => {}
                number if (1..=count).contains(&number) => corners.push(self.vertices[number - 1]),
                number => {
                    let what = format!("there is no vertex {number}: {count} vertices stand above this line");
                    let help =
                        format!("use numbers from 1 to {count}; 0 only as the fourth vertex of a triangle");
                    return Err(self.error(ErrorKind::Value, span, what, &help));
                }
            }
        }
        Ok(corners)
    }

    fn radiating(&self, record: &Record) -> Result<Radiating, SceneError> {
        let base = self.earlier(record, 6, "base")?;
        let combined = self.earlier(record, 7, "combine")?;
        let target = combined.and_then(|index| self.surfaces[index].radiates.as_ref());
        if combined.is_some() && target.is_none_or(|target| target.combined.is_some()) {
            let what = "surfaces cannot be combined with an obstruction, or in a chain";
            let help = "name a surface S that is not itself combined with another";
            return Err(self.error(ErrorKind::Value, &record.words[7].1, what, help));
        }
        let (word, span) = self.word(record, 8, "a radiating surface has an emittance")?;
        let emissivity = self.number(word, span, "the emittance")?;
        if !(0.0..=1.0).contains(&emissivity) {
            let what = format!("the emittance is {word}, outside its range");
            return Err(self.error(ErrorKind::Value, span, what, "write a number from 0 to 1"));
        }
        let number = self.surfaces.len() + 1;
        let name =
            record.words.get(9).map_or_else(|| format!("surface-{number}"), |(name, _)| (*name).to_owned());
        Ok(Radiating { base, combined, emissivity, name })
    }

    /// Index of the surface that column `at` names; `None` for 0.
    fn earlier(&self, record: &Record, at: usize, column: &str) -> Result<Option<usize>, SceneError> {
        let (word, span) =
            self.word(record, at, "a radiating surface has a base, a combine number and an emittance")?;
        let number = self.whole(word, span)?;
        if number > self.surfaces.len() {
            let what = format!("the {column} surface {number} does not stand above this line");
            return Err(self.error(ErrorKind::Value, span, what, "name an earlier surface, or 0 for none"));
        }
        Ok(number.checked_sub(1))
    }

    /// Refuses a record whose number is not the next.
    fn numbered(&self, record: &Record, above: usize, thing: &str) -> Result<(), SceneError> {
        let (word, span) = self.word(record, 1, "a vertex or a surface has a number")?;
        let (number, next) = (self.whole(word, span)?, above + 1);
        if number == next {
            return Ok(());
        }
        let what = format!("{thing} {number} is out of sequence: the next is {next}");
        Err(self.error(ErrorKind::Value, span, what, "number vertices, and surfaces, from 1 without gaps"))
    }

    fn word<'r>(
        &self,
        record: &'r Record,
        at: usize,
        rule: &str,
    ) -> Result<(&'r str, &'r Range<usize>), SceneError> {
        record.words.get(at).map(|(word, span)| (*word, span)).ok_or_else(|| {
            let help = format!("{rule}; if the file ends here, it was cut short");
            self.error(ErrorKind::Syntax, &record.span, "the record is too short", &help)
        })
    }

    fn whole(&self, word: &str, span: &Range<usize>) -> Result<usize, SceneError> {
        word.parse().map_err(|_| {
            let what = format!("`{word}` is not a whole number, 0 or more");
            self.error(ErrorKind::Value, span, what, "write digits only, such as 12")
        })
    }

    fn number(&self, word: &str, span: &Range<usize>, quantity: &str) -> Result<f64, SceneError> {
        word.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
            let what = format!("{quantity} `{word}` is not a finite number");
            self.error(ErrorKind::Value, span, what, "write a number between -1.7e308 and 1.7e308")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VERTICES: &str = "V 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\n";

    fn parsed(text: &str) -> Result<View3d, SceneError> {
        parse(Source::of("a.vs3".as_ref(), text.to_owned()))
    }

    #[test]
    fn records_are_read_in_any_layout() {
        let text = format!(
            "t A box, open\nc EPS = 1e-5,encl=1 emit 0 ! all\n! note\n/ note\nF 3\n{VERTICES}\
            s 1,1,2,3,4,0,0,.5,floor ! the floor\nS\t2 1 2 3 0 0 1 0.9\nO 3 1 2 4 0\nEnd of data\nnonsense\n"
        );
        let file = parsed(&text).unwrap();
        assert_eq!(file.title.as_deref(), Some("A box, open"));
        assert_eq!(
            (file.control.tolerance, file.control.enclosure, file.control.emittances),
            (Some(1e-5), true, false)
        );
        assert_eq!(file.surfaces[0].corners, [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y]);
        let second = file.surfaces[1].radiates.as_ref().unwrap();
        assert_eq!(
            (file.surfaces[1].corners.len(), second.combined, second.name.as_str()),
            (3, Some(0), "surface-2")
        );
        assert!(file.surfaces[2].radiates.is_none() && file.surfaces.len() == 3);
    }

    #[test]
    fn errors_point_at_the_word() {
        let place = |text: &str| parsed(&format!("{VERTICES}{text}")).unwrap_err().place();
        let at = |line, column| Some(crate::Place::Line { line, column });
        assert_eq!(place("V 5 0 0 inf"), at(5, 9));
        assert_eq!(place("V 7 0 0 0"), at(5, 3));
        assert_eq!(place("S 1 1 2 9 0 0 0 0.5 a"), at(5, 9));
        assert_eq!(place("S 1 1 2 3 0 0 4 0.5 a"), at(5, 15));
        assert_eq!(place("C eps=1e-4 encl"), at(5, 12));
        assert_eq!(place("C  epss=1e-4"), at(5, 4));
        assert_eq!(place("F 3a"), at(5, 3));
        assert_eq!(place("M 1 1 2 3 0 0 0 0.5 a"), at(5, 1));
    }

    #[test]
    fn pieces_go_into_a_scene_under_the_name_of_what_they_are_combined_with() {
        let text = format!("{VERTICES}S 1 1 2 3 0 0 0 0.5 a\nS 2 1 3 4 0 0 1 0.5 b\nS 3 1 2 4 0 0 0 0.5 c\n");
        let groups = import(Source::of("a.vs3".as_ref(), text)).unwrap().groups;
        let sizes: Vec<_> = groups.iter().map(|g| (g.object.as_deref().unwrap(), g.faces.len())).collect();
        assert_eq!(sizes, [("a", 2), ("c", 1)]);
    }
}

//! Wavefront OBJ: corners, faces, objects and material names.
//!
//! Format: Wavefront Technologies, Advanced Visualizer Manual, appendix B1. Indices count from 1;
//! negative ones count back from the last corner read so far. Texture coordinates, normals, lines
//! and points are passed over; free-form surfaces are refused, since a part of the geometry would
//! be missing without notice.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use fredholm_mesh::Vec3;

use super::{Group, Imported, ImportedFace, MOST_CORNERS, Name};
use crate::error::{ErrorKind, SceneError};
use crate::source::Source;

/// Statements that change no surface.
const PASSED_OVER: [&str; 15] = [
    "vt",
    "vn",
    "vp",
    "s",
    "l",
    "p",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "maplib",
    "usemap",
];

pub(super) fn parse(source: Source) -> Result<Imported, SceneError> {
    let mut reader = Reader::new(&source);
    for statement in (Statements { text: &source.text, start: 0 }) {
        reader.statement(&statement)?;
    }
    let Reader { groups, libraries, .. } = reader;
    Ok(Imported { libraries, ..Imported::new(source, groups) })
}

/// A statement: one line, or several that a backslash at the end joins.
struct Statement<'a> {
    text: Cow<'a, str>,
    span: Range<usize>,
}

/// The statements of a text, one after the other: a file of many lines is not held twice.
struct Statements<'a> {
    text: &'a str,
    /// Where the next line begins.
    start: usize,
}

impl<'a> Statements<'a> {
    /// The next line without its comment, and where it lies.
    fn line(&mut self) -> Option<(&'a str, Range<usize>)> {
        let start = self.start;
        let line = self.text[start..].split_inclusive('\n').next()?;
        self.start += line.len();
        let content = line.split('#').next().unwrap_or_default().trim_end();
        Some((content, start..start + content.len()))
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = Statement<'a>;

    fn next(&mut self) -> Option<Statement<'a>> {
        let (mut piece, mut span) = self.line()?;
        let mut text = Cow::Borrowed(piece.strip_suffix('\\').unwrap_or(piece));
        while piece.ends_with('\\') {
            let Some((line, place)) = self.line() else { break };
            piece = line;
            span.end = place.end;
            let joined = text.to_mut();
            joined.push(' ');
            joined.push_str(piece.strip_suffix('\\').unwrap_or(piece));
        }
        Some(Statement { text, span })
    }
}

/// What has been read so far.
struct Reader<'a> {
    source: &'a Source,
    corners: Vec<Vec3>,
    groups: Vec<Group>,
    /// Index of the group of an object and a material.
    numbers: BTreeMap<(Option<String>, Option<String>), usize>,
    /// Object of the next face.
    object: Option<String>,
    /// Material of the next face.
    material: Option<Name>,
    /// Group of the next face, once it has been looked up.
    open: Option<usize>,
    libraries: Vec<Name>,
}

impl<'a> Reader<'a> {
    fn new(source: &'a Source) -> Self {
        let (corners, groups, libraries) = (vec![], vec![], vec![]);
        let (numbers, object, material, open) = (BTreeMap::new(), None, None, None);
        Self { source, corners, groups, numbers, object, material, open, libraries }
    }
}

impl Reader<'_> {
    fn statement(&mut self, statement: &Statement) -> Result<(), SceneError> {
        let text = statement.text.trim();
        let (keyword, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let rest = rest.trim();
        match keyword {
            "v" => self.corner(statement, rest)?,
            "f" => self.face(statement, rest)?,
            "o" | "g" => (self.object, self.open) = ((!rest.is_empty()).then(|| rest.to_owned()), None),
            "usemtl" => {
                (self.material, self.open) = (Some(name(self.source, statement, rest, "material")?), None);
            }
            "mtllib" => self.libraries.push(name(self.source, statement, rest, "file")?),
            "" => {}
            _ if PASSED_OVER.contains(&keyword) => {}
            _ => return Err(unknown(self.source, statement, keyword)),
        }
        Ok(())
    }

    fn corner(&mut self, statement: &Statement, rest: &str) -> Result<(), SceneError> {
        let mut words = rest.split_whitespace();
        let mut corner = [0.0; 3];
        for value in &mut corner {
            *value = coordinate(self.source, statement, words.next())?;
        }
        self.corners.push(Vec3::from_array(corner));
        Ok(())
    }

    fn face(&mut self, statement: &Statement, rest: &str) -> Result<(), SceneError> {
        let count = rest.split_whitespace().take(MOST_CORNERS + 1).count();
        if count > MOST_CORNERS {
            let what = format!("a face of more than {MOST_CORNERS} corners");
            let help = "cut it into smaller faces";
            return Err(self.source.error(ErrorKind::TooLarge, statement.span.clone(), what, help));
        }
        let corners = rest.split_whitespace().map(|word| self.index(statement, word));
        let corners: Vec<Vec3> = corners.collect::<Result<_, _>>()?;
        if corners.len() < 3 {
            let what = format!("a face of {} corners", corners.len());
            let help = "give a face at least three corners; if the file ends here, it was cut short";
            return Err(self.source.error(ErrorKind::Syntax, statement.span.clone(), what, help));
        }
        let face = ImportedFace { corners, span: statement.span.clone() };
        self.group().faces.push(face);
        Ok(())
    }

    /// The group of the current object and material.
    fn group(&mut self) -> &mut Group {
        let index = self.open.unwrap_or_else(|| {
            let key = (self.object.clone(), self.material.as_ref().map(|name| name.text.clone()));
            *self.numbers.entry(key).or_insert(self.groups.len())
        });
        if index == self.groups.len() {
            let (object, material) = (self.object.clone(), self.material.clone());
            self.groups.push(Group { object, material, ..Group::default() });
        }
        self.open = Some(index);
        &mut self.groups[index]
    }

    /// The corner that `1`, `1/2`, `1//3`, `1/2/3` or a negative index names.
    fn index(&self, statement: &Statement, word: &str) -> Result<Vec3, SceneError> {
        let span = within(self.source, statement, word);
        let count = self.corners.len();
        let error =
            |what: String, help: String| self.source.error(ErrorKind::Value, span.clone(), what, help);
        let number = word.split('/').next().unwrap_or_default();
        let Ok(index) = number.parse::<i64>() else {
            let what = format!("`{number}` is not an index of a corner");
            return Err(error(what, "write a whole number, such as 1, 1/2 or 1//3".to_owned()));
        };
        let position = if index < 0 { count as i128 + i128::from(index) } else { i128::from(index) - 1 };
        let corner = usize::try_from(position).ok().and_then(|position| self.corners.get(position));
        corner.copied().ok_or_else(|| {
            let what = format!("there is no corner {index}: {count} corners stand above this line");
            error(what, format!("use indices from 1 to {count}, or from -1 back to -{count}"))
        })
    }
}

fn coordinate(source: &Source, statement: &Statement, word: Option<&str>) -> Result<f64, SceneError> {
    let Some(word) = word else {
        let help = "write three numbers; if the file ends here, it was cut short";
        let what = "a corner with fewer than three coordinates";
        return Err(source.error(ErrorKind::Syntax, statement.span.clone(), what, help));
    };
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => {
            let what = format!("the coordinate `{word}` is not a finite number");
            let help = "write a number between -1.7e308 and 1.7e308";
            Err(source.error(ErrorKind::Value, within(source, statement, word), what, help))
        }
    }
}

fn name(source: &Source, statement: &Statement, text: &str, thing: &str) -> Result<Name, SceneError> {
    if text.is_empty() {
        let what = format!("the name of the {thing} is missing");
        let help = format!("write the name of a {thing} behind the keyword");
        return Err(source.error(ErrorKind::Syntax, statement.span.clone(), what, help));
    }
    Ok(Name { text: text.to_owned(), span: within(source, statement, text) })
}

fn unknown(source: &Source, statement: &Statement, keyword: &str) -> SceneError {
    let span = within(source, statement, keyword);
    let help = "only flat faces are read (v, f, o, g, usemtl, mtllib); \
                export the mesh as polygons, or mend the line if it is damaged";
    source.error(ErrorKind::Syntax, span, format!("unknown statement `{keyword}`"), help)
}

/// Where a word of a statement stands.
fn within(source: &Source, statement: &Statement, word: &str) -> Range<usize> {
    let Range { start, end } = statement.span;
    let found = source.piece(start..end).match_indices(word).map(|(i, _)| start + i).find(|&i| {
        let stop = i + word.len();
        let space = |text: &str, c: Option<char>| text.is_empty() || c.is_none_or(char::is_whitespace);
        let (before, behind) = (source.piece(start..i), source.piece(stop..end));
        space(before, before.chars().next_back()) && space(behind, behind.chars().next())
    });
    found.map_or(start..end, |i| i..i + word.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Imported, SceneError> {
        parse(Source::of("a.obj".as_ref(), text.to_owned()))
    }

    const UNIT_SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn all_ways_of_naming_a_corner_give_the_same_face() {
        for face in
            ["f 1 2 3 4", "f 1/1 2/2 3/3 4/4", "f 1//1 2//1 3//1 4//1", "f -4/9/9 -3 -2 -1", "f 1 2 \\\n 3 4"]
        {
            let groups = parsed(&format!("{UNIT_SQUARE}{face}\n")).unwrap().groups;
            assert_eq!(
                groups[0].faces[0].corners,
                [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y],
                "{face}"
            );
        }
    }

    #[test]
    fn a_face_has_a_bounded_number_of_corners() {
        let face = |corners: usize| parsed(&format!("{UNIT_SQUARE}f{}\n", " 1 2 3 4".repeat(corners / 4)));
        assert!(face(MOST_CORNERS).is_ok());
        let error = face(MOST_CORNERS + 4).unwrap_err();
        assert!(error.kind() == ErrorKind::TooLarge && error.to_string().contains("a.obj:5"), "{error}");
    }

    #[test]
    fn joined_lines_are_one_statement_up_to_the_end_of_the_file() {
        let found: Vec<(String, Range<usize>)> = Statements { text: "a \\\n b\\\n\nc # \\\nd\\", start: 0 }
            .map(|statement| (statement.text.into_owned(), statement.span))
            .collect();
        let expected = [("a   b ", 0..8), ("c", 9..10), ("d", 15..17)];
        assert_eq!(found, expected.map(|(text, span)| (text.to_owned(), span)));
    }

    #[test]
    fn negative_indices_count_from_the_last_corner_read_so_far() {
        let groups = parsed(&format!("{UNIT_SQUARE}f -3 -2 -1\nv 9 9 9\nf -4 -3 -2\n")).unwrap().groups;
        assert_eq!(groups[0].faces[0].corners, groups[0].faces[1].corners);
    }

    #[test]
    fn faces_are_grouped_by_object_and_material() {
        let text = "o a\nusemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\no b\nf 1 2 3\nl 1 2 3 4\no a\nf 1 2 4\ng\nf 1 2 3 4\n";
        let groups = parsed(&format!("{UNIT_SQUARE}{text}")).unwrap().groups;
        let names: Vec<_> = groups
            .iter()
            .map(|g| (g.object.as_deref(), g.material.as_ref().map(|m| m.text.as_str()), g.faces.len()))
            .collect();
        let expected = [
            (Some("a"), Some("m"), 1),
            (Some("a"), Some("n"), 2),
            (Some("b"), Some("n"), 1),
            (None, Some("n"), 1),
        ];
        assert_eq!(names, expected);
    }

    #[test]
    fn errors_point_at_the_word() {
        let column = |text: &str| parsed(text).unwrap_err().place();
        let at = |line, column| Some(crate::Place::Line { line, column });
        assert_eq!(column("v 0 0 nan\n"), at(1, 7));
        assert_eq!(column("v 1 0 0\nv 0 1 1e400 # far\n"), at(2, 7));
        assert_eq!(column(&format!("{UNIT_SQUARE}f 1 2 18446744073709551616\n")), at(5, 7));
        assert_eq!(column(&format!("{UNIT_SQUARE}f 1 2 0\n")), at(5, 7));
        assert_eq!(column(&format!("{UNIT_SQUARE}f 1 11 1/7\n")), at(5, 5));
        assert_eq!(column("curv 0 1 2\n"), at(1, 1));
    }
}

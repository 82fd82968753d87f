//! STL: triangles, as text or binary.
//!
//! Format: 3D Systems, StereoLithography Interface Specification, 1988. A binary file is a header
//! of 80 bytes, the number of triangles (u32) and 50 bytes a triangle: normal, three corners (f32),
//! and two bytes that are passed over. All numbers are little endian. Normals are not read: the lit
//! side is the one from which the corners run counter-clockwise.

use std::path::Path;

use super::cursor::{Cursor, Encoding, Scalar};
use super::{Group, Imported, ImportedFace, Note};
use crate::error::SceneError;
use crate::source::Source;

/// Bytes before the first triangle, and of a triangle.
const BYTES_OF_HEADER: usize = 80;
const BYTES_OF_A_TRIANGLE: usize = 50;

pub(super) fn import(path: &Path, bytes: Vec<u8>) -> Result<Imported, SceneError> {
    if is_text(&bytes) {
        return text(Source::decode_mesh(path, bytes)?);
    }
    let source = Source::binary(path);
    let (group, note) = binary(&source, &bytes)?;
    Ok(Imported { notes: note.into_iter().collect(), ..Imported::new(source, vec![group]) })
}

/// Whether a file is text. Binary ones may begin with `solid`, too, but then have the right length.
fn is_text(bytes: &[u8]) -> bool {
    let count =
        bytes.get(BYTES_OF_HEADER..BYTES_OF_HEADER + 4).map_or(0.0, |bytes| Scalar::U32.of_little(bytes));
    let expected = (BYTES_OF_HEADER + 4) as f64 + BYTES_OF_A_TRIANGLE as f64 * count;
    let begins = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let is_binary = bytes.len() > BYTES_OF_HEADER + 4 && (expected - bytes.len() as f64).abs() < 0.5;
    begins && !is_binary && !bytes.contains(&0)
}

fn binary(source: &Source, bytes: &[u8]) -> Result<(Group, Option<Note>), SceneError> {
    let mut cursor = Cursor::new(source, bytes, Encoding::Little);
    cursor.take(BYTES_OF_HEADER, "the header of a binary STL file")?;
    let count = cursor.number(Scalar::U32, "the number of triangles")? as u64;
    let mut group = Group::default();
    for triangle in 0..count {
        let start = cursor.at;
        if bytes.len() - start < BYTES_OF_A_TRIANGLE {
            return Err(cursor.ended(&format!("triangle {triangle} of {count}")));
        }
        cursor.take(12, "a normal")?;
        let mut corners = vec![];
        for _ in 0..3 {
            corners.push(cursor.point(Scalar::F32)?);
        }
        cursor.take(2, "the attribute")?;
        group.faces.push(ImportedFace { corners, span: start..cursor.at });
    }
    let left = bytes.len() - cursor.at;
    let note = (left > 0).then(|| Note {
        span: cursor.at..cursor.at,
        what: format!("{left} bytes stand behind the {count} triangles that the header counts; not read"),
        help: "write the file anew if triangles are missing".to_owned(),
    });
    Ok((group, note))
}

/// Solids of facets, each of an outer loop of three vertices.
fn text(source: Source) -> Result<Imported, SceneError> {
    let mut groups: Vec<Group> = vec![];
    let mut cursor = Cursor::new(&source, source.text.as_bytes(), Encoding::Text);
    let mut open = false;
    while let Some((word, span)) = cursor.word() {
        match word.to_ascii_lowercase().as_str() {
            "solid" if !open => {
                let name = rest_of_line(&mut cursor);
                groups.push(Group { object: Some(name).filter(|name| !name.is_empty()), ..Group::default() });
                open = true;
            }
            "endsolid" if open => {
                rest_of_line(&mut cursor);
                open = false;
            }
            "facet" if open => {
                let corners = facet(&mut cursor)?;
                if let Some(group) = groups.last_mut() {
                    group.faces.push(ImportedFace { corners, span: span.start..cursor.at });
                }
            }
            _ => {
                let expected = if open { "`facet` or `endsolid`" } else { "`solid`" };
                let what = format!("`{word}` stands where {expected} should be");
                return Err(cursor.error(span.start, what, "mend the word, or write the file anew"));
            }
        }
    }
    if open {
        return Err(cursor.ended("`endsolid`"));
    }
    Ok(Imported::new(source, groups))
}

/// A name may hold blanks: it is all that stands behind the word.
fn rest_of_line(cursor: &mut Cursor) -> String {
    let rest = cursor.line().map(|(line, _)| line).unwrap_or_default();
    rest.trim().to_owned()
}

fn facet(cursor: &mut Cursor) -> Result<Vec<fredholm_mesh::Vec3>, SceneError> {
    expect(cursor, "normal")?;
    for _ in 0..3 {
        cursor.number(Scalar::F64, "a component of the normal")?;
    }
    expect(cursor, "outer")?;
    expect(cursor, "loop")?;
    let mut corners = vec![];
    for _ in 0..3 {
        expect(cursor, "vertex")?;
        corners.push(cursor.point(Scalar::F64)?);
    }
    expect(cursor, "endloop")?;
    expect(cursor, "endfacet")?;
    Ok(corners)
}

fn expect(cursor: &mut Cursor, keyword: &str) -> Result<(), SceneError> {
    let expected = format!("`{keyword}`");
    let (word, span) = cursor.word().ok_or_else(|| cursor.ended(&expected))?;
    if word.eq_ignore_ascii_case(keyword) {
        return Ok(());
    }
    let what = format!("`{word}` stands where {expected} should be");
    Err(cursor.error(
        span.start,
        what,
        "a facet is: facet normal, outer loop, three vertices, endloop, endfacet",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Place;
    use fredholm_mesh::Vec3;

    const TEXT: &str = "solid a lamp\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n\
        vertex 0 1 0.1\nendloop\nendfacet\nendsolid a lamp\n";

    fn read(bytes: &[u8]) -> Result<Imported, SceneError> {
        import(Path::new("a.stl"), bytes.to_vec())
    }

    fn packed(count: u32, corners: &[f32]) -> Vec<u8> {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(BYTES_OF_HEADER, b' ');
        bytes.extend(count.to_le_bytes());
        bytes.extend(corners.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
        bytes
    }

    #[test]
    fn text_and_bytes_give_the_same_triangle() {
        let corners = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.1_f32];
        let (text, binary) = (read(TEXT.as_bytes()).unwrap(), read(&packed(1, &corners)).unwrap());
        assert_eq!(text.groups[0].object.as_deref(), Some("a lamp"));
        assert_eq!(text.groups[0].faces[0].corners[2], Vec3::new(0.0, 1.0, 0.1));
        assert_eq!(binary.groups[0].faces[0].corners[2], Vec3::new(0.0, 1.0, f64::from(0.1_f32)));
        assert!(text.notes.is_empty() && binary.notes.is_empty());
    }

    #[test]
    fn errors_name_the_line_or_the_byte() {
        let place = |bytes: &[u8]| read(bytes).unwrap_err().place();
        let line = |line, column| Some(Place::Line { line, column });
        assert_eq!(place(TEXT.replace("vertex 1 0 0", "vertex 1 x 0").as_bytes()), line(5, 10));
        assert_eq!(place(TEXT.replace("endloop", "vertex").as_bytes()), line(7, 1));
        assert_eq!(place(&TEXT.as_bytes()[..60]), line(5, 1));
        assert_eq!(place(&packed(1, &[f32::NAN; 12])), Some(Place::Byte(96)));
        let error = read(&packed(u32::MAX, &[0.0; 12])).unwrap_err();
        assert!(
            error.to_string().contains("byte 134: the file ends where triangle 1 of 4294967295"),
            "{error}"
        );
        assert_eq!(place(b""), Some(Place::Byte(0)));
    }

    #[test]
    fn what_stands_behind_the_last_triangle_is_told() {
        let mut bytes = packed(1, &[0.0; 12]);
        bytes.extend([1, 2, 3]);
        assert!(read(&bytes).unwrap().notes[0].what.starts_with("3 bytes stand behind the 1 triangles"));
    }
}

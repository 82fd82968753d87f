//! PLY, the Stanford polygon format: vertices and faces, as text or binary in either order of
//! bytes.
//!
//! Format: G. Turk, The PLY Polygon File Format, 1994. Of the vertices x, y and z are read, of the
//! faces the list `vertex_indices` or `vertex_index`; other elements and properties are passed
//! over.

use std::ops::Range;
use std::path::Path;

use fredholm_mesh::Vec3;

use super::cursor::{Cursor, Encoding, Scalar};
use super::{Group, Imported, check_corners, face};
use crate::error::SceneError;
use crate::source::Source;

/// Names of the list of the corners of a face.
const INDEX_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

struct Property {
    name: String,
    kind: Scalar,
    /// Of a list: the kind of its length.
    length: Option<Scalar>,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
    span: Range<usize>,
}

/// What is known once the header has been read.
struct Header {
    encoding: Encoding,
    elements: Vec<Element>,
    /// Bytes of the header.
    length: usize,
}

pub(super) fn import(path: &Path, bytes: Vec<u8>) -> Result<Imported, SceneError> {
    let probe = Source::binary(path);
    let text = is_text(&bytes);
    if text {
        let source = Source::decode_mesh(path, bytes)?;
        let faces = faces(&source, source.text.as_bytes())?;
        return Ok(Imported::new(source, vec![faces]));
    }
    let faces = faces(&probe, &bytes)?;
    Ok(Imported::new(probe, vec![faces]))
}

/// Whether the header says that the file is text, or is none.
fn is_text(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|&byte| byte == b'\n').take(100);
    !lines.any(|line| line.trim_ascii().starts_with(b"format binary"))
}

fn faces(source: &Source, bytes: &[u8]) -> Result<Group, SceneError> {
    let header = header(&mut Cursor::new(source, bytes, Encoding::Text))?;
    let mut cursor = Cursor::new(source, bytes, header.encoding);
    cursor.at = header.length;
    let (mut vertices, mut group) = (vec![], Group::default());
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices.extend(read_vertices(&mut cursor, element)?),
            "face" => read_faces(&mut cursor, element, &vertices, &mut group)?,
            "tristrips" => {
                let help = "write the mesh with faces instead of strips of triangles";
                return Err(cursor.error(element.span.start, "strips of triangles are not read", help));
            }
            _ => pass_over(&mut cursor, element)?,
        }
    }
    Ok(group)
}

fn header(cursor: &mut Cursor) -> Result<Header, SceneError> {
    let (mut encoding, mut elements) = (None, Vec::<Element>::new());
    if cursor.line().is_none_or(|(line, _)| line.trim() != "ply") {
        return Err(cursor.error(0, "the file does not begin with `ply`", "give a PLY file"));
    }
    loop {
        let (line, span) = cursor.line().ok_or_else(|| cursor.ended("`end_header`"))?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let error = |what: String, help: &str| Err(cursor.error(span.start, what, help));
        match words[..] {
            ["format", name, "1.0"] => match name {
                "ascii" => encoding = Some(Encoding::Text),
                "binary_little_endian" => encoding = Some(Encoding::Little),
                "binary_big_endian" => encoding = Some(Encoding::Big),
                _ => {
                    return error(
                        format!("unknown format `{name}`"),
                        "write ascii, binary_little_endian or binary_big_endian",
                    );
                }
            },
            ["element", name, count] => {
                let Ok(count) = count.parse() else {
                    return error(format!("`{count}` is no number of elements"), "write a whole number");
                };
                let (name, properties) = (name.to_owned(), vec![]);
                elements.push(Element { name, count, properties, span });
            }
            ["property", ref rest @ ..] => match (property(rest), elements.last_mut()) {
                (Some(property), Some(element)) => element.properties.push(property),
                (None, _) => {
                    return error(
                        format!("`{}` is no property", line.trim()),
                        "write: property float x, or: property list uchar int vertex_indices",
                    );
                }
                (_, None) => {
                    return error("a property before the first element".to_owned(), "write `element` first");
                }
            },
            ["end_header"] => break,
            [] | ["comment" | "obj_info", ..] => {}
            _ => {
                return error(
                    format!("unknown line `{}` in the header", line.trim()),
                    "mend the line; headers have format, element, property, comment and end_header",
                );
            }
        }
    }
    let encoding = encoding.ok_or_else(|| {
        cursor.error(0, "the header has no format", "write a line `format ascii 1.0` behind `ply`")
    })?;
    Ok(Header { encoding, elements, length: cursor.at })
}

fn property(words: &[&str]) -> Option<Property> {
    let of = |name: &str, kind: &str, length| {
        Some(Property { name: name.to_owned(), kind: scalar(kind)?, length })
    };
    match *words {
        ["list", length, kind, name] => of(name, kind, Some(scalar(length).filter(|kind| kind.is_whole())?)),
        [kind, name] => of(name, kind, None),
        _ => None,
    }
}

fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}

fn read_vertices(cursor: &mut Cursor, element: &Element) -> Result<Vec<Vec3>, SceneError> {
    let place = |name: &str| element.properties.iter().position(|p| p.name == name && p.length.is_none());
    let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(place) else {
        let help = "write the properties x, y and z";
        return Err(cursor.error(element.span.start, "the vertices have no coordinates", help));
    };
    let mut vertices = vec![];
    for _ in 0..element.count {
        let mut values = [0.0; 3];
        for (number, property) in element.properties.iter().enumerate() {
            match [x, y, z].iter().position(|&place| place == number) {
                Some(axis) => values[axis] = cursor.coordinate(property.kind)?,
                None => pass(cursor, property)?,
            }
        }
        vertices.push(Vec3::from_array(values));
    }
    Ok(vertices)
}

fn read_faces(
    cursor: &mut Cursor,
    element: &Element,
    vertices: &[Vec3],
    group: &mut Group,
) -> Result<(), SceneError> {
    let is_list =
        |p: &Property| INDEX_LISTS.contains(&p.name.as_str()) && p.length.is_some() && p.kind.is_whole();
    let Some(list) = element.properties.iter().position(is_list) else {
        let help = "write: property list uchar int vertex_indices";
        return Err(cursor.error(element.span.start, "the faces have no list of vertices", help));
    };
    for _ in 0..element.count {
        let mut start = cursor.at;
        for (number, property) in element.properties.iter().enumerate() {
            let (true, Some(length)) = (number == list, property.length) else {
                pass(cursor, property)?;
                continue;
            };
            let count = cursor.number(length, "the number of corners of a face")?;
            if cursor.encoding == Encoding::Text {
                // The blanks before the number belong to the line above.
                start = cursor.at.saturating_sub(1);
            }
            check_corners(cursor.source, count.max(0.0) as usize, start..cursor.at)?;
            let mut indices = vec![];
            for _ in 0..count as u64 {
                // A negative index is one beyond the last.
                let index = cursor.number(property.kind, "the index of a corner")?;
                indices.push(if index < 0.0 { u64::MAX } else { index as u64 });
            }
            group.faces.push(face(cursor.source, vertices, &indices, start..cursor.at)?);
        }
    }
    Ok(())
}

fn pass_over(cursor: &mut Cursor, element: &Element) -> Result<(), SceneError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        element.properties.iter().try_for_each(|property| pass(cursor, property))?;
    }
    Ok(())
}

fn pass(cursor: &mut Cursor, property: &Property) -> Result<(), SceneError> {
    let what = &property.name;
    let count = property.length.map_or(Ok(1.0), |kind| cursor.number(kind, what))?;
    for _ in 0..count as u64 {
        cursor.number(property.kind, what)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Place;

    const HEADER: &str = "element vertex 3\nproperty uchar red\nproperty float x\nproperty float y\nproperty double z\n\
        element edge 1\nproperty list uchar short ends\nelement face 1\nproperty list uchar int vertex_indices\n\
        property float radiosity\nend_header\n";

    fn read(bytes: &[u8]) -> Result<Imported, SceneError> {
        import(Path::new("a.ply"), bytes.to_vec())
    }

    fn text() -> String {
        format!("ply\nformat ascii 1.0\ncomment x\n{HEADER}9 0 0 0\n9 1 0 0\n9 0 1 0.5\n2 0 1\n3 0 1 2 7.5\n")
    }

    fn packed(big: bool) -> Vec<u8> {
        let order = |mut bytes: Vec<u8>| {
            if big {
                bytes.reverse();
            }
            bytes
        };
        let mut all =
            format!("ply\nformat binary_{}_endian 1.0\n{HEADER}", if big { "big" } else { "little" })
                .into_bytes();
        for (x, y, z) in [(0.0_f32, 0.0_f32, 0.0_f64), (1.0, 0.0, 0.0), (0.0, 1.0, 0.5)] {
            all.push(9);
            all.extend(order(x.to_le_bytes().to_vec()));
            all.extend(order(y.to_le_bytes().to_vec()));
            all.extend(order(z.to_le_bytes().to_vec()));
        }
        all.push(2);
        for i in [0_i16, 1] {
            all.extend(order(i.to_le_bytes().to_vec()));
        }
        all.push(3);
        for i in [0_i32, 1, 2] {
            all.extend(order(i.to_le_bytes().to_vec()));
        }
        all.extend(order(7.5_f32.to_le_bytes().to_vec()));
        all
    }

    #[test]
    fn all_three_forms_give_the_same_face() {
        for bytes in [text().into_bytes(), packed(false), packed(true)] {
            let found = read(&bytes).unwrap();
            let corners = &found.groups[0].faces[0].corners;
            assert_eq!(corners[..], [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 0.5)]);
        }
    }

    #[test]
    fn errors_name_the_line_or_the_byte() {
        let fault = |from: &str, to: &str| read(text().replace(from, to).as_bytes()).unwrap_err();
        let line = |error: SceneError| match error.place() {
            Some(Place::Line { line, .. }) => line,
            place => panic!("{place:?}"),
        };
        assert_eq!(line(fault("3 0 1 2 7.5", "3 0 1 3 7.5")), 19);
        assert_eq!(line(fault("9 0 1 0.5", "9 0 nan 0.5")), 17);
        assert_eq!(line(fault("3 0 1 2 7.5", "2 0 1 7.5")), 19);
        assert_eq!(line(fault("vertex 3", "vertex x")), 4);
        assert_eq!(line(fault("float x", "flout x")), 6);
        let promised = read(&[b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n", &[0_u8; 30][..]].concat());
        let error = promised.unwrap_err();
        assert!(matches!(error.place(), Some(Place::Byte(154))), "{error}");
        assert_eq!(read(b"").unwrap_err().place(), Some(Place::Line { line: 1, column: 1 }));
    }
}

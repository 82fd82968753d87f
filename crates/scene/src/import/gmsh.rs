//! Gmsh meshes (.msh), version 4.1, as text or binary: triangles and quads of surfaces.
//!
//! Format: C. Geuzaine, J.-F. Remacle, Gmsh Reference Manual, "MSH file format". A physical group
//! of surfaces is a surface; where a surface belongs to several, the first counts. Points, lines
//! and volumes are passed over. Elements with curved sides are taken as flat between their corners,
//! which is told.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use fredholm_mesh::Vec3;

use super::cursor::{Cursor, Encoding, Scalar};
use super::{Group, Imported, ImportedFace, Note};
use crate::error::{ErrorKind, SceneError};
use crate::source::Source;

/// Nodes of the types of elements 1 to 19 and 26 to 31.
const NODES_OF_TYPES: [(i32, usize); 25] = [
    (1, 2),
    (2, 3),
    (3, 4),
    (4, 4),
    (5, 8),
    (6, 6),
    (7, 5),
    (8, 3),
    (9, 6),
    (10, 9),
    (11, 10),
    (12, 27),
    (13, 18),
    (14, 14),
    (15, 1),
    (16, 8),
    (17, 20),
    (18, 15),
    (19, 13),
    (26, 4),
    (27, 5),
    (28, 6),
    (29, 20),
    (30, 35),
    (31, 56),
];
/// Types of surface elements, and how many of their nodes are corners; the corners come first.
const SURFACE_TYPES: [(i32, usize); 5] = [(2, 3), (3, 4), (9, 3), (10, 4), (16, 4)];

pub(super) fn import(path: &Path, bytes: Vec<u8>) -> Result<Imported, SceneError> {
    if is_binary(&bytes) {
        let source = Source::binary(path);
        let (groups, notes) = groups(&source, &bytes)?;
        return Ok(Imported { notes, ..Imported::new(source, groups) });
    }
    let source = Source::decode_mesh(path, bytes)?;
    let (groups, notes) = groups(&source, source.text.as_bytes())?;
    Ok(Imported { notes, ..Imported::new(source, groups) })
}

/// Whether the second word behind `$MeshFormat` is 1.
fn is_binary(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4000)]);
    let head = text.split("$MeshFormat").nth(1).unwrap_or_default();
    head.split_whitespace().nth(1) == Some("1")
}

/// What has been read so far.
#[derive(Default)]
struct Reader {
    /// Names of physical groups of surfaces.
    names: HashMap<i32, String>,
    /// First physical group of each surface.
    physical: HashMap<i32, i32>,
    nodes: HashMap<u64, Vec3>,
    groups: BTreeMap<i32, Group>,
    curved: Option<(usize, usize)>,
}

fn groups(source: &Source, bytes: &[u8]) -> Result<(Vec<Group>, Vec<Note>), SceneError> {
    let mut cursor = Cursor::new(source, bytes, Encoding::Text);
    let mut reader = Reader::default();
    let (mut encoding, mut elements) = (None, false);
    while let Some((line, span)) = cursor.line() {
        let section = line.trim().to_owned();
        if section.is_empty() {
            continue;
        }
        let Some(name) = section.strip_prefix('$') else {
            let what = format!("`{section}` stands where a section, such as $Nodes, should begin");
            return Err(cursor.error(span.start, what, "mend the line, or write the file anew"));
        };
        if name == "MeshFormat" {
            encoding = Some(format(&mut cursor)?);
            close(&mut cursor, name)?;
            continue;
        }
        let Some(encoding) = encoding else {
            return Err(cursor.error(span.start, "$MeshFormat must come first", "give a Gmsh 4.1 file"));
        };
        cursor.encoding = encoding;
        match name {
            "PhysicalNames" => reader.physical_names(&mut cursor)?,
            "Entities" => reader.entities(&mut cursor)?,
            "Nodes" => reader.nodes(&mut cursor)?,
            "Elements" => {
                reader.elements(&mut cursor)?;
                elements = true;
            }
            "PartitionedEntities" => {
                let help = "save the mesh without partitions";
                return Err(cursor.error(span.start, "a mesh in partitions is not read", help));
            }
            _ => {
                skip(&mut cursor, bytes, name)?;
                continue;
            }
        }
        close(&mut cursor, name)?;
    }
    if !elements {
        return Err(cursor.ended("the section $Elements"));
    }
    Ok((reader.groups.into_values().collect(), curved(reader.curved)))
}

fn curved(found: Option<(usize, usize)>) -> Vec<Note> {
    let note = |(count, at): (usize, usize)| Note {
        span: at..at,
        what: format!("{count} curved elements are taken as flat between their corners"),
        help: "mesh with elements of the first order, and finer".to_owned(),
    };
    found.map(note).into_iter().collect()
}

/// Version, kind of the file, size of numbers; in a binary file the number 1 follows.
fn format(cursor: &mut Cursor) -> Result<Encoding, SceneError> {
    let (line, span) = cursor.line().ok_or_else(|| cursor.ended("the version of the format"))?;
    let words: Vec<&str> = line.split_whitespace().collect();
    let ["4.1", kind, size] = words[..] else {
        let what = format!("the version `{}` is not read", line.trim());
        return Err(cursor.error(span.start, what, "save the mesh in version 4.1: gmsh -format msh41"));
    };
    if size != "8" || !matches!(kind, "0" | "1") {
        let help = "save the mesh with numbers of 8 bytes";
        return Err(cursor.error(span.start, format!("`{}` is not read", line.trim()), help));
    }
    if kind == "0" {
        return Ok(Encoding::Text);
    }
    let start = cursor.at;
    let encoding = match cursor.take(4, "the number 1")? {
        [1, 0, 0, 0] => Encoding::Little,
        [0, 0, 0, 1] => Encoding::Big,
        _ => return Err(cursor.error(start, "the number 1 should stand here", "write the file anew")),
    };
    Ok(encoding)
}

/// Goes past `$End` and the name of the section.
fn close(cursor: &mut Cursor, name: &str) -> Result<(), SceneError> {
    let expected = format!("$End{name}");
    let (word, span) = cursor.word().ok_or_else(|| cursor.ended(&expected))?;
    if word == expected {
        return Ok(());
    }
    let what = format!("{expected} should stand here");
    Err(cursor.error(span.start, what, "the counts of the section do not fit: write the file anew"))
}

/// Goes past a section that is not read.
fn skip(cursor: &mut Cursor, bytes: &[u8], name: &str) -> Result<(), SceneError> {
    let end = format!("$End{name}");
    let rest = &bytes[cursor.at..];
    let found = rest.windows(end.len()).position(|window| window == end.as_bytes());
    let found = found.ok_or_else(|| cursor.ended(&end))?;
    cursor.at += found + end.len();
    Ok(())
}

impl Reader {
    fn physical_names(&mut self, cursor: &mut Cursor) -> Result<(), SceneError> {
        // This section is text in binary files, too.
        let encoding = std::mem::replace(&mut cursor.encoding, Encoding::Text);
        let count = cursor.size("the number of names")?;
        for _ in 0..count {
            let (dimension, tag) = (cursor.int("a dimension")?, cursor.int("a tag")?);
            let (rest, _) = cursor.line().ok_or_else(|| cursor.ended("a name"))?;
            if dimension == 2 {
                self.names.insert(tag, rest.trim().trim_matches('"').to_owned());
            }
        }
        cursor.encoding = encoding;
        Ok(())
    }

    fn entities(&mut self, cursor: &mut Cursor) -> Result<(), SceneError> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = cursor.size("the number of entities")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let tag = cursor.int("the tag of an entity")?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    cursor.number(Scalar::F64, "a bound of an entity")?;
                }
                for group in 0..cursor.size("the number of physical groups")? {
                    let physical = cursor.int("the tag of a physical group")?;
                    if dimension == 2 && group == 0 {
                        self.physical.insert(tag, physical);
                    }
                }
                if dimension > 0 {
                    for _ in 0..cursor.size("the number of bounding entities")? {
                        cursor.int("the tag of a bounding entity")?;
                    }
                }
            }
        }
        Ok(())
    }

    fn nodes(&mut self, cursor: &mut Cursor) -> Result<(), SceneError> {
        let blocks = counts(cursor)?;
        for _ in 0..blocks {
            let dimension = cursor.int("the dimension of an entity")?;
            cursor.int("the tag of an entity")?;
            let parametric = cursor.int("whether there are parameters")?;
            let count = cursor.size("the number of nodes")?;
            let mut tags = vec![];
            for _ in 0..count {
                tags.push(cursor.size("the tag of a node")?);
            }
            for tag in tags {
                let node = cursor.point(Scalar::F64)?;
                for _ in 0..if parametric == 1 { dimension } else { 0 } {
                    cursor.number(Scalar::F64, "a parameter of a node")?;
                }
                self.nodes.insert(tag, node);
            }
        }
        Ok(())
    }

    fn elements(&mut self, cursor: &mut Cursor) -> Result<(), SceneError> {
        let blocks = counts(cursor)?;
        for _ in 0..blocks {
            let start = cursor.at;
            let dimension = cursor.int("the dimension of an entity")?;
            let entity = cursor.int("the tag of an entity")?;
            let kind = cursor.int("the type of elements")?;
            let count = cursor.size("the number of elements")?;
            let Some((_, nodes)) = NODES_OF_TYPES.iter().find(|(known, _)| *known == kind) else {
                let help = "mesh with triangles or quads";
                return Err(cursor.error(start, format!("elements of type {kind} are not read"), help));
            };
            let corners = SURFACE_TYPES.iter().find(|(known, _)| *known == kind).map(|(_, corners)| *corners);
            if corners.is_some_and(|corners| corners < *nodes) && count > 0 {
                let (before, at) = self.curved.unwrap_or((0, start));
                self.curved = Some((before.saturating_add(usize::try_from(count).unwrap_or(usize::MAX)), at));
            }
            let corners = corners.filter(|_| dimension == 2);
            for _ in 0..count {
                let face = self.element(cursor, *nodes, corners)?;
                self.group(entity).faces.extend(face);
            }
        }
        Ok(())
    }

    fn element(
        &self,
        cursor: &mut Cursor,
        nodes: usize,
        corners: Option<usize>,
    ) -> Result<Option<ImportedFace>, SceneError> {
        let mut start = cursor.at;
        cursor.size("the tag of an element")?;
        if cursor.encoding == Encoding::Text {
            start = cursor.at.saturating_sub(1);
        }
        let mut found = vec![];
        for number in 0..nodes {
            let tag = cursor.size("the tag of a node")?;
            if corners.is_some_and(|corners| number < corners) {
                found.push(*self.nodes.get(&tag).ok_or_else(|| {
                    let what = format!("there is no node {tag}");
                    let help = "mend the tag, or write the file anew: nodes stand before elements";
                    cursor.source.error(ErrorKind::Value, start..cursor.at, what, help)
                })?);
            }
        }
        Ok(corners.map(|_| ImportedFace { corners: found, span: start..cursor.at }))
    }

    /// The group of a surface: its physical group, or itself. Physical groups come in the order of
    /// their tags, surfaces without one behind them.
    fn group(&mut self, entity: i32) -> &mut Group {
        let physical = self.physical.get(&entity).copied();
        let (key, name) = match physical {
            Some(tag) => (
                tag.saturating_abs(),
                self.names.get(&tag.saturating_abs()).cloned().unwrap_or_else(|| format!("physical {tag}")),
            ),
            None => (i32::MIN.saturating_add(entity.saturating_abs()), format!("surface {entity}")),
        };
        self.groups.entry(key).or_insert_with(|| Group { object: Some(name), ..Group::default() })
    }
}

/// The four counts at the head of nodes and elements; the number of blocks is what counts.
fn counts(cursor: &mut Cursor) -> Result<u64, SceneError> {
    let blocks = cursor.size("the number of blocks")?;
    for what in ["the number of all", "the least tag", "the greatest tag"] {
        cursor.size(what)?;
    }
    Ok(blocks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Place;

    const TEXT: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Comments\nfree $ text\n$EndComments\n$PhysicalNames\n2\n1 7 \"rim\"\n2 3 \"the floor\"\n\
        $EndPhysicalNames\n$Entities\n1 0 2 0\n1 0 0 0 0\n5 0 0 0 1 1 0 1 3 0\n6 0 0 0 1 1 0 0 2 1 -2\n$EndEntities\n\
        $Nodes\n2 4 1 9\n0 1 0 1\n1\n0 0 0\n2 5 1 3\n2\n3\n9\n1 0 0 0.1 0.2\n1 1 0 0.3 0.4\n0 1 0 0.5 0.6\n$EndNodes\n\
        $Elements\n3 4 1 4\n0 1 15 1\n1 1\n2 5 2 2\n2 1 2 3\n3 1 3 9\n2 6 3 1\n4 1 2 3 9\n$EndElements\n";

    fn read(text: &str) -> Result<Imported, SceneError> {
        import(Path::new("a.msh"), text.as_bytes().to_vec())
    }

    #[test]
    fn physical_groups_are_surfaces() {
        let found = read(TEXT).unwrap();
        let shape: Vec<_> =
            found.groups.iter().map(|g| (g.object.as_deref().unwrap(), g.faces.len())).collect();
        assert_eq!(shape, [("surface 6", 1), ("the floor", 2)]);
        let corners = &found.groups[0].faces[0].corners;
        assert_eq!(corners[..], [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y]);
    }

    #[test]
    fn errors_name_the_line() {
        for (from, to, line) in [
            ("4.1 0 8", "2.2 0 8", 2),
            ("3 1 3 9", "3 1 3 8", 37),
            ("2 5 2 2", "2 5 99 2", 34),
            ("1 1 0 0.3", "1 inf 0 0.3", 28),
            ("$EndElements\n", "", 40),
            ("2 6 3 1\n", "2 6 3 4000000000\n", 40),
            ("$Nodes", "Nodes", 18),
        ] {
            let error = read(&TEXT.replacen(from, to, 1)).unwrap_err();
            assert!(
                matches!(error.place(), Some(Place::Line { line: found, .. }) if found == line),
                "{line}: {error}"
            );
        }
    }
}

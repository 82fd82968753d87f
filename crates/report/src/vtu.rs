//! `field.vtu`: a VTK unstructured grid for `ParaView`.
//!
//! Format: VTK XML, version 1.0, little endian, appended raw data, `UInt64` block headers
//! (<https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>). Each cell is a leaf element: a triangle
//! (type 5), a quad (type 9), or a polygon (type 7) where smaller elements have corners on its sides: so every side within a face is one of two cells, and
//! there are no cracks. Elements that shade smoothly into each other share their points, so that a smoothing filter
//! keeps surfaces and edges apart. Points in metres.
//!
//! Cell data: `element`, `face`, `surface` (numbers, from 0), `area` (m²), `exposed` (share not buried), and band by band `irradiance_BAND` and
//! `radiosity_BAND` (W/m²).

use std::io::{self, Write};

use fredholm_mesh::{Anchored, Patch, Vec3, Welded};

use crate::Field;
use crate::nodal::SMOOTH;
use crate::xml::escaped;

pub(crate) const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;
const POLYGON: u8 = 7;

pub(crate) type Fill<'a> = Box<dyn Fn(&mut dyn Write) -> io::Result<()> + 'a>;

/// One data array: its description, its size in bytes and what writes them.
pub(crate) struct Array<'a> {
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    pub(crate) components: usize,
    pub(crate) bytes: usize,
    pub(crate) fill: Fill<'a>,
}

impl<'a> Array<'a> {
    pub(crate) fn floats<I>(
        name: String,
        components: usize,
        count: usize,
        values: impl Fn() -> I + 'a,
    ) -> Self
    where
        I: Iterator<Item = f64>,
    {
        let fill: Fill = Box::new(move |out| values().try_for_each(|x| out.write_all(&x.to_le_bytes())));
        Self { name, kind: "Float64", components, bytes: 8 * components * count, fill }
    }

    pub(crate) fn integers<I>(name: &str, count: usize, values: impl Fn() -> I + 'a) -> Self
    where
        I: Iterator<Item = usize>,
    {
        let fill: Fill =
            Box::new(move |out| values().try_for_each(|i| out.write_all(&(i as u64).to_le_bytes())));
        Self { name: name.to_owned(), kind: "Int64", components: 1, bytes: 8 * count, fill }
    }

    fn describe(&self, out: &mut dyn Write, offset: usize) -> io::Result<()> {
        let (kind, name) = (self.kind, escaped(&self.name));
        write!(out, "<DataArray type=\"{kind}\" Name=\"{name}\"")?;
        // Some readers make a matrix of one column where a single component is announced.
        if self.components > 1 {
            write!(out, " NumberOfComponents=\"{}\"", self.components)?;
        }
        writeln!(out, " format=\"appended\" offset=\"{offset}\"/>")
    }

    fn append(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(&(self.bytes as u64).to_le_bytes())?;
        (self.fill)(out)
    }
}

/// Writes the leaf elements with their values.
///
/// # Errors
/// What `out` reports.
pub fn write_vtu(field: &Field<'_>, out: &mut dyn Write) -> io::Result<()> {
    let Anchored { leaves, polygons: welded, .. } = field.mesh().anchored(SMOOTH);
    let sections =
        [("Points", vec![points(&welded)]), ("Cells", cells(&leaves, &welded)), ("CellData", data(field))];
    write_grid([welded.vertices.len(), welded.len()], &sections, out)
}

/// Writes the arrays of a grid of some points and cells, by sections.
pub(crate) fn write_grid(
    counts: [usize; 2],
    sections: &[(&str, Vec<Array<'_>>)],
    out: &mut dyn Write,
) -> io::Result<()> {
    opening(counts, out)?;
    let mut offset = 0;
    for (section, arrays) in sections {
        writeln!(out, "<{section}>")?;
        for array in arrays {
            array.describe(out, offset)?;
            offset += 8 + array.bytes;
        }
        writeln!(out, "</{section}>")?;
    }
    write!(out, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
    sections.iter().flat_map(|(_, arrays)| arrays).try_for_each(|array| array.append(out))?;
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}

fn opening([points, cells]: [usize; 2], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
    )?;
    writeln!(out, "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">")
}

fn points(welded: &Welded) -> Array<'_> {
    let values = || welded.vertices.iter().flat_map(Vec3::to_array);
    Array::floats("Points".to_owned(), 3, welded.vertices.len(), values)
}

fn cells<'a>(leaves: &'a Welded, welded: &'a Welded) -> Vec<Array<'a>> {
    let ends = || {
        welded.patches().scan(0, |end, patch| {
            *end += patch.len();
            Some(*end)
        })
    };
    let corners = ends().last().unwrap_or(0);
    vec![
        Array::integers("connectivity", corners, || welded.patches().flatten().copied()),
        Array::integers("offsets", welded.len(), ends),
        Array {
            name: "types".to_owned(),
            kind: "UInt8",
            components: 1,
            bytes: welded.len(),
            fill: Box::new(|out| {
                let mut cells = leaves.patches().zip(welded.patches());
                cells.try_for_each(|(leaf, polygon)| out.write_all(&[cell_type(leaf, polygon)]))
            }),
        },
    ]
}

fn cell_type(leaf: &[usize], polygon: &[usize]) -> u8 {
    match (leaf.len() == polygon.len(), leaf.len()) {
        (true, 3) => TRIANGLE,
        (true, _) => QUAD,
        (false, _) => POLYGON,
    }
}

fn data<'a>(field: &Field<'a>) -> Vec<Array<'a>> {
    let (field, mesh, n) = (*field, field.mesh(), field.mesh().len());
    let mut arrays = vec![
        Array::integers("element", n, move || 0..n),
        Array::integers("face", n, move || (0..n).map(|leaf| mesh.face_of(leaf))),
        Array::integers("surface", n, move || (0..n).map(|leaf| mesh.surface_of(leaf))),
        Array::floats("area".to_owned(), 1, n, move || mesh.patches().map(Patch::area)),
        Array::floats("exposed".to_owned(), 1, n, move || (0..n).map(move |leaf| field.exposed(leaf))),
    ];
    for band in 0..field.bands().len() {
        arrays.push(lane(&field, "irradiance", field.irradiance(), band));
        arrays.push(lane(&field, "radiosity", field.radiosity(), band));
    }
    arrays
}

fn lane<'a>(field: &Field<'a>, what: &str, values: &'a [f64], band: usize) -> Array<'a> {
    let bands = field.bands();
    let picked = move || values.iter().skip(band).step_by(bands.len()).copied();
    Array::floats(format!("{what}_{}", bands[band]), 1, field.mesh().len(), picked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{names, sample};
    use crate::xml::tests::{attribute, tags};
    use std::collections::BTreeMap;

    /// Data arrays by name: (type, bytes).
    fn parse(file: &[u8]) -> (String, BTreeMap<String, (String, Vec<u8>)>) {
        let mark = b"<AppendedData encoding=\"raw\">\n_";
        let start = file.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
        let tail = b"\n</AppendedData>\n</VTKFile>\n";
        assert!(file.ends_with(tail));
        let raw = &file[start..file.len() - tail.len()];
        let xml = String::from_utf8(file[..start - 1].to_vec()).unwrap() + "</AppendedData></VTKFile>";
        let (mut arrays, mut end) = (BTreeMap::new(), 0);
        for (_, attributes) in tags(&xml).iter().filter(|(name, _)| name == "DataArray") {
            let offset: usize = attribute(attributes, "offset").parse().unwrap();
            assert_eq!(offset, end, "blocks must follow each other");
            let size = u64::from_le_bytes(raw[offset..offset + 8].try_into().unwrap()) as usize;
            let block = raw[offset + 8..offset + 8 + size].to_vec();
            end = offset + 8 + size;
            let kind = attribute(attributes, "type").to_owned();
            arrays.insert(attribute(attributes, " Name").to_owned(), (kind, block));
        }
        assert_eq!(end, raw.len());
        (xml, arrays)
    }

    fn floats((kind, block): &(String, Vec<u8>)) -> Vec<f64> {
        assert_eq!(kind, "Float64");
        block.chunks(8).map(|c| f64::from_le_bytes(c.try_into().unwrap())).collect()
    }

    fn integers((kind, block): &(String, Vec<u8>)) -> Vec<i64> {
        assert_eq!(kind, "Int64");
        block.chunks(8).map(|c| i64::from_le_bytes(c.try_into().unwrap())).collect()
    }

    #[test]
    fn every_array_reads_back() {
        let (mesh, bands) = (sample(), names(&["r", "a<b"]));
        let e = [0.1, 0.2, 1.0 / 3.0, 1e-17, 5e20, 0.0];
        let b = e.map(|x| x * 1.1);
        let field = Field::new(&mesh, &bands, &e, &b).unwrap();
        let mut out = Vec::new();
        write_vtu(&field, &mut out).unwrap();
        let (xml, arrays) = parse(&out);
        assert!(xml.contains("NumberOfPoints=\"9\" NumberOfCells=\"3\""), "{xml}");
        assert_eq!(floats(&arrays["irradiance_a&lt;b"]), [e[1], e[3], e[5]]);
        assert_eq!(floats(&arrays["radiosity_r"]), [b[0], b[2], b[4]]);
        assert_eq!(integers(&arrays["surface"]), [0, 0, 1]);
        assert_eq!(integers(&arrays["face"]), [0, 1, 2]);
        assert_eq!(integers(&arrays["offsets"]), [4, 8, 11]);
        assert_eq!(integers(&arrays["connectivity"]), [0, 1, 2, 3, 1, 4, 5, 2, 6, 7, 8]);
        assert_eq!(arrays["types"], ("UInt8".to_owned(), vec![9, 9, 5]));
        let points = floats(&arrays["Points"]);
        assert_eq!(points[3..6], [1.0, 0.0, 0.0]);
        assert_eq!(points[12..15], [2.0, 0.0, 0.0]);
        assert_eq!(points[24..], [1.0 / 3.0, 0.0, 1.0]);
        assert_eq!(floats(&arrays["area"])[..2], [1.0, 1.0]);
    }

    #[test]
    fn sides_that_smaller_elements_touch_make_polygons() {
        let v = |x: f64, y: f64| Vec3::new(x, y, 0.0);
        let square =
            |x: f64| Patch::quad([v(x, 0.), v(x + 1., 0.), v(x + 1., 1.), v(x, 1.)]).unwrap().unwrap();
        let mut builder = fredholm_mesh::MeshBuilder::default();
        builder.surface("floor", 0);
        builder.face(&[square(0.0)]).unwrap();
        builder.face(&square(1.0).split().unwrap()).unwrap();
        let (mesh, bands) = (builder.build(), names(&["grey"]));
        let field = Field::new(&mesh, &bands, &[1.0; 5], &[1.0; 5]).unwrap();
        let mut out = Vec::new();
        write_vtu(&field, &mut out).unwrap();
        let (_, arrays) = parse(&out);
        assert_eq!(arrays["types"].1, vec![7, 9, 9, 9, 9]);
        assert_eq!(integers(&arrays["offsets"]), [5, 9, 13, 17, 21]);
        let points = floats(&arrays["Points"]);
        let at = |k: i64| (points[3 * k as usize], points[3 * k as usize + 1]);
        let first: Vec<(f64, f64)> = integers(&arrays["connectivity"])[..5].iter().map(|&k| at(k)).collect();
        assert_eq!(first, [(0., 0.), (1., 0.), (1., 0.5), (1., 1.), (0., 1.)]);
    }
}

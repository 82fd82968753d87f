//! `field.vtu`: a VTK unstructured grid for `ParaView`.
//!
//! Format: VTK XML, version 1.0, little endian, appended data in blocks of 1 MiB, each compressed
//! by zlib (RFC 1950), `UInt64` headers
//! (<https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>). Each cell is a leaf
//! element: a triangle (type 5), a quad (type 9), or a polygon (type 7) where smaller elements have
//! corners on its sides: so every side within a face is one of two cells, and there are no cracks.
//! Elements that shade smoothly into each other share their points, so that a smoothing filter
//! keeps surfaces and edges apart. Points in metres.
//!
//! Cell data: `element`, `face`, `surface` (numbers, from 0), `area` (m²), `exposed` (share not
//! buried), and band by band `irradiance_BAND` and `radiosity_BAND` (W/m²).

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use fredholm_mesh::{Anchored, Patch, Vec3, Welded};

use crate::Field;
use crate::nodal::SMOOTH_WELD;
use crate::xml::escaped;

pub(crate) const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;
const POLYGON: u8 = 7;

pub(crate) type Fill<'a> = Box<dyn Fn(&mut dyn Write) -> io::Result<()> + 'a>;

/// One data array: its description and what writes its bytes.
pub(crate) struct Array<'a> {
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    pub(crate) components: usize,
    pub(crate) fill: Fill<'a>,
}

impl<'a> Array<'a> {
    pub(crate) fn floats<I>(name: String, components: usize, values: impl Fn() -> I + 'a) -> Self
    where
        I: Iterator<Item = f64>,
    {
        let fill: Fill = Box::new(move |out| values().try_for_each(|x| out.write_all(&x.to_le_bytes())));
        Self { name, kind: "Float64", components, fill }
    }

    pub(crate) fn integers<I>(name: &str, values: impl Fn() -> I + 'a) -> Self
    where
        I: Iterator<Item = usize>,
    {
        let fill: Fill =
            Box::new(move |out| values().try_for_each(|i| out.write_all(&(i as u64).to_le_bytes())));
        Self { name: name.to_owned(), kind: "Int64", components: 1, fill }
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

    /// The number of blocks, their size, that of the last one where it is smaller, the sizes of the
    /// compressed blocks, and these.
    fn compressed(&self) -> io::Result<Vec<u8>> {
        let mut blocks = Blocks::default();
        (self.fill)(&mut blocks)?;
        let last = blocks.open.len();
        blocks.close()?;
        let head = [blocks.sizes.len(), BLOCK, last].into_iter().chain(blocks.sizes);
        let mut bytes: Vec<u8> = head.flat_map(|number| (number as u64).to_le_bytes()).collect();
        bytes.extend(blocks.compressed);
        Ok(bytes)
    }
}

/// Bytes of a block before it is compressed.
const BLOCK: usize = 1 << 20;

/// Compresses what is written to it, block by block.
#[derive(Default)]
struct Blocks {
    open: Vec<u8>,
    sizes: Vec<usize>,
    compressed: Vec<u8>,
}

impl Blocks {
    /// Compresses the open block, if there is anything in it.
    fn close(&mut self) -> io::Result<()> {
        if self.open.is_empty() {
            return Ok(());
        }
        let before = self.compressed.len();
        let mut encoder = ZlibEncoder::new(&mut self.compressed, Compression::fast());
        encoder.write_all(&self.open)?;
        encoder.finish()?;
        self.sizes.push(self.compressed.len() - before);
        self.open.clear();
        Ok(())
    }
}

impl Write for Blocks {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = bytes.len().min(BLOCK - self.open.len());
        self.open.extend(&bytes[..taken]);
        if self.open.len() == BLOCK {
            self.close()?;
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Writes the leaf elements with their values.
///
/// # Errors
/// What `out` reports.
pub fn write_vtu(field: &Field<'_>, out: &mut dyn Write) -> io::Result<()> {
    let Anchored { leaves, polygons: welded, .. } = field.mesh().anchored(SMOOTH_WELD);
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
    let all = || sections.iter().flat_map(|(_, arrays)| arrays);
    let data: Vec<Vec<u8>> = all().map(Array::compressed).collect::<io::Result<_>>()?;
    let (mut offset, mut sizes) = (0, data.iter().map(Vec::len));
    for (section, arrays) in sections {
        writeln!(out, "<{section}>")?;
        for array in arrays {
            array.describe(out, offset)?;
            offset += sizes.next().unwrap_or_default();
        }
        writeln!(out, "</{section}>")?;
    }
    write!(out, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
    data.iter().try_for_each(|bytes| out.write_all(bytes))?;
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}

fn opening([points, cells]: [usize; 2], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
    )?;
    writeln!(out, "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">")
}

fn points(welded: &Welded) -> Array<'_> {
    let values = || welded.vertices.iter().flat_map(Vec3::to_array);
    Array::floats("Points".to_owned(), 3, values)
}

fn cells<'a>(leaves: &'a Welded, welded: &'a Welded) -> Vec<Array<'a>> {
    let ends = || {
        welded.patches().scan(0, |end, patch| {
            *end += patch.len();
            Some(*end)
        })
    };
    vec![
        Array::integers("connectivity", || welded.patches().flatten().copied()),
        Array::integers("offsets", ends),
        Array {
            name: "types".to_owned(),
            kind: "UInt8",
            components: 1,
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
        Array::integers("element", move || 0..n),
        Array::integers("face", move || (0..n).map(|leaf| mesh.face_of(leaf))),
        Array::integers("surface", move || (0..n).map(|leaf| mesh.surface_of(leaf))),
        Array::floats("area".to_owned(), 1, move || mesh.patches().map(Patch::area)),
        Array::floats("exposed".to_owned(), 1, move || (0..n).map(move |leaf| field.exposed(leaf))),
    ];
    for band in 0..field.bands().len() {
        arrays.push(of_band(&field, "irradiance", field.irradiance(), band));
        arrays.push(of_band(&field, "radiosity", field.radiosity(), band));
    }
    arrays
}

fn of_band<'a>(field: &Field<'a>, what: &str, values: &'a [f64], band: usize) -> Array<'a> {
    let bands = field.bands();
    let picked = move || values.iter().skip(band).step_by(bands.len()).copied();
    Array::floats(format!("{what}_{}", bands[band]), 1, picked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::{names, sample};
    use crate::xml::tests::{attribute, tags};
    use flate2::read::ZlibDecoder;
    use std::collections::BTreeMap;
    use std::io::Read;

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
            let word = |k: usize| {
                let at = offset + 8 * k;
                u64::from_le_bytes(raw[at..at + 8].try_into().unwrap()) as usize
            };
            let mut block = vec![];
            end = offset + 8 * (3 + word(0));
            for k in 0..word(0) {
                ZlibDecoder::new(&raw[end..end + word(3 + k)]).read_to_end(&mut block).unwrap();
                end += word(3 + k);
            }
            assert_eq!(word(2), block.len() % word(1));
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

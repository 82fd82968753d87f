//! `currents.vtu`: the surface currents for `ParaView`, a cell a facet.
//!
//! Format: VTK XML, version 1.0, little endian, appended raw data, `UInt64` block headers
//! (<https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>). For each frequency
//! the magnitude √(Σ |c|²) of J (A/m) and M (V/m), their real and imaginary vectors, and the phase
//! (degrees) of the component of J that is largest on the whole surface.

use std::io::{self, Write};

use fredholm_mesh::{Mesh, Vec3};

use crate::xml::escaped;

const TRIANGLE: u8 = 5;
const QUAD: u8 = 9;

/// The currents at one frequency: jx, jy, jz (A/m), mx, my, mz (V/m), real part first, a facet.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveCurrents {
    /// What it is called in the file.
    pub name: String,
    /// Twelve numbers a facet.
    pub values: Vec<[f64; 12]>,
}

/// An array of the file: kind, name, components and bytes.
struct Array {
    kind: &'static str,
    name: String,
    components: usize,
    bytes: Vec<u8>,
}

impl Array {
    fn floats(name: String, components: usize, values: impl Iterator<Item = f64>) -> Self {
        Self { kind: "Float64", name, components, bytes: values.flat_map(f64::to_le_bytes).collect() }
    }

    fn integers(name: &str, values: impl Iterator<Item = usize>) -> Self {
        let bytes = values.flat_map(|value| (value as u64).to_le_bytes()).collect();
        Self { kind: "Int64", name: name.to_owned(), components: 1, bytes }
    }
}

/// Writes the facets with their currents, one set a frequency.
///
/// # Errors
/// What `out` reports.
pub fn write_currents_vtu(mesh: &Mesh, currents: &[WaveCurrents], out: &mut dyn Write) -> io::Result<()> {
    let corners: usize = mesh.patches().map(|patch| patch.corners().len()).sum();
    let points = mesh.patches().flat_map(fredholm_mesh::Patch::corners).flat_map(Vec3::to_array);
    let data = currents.iter().flat_map(arrays).collect();
    let sections = [
        ("Points", vec![Array::floats("Points".to_owned(), 3, points)]),
        ("Cells", cells(mesh, corners)),
        ("CellData", data),
    ];
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
    )?;
    let facets = mesh.len();
    writeln!(out, "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{corners}\" NumberOfCells=\"{facets}\">")?;
    describe(&sections, out)?;
    write!(out, "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
    for array in sections.iter().flat_map(|(_, arrays)| arrays) {
        out.write_all(&(array.bytes.len() as u64).to_le_bytes())?;
        out.write_all(&array.bytes)?;
    }
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}

fn describe(sections: &[(&str, Vec<Array>)], out: &mut dyn Write) -> io::Result<()> {
    let mut offset = 0;
    for (section, arrays) in sections {
        writeln!(out, "<{section}>")?;
        for Array { kind, name, components, bytes } in arrays {
            let name = escaped(name);
            write!(out, "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\"")?;
            writeln!(out, " format=\"appended\" offset=\"{offset}\"/>")?;
            offset += 8 + bytes.len();
        }
        writeln!(out, "</{section}>")?;
    }
    Ok(())
}

fn cells(mesh: &Mesh, corners: usize) -> Vec<Array> {
    let sides = || mesh.patches().map(|patch| patch.corners().len());
    let ends = sides().scan(0, |end, sides| {
        *end += sides;
        Some(*end)
    });
    let types = sides().map(|sides| if sides == 3 { TRIANGLE } else { QUAD }).collect();
    vec![
        Array::integers("connectivity", 0..corners),
        Array::integers("offsets", ends),
        Array { kind: "UInt8", name: "types".to_owned(), components: 1, bytes: types },
    ]
}

fn arrays(currents: &WaveCurrents) -> Vec<Array> {
    let WaveCurrents { name, values } = currents;
    let mut arrays = Vec::new();
    for (letter, first) in [("J", 0), ("M", 6)] {
        if values.iter().all(|value| value[first..first + 6].iter().all(|&x| x == 0.0)) {
            continue;
        }
        let part = move |offset: usize| {
            values.iter().flat_map(move |v| (0..3).map(move |c| v[first + 2 * c + offset]))
        };
        let magnitude = values.iter().map(|v| v[first..first + 6].iter().map(|x| x * x).sum::<f64>().sqrt());
        let component = largest(values, first);
        let phase = values.iter().map(|v| v[component + 1].atan2(v[component]).to_degrees());
        arrays.push(Array::floats(format!("{letter} magnitude {name}"), 1, magnitude));
        arrays.push(Array::floats(format!("{letter} phase degrees {name}"), 1, phase));
        arrays.push(Array::floats(format!("{letter} real {name}"), 3, part(0)));
        arrays.push(Array::floats(format!("{letter} imaginary {name}"), 3, part(1)));
    }
    arrays
}

/// Where the component with the most power begins.
fn largest(values: &[[f64; 12]], first: usize) -> usize {
    let power = |at: usize| values.iter().map(|v| v[at] * v[at] + v[at + 1] * v[at + 1]).sum::<f64>();
    let places = [first, first + 2, first + 4];
    places.into_iter().max_by(|&a, &b| power(a).total_cmp(&power(b))).unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::sample;
    use crate::xml::tests::{attribute, tags};

    #[test]
    fn magnitude_and_phase_stand_where_the_header_says() {
        let mesh = sample();
        let mut values = vec![[0.0; 12]; mesh.len()];
        values[1][2] = 3.0;
        values[1][3] = -4.0;
        let mut out = Vec::new();
        write_currents_vtu(&mesh, &[WaveCurrents { name: "1 GHz".to_owned(), values }], &mut out).unwrap();
        let mark = b"<AppendedData encoding=\"raw\">\n_";
        let start = out.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len();
        let xml = String::from_utf8(out[..start - 1].to_vec()).unwrap() + "</AppendedData></VTKFile>";
        let found = tags(&xml);
        let arrays: Vec<&String> =
            found.iter().filter(|(name, _)| name == "DataArray").map(|(_, attributes)| attributes).collect();
        assert_eq!(arrays.len(), 4 + 4);
        let read = |name: &str, index: usize| {
            let array = arrays.iter().find(|a| attribute(a, " Name") == name).unwrap();
            let at = start + attribute(array, "offset").parse::<usize>().unwrap() + 8 + 8 * index;
            f64::from_le_bytes(out[at..at + 8].try_into().unwrap())
        };
        assert_eq!((read("J magnitude 1 GHz", 0), read("J magnitude 1 GHz", 1)), (0.0, 5.0));
        assert!((read("J phase degrees 1 GHz", 1) + 53.130_102_354_155_98).abs() < 1e-12);
        assert_eq!((read("J real 1 GHz", 4), read("J imaginary 1 GHz", 4)), (3.0, -4.0));
    }
}

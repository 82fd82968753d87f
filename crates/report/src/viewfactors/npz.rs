//! View factors as an NPZ archive: `numpy.load` reads all of it, `scipy.sparse.load_npz` the sparse
//! matrix.
//!
//! | array | type | shape | |
//! |---|---|---|---|
//! | `F` | f64 | n × n | dense matrix |
//! | `data`, `indices`, `indptr`, `shape`, `format` | f64, i32, i64, i64, bytes | | sparse matrix (CSR) in place of `F` |
//! | `threshold` | f64 | 1 | least factor kept, of a sparse matrix |
//! | `F_error` | f32 | as `F` or `data` | stated error of every stored factor, rounded up |
//! | `names` | text | n | |
//! | `areas` | f64 | n | m² |
//! | `emissivity` | f64 | n | where it is known |
//! | `row_sums`, `row_error`, `row_dropped` | f64 | n | Σ_j F_ij, its stated error, the part that was dropped |
//! | `points`, `normals` | f64 | m × 3 | m; unit; where there are points |
//! | `point_factors` | f64 | m × n | what the points see |
//!
//! Nothing is compressed; no time stamp enters the file.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use super::error::ViewFactorsError;
use super::matrix::{Factors, Sparse, SurfaceData, ViewFactors, ViewPoints};
use super::npy::{self, Array, Number};

impl ViewFactors {
    /// Writes the matrix as an NPZ archive.
    ///
    /// # Errors
    /// What `out` reports.
    pub fn write_npz(&self, out: &mut dyn Write) -> io::Result<()> {
        let n = self.len();
        let mut archive = Archive(ZipWriter::new_stream(out));
        match &self.factors {
            Factors::Dense(values) => archive.numbers("F", &[n, n], values)?,
            Factors::Sparse(sparse) => archive.sparse(n, sparse)?,
        }
        archive.numbers("F_error", &self.factors.shape(n), &self.errors)?;
        archive.entry("names", |out| npy::write_texts(out, &self.surfaces.names))?;
        archive.numbers("areas", &[n], &self.surfaces.area)?;
        if let Some(emissivity) = &self.surfaces.emissivity {
            archive.numbers("emissivity", &[n], emissivity)?;
        }
        archive.numbers("row_sums", &[n], &self.row_sums)?;
        archive.numbers("row_error", &[n], &self.surfaces.row_error)?;
        archive.numbers("row_dropped", &[n], &self.row_dropped)?;
        if let Some(points) = &self.points {
            archive.points(n, points)?;
        }
        archive.0.finish().map(drop).map_err(io::Error::other)
    }

    /// Reads what [`write_npz`](Self::write_npz) wrote, to the same bits.
    ///
    /// # Errors
    /// [`ViewFactorsError`] with the array and its place for a file that is damaged or holds
    /// something else.
    pub fn read_npz(path: &Path) -> Result<Self, ViewFactorsError> {
        Reader::open(path)?.view_factors()
    }
}

impl Factors {
    /// Shape of what is stored of n × n factors.
    fn shape(&self, n: usize) -> Vec<usize> {
        match self {
            Self::Dense(_) => vec![n; 2],
            Self::Sparse(sparse) => vec![sparse.values.len()],
        }
    }
}

/// An archive that is being written.
struct Archive<'a>(ZipWriter<zip::write::StreamWriter<&'a mut dyn Write>>);

impl Archive<'_> {
    fn entry(&mut self, name: &str, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .large_file(true);
        self.0.start_file(format!("{name}.npy"), options)?;
        write(&mut self.0)
    }

    fn numbers<T: Number>(&mut self, name: &str, shape: &[usize], values: &[T]) -> io::Result<()> {
        self.entry(name, |out| npy::write(out, shape, values))
    }

    fn sparse(&mut self, n: usize, sparse: &Sparse) -> io::Result<()> {
        // Numbers of surfaces and entries in memory fit the signed types of SciPy.
        let columns: Vec<i32> = sparse.columns.iter().map(|&column| column.cast_signed()).collect();
        let starts: Vec<i64> = sparse.starts.iter().map(|&start| start.cast_signed()).collect();
        self.numbers("data", &[sparse.values.len()], &sparse.values)?;
        self.numbers("indices", &[columns.len()], &columns)?;
        self.numbers("indptr", &[starts.len()], &starts)?;
        self.numbers("shape", &[2], &[n as i64; 2])?;
        self.entry("format", |out| npy::write_word(out, "csr"))?;
        self.numbers("threshold", &[1], &[sparse.threshold])
    }

    fn points(&mut self, n: usize, points: &ViewPoints) -> io::Result<()> {
        let count = points.points.len();
        self.numbers("points", &[count, 3], points.points.as_flattened())?;
        self.numbers("normals", &[count, 3], points.normals.as_flattened())?;
        self.numbers("point_factors", &[count, n], &points.factors)
    }
}

/// Every array that an archive may have; another one is taken for damage.
const ARRAYS: [&str; 17] = [
    "F",
    "F_error",
    "data",
    "indices",
    "indptr",
    "shape",
    "format",
    "threshold",
    "names",
    "areas",
    "emissivity",
    "row_sums",
    "row_error",
    "row_dropped",
    "points",
    "normals",
    "point_factors",
];

/// An archive that is being read.
struct Reader<'a> {
    path: &'a Path,
    archive: ZipArchive<BufReader<File>>,
}

impl<'a> Reader<'a> {
    fn open(path: &'a Path) -> Result<Self, ViewFactorsError> {
        let unreadable = |source| ViewFactorsError::Read { path: path.to_owned(), source };
        let file = BufReader::new(File::open(path).map_err(unreadable)?);
        let archive = ZipArchive::new(file).map_err(|error| match error {
            zip::result::ZipError::Io(source) if source.kind() != io::ErrorKind::UnexpectedEof => {
                unreadable(source)
            }
            error => ViewFactorsError::Archive { path: path.to_owned(), why: error.to_string() },
        })?;
        let known = |name: &&str| name.strip_suffix(".npy").is_some_and(|name| ARRAYS.contains(&name));
        if let Some(name) = archive.file_names().find(|name| !known(name)) {
            let why = format!("it has an entry {name:?} that view factors do not have");
            return Err(ViewFactorsError::Archive { path: path.to_owned(), why });
        }
        Ok(Self { path, archive })
    }

    fn view_factors(mut self) -> Result<ViewFactors, ViewFactorsError> {
        let names = self.required("names", names)?;
        let n = names.len();
        let area = self.vector("areas", n)?;
        let emissivity = self.optional("emissivity", |array| matrix(array, &[n]))?;
        let factors = if self.has("F") {
            Factors::Dense(self.required("F", |array| matrix(array, &[n, n]))?)
        } else {
            Factors::Sparse(self.sparse(n)?)
        };
        let shape = factors.shape(n);
        let errors = self.required("F_error", |array| errors(array, &shape))?;
        let (row_sums, row_error, row_dropped) =
            (self.vector("row_sums", n)?, self.vector("row_error", n)?, self.vector("row_dropped", n)?);
        let points = if self.has("points") { Some(self.points(n)?) } else { None };
        let surfaces = SurfaceData { names, area, emissivity, row_error };
        Ok(ViewFactors { surfaces, factors, errors, row_sums, row_dropped, points })
    }

    fn sparse(&mut self, n: usize) -> Result<Sparse, ViewFactorsError> {
        let values: Vec<f64> = self.required("data", |array| finite(array.numbers()?))?;
        let count = values.len();
        let starts = self.required("indptr", |array| starts(&array.numbers()?, n, count))?;
        let columns = self.required("indices", |array| columns(&array.numbers()?, n, &starts))?;
        let threshold = self.vector("threshold", 1)?[0];
        Ok(Sparse { threshold, starts, columns, values })
    }

    fn points(&mut self, n: usize) -> Result<ViewPoints, ViewFactorsError> {
        let triples = |array: &Array| {
            let count = array.shape.first().copied().unwrap_or(0);
            let flat = matrix(array, &[count, 3])?;
            Ok(flat.as_chunks::<3>().0.to_vec())
        };
        let points = self.required("points", triples)?;
        let count = points.len();
        let normals = self.required("normals", |array| matrix(array, &[count, 3]))?;
        let normals = normals.as_chunks::<3>().0.to_vec();
        let factors = self.required("point_factors", |array| matrix(array, &[count, n]))?;
        Ok(ViewPoints { points, normals, factors })
    }

    fn vector(&mut self, entry: &'static str, n: usize) -> Result<Vec<f64>, ViewFactorsError> {
        self.required(entry, |array| matrix(array, &[n]))
    }

    fn has(&self, entry: &str) -> bool {
        self.archive.index_for_name(&format!("{entry}.npy")).is_some()
    }

    fn optional<T>(
        &mut self,
        entry: &'static str,
        take: impl FnOnce(&Array) -> Result<T, String>,
    ) -> Result<Option<T>, ViewFactorsError> {
        if self.has(entry) { self.required(entry, take).map(Some) } else { Ok(None) }
    }

    fn required<T>(
        &mut self,
        entry: &'static str,
        take: impl FnOnce(&Array) -> Result<T, String>,
    ) -> Result<T, ViewFactorsError> {
        let path = || self.path.to_owned();
        if !self.has(entry) {
            return Err(ViewFactorsError::Missing { path: path(), entry });
        }
        let broken = |offset, why| ViewFactorsError::Array { path: path(), entry, offset, why };
        let mut file = self.archive.by_name(&format!("{entry}.npy")).map_err(|e| broken(0, e.to_string()))?;
        let offset = file.data_start();
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(|error| broken(offset, error.to_string()))?;
        Array::parse(&bytes).and_then(|array| take(&array)).map_err(|why| broken(offset, why))
    }
}

fn names(array: &Array) -> Result<Vec<String>, String> {
    array.texts()
}

/// Finite numbers of a given shape.
fn matrix(array: &Array, shape: &[usize]) -> Result<Vec<f64>, String> {
    fits(array, shape)?;
    finite(array.numbers()?)
}

fn fits(array: &Array, shape: &[usize]) -> Result<(), String> {
    if array.shape == shape {
        Ok(())
    } else {
        Err(format!("its shape is {:?}, but {shape:?} fits the names", array.shape))
    }
}

/// Finite numbers of a given shape, none of them negative.
fn errors(array: &Array, shape: &[usize]) -> Result<Vec<f32>, String> {
    fits(array, shape)?;
    let errors: Vec<f32> = array.numbers()?;
    match errors.iter().position(|error| !error.is_finite() || *error < 0.0) {
        Some(at) => Err(format!("number {at} is {}, no error", errors[at])),
        None => Ok(errors),
    }
}

fn finite(values: Vec<f64>) -> Result<Vec<f64>, String> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(at) => Err(format!("number {at} is {}, not finite", values[at])),
        None => Ok(values),
    }
}

/// Starts of rows: from 0 to `count`, never falling.
fn starts(found: &[i64], n: usize, count: usize) -> Result<Vec<u64>, String> {
    let starts: Vec<u64> = found.iter().filter_map(|&start| u64::try_from(start).ok()).collect();
    let ends = starts.first() == Some(&0) && starts.last() == Some(&(count as u64));
    let sound = found.len() == n + 1 && starts.len() == found.len() && ends && starts.is_sorted();
    if sound { Ok(starts) } else { Err(format!("it does not cut {count} entries into {n} rows")) }
}

/// Columns: below `n`, rising within a row.
fn columns(found: &[i32], n: usize, starts: &[u64]) -> Result<Vec<u32>, String> {
    let columns: Vec<u32> = found.iter().filter_map(|&column| u32::try_from(column).ok()).collect();
    let whole = columns.len() == found.len() && starts.last() == Some(&(found.len() as u64));
    let rising =
        |row: &[u32]| row.windows(2).all(|pair| pair[0] < pair[1]) && row.iter().all(|&c| (c as usize) < n);
    let sound = whole && starts.windows(2).all(|row| rising(&columns[row[0] as usize..row[1] as usize]));
    if sound {
        Ok(columns)
    } else {
        Err(format!("its columns do not rise within rows, or are not below {n}"))
    }
}

#[cfg(test)]
mod tests {
    use super::super::matrix::tests::sample;
    use super::*;

    fn written(factors: &ViewFactors) -> Vec<u8> {
        let mut out = Vec::new();
        factors.write_npz(&mut out).unwrap();
        out
    }

    fn read(bytes: &[u8]) -> Result<ViewFactors, ViewFactorsError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("F.npz");
        std::fs::write(&path, bytes).unwrap();
        ViewFactors::read_npz(&path)
    }

    #[test]
    fn what_was_written_reads_back_to_the_same_bits() {
        for threshold in [None, Some(0.1), Some(0.0), Some(2.0)] {
            let factors = sample(threshold);
            let bytes = written(&factors);
            assert_eq!(read(&bytes).unwrap(), factors);
            assert!(bytes == written(&factors), "no time stamp may enter the file");
        }
        let plain = ViewFactors { points: None, ..sample(None) };
        let plain = ViewFactors { surfaces: SurfaceData { emissivity: None, ..plain.surfaces }, ..plain };
        assert_eq!(read(&written(&plain)).unwrap(), plain);
    }

    #[test]
    fn another_reader_finds_the_same_numbers() {
        let factors = sample(None);
        let mut npz = ndarray_npy::NpzReader::new(io::Cursor::new(written(&factors))).unwrap();
        let f: ndarray::Array2<f64> = npz.by_name("F").unwrap();
        let mut row = [0.0; 3];
        for i in 0..3 {
            factors.copy_row(i, &mut row);
            assert_eq!(f.row(i).to_vec(), row);
        }
        let areas: ndarray::Array1<f64> = npz.by_name("areas").unwrap();
        assert_eq!(areas.to_vec(), factors.surfaces.area);
        let points: ndarray::Array2<f64> = npz.by_name("points").unwrap();
        assert_eq!(points.row(1).to_vec(), [1e-300, -0.5, 7.0]);
    }

    #[test]
    fn no_truncation_or_flipped_byte_is_read_as_something_else() {
        let factors = sample(Some(0.1));
        let bytes = written(&factors);
        for length in (0..bytes.len()).step_by(7) {
            assert!(read(&bytes[..length]).is_err(), "{length}");
        }
        let mut changed = 0;
        for at in (0..bytes.len()).step_by(11) {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x21;
            // Bytes that nothing reads, such as attributes of files, may differ; numbers may not.
            match read(&damaged) {
                Ok(found) => assert_eq!(found, factors, "byte {at}"),
                Err(error) => changed += usize::from(error.to_string().contains("F.npz")),
            }
        }
        assert!(changed > 100, "{changed}");
    }

    #[test]
    fn arrays_that_do_not_fit_are_named_with_their_place() {
        let mut factors = sample(None);
        factors.surfaces.area.pop();
        let message =
            read(&written(&ViewFactors { row_sums: vec![1.0; 2], ..factors })).unwrap_err().to_string();
        assert!(message.contains("`areas`, from byte ") && message.contains("[3] fits"), "{message}");
        let nan = sample(Some(0.1));
        let Factors::Sparse(sparse) = &nan.factors else { panic!("a threshold makes it sparse") };
        let broken = |change: &dyn Fn(&mut Sparse)| {
            let mut sparse = sparse.clone();
            change(&mut sparse);
            read(&written(&ViewFactors { factors: Factors::Sparse(sparse), ..nan.clone() }))
                .unwrap_err()
                .to_string()
        };
        assert!(broken(&|s| s.values[0] = f64::NAN).contains("`data`"));
        assert!(broken(&|s| s.columns[0] = 7).contains("`indices`"));
        assert!(broken(&|s| s.starts[1] = 9).contains("`indptr`"));
        let negative = ViewFactors { errors: vec![-1.0; nan.errors.len()], ..nan.clone() };
        let message = read(&written(&negative)).unwrap_err().to_string();
        assert!(message.contains("`F_error`") && message.contains("-1, no error"), "{message}");
        assert!(matches!(read(b"PK"), Err(ViewFactorsError::Archive { .. })));
        let missing = ViewFactors::read_npz(Path::new("/nonexistent/F.npz"));
        assert!(matches!(missing, Err(ViewFactorsError::Read { .. })));
    }
}

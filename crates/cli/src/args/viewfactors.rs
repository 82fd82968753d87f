//! What `viewfactors` understands.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use fredholm_report::MatrixFormat;
use fredholm_study::{
    Bytes, GatherPoints, MatrixRows, PointGrid, Receiver, Vec3, ViewFactorOptions, view_factor_methods,
};

use super::{LogArgs, tolerance};
use crate::start::recorded;

/// What follows the help.
pub(super) const EXAMPLES: &str = "\
Examples:
  fredholm viewfactors room.vs3 -o F.npz
  fredholm viewfactors room.obj -o F.csv --tolerance 1e-4
  fredholm viewfactors room.obj -o F.csv --method auto --tolerance 1e-6
  fredholm viewfactors room.toml -o F.txt --rows surface --close
  fredholm viewfactors court.obj -o F.npz --sky --threshold 1e-5
  fredholm viewfactors room.obj -o F.npz --method hemicube --setting 256
  fredholm viewfactors hall.obj -o F.npz --point 1,2,0.8,0,0,1 --plane 0,0,0.8,6,0,0,0,4,0,12,8

row-budget asks the tolerance of a row and spends on a pair what it matters to its row; auto asks it
of every pair: take that for factors that are used one by one. All other methods are for study: they
compute one pair after the other. --setting is the order of area-gauss and nystrom, the tolerance of
contour and point-polygon, the samples (or samples,seed) of monte-carlo, the pixels of hemicube.

Beside F.npz come F.png, the matrix as a picture; F.svg, how well its rows close; F.html, the
page for the browser; and F.json, the record. Ctrl-C ends the run with nothing written.

Faces of a mesh file are seen from the side from which their corners run counter-clockwise.";

/// Most points of a plane.
const MOST_POINTS: f64 = 1e8;

/// Options of `viewfactors`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ViewFactorsArgs {
    /// Scene (.toml), or mesh file whose faces are the patches (.obj, .vs3)
    pub(crate) input: PathBuf,
    /// File for the matrix [default: out/<name of the input>.npz]
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Form of the matrix [default: by the ending of the file: .npz, .csv, or .txt, .out, .vf for
    /// view3d]
    #[arg(long, value_enum, value_name = "FORM")]
    pub(crate) format: Option<Format>,
    /// Error asked for in a row; with auto in a pair, and rounded down to a power of ten, 1e-14 at
    /// least [default: the file's, else 1e-3; of methods for study, their usual one]
    #[arg(long, value_name = "T", value_parser = tolerance)]
    pub(crate) tolerance: Option<f64>,
    /// How form factors are computed
    #[arg(long, value_name = "NAME", default_value = "row-budget",
        value_parser = PossibleValuesParser::new(view_factor_methods()))]
    pub(crate) method: String,
    /// Setting of a method for study: its order, tolerance, samples or pixels [default: its
    /// usual one]
    #[arg(long, value_name = "VALUE")]
    pub(crate) setting: Option<String>,
    /// What a row stands for
    #[arg(long, value_enum, default_value_t, value_name = "WHAT")]
    pub(crate) rows: RowsBy,
    /// Keep only factors of at least X, sparsely; what a row drops is stated
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub(crate) threshold: Option<f64>,
    /// Change the factors so that every row sums to 1, by least squares; the change is stated
    #[arg(long)]
    pub(crate) close: bool,
    /// Add the sky as the last row and column: a box around everything
    #[arg(long)]
    pub(crate) sky: bool,
    /// Point with a normal that sees the surfaces: x,y,z,nx,ny,nz (may be given several times)
    #[arg(long, value_name = "POINT", value_parser = point, allow_hyphen_values = true)]
    pub(crate) point: Vec<Receiver>,
    /// Points in a parallelogram: ox,oy,oz,ux,uy,uz,vx,vy,vz,NU,NV, normal u × v (may be given
    /// several times)
    #[arg(long, value_name = "PLANE", value_parser = plane, allow_hyphen_values = true)]
    pub(crate) plane: Vec<PointGrid>,
    /// Write no page for the browser (F.html)
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Threads; any number gives the same results [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Memory allowed, such as 4GiB or 800MB [default: what leaves the machine usable]
    #[arg(long, value_name = "LIMIT")]
    pub(crate) memory: Option<Bytes>,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

/// Form of the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Arrays for NumPy; SciPy reads the sparse ones
    Npz,
    /// A table
    Csv,
    /// Text as View3D writes it
    View3d,
}

/// What a row stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum RowsBy {
    /// An element of the mesh
    Element,
    /// A face of the input; of a .vs3, a surface with what is combined with it
    #[default]
    Face,
    /// A named surface
    Surface,
}

impl From<Format> for MatrixFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Npz => Self::Npz,
            Format::Csv => Self::Csv,
            Format::View3d => Self::View3d,
        }
    }
}

impl From<RowsBy> for MatrixRows {
    fn from(rows: RowsBy) -> Self {
        match rows {
            RowsBy::Element => Self::Element,
            RowsBy::Face => Self::Face,
            RowsBy::Surface => Self::Surface,
        }
    }
}

impl ViewFactorsArgs {
    pub(crate) fn options(&self) -> ViewFactorOptions {
        ViewFactorOptions {
            input: self.input.as_path().into(),
            tolerance: self.tolerance,
            method: self.method.clone(),
            setting: self.setting.clone(),
            rows: self.rows.into(),
            threshold: self.threshold,
            close: self.close,
            sky: self.sky,
            points: GatherPoints { points: self.point.clone(), grids: self.plane.clone() },
            no_report: self.no_report,
            threads: self.threads,
            memory: self.memory,
            recorded: recorded(self.log),
        }
    }
}

pub(crate) fn point(text: &str) -> Result<Receiver, String> {
    let [x, y, z, nx, ny, nz] = numbers(text)?;
    let receiver = Receiver::new(Vec3::new(x, y, z), Vec3::new(nx, ny, nz));
    receiver
        .ok_or_else(|| "the normal has no direction; write x,y,z,nx,ny,nz such as 1,2,0.8,0,0,1".to_owned())
}

pub(crate) fn plane(text: &str) -> Result<PointGrid, String> {
    let numbers: [f64; 11] = numbers(text)?;
    let [origin, u, v] = [0, 3, 6].map(|k| Vec3::new(numbers[k], numbers[k + 1], numbers[k + 2]));
    let [nu, nv] = [numbers[9], numbers[10]];
    let whole = |n: f64| n >= 1.0 && n.fract() == 0.0;
    if !whole(nu) || !whole(nv) || nu * nv > MOST_POINTS {
        return Err(format!(
            "NU and NV must be whole numbers from 1 on, with a product of at most {MOST_POINTS:e}"
        ));
    }
    PointGrid::new(origin, [u, v], [nu as usize, nv as usize])
        .ok_or_else(|| "u and v must span an area: their cross product is the normal".to_owned())
}

/// Finite numbers between commas.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parse = |word: &str| word.trim().parse().ok().filter(|x: &f64| x.is_finite() && x.abs() <= 1e30);
    let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
    let numbers = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
    numbers.ok_or_else(|| format!("write {N} finite numbers with commas between them"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_planes_are_read() {
        let receiver = point("1, -2,0.8,0,0,2").unwrap();
        assert_eq!((receiver.point, receiver.normal), (Vec3::new(1.0, -2.0, 0.8), Vec3::Z));
        let grid = plane("0,0,1,2,0,0,0,1,0,2,3").unwrap();
        assert_eq!((grid.count(), grid.receivers().len()), (6, 6));
        for text in ["", "1,2,3,0,0", "1,2,3,0,0,0", "1,2,3,0,0,nan", "1,2,3,0,0,1,1", "1,2,3,0,0,1e300"] {
            assert!(point(text).is_err(), "{text}");
        }
        for text in [
            "0,0,1,2,0,0,0,1,0,2,0",
            "0,0,1,2,0,0,0,1,0,2,1.5",
            "0,0,1,2,0,0,4,0,0,2,3",
            "0,0,1,2,0,0,0,1,0,1e9,1e9",
        ] {
            assert!(plane(text).is_err(), "{text}");
        }
    }
}

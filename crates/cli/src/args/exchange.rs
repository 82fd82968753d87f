//! Options of `export` and `convert`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use fredholm_study::ExportFormat;

use super::LogArgs;

/// What follows the help of `export`.
pub(super) const EXPORT_EXAMPLES: &str = "\
Examples:
  fredholm export scenes/cornell_planar.toml --to mitsuba -o out/mitsuba
  fredholm export room.toml --to radiance -o out/radiance
  fredholm export spectral.toml --to pbrt --band 540nm -o out/pbrt

Geometry, diffuse reflectances, emitters (radiance M/π) and the camera are those of the scene; what
a format cannot express is told. Bands r, g, b (or red, green, blue) are colours and a single band
is grey; of other bands, one is chosen by --band.";

/// What follows the help of `convert`.
pub(super) const CONVERT_EXAMPLES: &str = "\
Examples:
  fredholm convert chair.stl chair.obj
  fredholm convert room.xml room.glb
  fredholm convert scenes/cornell_planar.toml cornell.msh

Read are .obj, .stl, .ply, .gltf, .glb, .msh (Gmsh 4.1), .rad (Radiance), .xml (Mitsuba 3), .vs3
(View3D) and scenes (.toml). Written are .obj (with .mtl), .stl, .ply, .glb, .msh, .rad, .xml and
.pbrt. Faces without area are left out, and polygons of more than four corners are cut; what the
new format cannot express is told.";

/// Options of `export`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ExportArgs {
    /// Scene file (.toml), or mesh file that stands for a scene
    pub(crate) scene: PathBuf,
    /// Program or format to write for
    #[arg(long, value_name = "FORMAT", value_parser = PossibleValuesParser::new(ExportFormat::ALL.map(|(_, name, _)| name)))]
    to: String,
    /// Folder for the files [default: out/<name of the scene file>-export]
    #[arg(long, short, value_name = "DIR")]
    pub(crate) output: Option<PathBuf>,
    /// Band that stands for grey, for bands that are no colours
    #[arg(long, value_name = "BAND")]
    pub(crate) band: Option<String>,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

impl ExportArgs {
    pub(crate) fn format(&self) -> Option<ExportFormat> {
        ExportFormat::ALL.iter().find(|(_, name, _)| *name == self.to).map(|(format, ..)| *format)
    }
}

/// Options of `convert`.
#[derive(Clone, Debug, Args)]
pub(crate) struct ConvertArgs {
    /// Mesh file or scene to read
    pub(crate) from: PathBuf,
    /// Mesh file to write; the ending of its name is the format
    pub(crate) to: PathBuf,
    #[command(flatten)]
    pub(crate) log: LogArgs,
}

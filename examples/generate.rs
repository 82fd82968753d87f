//! Writes a generated scene:
//! `cargo run --release --example generate -- city --faces 13000 --seed 1 -o DIR`.

use std::error::Error;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use fredholm_generate::{Almond, City, Classroom, Files, Office, Room, Scan};

/// Writes a scene made from a number: an OBJ and a scene file beside it.
#[derive(Debug, Parser)]
struct Cli {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, Args)]
struct Common {
    /// Folder for the files
    #[arg(long, short, value_name = "DIR")]
    output: PathBuf,
    /// The same seed gives the same files
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

#[derive(Debug, Subcommand)]
enum Kind {
    /// Touching, overlapping and interpenetrating blocks with courtyards and thin walls, under a
    /// lit sky
    City {
        /// Most faces in all
        #[arg(long, value_name = "N", default_value_t = 13_000)]
        faces: usize,
        /// How far every corner of a house is moved, m
        #[arg(long, value_name = "M", default_value_t = 0.0)]
        jitter: f64,
        #[command(flatten)]
        common: Common,
    },
    /// A creased figure with noisy normals in a closed room
    Scan {
        /// Most triangles of the figure
        #[arg(long, value_name = "N", default_value_t = 20_000)]
        triangles: usize,
        /// How far corners are moved, in parts of an edge
        #[arg(long, value_name = "PART", default_value_t = 0.15)]
        noise: f64,
        #[command(flatten)]
        common: Common,
    },
    /// An open-plan office with desks, chairs, shelves of books, plants and lamps
    Office {
        /// Bays of about 30,000 triangles
        #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
        bays: u16,
        #[command(flatten)]
        common: Common,
    },
    /// A classroom with twelve desks, cupboards, radiators and curtains
    Classroom {
        #[command(flatten)]
        common: Common,
    },
    /// A closed room, whose energy balance is known
    Room {
        /// Reflectance of everything
        #[arg(long, value_name = "R", default_value_t = 0.9)]
        reflectance: f64,
        /// Everything emits 1 W/m², so that B = M/(1 − ρ) everywhere
        #[arg(long)]
        furnace: bool,
        /// Number of boxes
        #[arg(long, value_name = "N", default_value_t = 4)]
        boxes: usize,
        /// Pieces along each side of a wall
        #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(2..))]
        divide: u16,
        #[command(flatten)]
        common: Common,
    },
    /// The NASA almond with a monostatic sweep of 181 angles, a scene of waves
    Almond {
        /// Frequency, Hz
        #[arg(long, value_name = "HZ", default_value_t = 1e9)]
        frequency: f64,
        /// Length of the edges, m [default: a tenth of the wavelength, at most 6 mm]
        #[arg(long, value_name = "M")]
        edge: Option<f64>,
        /// Folder for the files
        #[arg(long, short, value_name = "DIR")]
        output: PathBuf,
    },
}

impl Kind {
    fn files(self) -> (Files, PathBuf) {
        match self {
            Self::City { faces, jitter, common } => {
                (City { faces, seed: common.seed, jitter }.files(), common.output)
            }
            Self::Scan { triangles, noise, common } => {
                (Scan { triangles, seed: common.seed, noise }.files(), common.output)
            }
            Self::Office { bays, common } => {
                (Office { bays: bays.into(), seed: common.seed }.files(), common.output)
            }
            Self::Classroom { common } => (Classroom { seed: common.seed }.files(), common.output),
            Self::Room { reflectance, furnace, boxes, divide, common } => {
                let room = Room { reflectance, furnace, boxes, divide: divide.into(), seed: common.seed };
                (room.files(), common.output)
            }
            Self::Almond { frequency, edge, output } => (Almond { frequency, edge }.files(), output),
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let (files, folder) = Cli::parse().kind.files();
    println!("{}", files.write(&folder)?.display());
    Ok(())
}

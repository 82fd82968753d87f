//! What can be wrong with a surface or a problem, and how to mend it. Everything is counted from 0.

use fredholm_compressed::CompressionError;
use fredholm_linop::LinopError;
use fredholm_waves::WaveError;
use thiserror::Error;

/// A problem that cannot be set up.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MomentsError {
    /// There is no triangle.
    #[error("the surface has no triangles")]
    Empty,
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices}")]
    NoSuchVertex {
        /// The triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("a coordinate of vertex {vertex} is not a finite number")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A triangle has no area.
    #[error("triangle {triangle} has no area")]
    Degenerate {
        /// The triangle.
        triangle: usize,
    },
    /// The same three corners make two triangles.
    #[error("triangles {first} and {second} have the same corners, but a box without thickness is one sheet")]
    Repeated {
        /// The first of them.
        first: usize,
        /// The second.
        second: usize,
    },
    /// A vertex lies within an edge of another triangle.
    #[error("vertex {vertex} lies within an open edge of triangle {triangle}, where no current could cross")]
    TJunction {
        /// The vertex.
        vertex: usize,
        /// The triangle with the edge.
        triangle: usize,
    },
    /// Two vertices are at the same place.
    #[error("vertices {first} and {second} are at the same place, so that no current crosses there")]
    DuplicateVertices {
        /// The first of them.
        first: usize,
        /// The second.
        second: usize,
    },
    /// No edge has two triangles.
    #[error("no edge of the surface joins two triangles, so that no current can flow")]
    NoInnerEdge,
    /// An equation for closed bodies meets an open surface.
    #[error("{equation} is made for closed bodies, but edge {edge} of triangle {triangle} is open")]
    NotClosed {
        /// The equation.
        equation: &'static str,
        /// The open edge.
        edge: usize,
        /// The triangle it bounds.
        triangle: usize,
    },
    /// An equation for closed bodies meets a junction of several surfaces.
    #[error(
        "{equation} is made for bodies with an inside and an outside, but {triangles} triangles meet at edge {edge}"
    )]
    Junction {
        /// The equation.
        equation: &'static str,
        /// The edge.
        edge: usize,
        /// Triangles that meet there.
        triangles: usize,
    },
    /// Neighbours do not agree on which side is outside.
    #[error(
        "triangles {first} and {second} are neighbours, but their normals are on different sides of the surface"
    )]
    Orientation {
        /// A triangle.
        first: usize,
        /// Its neighbour.
        second: usize,
    },
    /// The normals of a closed body point into it.
    #[error("the normals of the closed body with triangle {triangle} point inwards")]
    InsideOut {
        /// The first triangle of the body.
        triangle: usize,
    },
    /// Bodies touch, but not with the same triangles.
    #[error("triangles {first} and {second} lie on each other, but have not the same corners")]
    Unmatched {
        /// A triangle.
        first: usize,
        /// The other.
        second: usize,
    },
    /// Bodies cross.
    #[error("triangles {first} and {second} cross each other")]
    Crossing {
        /// A triangle.
        first: usize,
        /// The other.
        second: usize,
    },
    /// Curved triangles have functions of the lowest order.
    #[error("functions of the lowest order are on flat triangles, and some of these are curved")]
    Curved,
    /// A curved triangle turns its other side somewhere.
    #[error("the sides of triangle {triangle} are so curved that it folds over")]
    Folded {
        /// The triangle.
        triangle: usize,
    },
    /// The functions are those of a surface in free space, not between regions.
    #[error("the functions are those of a surface in free space, not between regions")]
    NoRegions,
    /// The regions around an edge do not agree.
    #[error("what is between the triangles at edge {edge} is told differently by two of them")]
    Regions {
        /// The edge.
        edge: usize,
    },
    /// A closed body with a surface impedance has something else on a part of its surface.
    #[error("triangles {first} and {second} are of one body, which has one surface impedance all over")]
    Patchwork {
        /// A triangle with an impedance.
        first: usize,
        /// A triangle with another condition.
        second: usize,
    },
    /// Something is not above the ground plane.
    #[error("{what} {index} is not above the ground")]
    BelowGround {
        /// What it is.
        what: &'static str,
        /// Its number.
        index: usize,
    },
    /// Multipoles above a ground plane.
    #[error("multipoles are those of conductors in free space, not above a ground plane")]
    Grounded,
    /// Multipoles of what is no perfect conductor.
    #[error("multipoles are those of perfect conductors only")]
    Imperfect,
    /// Triangles are too large for the wave.
    #[error("edge {edge} is {length} m long, which is more than {most} of the wavelength of {wavelength} m")]
    Coarse {
        /// The edge.
        edge: usize,
        /// Its length, m.
        length: f64,
        /// The shortest wavelength on either side, m.
        wavelength: f64,
        /// The most that it may be of it.
        most: &'static str,
    },
    /// A number that sets up the problem is out of its range.
    #[error("{what} is {value}, but must be {expected}")]
    Parameter {
        /// What the number is.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// A point lies on the surface, where the field jumps.
    #[error("point {point} of the receivers lies on triangle {triangle}, where the field jumps")]
    OnSurface {
        /// The point.
        point: usize,
        /// The triangle.
        triangle: usize,
    },
    /// A source or a wave cannot be set up.
    #[error(transparent)]
    Wave(#[from] WaveError),
    /// A matrix cannot be built.
    #[error(transparent)]
    Linop(#[from] LinopError),
    /// A matrix cannot be compressed as asked.
    #[error(transparent)]
    Compression(#[from] CompressionError),
}

impl MomentsError {
    /// What to do about it, where that is more than to correct the value.
    #[must_use]
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::Empty => Some("add a shape"),
            Self::Degenerate { .. } => Some("remove it and join its corners"),
            Self::Repeated { .. } => Some("remove one of them"),
            Self::TJunction { .. } => Some("split that triangle at the vertex"),
            Self::DuplicateVertices { .. } => Some("join them (`Surface::welded`)"),
            Self::NoInnerEdge => Some("mesh it finer"),
            Self::NotClosed { .. } => Some("close the surface or use the electric field equation"),
            Self::Junction { .. } => Some("use the electric field equation"),
            Self::Orientation { .. } => Some("turn one over (`Surface::oriented`)"),
            Self::InsideOut { .. } => Some("turn it over (`Surface::oriented`)"),
            Self::Unmatched { .. } => Some("cut both bodies alike where they touch, or move them apart"),
            Self::Crossing { .. } => Some("move them apart, or cut one where it enters the other"),
            Self::Curved => Some("take those of the first order (`Order::First`)"),
            Self::Folded { .. } => Some("mesh it finer there, or leave it flat"),
            Self::NoRegions => Some("take those between regions (`Basis::between`)"),
            Self::Regions { .. } => Some("mend the bodies there, or move them apart"),
            Self::Patchwork { .. } => Some("give the whole body one surface impedance"),
            Self::BelowGround { .. } => Some("move it up, or the ground down"),
            Self::Grounded | Self::Imperfect => {
                Some("compress the matrix in blocks (`Operator::compressed`, --storage compressed)")
            }
            Self::Coarse { .. } => Some("mesh finer: λ/10 is usual, λ/4 with functions of order 1"),
            Self::OnSurface { .. } => Some("move it off the surface"),
            Self::Wave(error) => error.help(),
            Self::NoSuchVertex { .. }
            | Self::NotFinite { .. }
            | Self::Parameter { .. }
            | Self::Linop(_)
            | Self::Compression(_) => None,
        }
    }
}

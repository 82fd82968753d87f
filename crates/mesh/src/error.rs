//! What can be wrong with geometry, and how to mend it. Corners, sides and holes are indices from 0
//! in the fields, and are counted from 1 in messages.

use thiserror::Error;

/// Geometry that cannot be meshed, with what to do about it.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("corner {} has a coordinate that is not a finite number", .corner + 1)]
    NotFinite {
        /// Index of the corner.
        corner: usize,
    },
    /// The corners enclose no area.
    #[error("the corners enclose no area (area {area:e} m², longest side {longest:e} m)")]
    NoArea {
        /// Area found, m².
        area: f64,
        /// Longest side, m.
        longest: f64,
    },
    /// More elements were asked for than an index can hold.
    #[error("the mesh would have more than {limit} elements")]
    TooLarge {
        /// Largest number of elements.
        limit: usize,
    },
    /// Two corners of a quad coincide.
    #[error("corners {} and {} of the quad are the same point", .first + 1, .second + 1)]
    RepeatedCorner {
        /// One corner.
        first: usize,
        /// The other.
        second: usize,
    },
    /// The sides of a quad cross.
    #[error("the sides of the quad cross each other")]
    BowTie,
    /// A quad with a reflex corner was to be cut by lines.
    #[error("the quad is not convex at corner {}, so lines cannot cut it", .corner + 1)]
    NotConvex {
        /// The reflex corner.
        corner: usize,
    },
    /// A border with fewer than three different corners.
    #[error("{ring} has fewer than three different corners")]
    TooFewCorners {
        /// The border.
        ring: Ring,
    },
    /// A polygon that is not flat.
    #[error("corner {} of {ring} is {distance:e} m off the plane of the polygon", .corner + 1)]
    NotPlanar {
        /// The border.
        ring: Ring,
        /// Index of the corner.
        corner: usize,
        /// Distance to the mean plane, m.
        distance: f64,
    },
    /// A border crosses or touches itself.
    #[error("{ring} crosses or touches itself at its sides {} and {}", .first + 1, .second + 1)]
    SelfIntersecting {
        /// The border.
        ring: Ring,
        /// Index of the corner where one of the sides begins.
        first: usize,
        /// Index of the corner where the other begins.
        second: usize,
    },
    /// Two borders of a polygon cross or touch.
    #[error("{first} and {second} cross or touch")]
    Crossing {
        /// One border.
        first: Ring,
        /// The other.
        second: Ring,
    },
    /// A hole that does not lie in the polygon.
    #[error("hole {} lies outside the outline", .hole + 1)]
    HoleOutside {
        /// Index of the hole.
        hole: usize,
    },
    /// A hole within a hole.
    #[error("hole {} lies inside hole {}", .hole + 1, .other + 1)]
    HoleInHole {
        /// The inner hole.
        hole: usize,
        /// The outer hole.
        other: usize,
    },
    /// The triangles of a polygon do not fill it.
    #[error("the triangles of the polygon fill {found:e} instead of {expected:e} of its squared extent")]
    Triangulation {
        /// Area by the borders, relative to the squared extent of the outline.
        expected: f64,
        /// Area of the triangles, relative to the squared extent of the outline.
        found: f64,
    },
    /// A length or direction of a shape makes no sense.
    #[error("{quantity} is {value:e} m, but must be positive and finite")]
    Length {
        /// What is wrong.
        quantity: &'static str,
        /// Its value, m.
        value: f64,
    },
    /// A curved shape needs at least three segments.
    #[error("{segments} segments cannot go around a curved shape")]
    TooFewSegments {
        /// What was asked for.
        segments: usize,
    },
    /// More segments than a curved shape can use.
    #[error("{segments} segments around a curved shape are more than {limit}")]
    TooManySegments {
        /// What was asked for.
        segments: usize,
        /// Largest number of segments.
        limit: usize,
    },
    /// A number of pieces is zero.
    #[error("{quantity} is 0, but must be at least 1")]
    NoPieces {
        /// Which number.
        quantity: &'static str,
    },
    /// Parameters of lines do not run from 0 to 1.
    #[error("the {direction} lines must begin with 0, end with 1 and increase strictly")]
    BadLines {
        /// "u" or "v".
        direction: &'static str,
        /// Index of the first wrong parameter.
        index: usize,
    },
    /// Triangles cannot be cut differently in two directions.
    #[error("triangles need the same count along u and v, not {u} and {v}")]
    UnequalCounts {
        /// Pieces along u.
        u: usize,
        /// Pieces along v.
        v: usize,
    },
    /// Explicit lines on something that has no parameters.
    #[error("explicit lines cut quads only")]
    LinesOnTriangles,
    /// A cell to be left out does not exist.
    #[error("cell ({i}, {j}) to be left out is not one of the {u} × {v} cells")]
    NoSuchCell {
        /// Index along u.
        i: usize,
        /// Index along v.
        j: usize,
        /// Cells along u.
        u: usize,
        /// Cells along v.
        v: usize,
    },
    /// All cells are left out.
    #[error("every cell of the quad is left out")]
    NothingLeft,
    /// A face was added before any surface.
    #[error("a face was added before any surface")]
    NoSurface,
    /// An element cannot be split.
    #[error("element {element} is not a leaf of this mesh")]
    NotALeaf {
        /// Index of the element.
        element: usize,
    },
}

impl MeshError {
    /// What to do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        match self {
            Self::NoArea { .. } => "remove the face or separate its corners",
            Self::TooLarge { .. } => "subdivide less",
            Self::RepeatedCorner { .. } => "use a triangle, or move one of them",
            Self::BowTie | Self::SelfIntersecting { .. } => "list its corners in order around the border",
            Self::NotConvex { .. } => "use a polygon, or two quads",
            Self::TooFewCorners { .. } => "add corners or remove it",
            Self::NotPlanar { .. } => "move it, or use triangles",
            Self::Crossing { .. } => "keep them apart, or draw both as one border",
            Self::HoleOutside { .. } => "move it inside or remove it",
            Self::HoleInHole { .. } => "remove it, or make what it encloses a polygon of its own",
            Self::Triangulation { .. } => "remove corners that all but coincide",
            Self::TooFewSegments { .. } => "give at least 3",
            Self::TooManySegments { .. } => "give fewer, and cut the facets instead",
            Self::LinesOnTriangles => "give counts or a largest edge for triangles",
            Self::NothingLeft => "remove the quad instead",
            Self::NoSurface => "start a surface first",
            Self::NotALeaf { .. } => "split leaves only",
            Self::NotFinite { .. }
            | Self::Length { .. }
            | Self::NoPieces { .. }
            | Self::BadLines { .. }
            | Self::UnequalCounts { .. }
            | Self::NoSuchCell { .. } => "correct the value marked",
        }
    }
}

/// A border of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ring {
    /// The outer border.
    Outline,
    /// The border of a hole, by its index.
    Hole(usize),
}

impl Ring {
    /// Number 0 is the outline, the holes follow.
    pub(crate) fn numbered(number: usize) -> Self {
        number.checked_sub(1).map_or(Self::Outline, Self::Hole)
    }
}

impl std::fmt::Display for Ring {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Outline => f.write_str("the outline"),
            Self::Hole(hole) => write!(f, "hole {}", hole + 1),
        }
    }
}

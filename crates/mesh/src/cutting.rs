//! How a shape is cut into faces, and faces into elements.
//!
//! A quad cut M × N by lines, with k elements per side, has M N faces of k² elements each; a
//! triangle cut N times has N² faces of k² elements each.

use crate::MeshError;

/// Relative excess of an edge over the largest edge that is taken for rounding.
const ROUNDING: f64 = 1e-9;

/// Lines that cut a shape into faces, the pieces that results are reported on.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Lines {
    /// No lines: a quad, a triangle or a polygon is one face; a box, sphere, disc or cylinder has
    /// one face a facet.
    #[default]
    Whole,
    /// Equal spacing: u pieces along u times v pieces along v. Triangles need u = v and become u²
    /// triangles.
    Counts {
        /// Pieces along u.
        u: usize,
        /// Pieces along v.
        v: usize,
    },
    /// Parameters from 0 to 1, strictly increasing, both ends included. Quads and boxes only.
    Explicit {
        /// Parameters along u.
        u: Vec<f64>,
        /// Parameters along v.
        v: Vec<f64>,
    },
    /// As few pieces as keep every edge at most this long, m. The diagonal that halves a cell that
    /// is not flat does not count as an edge. The triangles of one shape are all cut alike.
    LargestEdge(f64),
}

/// How a shape is cut. The default leaves it whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Cutting {
    /// Lines that cut the shape into faces.
    pub lines: Lines,
    /// Every face (each of its triangles, where it has several) is split into this number squared
    /// of elements.
    pub elements_per_side: usize,
    /// Lit from the other side. This is the back of a two-sided surface, whose front blocks the
    /// view already.
    pub flipped: bool,
}

impl Default for Cutting {
    fn default() -> Self {
        Self { lines: Lines::Whole, elements_per_side: 1, flipped: false }
    }
}

/// Edge lengths that decide how often facets of one kind are cut, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// Triangles with this longest edge.
    Triangle { longest: f64 },
    /// Quads with these longest edges along u and v; those that are not flat have two triangles a
    /// cell.
    Quad { u: f64, v: f64, flat: bool },
}

impl Form {
    /// Flat pieces that each cell consists of.
    pub fn pieces(&self) -> u128 {
        if matches!(self, Self::Quad { flat: false, .. }) { 2 } else { 1 }
    }
}

/// Where the lines of one direction lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cuts<'a> {
    Even(usize),
    Given(&'a [f64]),
}

impl Cuts<'_> {
    pub fn pieces(&self) -> usize {
        match self {
            Self::Even(n) => *n,
            Self::Given(parameters) => parameters.len() - 1,
        }
    }

    /// Weights of the two ends at line `i`. Even lines give the same two numbers from either end,
    /// so that neighbours that run opposite ways meet in the same bits.
    pub fn weights(&self, i: usize) -> [f64; 2] {
        match self {
            Self::Even(n) => [(n - i) as f64 / *n as f64, i as f64 / *n as f64],
            Self::Given(parameters) => [1.0 - parameters[i], parameters[i]],
        }
    }
}

/// Lines of both directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid<'a> {
    pub u: Cuts<'a>,
    pub v: Cuts<'a>,
}

impl Grid<'_> {
    pub fn even(u: usize, v: usize) -> Self {
        Self { u: Cuts::Even(u), v: Cuts::Even(v) }
    }

    /// Number of cells, the same for a quad cut u × v and a triangle cut u = v times.
    pub fn cells(&self) -> u128 {
        self.u.pieces() as u128 * self.v.pieces() as u128
    }

    /// Cell (i along u, j along v) of a quad's face `index`.
    pub fn cell(&self, index: usize) -> [usize; 2] {
        [index / self.v.pieces(), index % self.v.pieces()]
    }

    /// Indices of all cells but the skipped ones, which are sorted.
    pub fn kept(self, skipped: &[[usize; 2]]) -> impl Iterator<Item = usize> {
        (0..self.cells() as usize).filter(move |&index| skipped.binary_search(&self.cell(index)).is_err())
    }
}

impl Lines {
    /// The lines on facets of a form.
    pub(crate) fn grid(&self, form: Form) -> Result<Grid<'_>, MeshError> {
        match (self, form) {
            (Self::Whole, _) => Ok(Grid::even(1, 1)),
            (Self::Counts { u, v }, _) => counts(*u, *v, form),
            (Self::Explicit { .. }, Form::Triangle { .. }) => Err(MeshError::LinesOnTriangles),
            (Self::Explicit { u, v }, Form::Quad { .. }) => Ok(Grid { u: given(u, "u")?, v: given(v, "v")? }),
            (Self::LargestEdge(edge), Form::Triangle { longest }) => {
                let n = pieces(longest, *edge)?;
                Ok(Grid::even(n, n))
            }
            (Self::LargestEdge(edge), Form::Quad { u, v, .. }) => {
                Ok(Grid::even(pieces(u, *edge)?, pieces(v, *edge)?))
            }
        }
    }
}

fn counts(u: usize, v: usize, form: Form) -> Result<Grid<'static>, MeshError> {
    if u == 0 || v == 0 {
        return Err(MeshError::NoPieces { quantity: "the count of lines" });
    }
    if matches!(form, Form::Triangle { .. }) && u != v {
        return Err(MeshError::UnequalCounts { u, v });
    }
    Ok(Grid::even(u, v))
}

fn given<'a>(parameters: &'a [f64], direction: &'static str) -> Result<Cuts<'a>, MeshError> {
    let wrong = |index| MeshError::BadLines { direction, index };
    let last = parameters.len().saturating_sub(1);
    if last == 0 || parameters[0] != 0.0 {
        return Err(wrong(0));
    }
    // Written so that NaN fails.
    if let Some(i) = (0..last).find(|&i| !(parameters[i] < parameters[i + 1] && parameters[i + 1] <= 1.0)) {
        return Err(wrong(i + 1));
    }
    if parameters[last] < 1.0 {
        return Err(wrong(last));
    }
    Ok(Cuts::Given(parameters))
}

fn pieces(length: f64, edge: f64) -> Result<usize, MeshError> {
    if !(edge > 0.0 && edge.is_finite()) {
        return Err(MeshError::Length { quantity: "the largest edge", value: edge });
    }
    let pieces = (length / edge * (1.0 - ROUNDING)).ceil().max(1.0);
    // Beyond 2⁵³ the count of pieces is no longer exact, and no mesh holds as many.
    if pieces > 2f64.powi(53) {
        return Err(MeshError::TooLarge { limit: crate::builder::MOST_ELEMENTS });
    }
    Ok(pieces as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT_SQUARE: Form = Form::Quad { u: 1.0, v: 1.0, flat: true };
    const TRIANGLE: Form = Form::Triangle { longest: 1.0 };

    #[test]
    fn largest_edge_is_met_with_the_fewest_pieces() {
        for (length, edge, expected) in [
            (1.0, 1.0, 1),
            (2.1, 0.3, 7),
            (2.7, 0.3, 9),
            (1.1, 0.5, 3),
            (0.3, 0.1, 3),
            (1.0, 3.0, 1),
            (1.0, 0.4999, 3),
        ] {
            assert_eq!(pieces(length, edge), Ok(expected), "{length} in pieces of {edge}");
        }
    }

    #[test]
    fn even_weights_are_the_same_bits_from_either_end() {
        for n in 1..50 {
            for i in 0..=n {
                let bits = |i| Cuts::Even(n).weights(i).map(f64::to_bits);
                let [a, b] = bits(i);
                assert_eq!([b, a], bits(n - i));
            }
        }
    }

    #[test]
    fn lines_that_make_no_sense_are_refused() {
        let bad =
            |u: &[f64]| Lines::Explicit { u: u.to_vec(), v: vec![0.0, 1.0] }.grid(UNIT_SQUARE).unwrap_err();
        let at = |index| MeshError::BadLines { direction: "u", index };
        assert_eq!(bad(&[]), at(0));
        assert_eq!(bad(&[0.0]), at(0));
        assert_eq!(bad(&[0.1, 1.0]), at(0));
        assert_eq!(bad(&[0.0, 0.5, 0.5, 1.0]), at(2));
        assert_eq!(bad(&[0.0, 0.7, 0.5, 1.0]), at(2));
        assert_eq!(bad(&[0.0, f64::NAN, 1.0]), at(1));
        assert_eq!(bad(&[0.0, 0.5, 1.5]), at(2));
        assert_eq!(bad(&[0.0, 0.5]), at(1));
        let explicit = Lines::Explicit { u: vec![0.0, 1.0], v: vec![0.0, 1.0] };
        assert_eq!(explicit.grid(TRIANGLE), Err(MeshError::LinesOnTriangles));
        assert_eq!(Lines::Counts { u: 2, v: 3 }.grid(TRIANGLE), Err(MeshError::UnequalCounts { u: 2, v: 3 }));
        for edge in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Lines::LargestEdge(edge).grid(UNIT_SQUARE), Err(MeshError::Length { .. })));
        }
        assert!(matches!(Lines::LargestEdge(1e-300).grid(UNIT_SQUARE), Err(MeshError::TooLarge { .. })));
    }
}

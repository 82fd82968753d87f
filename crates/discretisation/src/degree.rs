//! The degrees of the bases.

/// Degree of piecewise polynomials: P on triangles, Q on quads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Degree {
    /// P0 and Q0.
    Constant,
    /// P1 and Q1.
    Linear,
    /// P2 and Q2.
    Quadratic,
}

impl Degree {
    /// All of them, rising.
    pub const ALL: [Self; 3] = [Self::Constant, Self::Linear, Self::Quadratic];

    /// 0, 1 or 2.
    #[must_use]
    pub fn number(self) -> usize {
        self as usize
    }
}

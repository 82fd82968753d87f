//! The error that is stated for an exchange behind bodies: one formula, and the constants in it.
//!
//! The hidden part of an exchange is integrated over parts of the source
//! ([`pieces`](super::pieces)). Of each part the error e is estimated from s, the change from the
//! rule before; v, the range of the integrand h at the first points times the area (of a higher
//! rule on a part of one topology: the change before); m, the area times the largest value that h
//! could have; and r, the radius of the part over its distance from the nearest edge of a body:
//!
//! | | r ≤ 1 | r > 1 |
//! |---|---|---|
//! | all points of one topology | r √r √(a² s v + a′² v² + a″² s²) (`smooth`) | √r √((b m)² + (c s)²) (`smooth_near`) |
//! | topologies differ | d √(s v) (`broken`) | r √(e² s m + (f m)² + (g s)²) (`broken_near`) |
//!
//! To it comes what small shadows between the points may hide, t₀ t₁^(k−1) w m with k the number of
//! the rule and w the share of the width of the part behind a critical line (`between`). Errors of
//! parts are of either sign; of many, some are underestimated, and those are the ones that are not
//! improved. Each time a part is refined, the change of its integral shows what its error was. With
//! ρ the change over the error, and Σ a sum in which each earlier refinement weighs less by the
//! factor `memory`, n parts have together
//!
//! error = c √(1 + u Σ ρ²) (1 + w/(1 + Σ 1)) (1 + l ln n) √(Σ eₖ²)
//!
//! (`safety`, `surprise`, `unknown`, `many`): a part that was off by about its error or more raises
//! that of all, and before the first refinement nothing is known.
//!
//! The constants are fitted: as small as they can be with 99 % of true errors below the stated
//! ones. The program that measures that on random pairs, and fits them anew, is
//! `cargo run --release -p fredholm-coupling --example error_model`.

/// The constants of the formula above; dimensionless. The default is what was fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorModel {
    /// a, a′ and a″: shares of the changes on a smooth part.
    pub smooth: [f64; 3],
    /// b and c: of the largest value and of the change on a smooth part near an edge.
    pub smooth_near: [f64; 2],
    /// d: of the mean of change and range where topologies differ.
    pub broken: f64,
    /// e, f and g: the same near an edge.
    pub broken_near: [f64; 3],
    /// t₀ and t₁: share that small shadows between points may hide, and what each next rule leaves
    /// of it.
    pub between: [f64; 2],
    /// Share of the jump across an active line that counts where no point of the rule lies behind
    /// it.
    pub behind: f64,
    /// c.
    pub safety: f64,
    /// u.
    pub surprise: f64,
    /// w, where it is not known which lines are active, and where it is.
    pub unknown: [f64; 2],
    /// l.
    pub many: f64,
    /// What a refinement weighs after the next one.
    pub memory: f64,
    /// Largest ρ that counts.
    pub largest_surprise: f64,
}

impl ErrorModel {
    /// What was fitted.
    pub const FITTED: Self = Self {
        smooth: [0.11, 0.02, 0.32],
        smooth_near: [0.0106, 0.18],
        broken: 0.1,
        broken_near: [0.05, 0.008, 0.014],
        between: [1e-3, 0.22],
        behind: 1.3,
        safety: 0.495,
        surprise: 0.62,
        unknown: [5.0, 1.2],
        many: 0.17,
        memory: 0.95,
        largest_surprise: 6.2,
    };
}

impl Default for ErrorModel {
    fn default() -> Self {
        Self::FITTED
    }
}

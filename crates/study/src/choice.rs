//! Which way to an accuracy costs less: the matrix of the scene's elements, or links.
//!
//! The matrix has n(n + 1)/2 pairs. The links are about [`LINKS_A_FACE`] (1 %/ε)^[`LINKS_EXPONENT`]
//! a face at the accuracy ε, and one costs as much as [`PAIRS_A_LINK`] pairs, as measured on the
//! scenes of docs/notes/hierarchical.md. On fewer than 2 × 2 elements a face the matrix is seldom
//! exact enough, and links would have to follow; else the error that it states decides whether it
//! was enough.

use std::fmt;

use crate::options::Way;
use crate::sampled;

/// Links a face at 1 %, one for both ways.
const LINKS_A_FACE: f64 = 160.0;
/// Exponent of 1 %/ε.
const LINKS_EXPONENT: f64 = 0.8;
/// Pairs of the matrix that take the time of one link.
const PAIRS_A_LINK: f64 = 6.0;

/// Most links at 1 % over √(faces): cells of a wall, and small things far away, are linked as
/// wholes.
const MOST_LINKS_OVER_ROOT_FACES: f64 = 10_000.0;
/// Faces from which on random paths may take the place of links, and the least accuracy.
const MANY_FACES: usize = 8000;
const LEAST_ACCURACY: f64 = 0.01;
/// Paths that take the time of all links of a run, over the links of its first round: about ten
/// times as many come of them, and one takes about as long as five paths. Measured on cities and
/// curved objects (docs/notes/hierarchical.md).
const PATHS_A_LINK: f64 = 50.0;
/// Links of an element.
const OF_ELEMENT: f64 = 10.0;

/// Elements and links to expect at an accuracy, from which those of a scene may differ by a factor
/// of three.
pub(crate) fn expected(faces: usize, accuracy: f64) -> [usize; 2] {
    let n = faces as f64;
    let links = (LINKS_A_FACE * n).min(MOST_LINKS_OVER_ROOT_FACES * n.sqrt())
        * (0.01 / accuracy).powf(LINKS_EXPONENT);
    [faces.max((links / OF_ELEMENT) as usize), links as usize]
}

/// What is known of a scene before it is solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) elements: f64,
    pub(crate) faces: f64,
    /// Fewest elements of a face.
    pub(crate) fewest: usize,
}

/// What was predicted, and what it came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Choice {
    /// The matrix has fewer than 2 × 2 elements a face: links would follow in the end.
    Coarse,
    /// Links alone know a goal.
    Goal,
    /// The way that was asked for.
    Asked(Way),
    /// The links of the first round were so many that paths cost less.
    Paths { links: f64, paths: f64 },
    /// The matrix costs more: pairs and links.
    Links { pairs: f64, links: f64 },
    /// The matrix does not fit the memory.
    Memory,
    /// The matrix costs less.
    Matrix { pairs: f64, links: f64 },
    /// The matrix cost less, and stated this error or none.
    TooCoarse { stated: Option<f64> },
}

impl Choice {
    /// The cheaper way to an accuracy.
    pub(crate) fn new(extent: Extent, accuracy: f64) -> Self {
        let pairs = 0.5 * extent.elements * (extent.elements + 1.0);
        let links = LINKS_A_FACE * extent.faces * (0.01 / accuracy).powf(LINKS_EXPONENT);
        if pairs >= PAIRS_A_LINK * links {
            Self::Links { pairs, links }
        } else if extent.fewest < 4 {
            Self::Coarse
        } else {
            Self::Matrix { pairs, links }
        }
    }

    /// Elements from which on links cost less, whatever the faces.
    pub(crate) fn most_elements(accuracy: f64) -> f64 {
        2.0 * PAIRS_A_LINK * LINKS_A_FACE * (0.01 / accuracy).powf(LINKS_EXPONENT)
    }

    /// Random paths that answer a scene of so many faces, where they may: on fewer faces light that
    /// changes over a face would not be seen.
    pub(crate) fn paths(faces: usize, accuracy: f64) -> Option<f64> {
        let suit = faces >= MANY_FACES && accuracy >= LEAST_ACCURACY;
        suit.then(|| sampled::expected_paths(faces, accuracy))
    }

    /// Whether the links of a first round promise more work than these paths.
    pub(crate) fn too_many(links: f64, paths: f64) -> bool {
        paths < PATHS_A_LINK * links
    }

    /// Whether paths were asked for.
    pub(crate) fn is_paths(self) -> bool {
        self == Self::Asked(Way::Paths)
    }

    pub(crate) fn is_matrix(self) -> bool {
        matches!(self, Self::Matrix { .. })
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Coarse => f.write_str(
                "hierarchical, since a matrix of faces of fewer than 4 elements is seldom exact enough",
            ),
            Self::Goal => f.write_str("hierarchical, since elements are chosen for a goal"),
            Self::Asked(Way::Links) => f.write_str("hierarchical, as asked for"),
            Self::Asked(Way::Paths) => f.write_str("random paths, as asked for"),
            Self::Paths { links, paths } => write!(
                f,
                "random paths, since {links:.1e} links in the first round promised more work than about {paths:.1e} paths"
            ),
            Self::Links { pairs, links } => {
                write!(
                    f,
                    "hierarchical, since about {links:.1e} links cost less than {pairs:.1e} pairs of a matrix"
                )
            }
            Self::Memory => {
                f.write_str("hierarchical, since the matrix of the scene's elements does not fit the memory")
            }
            Self::Matrix { pairs, links } => {
                write!(
                    f,
                    "the matrix of the scene's elements, since {pairs:.1e} pairs cost less than about {links:.1e} links"
                )
            }
            Self::TooCoarse { stated: Some(stated) } => {
                write!(
                    f,
                    "hierarchical, since the matrix of the scene's elements was cheaper but left an error of {stated:.1e}"
                )
            }
            Self::TooCoarse { stated: None } => f.write_str(
                "hierarchical, since the matrix of the scene's elements was cheaper but stated no error",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(faces: f64, fewest: usize, accuracy: f64) -> Choice {
        Choice::new(Extent { elements: faces * fewest as f64, faces, fewest }, accuracy)
    }

    #[test]
    fn few_faces_take_the_matrix_and_many_take_links() {
        assert!(choice(96.0, 4, 0.01).is_matrix());
        assert!(matches!(choice(480.0, 9, 0.01), Choice::Links { .. }));
        assert!(
            matches!(choice(96.0, 4, 0.3), Choice::Links { .. }),
            "few links are enough for little accuracy"
        );
        assert_eq!(choice(96.0, 1, 0.01), Choice::Coarse);
    }

    #[test]
    fn paths_take_the_place_of_many_links_only() {
        // Cities of 13,000 and 40,000 faces at 5 %, with the links of their first rounds.
        for (faces, links) in [(13_000, 7.4e5), (40_000, 1.9e6)] {
            assert!(Choice::paths(faces, 0.05).is_some_and(|paths| Choice::too_many(links, paths)));
        }
        // A curved object of 100,000 triangles at 2 % has 1.6 million links in the end.
        assert!(Choice::paths(100_000, 0.02).is_some_and(|paths| !Choice::too_many(1.6e6, paths)));
        assert!(Choice::paths(3000, 0.05).is_none() && Choice::paths(13_000, 0.001).is_none());
    }

    #[test]
    fn above_the_most_elements_links_always_cost_less() {
        for accuracy in [0.1, 0.01, 0.001] {
            let most = Choice::most_elements(accuracy);
            let at = |elements: f64| Choice::new(Extent { elements, faces: elements, fewest: 1 }, accuracy);
            assert!(matches!(at(most), Choice::Links { .. }) && at(0.9 * most) == Choice::Coarse);
        }
    }
}

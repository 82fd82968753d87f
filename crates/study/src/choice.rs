//! Which way to an accuracy costs less: the matrix of the scene's elements, links, or rays.
//!
//! The matrix has n(n + 1)/2 pairs. The links are about [`LINKS_A_FACE`] (1 %/ε)^[`LINKS_EXPONENT`]
//! a face at the accuracy ε, and one costs as much as [`PAIRS_A_LINK`] pairs, as measured on the
//! scenes of docs/notes/hierarchical.md. On fewer than 2 × 2 elements a face the matrix is seldom
//! exact enough, and links would have to follow; else the error that it states decides whether it
//! was enough. What rays take does not depend on what stands between surfaces, but a link takes
//! [`RAYS_A_LINK`] and [`RAYS_AN_OBJECT`] for every object of the scene (docs/hierarchical.md).
//! Rays may take somewhat longer than links, since they are more exact on dim faces.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use fredholm_mesh::{Mesh, Patch, Topology};

use crate::options::Way;
use crate::rays;

/// Links a face at 1 %, one for both ways.
const LINKS_A_FACE: f64 = 160.0;
/// Exponent of 1 %/ε.
const LINKS_EXPONENT: f64 = 0.8;
/// Pairs of the matrix that take the time of one link.
const PAIRS_A_LINK: f64 = 6.0;

/// Most links at 1 % over √(faces): cells of a wall, and small things far away, are linked as
/// wholes.
const MOST_LINKS_OVER_ROOT_FACES: f64 = 10_000.0;
/// Rays that take the time of one link, and of what one object adds to it. Measured were 3 to 15
/// with two to five objects, 68 with eleven, 60 with 52 and 120 with 39; how much stands in the way
/// of a link is not known before.
const RAYS_A_LINK: f64 = 6.0;
const RAYS_AN_OBJECT: f64 = 3.0;
/// A curved object counts once for every so many directions that its pieces are turned to.
const DIRECTIONS_OF_AN_OBJECT: f64 = 32.0;
/// Steps in which the coordinates of unit normals are told apart.
const STEPS_OF_DIRECTIONS: f64 = 1e6;
/// What rays may take over what links take.
const RAYS_OVER_LINKS: f64 = 1.5;
/// Rays of about half a second: quicker links are not given up.
const FEW_RAYS: f64 = 6e5;
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
    /// Where rays may take the place of links: what they depend on.
    pub(crate) for_rays: Option<ForRays>,
}

/// What tells rays from links.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForRays {
    pub(crate) faces: rays::Faces,
    /// Things that may stand between elements: pieces that hang together, curved ones counted as
    /// several.
    pub(crate) objects: f64,
}

impl Extent {
    /// Of a mesh; `free` where rays may take the place of links.
    pub(crate) fn of(mesh: &Mesh, free: bool) -> Self {
        let count = mesh.faces().len();
        Self {
            elements: mesh.len() as f64,
            faces: count as f64,
            fewest: (0..count).map(|face| mesh.leaves_of_face(face).len()).min().unwrap_or(0),
            for_rays: free
                .then(|| ForRays { faces: rays::Faces::of(mesh), objects: objects(mesh.occluders()) }),
        }
    }
}

/// Objects that pieces form: those that hang together are one, and a curved one counts as several.
fn objects(pieces: &[Patch]) -> f64 {
    let topology = Topology::of(pieces);
    let mut directions: BTreeMap<u32, BTreeSet<[i32; 3]>> = BTreeMap::new();
    for (piece, component) in pieces.iter().zip(topology.component_of) {
        let direction = piece.normal().to_array().map(|x| (STEPS_OF_DIRECTIONS * x).round() as i32);
        directions.entry(component).or_default().insert(direction);
    }
    directions.values().map(|own| (own.len() as f64 / DIRECTIONS_OF_AN_OBJECT).max(1.0)).sum()
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
    /// Rays cost less than links, or little more.
    Rays { links: f64, rays: f64 },
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
        if let Some(ForRays { faces, objects }) = extent.for_rays {
            let rays = rays::expected(extent.elements, faces, accuracy);
            let time = links * (RAYS_A_LINK + RAYS_AN_OBJECT * objects);
            if time > FEW_RAYS && rays < RAYS_OVER_LINKS * time {
                return Self::Rays { links, rays };
            }
        }
        if pairs >= PAIRS_A_LINK * links {
            Self::Links { pairs, links }
        } else if extent.fewest < 4 {
            Self::Coarse
        } else {
            Self::Matrix { pairs, links }
        }
    }

    /// Whether rays were asked for.
    pub(crate) fn is_rays(self) -> bool {
        matches!(self, Self::Asked(Way::Rays) | Self::Rays { .. })
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
            Self::Asked(Way::Rays) => f.write_str("rays, as asked for"),
            Self::Rays { links, rays } => {
                write!(
                    f,
                    "rays, since about {rays:.1e} of them cost less than {links:.1e} links, or little more"
                )
            }
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
    use fredholm_mesh::{Cutting, MeshBuilder, Shape, Vec3};

    use super::*;

    fn choice(faces: f64, fewest: usize, accuracy: f64) -> Choice {
        let elements = faces * fewest as f64;
        let for_rays = Some(ForRays { faces: rays::Faces { alike: faces, large: faces }, objects: 3.0 });
        Choice::new(Extent { elements, faces, fewest, for_rays }, accuracy)
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
    fn things_are_counted_and_curved_ones_count_as_several() {
        let count = |shapes: &[Shape]| {
            let mut builder = MeshBuilder::default();
            for shape in shapes {
                builder.surface("s", 0);
                builder.add(shape, &Cutting::default()).unwrap();
            }
            objects(builder.build().occluders())
        };
        let cube = |at: f64, inward| Shape::Box { min: Vec3::splat(-at), max: Vec3::splat(at), inward };
        let ball = |segments| {
            let centre = Vec3::new(3.0, 0.0, 0.0);
            Shape::Sphere { centre, radius: 0.5, inward: false, segments }
        };
        assert!((count(&[cube(9.0, true)]) - 1.0).abs() < 1e-12);
        assert!((count(&[cube(9.0, true), cube(1.0, false)]) - 2.0).abs() < 1e-12);
        assert!(count(&[cube(9.0, true), ball(16)]) > 4.0);
    }

    #[test]
    fn rays_take_the_place_of_many_links_in_furnished_scenes() {
        let of = |faces: f64, objects: f64, accuracy: f64| {
            let known = ForRays { faces: rays::Faces { alike: faces, large: 500.0 }, objects };
            let extent = Extent { elements: faces, faces, fewest: 1, for_rays: Some(known) };
            Choice::new(extent, accuracy)
        };
        // Furnished rooms, and a city.
        for (faces, objects) in [(680.0, 11.0), (2200.0, 52.0), (2900.0, 39.0), (13_000.0, 3000.0)] {
            assert!(of(faces, objects, 0.05).is_rays() && of(faces, objects, 0.01).is_rays(), "{faces}");
        }
        // A box, and great accuracy.
        assert!(!of(600.0, 2.0, 0.01).is_rays() && !of(2900.0, 10.0, 0.0005).is_rays());
        let extent = Extent { elements: 2900.0, faces: 2900.0, fewest: 1, for_rays: None };
        assert!(!Choice::new(extent, 0.05).is_rays(), "links were asked for");
    }
}

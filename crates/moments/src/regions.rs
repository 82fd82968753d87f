//! Bodies that are nested in each other, coat each other or touch: which medium is on either side
//! of every triangle.
//!
//! Space is cut into regions of one medium each; region 0 is the free space around everything. What
//! is asked for are the two regions of every triangle. Closed bodies are oriented, so that a point
//! is inside where the solid angles of their triangles add up to the whole sphere,
//!
//! ```text
//! Σ Ω(triangle) = 4π inside, 0 outside
//! ```
//!
//! (A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125,
//! doi:10.1109/TBME.1983.325207), and of several bodies around a point the smallest says what is
//! there. Triangles of several bodies at one place are one; those between equal media, or inside of
//! conductors, bound nothing and are left out. All triangles that are joined by edges of two have
//! the same regions, so that one of them is looked at.

use crate::topology::{join, numbered};
use crate::{MomentsError, Surface, Topology};
use fredholm_mesh::{Bounds, Contacts, Patch, Vec3};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Distance from a triangle at which its sides are looked at, over the root of its area.
const STEP_ASIDE: f64 = 1e-5;
/// Relative difference of the volumes of shells that are the same.
const SAME_VOLUME: f64 = 1e-9;

/// What a triangle of a body bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Filling {
    /// A perfectly conducting sheet, which bounds nothing.
    Sheet,
    /// A perfect conductor behind it.
    Conductor,
    /// A dielectric of this number behind it.
    Dielectric(usize),
}

/// What is on the sides of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// The regions in front (on the side of the normal) and behind; none inside of a conductor,
    /// which is never in front.
    pub regions: [Option<usize>; 2],
    /// Whether the triangle itself is a conductor.
    pub conductor: bool,
}

/// A triangle of the bodies in the surface between the regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placed {
    /// The triangle of the surface.
    pub triangle: usize,
    /// Whether its normal is the other way.
    pub turned: bool,
}

/// The regions between bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    surface: Surface,
    faces: Vec<Face>,
    /// Numbers of the dielectrics; none for free space.
    media: Vec<Option<usize>>,
    placed: Vec<Option<Placed>>,
    shells: Vec<Shell>,
}

/// A closed oriented surface with one filling behind it.
#[derive(Clone, Debug, PartialEq)]
struct Shell {
    triangles: Vec<[Vec3; 3]>,
    bounds: Bounds,
    first: usize,
    filling: Filling,
    /// m³, negative where the filling is around it.
    volume: f64,
    /// The region inside; none in a conductor.
    inside: Option<usize>,
}

impl Regions {
    /// Finds the regions between bodies, whose normals point out of what fills them. Where bodies
    /// touch, their triangles are the same.
    ///
    /// # Errors
    /// [`MomentsError::Parameter`] for another number of fillings than of triangles,
    /// [`MomentsError::NotClosed`], [`MomentsError::Orientation`], [`MomentsError::InsideOut`] and
    /// [`MomentsError::Repeated`] for what is no body, [`MomentsError::Unmatched`] and
    /// [`MomentsError::Crossing`] for bodies that touch with different triangles, or cross.
    pub fn new(bodies: &Surface, fillings: &[Filling]) -> Result<Self, MomentsError> {
        if fillings.len() != bodies.triangles().len() {
            let (what, expected) = ("the number of fillings", "that of the triangles");
            return Err(MomentsError::Parameter { what, value: fillings.len() as f64, expected });
        }
        check_contacts(bodies)?;
        let mut shells = shells(bodies, fillings)?;
        let mut media = vec![None];
        for shell in &mut shells {
            // What is in a cavity is free space, unless another body fills it.
            let medium = match shell.filling {
                _ if shell.volume < 0.0 => None,
                Filling::Dielectric(number) => Some(number),
                Filling::Conductor | Filling::Sheet => continue,
            };
            shell.inside = Some(media.len());
            media.push(medium);
        }
        check_cavities(&shells)?;
        let merged = Merged::new(bodies, fillings)?;
        let faces = merged.faces(&shells);
        merged.keep(bodies, &faces, &media, shells)
    }

    /// The surface between the regions.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// What is on the sides of every triangle.
    #[must_use]
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// The number of the dielectric of every region; none for free space, as of region 0.
    #[must_use]
    pub fn media(&self) -> &[Option<usize>] {
        &self.media
    }

    /// Where every triangle of the bodies is in the surface; nowhere if it bounds nothing.
    #[must_use]
    pub fn placed(&self) -> &[Option<Placed>] {
        &self.placed
    }

    /// The region of a point (m); none inside of a conductor.
    #[must_use]
    pub fn at(&self, p: Vec3) -> Option<usize> {
        located(&self.shells, p)
    }
}

/// The region of a point: that of the smallest shell around it.
fn located(shells: &[Shell], p: Vec3) -> Option<usize> {
    let around = shells.iter().filter(|shell| shell.holds(p));
    let smallest = around.reduce(|best, shell| if shell.is_within(best) { shell } else { best });
    smallest.map_or(Some(0), |shell| shell.inside)
}

impl Shell {
    fn holds(&self, p: Vec3) -> bool {
        let inside = (self.bounds.min.cmple(p) & p.cmple(self.bounds.max)).all();
        inside && self.triangles.iter().map(|&corners| solid_angle(corners, p)).sum::<f64>().abs() > TAU
    }

    /// Whether it is the smaller of two shells around a point; of a cavity and the body that fills
    /// it that is the body.
    fn is_within(&self, other: &Self) -> bool {
        let (own, size) = (self.volume.abs(), other.volume.abs());
        if (own - size).abs() <= SAME_VOLUME * size { self.volume > 0.0 } else { own < size }
    }
}

/// The solid angle of a triangle, positive seen from behind.
fn solid_angle(corners: [Vec3; 3], p: Vec3) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - p);
    let [u, v, w] = [a, b, c].map(Vec3::length);
    let below = u * v * w + a.dot(b) * w + b.dot(c) * u + c.dot(a) * v;
    2.0 * a.dot(b.cross(c)).atan2(below)
}

/// Refuses bodies that cross, or touch with different triangles.
fn check_contacts(bodies: &Surface) -> Result<(), MomentsError> {
    let count = bodies.triangles().len();
    // Triangles of a surface have an area.
    let patches: Vec<Patch> = (0..count).filter_map(|t| Patch::triangle(bodies.corners(t)).ok()).collect();
    let contacts = Contacts::of(&patches);
    let sorted = |triangle: u32| {
        let mut corners = bodies.triangles()[triangle as usize];
        corners.sort_unstable();
        corners
    };
    let unmatched = contacts.overlaps.iter().find(|pair| sorted(pair.pieces[0]) != sorted(pair.pieces[1]));
    if let Some(pair) = unmatched {
        let [first, second] = pair.pieces.map(|piece| piece as usize);
        return Err(MomentsError::Unmatched { first, second });
    }
    match contacts.crossings.first() {
        Some(pair) => {
            let [first, second] = pair.map(|piece| piece as usize);
            Err(MomentsError::Crossing { first, second })
        }
        None => Ok(()),
    }
}

/// The closed parts of each filling.
fn shells(bodies: &Surface, fillings: &[Filling]) -> Result<Vec<Shell>, MomentsError> {
    let topology = Topology::new(bodies);
    let mut roots: Vec<usize> = (0..fillings.len()).collect();
    for (edge, meeting) in topology.edges().iter().enumerate() {
        let mut by_filling: BTreeMap<Filling, Vec<crate::Side>> = BTreeMap::new();
        for side in &meeting.sides {
            let filling = fillings[side.triangle as usize];
            if filling != Filling::Sheet {
                by_filling.entry(filling).or_default().push(*side);
            }
        }
        for sides in by_filling.into_values() {
            let triangles: Vec<usize> = sides.iter().map(|side| side.triangle as usize).collect();
            for &triangle in &triangles[1..] {
                join(&mut roots, triangles[0], triangle);
            }
            let forward = sides.iter().filter(|side| side.forward).count();
            if let [triangle] = triangles[..] {
                let equation = "the equation of dielectric bodies";
                return Err(MomentsError::NotClosed { equation, edge, triangle });
            }
            if 2 * forward != sides.len() {
                return Err(MomentsError::Orientation { first: triangles[0], second: triangles[1] });
            }
        }
    }
    let (component, count) = numbered(roots);
    let mut triangles: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (triangle, &component) in component.iter().enumerate() {
        if fillings[triangle] != Filling::Sheet {
            triangles[component].push(triangle);
        }
    }
    let of = |triangles: Vec<usize>| Shell::new(bodies, &triangles, fillings[triangles[0]]);
    Ok(triangles.into_iter().filter(|triangles| !triangles.is_empty()).map(of).collect())
}

impl Shell {
    fn new(bodies: &Surface, triangles: &[usize], filling: Filling) -> Self {
        let corners: Vec<[Vec3; 3]> = triangles.iter().flat_map(|&t| bodies.pieces(t)).collect();
        let origin = corners[0][0];
        let cone = |corners: &[Vec3; 3]| {
            let [a, b, c] = corners.map(|corner| corner - origin);
            a.dot(b.cross(c)) / 6.0
        };
        let volume = corners.iter().map(cone).sum();
        let low = corners.iter().flatten().copied().fold(origin, Vec3::min);
        let high = corners.iter().flatten().copied().fold(origin, Vec3::max);
        let bounds = Bounds { min: low, max: high };
        Self { triangles: corners, bounds, first: triangles[0], filling, volume, inside: None }
    }
}

/// Refuses cavities that are in nothing of what is around them: bodies inside out.
fn check_cavities(shells: &[Shell]) -> Result<(), MomentsError> {
    for (number, cavity) in shells.iter().enumerate().filter(|(_, shell)| shell.volume <= 0.0) {
        let corner = cavity.triangles[0][0];
        let around = |(other, shell): (usize, &Shell)| {
            other != number && shell.volume > 0.0 && shell.filling == cavity.filling && shell.holds(corner)
        };
        if !shells.iter().enumerate().any(around) {
            return Err(MomentsError::InsideOut { triangle: cavity.first });
        }
    }
    Ok(())
}

/// The triangles of all bodies, those at the same place as one.
struct Merged {
    /// The first triangle at every place.
    firsts: Vec<usize>,
    /// Whether one of them is a sheet.
    sheets: Vec<bool>,
    placed: Vec<Placed>,
    topology: Topology,
    surface: Surface,
}

impl Merged {
    fn new(bodies: &Surface, fillings: &[Filling]) -> Result<Self, MomentsError> {
        let mut names: BTreeMap<[u32; 3], usize> = BTreeMap::new();
        let (mut firsts, mut sheets, mut placed) = (Vec::new(), Vec::new(), Vec::new());
        // Sorted fillings with the way they face, of every place.
        let mut there: Vec<Vec<(Filling, bool, usize)>> = Vec::new();
        for (triangle, corners) in bodies.triangles().iter().enumerate() {
            let mut sorted = *corners;
            sorted.sort_unstable();
            let at = *names.entry(sorted).or_insert_with(|| {
                firsts.push(triangle);
                sheets.push(false);
                there.push(Vec::new());
                firsts.len() - 1
            });
            let turned = !is_rotated(bodies.triangles()[firsts[at]], *corners);
            let filling = fillings[triangle];
            let same = there[at]
                .iter()
                .find(|(other, way, _)| *other == filling && (*way == turned || filling == Filling::Sheet));
            if let Some(&(_, _, first)) = same {
                return Err(MomentsError::Repeated { first, second: triangle });
            }
            there[at].push((filling, turned, triangle));
            sheets[at] |= filling == Filling::Sheet;
            placed.push(Placed { triangle: at, turned });
        }
        let triangles = firsts.iter().map(|&triangle| bodies.triangles()[triangle]).collect();
        let surface = bodies.with_triangles(triangles)?;
        Ok(Self { firsts, sheets, placed, topology: Topology::new(&surface), surface })
    }

    /// The faces of all places.
    fn faces(&self, shells: &[Shell]) -> Vec<Face> {
        let neighbours = self.topology.neighbours();
        let mut regions: Vec<Option<[Option<usize>; 2]>> = vec![None; self.firsts.len()];
        for first in 0..regions.len() {
            if regions[first].is_some() {
                continue;
            }
            let mut waiting = vec![(first, self.looked_at(shells, first))];
            while let Some((triangle, sides)) = waiting.pop() {
                if regions[triangle].is_none() {
                    regions[triangle] = Some(sides);
                    let [front, back] = sides;
                    let next = |&(other, differ): &(usize, bool)| {
                        (other, if differ { [back, front] } else { sides })
                    };
                    waiting.extend(neighbours[triangle].iter().map(next));
                }
            }
        }
        let face = |(regions, &sheet): (Option<[Option<usize>; 2]>, &bool)| {
            let regions = regions.unwrap_or_default();
            Face { regions, conductor: sheet || regions.contains(&None) }
        };
        regions.into_iter().zip(&self.sheets).map(face).collect()
    }

    /// The regions of both sides of a triangle.
    fn looked_at(&self, shells: &[Shell], triangle: usize) -> [Option<usize>; 2] {
        // Shells are made of the same pieces.
        let pieces = self.surface.pieces(triangle);
        let [a, b, c] = pieces[pieces.len() / 2];
        let across = 0.5 * (b - a).cross(c - a);
        let step = across * (STEP_ASIDE / across.length().sqrt());
        let centre = (a + b + c) / 3.0;
        [centre + step, centre - step].map(|p| located(shells, p))
    }

    /// Leaves out what bounds nothing and what no field reaches, and turns conductors so that there
    /// is a region in front.
    fn keep(
        self,
        bodies: &Surface,
        faces: &[Face],
        media: &[Option<usize>],
        mut shells: Vec<Shell>,
    ) -> Result<Regions, MomentsError> {
        let reached = reached(faces, media.len());
        let is_reached = |side: &Option<usize>| side.is_some_and(|region| reached[region]);
        let bounds = |face: &Face| {
            let [front, back] = face.regions;
            (front != back || face.conductor) && face.regions.iter().any(is_reached)
        };
        let (mut triangles, mut kept, mut names) = (Vec::new(), Vec::new(), vec![None; faces.len()]);
        // Regions by their new numbers, in the order in which they were.
        let mut numbers = vec![None; media.len()];
        let mut left = Vec::new();
        for region in (0..media.len()).filter(|&region| reached[region]) {
            numbers[region] = Some(left.len());
            left.push(media[region]);
        }
        for (at, face) in faces.iter().enumerate().filter(|(_, face)| bounds(face)) {
            let [a, b, c] = bodies.triangles()[self.firsts[at]];
            let mut regions = face.regions.map(|side| side.and_then(|region| numbers[region]));
            let turned = regions[0].is_none();
            if turned {
                regions.reverse();
            }
            names[at] = Some((triangles.len(), turned));
            triangles.push(if turned { [a, c, b] } else { [a, b, c] });
            kept.push(Face { regions, ..*face });
        }
        for shell in &mut shells {
            shell.inside = shell.inside.and_then(|region| numbers[region]);
        }
        let placed = |place: &Placed| {
            names[place.triangle].map(|(triangle, turned)| Placed { triangle, turned: place.turned ^ turned })
        };
        let placed = self.placed.iter().map(placed).collect();
        let surface = bodies.with_triangles(triangles)?;
        Ok(Regions { surface, faces: kept, media: left, placed, shells })
    }
}

/// Which regions are reached by fields from region 0, through what is no conductor.
fn reached(faces: &[Face], regions: usize) -> Vec<bool> {
    let mut roots: Vec<usize> = (0..regions).collect();
    for face in faces.iter().filter(|face| !face.conductor) {
        if let [Some(front), Some(back)] = face.regions {
            join(&mut roots, front, back);
        }
    }
    let (component, _) = numbered(roots);
    // The first component is that of region 0.
    component.into_iter().map(|component| component == 0).collect()
}

/// Whether the same three corners are in the same order, wherever it begins.
fn is_rotated(corners: [u32; 3], others: [u32; 3]) -> bool {
    (0..3).any(|first| [0, 1, 2].map(|i| others[(first + i) % 3]) == corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::{Grading, cuboid};

    /// A cube around the origin, perhaps with its normals inwards.
    fn cube(side: f64, inward: bool) -> Surface {
        let cube = cuboid(Vec3::splat(side), 0.5 * side, Grading::default()).unwrap();
        let turn = |&[a, b, c]: &[u32; 3]| if inward { [a, c, b] } else { [a, b, c] };
        Surface::new(cube.vertices().to_vec(), cube.triangles().iter().map(turn).collect()).unwrap()
    }

    fn regions(cubes: &[(f64, bool, Filling)]) -> Result<Regions, MomentsError> {
        let mut all: Option<Surface> = None;
        let mut fillings = Vec::new();
        for &(side, inward, filling) in cubes {
            let cube = cube(side, inward);
            fillings.extend(vec![filling; cube.triangles().len()]);
            all = Some(all.map_or(Ok(cube.clone()), |all| all.with(&cube)).unwrap());
        }
        Regions::new(&all.unwrap().welded(1e-9).unwrap(), &fillings)
    }

    #[test]
    fn the_smallest_body_around_a_point_says_what_is_there() {
        let (a, b) = (Filling::Dielectric(0), Filling::Dielectric(1));
        let onion = regions(&[(3.0, false, a), (2.0, false, b), (1.0, false, a)]).unwrap();
        assert_eq!(onion.media(), [None, Some(0), Some(1), Some(0)]);
        for (x, region) in [(0.4, 3), (0.6, 2), (1.2, 1), (1.6, 0)] {
            assert_eq!(onion.at(Vec3::new(x, 0.1, 0.2)), Some(region), "{x}");
        }
        let outer = onion.faces().iter().filter(|face| face.regions == [Some(0), Some(1)]).count();
        assert_eq!(outer, cube(3.0, false).triangles().len());
    }

    #[test]
    fn cavities_are_empty_unless_they_are_filled() {
        let (a, b) = (Filling::Dielectric(0), Filling::Dielectric(1));
        let hollow = regions(&[(3.0, false, a), (2.0, true, a)]).unwrap();
        assert_eq!((hollow.media(), hollow.at(Vec3::ZERO)), (&[None, Some(0), None][..], Some(2)));
        // A cavity that a body fills is no region, and its walls are those of the body.
        let filled = regions(&[(3.0, false, a), (2.0, true, a), (2.0, false, b)]).unwrap();
        let nested = regions(&[(3.0, false, a), (2.0, false, b)]).unwrap();
        assert_eq!(filled.surface().triangles().len(), nested.surface().triangles().len());
        let medium = |regions: &Regions| regions.at(Vec3::ZERO).and_then(|region| regions.media()[region]);
        assert_eq!((medium(&filled), medium(&nested)), (Some(1), Some(1)));
        assert!(matches!(regions(&[(2.0, true, a)]), Err(MomentsError::InsideOut { triangle: 0 })));
    }

    #[test]
    fn what_no_field_reaches_is_left_out() {
        let metal = Filling::Conductor;
        let shell = regions(&[(3.0, false, metal), (2.0, true, metal), (1.0, false, Filling::Dielectric(0))]);
        let shell = shell.unwrap();
        assert_eq!((shell.media(), shell.at(Vec3::ZERO)), (&[None][..], None));
        let outer = cube(3.0, false).triangles().len();
        assert_eq!(shell.surface().triangles().len(), outer);
        assert_eq!(shell.placed().iter().flatten().count(), outer);
        assert!(shell.faces().iter().all(|face| face.conductor && face.regions == [Some(0), None]));
        // A conductor on the other side of its triangles is turned over.
        let wall = regions(&[(3.0, false, Filling::Dielectric(0)), (2.0, false, metal)]).unwrap();
        let inner = |face: &&Face| face.regions == [Some(1), None];
        assert!(wall.faces().iter().filter(inner).count() > 0);
    }
}

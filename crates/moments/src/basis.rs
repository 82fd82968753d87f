//! Rao–Wilton–Glisson functions: div-conforming currents on pairs of triangles.
//!
//! S. M. Rao, D. R. Wilton, A. W. Glisson, Electromagnetic scattering by surfaces of arbitrary
//! shape, IEEE Trans. Antennas Propag. 30 (1982) 409, doi:10.1109/TAP.1982.1142818. For an edge of
//! length l between triangles T₊ and T₋ with areas A± and opposite corners v±,
//!
//! ```text
//! f(r) = ±l/(2A±) (r − v±) on T±,   div f = ±l/A±
//! ```
//!
//! Here every function is divided by its norm ‖f‖ = √∫|f|² dA, so that ∫|f|² dA = 1 and the entries
//! of the equations are of order one on any mesh. Functions are in 1/m, coefficients of an electric
//! current in A. An edge where n > 2 triangles meet has n − 1 functions, each between the first of
//! them and another, so that the sum of the currents into it is 0.
//!
//! Between several regions ([`Regions`]) every side of a triangle has a current of its own, n × H
//! with n into the region. Through a wedge of one region between two triangles the component of H
//! along the edge is the same, so that what flows away from the edge on one of them comes to it on
//! the other: a function for every wedge. The component is the same on both sides of a triangle,
//! too, unless that is a conductor, so that the wedges between two conductors have one coefficient,
//! and all wedges where there is no conductor. The same holds for E and the magnetic current; at
//! conductors it is 0. (P. Ylä-Oijala, M. Taskinen, J. Sarvas, Surface integral equation method for
//! general composite metallic and dielectric structures with junctions, Progress In
//! Electromagnetics Research 52 (2005) 81, doi:10.2528/PIER04071301.)

use crate::regions::{Face, Regions};
use crate::{MomentsError, Side, Surface, Topology};
use fredholm_mesh::Vec3;
use fredholm_waves::Ground;
use std::f64::consts::TAU;

/// Half a function: on its triangle f = weight/(2A) (r − v), with v the corner. The weight is
/// ±l/‖f‖.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Half {
    /// The triangle.
    pub triangle: u32,
    /// The corner v: 0, 1 or 2.
    pub corner: u8,
    /// ±l/‖f‖, dimensionless.
    pub weight: f64,
    /// The region that the current radiates into; 0 where there is one only.
    pub region: usize,
}

/// A Rao–Wilton–Glisson function of unit norm. In every region its current flows through pairs of
/// halves, from one to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Its edge in the topology.
    pub edge: usize,
    /// The halves, two for every wedge.
    pub halves: Vec<Half>,
    /// Whether a magnetic current can flow there between regions: there is no conductor.
    pub magnetic: bool,
}

/// The functions of a surface, neighbours near each other in their order.
#[derive(Clone, Debug)]
pub struct Basis {
    surface: Surface,
    topology: Topology,
    functions: Vec<Function>,
    /// Place of every triangle in an order in which neighbours are near each other.
    ranks: Vec<u32>,
    ground: Option<Ground>,
    /// None where there is one region only.
    regions: Option<Regions>,
}

impl Basis {
    /// One function for every inner edge of a surface in free space.
    ///
    /// # Errors
    /// Those of [`Topology::check`].
    pub fn new(surface: Surface) -> Result<Self, MomentsError> {
        let topology = Topology::new(&surface);
        topology.check(&surface)?;
        let mut functions: Vec<Function> = Vec::new();
        for (edge, meeting) in topology.edges().iter().enumerate() {
            let ends = meeting.vertices.map(|vertex| surface.vertices()[vertex as usize]);
            let length = ends[0].distance(ends[1]);
            for second in meeting.sides.iter().skip(1) {
                let sides = [meeting.sides[0], *second];
                let triangles = sides.map(|side| (side.triangle, side.corner));
                let weight = length / norm(&surface, length, &triangles);
                let half = |at: usize, sign: f64| Half {
                    triangle: sides[at].triangle,
                    corner: sides[at].corner,
                    weight: sign * weight,
                    region: 0,
                };
                let halves = vec![half(0, 1.0), half(1, -1.0)];
                functions.push(Function { edge, halves, magnetic: false });
            }
        }
        Ok(Self::ordered(surface, topology, functions, None))
    }

    /// The functions of the currents between regions.
    ///
    /// # Errors
    /// [`MomentsError::NoInnerEdge`], and [`MomentsError::Regions`] for regions that do not fit each
    /// other.
    pub fn between(regions: Regions) -> Result<Self, MomentsError> {
        let surface = regions.surface().clone();
        let topology = Topology::new(&surface);
        let mut functions = Vec::new();
        for edge in 0..topology.edges().len() {
            functions.extend(around(&surface, &topology, regions.faces(), edge)?);
        }
        if functions.is_empty() {
            return Err(MomentsError::NoInnerEdge);
        }
        Ok(Self::ordered(surface, topology, functions, Some(regions)))
    }

    fn ordered(
        surface: Surface,
        topology: Topology,
        functions: Vec<Function>,
        regions: Option<Regions>,
    ) -> Self {
        let middle = |function: &Function| {
            let ends = topology.edges()[function.edge].vertices;
            0.5 * (surface.vertices()[ends[0] as usize] + surface.vertices()[ends[1] as usize])
        };
        let order = along_curve(&functions.iter().map(middle).collect::<Vec<_>>());
        let mut waiting: Vec<Option<Function>> = functions.into_iter().map(Some).collect();
        let functions = order.into_iter().filter_map(|at| waiting[at].take()).collect();
        Self { regions, ..Self::with(surface, topology, functions, None) }
    }

    /// Functions in the order in which they are given.
    pub(crate) fn with(
        surface: Surface,
        topology: Topology,
        functions: Vec<Function>,
        ground: Option<Ground>,
    ) -> Self {
        let centres: Vec<Vec3> = (0..surface.triangles().len()).map(|t| surface.centre(t)).collect();
        let mut ranks = vec![0; centres.len()];
        for (rank, triangle) in along_curve(&centres).into_iter().enumerate() {
            ranks[triangle] = rank as u32;
        }
        Self { surface, topology, functions, ranks, ground, regions: None }
    }

    /// The same above a ground plane: all equations and fields then have the images of the currents
    /// in. The sources are to be those above the plane ([`Grounded`](fredholm_waves::Grounded)).
    ///
    /// # Errors
    /// [`MomentsError::BelowGround`] for a triangle that touches the plane, or is below it.
    pub fn above(self, ground: Ground) -> Result<Self, MomentsError> {
        let low = |triangle: &usize| {
            self.surface.corners(*triangle).iter().any(|corner| corner.z <= ground.height())
        };
        match (0..self.surface.triangles().len()).find(low) {
            Some(index) => Err(MomentsError::BelowGround { what: "triangle", index }),
            None => Ok(Self { ground: Some(ground), ..self }),
        }
    }

    /// The ground plane under the surface.
    #[must_use]
    pub fn ground(&self) -> Option<Ground> {
        self.ground
    }

    /// The regions that the surface is between; none where it is in free space.
    #[must_use]
    pub fn regions(&self) -> Option<&Regions> {
        self.regions.as_ref()
    }

    /// What is on the sides of every triangle; nothing where there is one region only.
    pub(crate) fn faces(&self) -> &[Face] {
        self.regions.as_ref().map_or(&[], Regions::faces)
    }

    /// The surface.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Its edges.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The functions.
    #[must_use]
    pub fn functions(&self) -> &[Function] {
        &self.functions
    }

    /// Number of functions.
    #[must_use]
    pub fn len(&self) -> usize {
        self.functions.len()
    }

    /// Whether there is none; that is never so.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.functions.is_empty()
    }

    /// Middle of the edge of a function, m.
    ///
    /// # Panics
    /// Like a slice, where there is no such function.
    #[must_use]
    pub fn centre(&self, function: usize) -> Vec3 {
        let ends = self.topology.edges()[self.functions[function].edge].vertices;
        0.5 * (self.surface.vertices()[ends[0] as usize] + self.surface.vertices()[ends[1] as usize])
    }

    /// Place of a triangle in an order in which neighbours are near each other.
    pub(crate) fn rank(&self, triangle: u32) -> u32 {
        self.ranks[triangle as usize]
    }
}

/// ∫ f_a·f_b dA over one triangle, for its corners `a` and `b` and weights 1.
pub(crate) fn gram(surface: &Surface, triangle: u32, [a, b]: [usize; 2]) -> f64 {
    let triangle = triangle as usize;
    let centre = surface.centre(triangle);
    let corners = surface.corners(triangle).map(|corner| corner - centre);
    let spread: f64 = corners.iter().map(|corner| corner.length_squared()).sum();
    (spread / 12.0 + corners[a].dot(corners[b])) / (4.0 * surface.area(triangle))
}

/// A triangle at an edge: the regions ahead of it and behind it on the way around the edge.
struct Wedge {
    side: Side,
    ahead: Option<usize>,
    behind: Option<usize>,
    conductor: bool,
}

/// The functions of an edge: one for all wedges between two conductors, or one for all.
fn around(
    surface: &Surface,
    topology: &Topology,
    faces: &[Face],
    edge: usize,
) -> Result<Vec<Function>, MomentsError> {
    let meeting = &topology.edges()[edge];
    let [from, to] = meeting.vertices.map(|vertex| surface.vertices()[vertex as usize]);
    let length = from.distance(to);
    let along = (to - from) / length;
    let wedge = |side: &Side| {
        let face = faces[side.triangle as usize];
        // The normal of a triangle that runs along the edge is the way around it.
        let [front, back] = face.regions;
        let (ahead, behind) = if side.forward { (front, back) } else { (back, front) };
        Wedge { side: *side, ahead, behind, conductor: face.conductor }
    };
    let mut wedges: Vec<Wedge> = meeting.sides.iter().map(wedge).collect();
    let out = |wedge: &Wedge| {
        let corner = surface.corners(wedge.side.triangle as usize)[usize::from(wedge.side.corner)];
        corner - from - along * (corner - from).dot(along)
    };
    let (x, y) = (out(&wedges[0]).normalize(), along.cross(out(&wedges[0]).normalize()));
    let angle = |wedge: &Wedge| {
        let d = out(wedge);
        d.dot(y).atan2(d.dot(x)).rem_euclid(TAU)
    };
    // The first is at angle 0, whatever rounding says.
    wedges[1..].sort_by(|a, b| angle(a).total_cmp(&angle(b)).then(a.side.triangle.cmp(&b.side.triangle)));
    let count = wedges.len();
    let next = |at: usize| &wedges[(at + 1) % count];
    if (0..count).any(|at| wedges[at].ahead != next(at).behind) {
        return Err(MomentsError::Regions { edge });
    }
    // From a conductor on, so that no run of wedges goes through the first.
    let first = wedges.iter().position(|wedge| wedge.conductor);
    let magnetic = first.is_none();
    let mut runs: Vec<Vec<usize>> = Vec::new();
    for at in (0..count).map(|i| (first.unwrap_or(0) + i) % count) {
        if wedges[at].conductor || runs.is_empty() {
            runs.push(Vec::new());
        }
        if let Some(run) = runs.last_mut() {
            run.push(at);
        }
    }
    // Inside of a conductor there is no current.
    runs.retain(|run| wedges[run[0]].ahead.is_some());
    // All around in one region the currents of all wedges but one are that of the last.
    if !magnetic && wedges.iter().all(|wedge| wedge.ahead == wedges[0].ahead) {
        runs.pop();
    }
    let function = |run: Vec<usize>| {
        let mut triangles: Vec<(u32, u8)> = run
            .iter()
            .flat_map(|&at| [&wedges[at], next(at)])
            .map(|wedge| (wedge.side.triangle, wedge.side.corner))
            .collect();
        triangles.sort_unstable();
        triangles.dedup();
        let weight = length / norm(surface, length, &triangles);
        let half = |wedge: &Wedge, region: Option<usize>, sign: f64| Half {
            triangle: wedge.side.triangle,
            corner: wedge.side.corner,
            weight: sign * weight,
            region: region.unwrap_or_default(),
        };
        let pair = |&at: &usize| {
            let region = wedges[at].ahead;
            [half(&wedges[at], region, -1.0), half(next(at), region, 1.0)]
        };
        Function { edge, halves: run.iter().flat_map(pair).collect(), magnetic }
    };
    Ok(runs.into_iter().map(function).collect())
}

/// ‖f‖ over some triangles, for the weight l.
fn norm(surface: &Surface, length: f64, triangles: &[(u32, u8)]) -> f64 {
    let square = |&(triangle, corner): &(u32, u8)| length * length * share(surface, triangle, corner);
    triangles.iter().map(square).sum::<f64>().sqrt()
}

/// ∫ |r − v|² dA/(2A)² over a triangle.
fn share(surface: &Surface, triangle: u32, corner: u8) -> f64 {
    let corners = surface.corners(triangle as usize);
    let [v, a, b] = [0, 1, 2].map(|i| corners[(usize::from(corner) + i) % 3]);
    let (a, b) = (a - v, b - v);
    (a.length_squared() + b.length_squared() + a.dot(b)) / (24.0 * surface.area(triangle as usize))
}

/// The order of points along a curve that fills their box (G. M. Morton 1966): the bits of the
/// coordinates interleaved.
pub(crate) fn along_curve(points: &[Vec3]) -> Vec<usize> {
    let low = points.iter().copied().reduce(Vec3::min).unwrap_or_default();
    let high = points.iter().copied().reduce(Vec3::max).unwrap_or_default();
    let scale = f64::from(1 << 20) / (high - low).max_element().max(f64::MIN_POSITIVE);
    let code = |&point: &Vec3| {
        let cell = ((point - low) * scale).to_array().map(|c| c as u64);
        (0..21).fold(0_u64, |code, bit| {
            (0..3).fold(code, |code, axis| code | ((cell[axis] >> bit & 1) << (3 * bit + axis)))
        })
    };
    let codes: Vec<u64> = points.iter().map(code).collect();
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(|&at| (codes[at], at));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_quadrature::symmetric_triangle;

    /// A square of four triangles around a point off its middle, and a fin on one diagonal.
    fn basis() -> Basis {
        let vertices = vec![
            Vec3::ZERO,
            Vec3::X,
            Vec3::new(1.0, 1.0, 0.2),
            Vec3::Y,
            Vec3::new(0.4, 0.5, 0.1),
            Vec3::new(0.3, 0.3, 1.0),
        ];
        let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 4, 5]];
        Basis::new(Surface::new(vertices, triangles).unwrap()).unwrap()
    }

    /// f of a half at a point of its triangle.
    fn value(basis: &Basis, half: &Half, p: Vec3) -> Vec3 {
        let triangle = half.triangle as usize;
        let v = basis.surface().corners(triangle)[usize::from(half.corner)];
        (p - v) * (half.weight / (2.0 * basis.surface().area(triangle)))
    }

    #[test]
    fn a_junction_of_three_triangles_has_two_functions() {
        let basis = basis();
        assert_eq!(basis.len(), 5);
        let counts: Vec<usize> = basis.topology().edges().iter().map(|edge| edge.sides.len()).collect();
        assert_eq!((counts.iter().filter(|&&n| n == 3).count(), basis.is_empty()), (1, false));
    }

    #[test]
    fn the_current_across_the_edge_is_continuous_and_along_the_others_only() {
        let basis = basis();
        for function in basis.functions() {
            let ends = basis.topology().edges()[function.edge].vertices;
            let ends = ends.map(|vertex| basis.surface().vertices()[vertex as usize]);
            let along = (ends[1] - ends[0]).normalize();
            let flux: Vec<f64> = function
                .halves
                .iter()
                .map(|half| {
                    let triangle = half.triangle as usize;
                    let out = basis.surface().centre(triangle) - ends[0];
                    let out = (out - along * out.dot(along)).normalize();
                    let p = ends[0].lerp(ends[1], 0.3);
                    value(&basis, half, p).dot(-out)
                })
                .collect();
            assert!((flux[0] + flux[1]).abs() < 1e-14 && flux[0] > 0.0, "{flux:?}");
        }
    }

    #[test]
    fn functions_have_unit_norm_and_the_closed_products_are_those_of_a_rule() {
        let basis = basis();
        let rule = symmetric_triangle(2).unwrap();
        for function in basis.functions() {
            let mut norm = 0.0;
            for half in &function.halves {
                let triangle = half.triangle as usize;
                let [a, b, c] = basis.surface().corners(triangle);
                let area = basis.surface().area(triangle);
                for other in 0..3 {
                    let other = Half { corner: other, weight: 1.0, ..*half };
                    let product = |p: Vec3| value(&basis, half, p).dot(value(&basis, &other, p));
                    let sum: f64 = rule
                        .iter()
                        .map(|x| 2.0 * area * x.weight * product(a + x.u * (b - a) + x.v * (c - a)))
                        .sum();
                    let closed = half.weight
                        * gram(basis.surface(), half.triangle, [half.corner.into(), other.corner.into()]);
                    assert!((sum - closed).abs() < 1e-14 * half.weight.abs());
                    if other.corner == half.corner {
                        norm += half.weight * closed;
                    }
                }
            }
            assert!((norm - 1.0).abs() < 1e-14);
        }
    }
}

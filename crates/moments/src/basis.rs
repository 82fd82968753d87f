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
//! Of the first full order ([`Order::First`]) every edge has a second function, whose current
//! changes along the edge, and every triangle two that stay inside of it (`element` has the
//! formulas). They may be on curved triangles.
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

use crate::kernel::WIDTH;
use crate::regions::{Face, Regions};
use crate::{MomentsError, Side, Surface, Topology};
use fredholm_mesh::Vec3;
use fredholm_waves::Ground;
use std::f64::consts::TAU;

/// Which functions there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// Those of Rao, Wilton and Glisson, with even charges: order 0.
    #[default]
    Lowest,
    /// Those with all linear currents and linear charges (Graglia, Wilton and Peterson): order 1.
    First,
}

impl Order {
    /// The longest edge that a wave can be told from its alias on, in wavelengths, and in words.
    pub(crate) fn longest_edge(self) -> (f64, &'static str) {
        match self {
            Self::Lowest => (1.0 / 3.0, "a third"),
            Self::First => (0.5, "half"),
        }
    }
}

/// Half a function: weight/√g F on its triangle, with one of the F of the triangle. The first three
/// are F = r − v with v the corner of this number where the triangle is flat, and √g is twice its
/// area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Half {
    /// The triangle.
    pub triangle: u32,
    /// The number of F: 0 to 2 of the side opposite to this corner, 3 to 5 of the same sides but
    /// odd along them, 6 and 7 of the inside.
    pub number: u8,
    /// ± 1 over the norm of the whole function.
    pub weight: f64,
    /// The region that the current radiates into; 0 where there is one only.
    pub region: usize,
}

/// Where a function is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Around an edge of the topology.
    Edge(usize),
    /// On one triangle.
    Triangle(usize),
}

/// A function of unit norm. In every region its current flows through pairs of halves, from one to
/// the next, or stays on one triangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Where it is.
    pub place: Place,
    /// The halves, two for every wedge, or one for every side of a triangle.
    pub halves: Vec<Half>,
    /// Whether a magnetic current can flow there between regions: there is no conductor.
    pub magnetic: bool,
}

/// The functions of a surface, neighbours near each other in their order.
#[derive(Clone, Debug)]
pub struct Basis {
    surface: Surface,
    topology: Topology,
    order: Order,
    functions: Vec<Function>,
    /// Place of every triangle in an order in which neighbours are near each other.
    ranks: Vec<u32>,
    ground: Option<Ground>,
    /// None where there is one region only.
    regions: Option<Regions>,
}

impl Basis {
    /// One function for every inner edge of a surface in free space: those of the lowest order.
    ///
    /// # Errors
    /// Those of [`Basis::of_order`].
    pub fn new(surface: Surface) -> Result<Self, MomentsError> {
        Self::of_order(surface, Order::Lowest)
    }

    /// The functions of a surface in free space.
    ///
    /// # Errors
    /// Those of [`Topology::check`], [`MomentsError::Curved`] for curved triangles with functions
    /// of the lowest order.
    pub fn of_order(surface: Surface, order: Order) -> Result<Self, MomentsError> {
        let topology = Topology::new(&surface);
        topology.check(&surface)?;
        let mut functions: Vec<Function> = Vec::new();
        for (edge, meeting) in topology.edges().iter().enumerate() {
            for second in meeting.sides.iter().skip(1) {
                let half = |side: Side, weight: f64| Half {
                    triangle: side.triangle,
                    number: side.corner,
                    weight,
                    region: 0,
                };
                let halves = vec![half(meeting.sides[0], 1.0), half(*second, -1.0)];
                functions.push(Function { place: Place::Edge(edge), halves, magnetic: false });
            }
        }
        Self::ordered(surface, topology, order, functions, None)
    }

    /// The functions of the lowest order of the currents between regions.
    ///
    /// # Errors
    /// Those of [`Basis::between_of_order`].
    pub fn between(regions: Regions) -> Result<Self, MomentsError> {
        Self::between_of_order(regions, Order::Lowest)
    }

    /// The functions of the currents between regions.
    ///
    /// # Errors
    /// [`MomentsError::NoInnerEdge`], [`MomentsError::Curved`], and [`MomentsError::Regions`] for
    /// regions that do not fit each other.
    pub fn between_of_order(regions: Regions, order: Order) -> Result<Self, MomentsError> {
        let surface = regions.surface().clone();
        let topology = Topology::new(&surface);
        let mut functions = Vec::new();
        for edge in 0..topology.edges().len() {
            functions.extend(around(&surface, &topology, regions.faces(), edge)?);
        }
        if functions.is_empty() {
            return Err(MomentsError::NoInnerEdge);
        }
        Self::ordered(surface, topology, order, functions, Some(regions))
    }

    /// From the functions of the lowest order, with the signs of their halves for weights.
    fn ordered(
        surface: Surface,
        topology: Topology,
        order: Order,
        mut functions: Vec<Function>,
        regions: Option<Regions>,
    ) -> Result<Self, MomentsError> {
        if order == Order::Lowest && surface.is_curved() {
            return Err(MomentsError::Curved);
        }
        if order == Order::First {
            let odd: Vec<Function> = functions.iter().map(|even| along(&surface, &topology, even)).collect();
            functions.extend(odd);
            let faces = regions.as_ref().map_or(&[][..], Regions::faces);
            functions.extend((0..surface.triangles().len()).flat_map(|t| inside(t, faces.get(t))));
        }
        let norms: Vec<[f64; WIDTH]> = (0..surface.triangles().len())
            .map(|t| {
                let products = surface.element(t).products();
                std::array::from_fn(|i| products[i][i])
            })
            .collect();
        for function in &mut functions {
            normalise(function, &norms);
        }
        let middle = |function: &Function| middle(&surface, &topology, function.place);
        let order_of = along_curve(&functions.iter().map(middle).collect::<Vec<_>>());
        let mut waiting: Vec<Option<Function>> = functions.into_iter().map(Some).collect();
        let functions = order_of.into_iter().filter_map(|at| waiting[at].take()).collect();
        Ok(Self { order, regions, ..Self::with(surface, topology, functions, None) })
    }

    /// Functions of the lowest order as they are given.
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
        Self { surface, topology, order: Order::Lowest, functions, ranks, ground, regions: None }
    }

    /// The same above a ground plane: all equations and fields then have the images of the currents
    /// in. The sources are to be those above the plane ([`Grounded`](fredholm_waves::Grounded)).
    ///
    /// # Errors
    /// [`MomentsError::BelowGround`] for a triangle that touches the plane, or is below it.
    pub fn above(self, ground: Ground) -> Result<Self, MomentsError> {
        let low = |triangle: &usize| {
            self.surface.pieces(*triangle).iter().flatten().any(|place| place.z <= ground.height())
        };
        match (0..self.surface.triangles().len()).find(low) {
            Some(index) => Err(MomentsError::BelowGround { what: "triangle", index }),
            None => Ok(Self { ground: Some(ground), ..self }),
        }
    }

    /// Which functions there are.
    #[must_use]
    pub fn order(&self) -> Order {
        self.order
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

    /// Middle of the edge of a function, or of its triangle, m.
    ///
    /// # Panics
    /// Like a slice, where there is no such function.
    #[must_use]
    pub fn centre(&self, function: usize) -> Vec3 {
        middle(&self.surface, &self.topology, self.functions[function].place)
    }

    /// Place of a triangle in an order in which neighbours are near each other.
    pub(crate) fn rank(&self, triangle: u32) -> u32 {
        self.ranks[triangle as usize]
    }
}

/// Middle of an edge or of a triangle, m.
fn middle(surface: &Surface, topology: &Topology, place: Place) -> Vec3 {
    match place {
        Place::Edge(edge) => {
            let ends = topology.edges()[edge].vertices;
            0.5 * (surface.vertices()[ends[0] as usize] + surface.vertices()[ends[1] as usize])
        }
        Place::Triangle(triangle) => surface.centre(triangle),
    }
}

/// The function of an edge that changes along it, from the even one.
fn along(surface: &Surface, topology: &Topology, even: &Function) -> Function {
    let Place::Edge(edge) = even.place else { return even.clone() };
    let first = topology.edges()[edge].vertices[0];
    let odd = |half: &Half| {
        // λ_j − λ_k falls along the edge where the triangle runs from its first vertex on.
        let begins = surface.triangles()[half.triangle as usize][(usize::from(half.number) + 1) % 3];
        let weight = if begins == first { half.weight } else { -half.weight };
        Half { number: half.number + 3, weight, ..*half }
    };
    Function { halves: even.halves.iter().map(odd).collect(), ..even.clone() }
}

/// The functions inside of a triangle: of a border between dielectrics the currents of both sides
/// are the negatives of each other, on a conductor each side has its own, unless it is a sheet in
/// one region.
fn inside(triangle: usize, face: Option<&Face>) -> Vec<Function> {
    let (mut sides, mut magnetic) = (vec![vec![(0, 1.0)]], false);
    if let Some(face) = face {
        let [front, back] = face.regions;
        magnetic = !face.conductor;
        sides = match (front, back) {
            (Some(front), Some(back)) if !face.conductor => vec![vec![(front, 1.0), (back, -1.0)]],
            (Some(front), Some(back)) if front == back => vec![vec![(front, 1.0)]],
            _ => [front, back].into_iter().flatten().map(|region| vec![(region, 1.0)]).collect(),
        };
    }
    let mut functions = Vec::new();
    for side in sides {
        for number in [6, 7] {
            let half =
                |&(region, weight): &(usize, f64)| Half { triangle: triangle as u32, number, weight, region };
            let halves = side.iter().map(half).collect();
            functions.push(Function { place: Place::Triangle(triangle), halves, magnetic });
        }
    }
    functions
}

/// Divides a function by its norm; `norms` are ∫ f² dA of all functions of every triangle.
fn normalise(function: &mut Function, norms: &[[f64; WIDTH]]) {
    let mut triangles: Vec<(u32, u8)> =
        function.halves.iter().map(|half| (half.triangle, half.number)).collect();
    triangles.sort_unstable();
    triangles.dedup();
    let square: f64 = triangles.iter().map(|&(t, number)| norms[t as usize][usize::from(number)]).sum();
    for half in &mut function.halves {
        half.weight /= square.sqrt();
    }
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
        let half = |wedge: &Wedge, region: Option<usize>, weight: f64| Half {
            triangle: wedge.side.triangle,
            number: wedge.side.corner,
            weight,
            region: region.unwrap_or_default(),
        };
        let pair = |&at: &usize| {
            let region = wedges[at].ahead;
            [half(&wedges[at], region, -1.0), half(next(at), region, 1.0)]
        };
        let halves = run.iter().flat_map(pair).collect();
        Function { place: Place::Edge(edge), halves, magnetic }
    };
    Ok(runs.into_iter().map(function).collect())
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
        let v = basis.surface().corners(triangle)[usize::from(half.number)];
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
            let Place::Edge(edge) = function.place else { continue };
            let ends = basis.topology().edges()[edge].vertices;
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
                    let other = Half { number: other, weight: 1.0, ..*half };
                    let product = |p: Vec3| value(&basis, half, p).dot(value(&basis, &other, p));
                    let sum: f64 = rule
                        .iter()
                        .map(|x| 2.0 * area * x.weight * product(a + x.u * (b - a) + x.v * (c - a)))
                        .sum();
                    let products = basis.surface().element(triangle).products();
                    let closed = half.weight * products[usize::from(half.number)][usize::from(other.number)];
                    assert!((sum - closed).abs() < 1e-14 * half.weight.abs());
                    if other.number == half.number {
                        norm += half.weight * closed;
                    }
                }
            }
            assert!((norm - 1.0).abs() < 1e-14);
        }
    }
}

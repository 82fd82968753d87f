//! Dual functions: currents on the barycentric refinement of a closed surface, across the functions
//! of [`Basis`].
//!
//! Every triangle is cut into six at its medians. Around each vertex lies a dual cell of its 2N
//! small triangles. The function of an edge carries a unit current from the cell of one of its ends
//! to that of the other, half of it on either side of the middle of the edge, and spreads it
//! evenly: every small triangle has the same charge. With the spokes of a cell counted from the
//! edge on, the current through spoke i is i/(2N) − ½. So the functions are div-conforming, as the
//! ones of the edges are, and n × them is nearly along those: they are what the range of the
//! magnetic equation is to be tested with. (A. Buffa, S. H. Christiansen, A dual finite element
//! complex on the barycentric refinement, Math. Comp. 76 (2007) 1743,
//! doi:10.1090/S0025-5718-07-01965-5; K. Cools, F. P. Andriulli, D. De Zutter, E. Michielssen,
//! Accurate and conforming mixed discretization of the MFIE, IEEE Antennas Wirel. Propag. Lett. 10
//! (2011) 528, doi:10.1109/LAWP.2011.2155022.)

use crate::basis::Place;
use crate::{Basis, Function, Half, MomentsError, Surface, Topology};
use fredholm_mesh::Vec3;

/// Small triangles of a triangle: triangle t has those from 6t on.
pub(crate) const PARTS: usize = 6;

/// The small triangles of a triangle, in order: at every corner the one along the next side, and
/// the one along the side before. Their first corner is that of the triangle.
pub(crate) fn parts(corners: [Vec3; 3]) -> [[Vec3; 3]; PARTS] {
    let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    let middle = |i: usize| 0.5 * (corners[i % 3] + corners[(i + 1) % 3]);
    std::array::from_fn(|part| {
        let i = part / 2;
        if part % 2 == 0 { [corners[i], middle(i), centre] } else { [corners[i], centre, middle(i + 2)] }
    })
}

/// The dual functions of a closed surface, in the order of its functions.
///
/// # Errors
/// Those of [`Surface::new`].
pub(crate) fn dual(basis: &Basis) -> Result<Basis, MomentsError> {
    let edges = Edges::new(basis);
    let surface = refined(basis.surface(), &edges)?;
    let topology = Topology::new(&surface);
    let small = Edges::of(&topology, surface.triangles().len());
    let functions = basis.functions().iter().map(|function| {
        // Those of the lowest order are around edges.
        let (Place::Edge(edge) | Place::Triangle(edge)) = function.place;
        let meeting = &basis.topology().edges()[edge];
        let mut halves = Vec::new();
        for side in &meeting.sides {
            // From either end the triangle that runs through the edge from there on comes first.
            let sign = if side.forward { 1.0 } else { -1.0 };
            let from = (side.triangle as usize, (usize::from(side.corner) + 1) % 3);
            add_cell(basis.topology(), &edges, from, sign, &mut halves);
        }
        // So that n × it is the function as well as it can be.
        let product = product(&surface, &halves, basis, function);
        for half in &mut halves {
            half.weight /= product;
        }
        // Half of the edge itself, from its lower vertex to the middle.
        let place = Place::Edge(small.0[halves[0].triangle as usize][2]);
        Function { place, halves, magnetic: false }
    });
    let functions = functions.collect();
    Ok(Basis::with(surface, topology, functions, basis.ground()))
}

/// The edges opposite to the corners of every triangle.
struct Edges(Vec<[usize; 3]>);

impl Edges {
    fn new(basis: &Basis) -> Self {
        Self::of(basis.topology(), basis.surface().triangles().len())
    }

    fn of(topology: &Topology, triangles: usize) -> Self {
        let mut edges = vec![[0; 3]; triangles];
        for (edge, meeting) in topology.edges().iter().enumerate() {
            for side in &meeting.sides {
                edges[side.triangle as usize][usize::from(side.corner)] = edge;
            }
        }
        Self(edges)
    }
}

/// The surface with every triangle cut into its parts.
fn refined(surface: &Surface, edges: &Edges) -> Result<Surface, MomentsError> {
    let (corners, triangles) = (surface.vertices(), surface.triangles());
    let count = edges.0.iter().flatten().max().map_or(0, |last| last + 1);
    let mut vertices = corners.to_vec();
    vertices.resize(corners.len() + count + triangles.len(), Vec3::ZERO);
    let mut cut = Vec::with_capacity(PARTS * triangles.len());
    for (triangle, names) in triangles.iter().enumerate() {
        let places = parts(surface.corners(triangle));
        let centre = corners.len() + count + triangle;
        let middle = |i: usize| corners.len() + edges.0[triangle][(i + 2) % 3];
        for i in 0..3 {
            let [next, before] = [middle(i), middle((i + 2) % 3)];
            (vertices[next], vertices[centre]) = (places[2 * i][1], places[2 * i][2]);
            cut.push([names[i], next as u32, centre as u32]);
            cut.push([names[i], centre as u32, before as u32]);
        }
    }
    Surface::new(vertices, cut)
}

/// Adds what a function has in the cell of a vertex: a unit current that leaves it through the
/// sides of its first and last small triangle. The cell begins at a corner of a triangle and goes
/// around counterclockwise.
fn add_cell(topology: &Topology, edges: &Edges, first: (usize, usize), sign: f64, halves: &mut Vec<Half>) {
    let mut fan = vec![first];
    while let Some(&(triangle, corner)) = fan.last() {
        // Across the side from the vertex to the corner before.
        let sides = &topology.edges()[edges.0[triangle][(corner + 1) % 3]].sides;
        let Some(other) = sides.iter().find(|side| side.triangle as usize != triangle) else { break };
        let next = (other.triangle as usize, (usize::from(other.corner) + 1) % 3);
        if next == first || fan.len() == edges.0.len() {
            break;
        }
        fan.push(next);
    }
    let count = 2 * fan.len();
    let through = |spoke: usize| spoke as f64 / count as f64 - 0.5;
    for spoke in 0..count {
        let (triangle, corner) = fan[spoke / 2];
        let triangle = (PARTS * triangle + 2 * corner + spoke % 2) as u32;
        let mut add = |corner: u8, weight: f64| {
            halves.push(Half { triangle, number: corner, weight: sign * weight, region: 0 });
        };
        // Small triangles are (vertex, on the spoke, on the next spoke).
        if spoke > 0 {
            add(2, -through(spoke));
        }
        if spoke + 1 < count {
            add(1, through(spoke + 1));
        }
        if spoke == 0 || spoke + 1 == count {
            add(0, 0.5);
        }
    }
}

/// ∫ (n × g_a)·f_b dA over a part of a triangle, for corner `a` of the part, corner `b` of the
/// whole and weights 1.
pub(crate) fn turned_gram(cut: &Surface, part: u32, whole: &Surface, [a, b]: [usize; 2]) -> f64 {
    let (part, triangle) = (part as usize, part as usize / PARTS);
    let centre = cut.centre(part);
    let own = centre - cut.corners(part)[a];
    let other = centre - whole.corners(triangle)[b];
    whole.normal(triangle).dot(own.cross(other)) / (4.0 * whole.area(triangle))
}

/// ∫ (n × g)·f dA of halves g on a surface and a function f of the basis whose triangles it cuts.
fn product(surface: &Surface, halves: &[Half], basis: &Basis, function: &Function) -> f64 {
    let mut sum = 0.0;
    for g in halves {
        for f in function.halves.iter().filter(|f| f.triangle == g.triangle / PARTS as u32) {
            let corners = [g.number, f.number].map(usize::from);
            sum += g.weight * f.weight * turned_gram(surface, g.triangle, basis.surface(), corners);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::sphere;

    fn basis() -> Basis {
        Basis::new(sphere(1.0, 0.6).unwrap()).unwrap()
    }

    #[test]
    fn the_parts_of_a_triangle_are_a_sixth_of_it_and_are_those_of_the_refinement() {
        let basis = basis();
        let dual = dual(&basis).unwrap();
        for triangle in 0..basis.surface().triangles().len() {
            let parts = parts(basis.surface().corners(triangle));
            for (part, corners) in parts.into_iter().enumerate() {
                assert_eq!(dual.surface().corners(PARTS * triangle + part), corners);
                let share = dual.surface().area(PARTS * triangle + part) / basis.surface().area(triangle);
                assert!((share * 6.0 - 1.0).abs() < 1e-12);
            }
        }
        assert!(dual.topology().check_closed(dual.surface(), "a test").is_ok());
    }

    /// What comes through an edge of the refinement on one side leaves on the other, and the charge
    /// of a cell is even.
    #[test]
    fn dual_functions_are_continuous_with_even_charges_in_two_cells() {
        let basis = basis();
        let dual = dual(&basis).unwrap();
        let count = dual.surface().triangles().len();
        let edges = Edges::of(dual.topology(), count);
        for (function, own) in dual.functions().iter().zip(basis.functions()) {
            let mut through = vec![0.0; dual.topology().edges().len()];
            let mut charges = vec![0.0; count];
            let mut square = 0.0;
            for half in &function.halves {
                through[edges.0[half.triangle as usize][usize::from(half.number)]] += half.weight;
                charges[half.triangle as usize] += half.weight;
                square += half.weight.abs();
            }
            assert!(square > 0.0 && through.iter().all(|sum| sum.abs() < 1e-12));
            let Place::Edge(edge) = own.place else { continue };
            let ends = basis.topology().edges()[edge].vertices;
            let mut sums = [0.0; 2];
            for (end, vertex) in ends.into_iter().enumerate() {
                let cell: Vec<f64> = (0..count)
                    .filter(|&t| dual.surface().triangles()[t][0] == vertex)
                    .map(|t| charges[t])
                    .collect();
                let sum: f64 = cell.iter().sum();
                assert!(cell.iter().all(|c| (c * cell.len() as f64 - sum).abs() < 1e-12));
                sums[end] = sum;
            }
            assert!((sums[0] + sums[1]).abs() < 1e-12 && sums[0].abs() > 0.1);
        }
    }

    #[test]
    fn dual_functions_are_across_those_of_the_edges() {
        let basis = basis();
        let dual = dual(&basis).unwrap();
        for (function, own) in dual.functions().iter().zip(basis.functions()) {
            let product = product(dual.surface(), &function.halves, &basis, own);
            assert!((product - 1.0).abs() < 1e-12);
            // By Cauchy's inequality 1 at least: they are nearly the turned ones.
            let mut square = 0.0;
            for together in function.halves.chunk_by(|a, b| a.triangle == b.triangle) {
                for (a, b) in together.iter().flat_map(|a| together.iter().map(move |b| (a, b))) {
                    let products = dual.surface().element(a.triangle as usize).products();
                    let gram = products[usize::from(a.number)][usize::from(b.number)];
                    square += a.weight * b.weight * gram;
                }
            }
            assert!((1.0..4.0).contains(&square), "{square}");
        }
    }
}

//! Constrained Delaunay triangulation of a flat region bounded by borders.
//!
//! L. P. Chew, Constrained Delaunay triangulations, Algorithmica 4 (1989) 97–108,
//! doi:10.1007/BF01553881; the triangulation itself is spade's. Triangles belong to the region when
//! an odd number of borders separates them from the outside. Lengths relative to the size of the
//! region.

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::border::Corner;

type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>>;

/// Below this a coordinate is zero: spade refuses numbers near underflow.
const LEAST_COORDINATE: f64 = 1e-30;

/// Triangles, counter-clockwise, as indices of corners counted through all rings; `None` where the
/// borders conflict.
pub(crate) fn triangulate(rings: &[Vec<Corner>]) -> Option<Vec<[usize; 3]>> {
    let number = |x: f64| if x.abs() < LEAST_COORDINATE { 0.0 } else { x };
    let points = rings.iter().flatten().map(|c| Point2::new(number(c.at.x), number(c.at.y))).collect();
    let mut conflict = false;
    let cdt = Cdt::try_bulk_load_cdt(points, constraints(rings), |_| conflict = true).ok()?;
    let complete = !conflict && cdt.num_vertices() == rings.iter().map(Vec::len).sum::<usize>();
    complete.then(|| inside(&cdt))
}

fn constraints(rings: &[Vec<Corner>]) -> Vec<[usize; 2]> {
    let mut edges = Vec::new();
    let mut first = 0;
    for ring in rings {
        edges.extend((0..ring.len()).map(|i| [first + i, first + (i + 1) % ring.len()]));
        first += ring.len();
    }
    edges
}

fn inside(cdt: &Cdt) -> Vec<[usize; 3]> {
    let inner = flood(cdt);
    let chosen = cdt.inner_faces().filter(|face| inner[face.index()] == Some(true));
    chosen.map(|face| face.vertices().map(|vertex| vertex.index())).collect()
}

/// Whether each face lies inside, spread from the outer face; every border that is crossed turns
/// the answer round.
fn flood(cdt: &Cdt) -> Vec<Option<bool>> {
    let outer = cdt.outer_face().index();
    let mut inside = vec![None; cdt.num_all_faces()];
    inside[outer] = Some(false);
    let mut front: Vec<_> = cdt.directed_edges().filter(|edge| edge.face().index() == outer).collect();
    while let Some(edge) = front.pop() {
        let across = edge.rev();
        let face = across.face().index();
        if let (Some(here), None) = (inside[edge.face().index()], inside[face]) {
            inside[face] = Some(here != across.is_constraint_edge());
            front.extend([across.next(), across.prev()]);
        }
    }
    inside
}

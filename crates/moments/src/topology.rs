//! Which triangles meet at which edges, and what that says of a surface.
//!
//! An edge has one triangle (open), two (inside a surface) or more (a junction). Two neighbours
//! agree on the side of the surface that is outside where they run through their common edge in
//! opposite directions.

use crate::{MomentsError, Order, Surface};
use fredholm_mesh::{Bounds, Vec3};
use std::fmt;

/// Distance over the length of an edge (or the diagonal of the surface) below which a point is on
/// it.
const ON_EDGE_DISTANCE: f64 = 1e-9;
/// Largest extents of a closed part over which its field changes where it is small beside the
/// wavelength, measured on balls, cubes and boxes.
const EXTENTS_OF_CLOSED: f64 = 1.5;
/// The same of an open part, in areas over lengths of its open edges, measured on plates and
/// strips.
const WIDTHS_OF_OPEN: f64 = 4.8;
/// Longest edge over the wavelength beyond which the report warns.
const LONGEST_EDGE_OVER_WAVELENGTH: f64 = 1.0 / 6.0;

/// A triangle at an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// The triangle.
    pub triangle: u32,
    /// Its corner opposite to the edge: 0, 1 or 2.
    pub corner: u8,
    /// Whether the triangle runs through the edge from its lower to its higher vertex.
    pub forward: bool,
}

/// An edge with the triangles that meet there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Its vertices, the lower first.
    pub vertices: [u32; 2],
    /// The triangles, in order.
    pub sides: Vec<Side>,
}

/// A connected part of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Its first triangle.
    pub first: usize,
    /// Number of its triangles.
    pub triangles: usize,
    /// Whether every edge has two triangles.
    pub closed: bool,
    /// Whether all neighbours agree on the outside.
    pub oriented: bool,
    /// Signed volume of a closed component (m³), negative where its normals point inwards; 0 of an
    /// open one.
    pub volume: f64,
}

/// A vertex within an open edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TJunction {
    /// The vertex.
    pub vertex: usize,
    /// The edge.
    pub edge: usize,
}

/// The edges of a surface, ordered by their vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    edges: Vec<Edge>,
    /// Component of every triangle.
    component: Vec<usize>,
    components: usize,
}

impl Topology {
    /// Finds the edges and components of a surface.
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        let edges = edges(surface.triangles());
        let mut roots: Vec<usize> = (0..surface.triangles().len()).collect();
        for edge in &edges {
            for side in &edge.sides[1..] {
                join(&mut roots, edge.sides[0].triangle as usize, side.triangle as usize);
            }
        }
        let (component, components) = numbered(roots);
        Self { edges, component, components }
    }

    /// The edges.
    #[must_use]
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The neighbours of every triangle across edges of two, and whether they disagree on the
    /// outside.
    pub(crate) fn neighbours(&self) -> Vec<Vec<(usize, bool)>> {
        let mut neighbours = vec![Vec::new(); self.component.len()];
        for edge in &self.edges {
            if let [a, b] = edge.sides[..] {
                let differ = a.forward == b.forward;
                neighbours[a.triangle as usize].push((b.triangle as usize, differ));
                neighbours[b.triangle as usize].push((a.triangle as usize, differ));
            }
        }
        neighbours
    }

    /// Which triangles have to be turned over for neighbours to agree and closed bodies to have
    /// their normals outwards.
    pub(crate) fn turned(&self, surface: &Surface) -> Vec<bool> {
        let neighbours = self.neighbours();
        let mut turned: Vec<Option<bool>> = vec![None; neighbours.len()];
        for first in 0..neighbours.len() {
            let mut waiting = if turned[first].is_none() { vec![(first, false)] } else { Vec::new() };
            while let Some((triangle, turn)) = waiting.pop() {
                if turned[triangle].is_none() {
                    turned[triangle] = Some(turn);
                    waiting.extend(neighbours[triangle].iter().map(|&(next, differ)| (next, turn ^ differ)));
                }
            }
        }
        let mut turned: Vec<bool> = turned.into_iter().map(Option::unwrap_or_default).collect();
        let volumes = self.volumes(surface, &turned);
        let closed = self.closed();
        for (triangle, turned) in turned.iter_mut().enumerate() {
            let component = self.component[triangle];
            *turned ^= closed[component] && volumes[component] < 0.0;
        }
        turned
    }

    /// Whether every edge of a component has two triangles.
    fn closed(&self) -> Vec<bool> {
        let mut closed = vec![true; self.components];
        for edge in self.edges.iter().filter(|edge| edge.sides.len() != 2) {
            closed[self.component[edge.sides[0].triangle as usize]] = false;
        }
        closed
    }

    /// ⅓ ∮ r·n dA of every component, about its first corner, with some triangles turned over.
    fn volumes(&self, surface: &Surface, turned: &[bool]) -> Vec<f64> {
        let mut volumes = vec![0.0; self.components];
        let mut origins: Vec<Option<Vec3>> = vec![None; self.components];
        for (triangle, &component) in self.component.iter().enumerate() {
            let corners = surface.corners(triangle);
            let origin = *origins[component].get_or_insert(corners[0]);
            let [a, b, c] = corners.map(|corner| corner - origin);
            let sign = if turned[triangle] { -1.0 } else { 1.0 };
            volumes[component] += sign * a.dot(b.cross(c)) / 6.0;
        }
        volumes
    }

    /// The connected parts of the surface.
    #[must_use]
    pub fn components(&self, surface: &Surface) -> Vec<Component> {
        let volumes = self.volumes(surface, &vec![false; self.component.len()]);
        let part = |(closed, volume): (bool, f64)| Component {
            first: usize::MAX,
            triangles: 0,
            closed,
            oriented: true,
            volume: if closed { volume } else { 0.0 },
        };
        let mut parts: Vec<Component> = self.closed().into_iter().zip(volumes).map(part).collect();
        for (triangle, &component) in self.component.iter().enumerate() {
            parts[component].first = parts[component].first.min(triangle);
            parts[component].triangles += 1;
        }
        for edge in self.misoriented() {
            parts[self.component[self.edges[edge].sides[0].triangle as usize]].oriented = false;
        }
        parts
    }

    /// Component of every triangle.
    pub(crate) fn component_of(&self, triangle: usize) -> usize {
        self.component[triangle]
    }

    /// Edges where two neighbours do not agree on the outside.
    fn misoriented(&self) -> impl Iterator<Item = usize> {
        let differ = |edge: &Edge| matches!(edge.sides[..], [a, b] if a.forward == b.forward);
        self.edges.iter().enumerate().filter(move |(_, edge)| differ(edge)).map(|(index, _)| index)
    }

    /// Refuses surfaces on which no current can be expanded as meant: duplicate vertices on open
    /// edges, T-junctions, repeated triangles, no inner edge.
    ///
    /// # Errors
    /// [`MomentsError::Repeated`], [`MomentsError::DuplicateVertices`],
    /// [`MomentsError::TJunction`], [`MomentsError::NoInnerEdge`].
    pub fn check(&self, surface: &Surface) -> Result<(), MomentsError> {
        if let Some([first, second]) = repeated(surface.triangles()) {
            return Err(MomentsError::Repeated { first, second });
        }
        if let Some(&[first, second]) = self.duplicates(surface).first() {
            return Err(MomentsError::DuplicateVertices { first, second });
        }
        if let Some(&TJunction { vertex, edge }) = self.t_junctions(surface).first() {
            let triangle = self.edges[edge].sides[0].triangle as usize;
            return Err(MomentsError::TJunction { vertex, triangle });
        }
        if self.edges.iter().all(|edge| edge.sides.len() < 2) {
            return Err(MomentsError::NoInnerEdge);
        }
        Ok(())
    }

    /// Refuses what is not a set of closed bodies with normals outwards.
    ///
    /// # Errors
    /// [`MomentsError::NotClosed`], [`MomentsError::Junction`], [`MomentsError::Orientation`],
    /// [`MomentsError::InsideOut`].
    pub fn check_closed(&self, surface: &Surface, equation: &'static str) -> Result<(), MomentsError> {
        for (edge, Edge { sides, .. }) in self.edges.iter().enumerate() {
            match sides[..] {
                [side] => {
                    let triangle = side.triangle as usize;
                    return Err(MomentsError::NotClosed { equation, edge, triangle });
                }
                [a, b] if a.forward == b.forward => {
                    let [first, second] = [a, b].map(|side| side.triangle as usize);
                    return Err(MomentsError::Orientation { first, second });
                }
                [_, _] => {}
                _ => return Err(MomentsError::Junction { equation, edge, triangles: sides.len() }),
            }
        }
        match self.components(surface).iter().find(|part| part.volume <= 0.0) {
            Some(part) => Err(MomentsError::InsideOut { triangle: part.first }),
            None => Ok(()),
        }
    }

    /// The length of the longest edge, m.
    #[must_use]
    pub fn longest_edge(&self, surface: &Surface) -> f64 {
        self.edges.iter().map(|edge| length(surface, edge)).fold(0.0, f64::max)
    }

    /// Whether some edge has one triangle only.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.edges.iter().any(|edge| edge.sides.len() == 1)
    }

    /// The longest edge over the length on which currents change at a wavelength (m): what the
    /// error of boundary elements follows. That length is the wavelength, or less where a part of
    /// the surface is small beside it.
    #[must_use]
    pub fn relative_edge(&self, surface: &Surface, wavelength: f64) -> f64 {
        self.longest_edge(surface) / self.field_length(surface, wavelength)
    }

    /// The length on which currents change, m.
    fn field_length(&self, surface: &Surface, wavelength: f64) -> f64 {
        let mut parts = vec![(0.0, 0.0, None::<Bounds>); self.components];
        for (triangle, &component) in self.component.iter().enumerate() {
            let (area, _, bounds) = &mut parts[component];
            *area += surface.area(triangle);
            let corners = surface.corners(triangle);
            *bounds = Bounds::around(bounds.iter().flat_map(|b| [b.min, b.max]).chain(corners));
        }
        for edge in self.edges.iter().filter(|edge| edge.sides.len() == 1) {
            parts[self.component[edge.sides[0].triangle as usize]].1 += length(surface, edge);
        }
        let of_part = |(area, open, bounds): (f64, f64, Option<Bounds>)| {
            let extent = bounds.map_or(f64::INFINITY, |b| (b.max - b.min).max_element());
            if open > 0.0 { WIDTHS_OF_OPEN * area / open } else { EXTENTS_OF_CLOSED * extent }
        };
        parts.into_iter().map(of_part).fold(wavelength, f64::min)
    }

    /// Refuses edges above a third of the wavelength (m), or half of it with functions of the first
    /// full order, on which no wave can be told from its alias.
    ///
    /// # Errors
    /// [`MomentsError::Coarse`] with the first such edge.
    pub fn check_resolution(
        &self,
        surface: &Surface,
        wavelength: f64,
        order: Order,
    ) -> Result<(), MomentsError> {
        let (longest, most) = order.longest_edge();
        let lengths = self.edges.iter().map(|edge| length(surface, edge));
        match lengths.enumerate().find(|(_, length)| *length > longest * wavelength) {
            Some((edge, length)) => Err(MomentsError::Coarse { edge, length, wavelength, most }),
            None => Ok(()),
        }
    }

    /// Pairs of vertices at the same place of which both are on open edges.
    fn duplicates(&self, surface: &Surface) -> Vec<[usize; 2]> {
        let open = self.open_vertices(surface);
        let places: Vec<Vec3> = open.iter().map(|&vertex| surface.vertices()[vertex]).collect();
        let extent = extent(surface.vertices());
        close_pairs(&places, ON_EDGE_DISTANCE * extent)
            .into_iter()
            .map(|pair| pair.map(|at| open[at]))
            .collect()
    }

    /// Vertices of open edges.
    fn open_vertices(&self, surface: &Surface) -> Vec<usize> {
        let mut open = vec![false; surface.vertices().len()];
        for edge in self.edges.iter().filter(|edge| edge.sides.len() == 1) {
            edge.vertices.iter().for_each(|&vertex| open[vertex as usize] = true);
        }
        (0..open.len()).filter(|&vertex| open[vertex]).collect()
    }

    /// Vertices of open edges that lie within others.
    fn t_junctions(&self, surface: &Surface) -> Vec<TJunction> {
        let mut candidates = self.open_vertices(surface);
        candidates.sort_by(|&a, &b| surface.vertices()[a].x.total_cmp(&surface.vertices()[b].x));
        let mut found = Vec::new();
        for (index, edge) in self.edges.iter().enumerate().filter(|(_, edge)| edge.sides.len() == 1) {
            let [a, b] = edge.vertices.map(|vertex| surface.vertices()[vertex as usize]);
            let slack = ON_EDGE_DISTANCE * a.distance(b);
            let (low, high) = (a.x.min(b.x) - slack, a.x.max(b.x) + slack);
            let start = candidates.partition_point(|&vertex| surface.vertices()[vertex].x < low);
            let near = candidates[start..].iter().take_while(|&&vertex| surface.vertices()[vertex].x <= high);
            let inside = near.filter(|&&vertex| {
                !edge.vertices.contains(&(vertex as u32)) && within(surface.vertices()[vertex], a, b, slack)
            });
            found.extend(inside.map(|&vertex| TJunction { vertex, edge: index }));
        }
        found
    }

    /// Everything that is worth knowing of a surface before a wave of this length (m) meets it.
    #[must_use]
    pub fn report(&self, surface: &Surface, wavelength: f64) -> Report {
        let count = |wanted: fn(usize) -> bool| self.edges.iter().filter(|e| wanted(e.sides.len())).count();
        let lengths: Vec<f64> = self.edges.iter().map(|edge| length(surface, edge)).collect();
        Report {
            vertices: surface.vertices().len(),
            triangles: surface.triangles().len(),
            edges: self.edges.len(),
            open_edges: count(|sides| sides == 1),
            junctions: count(|sides| sides > 2),
            components: self.components(surface),
            misoriented: self.misoriented().collect(),
            duplicates: self.duplicates(surface),
            t_junctions: self.t_junctions(surface),
            repeated: repeated(surface.triangles()),
            wavelength,
            longest: lengths.iter().copied().fold(0.0, f64::max),
            long_edges: lengths
                .iter()
                .filter(|&&length| length > LONGEST_EDGE_OVER_WAVELENGTH * wavelength)
                .count(),
        }
    }
}

/// What a surface is, and what to mend. Its text names every defect with its cure.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Number of vertices.
    pub vertices: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of edges.
    pub edges: usize,
    /// Edges with one triangle.
    pub open_edges: usize,
    /// Edges with more than two triangles.
    pub junctions: usize,
    /// The connected parts.
    pub components: Vec<Component>,
    /// Edges where neighbours do not agree on the outside.
    pub misoriented: Vec<usize>,
    /// Vertices of open edges that are at the same place.
    pub duplicates: Vec<[usize; 2]>,
    /// Vertices within open edges.
    pub t_junctions: Vec<TJunction>,
    /// The first two triangles with the same corners.
    pub repeated: Option<[usize; 2]>,
    /// The wavelength, m.
    pub wavelength: f64,
    /// The longest edge, m.
    pub longest: f64,
    /// Edges above λ/6.
    pub long_edges: usize,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let closed = self.components.iter().filter(|part| part.closed).count();
        writeln!(f, "{} triangles, {} edges, {} vertices", self.triangles, self.edges, self.vertices)?;
        writeln!(f, "{} components, {closed} of them closed", self.components.len())?;
        writeln!(f, "{} open edges, {} junctions", self.open_edges, self.junctions)?;
        writeln!(f, "longest edge λ/{:.1}", self.wavelength / self.longest)?;
        if self.long_edges > 0 {
            writeln!(f, "{} edges are longer than λ/6: mesh finer, λ/10 is usual", self.long_edges)?;
        }
        if let Some([a, b]) = self.repeated {
            writeln!(f, "triangles {a} and {b} have the same corners: remove one of them")?;
        }
        if let Some([a, b]) = self.duplicates.first() {
            let count = self.duplicates.len();
            writeln!(f, "{count} pairs of vertices are at the same place, such as {a} and {b}: join them")?;
        }
        if let Some(TJunction { vertex, edge }) = self.t_junctions.first() {
            let count = self.t_junctions.len();
            writeln!(
                f,
                "{count} vertices lie within open edges, such as {vertex} in edge {edge}: split the triangles there"
            )?;
        }
        if let Some(edge) = self.misoriented.first() {
            let count = self.misoriented.len();
            writeln!(
                f,
                "at {count} edges, such as {edge}, neighbours have their normals on different sides: turn one over"
            )?;
        }
        let inside_out = |part: &&Component| part.closed && part.oriented && part.volume < 0.0;
        for part in self.components.iter().filter(inside_out) {
            writeln!(
                f,
                "the normals of the closed body with triangle {} point inwards: turn it over",
                part.first
            )?;
        }
        Ok(())
    }
}

/// The edges of triangles, ordered by their vertices.
fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let side = |(triangle, corners): (usize, &[u32; 3])| {
        let corners = *corners;
        [0, 1, 2].map(|corner| {
            let (from, to) = (corners[(corner + 1) % 3], corners[(corner + 2) % 3]);
            let side = Side { triangle: triangle as u32, corner: corner as u8, forward: from < to };
            ([from.min(to), from.max(to)], side)
        })
    };
    let mut sides: Vec<([u32; 2], Side)> = triangles.iter().enumerate().flat_map(side).collect();
    sides.sort_by_key(|&(vertices, side)| (vertices, side.triangle));
    let mut edges: Vec<Edge> = Vec::new();
    for (vertices, side) in sides {
        match edges.last_mut() {
            Some(edge) if edge.vertices == vertices => edge.sides.push(side),
            _ => edges.push(Edge { vertices, sides: vec![side] }),
        }
    }
    edges
}

/// The first two triangles with the same corners.
fn repeated(triangles: &[[u32; 3]]) -> Option<[usize; 2]> {
    let sorted = |(index, corners): (usize, &[u32; 3])| {
        let mut corners = *corners;
        corners.sort_unstable();
        (corners, index)
    };
    let mut all: Vec<([u32; 3], usize)> = triangles.iter().enumerate().map(sorted).collect();
    all.sort_unstable();
    all.windows(2).find(|pair| pair[0].0 == pair[1].0).map(|pair| [pair[0].1, pair[1].1])
}

fn length(surface: &Surface, edge: &Edge) -> f64 {
    let [a, b] = edge.vertices.map(|vertex| surface.vertices()[vertex as usize]);
    a.distance(b)
}

/// Whether a point lies between the ends of an edge.
fn within(p: Vec3, a: Vec3, b: Vec3, slack: f64) -> bool {
    let along = (p - a).dot(b - a) / a.distance_squared(b);
    along > ON_EDGE_DISTANCE && along < 1.0 - ON_EDGE_DISTANCE && p.distance(a + along * (b - a)) <= slack
}

/// Diagonal of the box around points, m.
fn extent(points: &[Vec3]) -> f64 {
    let fold = |f: fn(Vec3, Vec3) -> Vec3| points.iter().copied().reduce(f).unwrap_or_default();
    fold(Vec3::max).distance(fold(Vec3::min))
}

/// Pairs (lower, higher) of points within a distance of each other, by the lower.
pub(crate) fn close_pairs(points: &[Vec3], distance: f64) -> Vec<[usize; 2]> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].x.total_cmp(&points[b].x));
    let mut pairs = Vec::new();
    for (rank, &a) in order.iter().enumerate() {
        let near = order[rank + 1..].iter().take_while(|&&b| points[b].x - points[a].x <= distance);
        let close = near.filter(|&&b| points[b].distance(points[a]) <= distance);
        pairs.extend(close.map(|&b| [a.min(b), a.max(b)]));
    }
    pairs.sort_unstable();
    pairs
}

/// Joins the sets of two triangles.
pub(crate) fn join(roots: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(roots, a), root(roots, b));
    roots[a.max(b)] = a.min(b);
}

/// The first triangle of a set; halves the path on the way.
fn root(roots: &mut [usize], mut at: usize) -> usize {
    while roots[at] != at {
        roots[at] = roots[roots[at]];
        at = roots[at];
    }
    at
}

/// Sets numbered by their first triangle, and how many there are.
pub(crate) fn numbered(mut roots: Vec<usize>) -> (Vec<usize>, usize) {
    let mut numbers = vec![0; roots.len()];
    let mut count = 0;
    for at in 0..roots.len() {
        let first = root(&mut roots, at);
        numbers[at] = if first == at { count } else { numbers[first] };
        count += usize::from(first == at);
    }
    (numbers, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron with its normals outwards.
    fn tetrahedron() -> Surface {
        let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        Surface::new(vertices, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap()
    }

    fn report(surface: &Surface) -> Report {
        Topology::new(surface).report(surface, 10.0)
    }

    #[test]
    fn a_tetrahedron_is_one_closed_body() {
        let surface = tetrahedron();
        let found = report(&surface);
        assert_eq!((found.edges, found.open_edges, found.junctions, found.components.len()), (6, 0, 0, 1));
        assert!(found.components[0].closed && (found.components[0].volume - 1.0 / 6.0).abs() < 1e-15);
        assert!(found.misoriented.is_empty() && found.t_junctions.is_empty() && found.long_edges == 0);
        Topology::new(&surface).check(&surface).unwrap();
        Topology::new(&surface).check_closed(&surface, "").unwrap();
        assert_eq!(surface.oriented(), surface);
    }

    #[test]
    fn inverted_triangles_are_found_and_turned_over() {
        let mut triangles = tetrahedron().triangles().to_vec();
        triangles[2].swap(0, 1);
        let surface = Surface::new(tetrahedron().vertices().to_vec(), triangles).unwrap();
        assert_eq!(report(&surface).misoriented.len(), 3);
        let refused = Topology::new(&surface).check_closed(&surface, "");
        assert!(matches!(refused, Err(MomentsError::Orientation { .. })));
        let mended = surface.oriented();
        Topology::new(&mended).check_closed(&mended, "").unwrap();
    }

    #[test]
    fn a_body_that_is_inside_out_is_found_and_turned_over() {
        let triangles = tetrahedron().triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let surface = Surface::new(tetrahedron().vertices().to_vec(), triangles).unwrap();
        let refused = Topology::new(&surface).check_closed(&surface, "");
        assert_eq!(refused, Err(MomentsError::InsideOut { triangle: 0 }));
        assert!(report(&surface).to_string().contains("point inwards"));
        let mended = surface.oriented();
        Topology::new(&mended).check_closed(&mended, "").unwrap();
    }

    #[test]
    fn small_parts_shorten_the_length_on_which_currents_change() {
        let plate = |u: f64, v: f64| {
            let corners = vec![Vec3::ZERO, Vec3::X * u, Vec3::new(u, v, 0.0), Vec3::Y * v];
            Surface::new(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
        };
        let length = |surface: &Surface| Topology::new(surface).field_length(surface, 1.0);
        let same = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(same(length(&plate(2.0, 2.0)), 1.0));
        assert!((length(&plate(0.1, 0.1)) - 0.12).abs() < 1e-12);
        assert!((length(&plate(0.4, 0.1)) - 4.8 * 0.04).abs() < 1e-12);
        let ball = |radius| crate::meshing::sphere(radius, radius).unwrap();
        assert!(same(length(&ball(1.0)), 1.0) && (length(&ball(0.01)) - 0.03).abs() < 4e-3);
        // The smallest part counts.
        let both = plate(2.0, 2.0).with(&ball(0.01)).unwrap();
        assert!(same(length(&both), length(&ball(0.01))) && Topology::new(&both).is_open());
        assert!(!Topology::new(&ball(0.01)).is_open());
    }

    #[test]
    fn open_edges_junctions_and_components_are_counted() {
        let mut vertices = tetrahedron().vertices().to_vec();
        vertices.extend([Vec3::NEG_Z, Vec3::splat(5.0), Vec3::new(6.0, 5.0, 5.0), Vec3::new(5.0, 6.0, 5.0)]);
        let mut triangles = tetrahedron().triangles().to_vec();
        triangles.extend([[0, 1, 4], [5, 6, 7]]);
        let surface = Surface::new(vertices, triangles).unwrap();
        let found = report(&surface);
        assert_eq!((found.junctions, found.open_edges, found.components.len()), (1, 5, 2));
        let topology = Topology::new(&surface);
        assert_eq!(topology.check(&surface), Ok(()));
        let refused = topology.check_closed(&surface, "");
        assert!(matches!(
            refused,
            Err(MomentsError::Junction { triangles: 3, .. } | MomentsError::NotClosed { .. })
        ));
    }

    #[test]
    fn t_junctions_and_duplicates_are_refused_with_a_cure() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let mut vertices = square.to_vec();
        vertices.extend([Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.0, 0.9, 0.0)]);
        // The second half of the square is two triangles with a vertex on the diagonal.
        let surface = Surface::new(vertices, vec![[0, 1, 2], [0, 4, 3], [4, 2, 3]]).unwrap();
        let topology = Topology::new(&surface);
        let refused = topology.check(&surface);
        assert_eq!(refused, Err(MomentsError::TJunction { vertex: 4, triangle: 0 }));
        assert!(report(&surface).to_string().contains("split the triangles"));
        let apart = Surface::new([square, square].concat(), vec![[0, 1, 2], [4, 6, 7]]).unwrap();
        let topology = Topology::new(&apart);
        assert_eq!(topology.check(&apart), Err(MomentsError::DuplicateVertices { first: 0, second: 4 }));
        let joined = apart.welded(1e-9).unwrap();
        Topology::new(&joined).check(&joined).unwrap();
    }

    #[test]
    fn bad_triangles_are_refused() {
        let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X * 2.0];
        let of = |triangles: &[[u32; 3]]| Surface::new(vertices.clone(), triangles.to_vec());
        assert_eq!(of(&[]), Err(MomentsError::Empty));
        assert_eq!(of(&[[0, 1, 3]]), Err(MomentsError::Degenerate { triangle: 0 }));
        let missing = MomentsError::NoSuchVertex { triangle: 0, vertex: 9, vertices: 4 };
        assert_eq!(of(&[[0, 1, 9]]), Err(missing));
        let twice = of(&[[0, 1, 2], [0, 2, 1]]).unwrap();
        let refused = Topology::new(&twice).check(&twice);
        assert_eq!(refused, Err(MomentsError::Repeated { first: 0, second: 1 }));
        let alone = of(&[[0, 1, 2]]).unwrap();
        assert_eq!(Topology::new(&alone).check(&alone), Err(MomentsError::NoInnerEdge));
        let nan = Surface::new(vec![Vec3::NAN; 3], vec![[0, 1, 2]]);
        assert_eq!(nan, Err(MomentsError::NotFinite { vertex: 0 }));
    }

    #[test]
    fn edges_beyond_a_third_of_the_wavelength_are_refused() {
        let surface = tetrahedron();
        let topology = Topology::new(&surface);
        topology.check_resolution(&surface, 4.3, Order::Lowest).unwrap();
        topology.check_resolution(&surface, 2.9, Order::First).unwrap();
        assert!(matches!(
            topology.check_resolution(&surface, 4.2, Order::Lowest),
            Err(MomentsError::Coarse { .. })
        ));
        assert_eq!(topology.report(&surface, 7.0).long_edges, 3);
    }
}

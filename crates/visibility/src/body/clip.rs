//! The part of a body in front of a plane.
//!
//! Every face that the plane crosses gets a new edge from where its border leaves the front to
//! where it comes back; a solid gets the cut as a new face.

use fredholm_mesh::Vec3;

use super::{Body, Edge, Face};

impl Body {
    /// The part at heights ≥ 0 over `plane`, or `None` where that is the whole body. Heights of at
    /// most `tolerance` (m) count as 0. A body of which nothing is in front keeps no edge and hides
    /// nothing.
    #[must_use]
    pub fn in_front(&self, plane: &Face, tolerance: f64) -> Option<Self> {
        let snapped = |h: f64| if h.abs() <= tolerance { 0.0 } else { h };
        let height = |&x: &Vec3| snapped(plane.height(x));
        if self.corners.iter().all(|x| height(x) >= 0.0) {
            return None;
        }
        let heights: Vec<f64> = self.corners.iter().map(height).collect();
        let mut faces = self.faces.clone();
        if self.solid {
            faces.push(Face { normal: -plane.normal, offset: -plane.offset });
        }
        let mut part = Cut {
            body: self,
            heights: &heights,
            corners: Vec::new(),
            edges: Vec::new(),
            gaps: vec![[None; 2]; self.faces.len()],
        };
        self.edges.iter().for_each(|edge| part.edge(edge));
        part.close(faces.len() as u32 - 1);
        Some(Self { corners: part.corners, faces, edges: part.edges, local: Vec::new(), solid: self.solid })
    }
}

struct Cut<'a> {
    body: &'a Body,
    heights: &'a [f64],
    corners: Vec<Vec3>,
    edges: Vec<Edge>,
    /// Per face, where its border leaves the front and where it comes back.
    gaps: Vec<[Option<u32>; 2]>,
}

impl Cut<'_> {
    fn edge(&mut self, edge: &Edge) {
        let [low, high] = edge.ends.map(|k| self.heights[k as usize]);
        if low < 0.0 && high <= 0.0 || low <= 0.0 && high < 0.0 {
            return;
        }
        let [a, b] = self.body.ends(edge);
        let at = |from: Vec3, to: Vec3, h: f64, g: f64| from + (to - from) * (h / (h - g));
        let start = if low < 0.0 { at(a, b, low, high) } else { a };
        let end = if high < 0.0 { at(b, a, high, low) } else { b };
        let ends = [self.corner(start), self.corner(end)];
        self.edges.push(Edge { ends, faces: edge.faces });
        if high < 0.0 || (high == 0.0 && low > 0.0) {
            self.leave(edge, ends[1], 0);
        }
        if low < 0.0 || (low == 0.0 && high > 0.0) {
            self.leave(edge, ends[0], 1);
        }
    }

    /// Round the first face the edge runs forwards, round the second backwards.
    fn leave(&mut self, edge: &Edge, corner: u32, end: usize) {
        self.gaps[edge.faces[0] as usize][end] = Some(corner);
        self.gaps[edge.faces[1] as usize][1 - end] = Some(corner);
    }

    fn corner(&mut self, x: Vec3) -> u32 {
        let found = self.corners.iter().position(|y| *y == x);
        found.unwrap_or_else(|| {
            self.corners.push(x);
            self.corners.len() - 1
        }) as u32
    }

    /// Adds the new edges; a flat body has one, between its two faces.
    fn close(&mut self, cap: u32) {
        let faces = if self.body.solid { self.gaps.len() } else { 1 };
        for face in 0..faces {
            if let [Some(leaves), Some(returns)] = self.gaps[face]
                && leaves != returns
            {
                self.edges.push(Edge { ends: [leaves, returns], faces: [face as u32, cap] });
            }
        }
    }
}

//! The plane of a map, and where bodies meet it: the outline that maps are drawn over.
//!
//! A facet that crosses the plane leaves the line between the two points where its sides cross it.
//! One that lies in the plane leaves those of its sides that no other facet in the plane shares.

use std::collections::BTreeMap;

use fredholm_mesh::{Mesh, Vec3};

use super::MapAxis;

/// Distances below this share of the map's size count as none.
const ZERO_DISTANCE: f64 = 1e-9;
/// Cosine from which on an axis is that of the coordinates.
const ALONG_AXIS_COSINE: f64 = 1.0 - 1e-12;

/// The ends of a line on the axes of a map.
type Segment = [(f64, f64); 2];

/// A rectangle of points that a map is drawn over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPlane {
    origin: Vec3,
    sides: [Vec3; 2],
}

impl MapPlane {
    /// The plane of a grid of points, `columns` a row.
    #[must_use]
    pub fn of(points: &[Vec3], columns: usize) -> Option<Self> {
        let (first, last) = (points.first()?, points.get(columns.checked_sub(1)?)?);
        let top = points.get(points.len().checked_sub(columns)?)?;
        let sides = [*last - *first, *top - *first];
        (sides[0].cross(sides[1]).length() > 0.0).then_some(Self { origin: *first, sides })
    }

    /// Height over width.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        self.sides[1].length() / self.sides[0].length()
    }

    /// The axes: coordinates where the sides run along one, else distances from the first point, m.
    #[must_use]
    pub fn axes(&self) -> [MapAxis; 2] {
        std::array::from_fn(|i| {
            let (from, length) = (self.start(i), self.sides[i].length());
            let Some((axis, sign)) = self.coordinate(i) else {
                let label = format!("along side {}, m", i + 1);
                return MapAxis { label, from: 0.0, to: length };
            };
            MapAxis { label: format!("{}, m", ["x", "y", "z"][axis]), from, to: from + sign * length }
        })
    }

    /// The coordinate that a side runs along, and whether up or down.
    fn coordinate(&self, side: usize) -> Option<(usize, f64)> {
        let along = (self.sides[side] / self.sides[side].length()).to_array();
        (0..3).find(|&axis| along[axis].abs() >= ALONG_AXIS_COSINE).map(|axis| (axis, along[axis].signum()))
    }

    fn start(&self, side: usize) -> f64 {
        self.coordinate(side).map_or(0.0, |(axis, _)| self.origin.to_array()[axis])
    }

    /// Where a point stands on the axes.
    fn place(&self, point: Vec3) -> (f64, f64) {
        let along = |side: usize| {
            let distance = (point - self.origin).dot(self.sides[side] / self.sides[side].length());
            self.start(side) + self.coordinate(side).map_or(1.0, |(_, sign)| sign) * distance
        };
        (along(0), along(1))
    }

    /// The lines in which the facets of a mesh meet the plane, within the map.
    #[must_use]
    pub fn outline(&self, mesh: &Mesh) -> Vec<[(f64, f64); 2]> {
        let size = self.sides[0].length().max(self.sides[1].length());
        let normal = self.sides[0].cross(self.sides[1]);
        let normal = normal / normal.length();
        let mut flat: BTreeMap<[[i64; 2]; 2], (usize, Segment)> = BTreeMap::new();
        let mut lines = Vec::new();
        for patch in mesh.patches() {
            let corners = patch.corners();
            let heights: Vec<f64> = corners
                .iter()
                .map(|corner| (*corner - self.origin).dot(normal))
                .map(|height| if height.abs() <= ZERO_DISTANCE * size { 0.0 } else { height })
                .collect();
            let sides = (0..corners.len()).map(|i| (i, (i + 1) % corners.len()));
            if heights.iter().all(|height| *height == 0.0) {
                for (i, j) in sides {
                    let ends = [self.place(corners[i]), self.place(corners[j])];
                    let code = |(x, y): (f64, f64)| {
                        [x, y].map(|c| (c / (1e3 * ZERO_DISTANCE * size)).round() as i64)
                    };
                    let mut key = ends.map(code);
                    key.sort_unstable();
                    flat.entry(key).or_insert((0, ends)).0 += 1;
                }
                continue;
            }
            let crossing = sides.filter_map(|(i, j)| match (heights[i], heights[j]) {
                (0.0, _) => Some(corners[i]),
                (a, b) if a * b < 0.0 => Some(corners[i] + (corners[j] - corners[i]) * (a / (a - b))),
                _ => None,
            });
            let ends: Vec<(f64, f64)> = crossing.map(|point| self.place(point)).collect();
            lines.extend(ends.as_chunks::<2>().0);
        }
        lines.extend(flat.into_values().filter(|(count, _)| count % 2 == 1).map(|(_, ends)| ends));
        let window = self.axes().map(|axis| (axis.from.min(axis.to), axis.from.max(axis.to)));
        lines.into_iter().filter_map(|line| clipped(line, window)).collect()
    }
}

/// The part of a line within a window (B. Liang, B. Barsky, ACM TOG 3(1), 1984).
fn clipped([from, to]: [(f64, f64); 2], window: [(f64, f64); 2]) -> Option<[(f64, f64); 2]> {
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (start, step, (low, high)) in [(from.0, to.0 - from.0, window[0]), (from.1, to.1 - from.1, window[1])]
    {
        if step == 0.0 {
            if start < low || start > high {
                return None;
            }
        } else {
            let (a, b) = ((low - start) / step, (high - start) / step);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        }
    }
    let at = |t: f64| (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
    (first < last).then(|| [at(first), at(last)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::tests::grid;
    use fredholm_mesh::{MeshBuilder, Patch};

    fn length(lines: &[[(f64, f64); 2]]) -> f64 {
        lines.iter().map(|[a, b]| (a.0 - b.0).hypot(a.1 - b.1)).sum()
    }

    /// The plane y = `height` of points from (−1, −1) to (3, 2) in x and z.
    fn plane(height: f64) -> MapPlane {
        let point = |x, z| Vec3::new(x, height, z);
        MapPlane::of(&[point(-1.0, -1.0), point(3.0, -1.0), point(-1.0, 2.0), point(3.0, 2.0)], 2).unwrap()
    }

    #[test]
    fn a_crossing_sheet_is_a_line_and_a_flat_one_its_border() {
        let mut builder = MeshBuilder::default();
        builder.surface("sheet", 0);
        grid(&mut builder, &[0.0, 0.5, 1.0], &[0.0, 1.0]);
        let mesh = builder.build();
        // The sheet lies in z = 0; the plane y = ½ cuts it from x = 0 to 1.
        let cut = plane(0.5).outline(&mesh);
        assert!((length(&cut) - 1.0).abs() < 1e-12 && cut.iter().flatten().all(|p| p.1 == 0.0), "{cut:?}");
        assert!(plane(2.0).outline(&mesh).is_empty());
        let point = |x, y| Vec3::new(x, y, 0.0);
        let flat = [point(-2.0, -2.0), point(2.0, -2.0), point(-2.0, 2.0), point(2.0, 2.0)];
        let flat = MapPlane::of(&flat, 2).unwrap();
        assert!((length(&flat.outline(&mesh)) - 4.0).abs() < 1e-12, "without the line between the facets");
        assert_eq!(flat.axes()[0], MapAxis { label: "x, m".to_owned(), from: -2.0, to: 2.0 });
    }

    #[test]
    fn lines_end_at_the_border_of_the_map() {
        let mut builder = MeshBuilder::default();
        builder.surface("wall", 0);
        let corners = [[0.0, 0.0, -9.0], [0.0, 1.0, -9.0], [0.0, 1.0, 9.0]].map(Vec3::from_array);
        builder.face(&[Patch::triangle(corners).unwrap()]).unwrap();
        let cut = plane(0.75).outline(&builder.build());
        // The triangle is cut from z = −9 to 4.5; the map reaches from −1 to 2.
        assert!(cut.len() == 1 && (length(&cut) - 3.0).abs() < 1e-12, "{cut:?}");
    }
}

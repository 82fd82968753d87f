//! The patches of a scene, one array a quantity.
//!
//! Lengths are measured from the middle of the scene in a power of two near its extent: the
//! products of distances stay far from underflow, and no digit changes.

use fredholm_mesh::{Patch, Vec3};

/// Deviation from a parallelogram, relative to the diameter, that is rounding.
const SKEW_TOLERANCE: f64 = 1e-14;

/// A field of vectors, by components.
pub(super) type Vectors = [Vec<f64>; 3];

/// Shapes with a kernel of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outline {
    Parallelogram,
    Triangle,
    Quad,
}

/// Arrays over the patches; lengths in [`unit`](Self::unit).
#[derive(Clone, Debug, Default)]
pub(super) struct Patches {
    /// The unit of length, m.
    pub unit: f64,
    /// Rounding of coordinates.
    pub rounding: f64,
    /// Kind of outline.
    pub outline: Vec<Outline>,
    /// A point about the middle.
    pub centre: Vectors,
    /// Unit normal.
    pub normal: Vectors,
    /// Corners seen from the centre; a triangle repeats its last.
    pub corner: [Vectors; 4],
    /// Sides u, v of a parallelogram, from middle to middle of opposite sides.
    pub side: [Vectors; 2],
    /// Area.
    pub area: Vec<f64>,
    /// Largest distance of a corner from the centre.
    pub radius: Vec<f64>,
    /// Half the longest side.
    pub half: Vec<f64>,
    /// Largest distance of the middle of a side from the centre.
    pub middle: Vec<f64>,
    /// Circumference over area; 0 for a parallelogram, where the errors of opposite sides cancel.
    pub slenderness: Vec<f64>,
}

impl Patches {
    pub(super) fn new(patches: &[&Patch]) -> Self {
        let (origin, extent) = frame(patches);
        let unit = if extent > 0.0 { extent.log2().ceil().exp2() } else { 1.0 };
        let farthest = patches.iter().flat_map(|p| p.corners()).map(|x| x.abs().max_element());
        let rounding = farthest.fold(0.0, f64::max) / unit * f64::EPSILON;
        let mut all = Self { unit, rounding, ..Self::default() };
        for patch in patches {
            all.push(patch, origin);
        }
        all
    }

    fn push(&mut self, patch: &Patch, origin: Vec3) {
        let corners = [0, 1, 2, 3].map(|k| (patch.corner(k.min(patch.sides() - 1)) - origin) / self.unit);
        let outline = self.outline_of(patch, &corners);
        let centre = match outline {
            Outline::Parallelogram => (corners[0] + corners[2] + (corners[1] + corners[3])) * 0.25,
            Outline::Triangle => (corners[0] + corners[1] + corners[2]) / 3.0,
            Outline::Quad => (patch.centroid() - origin) / self.unit,
        };
        self.outline.push(outline);
        push(&mut self.centre, centre);
        push(&mut self.normal, patch.normal());
        let [a, b, c, d] = corners.map(|x| x - centre);
        self.corner.iter_mut().zip([a, b, c, d]).for_each(|(field, x)| push(field, x));
        push(&mut self.side[0], (b - a + (c - d)) * 0.5);
        push(&mut self.side[1], (d - a + (c - b)) * 0.5);
        self.push_sizes(patch, &[a, b, c, d][..patch.sides()], outline);
    }

    fn outline_of(&self, patch: &Patch, [a, b, c, d]: &[Vec3; 4]) -> Outline {
        let skew = (*a - *b + (*c - *d)).length();
        match patch.sides() {
            3 => Outline::Triangle,
            _ if skew <= SKEW_TOLERANCE * patch.diameter() / self.unit + 4.0 * self.rounding => {
                Outline::Parallelogram
            }
            _ => Outline::Quad,
        }
    }

    fn push_sizes(&mut self, patch: &Patch, corners: &[Vec3], outline: Outline) {
        let next = |k: usize| corners[(k + 1) % corners.len()];
        let largest = |of: &dyn Fn(usize) -> f64| (0..corners.len()).map(of).fold(0.0, f64::max);
        let area = patch.area() / (self.unit * self.unit);
        let circumference: f64 = (0..corners.len()).map(|k| corners[k].distance(next(k))).sum();
        self.area.push(area);
        self.radius.push(largest(&|k| corners[k].length()));
        self.half.push(0.5 * largest(&|k| corners[k].distance(next(k))));
        self.middle.push(0.5 * largest(&|k| (corners[k] + next(k)).length()));
        let straight = outline == Outline::Parallelogram;
        self.slenderness.push(if straight { 0.0 } else { circumference / area });
    }
}

/// The middle of the scene and the largest coordinate from there, m.
fn frame(patches: &[&Patch]) -> (Vec3, f64) {
    let corners = || patches.iter().flat_map(|patch| patch.corners());
    let low = corners().fold(Vec3::INFINITY, |low, x| low.min(*x));
    let high = corners().fold(Vec3::NEG_INFINITY, |high, x| high.max(*x));
    ((low + high) * 0.5, ((high - low) * 0.5).max_element())
}

fn push(field: &mut Vectors, x: Vec3) {
    field.iter_mut().zip(x.to_array()).for_each(|(component, value)| component.push(value));
}

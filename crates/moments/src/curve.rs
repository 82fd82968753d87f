//! Curved shapes that the triangles of a surface stand for.
//!
//! Meshes of spheres, cylinders and discs are polyhedra with the area of the true shape, their
//! corners a little outside of it. Functions of the first full order are on curved triangles:
//! corners are moved onto the true shape, and sides go through it in their middle.

use crate::{MomentsError, Surface};
use fredholm_mesh::Vec3;
use std::collections::BTreeMap;

/// A curved shape. Lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// A sphere.
    Sphere {
        /// Its centre.
        centre: Vec3,
        /// Its radius.
        radius: f64,
    },
    /// The side of a cylinder; its caps are flat.
    Cylinder {
        /// A point of its axis.
        base: Vec3,
        /// The direction of its axis, of any length.
        axis: Vec3,
        /// Its radius.
        radius: f64,
    },
    /// The rim of a disc.
    Disc {
        /// Its centre.
        centre: Vec3,
        /// Its radius.
        radius: f64,
    },
}

impl Curve {
    /// The point of it in the direction of a point.
    fn nearest(&self, p: Vec3) -> Vec3 {
        let out = |from: Vec3, radius: f64| from + (p - from).normalize_or_zero() * radius;
        match *self {
            Self::Sphere { centre, radius } | Self::Disc { centre, radius } => out(centre, radius),
            Self::Cylinder { base, axis, radius } => {
                let axis = axis.normalize_or_zero();
                out(base + axis * (p - base).dot(axis), radius)
            }
        }
    }

    /// Which sides of a triangle are on it; `border` says which of them no other triangle has.
    fn sides_on(&self, normal: Vec3, border: [bool; 3]) -> [bool; 3] {
        match *self {
            Self::Sphere { .. } => [true; 3],
            // The normals of the caps are along the axis.
            Self::Cylinder { axis, .. } => [normal.dot(axis.normalize_or_zero()).abs() < 0.5; 3],
            Self::Disc { .. } => border,
        }
    }
}

impl Surface {
    /// The same on the curved shapes that its triangles stand for; none of a triangle that is flat,
    /// as are those beyond the end of the list.
    ///
    /// # Errors
    /// [`MomentsError::Folded`] for triangles that are too coarse for their shape, and those of
    /// [`Surface::new`].
    pub fn on_curves(&self, curves: &[Option<Curve>]) -> Result<Self, MomentsError> {
        let mut vertices = self.vertices().to_vec();
        let mut sides: BTreeMap<[u32; 2], Curve> = BTreeMap::new();
        let mut uses: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        let side = |names: [u32; 3], i: usize| {
            let [a, b] = [names[i], names[(i + 1) % 3]];
            [a.min(b), a.max(b)]
        };
        for &names in self.triangles() {
            (0..3).for_each(|i| *uses.entry(side(names, i)).or_default() += 1);
        }
        for (triangle, (&names, curve)) in self.triangles().iter().zip(curves).enumerate() {
            let Some(curve) = curve else { continue };
            let border = [0, 1, 2].map(|i| uses.get(&side(names, i)) == Some(&1));
            let on = curve.sides_on(self.normal(triangle), border);
            for i in (0..3).filter(|&i| on[i]) {
                sides.insert(side(names, i), *curve);
                for vertex in [names[i], names[(i + 1) % 3]].map(|v| v as usize) {
                    vertices[vertex] = curve.nearest(self.vertices()[vertex]);
                }
            }
        }
        let moved = Self::new(vertices, self.triangles().to_vec())?;
        let middle = |[a, b]: [u32; 2]| {
            let ends = [a, b].map(|v| moved.vertices()[v as usize]);
            let straight = 0.5 * (ends[0] + ends[1]);
            sides.get(&[a, b]).map_or(straight, |curve| curve.nearest(straight))
        };
        moved.clone().curved(middle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshing::{curved_sphere, sphere};
    use fredholm_mesh::{Cutting, MeshBuilder, Shape};

    fn area(surface: &Surface) -> f64 {
        let rule = fredholm_quadrature::symmetric_triangle(8).unwrap();
        let at = |p: &fredholm_quadrature::PlanePoint| crate::element::shares([p.u, p.v]);
        (0..surface.triangles().len())
            .map(|t| rule.iter().map(|p| p.weight * surface.element(t).stretch(at(p))).sum::<f64>())
            .sum()
    }

    fn meshed(shape: &Shape) -> Surface {
        let mut builder = MeshBuilder::default();
        builder.surface("", 0);
        builder.add(shape, &Cutting::default()).unwrap();
        Surface::from_mesh(&builder.build()).unwrap()
    }

    #[test]
    fn spheres_are_those_of_the_generator() {
        let flat = sphere(0.7, 0.3).unwrap();
        let curve = Curve::Sphere { centre: Vec3::ZERO, radius: 0.7 };
        let curved = flat.on_curves(&vec![Some(curve); flat.triangles().len()]).unwrap();
        assert_eq!(curved.triangles(), curved_sphere(0.7, 0.3).unwrap().triangles());
        let exact = 4.0 * std::f64::consts::PI * 0.49;
        assert!((area(&curved) / exact - 1.0).abs() < 2e-4, "{}", area(&curved) / exact);
    }

    #[test]
    fn cylinders_and_discs_have_their_areas() {
        let (radius, axis) = (0.5, Vec3::new(0.2, 0.9, -0.3));
        let cylinder =
            Shape::Cylinder { base: Vec3::X, axis, radius, caps: true, inward: false, segments: 16 };
        let flat = meshed(&cylinder);
        let curve = Curve::Cylinder { base: Vec3::X, axis, radius };
        let curved = flat.on_curves(&vec![Some(curve); flat.triangles().len()]).unwrap();
        let pi = std::f64::consts::PI;
        let exact = 2.0 * pi * radius * (axis.length() + radius);
        assert!((area(&curved) / exact - 1.0).abs() < 1e-4, "{}", area(&curved) / exact);
        let disc = Shape::Disc { centre: Vec3::Y, normal: axis, radius, segments: 16 };
        let flat = meshed(&disc);
        let curve = Curve::Disc { centre: Vec3::Y, radius };
        let curved = flat.on_curves(&vec![Some(curve); flat.triangles().len()]).unwrap();
        assert!((area(&curved) / (pi * radius * radius) - 1.0).abs() < 1e-4, "{}", area(&curved));
    }
}

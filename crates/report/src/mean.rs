//! Area means over groups of leaves: x̄ = Σ Aᵢ xᵢ / Σ Aᵢ.

use crate::Field;

/// Area and area means of groups of leaves, for all bands.
pub(crate) struct Means {
    bands: usize,
    areas: Vec<f64>,
    integrals: Vec<f64>,
}

impl Means {
    /// Means of `values` (leaf-major) over the leaves of each of `groups` groups. Leaves are summed
    /// in their order.
    pub(crate) fn new(
        field: &Field<'_>,
        values: &[f64],
        groups: usize,
        group: impl Fn(usize) -> usize,
    ) -> Self {
        let bands = field.bands().len();
        let mut means = Self { bands, areas: vec![0.0; groups], integrals: vec![0.0; groups * bands] };
        for (leaf, patch) in field.mesh().patches().enumerate() {
            means.add(group(leaf), patch.area(), &values[leaf * bands..(leaf + 1) * bands]);
        }
        means
    }

    fn add(&mut self, group: usize, area: f64, row: &[f64]) {
        self.areas[group] += area;
        let integrals = &mut self.integrals[group * self.bands..(group + 1) * self.bands];
        integrals.iter_mut().zip(row).for_each(|(sum, value)| *sum += area * value);
    }

    /// Area of a group, m².
    pub(crate) fn area(&self, group: usize) -> f64 {
        self.areas[group]
    }

    /// Integral over a group in a band: W for a density in W/m².
    pub(crate) fn integral(&self, group: usize, band: usize) -> f64 {
        self.integrals[group * self.bands + band]
    }

    /// Mean over a group in a band; 0 for a group without leaves.
    pub(crate) fn mean(&self, group: usize, band: usize) -> f64 {
        if self.areas[group] > 0.0 { self.integral(group, band) / self.areas[group] } else { 0.0 }
    }
}

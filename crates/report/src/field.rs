//! A solved field: irradiance E and radiosity B = M + ρ E of every leaf element, W/m².

use fredholm_mesh::Mesh;

use crate::ReportError;

/// A solved field on the leaves of a mesh.
///
/// Vectors are leaf-major: leaf i, band l stands at i × bands + l. Units: W/m².
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    mesh: &'a Mesh,
    bands: &'a [String],
    irradiance: &'a [f64],
    radiosity: &'a [f64],
    exitance: Option<&'a [f64]>,
    exposed: Option<&'a [f64]>,
}

impl<'a> Field<'a> {
    /// A field of `mesh.len()` × `bands.len()` values of irradiance and of radiosity, W/m².
    ///
    /// # Errors
    /// [`ReportError::Length`] for a vector of another length, [`ReportError::NotFinite`] for NaN
    /// or infinity.
    pub fn new(
        mesh: &'a Mesh,
        bands: &'a [String],
        irradiance: &'a [f64],
        radiosity: &'a [f64],
    ) -> Result<Self, ReportError> {
        let field = Self { mesh, bands, irradiance, radiosity, exitance: None, exposed: None };
        field.check("irradiance", irradiance)?;
        field.check("radiosity", radiosity)?;
        Ok(field)
    }

    /// The field with its exitance M, W/m², of the same shape: it adds powers to the table of
    /// surfaces and tells the picture which elements are lamps.
    ///
    /// # Errors
    /// As for [`Field::new`].
    pub fn with_exitance(mut self, exitance: &'a [f64]) -> Result<Self, ReportError> {
        self.check("exitance", exitance)?;
        self.exitance = Some(exitance);
        Ok(self)
    }

    /// The field with the exposed share of each leaf, in [0, 1]: 1 but where an element is partly
    /// buried, as the floor is under a box. Values of the field are means over whole elements; the
    /// picture shows the exposed part.
    ///
    /// # Errors
    /// [`ReportError::Length`] for a vector that has not one share a leaf.
    pub fn with_exposed(mut self, exposed: &'a [f64]) -> Result<Self, ReportError> {
        let (expected, found) = (self.mesh.len(), exposed.len());
        if found != expected {
            return Err(ReportError::Length { what: "exposed shares", expected, found });
        }
        self.exposed = Some(exposed);
        Ok(self)
    }

    fn check(&self, what: &'static str, values: &[f64]) -> Result<(), ReportError> {
        let expected = self.mesh.len() * self.bands.len();
        if values.len() != expected {
            return Err(ReportError::Length { what, expected, found: values.len() });
        }
        match values.iter().position(|v| !v.is_finite()) {
            Some(at) => Err(self.not_finite(what, at, values[at])),
            None => Ok(()),
        }
    }

    fn not_finite(&self, what: &'static str, at: usize, value: f64) -> ReportError {
        let (element, band) = (at / self.bands.len(), self.bands[at % self.bands.len()].clone());
        ReportError::NotFinite { what, element, band, value }
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// Names of the bands.
    #[must_use]
    pub fn bands(&self) -> &'a [String] {
        self.bands
    }

    /// All irradiances, leaf-major, W/m².
    #[must_use]
    pub fn irradiance(&self) -> &'a [f64] {
        self.irradiance
    }

    /// All radiosities, leaf-major, W/m².
    #[must_use]
    pub fn radiosity(&self) -> &'a [f64] {
        self.radiosity
    }

    /// All exitances, leaf-major, W/m², where they are known.
    #[must_use]
    pub fn exitance(&self) -> Option<&'a [f64]> {
        self.exitance
    }

    /// Exposed share of leaf `leaf`; 1 where nothing is known of it.
    #[must_use]
    pub fn exposed(&self, leaf: usize) -> f64 {
        self.exposed.map_or(1.0, |shares| shares[leaf])
    }

    /// What a mean over all of a leaf is multiplied by for that over its exposed part: means of what
    /// is buried are 0, and stay so.
    pub(crate) fn over_exposed(&self, leaf: usize) -> f64 {
        let share = self.exposed(leaf);
        if share > 0.0 { 1.0 / share } else { 1.0 }
    }

    /// Radiosity of the exposed part of leaf `leaf`, M + (B − M)/w, in all bands, W/m².
    pub(crate) fn exposed_radiosity(&self, leaf: usize) -> Vec<f64> {
        let reflected_by = self.over_exposed(leaf);
        let exitance = |band: usize| self.exitance.map_or(0.0, |m| self.row(m, leaf)[band]);
        let mean = self.row(self.radiosity, leaf).iter().enumerate();
        mean.map(|(band, b)| exitance(band) + (b - exitance(band)) * reflected_by).collect()
    }

    /// Whether leaf `leaf` emits light by itself in any band.
    #[must_use]
    pub fn emits(&self, leaf: usize) -> bool {
        self.exitance.is_some_and(|m| self.row(m, leaf).iter().any(|&v| v > 0.0))
    }

    /// The values of one leaf in all bands.
    pub(crate) fn row(&self, values: &'a [f64], leaf: usize) -> &'a [f64] {
        let bands = self.bands.len();
        &values[leaf * bands..(leaf + 1) * bands]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use fredholm_mesh::{MeshBuilder, Patch, Vec3};

    /// A wall of nx × ny rectangles in the plane z = 0, one face each, lit towards +z, between the
    /// given lines.
    pub(crate) fn grid(builder: &mut MeshBuilder, xs: &[f64], ys: &[f64]) {
        for y in ys.windows(2) {
            for x in xs.windows(2) {
                let corner = |x: f64, y: f64| Vec3::new(x, y, 0.0);
                let corners =
                    [corner(x[0], y[0]), corner(x[1], y[0]), corner(x[1], y[1]), corner(x[0], y[1])];
                builder.face(&[Patch::quad(corners).unwrap().unwrap()]).unwrap();
            }
        }
    }

    /// Two surfaces with awkward names: two unit quads, and a triangle lit downwards.
    pub(crate) fn sample() -> Mesh {
        let mut builder = MeshBuilder::default();
        builder.surface("wall, \"north\"", 0);
        grid(&mut builder, &[0.0, 1.0, 2.0], &[0.0, 1.0]);
        builder.surface("<lamp & shade>", 1);
        let corners = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0 / 3.0, 0.0, 1.0)];
        builder.face(&[Patch::triangle(corners).unwrap()]).unwrap();
        builder.build()
    }

    pub(crate) fn names(bands: &[&str]) -> Vec<String> {
        bands.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn lengths_and_values_are_checked() {
        let (mesh, bands) = (sample(), names(&["r", "g"]));
        let good = [0.5; 6];
        assert!(Field::new(&mesh, &bands, &good, &good).is_ok());
        let short = Field::new(&mesh, &bands, &good, &good[1..]).unwrap_err().to_string();
        assert!(short.contains("radiosity has 5 values, but 6"), "{short}");
        let mut bad = good;
        bad[3] = f64::NAN;
        let text = Field::new(&mesh, &bands, &bad, &good).unwrap_err().to_string();
        assert!(text.contains("irradiance of element 1 in band g is NaN"), "{text}");
    }

    #[test]
    fn lamps_are_the_leaves_with_exitance() {
        let (mesh, bands) = (sample(), names(&["r", "g"]));
        let zero = [0.0; 6];
        let field = Field::new(&mesh, &bands, &zero, &zero).unwrap();
        assert!(!field.emits(1));
        let field = field.with_exitance(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]).unwrap();
        assert_eq!([0, 1, 2].map(|leaf| field.emits(leaf)), [false, true, false]);
    }
}

//! Form-factor methods by name: A_i F_ij = ∫_i ∫_j cosθ cosθ' V / (π r²) dA dA' (m²), each in its
//! own way, for study.
//!
//! M. F. Cohen, J. R. Wallace, *Radiosity and Realistic Image Synthesis*, Academic Press 1993,
//! chapter 4, compares most of them. A method is one file here and one line in [`methods`].
//! Assemblies use [`PairIntegrator`](crate::form_factor::PairIntegrator), which without a budget of
//! rows is called `auto` here.
//!
//! | name | what it computes | setting | converges to A_i F_ij |
//! |---|---|---|---|
//! | `centre` | the kernel between the centroids | none | no |
//! | `disc` | the same, the larger patch a disc | none | no |
//! | `area-gauss` | Gauss points on both patches | order | yes |
//! | `nystrom` | quadrature points of j, the centroid of i | order | no |
//! | `contour` | Stokes' theorem twice | tolerance | yes |
//! | `point-polygon` | Lambert's closed form inside, adaptive outside | tolerance | yes |
//! | `schroeder-hanrahan` | closed form of both integrals | none | yes |
//! | `monte-carlo` | random points and directions | samples, seed | in the mean |
//! | `hemicube` | pixels about the centroid of i | resolution | no |
//! | `auto` | the cheapest that meets the tolerance | tolerance | yes |
//!
//! A tolerance is relative to the exchange that the patches would have squarely facing each other,
//! A_i A_j / (π d²), or the smaller area where that is less. Errors are absolute, in m².

mod area_gauss;
mod auto;
mod centre;
mod contour;
mod dilogarithm;
mod disc;
mod error;
mod facing;
mod graded;
mod hemicube;
pub(crate) mod keyed;
mod monte_carlo;
mod nystrom;
mod orders;
mod pieces;
mod point_polygon;
mod schroeder_hanrahan;
mod setting;
mod skew_edges;

pub use dilogarithm::dilogarithm;
pub use error::MethodError;
pub use setting::Setting;

use fredholm_mesh::Patch;
use fredholm_quadrature::Estimate;
use fredholm_visibility::Occluders;

/// A_i F_ij with its estimated absolute error and what it cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evaluated {
    /// A_i F_ij, m²; never negative.
    pub value: f64,
    /// Estimated absolute error, m². Of `monte-carlo`: one standard error.
    pub error: f64,
    /// Evaluations of the innermost formula: point pairs (`centre`, `disc`, `area-gauss`,
    /// `nystrom`, `monte-carlo`), points (`point-polygon`), pairs of edges (`contour`,
    /// `schroeder-hanrahan`), pixels (`hemicube`); 1 where the method does not count (`auto`).
    pub evaluations: u64,
}

impl Evaluated {
    /// A factor is not negative: rounding below 0 becomes 0 and is added to the error.
    fn new(estimate: Estimate, evaluations: u64) -> Self {
        let below = (-estimate.value).max(0.0);
        Self { value: estimate.value.max(0.0), error: estimate.error + below, evaluations }
    }
}

/// One way to compute A_i F_ij of two patches.
pub trait FormFactorMethod: Send + Sync {
    /// The name it is chosen by.
    fn name(&self) -> &'static str;

    /// One line on what it does.
    fn summary(&self) -> &'static str;

    /// Whether a finer setting leads to A_i F_ij as closely as rounding lets it.
    fn convergent(&self) -> bool;

    /// The setting for everyday use.
    fn default_setting(&self) -> Setting;

    /// A_i F_ij (m²) of `a` (patch i) and `b` (patch j) behind `occluders`. Patches that do not
    /// face each other have 0.
    ///
    /// # Errors
    /// A setting of another kind or out of range, or occluders between the patches that the method
    /// cannot treat.
    fn exchange(
        &self,
        a: &Patch,
        b: &Patch,
        occluders: &Occluders,
        setting: Setting,
    ) -> Result<Evaluated, MethodError>;
}

/// All methods, the simplest first.
#[must_use]
pub fn methods() -> Vec<Box<dyn FormFactorMethod>> {
    vec![
        Box::new(centre::Centre),
        Box::new(disc::Disc),
        Box::new(area_gauss::AreaGauss),
        Box::new(nystrom::Nystrom),
        Box::new(contour::Contour),
        Box::new(point_polygon::PointPolygon),
        Box::new(schroeder_hanrahan::SchroederHanrahan),
        Box::new(monte_carlo::MonteCarlo),
        Box::new(hemicube::Hemicube),
        Box::new(auto::Auto),
    ]
}

/// The method of this name.
///
/// # Errors
/// [`MethodError::Unknown`], which lists the names.
///
/// ```
/// use fredholm_coupling::method::method;
/// use fredholm_mesh::{Patch, Vec3};
/// use fredholm_visibility::Occluders;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let floor = Patch::triangle([Vec3::ZERO, Vec3::X, Vec3::Y])?;
/// let ceiling = Patch::triangle([Vec3::Z, Vec3::Y + Vec3::Z, Vec3::X + Vec3::Z])?;
/// let closed = method("schroeder-hanrahan")?;
/// let exchange = closed.exchange(&floor, &ceiling, &Occluders::new(&[])?, closed.default_setting())?;
/// assert!((exchange.value / floor.area() - 0.115_049_228_1).abs() < 1e-10);
/// # Ok(())
/// # }
/// ```
pub fn method(name: &str) -> Result<Box<dyn FormFactorMethod>, MethodError> {
    methods().into_iter().find(|method| method.name() == name).ok_or_else(|| MethodError::Unknown {
        name: name.to_owned(),
        known: methods().iter().map(|method| method.name()).collect::<Vec<_>>().join(", "),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_finds_its_method_and_is_unique() {
        let all = methods();
        assert_eq!(all.len(), 10);
        for one in &all {
            assert_eq!(method(one.name()).unwrap().summary(), one.summary());
            assert_eq!(all.iter().filter(|other| other.name() == one.name()).count(), 1);
        }
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let Err(error) = method("zonal") else { panic!("there is no zonal method") };
        assert!(error.to_string().contains("schroeder-hanrahan"), "{error}");
    }
}

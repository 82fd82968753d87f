//! From bands to colour: linear sRGB (IEC 61966-2-1) as a fixed linear combination of the bands.
//!
//! - `r, g, b` or `red, green, blue`, in any order: the three channels themselves.
//! - wavelengths such as `540nm`: X = Σ wₗ x̄(λₗ) Bₗ with trapezoid weights wₗ over the sorted
//!   wavelengths, likewise Y and Z; each is scaled so that an equal-energy spectrum becomes the
//!   white of sRGB (D65).
//! - one band, or any other names: the mean of the bands, as grey.
//!
//! An equal value in all bands is the same value in all channels. Negative channels mark colours
//! outside sRGB.

use crate::cie::colour_matching;

/// Linear colour: red, green, blue.
pub(crate) type Rgb = [f64; 3];

/// White of sRGB: D65 at Y = 1 (IEC 61966-2-1).
const WHITE_POINT: [f64; 3] = [0.950_455_927_051_671_6, 1.0, 1.089_057_750_759_878_4];
/// XYZ to linear sRGB for the primaries and the white point of IEC 61966-2-1.
const XYZ_TO_SRGB: [[f64; 3]; 3] = [
    [3.240_969_941_904_521_4, -1.537_383_177_570_093_5, -0.498_610_760_293_003_3],
    [-0.969_243_636_280_879_8, 1.875_967_501_507_720_7, 0.041_555_057_407_175_61],
    [0.055_630_079_696_993_61, -0.203_976_958_888_976_57, 1.056_971_514_242_878_6],
];
/// Share of the best possible response below which wavelengths count as invisible.
const INVISIBLE_RESPONSE: f64 = 1e-3;

/// How bands mix into a colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Colouring {
    columns: Vec<Rgb>,
}

impl Colouring {
    /// The mixture for bands of these names.
    #[must_use]
    pub fn new(bands: &[String]) -> Self {
        let columns = channels(bands).or_else(|| spectrum(bands)).unwrap_or_else(|| grey(bands.len()));
        Self { columns }
    }

    /// Linear sRGB of 1 in each band.
    pub(crate) fn columns(&self) -> &[Rgb] {
        &self.columns
    }

    /// Linear sRGB of what is reflected of an irradiance in each band, in its unit.
    pub(crate) fn reflected(&self, reflectance: &[f64], irradiance: &[f64]) -> Rgb {
        self.mixed(reflectance.iter().zip(irradiance).map(|(rho, e)| rho * e))
    }

    /// Linear sRGB of a value in each band, in the unit of the values.
    ///
    /// # Examples
    /// ```
    /// use fredholm_report::Colouring;
    /// let bands = ["red", "green", "blue"].map(String::from);
    /// assert_eq!(Colouring::new(&bands).colour(&[3.0, 2.0, 1.0]), [3.0, 2.0, 1.0]);
    /// ```
    #[must_use]
    pub fn colour(&self, values: &[f64]) -> [f64; 3] {
        self.mixed(values.iter().copied())
    }

    fn mixed(&self, values: impl Iterator<Item = f64>) -> Rgb {
        self.columns.iter().zip(values).fold([0.0; 3], |sum, (column, value)| {
            [0, 1, 2].map(|channel| sum[channel] + column[channel] * value)
        })
    }
}

/// The sum of two colours.
pub(crate) fn sum(a: Rgb, b: Rgb) -> Rgb {
    [0, 1, 2].map(|i| a[i] + b[i])
}

fn grey(bands: usize) -> Vec<Rgb> {
    vec![[1.0 / bands.max(1) as f64; 3]; bands]
}

fn channels(bands: &[String]) -> Option<Vec<Rgb>> {
    let found: Vec<usize> = bands.iter().map(|name| channel(name)).collect::<Option<_>>()?;
    let complete = found.len() == 3 && (0..3).all(|channel| found.contains(&channel));
    let unit = |channel| [0, 1, 2].map(|i| f64::from(u8::from(i == channel)));
    complete.then(|| found.into_iter().map(unit).collect())
}

fn channel(name: &str) -> Option<usize> {
    match name.to_ascii_lowercase().as_str() {
        "r" | "red" => Some(0),
        "g" | "green" => Some(1),
        "b" | "blue" => Some(2),
        _ => None,
    }
}

/// The wavelength a name such as `540nm` stands for, nm.
fn wavelength(name: &str) -> Option<f64> {
    let number = name.strip_suffix("nm")?.trim_end();
    number.parse().ok().filter(|value: &f64| value.is_finite() && *value > 0.0)
}

fn spectrum(bands: &[String]) -> Option<Vec<Rgb>> {
    let wavelengths: Vec<f64> = bands.iter().map(|name| wavelength(name)).collect::<Option<_>>()?;
    let weights = trapezoid(&wavelengths)?;
    let responses: Vec<[f64; 3]> =
        wavelengths.iter().zip(&weights).map(|(&l, w)| colour_matching(l).map(|m| w * m)).collect();
    let white = responses.iter().fold([0.0; 3], |sum, r| [0, 1, 2].map(|i| sum[i] + r[i]));
    let visible = INVISIBLE_RESPONSE * weights.iter().sum::<f64>();
    let scaled = |r: &[f64; 3]| to_srgb([0, 1, 2].map(|i| r[i] / white[i] * WHITE_POINT[i]));
    white.iter().all(|&sum| sum > visible).then(|| responses.iter().map(scaled).collect())
}

/// Weights of the trapezoid rule for points in any order; `None` for fewer than two distinct
/// points.
fn trapezoid(points: &[f64]) -> Option<Vec<f64>> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&i, &j| points[i].total_cmp(&points[j]));
    let mut weights = vec![0.0; points.len()];
    for pair in order.windows(2) {
        let half = 0.5 * (points[pair[1]] - points[pair[0]]);
        weights[pair[0]] += half;
        weights[pair[1]] += half;
    }
    weights.iter().any(|&w| w > 0.0).then_some(weights)
}

fn to_srgb(xyz: [f64; 3]) -> Rgb {
    XYZ_TO_SRGB.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;
    use crate::field::tests::names;

    fn wavelengths(step: usize) -> Vec<String> {
        (380..=780).step_by(step).map(|l| format!("{l}nm")).collect()
    }

    fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance), "{a:?} {b:?}");
    }

    #[test]
    fn equal_energy_is_white() {
        for step in [5, 10, 20, 40] {
            let bands = wavelengths(step);
            close(Colouring::new(&bands).colour(&vec![2.0; bands.len()]), [2.0; 3], 1e-6);
        }
    }

    #[test]
    fn the_matrix_takes_white_to_white_and_red_to_its_chromaticity() {
        close(to_srgb(WHITE_POINT), [1.0; 3], 1e-12);
        // Red primary of sRGB: chromaticity (0.64, 0.33), luminance 0.2126.
        let y = 0.212_639;
        close(to_srgb([0.64 / 0.33 * y, y, 0.03 / 0.33 * y]), [1.0, 0.0, 0.0], 1e-5);
    }

    #[test]
    fn single_wavelengths_have_their_hue() {
        let bands = wavelengths(10);
        let colour = |wanted: &str| {
            let values: Vec<f64> = bands.iter().map(|b| f64::from(u8::from(b == wanted))).collect();
            Colouring::new(&bands).colour(&values)
        };
        let largest = |c: [f64; 3]| (0..3).max_by(|&i, &j| c[i].total_cmp(&c[j])).unwrap();
        assert_eq!([650, 530, 450].map(|l| largest(colour(&format!("{l}nm")))), [0, 1, 2]);
    }

    #[test]
    fn the_order_of_wavelengths_does_not_matter() {
        let bands = wavelengths(20);
        let values: Vec<f64> = (0..bands.len()).map(|i| i as f64).collect();
        let (mut back, mut values_back) = (bands.clone(), values.clone());
        back.reverse();
        values_back.reverse();
        close(Colouring::new(&bands).colour(&values), Colouring::new(&back).colour(&values_back), 1e-12);
    }

    #[test]
    fn trapezoid_weights_integrate_a_line() {
        let points = [2.0, 0.0, 1.5];
        let weights = trapezoid(&points).unwrap();
        let integral: f64 = points.iter().zip(&weights).map(|(x, w)| w * (3.0 * x + 1.0)).sum();
        assert!((integral - 8.0).abs() < 1e-15, "{integral}");
    }

    #[test]
    fn names_choose_the_mixture() {
        let colour = |bands: &[&str], values: &[f64]| Colouring::new(&names(bands)).colour(values);
        assert_eq!(colour(&["b", "R", "g"], &[1.0, 2.0, 3.0]), [2.0, 3.0, 1.0]);
        assert_eq!(colour(&["grey"], &[0.7]), [0.7; 3]);
        assert_eq!(colour(&["540nm"], &[0.7]), [0.7; 3]);
        assert_eq!(colour(&["540nm", "540nm"], &[1.0, 2.0]), [1.5; 3]);
        assert_eq!(colour(&["r", "r", "g"], &[1.0, 2.0, 6.0]), [3.0; 3]);
        assert_eq!(colour(&["8000nm", "9000nm"], &[1.0, 3.0]), [2.0; 3]);
        assert_eq!(colour(&["low", "high"], &[1.0, 3.0]), [2.0; 3]);
    }
}

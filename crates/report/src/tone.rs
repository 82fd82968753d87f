//! Tone mapping: from unbounded linear colour to display values.
//!
//! The luminance L = 0.2126 R + 0.7152 G + 0.0722 B is scaled by the exposure and compressed by L′
//! = L (1 + L/w²)/(1 + L), so that w becomes white (E. Reinhard, M. Stark, P. Shirley, J. Ferwerda,
//! "Photographic tone reproduction for digital images", 2002, DOI 10.1145/566654.566575, eq. 4).
//! The channels are scaled alike, which keeps the hue; a colour that is then too bright for its
//! channel is mixed with white of the same luminance. Display values are encoded by the curve of
//! sRGB (IEC 61966-2-1).

use crate::ReportError;
use crate::colour::Rgb;

/// Exposed luminance that becomes white.
const WHITE_LUMINANCE: f64 = 4.0;
/// Display luminance of the mean of the picture: mid grey.
const MID_GREY: f64 = 0.18;
/// Luminance, relative to the mean, below which darkness does not lengthen the exposure further.
const LUMINANCE_FLOOR: f64 = 1e-2;
/// Coefficients of luminance in linear sRGB.
const LUMINANCE_WEIGHTS: Rgb = [0.2126, 0.7152, 0.0722];

/// How bright a picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposure {
    /// The mean of log luminance over the visible surfaces, lamps left out, becomes mid grey.
    #[default]
    Auto,
    /// Radiosity is multiplied by this factor, m²/W; about 0.2 becomes mid grey.
    Fixed(f64),
}

/// A chosen exposure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tone {
    exposure: f64,
}

impl Tone {
    /// The tone for an exposure; `metered` are the luminances that an automatic one goes by.
    pub(crate) fn new(exposure: Exposure, metered: &[f64]) -> Result<Self, ReportError> {
        match exposure {
            Exposure::Auto => Ok(Self { exposure: automatic(metered) }),
            Exposure::Fixed(value) if value.is_finite() && value > 0.0 => Ok(Self { exposure: value }),
            Exposure::Fixed(value) => Err(ReportError::Exposure { value }),
        }
    }

    /// The factor that colours are multiplied by first, m²/W.
    pub(crate) fn exposure(self) -> f64 {
        self.exposure
    }

    /// Linear display values from 0 to 1.
    pub(crate) fn display(self, colour: Rgb) -> Rgb {
        let colour = colour.map(|c| c.max(0.0) * self.exposure);
        let bright = luminance(colour);
        if bright <= 0.0 {
            return [0.0; 3];
        }
        let target = compress(bright).min(1.0);
        into_gamut(colour.map(|c| c * (target / bright)), target)
    }
}

/// Luminance of a linear colour, negative channels taken as 0.
pub(crate) fn luminance(colour: Rgb) -> f64 {
    (0..3).map(|i| LUMINANCE_WEIGHTS[i] * colour[i].max(0.0)).sum()
}

fn automatic(metered: &[f64]) -> f64 {
    let mean = metered.iter().sum::<f64>() / metered.len().max(1) as f64;
    if mean <= 0.0 || !mean.is_finite() {
        return 1.0;
    }
    let logs: f64 = metered.iter().map(|l| l.max(LUMINANCE_FLOOR * mean).ln()).sum();
    expand(MID_GREY) / (logs / metered.len() as f64).exp()
}

fn compress(bright: f64) -> f64 {
    if bright >= WHITE_LUMINANCE {
        1.0
    } else {
        bright * (1.0 + bright / (WHITE_LUMINANCE * WHITE_LUMINANCE)) / (1.0 + bright)
    }
}

/// The luminance that [`compress`] takes to `y`.
fn expand(y: f64) -> f64 {
    let (w2, b) = (WHITE_LUMINANCE * WHITE_LUMINANCE, 1.0 - y);
    0.5 * w2 * ((b * b + 4.0 * y / w2).sqrt() - b)
}

fn into_gamut(colour: Rgb, target: f64) -> Rgb {
    let largest = colour.iter().copied().fold(0.0, f64::max);
    if largest <= 1.0 {
        return colour;
    }
    let keep = (1.0 - target) / (largest - target);
    colour.map(|c| target + keep * (c - target))
}

/// The sRGB code of a linear display value.
pub(crate) fn encode(value: f64) -> u8 {
    let value = value.clamp(0.0, 1.0);
    let curved = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
    (255.0 * curved).round() as u8
}

/// The linear display value of a code of sRGB.
pub(crate) fn decode(code: u8) -> f64 {
    let value = f64::from(code) / 255.0;
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these values are exact")]
mod tests {
    use super::*;

    #[test]
    fn a_uniform_picture_is_mid_grey() {
        for level in [1e-6, 1.0, 3e7] {
            let tone = Tone::new(Exposure::Auto, &[level; 5]).unwrap();
            for channel in tone.display([level; 3]) {
                assert!((channel - MID_GREY).abs() < 1e-12, "{channel}");
            }
        }
    }

    #[test]
    fn the_curve_rises_to_white() {
        let steps: Vec<f64> = (0..=400).map(|i| compress(f64::from(i) * 0.01)).collect();
        assert!(steps.windows(2).all(|w| w[1] > w[0]));
        assert!((steps[400] - 1.0).abs() < 1e-12 && steps[0] == 0.0);
        assert!((compress(expand(0.5)) - 0.5).abs() < 1e-14);
    }

    #[test]
    fn codes_come_back() {
        assert!((0..=255).all(|code| encode(decode(code)) == code));
    }

    #[test]
    fn hue_is_kept() {
        let tone = Tone::new(Exposure::Fixed(1.0), &[]).unwrap();
        let [r, g, b] = tone.display([0.4, 0.2, 0.1]);
        assert!((r / g - 2.0).abs() < 1e-12 && (g / b - 2.0).abs() < 1e-12);
        // Too bright for its channel: paler, but of the same hue and luminance.
        let bright = [9.0, 1.0, 0.5];
        let [r, g, b] = tone.display(bright);
        assert!((r - 1.0).abs() < 1e-12 && r > g && g > b && b > 0.0);
        assert!(((g - b) / (r - b) - 0.5 / 8.5).abs() < 1e-12);
        assert!((luminance([r, g, b]) - compress(luminance(bright))).abs() < 1e-12);
    }

    #[test]
    fn darkness_and_bad_exposures() {
        assert_eq!(Tone::new(Exposure::Auto, &[]).unwrap().display([0.0, -1.0, 0.0]), [0.0; 3]);
        assert_eq!(Tone::new(Exposure::Auto, &[0.0]).unwrap().display([-1.0; 3]), [0.0; 3]);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Tone::new(Exposure::Fixed(value), &[]).is_err());
        }
    }

    #[test]
    fn codes_of_srgb() {
        // From the decoding formula of the standard: code 118 is 0.1812, code 188 is 0.5029, code
        // 10 is 0.003035.
        for (linear, code) in
            [(0.0, 0), (0.003_035, 10), (0.1812, 118), (0.5029, 188), (1.0, 255), (7.0, 255)]
        {
            assert_eq!(encode(linear), code);
        }
    }
}

//! The picture of a solution with the light of lamps taken at every pixel: B(x) = M + ρ (Σ_g M_g F(x→g) + E_r(x)).
//!
//! F are factors of what the point sees of each lamp, so that shadows have their true borders whatever the elements; E_r is the rest of the irradiance, E − E_d with the part E_d that the
//! solution itself has straight from the lamps, interpolated between the corners of elements of one surface: so no light passes under walls or blocks.
//!
//! Every pixel is first looked at through its middle. One whose neighbours show another plane, surface or brightness is then the mean of [`FINE`] points of a lattice: borders of bodies, of lamps and of
//! shadows are smooth (adaptive supersampling, T. Whitted, CACM 23(6), 1980, doi:10.1145/358876.358882). W/m².

use rayon::prelude::*;

use fredholm_mesh::Vec3;

use super::{BACKGROUND, Picture};
use crate::colour::{Colouring, Rgb};
use crate::shading::Shading;
use crate::tone::{Exposure, Tone, encode, luminance};
use crate::{Camera, Eye, Field, ReportError};

/// Points of a pixel at a border, and the generator of their lattice.
const FINE: usize = 16;
const GENERATOR: usize = 7;
/// Difference of linear display values between neighbours, over the larger, from which there is a border; and of
/// values so dark that none is seen.
const STEP: f64 = 0.06;
const DARK: f64 = 0.01;
/// Cosine, less than 1 by this, up to which two elements have one normal.
const TURN: f64 = 1e-9;
/// How often the corners are moved towards the means of elements where the rest is smooth.
const PASSES: usize = 3;
/// No leaf.
const NOTHING: u32 = u32::MAX;

/// Tells the factors from a point (m) of a leaf to what it sees of each lamp.
pub type Lighter<'a> = Box<dyn FnMut(usize, Vec3, &mut [f64]) + 'a>;

/// Looks at the lamps of a scene.
pub trait LampLight: Sync {
    /// Number of lamps.
    fn lamps(&self) -> usize;

    /// Looks for one thread.
    fn lighter(&self) -> Lighter<'_>;
}

/// What a solution is drawn with.
pub struct Lit<'a> {
    /// The lamps.
    pub light: &'a dyn LampLight,
    /// Exitance of each lamp, lamps × bands, W/m².
    pub exitance: &'a [f64],
    /// Reflectance of the leaves, leaves × bands.
    pub reflectance: &'a [f64],
    /// The part of the irradiance of the leaves that the solution has straight from these lamps, leaves × bands, W/m²;
    /// none where there are no lamps that are told apart: then all of it is interpolated.
    pub direct: Option<&'a [f64]>,
}

/// A picture, and what it was made with.
pub struct LitPicture {
    /// The picture.
    pub picture: Picture,
    /// Linear sRGB of its pixels, W/m², rows from the top, 0 where nothing is seen; empty unless asked for.
    pub linear: Vec<[f32; 3]>,
    /// The factor that radiosity was multiplied by before tone mapping, m²/W.
    pub exposure: f64,
}

/// A leaf and its linear colour as seen through the middle of a pixel.
#[derive(Clone, Copy)]
struct Middle {
    leaf: u32,
    colour: [f32; 3],
}

/// Draws one view.
pub(super) struct LitView<'a> {
    field: Field<'a>,
    eye: &'a Eye,
    lit: &'a Lit<'a>,
    rest: Shading<'a>,
    /// Linear sRGB of ρ M for each surface and lamp.
    sent: Vec<Rgb>,
}

/// Colours points for one thread.
type Brush<'a> = Box<dyn FnMut(usize, Vec3) -> Rgb + 'a>;

impl<'a> LitView<'a> {
    pub fn new(field: Field<'a>, eye: &'a Eye, lit: &'a Lit<'a>) -> Result<Self, ReportError> {
        let (mesh, bands) = (field.mesh(), field.bands().len());
        let lengths = [
            ("reflectance", mesh.len() * bands, lit.reflectance.len()),
            ("direct irradiance", mesh.len() * bands, lit.direct.map_or(mesh.len() * bands, <[f64]>::len)),
            ("exitance of lamps", lit.light.lamps() * bands, lit.exitance.len()),
        ];
        for (what, expected, found) in lengths {
            if expected != found {
                return Err(ReportError::Length { what, expected, found });
            }
        }
        let colouring = Colouring::new(field.bands());
        let mut sent = vec![[0.0; 3]; mesh.surfaces().len() * lit.light.lamps()];
        // All leaves of a surface have one material.
        for leaf in 0..mesh.len() {
            let rho = field.row(lit.reflectance, leaf);
            for (lamp, m) in lit.exitance.chunks_exact(bands).enumerate() {
                let sent = &mut sent[mesh.surface_of(leaf) * lit.light.lamps() + lamp];
                if sent.iter().all(|part| *part == 0.0) {
                    let both: Vec<f64> = rho.iter().zip(m).map(|(rho, m)| rho * m).collect();
                    *sent = colouring.colour(&both);
                }
            }
        }
        let part = |leaf: usize, band: usize| {
            let at = leaf * bands + band;
            lit.direct.map_or(0.0, |direct| lit.reflectance[at] * direct[at])
        };
        let rest = Shading::of_rest(field, if lit.direct.is_some() { PASSES } else { 0 }, part);
        Ok(Self { field, eye, lit, rest, sent })
    }

    fn brush(&self) -> Brush<'_> {
        let lamps = self.lit.light.lamps();
        let mut factors = vec![0.0; lamps];
        let mut look = self.lit.light.lighter();
        Box::new(move |leaf, point| {
            look(leaf, point, &mut factors);
            let surface = self.field.mesh().surface_of(leaf);
            let sent = &self.sent[surface * lamps..(surface + 1) * lamps];
            let rest = self.rest.colour(leaf, point);
            factors.iter().zip(sent).fold(rest, |sum, (f, c)| [0, 1, 2].map(|i| sum[i] + f * c[i]))
        })
    }

    /// The picture, with its linear colours where these are wanted.
    pub fn draw(&self, exposure: Exposure, linear: bool) -> Result<LitPicture, ReportError> {
        let Camera { width, height, .. } = *self.eye.camera();
        let (w, h) = (width as usize, height as usize);
        let nothing = Middle { leaf: NOTHING, colour: [0.0; 3] };
        let mut middles = vec![nothing; w * h];
        middles.par_chunks_mut(w).enumerate().for_each(|(y, row)| {
            let mut brush = self.brush();
            for (x, middle) in row.iter_mut().enumerate() {
                if let Some((leaf, point)) = self.eye.hit(x as f64 + 0.5, y as f64 + 0.5) {
                    *middle = Middle { leaf: leaf as u32, colour: brush(leaf, point).map(|c| c as f32) };
                }
            }
        });
        let tone = Tone::new(exposure, &self.metered(&middles))?;
        let mut colours = vec![[0.0_f32; 3]; if linear { w * h } else { 0 }];
        let mut pixels = vec![0; 3 * w * h];
        let paint = |brush: &mut Brush, x: usize, y: usize| {
            let middle = &middles[y * w + x];
            if self.is_border(&middles, (w, h), (x, y), tone) {
                self.supersampled((x, y), tone, brush)
            } else if middle.leaf == NOTHING {
                ([BACKGROUND; 3], [0.0; 3])
            } else {
                let colour = middle.colour.map(f64::from);
                (tone.display(colour), colour)
            }
        };
        let rows = pixels.par_chunks_mut(3 * w).enumerate();
        if linear {
            rows.zip(colours.par_chunks_mut(w)).for_each(|((y, row), colours)| {
                let mut brush = self.brush();
                for (x, (pixel, exact)) in row.chunks_exact_mut(3).zip(colours).enumerate() {
                    let (shown, seen) = paint(&mut brush, x, y);
                    pixel.copy_from_slice(&shown.map(encode));
                    *exact = seen.map(|c| c as f32);
                }
            });
        } else {
            rows.for_each(|(y, row)| {
                let mut brush = self.brush();
                for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
                    pixel.copy_from_slice(&paint(&mut brush, x, y).0.map(encode));
                }
            });
        }
        let picture = Picture { width, height, pixels };
        Ok(LitPicture { picture, linear: colours, exposure: tone.exposure() })
    }

    /// Luminances that an automatic exposure goes by: of lit surfaces, or of lamps where there is nothing else.
    fn metered(&self, middles: &[Middle]) -> Vec<f64> {
        let seen = || middles.iter().filter(|middle| middle.leaf != NOTHING);
        let of = |lamps: bool| -> Vec<f64> {
            let of = seen().filter(|middle| self.field.emits(middle.leaf as usize) == lamps);
            of.map(|middle| luminance(middle.colour.map(f64::from))).collect()
        };
        let lit = of(false);
        if lit.is_empty() { of(true) } else { lit }
    }

    /// Whether a neighbour of a pixel shows something else.
    fn is_border(
        &self,
        middles: &[Middle],
        (w, h): (usize, usize),
        (x, y): (usize, usize),
        tone: Tone,
    ) -> bool {
        let own = &middles[y * w + x];
        let shown = |middle: &Middle| match middle.leaf {
            NOTHING => [BACKGROUND; 3],
            _ => tone.display(middle.colour.map(f64::from)),
        };
        let colour = shown(own);
        let (xs, ys) = (x.saturating_sub(1)..=(x + 1).min(w - 1), y.saturating_sub(1)..=(y + 1).min(h - 1));
        ys.flat_map(|v| xs.clone().map(move |u| v * w + u)).any(|at| {
            let other = &middles[at];
            if !self.is_alike(own.leaf, other.leaf) {
                return true;
            }
            let beside = shown(other);
            (0..3).any(|i| (colour[i] - beside[i]).abs() > STEP * colour[i].max(beside[i]).max(DARK / STEP))
        })
    }

    /// Whether two leaves lie on one plane of one surface.
    fn is_alike(&self, a: u32, b: u32) -> bool {
        if a == b {
            return true;
        }
        if a == NOTHING || b == NOTHING {
            return false;
        }
        let mesh = self.field.mesh();
        let (a, b) = (a as usize, b as usize);
        let [p, q] = [a, b].map(|leaf| mesh.patch(leaf));
        mesh.surface_of(a) == mesh.surface_of(b)
            && p.normal().dot(q.normal()) > 1.0 - TURN
            && (q.corner(0) - p.corner(0)).dot(p.normal()).abs() <= TURN * (p.diameter() + q.diameter())
    }

    /// The display value and the linear colour of a pixel from points of a lattice.
    fn supersampled(&self, (x, y): (usize, usize), tone: Tone, brush: &mut Brush) -> (Rgb, Rgb) {
        let place = |i: usize| (i as f64 + 0.5) / FINE as f64;
        let (mut shown, mut seen) = ([0.0; 3], [0.0; 3]);
        for k in 0..FINE {
            let at = (x as f64 + place(k), y as f64 + place(GENERATOR * k % FINE));
            let colour = self.eye.hit(at.0, at.1).map(|(leaf, point)| brush(leaf, point));
            let display = colour.map_or([BACKGROUND; 3], |colour| tone.display(colour));
            let colour = colour.unwrap_or_default();
            shown = [0, 1, 2].map(|i| shown[i] + display[i] / FINE as f64);
            seen = [0, 1, 2].map(|i| seen[i] + colour[i] / FINE as f64);
        }
        (shown, seen)
    }
}

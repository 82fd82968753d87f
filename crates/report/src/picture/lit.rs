//! The picture of a solution with the light of lamps taken at every pixel: B(x) = M + ρ (Σ_g M_g
//! F(x→g) + E_r(x)).
//!
//! F are factors of what the point sees of each lamp, so that shadows have their true borders
//! whatever the elements; E_r is the rest of the irradiance, E − E_d with the part E_d that the
//! solution itself has straight from the lamps, interpolated between the corners of elements of one
//! surface: so no light passes under walls or blocks. Or it is gathered ([`super::gathered`]), at
//! all pixels or where elements are too large for it. Factors may have errors that are known and
//! independent from point to point; their light is smoothed ([`super::smoothed`]).
//!
//! Every pixel is first looked at through its middle. One whose neighbours show another plane,
//! surface or brightness is then the mean of [`POINTS_OF_A_PIXEL`] points of a lattice: borders of
//! bodies, of lamps and of shadows are smooth (adaptive supersampling, T. Whitted, CACM 23(6),
//! 1980, doi:10.1145/358876.358882). W/m².

use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use fredholm_mesh::Vec3;

use super::gathered::{Candidate, Gathered, Gathering, Quality, Sent};
use super::smoothed::smoothed;
use super::{BACKGROUND, Picture};
use crate::colour::{Colouring, Rgb, sum};
use crate::shading::Shading;
use crate::tone::{Exposure, Tone, encode, luminance};
use crate::{Camera, Eye, Field, ReportError};

/// Points of a pixel at a border, and the generator of their lattice.
const POINTS_OF_A_PIXEL: usize = 16;
const GENERATOR: usize = 7;
/// One of so many of them has its own light of the lamps, of those that show one leaf: the border
/// itself needs more points than the light on either side of it.
const POINTS_OF_A_LIGHT: usize = 4;
/// The points that tell what share of a pixel at a border each plane has.
#[derive(Clone, Copy)]
struct BorderLattice {
    /// Luminance of the brightest over that of the darkest sample from which on it is taken.
    ratio: f64,
    /// Points and generator: those of Fibonacci tell the share of a half-plane evenly well whatever
    /// its direction.
    points: usize,
    generator: usize,
}

/// At the border of a lamp, which else has steps in linear colours.
const LAMP_LATTICE: BorderLattice = BorderLattice { ratio: 8.0, points: 233, generator: 144 };
const USUAL_LATTICE: BorderLattice = BorderLattice { ratio: 1.2, points: 34, generator: 21 };
/// Where all light is gathered: these shares are most of what a pixel is off there.
const GATHERED_LATTICE: BorderLattice = BorderLattice { ratio: 1.05, points: 55, generator: 34 };
/// Points for each plane in the samples of a pixel from which on they tell the shares: of the many
/// planes of small facets they would miss some.
const LEAST_POINTS_OF_A_PLANE: usize = 8;
/// Difference of the colours around a point, over the larger, up to which its own is their mean.
const ALIKE_DIFFERENCE: f64 = 0.03;
/// Second difference of colours of every other pixel, over the larger, up to which what lies
/// between two of them is interpolated: the parabola takes an eighth of it away.
const MOST_BEND: f64 = 0.04;
/// Pixels in a row of a tile.
const TILE_SIDE: usize = 64;
/// Pixels at borders that are looked at together.
const PIXELS_TOGETHER: usize = 64;
/// Difference of linear display values between neighbours, over the larger, from which there is a
/// border; and of values so dark that none is seen.
const BORDER_STEP: f64 = 0.06;
/// The same between neighbours on different planes or surfaces.
const EDGE_STEP: f64 = 0.02;
const UNSEEN_DIFFERENCE: f64 = 0.01;
/// Cosine, less than 1 by this, up to which two elements have one normal.
const COSINE_TOLERANCE: f64 = 1e-9;
/// By how much the light without that of the lamps bends between elements, over all that an element
/// sends on, from which on it is too large for that light.
const UNEVEN_SHARE: f64 = 0.03;
/// How exact all that is gathered has to be, and what is gathered only where it is uneven.
const EVERYWHERE: Quality = Quality { error: 0.005, reach: 0.2 };
const WHERE_UNEVEN: Quality = Quality { error: 0.01, reach: 0.35 };
/// How often the corners are moved towards the means of elements where the rest is smooth.
const CORNER_PASSES: usize = 3;
/// From where to where on the way of a picture the lamps are looked at, and pixels painted; light
/// is gathered between.
const LOOKED: [f64; 2] = [0.0, 0.4];
const PAINTED: [f64; 2] = [0.6, 1.0];
/// No leaf.
const NO_LEAF: u32 = u32::MAX;

/// Factors from points to what they see of each lamp, points × lamps.
#[derive(Clone, Debug, Default)]
pub struct LampFactors {
    /// The factors.
    pub values: Vec<f64>,
    /// Standard errors of them, which are independent from point to point; 0 where they are exact.
    pub errors: Vec<f64>,
}

impl LampFactors {
    /// As many factors of 0.
    pub(super) fn reset(&mut self, count: usize) {
        for list in [&mut self.values, &mut self.errors] {
            list.clear();
            list.resize(count, 0.0);
        }
    }
}

/// Tells the factors of points (m) of a leaf, which are 0 before.
pub type Lighter<'a> = Box<dyn FnMut(usize, &[Vec3], &mut LampFactors) + 'a>;

/// What is looked through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// Its middle.
    One,
    /// Several points, of which the mean is taken.
    Several,
    /// A point of which the number is told.
    Told,
}

/// Looks at the lamps of a scene.
pub trait LampLight: Sync {
    /// Number of lamps.
    fn lamps(&self) -> usize;

    /// Looks for one thread; at pixels of one point each, at pixels of several points, where less
    /// exact factors are enough, or at points that need better ones.
    fn lighter(&self, points: Points) -> Lighter<'_>;

    /// The picture has come to `share`, 0 to 1, of its way.
    fn advance(&self, _share: f64) {}

    /// Whether the picture is still wanted; asked often.
    fn go_on(&self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// No lamps: all light is interpolated.
pub(super) struct Unlit;

impl LampLight for Unlit {
    fn lamps(&self) -> usize {
        0
    }

    fn lighter(&self, _points: Points) -> Lighter<'_> {
        Box::new(|_, _, _| {})
    }
}

/// What a solution is drawn with.
pub struct Lit<'a> {
    /// The lamps.
    pub light: &'a dyn LampLight,
    /// Exitance of each lamp, lamps × bands, W/m².
    pub exitance: &'a [f64],
    /// Reflectance of the leaves, leaves × bands.
    pub reflectance: &'a [f64],
    /// The part of the irradiance of the leaves that the solution has straight from these lamps,
    /// leaves × bands, W/m²; none where there are no lamps that are told apart: then all of it is
    /// interpolated.
    pub direct: Option<&'a [f64]>,
    /// What gathers the rest, and where.
    pub gathering: Option<(&'a dyn Gathering, Where)>,
}

/// Where the rest of the light is gathered, and not interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Where {
    /// At all pixels.
    Everywhere,
    /// Where it bends so much between elements that they are too large for it.
    Uneven,
}

/// A picture, and what it was made with.
pub struct LitPicture {
    /// The picture.
    pub picture: Picture,
    /// Linear sRGB of its pixels, W/m², rows from the top, 0 where nothing is seen; empty unless
    /// asked for.
    pub linear: Vec<[f32; 3]>,
    /// Standard error of the linear colours at the middles of the pixels, for what is gathered;
    /// empty unless light was gathered.
    pub standard_error: Vec<[f32; 3]>,
    /// Number of places at which light was gathered.
    pub places: usize,
    /// Whether all of it was drawn: else borders are not smooth, and light is interpolated where it
    /// was not yet gathered.
    pub whole: bool,
    /// The factor that radiosity was multiplied by before tone mapping, m²/W.
    pub exposure: f64,
}

/// A linear colour, and the standard error of its luminance, W/m².
#[derive(Clone, Copy, Debug, Default)]
struct Light {
    colour: Rgb,
    error: f64,
}

/// A leaf and its linear colour as seen through the middle of a pixel, with the standard error of
/// its luminance where that is known to be independent of other pixels.
#[derive(Clone, Copy)]
pub(super) struct Middle {
    pub(super) leaf: u32,
    pub(super) colour: [f32; 3],
    pub(super) error: f32,
}

impl Middle {
    /// The leaf, where one is seen.
    pub(super) fn leaf(&self) -> Option<usize> {
        (self.leaf != NO_LEAF).then_some(self.leaf as usize)
    }
}

/// Linear display values, 0 to 1, of a linear colour.
pub(super) type Display<'a> = dyn Fn(Rgb) -> Rgb + Sync + 'a;

/// Draws one view.
pub(super) struct LitView<'a> {
    field: Field<'a>,
    eye: &'a Eye,
    lit: &'a Lit<'a>,
    rest: Shading<'a>,
    gathered: Option<Gathered<'a>>,
    /// The leaves at which all is interpolated; empty where there is none.
    even: Vec<bool>,
    /// Linear sRGB of ρ M for each surface and lamp.
    sent: Vec<Rgb>,
    /// Linear sRGB of M for each surface.
    own: Vec<Rgb>,
}

/// What is seen through a point of the picture: a leaf, and where (m).
pub type Seen = Option<(usize, Vec3)>;

/// Colours points for one thread.
struct Brush<'v> {
    view: &'v LitView<'v>,
    look: Lighter<'v>,
    /// Numbers of the samples by their leaves.
    order: Vec<(u32, u32)>,
    points: Vec<Vec3>,
    factors: LampFactors,
}

impl Brush<'_> {
    /// Linear colours of samples, W/m²; 0 where nothing is seen.
    fn colours(&mut self, samples: &[Seen]) -> Vec<Rgb> {
        let lights = self.of_lamps(samples);
        let add = |(light, sample): (Light, &Seen)| {
            sample.map_or(light.colour, |(leaf, point)| sum(light.colour, self.view.rest(leaf, point).0))
        };
        lights.into_iter().zip(samples).map(add).collect()
    }

    /// The part of the lamps in them. The samples of one leaf are looked at together.
    fn of_lamps(&mut self, samples: &[Seen]) -> Vec<Light> {
        let mut lights = vec![Light::default(); samples.len()];
        let LitView { field, lit, sent, .. } = self.view;
        let lamps = lit.light.lamps();
        self.order.clear();
        let seen = samples.iter().enumerate();
        self.order.extend(seen.filter_map(|(k, seen)| seen.map(|(leaf, _)| (leaf as u32, k as u32))));
        self.order.sort_unstable();
        for group in self.order.chunk_by(|a, b| a.0 == b.0) {
            let leaf = group[0].0 as usize;
            self.points.clear();
            self.points.extend(group.iter().filter_map(|(_, k)| samples[*k as usize].map(|(_, x)| x)));
            self.factors.reset(lamps * self.points.len());
            (self.look)(leaf, &self.points, &mut self.factors);
            let surface = field.mesh().surface_of(leaf);
            let sent = &sent[surface * lamps..(surface + 1) * lamps];
            for (i, (_, k)) in group.iter().enumerate() {
                let of_lamps = i * lamps..(i + 1) * lamps;
                let factors = &self.factors.values[of_lamps.clone()];
                let add = |sum: Rgb, (f, c): (&f64, &Rgb)| [0, 1, 2].map(|i| sum[i] + f * c[i]);
                let colour = factors.iter().zip(sent).fold([0.0; 3], add);
                let error = |(e, c): (&f64, &Rgb)| (e * luminance(*c)).powi(2);
                let square: f64 = self.factors.errors[of_lamps].iter().zip(sent).map(error).sum();
                lights[*k as usize] = Light { colour, error: square.sqrt() };
            }
        }
        lights
    }
}

/// A part of the picture that one thread draws, pixels.
struct Tile {
    xs: Range<usize>,
    ys: Range<usize>,
}

impl Tile {
    /// The tiles of a picture.
    fn all(w: usize, h: usize) -> Vec<Self> {
        let part = |k: usize, end: usize| k * TILE_SIDE..((k + 1) * TILE_SIDE).min(end);
        let row = |j: usize| (0..w.div_ceil(TILE_SIDE)).map(move |i| Self { xs: part(i, w), ys: part(j, h) });
        (0..h.div_ceil(TILE_SIDE)).flat_map(row).collect()
    }

    /// Its pixels, row by row.
    fn pixels(&self) -> impl Iterator<Item = (usize, usize)> {
        self.ys.clone().flat_map(|y| self.xs.clone().map(move |x| (x, y)))
    }
}

/// A pixel as it is shown, and its linear colour.
type Painted = ([u8; 3], [f32; 3]);

impl<'a> LitView<'a> {
    pub fn new(field: Field<'a>, eye: &'a Eye, lit: &'a Lit<'a>) -> Result<Self, ReportError> {
        check(field, lit)?;
        let (mesh, bands) = (field.mesh(), field.bands().len());
        let colouring = Colouring::new(field.bands());
        let mut sent = vec![[0.0; 3]; mesh.surfaces().len() * lit.light.lamps()];
        // All leaves of a surface have one material.
        for leaf in 0..mesh.len() {
            let rho = field.row(lit.reflectance, leaf);
            for (lamp, m) in lit.exitance.chunks_exact(bands).enumerate() {
                let sent = &mut sent[mesh.surface_of(leaf) * lit.light.lamps() + lamp];
                if sent.iter().all(|part| *part == 0.0) {
                    *sent = colouring.reflected(rho, m);
                }
            }
        }
        let part = |leaf: usize, band: usize| {
            let at = leaf * bands + band;
            lit.direct.map_or(0.0, |direct| lit.reflectance[at] * direct[at])
        };
        let rest = Shading::of_rest(field, if lit.direct.is_some() { CORNER_PASSES } else { 0 }, part);
        let mut own = vec![[0.0; 3]; mesh.surfaces().len()];
        if let Some(exitance) = field.exitance() {
            for leaf in 0..mesh.len() {
                own[mesh.surface_of(leaf)] = colouring.colour(field.row(exitance, leaf));
            }
        }
        Ok(Self { field, eye, lit, rest, gathered: None, even: Vec::new(), sent, own })
    }

    /// The irradiance in place of the radiosity, W/m²: the sum over the bands with a weight each,
    /// as a grey colour. What lamps do not send is always interpolated.
    pub fn of_irradiance(
        field: Field<'a>,
        eye: &'a Eye,
        lit: &'a Lit<'a>,
        weights: &[f64],
    ) -> Result<Self, ReportError> {
        check(field, lit)?;
        let bands = field.bands().len();
        let weighed = |values: &[f64]| values.iter().zip(weights).map(|(e, w)| e * w).sum::<f64>();
        let of_lamps: Vec<Rgb> = lit.exitance.chunks_exact(bands).map(|m| [weighed(m); 3]).collect();
        let sent = of_lamps.repeat(field.mesh().surfaces().len());
        let passes = if lit.direct.is_some() { CORNER_PASSES } else { 0 };
        let of_leaf = |leaf: usize| {
            let direct = lit.direct.map_or(0.0, |direct| weighed(field.row(direct, leaf)));
            [(weighed(field.row(field.irradiance(), leaf)) - direct) * field.over_exposed(leaf); 3]
        };
        let rest = (0..field.mesh().len()).flat_map(of_leaf).collect();
        let rest = Shading::of_values(field, passes, (3, rest));
        Ok(Self { field, eye, lit, rest, gathered: None, even: Vec::new(), sent, own: Vec::new() })
    }

    /// Linear colours of points, W/m², each looked at by itself; 0 where nothing is seen.
    pub fn colours(&self, samples: &[Seen]) -> Vec<Rgb> {
        self.brush(Points::Told).colours(samples)
    }

    fn brush(&self, points: Points) -> Brush<'_> {
        let look = self.lit.light.lighter(points);
        Brush { view: self, look, order: Vec::new(), points: Vec::new(), factors: LampFactors::default() }
    }

    /// The picture, with its linear colours where these are wanted; none where it was not wanted
    /// any more before all pixels had the light of the lamps.
    pub fn draw(mut self, exposure: Exposure, linear: bool) -> Result<Option<LitPicture>, ReportError> {
        let Camera { width, height, .. } = *self.eye.camera();
        let Some(mut middles) = self.lit_by_lamps() else { return Ok(None) };
        if let Some((gathering, place)) = self.lit.gathering {
            if place == Where::Uneven {
                self.even = self.even();
            }
            let quality = if place == Where::Uneven { WHERE_UNEVEN } else { EVERYWHERE };
            self.gathered = Some(self.gather((gathering, quality), &middles));
        }
        let standard_error = self.add_rest(&mut middles);
        let tone = Tone::new(exposure, &self.metered(&middles))?;
        let display = |colour| tone.display(colour);
        // Linear colours take four times the memory of what is shown.
        let drawn = if linear {
            let painted = self.in_tiles(PAINTED, |tile| self.painted(tile, &middles, &display));
            painted.map(|painted| painted.into_iter().unzip())
        } else {
            self.shown(&middles, &display).map(|shown| (shown, Vec::new()))
        };
        let whole = drawn.is_some();
        let (shown, linear_colours) = drawn.unwrap_or_else(|| {
            let shown = middles.iter().map(|middle| shown(middle, &display).map(encode)).collect();
            let colours = middles.iter().filter(|_| linear).map(|middle| middle.colour);
            (shown, colours.collect())
        });
        let picture = Picture { width, height, pixels: Vec::into_flattened(shown) };
        let (exposure, places) = (tone.exposure(), self.gathered.as_ref().map_or(0, Gathered::len));
        let linear = linear_colours;
        Ok(Some(LitPicture { picture, linear, standard_error, places, whole, exposure }))
    }

    /// What is seen through the middles of all pixels, row by row; none where the picture is not
    /// wanted any more.
    pub fn looked(&self) -> Option<Vec<Middle>> {
        let mut middles = self.lit_by_lamps()?;
        self.add_rest(&mut middles);
        Some(middles)
    }

    /// The same with the light of the lamps alone.
    fn lit_by_lamps(&self) -> Option<Vec<Middle>> {
        let middles = self.in_tiles(LOOKED, |tile| self.middles(tile))?;
        if middles.iter().all(|middle| middle.error == 0.0) {
            return Some(middles);
        }
        let width = self.eye.camera().width as usize;
        let smooth = |tile: &Tile| {
            Some(smoothed((self.eye, self.field.mesh()), (&middles, width), (&tile.xs, &tile.ys)))
        };
        self.in_tiles([LOOKED[1]; 2], smooth)
    }

    /// Linear colour at a point of a leaf without the light of the lamps, W/m², with its standard
    /// error where it is gathered.
    fn rest(&self, leaf: usize, point: Vec3) -> (Rgb, Option<Rgb>) {
        let gathered = self.gathered.as_ref().filter(|_| self.is_gathered(leaf));
        match gathered.and_then(|gathered| gathered.told(leaf, point)) {
            Some(told) => (sum(self.own[self.field.mesh().surface_of(leaf)], told.colour), Some(told.error)),
            None => (self.rest.colour(leaf, point), None),
        }
    }

    /// Whether the rest of the light of a leaf is gathered.
    fn is_gathered(&self, leaf: usize) -> bool {
        self.even.get(leaf).is_none_or(|even| !even)
    }

    /// Which leaves are small enough for the rest of the light to be interpolated.
    fn even(&self) -> Vec<bool> {
        let Self { field, lit, .. } = self;
        let colouring = Colouring::new(field.bands());
        let colour = |leaf: usize| luminance(colouring.colour(&field.exposed_radiosity(leaf)));
        let of_lamps = |leaf: usize| {
            let (direct, rho) = (lit.direct?, field.row(lit.reflectance, leaf));
            Some(luminance(colouring.reflected(rho, field.row(direct, leaf))) * field.over_exposed(leaf))
        };
        let all: Vec<f64> = (0..field.mesh().len()).map(colour).collect();
        let rest: Vec<f64> = (0..).zip(&all).map(|(leaf, all)| all - of_lamps(leaf).unwrap_or(0.0)).collect();
        self.rest.bends(&rest).iter().zip(&all).map(|(bend, all)| *bend <= UNEVEN_SHARE * all).collect()
    }

    /// Adds to the light of the lamps what else there is. Standard errors of what is gathered are
    /// returned, W/m²: none for pixels where nothing is seen, no number where light is
    /// interpolated, and no list where nothing is gathered.
    fn add_rest(&self, middles: &mut [Middle]) -> Vec<[f32; 3]> {
        let columns = self.eye.camera().width as usize;
        let add = |(k, middle): (usize, &mut Middle)| {
            let Some(leaf) = middle.leaf() else { return [0.0; 3] };
            let (rest, error) = self.rest(leaf, self.point(leaf, (k % columns, k / columns)));
            middle.colour = sum(middle.colour.map(f64::from), rest).map(|c| c as f32);
            error.map_or([f32::NAN; 3], |error| error.map(|e| e as f32))
        };
        let all = middles.par_iter_mut().enumerate();
        if self.gathered.is_some() && self.even.is_empty() {
            return all.map(add).collect();
        }
        all.for_each(|pixel| {
            add(pixel);
        });
        Vec::new()
    }

    /// The point of a leaf (m) that is seen through the middle of a pixel.
    fn point(&self, leaf: usize, (x, y): (usize, usize)) -> Vec3 {
        self.eye.on_plane(self.field.mesh().patch(leaf), x as f64 + 0.5, y as f64 + 0.5)
    }

    /// Gathers what is not of the lamps.
    fn gather(&self, (gathering, quality): (&dyn Gathering, Quality), middles: &[Middle]) -> Gathered<'a> {
        let columns = self.eye.camera().width as usize;
        let LitView { field, eye, lit, own, .. } = self;
        let sent = Sent::new(*field, lit, (CORNER_PASSES, self.even.is_empty()));
        let pixel = |x: usize, y: usize| {
            let middle = &middles[y * columns + x];
            let leaf = middle.leaf().filter(|&leaf| self.is_gathered(leaf))?;
            let colour = sum(middle.colour.map(f64::from), own[field.mesh().surface_of(leaf)]);
            Some(Candidate { leaf, point: self.point(leaf, (x, y)), colour })
        };
        let colouring = Colouring::new(field.bands());
        let reflected = |leaf: usize, e: &[f64]| colouring.reflected(field.row(lit.reflectance, leaf), e);
        let go_on = |share: f64| {
            lit.light.advance(LOOKED[1] + share * (PAINTED[0] - LOOKED[1]));
            lit.light.go_on().is_continue()
        };
        Gathered::new((*field, eye), (gathering, &sent), (&pixel, quality), &reflected, &go_on)
    }

    /// All pixels as they are shown, row by row; none where the picture is not wanted any more.
    pub fn shown(&self, middles: &[Middle], display: &Display<'_>) -> Option<Vec<[u8; 3]>> {
        self.in_tiles(PAINTED, |tile| {
            let painted = self.painted(tile, middles, display)?;
            Some(painted.into_iter().map(|(shown, _)| shown).collect())
        })
    }

    /// The pixels of all tiles, row by row; a part of the way of the picture.
    fn in_tiles<T: Copy + Send>(
        &self,
        [begun, end]: [f64; 2],
        of_tile: impl Fn(&Tile) -> Option<Vec<T>> + Sync,
    ) -> Option<Vec<T>> {
        let Camera { width, height, .. } = *self.eye.camera();
        let (w, h) = (width as usize, height as usize);
        let tiles = Tile::all(w, h);
        let done = AtomicUsize::new(0);
        let of_tile = |tile: &Tile| {
            let found = of_tile(tile)?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            self.lit.light.advance(begun + (end - begun) * done as f64 / tiles.len() as f64);
            Some(found)
        };
        let found: Vec<Vec<T>> = tiles.par_iter().map(of_tile).collect::<Option<_>>()?;
        let mut pixels = vec![*found.first()?.first()?; w * h];
        for (tile, found) in tiles.iter().zip(found) {
            tile.pixels().zip(found).for_each(|((x, y), value)| pixels[y * w + x] = value);
        }
        Some(pixels)
    }

    /// What is seen through the middles of the pixels of a tile; none where the picture is not
    /// wanted any more.
    fn middles(&self, tile: &Tile) -> Option<Vec<Middle>> {
        if self.lit.light.go_on().is_break() {
            return None;
        }
        let look = |(x, y)| self.eye.hit(x as f64 + 0.5, y as f64 + 0.5);
        let samples: Vec<Seen> = tile.pixels().map(look).collect();
        let mut brush = self.brush(Points::One);
        // Every other pixel of every other row first, then those that they do not tell the colour
        // of.
        let w = tile.xs.len();
        let first = |k: usize| (k % w).is_multiple_of(2) && (k / w).is_multiple_of(2);
        let some = |wanted: &dyn Fn(usize) -> bool| -> Vec<Seen> {
            samples.iter().enumerate().map(|(k, seen)| seen.filter(|_| wanted(k))).collect()
        };
        let known = brush.of_lamps(&some(&first));
        let number = |seen: Seen| seen.map_or(NO_LEAF, |(leaf, _)| leaf as u32);
        let beside = |k: usize, dx: isize, dy: isize| {
            let (x, y) = ((k % w).checked_add_signed(dx)?, (k / w).checked_add_signed(dy)?);
            let other = y * w + x;
            let inside = x < w && other < samples.len();
            (inside && self.is_alike(number(samples[k]), number(samples[other]))).then(|| known[other])
        };
        let between: Vec<Option<Light>> = (0..samples.len())
            .map(|k| match samples[k] {
                _ if first(k) => Some(known[k]),
                None => None,
                Some(_) => between((k % w, k / w), |dx, dy| beside(k, dx, dy)),
            })
            .collect();
        let others = brush.of_lamps(&some(&|k| between[k].is_none()));
        let lights = between.into_iter().zip(others).map(|(between, other)| between.unwrap_or(other));
        let middle = |(seen, Light { colour, error }): (&Seen, Light)| Middle {
            leaf: seen.map_or(NO_LEAF, |(leaf, _)| leaf as u32),
            colour: colour.map(|c| c as f32),
            error: error as f32,
        };
        Some(samples.iter().zip(lights).map(middle).collect())
    }

    /// The pixels of a tile; none where the picture is not wanted any more.
    fn painted(&self, tile: &Tile, middles: &[Middle], display: &Display<'_>) -> Option<Vec<Painted>> {
        let Camera { width, height, .. } = *self.eye.camera();
        let (w, h) = (width as usize, height as usize);
        let mut brush = self.brush(Points::Several);
        let mut painted = Vec::with_capacity(tile.xs.len() * tile.ys.len());
        let mut borders = Vec::new();
        for (x, y) in tile.pixels() {
            let middle = &middles[y * w + x];
            if self.is_border(middles, (w, h), (x, y), display) {
                borders.push((painted.len(), (x, y)));
            }
            painted.push((shown(middle, display).map(encode), middle.colour));
        }
        for borders in borders.chunks(PIXELS_TOGETHER) {
            if self.lit.light.go_on().is_break() {
                return None;
            }
            let samples: Vec<Seen> = borders.iter().flat_map(|(_, at)| self.lattice(*at)).collect();
            let lit: Vec<usize> = samples.chunks(POINTS_OF_A_PIXEL).flat_map(lit).collect();
            // What pixels around show tells the light of most samples.
            let around: Vec<Option<Rgb>> = (0..samples.len())
                .map(|k| {
                    if lit[k] == k % POINTS_OF_A_PIXEL {
                        self.around(middles, (w, h), borders[k / POINTS_OF_A_PIXEL].1, samples[k])
                    } else {
                        None
                    }
                })
                .collect();
            let own =
                |k: usize| samples[k].filter(|_| lit[k] == k % POINTS_OF_A_PIXEL && around[k].is_none());
            let colours = brush.colours(&(0..samples.len()).map(own).collect::<Vec<_>>());
            let of = |k: usize| k - k % POINTS_OF_A_PIXEL + lit[k];
            let colours: Vec<Rgb> =
                (0..samples.len()).map(of).map(|k| around[k].unwrap_or(colours[k])).collect();
            let pixels = samples.chunks(POINTS_OF_A_PIXEL).zip(colours.chunks(POINTS_OF_A_PIXEL));
            for ((place, at), (samples, colours)) in borders.iter().zip(pixels) {
                let shares = self.shares(*at, samples, colours);
                painted[*place] = mean((samples, colours), &shares, display);
            }
        }
        Some(painted)
    }

    /// The shares that the samples of a pixel have of it: equal ones, or those of the planes that
    /// they show by more points where these differ in brightness.
    fn shares(&self, (x, y): (usize, usize), samples: &[Seen], colours: &[Rgb]) -> Vec<f64> {
        let bright = || colours.iter().map(|&colour| luminance(colour));
        let (least, most) = (bright().fold(f64::INFINITY, f64::min), bright().fold(0.0, f64::max));
        let beside =
            if self.gathered.is_some() && self.even.is_empty() { GATHERED_LATTICE } else { USUAL_LATTICE };
        let equal = || vec![1.0 / samples.len() as f64; samples.len()];
        let lattice = [LAMP_LATTICE, beside].into_iter().find(|lattice| most > lattice.ratio * least);
        let Some(BorderLattice { points, generator, .. }) = lattice else { return equal() };
        let number = |seen: Seen| seen.map_or(NO_LEAF, |(leaf, _)| leaf as u32);
        // The first sample that shows the same plane.
        let first =
            |seen: Seen| samples.iter().position(|&sample| self.is_alike(number(sample), number(seen)));
        let firsts: Vec<Option<usize>> = samples.iter().map(|&sample| first(sample)).collect();
        let planes = firsts.iter().enumerate().filter(|(k, first)| **first == Some(*k)).count();
        if planes * LEAST_POINTS_OF_A_PLANE > points {
            return equal();
        }
        let mut counts = vec![0.0; samples.len()];
        let place = |i: usize| ((i % points) as f64 + 0.5) / points as f64;
        for k in 0..points {
            let (u, v) = (place(k), place(generator * k));
            // What no sample shows is hardly seen: there are few planes.
            if let Some(first) = first(self.eye.hit(x as f64 + u, y as f64 + v)) {
                counts[first] += 1.0;
            }
        }
        let all: f64 = counts.iter().sum();
        if all == 0.0 {
            return equal();
        }
        let share = |own: &Option<usize>| {
            let same = firsts.iter().filter(|other| *other == own).count();
            own.map_or(0.0, |first| counts[first] / (same as f64 * all))
        };
        firsts.iter().map(share).collect()
    }

    /// Luminances that an automatic exposure goes by: of lit surfaces, or of lamps where there is
    /// nothing else.
    fn metered(&self, middles: &[Middle]) -> Vec<f64> {
        let seen = || middles.iter().filter(|middle| middle.leaf != NO_LEAF);
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
        display: &Display<'_>,
    ) -> bool {
        let own = &middles[y * w + x];
        let colour = shown(own, display);
        neighbours((w, h), (x, y)).any(|at| {
            let other = &middles[at];
            // A change on one plane is a shadow's, which is seen less than an edge.
            let step = match self.is_alike(own.leaf, other.leaf) {
                // Nor is it where light is smooth up to its noise.
                true if own.error > 0.0 && other.error > 0.0 => return false,
                true => BORDER_STEP,
                false => EDGE_STEP,
            };
            let beside = shown(other, display);
            (0..3).any(|i| {
                (colour[i] - beside[i]).abs() > step * colour[i].max(beside[i]).max(UNSEEN_DIFFERENCE / step)
            })
        })
    }

    /// The colour of a sample in pixel `at` from the pixels around it that show the same leaf, or
    /// the same plane where their light is smooth up to its noise; none where there are none, or
    /// they differ.
    fn around(
        &self,
        middles: &[Middle],
        size: (usize, usize),
        at: (usize, usize),
        sample: Seen,
    ) -> Option<Rgb> {
        let leaf = sample?.0 as u32;
        let near = || neighbours(size, at).map(|at| &middles[at]);
        let colours = |same: &dyn Fn(&&Middle) -> bool| {
            near().filter(same).map(|middle| middle.colour.map(f64::from)).collect::<Vec<Rgb>>()
        };
        if near().any(|middle| middle.error > 0.0) {
            mean_colour(colours(&|middle| middle.error > 0.0 && self.is_alike(middle.leaf, leaf)).into_iter())
        } else {
            alike(colours(&|middle| middle.leaf == leaf).into_iter())
        }
    }

    /// Whether two leaves lie on one plane of one surface.
    fn is_alike(&self, a: u32, b: u32) -> bool {
        if a == b {
            return true;
        }
        if a == NO_LEAF || b == NO_LEAF {
            return false;
        }
        let mesh = self.field.mesh();
        let (a, b) = (a as usize, b as usize);
        let [p, q] = [a, b].map(|leaf| mesh.patch(leaf));
        mesh.surface_of(a) == mesh.surface_of(b)
            && p.normal().dot(q.normal()) > 1.0 - COSINE_TOLERANCE
            && (q.corner(0) - p.corner(0)).dot(p.normal()).abs()
                <= COSINE_TOLERANCE * (p.diameter() + q.diameter())
    }

    /// What is seen through the points of a lattice in a pixel.
    fn lattice(&self, (x, y): (usize, usize)) -> [Seen; POINTS_OF_A_PIXEL] {
        let place = |i: usize| (i as f64 + 0.5) / POINTS_OF_A_PIXEL as f64;
        std::array::from_fn(|k| {
            self.eye.hit(x as f64 + place(k), y as f64 + place(GENERATOR * k % POINTS_OF_A_PIXEL))
        })
    }
}

/// A pixel as its middle shows it, linear display values.
fn shown(middle: &Middle, display: &Display<'_>) -> Rgb {
    match middle.leaf {
        NO_LEAF => [BACKGROUND; 3],
        _ => display(middle.colour.map(f64::from)),
    }
}

/// The light at an odd row or column from those at even ones around it, on lines through them along
/// which it hardly bends: places are relative to the pixel. None where it bends, or one is missing.
fn between((x, y): (usize, usize), known: impl Fn(isize, isize) -> Option<Light>) -> Option<Light> {
    let line = |dx: isize, dy: isize| {
        let at = |step: isize| known(step * dx, step * dy);
        let (a, b) = (at(-1)?, at(1)?);
        let colour = midpoint([a.colour, b.colour], [at(-3), at(3)].map(|end| end.map(|end| end.colour)))?;
        Some(Light { colour, error: a.error.max(b.error) })
    };
    match (x % 2, y % 2) {
        (1, 0) => line(1, 0),
        (0, 1) => line(0, 1),
        _ => {
            let (down, up) = (line(1, 1)?, line(1, -1)?);
            let colour = alike([down.colour, up.colour].into_iter())?;
            Some(Light { colour, error: down.error.max(up.error) })
        }
    }
}

/// The colour halfway between two from the cubic through them and those beyond, the parabola where
/// there is one of these, or the mean of two that are alike where there is none; none where the
/// line through them bends.
fn midpoint([a, b]: [Rgb; 2], beyond: [Option<Rgb>; 2]) -> Option<Rgb> {
    let bend = |end: Option<Rgb>, from: Rgb, to: Rgb| {
        end.map(|end| [0, 1, 2].map(|i| end[i] - 2.0 * from[i] + to[i]))
    };
    let bends = [bend(beyond[0], a, b), bend(beyond[1], b, a)];
    let count = bends.iter().flatten().count() as f64;
    if count == 0.0 {
        return alike([a, b].into_iter());
    }
    let is_bent = |bend: &Rgb| (0..3).any(|i| bend[i].abs() > MOST_BEND * a[i].max(b[i]));
    if bends.iter().flatten().any(is_bent) {
        return None;
    }
    let mean = bends.iter().flatten().fold([0.0; 3], |all, &bend| sum(all, bend)).map(|all| all / count);
    Some([0, 1, 2].map(|i| 0.5 * (a[i] + b[i]) - 0.125 * mean[i]))
}

/// The places of a pixel and of those around it, in rows of pixels.
pub(super) fn neighbours((w, h): (usize, usize), (x, y): (usize, usize)) -> impl Iterator<Item = usize> {
    let (xs, ys) = (x.saturating_sub(1)..=(x + 1).min(w - 1), y.saturating_sub(1)..=(y + 1).min(h - 1));
    ys.flat_map(move |v| xs.clone().map(move |u| v * w + u))
}

/// The mean of colours; none where there are none, or they differ.
fn alike(colours: impl Iterator<Item = Rgb>) -> Option<Rgb> {
    let (mut count, mut sum) = (0.0, [0.0; 3]);
    let (mut least, mut most) = ([f64::INFINITY; 3], [0.0_f64; 3]);
    for colour in colours {
        count += 1.0;
        for (i, &c) in colour.iter().enumerate() {
            sum[i] += c;
            (least[i], most[i]) = (least[i].min(c), most[i].max(c));
        }
    }
    let same = (0..3).all(|i| most[i] - least[i] <= ALIKE_DIFFERENCE * most[i]);
    (count > 0.0 && same).then(|| sum.map(|sum| sum / count))
}

/// The mean of colours, at least of one.
fn mean_colour(colours: impl Iterator<Item = Rgb>) -> Option<Rgb> {
    let add = |(count, all): (f64, Rgb), colour| (count + 1.0, sum(all, colour));
    let (count, all) = colours.fold((0.0, [0.0; 3]), add);
    (count > 0.0).then(|| all.map(|c| c / count))
}

/// For each sample of a pixel the one whose light it has, which shows the same leaf.
fn lit(samples: &[Seen]) -> [usize; POINTS_OF_A_PIXEL] {
    let leaf = |k: usize| samples[k].map(|(leaf, _)| leaf);
    let mut lit = [0; POINTS_OF_A_PIXEL];
    for k in 0..POINTS_OF_A_PIXEL {
        let mut before = (0..k).filter(|&other| leaf(other) == leaf(k));
        let place = before.clone().count();
        lit[k] = if place.is_multiple_of(POINTS_OF_A_LIGHT) {
            k
        } else {
            before.next_back().map_or(k, |other| lit[other])
        };
    }
    lit
}

/// Refuses what does not fit the field.
fn check(field: Field<'_>, lit: &Lit<'_>) -> Result<(), ReportError> {
    let (leaves, bands) = (field.mesh().len(), field.bands().len());
    let lengths = [
        ("reflectance", leaves * bands, lit.reflectance.len()),
        ("direct irradiance", leaves * bands, lit.direct.map_or(leaves * bands, <[f64]>::len)),
        ("exitance of lamps", lit.light.lamps() * bands, lit.exitance.len()),
    ];
    for (what, expected, found) in lengths {
        if expected != found {
            return Err(ReportError::Length { what, expected, found });
        }
    }
    Ok(())
}

/// A pixel from its samples and their shares of it: the means of their display values and of their
/// colours.
fn mean((samples, colours): (&[Seen], &[Rgb]), shares: &[f64], display: &Display<'_>) -> Painted {
    let (mut shown, mut seen) = ([0.0; 3], [0.0; 3]);
    for ((sample, colour), share) in samples.iter().zip(colours).zip(shares) {
        let own = if sample.is_some() { display(*colour) } else { [BACKGROUND; 3] };
        shown = [0, 1, 2].map(|i| shown[i] + own[i] * share);
        seen = [0, 1, 2].map(|i| seen[i] + colour[i] * share);
    }
    (shown.map(encode), seen.map(|c| c as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_of_a_sample_is_of_its_own_leaf() {
        let samples: Vec<Seen> =
            (0..POINTS_OF_A_PIXEL).map(|k| [Some((7, Vec3::X)), Some((9, Vec3::Y)), None][k % 3]).collect();
        let lit = lit(&samples);
        let leaf = |k: usize| samples[k].map(|(leaf, _)| leaf);
        assert!((0..POINTS_OF_A_PIXEL).all(|k| leaf(lit[k]) == leaf(k) && lit[k] <= k));
        // Six samples of the first leaf, five of each other.
        let own =
            |of: Option<usize>| (0..POINTS_OF_A_PIXEL).filter(|&k| leaf(k) == of && lit[k] == k).count();
        assert_eq!([own(Some(7)), own(Some(9)), own(None)], [2, 2, 2]);
    }

    #[test]
    fn a_pixel_between_others_is_on_their_curve() {
        let grey = |value: f64| Light { colour: [value; 3], error: 0.0 };
        // Smooth: steep, but bent little. Every pixel with an odd place is told.
        let smooth = |x: isize, y: isize| 1.0 + 0.1 * x as f64 + 0.02 * y as f64 + 0.003 * (x * x) as f64;
        for (x, y) in [(5, 4), (4, 5), (5, 5)] {
            let own = smooth(x as isize, y as isize);
            let known = |dx: isize, dy: isize| Some(grey(smooth(x as isize + dx, y as isize + dy)));
            let found = between((x, y), known).unwrap();
            assert!(found.colour.iter().all(|c| (c - own).abs() < 1e-12), "{x} {y}: {found:?} {own}");
            // Without what is beyond it is their mean, were they alike.
            let near = |dx: isize, dy: isize| known(dx, dy).filter(|_| dx.abs() < 2 && dy.abs() < 2);
            assert!(between((x, y), near).is_none() == (x == 5), "{x} {y}");
            let border = |dx: isize, dy: isize| Some(grey(if dx + dy > 2 { 1.2 } else { 1.0 }));
            assert!(between((x, y), border).is_none());
            let missing = |dx: isize, dy: isize| known(dx, dy).filter(|_| (dx, dy) != (1, 0) && dx * dy != 1);
            assert!(between((x, y), missing).is_none() == (x == 5));
        }
    }
}

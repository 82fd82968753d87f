//! The rays themselves: where they go, and the looks at lamps on their way.

use crate::density::{Cut, Cuts, LampTree, Look, Receiver};
use crate::points::{Draw, Key, PointSet, Samples};
use crate::surfaces::Meets;
use crate::{Enclosure, Site};
use fredholm_linop::Watch;
use rayon::prelude::*;

use super::{BACK, Batch, Family, Looks, NOTHING, REPLICATES, Rows, WALKED};

/// Distance, over the root of the area of a patch, from which on the patch is seen as a whole.
const NEAR: f64 = 1.0;
/// The same from dark patches. They are dark since little of the scene is seen from there: behind a
/// cupboard the floor before it, the near and dim edge of which sends less than its mean.
const NEAR_FROM_THE_DARK: f64 = 3.0;
/// Reflections after which a ray that goes on may be absorbed by chance.
const SURE_REFLECTIONS: usize = 3;
/// Families that one thread takes at a time.
const CHUNK: usize = 64;

/// What casts the rays of rows.
#[derive(Debug)]
pub struct RowSampler<'a> {
    scene: &'a Enclosure,
    families: &'a [Family],
    ends: Vec<End>,
    lamps: LampTree,
    /// What each family sees of them.
    cuts: Cuts,
    /// Whether these know what looks have found.
    has_learned: bool,
    seed: u64,
}

/// What has to be known of a part that a ray meets, in one place of memory.
#[derive(Clone, Copy, Debug)]
struct End {
    /// Area, m².
    area: f64,
    family: u32,
    is_lamp: bool,
    /// Whether it is so near a lamp that looks at the lamp are not enough.
    is_near_lamp: bool,
}

/// What a ray weighs in every band, before and after the reflection where it is.
struct Weights {
    before: Vec<f64>,
    after: Vec<f64>,
}

/// The rays of some families.
#[derive(Default)]
struct Cast {
    met: Vec<u32>,
    direct: Vec<f64>,
    reflected: Vec<f64>,
    checked: Vec<f64>,
    /// Rays of each part and replicate that went on, where they ended and what they weigh.
    walks: Vec<usize>,
    walked: Vec<u32>,
    weights: Vec<f64>,
    looked: Vec<Look>,
}

impl<'a> RowSampler<'a> {
    /// Casts rays from the parts of these families, which together are the patches of the enclosure
    /// in order.
    #[must_use]
    pub fn new(scene: &'a Enclosure, families: &'a [Family], seed: u64) -> Self {
        let bands = scene.bands() as f64;
        let power =
            |patch: usize| scene.exitance(patch).iter().sum::<f64>() / bands * scene.patches()[patch].area();
        let power: Vec<f64> = (0..scene.len()).map(power).collect();
        let lamps = LampTree::new(scene.patches(), &power);
        let cuts = lamps.cuts(&receivers(families));
        let numbered = families.iter().zip(0..);
        let family_of = numbered.flat_map(|(family, k)| std::iter::repeat_n(k, family.parts.len()));
        let end = |(part, family): (usize, u32)| End {
            area: scene.patches()[part].area(),
            family,
            is_lamp: power[part] > 0.0,
            is_near_lamp: cuts.is_near(family as usize),
        };
        let ends = family_of.enumerate().map(end).collect();
        Self { scene, families, ends, lamps, cuts, has_learned: false, seed }
    }

    /// Chooses lamps from here on by what the looks of rows have found. These rows may not grow any
    /// more: what they have found would decide what they find.
    pub fn learn(&mut self, rows: &Rows) {
        self.cuts.learn(&self.lamps, &receivers(self.families), &rows.looked);
        self.has_learned = true;
    }

    /// No rows yet. The same stage gives the same rows; rows of other stages are independent. Rays
    /// go on further where they leave a family that is `dark`, one flag for each: less is left out of
    /// what they see, at the price of more noise.
    #[must_use]
    pub fn start(&self, looks: Looks, stage: u32, dark: Vec<bool>) -> Rows {
        debug_assert_eq!(dark.len(), self.families.len());
        let (parts, bands) = (self.scene.len(), self.scene.bands());
        let sums = vec![0.0; parts * REPLICATES * bands];
        Rows {
            bands,
            looks,
            stage,
            dark,
            counts: vec![0; parts],
            direct: sums.clone(),
            checked: if looks.is_checked() { sums.clone() } else { Vec::new() },
            reflected: sums,
            batches: Vec::new(),
            looked: Vec::new(),
        }
    }

    /// Prolongs rows to so many rays a part and replicate for each family, powers of two and no
    /// fewer than before. Whether it was done: where the watch breaks, rows stay as they were.
    pub fn prolong(&self, rows: &mut Rows, counts: &[u32], watch: &dyn Watch) -> bool {
        loop {
            // The first points, then as many again, until there are enough.
            let more: Vec<u32> = self
                .families
                .iter()
                .zip(counts)
                .map(|(family, &wanted)| match rows.counts[family.parts.start] {
                    known if known >= wanted => 0,
                    0 => wanted,
                    known => known,
                })
                .collect();
            if more.iter().all(|&more| more == 0) {
                return true;
            }
            if !self.cast_batch(rows, &more, watch) {
                return false;
            }
        }
    }

    fn cast_batch(&self, rows: &mut Rows, more: &[u32], watch: &dyn Watch) -> bool {
        let chunk = |families: &[Family], more: &[u32]| {
            let mut cast = Cast::default();
            let mut samples: [Samples; REPLICATES] =
                std::array::from_fn(|_| Samples::new(PointSet::Sobol, Key::default(), 0));
            for (family, &more) in families.iter().zip(more) {
                if watch.go_on().is_break() {
                    return None;
                }
                if more > 0 {
                    for (replicate, samples) in samples.iter_mut().enumerate() {
                        let batch = rows.stage * REPLICATES as u32 + replicate as u32;
                        samples.restart(Key { seed: self.seed, batch, stream: family.stream });
                    }
                    self.cast_family(family, (rows, &mut samples), more, &mut cast);
                }
            }
            Some(cast)
        };
        let chunks = self.families.par_chunks(CHUNK).zip(more.par_chunks(CHUNK));
        let Some(found) = chunks.map(|(families, more)| chunk(families, more)).collect::<Option<Vec<_>>>()
        else {
            return false;
        };
        let mut starts = Vec::with_capacity(rows.counts.len() + 1);
        let mut end = 0;
        let width = REPLICATES * rows.bands;
        let mut direct = found.iter().flat_map(|cast| cast.direct.chunks(width));
        let mut reflected = found.iter().flat_map(|cast| cast.reflected.chunks(width));
        let mut checked = found.iter().flat_map(|cast| cast.checked.chunks(width));
        let add = |own: &mut [f64], part: usize, sum: Option<&[f64]>| {
            let own = own.iter_mut().skip(part * width);
            own.zip(sum.into_iter().flatten()).for_each(|(own, sum)| *own += sum);
        };
        for (family, &more) in self.families.iter().zip(more) {
            for part in family.parts.clone() {
                starts.push(end);
                end += REPLICATES * more as usize;
                rows.counts[part] += more;
                if more > 0 {
                    add(&mut rows.direct, part, direct.next());
                    add(&mut rows.reflected, part, reflected.next());
                    add(&mut rows.checked, part, checked.next());
                }
            }
        }
        starts.push(end);
        let mut batch = Batch { starts, ..Batch::default() };
        batch.met.reserve_exact(end);
        let mut walks = found.iter().flat_map(|cast| &cast.walks);
        let mut walk_end = 0;
        for part in 0..rows.counts.len() {
            let cast = batch.starts[part + 1] > batch.starts[part];
            for _ in 0..REPLICATES {
                batch.walk_starts.push(walk_end);
                walk_end += if cast { walks.next().copied().unwrap_or(0) } else { 0 };
            }
        }
        batch.walk_starts.push(walk_end);
        for cast in &found {
            batch.met.extend_from_slice(&cast.met);
            batch.walked.extend_from_slice(&cast.walked);
            batch.weights.extend_from_slice(&cast.weights);
            rows.looked.extend_from_slice(&cast.looked);
        }
        rows.batches.push(batch);
        true
    }

    /// So many rays more of each part and replicate than the rows have, by the samples of each
    /// replicate.
    fn cast_family(
        &self,
        family: &Family,
        (rows, samples): (&Rows, &mut [Samples; REPLICATES]),
        more: u32,
        cast: &mut Cast,
    ) {
        let (parts, bands) = (family.parts.len() as u32, self.scene.bands());
        let (looks, known) = (rows.looks, rows.counts[family.parts.start]);
        let is_dark = rows.dark[self.ends[family.parts.start].family as usize];
        let near = if is_dark { NEAR_FROM_THE_DARK } else { NEAR };
        let mut weights = Weights { before: vec![1.0; bands], after: vec![1.0; bands] };
        // The parts are stored one after the other, so a replicate is taken part by part.
        for part in 0..parts {
            let begin = parts * known + part * more;
            for samples in samples.iter_mut() {
                let (sum, before) = (cast.direct.len(), cast.walked.len());
                cast.direct.resize(sum + bands, 0.0);
                cast.reflected.resize(sum + bands, 0.0);
                if looks.is_checked() {
                    cast.checked.resize(sum + bands, 0.0);
                }
                for ray in begin..begin + more {
                    let mut draw = samples.draw(ray);
                    let from = self.scene.point(family.parts.start + part as usize, draw.pair());
                    weights.before.fill(1.0);
                    let sums = (&*weights.before, &mut cast.direct[sum..]);
                    let met = self.step(from, &mut draw, sums, &mut cast.looked);
                    cast.met.push(match met {
                        Meets::Nothing => NOTHING,
                        Meets::Back => BACK,
                        Meets::Lit(site) if self.goes_on(from, site, near) => {
                            let reflected = &mut cast.reflected[sum..];
                            let way = (from, site, near);
                            let sums = (&mut weights, reflected, &mut cast.looked);
                            if let Some(end) = self.walk(way, looks, &mut draw, sums) {
                                cast.walked.push(end.patch as u32);
                                cast.weights.extend_from_slice(&weights.before);
                            }
                            WALKED
                        }
                        Meets::Lit(site) => {
                            if looks == Looks::Everywhere {
                                let rho = self.scene.reflectance(site.patch);
                                let sums = (rho, &mut cast.reflected[sum..]);
                                self.look(site, &mut draw, unshared, sums, &mut cast.looked);
                            } else if looks.checks((ray - begin) as usize) {
                                let rho = self.scene.reflectance(site.patch);
                                let sums = (rho, &mut cast.checked[sum..]);
                                self.look(site, &mut draw, unshared, sums, &mut cast.looked);
                            }
                            site.patch as u32
                        }
                    });
                }
                cast.walks.push(cast.walked.len() - before);
            }
        }
    }

    fn cut(&self, patch: usize) -> Cut<'_> {
        self.cuts.of(self.ends[patch].family as usize)
    }

    /// Whether a ray that meets a patch goes on: where the patch is so near that what it sends
    /// varies over what is seen of it, or where it is so near a lamp that looks at the lamp are not
    /// enough.
    fn goes_on(&self, from: Site, to: Site, near: f64) -> bool {
        let End { area, is_near_lamp, .. } = self.ends[to.patch];
        from.point.distance_squared(to.point) < near * near * area || is_near_lamp
    }

    /// A ray and a look at a lamp from one site: what the ray meets. What both bring is added.
    fn step(
        &self,
        from: Site,
        draw: &mut Draw,
        (weight, sum): (&[f64], &mut [f64]),
        looked: &mut Vec<Look>,
    ) -> Meets {
        let cut = self.cut(from.patch);
        let met = self.scene.bounce_to(from, draw.pair());
        if let Meets::Lit(site) = met
            && self.ends[site.patch].is_lamp
        {
            let kernel = self.scene.kernel(from, site);
            let looked_at = self.lamps.pdf(cut, site.patch);
            add(sum, weight, kernel / (looked_at + kernel), self.scene.exitance(site.patch));
        }
        self.look(from, draw, shared, (weight, sum), looked);
        met
    }

    /// Looks at a point of a lamp, and keeps in mind what it has found as long as there is something
    /// to learn.
    fn look(
        &self,
        from: Site,
        draw: &mut Draw,
        share: impl Fn(f64, f64) -> f64,
        (weight, sum): (&[f64], &mut [f64]),
        looked: &mut Vec<Look>,
    ) {
        let (choice, numbers) = (draw.single(), draw.pair());
        if let Some((patch, point, density)) = self.lamps.sample(self.cut(from.patch), choice, numbers) {
            let lamp = Site { patch, point };
            let kernel = self.scene.kernel(from, lamp);
            let exitance = self.scene.exitance(patch);
            let is_seen = kernel > 0.0 && self.scene.sees(from, lamp);
            let share = if is_seen { share(kernel, density) } else { 0.0 };
            if is_seen {
                add(sum, weight, share, exitance);
            }
            if let Some(place) = self.lamps.place(patch).filter(|_| !self.has_learned) {
                let receiver = self.ends[from.patch].family;
                let mean = exitance.iter().sum::<f64>() / exitance.len() as f64;
                let found = (share * mean / self.cuts.total(receiver as usize)) as f32;
                looked.push(Look { receiver, place, found });
            }
        }
    }

    /// From what a ray has met, and goes on from, to the site from which it goes on no more, with the
    /// weight before that; none where it is absorbed, leaves the scene or ends on a back. What lamps
    /// send to the patches on the way is added.
    fn walk(
        &self,
        (mut from, mut at, near): (Site, Site, f64),
        looks: Looks,
        draw: &mut Draw,
        (weights, sum, looked): (&mut Weights, &mut [f64], &mut Vec<Look>),
    ) -> Option<Site> {
        let Weights { before, after } = weights;
        for reflections in 0.. {
            let sure = reflections < SURE_REFLECTIONS;
            let survival = if sure { 1.0 } else { self.scene.survival(at.patch) };
            if !sure && draw.single() >= survival {
                return None;
            }
            let rho = self.scene.reflectance(at.patch);
            after.iter_mut().zip(&*before).zip(rho).for_each(|((out, w), rho)| *out = w * rho / survival);
            if !self.goes_on(from, at, near) {
                if looks == Looks::Everywhere {
                    self.look(at, draw, unshared, (after, sum), looked);
                }
                for weight in before.iter_mut() {
                    *weight /= survival;
                }
                return Some(at);
            }
            let next = self.step(at, draw, (after, sum), looked).lit()?;
            before.copy_from_slice(after);
            (from, at) = (at, next);
        }
        None
    }
}

fn receivers(families: &[Family]) -> Vec<Receiver> {
    families.iter().map(|family| Receiver::of(&family.whole)).collect()
}

/// Adds what comes from a lamp.
fn add(sum: &mut [f64], weight: &[f64], share: f64, exitance: &[f64]) {
    sum.iter_mut().zip(weight.iter().zip(exitance)).for_each(|(sum, (weight, m))| *sum += weight * share * m);
}

/// What a point of a lamp counts where rays may meet it too, and where they may not.
fn shared(kernel: f64, density: f64) -> f64 {
    kernel / (density + kernel)
}

fn unshared(kernel: f64, density: f64) -> f64 {
    kernel / density
}

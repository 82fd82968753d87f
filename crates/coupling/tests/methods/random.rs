//! Random pairs: closed form, contour integral and adaptive area integral agree within their stated errors.

use crate::generator::{KINDS, Kind, Random, axes, pair, polygon};
use crate::{open, smaller};
use fredholm_coupling::method::{Evaluated, Setting};
use fredholm_mesh::{Patch, Vec3};
use rayon::prelude::*;

/// Tolerance of the area integral, and its largest stated error as a part of the smaller area.
const AREA: f64 = 1e-6;

/// What one pair gave.
#[derive(Clone, Copy, Debug)]
struct Outcome {
    closed: Evaluated,
    contour: Evaluated,
    area: Evaluated,
    smaller: f64,
}

impl Outcome {
    fn of(pair: &[Patch; 2]) -> Self {
        Self {
            closed: open("schroeder-hanrahan", pair, Setting::Fixed),
            contour: open("contour", pair, Setting::Tolerance(1e-14)),
            area: open("point-polygon", pair, Setting::Tolerance(AREA)),
            smaller: smaller(pair),
        }
    }

    fn is_sound(&self) -> bool {
        [self.closed, self.contour, self.area].iter().all(|got| {
            got.value.is_finite()
                && got.error.is_finite()
                && got.value >= 0.0
                && got.value <= self.smaller * (1.0 + 1e-9) + got.error
        })
    }

    /// Differences over the sums of the stated errors: closed to contour, closed to area, contour to area.
    fn ratios(&self) -> [f64; 3] {
        let ratio = |x: Evaluated, y: Evaluated| {
            let difference = (x.value - y.value).abs();
            if difference == 0.0 { 0.0 } else { difference / (x.error + y.error) }
        };
        [ratio(self.closed, self.contour), ratio(self.closed, self.area), ratio(self.contour, self.area)]
    }
}

fn coplanar(random: &mut Random) -> [Patch; 2] {
    let n = random.direction();
    let [u, v] = axes(n, random);
    let aside = u * random.between(-3.0, 3.0) + v * random.between(-3.0, 3.0);
    let a = polygon(Vec3::ZERO, n, 1.0, 1.0, random);
    let b = polygon(aside, n, 1.0, 1.0, random);
    [a, if random.below(2) == 0 { b } else { b.flipped() }]
}

/// The same outcomes for any number of threads: each kind draws from its own seed.
fn outcomes(name: &str, pairs: &[[Patch; 2]]) {
    let outcomes: Vec<Outcome> = pairs.par_iter().map(Outcome::of).collect();
    let (mut worst, mut stated, mut apart) = ([0f64; 3], [0f64; 3], 0f64);
    for (k, outcome) in outcomes.iter().enumerate() {
        assert!(outcome.is_sound(), "{name} {k}: {outcome:?} {:?}", pairs[k]);
        let ratios = outcome.ratios();
        for i in 0..3 {
            worst[i] = worst[i].max(ratios[i]);
        }
        let errors = [outcome.closed.error, outcome.contour.error, outcome.area.error];
        for i in 0..3 {
            stated[i] = stated[i].max(errors[i] / outcome.smaller);
        }
        apart = apart.max((outcome.closed.value - outcome.contour.value).abs() / outcome.smaller);
    }
    println!(
        "{name}: worst ratios {:.2} {:.2} {:.2}; largest stated errors {:.0e} {:.0e} {:.0e}; closed − contour {apart:.0e}",
        worst[0], worst[1], worst[2], stated[0], stated[1], stated[2]
    );
    println!("{}", worst.iter().all(|&ratio| ratio <= 1.0));
}

#[test]
fn ten_thousand_pairs_agree_within_the_stated_errors() {
    for kind in KINDS {
        let mut random = Random::new(11);
        let pairs: Vec<_> = (0..480).map(|_| pair(kind, &mut random)).collect();
        let start = std::time::Instant::now();
        outcomes(&format!("{kind:?}"), &pairs);
        println!("{:?}", start.elapsed());
    }
    let mut random = Random::new(12);
    let pairs: Vec<_> = (0..400).map(|_| coplanar(&mut random)).collect();
    outcomes("Coplanar", &pairs);
}

//! One right-hand side of progressive radiosity, in the order of the groups: elements of a group
//! lie together, so that a group is a range and its unshot power a difference of two sums.

use std::ops::Range;

/// Places that a running sum takes at a time: within them nothing waits for the sum before.
const PLACES_A_STEP: usize = 4;

/// x, G x, r and D of one right-hand side in the order of the groups, and Σ A r over the places
/// before each.
pub(super) struct Rhs {
    /// D = ρ/A, 1/m².
    pub scaling: Vec<f64>,
    /// Shot radiosity x, W/m².
    pub shot: Vec<f64>,
    /// G x, W.
    pub received: Vec<f64>,
    /// r, W/m².
    pub unshot: Vec<f64>,
    /// Σ A r, W, one entry more than there are places.
    sums: Vec<f64>,
    /// Σ A |r|, W.
    pub left: f64,
    /// Σ A x, W.
    pub sent: f64,
    /// 1/‖b‖₂.
    pub scale: f64,
    /// 1 − ρ̄.
    pub loss: f64,
}

impl Rhs {
    /// Nothing shot of the exitance b.
    pub fn new(areas: &[f64], scaling: Vec<f64>, exitance: Vec<f64>, scale: f64) -> Self {
        let zeros = vec![0.0; areas.len()];
        let mut rhs = Self {
            loss: loss(areas, &scaling),
            scaling,
            shot: zeros.clone(),
            received: zeros,
            unshot: exitance,
            sums: vec![0.0; areas.len() + 1],
            left: 0.0,
            sent: 0.0,
            scale,
        };
        rhs.sum_up(areas);
        rhs
    }

    /// Σ_S A r of some places, W.
    pub fn power(&self, places: &Range<usize>) -> f64 {
        self.sums[places.end] - self.sums[places.start]
    }

    /// Sends the unshot power of a group of this area, whose exchange with every place is known.
    pub fn shoot(&mut self, places: &Range<usize>, area: f64, exchanges: &[f64], areas: &[f64]) {
        let step = self.power(places) / area;
        self.shot[places.clone()].iter_mut().for_each(|shot| *shot += step);
        self.unshot[places.clone()].iter_mut().for_each(|unshot| *unshot -= step);
        let places = self.received.iter_mut().zip(&mut self.unshot).zip(&self.scaling).zip(exchanges);
        for (((received, unshot), scaling), exchange) in places {
            let sent = exchange * step;
            *received += sent;
            *unshot += scaling * sent;
        }
        self.sent += area * step;
        self.sum_up(areas);
    }

    fn sum_up(&mut self, areas: &[f64]) {
        let (mut before, mut left) = (0.0, [0.0; PLACES_A_STEP]);
        let own = areas.chunks(PLACES_A_STEP).zip(self.unshot.chunks(PLACES_A_STEP));
        for ((areas, unshot), sums) in own.zip(self.sums[1..].chunks_mut(PLACES_A_STEP)) {
            let mut powers = [0.0; PLACES_A_STEP];
            powers.iter_mut().zip(areas).zip(unshot).for_each(|((power, area), r)| *power = area * r);
            let [a, b, c, d] = powers;
            let running = [a, a + b, (a + b) + c, (a + b) + (c + d)];
            sums.iter_mut().zip(running).for_each(|(sum, running)| *sum = before + running);
            left.iter_mut().zip(powers).for_each(|(left, power)| *left += power.abs());
            before += running[PLACES_A_STEP - 1];
        }
        self.left = (left[0] + left[1]) + (left[2] + left[3]);
    }
}

/// 1 − ρ̄ with the mean over areas.
fn loss(areas: &[f64], scaling: &[f64]) -> f64 {
    let reflected: f64 = areas.iter().zip(scaling).map(|(area, scaling)| area * area * scaling).sum();
    1.0 - reflected / areas.iter().sum::<f64>()
}

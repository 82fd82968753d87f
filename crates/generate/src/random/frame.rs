//! Where a scene stands, how large it is and how its coordinates are rounded.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use crate::dice::Dice;

/// Takes places in a scene of a few units to coordinates in files.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// Length of a unit, m.
    pub scale: f64,
    offset: DVec3,
    /// Decimals of a unit that are kept.
    decimals: Option<i32>,
}

impl Frame {
    pub fn random(dice: &mut Dice) -> Self {
        let scale = match dice.below(10) {
            0..7 => 1.0,
            7 => dice.pick(&[1e-3, 1e3]),
            8 => dice.pick(&[1e-6, 1e5, 0.0254, 39.37]),
            _ => dice.pick(&[1e-9, 1e-7, 1e7, 1e9, 1e12]),
        };
        let away = if dice.chance(0.85) { 0.0 } else { dice.pick(&[10.0, 1e3, 1e5]) };
        let offset = dice.direction() * away;
        let decimals = dice.pick(&[None, Some(6), Some(6), Some(4), Some(3), Some(2)]);
        Self { scale, offset, decimals }
    }

    /// Coordinates of a place.
    pub fn place(&self, p: DVec3) -> [f64; 3] {
        let rounded = |x: f64| match self.decimals {
            Some(decimals) => (x * 10_f64.powi(decimals)).round() / 10_f64.powi(decimals),
            None => x,
        };
        (p + self.offset).to_array().map(|x| rounded(x) * self.scale)
    }

    /// Coordinates of a place, as an array of a scene file.
    pub fn point(&self, p: DVec3) -> String {
        format!("{:?}", self.place(p))
    }

    /// Several places, as an array of arrays.
    pub fn points(&self, places: &[DVec3]) -> String {
        let places: Vec<String> = places.iter().map(|&p| self.point(p)).collect();
        format!("[{}]", places.join(", "))
    }

    /// A length, m.
    pub fn length(&self, x: f64) -> f64 {
        x * self.scale
    }
}

/// A place in the room of 4 × 3 × 3 units, often one of a coarse grid, so that bodies touch.
pub(super) fn somewhere(dice: &mut Dice, on_grid: bool) -> DVec3 {
    let p = DVec3::new(dice.between(0.2, 3.8), dice.between(0.2, 2.8), dice.between(0.2, 2.8));
    if on_grid { (p * 4.0).round() / 4.0 } else { p }
}

/// A turn: none, about z, a little, or any.
pub(super) fn turn(dice: &mut Dice) -> DQuat {
    match dice.below(6) {
        0 | 1 => DQuat::IDENTITY,
        2 => DQuat::from_rotation_z(dice.between(0.0, TAU)),
        3 => DQuat::from_axis_angle(dice.direction(), 10_f64.powf(dice.between(-9.0, -2.0))),
        _ => DQuat::from_axis_angle(dice.direction(), dice.between(0.0, TAU)),
    }
}

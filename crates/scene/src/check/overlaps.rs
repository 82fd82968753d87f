//! Surfaces that lie on each other and are lit on the same side: light would be counted twice, so
//! each place is left to one of them.

use std::collections::BTreeMap;

use fredholm_mesh::Vec3;

use super::Warning;
use crate::scene::Scene;

/// Pairs of surfaces that are told one by one.
const MOST_PAIRS_TOLD: usize = 4;

pub(super) fn check(scene: &Scene) -> Vec<Warning> {
    let mut pairs: BTreeMap<[usize; 2], (f64, Vec3)> = BTreeMap::new();
    let pieces = scene.pieces();
    for overlap in pieces.doubled() {
        let [a, b] = overlap.pieces.map(|piece| pieces.part(piece));
        pairs.entry([a.min(b), a.max(b)]).or_insert((0.0, overlap.place)).0 += overlap.area;
    }
    let help = "nothing is to be done if that is meant; otherwise remove one of them or move it";
    let mut warnings: Vec<Warning> = vec![];
    for ([first, second], (area, place)) in pairs.iter().take(MOST_PAIRS_TOLD) {
        let name = |part: usize| format!("`{}`", scene.parts()[part].name);
        let who = if first == second {
            format!("faces of {} lie on each other", name(*first))
        } else {
            format!("{} and {} lie on each other", name(*first), name(*second))
        };
        let what = format!(
            "{who}, lit on the same side, over {area:.3e} m² (at {place} m): only one of them is there: \
             a lamp, else the smaller face, else the first"
        );
        warnings.push(scene.warning(*second, what, help));
    }
    if let (Some(([_, second], _)), more @ 1..) =
        (pairs.iter().nth(MOST_PAIRS_TOLD), pairs.len().saturating_sub(MOST_PAIRS_TOLD))
    {
        let what = format!("{more} more pairs of surfaces lie on each other and are lit on the same side");
        warnings.push(scene.warning(*second, what, "fredholm check SCENE -o DIR draws them"));
    }
    warnings
}

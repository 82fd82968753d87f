//! Where the light goes that row sums of form factors lack: through openings, or onto the backs of
//! surfaces.
//!
//! What a surface sends is spread as cos θ dω/π. A set of rays whose origins are even over the area
//! and whose directions follow that density meets nothing with the probability that light leaves
//! the scene. Along the area they are equidistant, otherwise those of
//! [`rays`](fredholm_coupling::rays).

use fredholm_coupling::rays::{Meets, cosine_ray, meets, recurrence};
use fredholm_mesh::Patch;
use fredholm_report::Closure;
use rayon::prelude::*;

use crate::problem::{Problem, prepare};

/// Rays that are cast.
const RAYS_CAST: usize = 1 << 14;
/// Rays that are cast one after the other.
const CHUNK: usize = 256;

/// Where a ray ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Ends {
    nowhere: usize,
    back: usize,
}

/// Row sums below which an element sees nothing.
pub(crate) const LEAST_ROW_SUM: f64 = 1e-9;

/// Adds to a closure how much of the area sees nothing, and where light goes from the rest;
/// `exposed` has the share of every element that is not buried, `rows` its row sums where they are
/// known.
pub(crate) fn openness(closure: Closure, problem: &Problem, exposed: &[f64], rows: &[f64]) -> Closure {
    let mesh = &problem.mesh;
    let areas: Vec<f64> = mesh.patches().map(Patch::area).collect();
    let area: f64 = areas.iter().sum();
    // A face that lies on another looks into the void, as a ray does that begins there.
    let sees = |i: usize| rows.get(i).is_none_or(|&row| row > LEAST_ROW_SUM);
    let seeing: f64 = (0..areas.len()).filter(|&i| sees(i)).map(|i| areas[i] * exposed[i]).sum();
    let closure = Closure { blind: (area > 0.0).then_some((1.0 - seeing / area).max(0.0)), ..closure };
    let whole: Vec<usize> =
        (0..areas.len()).filter(|&i| exposed[i] >= 1.0 && areas[i] > 0.0 && sees(i)).collect();
    let missing = |i: &usize| rows.get(*i).map(|row| areas[*i] * (1.0 - row));
    let lacking: Option<f64> = whole.iter().map(missing).sum();
    let total: f64 = whole.iter().map(|&i| areas[i]).sum();
    let missing = lacking.filter(|_| total > 0.0).map(|lacking| lacking / total);
    let Some(ends) = ends(&whole, &areas, problem) else { return closure };
    let share = |count: usize| Some(count as f64 / RAYS_CAST as f64);
    let (open, backs) = (share(ends.nowhere), share(ends.back));
    Closure { rays: Some(RAYS_CAST as u64), open, backs, missing, ..closure }
}

/// Where the rays from these elements end; none where there are no elements.
fn ends(whole: &[usize], areas: &[f64], problem: &Problem) -> Option<Ends> {
    let sums: Vec<f64> = whole
        .iter()
        .scan(0.0, |sum, &i| {
            *sum += areas[i];
            Some(*sum)
        })
        .collect();
    let total = *sums.last()?;
    let mesh = &problem.mesh;
    // The sides of the faces: an occluder stands for both sides of a plate.
    let faces: Vec<Patch> = problem.scene.face_mesh().ok()?.patches().copied().collect();
    let lit = prepare(&faces).ok()?;
    let faces: Vec<&Patch> = faces.iter().collect();
    let end = |ray: usize| {
        let at = (ray as f64 + 0.5) / RAYS_CAST as f64 * total;
        let element = sums.partition_point(|&sum| sum < at).min(whole.len() - 1);
        let (from, direction) = cosine_ray(mesh.patch(whole[element]), recurrence(ray, [0.5; 4]));
        match meets(from, direction, &faces, &lit) {
            Meets::Nothing => Ends { nowhere: 1, back: 0 },
            Meets::Back => Ends { nowhere: 0, back: 1 },
            Meets::Lit => Ends::default(),
        }
    };
    let counts: Vec<Ends> = (0..RAYS_CAST.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            (chunk * CHUNK..((chunk + 1) * CHUNK).min(RAYS_CAST)).map(end).fold(Ends::default(), add)
        })
        .collect();
    Some(counts.into_iter().fold(Ends::default(), add))
}

fn add(a: Ends, b: Ends) -> Ends {
    Ends { nowhere: a.nowhere + b.nowhere, back: a.back + b.back }
}

//! The lamps of a scene as its picture sees them: elements that emit alike are one lamp.

use std::ops::ControlFlow;

use fredholm_hierarchical::Lamps;
use fredholm_linop::{MultiVector, Watch};
use fredholm_mesh::Patch;
use fredholm_report::{Gathering, LampLight, Lighter, Lit, Points, Where};

use crate::directions::Directions;
use crate::error::{Error, ErrorKind};
use crate::problem::{Problem, scene_failure};
use crate::sampled_lamps::{SEGMENTS, SampledLamps};

/// How points look at lamps.
enum Looks<'a> {
    /// Shadows have their true borders.
    Exact(Lamps<'a>),
    /// By segments: among very many bodies, or where the lamps are a sky.
    Sampled(SampledLamps<'a>),
}

/// What the light of lamps at pixels is taken from.
pub(crate) struct Lamplight<'a> {
    /// None where there are no lamps, or too many kinds, or where the solution does not tell their
    /// light apart.
    lamps: Option<(Looks<'a>, &'a [f64])>,
    /// Exitance of each lamp, lamps × bands, W/m².
    exitance: Vec<f64>,
    reflectance: Vec<f64>,
    gathering: Option<(Directions, Where)>,
    /// Whoever waits for the picture.
    watch: &'a dyn Watch,
}

impl<'a> Lamplight<'a> {
    /// The lamps of a scene, of which the irradiance of the elements has a part `direct`, W/m²,
    /// where that is known. The rest is gathered where that is wanted: at all pixels, or only where
    /// elements are too large to tell it, of lamps that are told apart and in scenes of few
    /// elements.
    pub(crate) fn new(
        problem: &'a Problem,
        (direct, gathers): (Option<&'a MultiVector<f64>>, Option<Where>),
        watch: &'a dyn Watch,
    ) -> Result<Self, Error> {
        let (scene, mesh) = (&problem.scene, &problem.mesh);
        let reflectance = scene.reflectance(mesh);
        let gathering = |place| Some((Directions::new(problem, place), place));
        let none = |reflectance| {
            let gathering = match gathers {
                Some(Where::Everywhere) => gathering(Where::Everywhere),
                _ => None,
            };
            Ok(Self { lamps: None, exitance: Vec::new(), reflectance, gathering, watch })
        };
        let Some(direct) = direct else { return none(reflectance) };
        let bands = scene.bands().len();
        let (mut exitance, mut kinds): (Vec<f64>, Vec<Vec<&Patch>>) = (Vec::new(), Vec::new());
        // The faces, not what a solution has split them into: the fewer patches, the quicker.
        let faces = scene.mesh().map_err(scene_failure)?;
        for (leaf, patch) in faces.patches().enumerate() {
            let m = &scene.materials()[faces.surfaces()[faces.surface_of(leaf)].material].exitance;
            if m.iter().all(|m| *m <= 0.0) {
                continue;
            }
            match exitance.chunks_exact(bands).position(|known| known == m) {
                Some(kind) => kinds[kind].push(patch),
                None if kinds.len() == MOST_KINDS => return none(reflectance),
                None => {
                    exitance.extend(m);
                    kinds.push(vec![patch]);
                }
            }
        }
        let area = |patches: &mut dyn Iterator<Item = &Patch>| patches.map(Patch::area).sum::<f64>();
        let emitting = area(&mut kinds.iter().flatten().copied());
        let all = area(&mut mesh.patches());
        // Where nearly everything emits there are no shadows to be seen.
        if kinds.is_empty() || emitting > MOST_EMITTING * all {
            return none(reflectance);
        }
        let elements = || mesh.patches().collect();
        let exact = if emitting > SKY_AREA_RATIO * (all - emitting) {
            None
        } else {
            let lamps = Lamps::new(&kinds, elements(), &problem.occluders);
            lamps.map_err(|error| Error::new(ErrorKind::Input, error))?
        };
        let looks = exact.map_or_else(
            || {
                let power: Vec<f64> = exitance.chunks_exact(bands).map(|m| m.iter().sum()).collect();
                Looks::Sampled(SampledLamps::new(&kinds, &power, elements(), &problem.occluders))
            },
            Looks::Exact,
        );
        let gathering = match gathers {
            Some(Where::Uneven) if mesh.len() > MOST_GATHERED_ELEMENTS => None,
            Some(place) => gathering(place),
            None => None,
        };
        Ok(Self { lamps: Some((looks, direct.as_slice())), exitance, reflectance, gathering, watch })
    }

    /// What the picture is drawn with.
    pub(crate) fn lit(&self) -> Lit<'_> {
        let Self { lamps, exitance, reflectance, gathering, .. } = self;
        let gathering = gathering.as_ref().map(|(directions, place)| (directions as &dyn Gathering, *place));
        let direct = lamps.as_ref().map(|(_, direct)| *direct);
        Lit { light: self, exitance, reflectance, direct, gathering }
    }

    /// Where the light of the picture comes from, of which some was gathered at so many places.
    pub(crate) fn words(&self, places: usize) -> String {
        let rest = match self.gathering {
            Some((_, Where::Everywhere)) => format!("gathered at {places} places"),
            Some((_, Where::Uneven)) if places > 0 => format!(
                "interpolated between elements, or gathered at {places} places where it changes within them"
            ),
            _ => "interpolated between elements".to_owned(),
        };
        match self.lamps {
            Some((Looks::Exact(_), _)) => format!(
                "light of the lamps at every pixel, or between pixels where it hardly changes, the rest {rest}"
            ),
            Some((Looks::Sampled(_), _)) => {
                format!("light of the lamps at every pixel, by {SEGMENTS} segments, the rest {rest}")
            }
            None => format!("light {rest}"),
        }
    }
}

/// Area of the lamps, over that of all else, from which they are a sky rather than lamps: their
/// shadows have no borders to be seen, and much stands before each of them.
const SKY_AREA_RATIO: f64 = 0.5;
/// Share of the area that emits, at most.
const MOST_EMITTING: f64 = 0.9;
/// Elements up to which the rest of the light is gathered where they are too large for it; where
/// there are more, they are small.
pub(crate) const MOST_GATHERED_ELEMENTS: usize = 200_000;
/// Exitances that differ, at most: scenes of more have no lamps that are few.
const MOST_KINDS: usize = 128;

impl LampLight for Lamplight<'_> {
    fn lamps(&self) -> usize {
        match &self.lamps {
            Some((Looks::Exact(lamps), _)) => lamps.len(),
            Some((Looks::Sampled(lamps), _)) => lamps.len(),
            None => 0,
        }
    }

    fn lighter(&self, pixel: Points) -> Lighter<'_> {
        match &self.lamps {
            Some((Looks::Exact(lamps), _)) => {
                let mut lighter = lamps.lighter();
                Box::new(move |element, points, factors| {
                    lighter.factors(element, points, &mut factors.values);
                })
            }
            Some((Looks::Sampled(lamps), _)) => {
                Box::new(move |element, points, factors| lamps.factors(element, points, pixel, factors))
            }
            None => Box::new(|_, _, _| {}),
        }
    }

    fn advance(&self, share: f64) {
        self.watch.advance(share, &|| "picture".to_owned());
    }

    fn go_on(&self) -> ControlFlow<()> {
        self.watch.go_on()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{ProblemOptions, ProblemSettings, SceneSource};
    use crate::solve::view_of;
    use crate::stages::Stages;
    use fredholm_linop::Quiet;
    use fredholm_report::{Field, render_lit};
    use std::time::Instant;

    #[test]
    #[ignore = "tells how long the usual picture of FREDHOLM_SCENE takes, of any solution"]
    fn what_the_picture_of_a_scene_takes() {
        let path = std::path::PathBuf::from(std::env::var("FREDHOLM_SCENE").unwrap());
        let source = SceneSource::from(&path);
        let mut stages = Stages::new(&Quiet);
        let scene = source.load(None, &mut stages).unwrap();
        let options = ProblemSettings::new(&ProblemOptions::default(), scene.solve());
        let problem = Problem::refined(scene, options, (1, &|plan, _, _| plan), &mut stages).unwrap();
        let (mesh, bands) = (&problem.mesh, problem.scene.bands());
        let exitance = problem.scene.exitance(mesh);
        let rho = problem.scene.reflectance(mesh);
        let values: Vec<f64> = exitance.iter().zip(&rho).map(|(m, r)| m + 3.0 * r).collect();
        let direct = MultiVector::zeros(mesh.len(), bands.len());
        let field = Field::new(mesh, bands, &values, &values).unwrap().with_exitance(&exitance).unwrap();
        let view = view_of(problem.scene.camera(), &field);
        let start = Instant::now();
        let light = Lamplight::new(&problem, (Some(&direct), None), &Quiet).unwrap();
        let made = start.elapsed().as_secs_f64();
        let drawn = render_lit(&field, &view.camera, view.exposure, &light.lit(), true).unwrap().unwrap();
        let all = start.elapsed().as_secs_f64();
        if let Ok(out) = std::env::var("FREDHOLM_OUT") {
            let bytes: Vec<u8> = drawn.linear.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
            std::fs::write(out, bytes).unwrap();
        }
        println!("lamps {made:.2} s, picture {all:.2} s, {} elements", mesh.len());
    }
}

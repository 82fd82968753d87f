//! Mistakes that only the whole geometry shows.
//!
//! A point is inside a closed body where the solid angles of its faces, seen from the point, add up
//! to ±4π; outside they add up to 0. A triangle with the corners a, b, c seen from the origin has
//! the solid angle Ω with tan(Ω/2) = a·(b × c)/(abc + (a·b) c + (b·c) a + (c·a) b) (A. van
//! Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125).

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use fredholm_mesh::{Bounds, Contacts, Cutting, Patch, Topology, Vec3};
use fredholm_waves::material::Material;
use fredholm_waves::{Kind, Origin};

use super::receiver::{Places, direction};
use super::scene::{About, WaveScene};
use super::settings::Method;
use crate::check::{Finding, Warning};
use crate::error::{ErrorKind, SceneError};

/// Distance over the extent of the scene below which a source is on a surface.
const ON_SURFACE: f64 = 1e-9;
/// Points of a receiver that are looked at to tell whether all are inside a body.
const MOST_POINTS_OF_A_RECEIVER: usize = 64;
/// Phase that may be lost in the rounding of a coordinate.
const MOST_LOST_PHASE: f64 = 1e-6;
/// Extent of a scene over the wavelength below which it is doubted.
const LEAST_EXTENT: f64 = 1e-4;
/// Share of the sides of an object that may be open so that it looks like a body with a fault.
const FEW_OPEN_SIDES: f64 = 0.2;
/// Points of a receiver that are asked how far away they are.
const MOST_POINTS_ASKED: usize = 4096;
/// Cosine of θ below which a direction is below the ground: that of a θ of 90° is rounded.
const LEAST_HEIGHT: f64 = -1e-12;
/// Pairs of surfaces that are told one by one.
const MOST_PAIRS_TOLD: usize = 4;

/// The pieces of the surfaces, and how they hang together.
struct Pieces {
    patches: Vec<Patch>,
    /// Part of each piece.
    part_of: Vec<usize>,
    topology: Topology,
    /// Length of the box around all, m.
    extent: f64,
}

/// A closed body.
struct Body<'a> {
    /// Part of its first piece.
    part: usize,
    patches: Vec<&'a Patch>,
    bounds: Bounds,
    /// Whether the body is around the room that its faces enclose.
    hollow: bool,
}

pub(super) fn check(scene: &WaveScene) -> Result<Vec<Warning>, SceneError> {
    let pieces = Pieces::of(scene);
    told_apart(scene, &pieces)?;
    above_ground(scene, &pieces)?;
    let mut warnings: Vec<Warning> = closed(scene, &pieces)?.into_iter().collect();
    warnings.extend(half_closed(scene, &pieces));
    warnings.extend(frequencies(scene));
    warnings.extend(lost_in_the_wave(scene, &pieces));
    warnings.extend(slabs_on_bodies(scene)?);
    films_on_bodies(scene)?;
    let bodies = pieces.bodies(scene);
    warnings.extend(inside_out(scene, &bodies));
    // Where there are fields inside of bodies, these may be in each other and touch.
    let solid = scene.settings().method.is_some_and(Method::knows_insides);
    warnings.extend(overlaps(scene, &pieces, solid)?);
    if !solid {
        warnings.extend(nested(scene, &bodies)?);
        warnings.extend(sheets_inside(scene, &pieces, &bodies));
        warnings.extend(receivers(scene, &bodies));
    }
    sources(scene, &pieces, &bodies)?;
    warnings.extend(weak_or_near(scene, &pieces));
    Ok(warnings)
}

/// What the pieces are.
pub(super) fn findings(scene: &WaveScene) -> Vec<Finding> {
    let pieces = Pieces::of(scene);
    let Topology { components, open, slivers, .. } = &pieces.topology;
    let closed = components.iter().filter(|component| component.closed).count();
    let first = open
        .first()
        .map_or_else(String::new, |([a, b], _)| format!("the first from {} to {} m", told(*a), told(*b)));
    let at = slivers.first().map(|&piece| pieces.patches[piece as usize].centroid());
    let at = at.map_or_else(String::new, |p| format!("the first at {} m", told(p)));
    let all = [
        ("flat pieces", pieces.patches.len(), format!("{:.3} m from end to end", pieces.extent)),
        ("objects", components.len(), format!("{closed} of them closed")),
        ("open sides", open.len(), first),
        ("slivers", slivers.len(), format!("{at}; lower than a thousandth of their longest side")),
    ];
    let found = all.into_iter().filter(|(_, count, _)| *count > 0);
    found.map(|(name, count, what)| Finding { name, count, what }).collect()
}

impl Pieces {
    fn of(scene: &WaveScene) -> Self {
        let (mut patches, mut part_of) = (vec![], vec![]);
        for (number, part) in scene.parts().iter().enumerate() {
            for shape in &part.shapes {
                // What cannot be meshed was refused before.
                patches.extend(shape.blockers(&Cutting::default()).unwrap_or_default());
            }
            part_of.resize(patches.len(), number);
        }
        let topology = Topology::of(&patches);
        let bounds = Bounds::around(patches.iter().flat_map(|patch| patch.corners().iter().copied()));
        let extent = bounds.map_or(0.0, |bounds| bounds.diagonal());
        Self { patches, part_of, topology, extent }
    }

    fn is_closed(&self, scene: &WaveScene, piece: u32) -> bool {
        scene.parts()[self.part_of[piece as usize]].kind == Kind::Closed
    }

    /// The components that are closed bodies.
    fn bodies(&self, scene: &WaveScene) -> Vec<Body<'_>> {
        let mut patches: Vec<Vec<&Patch>> = vec![vec![]; self.topology.components.len()];
        for (patch, &component) in self.patches.iter().zip(&self.topology.component_of) {
            patches[component as usize].push(patch);
        }
        let components = self.topology.components.iter().zip(patches);
        let bodies =
            components.filter(|(component, _)| component.closed && self.is_closed(scene, component.first));
        bodies
            .filter_map(|(component, patches)| {
                let corners = patches.iter().flat_map(|patch| patch.corners().iter().copied());
                let bounds = Bounds::around(corners)?;
                let part = self.part_of[component.first as usize];
                Some(Body { part, patches, bounds, hollow: component.volume < 0.0 })
            })
            .collect()
    }
}

impl Body<'_> {
    /// Whether a point is inside what the faces enclose.
    fn encloses(&self, p: Vec3) -> bool {
        let within = p.cmpge(self.bounds.min).all() && p.cmple(self.bounds.max).all();
        within && self.patches.iter().map(|patch| solid_angle(patch, p)).sum::<f64>().abs() > TAU
    }

    /// Whether a point is inside the body, where there is no field.
    fn holds(&self, p: Vec3) -> bool {
        self.encloses(p) != self.hollow
    }
}

/// Solid angle of a patch seen from `p`, positive from its back.
fn solid_angle(patch: &Patch, p: Vec3) -> f64 {
    let triangle = |i: usize| {
        let [a, b, c] = [0, i, i + 1].map(|corner| patch.corner(corner) - p);
        let [la, lb, lc] = [a, b, c].map(Vec3::length);
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    (1..patch.sides() - 1).map(triangle).sum()
}

/// A point with seven digits, zero where it is lost in the rounding of the others.
fn told(p: Vec3) -> String {
    let largest = p.abs().max_element();
    let short = |x: f64| if x.abs() < 1e-7 * largest { 0.0 } else { format!("{x:.6e}").parse().unwrap_or(x) };
    format!("[{}, {}, {}]", short(p.x), short(p.y), short(p.z))
}

/// Refuses coordinates so large that their rounding loses the phase.
fn told_apart(scene: &WaveScene, pieces: &Pieces) -> Result<(), SceneError> {
    let wavenumber = scene.waves().iter().map(fredholm_waves::Wave::wavenumber).fold(0.0, f64::max);
    let most = MOST_LOST_PHASE / (wavenumber * f64::EPSILON);
    let refuse = |about: About, p: Vec3| {
        let what = format!(
            "{} m is so far from the origin that rounding loses the phase of a wave of {:.3e} m",
            told(p),
            TAU / wavenumber
        );
        let help = format!("move the scene to the origin: coordinates may be up to {most:.0e} m");
        Err(scene.error(about, ErrorKind::Geometry, what, help))
    };
    for (patch, &part) in pieces.patches.iter().zip(&pieces.part_of) {
        if let Some(&p) = patch.corners().iter().find(|p| p.length() > most) {
            return refuse(About::Surface(part), p);
        }
    }
    for (number, receiver) in scene.receivers().iter().enumerate().filter(|(_, r)| r.is_near()) {
        let Places::Near { points, .. } = receiver.places() else { continue };
        let step = points.len().div_ceil(MOST_POINTS_ASKED).max(1);
        if let Some(&p) = points.iter().step_by(step).find(|p| p.length() > most) {
            return refuse(About::Receiver(number), p);
        }
    }
    Ok(())
}

/// Refuses what is not above the ground plane, and waves that come out of it.
fn above_ground(scene: &WaveScene, pieces: &Pieces) -> Result<(), SceneError> {
    let Some(ground) = scene.ground() else { return Ok(()) };
    let height = ground.height();
    let refuse =
        |about: About, what: String, help: &str| Err(scene.error(about, ErrorKind::Geometry, what, help));
    let raise = "move it up, or the ground down";
    let low = |patch: &Patch| patch.corners().iter().any(|p| p.z <= height);
    if let Some(piece) = pieces.patches.iter().position(low) {
        let part = pieces.part_of[piece];
        let what = format!(
            "`{}` is not above the ground at z = {height} m, which no surface may touch",
            scene.parts()[part].name
        );
        return refuse(About::Surface(part), what, raise);
    }
    for (number, placed) in scene.sources().iter().enumerate() {
        let ends = scene.waves().iter().filter_map(|wave| placed.source.wire(wave)).flatten();
        let mut places = ends.chain(match placed.source.origin() {
            Origin::Point(p) => Some(p),
            Origin::Direction(_) => None,
        });
        if places.any(|p| p.z <= height) {
            return refuse(About::Source(number), "the source is not above the ground".to_owned(), raise);
        }
        if matches!(placed.source.origin(), Origin::Direction(travel) if travel.z >= 0.0) {
            let what = "the plane wave does not come from above the ground".to_owned();
            return refuse(About::Source(number), what, "let it travel downwards, towards −z");
        }
    }
    for (number, receiver) in scene.receivers().iter().enumerate() {
        let what = match receiver.places() {
            Places::Near { points, .. } => points.iter().position(|p| p.z < height).map(|point| {
                format!("point {point} of the receiver `{}` is below the ground", receiver.name)
            }),
            Places::Far(angles) | Places::Monostatic(angles) => {
                let up = |[theta, phi]: &[f64; 2]| direction(*theta, *phi).z >= LEAST_HEIGHT;
                angles.iter().find(|angles| !up(angles)).map(|[theta, phi]| {
                    format!(
                        "the direction θ = {theta}°, φ = {phi}° of the receiver `{}` is not above the ground",
                        receiver.name
                    )
                })
            }
        };
        if let Some(what) = what {
            return refuse(About::Receiver(number), what, "leave out what is below, or the ground");
        }
    }
    Ok(())
}

/// Objects of mesh files that are taken as sheets, but look like bodies with a fault.
fn half_closed(scene: &WaveScene, pieces: &Pieces) -> Vec<Warning> {
    let Topology { open, clashes, component_of, components, .. } = &pieces.topology;
    let mut faults = vec![[0_usize; 2]; components.len()];
    for (_, piece) in open {
        faults[component_of[*piece as usize] as usize][0] += 1;
    }
    for (_, [piece, _]) in clashes {
        faults[component_of[*piece as usize] as usize][1] += 1;
    }
    let mut sides = vec![0_usize; components.len()];
    for (patch, &component) in pieces.patches.iter().zip(component_of) {
        sides[component as usize] += patch.sides();
    }
    let warning = |number: usize| {
        let ([open, turned], first) = (faults[number], components[number].first);
        let part = &scene.parts()[pieces.part_of[first as usize]];
        let sheet = part.imported && part.kind == Kind::Sheet && !part.said;
        let few = open as f64 <= FEW_OPEN_SIDES * sides[number] as f64;
        (sheet && open + turned > 0 && few).then(|| {
            let what = format!(
                "`{}` is taken as a thin sheet, though nearly closed: {open} sides belong to one face only, along {turned} \
                 both faces run the same way",
                part.name
            );
            let help = "mend it in the program that made the file, or write closed = false where a sheet is meant";
            scene.warning(About::Surface(pieces.part_of[first as usize]), what, help)
        })
    };
    (0..components.len()).filter_map(warning).take(MOST_PAIRS_TOLD).collect()
}

/// Frequencies that are there twice.
fn frequencies(scene: &WaveScene) -> Option<Warning> {
    let mut all: Vec<f64> = scene.waves().iter().map(fredholm_waves::Wave::frequency).collect();
    all.sort_by(f64::total_cmp);
    let twice = all.windows(2).find(|pair| pair[0].total_cmp(&pair[1]).is_eq())?[0];
    let what = format!("the frequency {twice} Hz is there more than once");
    Some(scene.warning(
        About::Frequencies,
        what,
        "remove it where it is repeated, or let the sweep have a length",
    ))
}

/// A scene that is next to nothing beside the wave: a frequency in other units, most probably.
fn lost_in_the_wave(scene: &WaveScene, pieces: &Pieces) -> Option<Warning> {
    let longest = scene.waves().iter().map(fredholm_waves::Wave::wavelength).fold(0.0, f64::max);
    let share = pieces.extent / longest;
    let warning = || {
        let what = format!("the surfaces are {share:.1e} wavelengths of {longest:.3e} m from end to end");
        let help = "are the frequencies in Hz and the lengths in metres? results so far below a wavelength lose digits";
        scene.warning(About::Frequencies, what, help)
    };
    (share < LEAST_EXTENT).then(warning)
}

/// Layers on closed bodies, which let nothing through.
fn slabs_on_bodies(scene: &WaveScene) -> Result<Vec<Warning>, SceneError> {
    let Some(wave) = scene.waves().first() else { return Ok(vec![]) };
    let materials = scene.materials(wave)?;
    let slab = |part: &super::surface::Part| {
        part.kind == Kind::Closed && matches!(materials.get(part.material), Some(Material::Slab(_)))
    };
    let warning = |(number, part): (usize, &super::surface::Part)| {
        let what = format!("the layers of `{}` let nothing through: it is a closed body", part.name);
        scene.warning(
            About::Surface(number),
            what,
            "take sheets (closed = false) for walls, or a half_space for a solid",
        )
    };
    Ok(scene.parts().iter().enumerate().filter(|(_, part)| slab(part)).map(warning).collect())
}

/// Refuses thin sheets on closed bodies, in which there is no field that could be the same on both
/// sides.
fn films_on_bodies(scene: &WaveScene) -> Result<(), SceneError> {
    let Some(wave) = scene.waves().first() else { return Ok(()) };
    let materials = scene.materials(wave)?;
    let film = |part: &super::surface::Part| {
        part.kind == Kind::Closed && matches!(materials.get(part.material), Some(Material::Sheet(_)))
    };
    let Some(number) = scene.parts().iter().position(film) else { return Ok(()) };
    let what = format!("`{}` is a closed body, but its material is a thin sheet", scene.parts()[number].name);
    let help = "write closed = false for a shell with fields on both sides, or impedance_ohm for a body";
    Err(scene.error(About::Surface(number), ErrorKind::Value, what, help))
}

/// Sheets inside of closed bodies, where there is no field.
fn sheets_inside(scene: &WaveScene, pieces: &Pieces, bodies: &[Body]) -> Vec<Warning> {
    let components = pieces.topology.components.iter();
    let sheets = components.filter(|component| !pieces.is_closed(scene, component.first));
    let warning = |component: &fredholm_mesh::Component| {
        let (part, p) =
            (pieces.part_of[component.first as usize], pieces.patches[component.first as usize].centroid());
        let outer = bodies.iter().find(|body| body.holds(p))?;
        let what = format!(
            "`{}` lies inside the closed body `{}`",
            scene.parts()[part].name,
            scene.parts()[outer.part].name
        );
        Some(scene.warning(
            About::Surface(part),
            what,
            "remove it, or make the outer one a thin sheet: closed = false",
        ))
    };
    sheets.filter_map(warning).take(MOST_PAIRS_TOLD).collect()
}

/// Distance of a point from a patch, m.
fn distance(patch: &Patch, p: Vec3) -> f64 {
    let normal = patch.normal();
    let inside = (0..patch.sides()).all(|i| {
        let (a, b) = (patch.corner(i), patch.corner(i + 1));
        (b - a).cross(p - a).dot(normal) >= 0.0
    });
    if inside {
        return (p - patch.corner(0)).dot(normal).abs();
    }
    let side = |i: usize| {
        let (a, b) = (patch.corner(i), patch.corner(i + 1));
        let share = (p - a).dot(b - a) / (b - a).length_squared();
        p.distance(a.lerp(b, share.clamp(0.0, 1.0)))
    };
    (0..patch.sides()).map(side).fold(f64::INFINITY, f64::min)
}

/// Whether a segment goes through a patch.
fn crosses(patch: &Patch, [a, b]: [Vec3; 2], near: f64) -> bool {
    let normal = patch.normal();
    let [h, k] = [a, b].map(|p| (p - patch.corner(0)).dot(normal));
    h * k <= 0.0 && (h - k).abs() > 0.0 && is_on(patch, a.lerp(b, h / (h - k)), near)
}

/// Sources without a field, and those so near to a surface that its facets do not follow their
/// field.
fn weak_or_near(scene: &WaveScene, pieces: &Pieces) -> Vec<Warning> {
    let waves = scene.waves();
    let shortest = waves.iter().map(fredholm_waves::Wave::wavelength).fold(f64::INFINITY, f64::min);
    let Some(wave) = waves.first() else { return vec![] };
    let mut warnings = vec![];
    for (number, placed) in scene.sources().iter().enumerate() {
        let place = match placed.source.origin() {
            Origin::Point(p) => p,
            Origin::Direction(_) => Vec3::ZERO,
        };
        let beside = place + Vec3::new(0.36, 0.48, 0.8) * wave.wavelength();
        if placed.source.field(wave, beside).e.norm() == 0.0 {
            let what = "the source has no strength: all fields are 0".to_owned();
            warnings.push(scene.warning(
                About::Source(number),
                what,
                "give it an amplitude, a current or a power above 0",
            ));
        }
        let Origin::Point(p) = placed.source.origin() else { continue };
        let closest =
            pieces.patches.iter().zip(&pieces.part_of).map(|(patch, &part)| (distance(patch, p), part));
        let Some((gap, part)) = closest.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        let part = &scene.parts()[part];
        if gap < 0.5 * part.edge.metres(shortest) {
            let what = format!(
                "the source is {gap:.2e} m from `{}`, whose facets of {:.2e} m do not follow its field",
                part.name,
                part.edge.metres(shortest)
            );
            warnings.push(scene.warning(
                About::Source(number),
                what,
                "take a shorter edge there, or move the source away",
            ));
        }
    }
    warnings
}

/// Refuses surfaces declared closed that have open sides, or faces turned differently. Where
/// corners lie inside the sides of others, open sides may be closed by several, which is not told
/// apart.
fn closed(scene: &WaveScene, pieces: &Pieces) -> Result<Option<Warning>, SceneError> {
    let Topology { open, clashes, junctions, .. } = &pieces.topology;
    let part = |piece: u32| pieces.part_of[piece as usize];
    let of_closed = |piece: &u32| pieces.is_closed(scene, *piece);
    if let Some(([a, b], clash)) = clashes.iter().find(|(_, clash)| clash.iter().all(of_closed)) {
        let number = part(clash[1]);
        let what = format!(
            "neighbouring faces of the closed body `{}` are turned differently: both run from {} to {} m",
            scene.parts()[number].name,
            told(*a),
            told(*b)
        );
        let help = "list the corners of one of them in the other direction";
        return Err(scene.error(About::Surface(number), ErrorKind::Geometry, what, help));
    }
    let mut open = open.iter().filter(|(_, piece)| of_closed(piece));
    let Some(([a, b], piece)) = open.next() else { return Ok(None) };
    let number = part(*piece);
    let what = format!(
        "`{}` is declared part of a closed body, which is open: {} sides belong to one face only, the first \
         from {} to {} m",
        scene.parts()[number].name,
        1 + open.count(),
        told(*a),
        told(*b)
    );
    if let Some(p) = junctions.first() {
        let what = format!(
            "whether `{}` is closed cannot be told, since corners lie inside the sides of others, such as at {} m",
            scene.parts()[number].name,
            told(*p)
        );
        let help = "divide the sides there, so that corners meet corners";
        return Ok(Some(scene.warning(About::Surface(number), what, help)));
    }
    let help = "add what closes the body, or write closed = false for a thin sheet";
    Err(scene.error(About::Surface(number), ErrorKind::Geometry, what, help))
}

/// Bodies of mesh files whose normals point inwards.
fn inside_out(scene: &WaveScene, bodies: &[Body]) -> Vec<Warning> {
    let wrong = bodies.iter().filter(|body| body.hollow && scene.parts()[body.part].imported);
    let warning = |body: &Body| {
        let what = format!(
            "the normals of `{}` point inwards, so that the body is what lies around it, as of a room",
            scene.parts()[body.part].name
        );
        scene.warning(About::Surface(body.part), what, "turn its faces in the program that made the file")
    };
    wrong.map(warning).collect()
}

impl WaveScene {
    fn warning(&self, about: About, what: String, help: &str) -> Warning {
        let (file, place) = (self.path().to_owned(), self.source().place(self.span(about)));
        Warning { file, place, what, help: help.to_owned() }
    }

    /// Refuses for equations of closed bodies what physical optics is only warned about.
    fn refuse_or_warn(&self, surface: usize, what: String, help: &str) -> Result<Warning, SceneError> {
        if self.settings().method.is_some_and(Method::is_equation) {
            return Err(self.error(About::Surface(surface), ErrorKind::Geometry, what, help));
        }
        Ok(self.warning(About::Surface(surface), what, help))
    }
}

/// Faces that lie on each other, unless bodies may touch, and closed bodies that cross.
fn overlaps(scene: &WaveScene, pieces: &Pieces, touching: bool) -> Result<Vec<Warning>, SceneError> {
    let contacts = Contacts::of(&pieces.patches);
    let mut pairs: BTreeMap<[usize; 2], &str> = BTreeMap::new();
    let key = |pair: [u32; 2]| {
        let [a, b] = pair.map(|piece| pieces.part_of[piece as usize]);
        [a.min(b), a.max(b)]
    };
    for overlap in contacts.overlaps.iter().filter(|_| !touching) {
        pairs.insert(key(overlap.pieces), "lie on each other, so that their currents count twice");
    }
    for crossing in &contacts.crossings {
        if crossing.iter().any(|piece| pieces.is_closed(scene, *piece)) {
            pairs.entry(key(*crossing)).or_insert("cross, so that parts of them are inside a body");
        }
    }
    let told = pairs.iter().take(MOST_PAIRS_TOLD).map(|([first, second], how)| {
        let name = |part: usize| &scene.parts()[part].name;
        let who = if first == second {
            format!("faces of `{}`", name(*first))
        } else {
            format!("`{}` and `{}`", name(*first), name(*second))
        };
        let help = "move them apart, or make them one body without the faces inside";
        scene.refuse_or_warn(*second, format!("{who} {how}"), help)
    });
    told.collect()
}

/// Bodies inside of others.
fn nested(scene: &WaveScene, bodies: &[Body]) -> Result<Vec<Warning>, SceneError> {
    let mut warnings = vec![];
    for (number, body) in bodies.iter().enumerate() {
        let first = body.patches[0].centroid();
        let around = |(other, outer): &(usize, &Body)| *other != number && outer.holds(first);
        if let Some((_, outer)) = bodies.iter().enumerate().find(around) {
            let name = |body: &Body| &scene.parts()[body.part].name;
            let what = format!("`{}` lies inside the closed body `{}`", name(body), name(outer));
            let help = "remove it, or make the outer one a thin sheet: closed = false";
            warnings.push(scene.refuse_or_warn(body.part, what, help)?);
        }
    }
    Ok(warnings)
}

/// Refuses sources inside bodies or on surfaces.
fn sources(scene: &WaveScene, pieces: &Pieces, bodies: &[Body]) -> Result<(), SceneError> {
    for (number, placed) in scene.sources().iter().enumerate() {
        let Origin::Point(p) = placed.source.origin() else { continue };
        let refuse = |what: String| {
            let help = "move the source off the surfaces and out of the bodies";
            Err(scene.error(About::Source(number), ErrorKind::Geometry, what, help))
        };
        let near = ON_SURFACE * pieces.extent;
        if let Some(piece) = pieces.patches.iter().position(|patch| is_on(patch, p, near)) {
            let name = &scene.parts()[pieces.part_of[piece]].name;
            return refuse(format!("the source lies on the surface `{name}`"));
        }
        let longest = scene.waves().iter().max_by(|a, b| a.wavelength().total_cmp(&b.wavelength()));
        let wire = longest.and_then(|wave| placed.source.wire(wave));
        if let Some(piece) =
            wire.and_then(|wire| pieces.patches.iter().position(|patch| crosses(patch, wire, near)))
        {
            let name = &scene.parts()[pieces.part_of[piece]].name;
            return refuse(format!("the wire of the source goes through the surface `{name}`"));
        }
        if let Some(body) = bodies.iter().find(|body| body.holds(p)) {
            let name = &scene.parts()[body.part].name;
            return refuse(format!("the source lies inside the closed body `{name}`"));
        }
    }
    Ok(())
}

/// Whether a point is within `near` of a patch.
fn is_on(patch: &Patch, p: Vec3, near: f64) -> bool {
    let normal = patch.normal();
    let inside = |i: usize| {
        let (a, b) = (patch.corner(i), patch.corner(i + 1));
        (b - a).cross(p - a).dot(normal) >= -near * (b - a).length()
    };
    (p - patch.corner(0)).dot(normal).abs() <= near && (0..patch.sides()).all(inside)
}

/// Receivers all of whose points are inside a body.
fn receivers(scene: &WaveScene, bodies: &[Body]) -> Vec<Warning> {
    let mut warnings = vec![];
    for (number, receiver) in scene.receivers().iter().enumerate().filter(|(_, r)| r.is_near()) {
        let Places::Near { points, .. } = receiver.places() else { continue };
        let step = points.len().div_ceil(MOST_POINTS_OF_A_RECEIVER).max(1);
        let inside = |p: &Vec3| bodies.iter().any(|body| body.holds(*p));
        if points.iter().step_by(step).all(inside) {
            let what = format!("all points of the receiver `{}` lie inside closed bodies", receiver.name);
            let help = "the total field is 0 there but for errors; move them out where that is not meant";
            warnings.push(scene.warning(About::Receiver(number), what, help));
        }
    }
    warnings
}

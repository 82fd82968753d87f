//! What a mesh is, and what was done with it.

use std::fmt;

use fredholm_coupling::exposed_share;
use fredholm_mesh::{Bounds, Component, Mesh, Patch, Topology, Vec3};
use fredholm_visibility::Occluders;
use rayon::prelude::*;

use super::Warning;
use crate::part::Origin;
use crate::scene::Scene;

/// Points along a side of the grid by which a piece is found to be buried.
const POINTS_ALONG_PIECE: usize = 2;
/// Diagonals, m, outside which the unit of length is told to be looked at.
const USUAL_DIAGONALS: [f64; 2] = [0.02, 2e3];

/// One thing that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// What it is called.
    pub name: &'static str,
    /// How often it was found.
    pub count: usize,
    /// Where, what it does to the light, and what was done.
    pub what: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.count, self.name, self.what)
    }
}

/// What the mesh of a scene is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Undivided flat pieces.
    pub pieces: usize,
    /// Groups of pieces that hang together through sides that two of them share.
    pub components: usize,
    /// Those of them that are closed.
    pub closed: usize,
    /// Diagonal of the box around all, m.
    pub diagonal: f64,
    /// What is remarkable.
    pub findings: Vec<Finding>,
    /// Sides of one piece only.
    pub open: Vec<[Vec3; 2]>,
    /// The pieces, to be drawn.
    pub shown: Vec<Shown>,
}

/// A piece as it is to be shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The piece, lit on its front.
    pub patch: Patch,
    /// Whether it is lit on its back, too.
    pub two_sided: bool,
    /// Whether it is a wall of a closed room, which is looked into through its walls.
    pub wall: bool,
    /// Whether it lies on another that is lit on the same side, or crosses one.
    pub meets: bool,
}

impl Scene {
    /// Looks at the pieces of the surfaces as they come: sides that are open, shared by too many or
    /// run along in one direction by both neighbours, pieces that are repeated, thin, buried, cross
    /// or lie on each other, objects that are lit inside, and the unit of length.
    ///
    /// ```
    /// let text = "[materials.clay]\nreflectance = 0.5\n[[surface]]\nname = \"a\"\nmaterial = \"clay\"\n\
    ///             quad = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\n";
    /// let report = fredholm_scene::Scene::from_str(text, "a.toml")?.report();
    /// assert_eq!((report.pieces, report.closed, report.open.len()), (1, 0, 4));
    /// assert!(report.findings[0].to_string().starts_with("4 open sides"));
    /// # Ok::<(), fredholm_scene::SceneError>(())
    /// ```
    #[must_use]
    pub fn report(&self) -> Report {
        let pieces = self.pieces();
        let topology = Topology::of(&pieces.patches);
        let diagonal = self.diagonal();
        let mut report = Report {
            pieces: pieces.patches.len(),
            components: topology.components.len(),
            closed: topology.components.iter().filter(|component| component.closed).count(),
            diagonal,
            findings: self.findings().to_vec(),
            ..Report::default()
        };
        report.open = topology.open.iter().map(|(side, _)| *side).collect();
        report.shown = self.shown(&topology);
        sides(&topology, &mut report.findings);
        self.shapes(&topology, &mut report.findings);
        self.contacts(&mut report.findings);
        self.buried(&mut report.findings);
        let [least, most] = USUAL_DIAGONALS;
        if diagonal > 0.0 && !(least..=most).contains(&diagonal) {
            let what = format!(
                "{diagonal:.3e} m from end to end: is the unit of length right? scale of an obj tells the metres of one unit"
            );
            report.findings.push(Finding { name: "unusual size", count: 1, what });
        }
        report
    }

    fn shown(&self, topology: &Topology) -> Vec<Shown> {
        let pieces = self.pieces();
        let mut meets = vec![false; pieces.patches.len()];
        let double = pieces.doubled().map(|overlap| overlap.pieces);
        for piece in double.chain(pieces.contacts.crossings.iter().copied()).flatten() {
            meets[piece as usize] = true;
        }
        let is_room = |component: &Component| component.closed && component.volume < 0.0;
        let shown = |(piece, patch): (usize, &Patch)| Shown {
            patch: *patch,
            two_sided: pieces.two_sided[pieces.part_of[piece]],
            wall: is_room(&topology.components[topology.component_of[piece] as usize]),
            meets: meets[piece],
        };
        pieces.patches.iter().enumerate().map(shown).collect()
    }

    fn diagonal(&self) -> f64 {
        let corners = self.pieces().patches.iter().flat_map(|patch| patch.corners().iter().copied());
        Bounds::around(corners).map_or(0.0, |bounds| bounds.diagonal())
    }

    fn shapes(&self, topology: &Topology, findings: &mut Vec<Finding>) {
        let patches = &self.pieces().patches;
        let centre = |piece: Option<u32>| at(piece.map(|k| patches[k as usize].centroid()).as_ref());
        let name = |component: &Component| &self.parts()[self.pieces().part(component.first)].name;
        let inward: Vec<&Component> = topology.inward().collect();
        let what = inward.first().map_or_else(String::new, |component| {
            format!(
                "the first in `{}`; closed and lit inside, as a room is: no light from outside reaches it",
                name(component)
            )
        });
        add(findings, "objects lit inside", inward.len(), what);
        let reversed = topology.repeats.iter().filter(|repeat| repeat.reversed);
        let what = format!(
            "the first at {} m; lit on the other side: together a plate that is lit on both",
            centre(reversed.clone().next().map(|repeat| repeat.second))
        );
        add(findings, "faces repeated in reverse", reversed.count(), what);
        let same = topology.repeats.iter().filter(|repeat| !repeat.reversed);
        let what = format!(
            "the first at {} m; only one of them is there",
            centre(same.clone().next().map(|repeat| repeat.second))
        );
        add(findings, "repeated faces", same.count(), what);
        let what = format!(
            "the first at {} m; lower than a thousandth of their longest side",
            centre(topology.slivers.first().copied())
        );
        add(findings, "slivers", topology.slivers.len(), what);
    }

    fn contacts(&self, findings: &mut Vec<Finding>) {
        let pieces = self.pieces();
        let doubled = pieces.doubled();
        let (count, area) = doubled.fold((0, 0.0), |(count, area), overlap| (count + 1, area + overlap.area));
        let what = format!(
            "over {area:.3e} m², the first at {} m; only one of them is there: a lamp, else the smaller face, else the first",
            at(pieces.doubled().next().map(|overlap| overlap.place).as_ref())
        );
        add(findings, "faces on each other, lit on the same side", count, what);
        let first = pieces.contacts.crossings.first().map(|[a, _]| pieces.patches[*a as usize].centroid());
        let what = format!(
            "the first near {} m; what lies inside an object sees backs only and is black",
            at(first.as_ref())
        );
        add(findings, "pairs of faces that cross", pieces.contacts.crossings.len(), what);
    }

    /// Pieces from which every ray ends on the back of a face.
    fn buried(&self, findings: &mut Vec<Finding>) {
        let pieces = self.pieces();
        let backs = pieces.patches.iter().zip(&pieces.part_of).filter(|(_, part)| pieces.two_sided[**part]);
        let backs: Vec<Patch> = backs.map(|(patch, _)| patch.flipped()).collect();
        let lit: Vec<Patch> = pieces.patches.iter().chain(&backs).copied().collect();
        // What is too large or too small for the ray caster is refused when it is solved.
        let Ok(occluders) = Occluders::new(&lit) else { return };
        let all: Vec<&Patch> = lit.iter().collect();
        let buried: Vec<bool> = pieces
            .patches
            .par_iter()
            .map(|patch| exposed_share(patch, POINTS_ALONG_PIECE, &all, &occluders) <= 0.0)
            .collect();
        let first = pieces.patches.iter().zip(&buried).find(|(_, buried)| **buried);
        let what = format!(
            "the first at {} m; they see backs only, such as the inside of an object, and stay black",
            at(first.map(|(p, _)| p.centroid()).as_ref())
        );
        add(findings, "buried faces", buried.iter().filter(|buried| **buried).count(), what);
    }
}

/// What is remarkable about sides.
fn sides(topology: &Topology, findings: &mut Vec<Finding>) {
    let first = |side: Option<&[Vec3; 2]>| {
        side.map_or_else(String::new, |[a, b]| format!("the first from {a} to {b} m"))
    };
    let open = topology.open.first().map(|(side, _)| side);
    let what = format!("{}; light passes there, and a face is black from behind", first(open));
    add(findings, "open sides", topology.open.len(), what);
    let what = format!("{}; that does no harm", first(topology.crowded.first()));
    add(findings, "sides of more than two faces", topology.crowded.len(), what);
    let clash = topology.clashes.first().map(|(side, _)| side);
    let what = format!(
        "{}; objects of a file that have them are lit on both sides, unless two_sided = false is set",
        first(clash)
    );
    add(findings, "sides with neighbours turned differently", topology.clashes.len(), what);
    let what = format!(
        "the first at {} m; faces meet there to rounding, which lets no light through",
        at(topology.junctions.first())
    );
    add(findings, "corners inside sides of others", topology.junctions.len(), what);
}

/// Objects of files that are closed, lit inside, and hold no lamp: turned inside out.
pub(super) fn inside_out(scene: &Scene, mesh: &Mesh) -> Vec<Warning> {
    let pieces = scene.pieces();
    let topology = Topology::of(&pieces.patches);
    let mut bounds: Vec<Option<Bounds>> = vec![None; topology.components.len()];
    let mut imported = vec![true; topology.components.len()];
    for (piece, &component) in topology.component_of.iter().enumerate() {
        let corners = pieces.patches[piece].corners().iter().copied();
        let known = bounds[component as usize].map(|b| [b.min, b.max]).into_iter().flatten();
        bounds[component as usize] = Bounds::around(corners.chain(known));
        let part = pieces.part_of[piece];
        imported[component as usize] &=
            scene.parts()[part].origin == Origin::MeshFile && !pieces.two_sided[part];
    }
    let lamps: Vec<Vec3> = (0..mesh.len())
        .filter(|&leaf| scene.emits(mesh.surfaces()[mesh.surface_of(leaf)].material))
        .map(|leaf| mesh.patch(leaf).centroid())
        .collect();
    let holds_lamp = |bounds: &Option<Bounds>| {
        bounds.is_some_and(|b| lamps.iter().any(|&p| p.cmpge(b.min).all() && p.cmple(b.max).all()))
    };
    let wrong = topology.components.iter().zip(bounds.iter().zip(imported));
    let wrong = wrong
        .filter(|(c, (bounds, imported))| c.closed && c.volume < 0.0 && *imported && !holds_lamp(bounds));
    let wrong: Vec<usize> = wrong.map(|(component, _)| pieces.part(component.first)).collect();
    let Some(&first) = wrong.first() else { return vec![] };
    let what = format!(
        "{} closed objects, the first in `{}`, are lit inside and hold no lamp: they are black from outside",
        wrong.len(),
        scene.parts()[first].name
    );
    vec![scene.warning(
        first,
        what,
        "turn their faces in the program that made the file, or set two_sided = true",
    )]
}

fn add(findings: &mut Vec<Finding>, name: &'static str, count: usize, what: String) {
    if count > 0 {
        findings.push(Finding { name, count, what });
    }
}

fn at(point: Option<&Vec3>) -> String {
    point.map_or_else(String::new, |p| {
        let [x, y, z] = p.to_array().map(|x| (1e6 * x).round() / 1e6);
        format!("({x}, {y}, {z})")
    })
}

//! Refinement: pairs of nodes that are too coarse become pairs of their children, until every pair is fine enough for the oracle.
//!
//! It goes in waves. In each, every pair is judged by itself, in parallel; then the nodes to be split are split in the order of the pairs, and the pairs of children
//! make the next wave. So the links do not depend on the number of threads. What a pair sees wholly its parts see wholly, and what sees nothing is gone.

use crate::oracle::{Candidate, Light, Oracle, Verdict};
use crate::transport::{Meeting, Side, Sight, View, Viewer, encounter, exchanges, spread};
use crate::tree::{Node, Tree};
use crate::{HierarchyError, Link, Watch};
use fredholm_mesh::Patch;
use rayon::prelude::*;

/// Pairs that one thread takes at a time.
const CHUNK: usize = 256;

/// A pair of nodes to be judged.
#[derive(Clone, Copy, Debug)]
struct Pair {
    nodes: [u32; 2],
    /// Whether nothing can be between.
    open: bool,
    /// Whether it is known to be too coarse, by its first node.
    coarse: bool,
}

/// What becomes of a pair.
enum Fate {
    Gone,
    Link(Link),
    /// The first is replaced by its children.
    Split(Pair),
}

/// Limits of a refinement.
pub(crate) struct Limits<'a> {
    /// Relative error that one link may leave.
    pub threshold: f64,
    /// Whether links have gradients.
    pub linear: bool,
    /// Elements are not made smaller than this, m².
    pub least_area: f64,
    /// Relative tolerance of exchanges.
    pub tolerance: f64,
    /// Bytes that tree and links may take.
    pub bytes: u64,
    /// Whether to go on.
    pub watch: &'a dyn Watch,
}

/// The links that the refinement left.
pub(crate) struct Refined {
    pub links: Vec<Link>,
    /// Whether memory ended it.
    pub limited: bool,
}

/// Bytes after a wave of which all children become links.
fn needed(tree: &Tree, fates: &[Fate], links: usize) -> u64 {
    let mut pairs = links;
    let mut split: Vec<u32> = Vec::new();
    for fate in fates {
        match fate {
            Fate::Gone => {}
            Fate::Link(_) => pairs += 1,
            Fate::Split(pair) => {
                pairs += 4;
                split.push(pair.nodes[0]);
            }
        }
    }
    split.retain(|&node| tree.nodes()[node as usize].is_leaf());
    split.sort_unstable();
    split.dedup();
    bytes(tree, pairs) + (4 * split.len() * (size_of::<Node>() + NODE_WORK)) as u64
}

/// Bytes of a tree and its links.
pub(crate) fn bytes(tree: &Tree, links: usize) -> u64 {
    let nodes = (tree.nodes().len() * (size_of::<Node>() + NODE_WORK)) as u64;
    nodes + links as u64 * Link::BYTES
}

/// Bytes of a node in the operator and in the preparation of exchanges.
const NODE_WORK: usize = 512;

/// Refines links, or the pair of the whole scene with itself where there are none yet.
pub(crate) fn refine(
    tree: &mut Tree,
    links: Option<Vec<Link>>,
    light: &mut Light,
    sight: Sight,
    limits: &Limits,
) -> Result<Refined, HierarchyError> {
    let (mut kept, mut fresh) = (Vec::new(), Vec::new());
    let mut wave = match links {
        None => vec![Pair { nodes: [0, 0], open: false, coarse: true }],
        Some(links) => sift(tree, links, light, limits, &mut kept),
    };
    let mut limited = false;
    while !wave.is_empty() {
        if limits.watch.poll().is_break() {
            return Err(HierarchyError::Interrupted);
        }
        let threshold = if limited { f64::INFINITY } else { limits.threshold };
        let oracle = Oracle { tree, light, threshold, linear: limits.linear, least_area: limits.least_area };
        let fates = judge(&oracle, sight, &wave);
        if !limited && needed(tree, &fates, kept.len() + fresh.len()) > limits.bytes {
            limited = true;
            // Once more, and nothing is too coarse now but what cannot be a link.
            for pair in &mut wave {
                pair.coarse = false;
            }
            continue;
        }
        wave = advance(tree, light, fates, &mut fresh)?;
    }
    fresh.par_sort_unstable_by_key(|link: &Link| (link.a, link.b));
    let flat = |index: u32| tree.nodes()[index as usize].patch().is_some();
    let (mut fresh, bent): (Vec<Link>, Vec<Link>) =
        fresh.into_iter().partition(|link| flat(link.a) && flat(link.b));
    exchanges(tree, &mut fresh, limits.tolerance);
    kept.extend(bent);
    kept.extend(fresh.into_iter().filter(|link| link.open > 0.0));
    kept.par_sort_unstable_by_key(|link| (link.a, link.b));
    Ok(Refined { links: kept, limited })
}

/// Parts links into those that stay and pairs to be split.
fn sift(tree: &Tree, links: Vec<Link>, light: &Light, limits: &Limits, kept: &mut Vec<Link>) -> Vec<Pair> {
    let oracle = Oracle {
        tree,
        light,
        threshold: limits.threshold,
        linear: limits.linear,
        least_area: limits.least_area,
    };
    let verdicts: Vec<Verdict> = links.par_iter().map(|link| oracle.judge(&candidate(link))).collect();
    let mut wave = Vec::new();
    for (link, verdict) in links.into_iter().zip(verdicts) {
        let pair = Pair { nodes: [link.a, link.b], open: !link.partly, coarse: true };
        match verdict {
            Verdict::Keep => kept.push(link),
            Verdict::SplitA => wave.push(pair),
            Verdict::SplitB => wave.push(swapped(pair)),
        }
    }
    wave
}

fn candidate(link: &Link) -> Candidate {
    Candidate {
        nodes: [link.a, link.b],
        open: link.open,
        sides: [0, 1].map(|k| [link.deviation[k], link.rest[k]].map(f64::from)),
        doubt: f64::from(link.doubt),
    }
}

fn judge(oracle: &Oracle, sight: Sight, wave: &[Pair]) -> Vec<Fate> {
    let chunks = wave.par_chunks(CHUNK);
    let judged = chunks.map_init(
        || Viewer::new(sight),
        |viewer, pairs| pairs.iter().map(|pair| fate(oracle, viewer, *pair)).collect::<Vec<_>>(),
    );
    judged.collect::<Vec<_>>().into_iter().flatten().collect()
}

fn fate(oracle: &Oracle, viewer: &mut Viewer, pair: Pair) -> Fate {
    if pair.coarse {
        return Fate::Split(pair);
    }
    let [a, b] = pair.nodes.map(|index| &oracle.tree.nodes()[index as usize]);
    if pair.nodes[0] == pair.nodes[1] {
        return match a.patch() {
            Some(_) => Fate::Gone,
            None if a.is_linkable() => bent(oracle, viewer, pair),
            None => Fate::Split(pair),
        };
    }
    if a.cone().turned_away(b.cone()) {
        return Fate::Gone;
    }
    match (a.patch(), b.patch()) {
        (Some(p), Some(q)) => flat(oracle, viewer, pair, [p, q]),
        (Some(p), None) if b.cone().apart_from(p) => Fate::Gone,
        (None, Some(q)) if a.cone().apart_from(q) => Fate::Gone,
        _ if a.is_linkable() && b.is_linkable() => bent(oracle, viewer, pair),
        _ if b.is_linkable() => Fate::Split(pair),
        _ if a.is_linkable() || a.cone().radius < b.cone().radius => Fate::Split(swapped(pair)),
        _ => Fate::Split(pair),
    }
}

/// The fate of two nodes of which at least one is bent, or of a bent one with itself.
fn bent(oracle: &Oracle, viewer: &mut Viewer, pair: Pair) -> Fate {
    let Meeting { open, share, sides, doubt } = encounter(oracle.tree, pair.nodes, viewer);
    let deviations = sides.map(|side| [side.deviation, side.rest]);
    let candidate = Candidate { nodes: pair.nodes, open, sides: deviations, doubt };
    match oracle.judge(&candidate) {
        Verdict::SplitA => Fate::Split(pair),
        Verdict::SplitB => Fate::Split(swapped(pair)),
        Verdict::Keep => Fate::Link(Link { open, ..link(pair, sides, [share, doubt], oracle.linear) }),
    }
}

fn swapped(pair: Pair) -> Pair {
    let [a, b] = pair.nodes;
    Pair { nodes: [b, a], ..pair }
}

/// The fate of two flat nodes.
fn flat(oracle: &Oracle, viewer: &mut Viewer, pair: Pair, [p, q]: [&Patch; 2]) -> Fate {
    if behind(p, q) || behind(q, p) {
        return Fate::Gone;
    }
    let view = if pair.open { View::Open } else { viewer.view(p, q) };
    let seen = spread(p, q, &mut viewer.front);
    let (share, sides, doubt, open) = match view {
        View::Nothing => return Fate::Gone,
        View::Open => (1.0, seen.sides, 0.0, true),
        View::Part { share, sides, doubt } => {
            // Where nothing stands in the way of the points, the open pair still varies.
            let varied = |k: usize| Side {
                deviation: sides[k].deviation.max(share * seen.sides[k].deviation),
                rest: sides[k].rest.max(share * seen.sides[k].rest),
                ..sides[k]
            };
            (share, [varied(0), varied(1)], doubt, false)
        }
    };
    let candidate = Candidate {
        nodes: pair.nodes,
        open: seen.exchange,
        sides: sides.map(|side| [side.deviation, side.rest]),
        doubt,
    };
    let pair = Pair { open, ..pair };
    match oracle.judge(&candidate) {
        Verdict::SplitA => Fate::Split(pair),
        Verdict::SplitB => Fate::Split(swapped(pair)),
        Verdict::Keep => Fate::Link(link(pair, sides, [share, doubt], oracle.linear)),
    }
}

fn link(pair: Pair, sides: [Side; 2], [share, doubt]: [f64; 2], linear: bool) -> Link {
    let [a, b] = pair.nodes;
    let [p, q] = if a < b { sides } else { [sides[1], sides[0]] };
    let gradient = |side: Side| if linear { side.gradient.as_vec3() } else { glam::Vec3::ZERO };
    Link {
        a: a.min(b),
        b: a.max(b),
        open: 0.0,
        share: share as f32,
        doubt: doubt as f32,
        deviation: [p.deviation as f32, q.deviation as f32],
        rest: [p.rest as f32, q.rest as f32],
        gradient: [gradient(p), gradient(q)],
        partly: !pair.open,
    }
}

/// Whether no point of `p` is in front of `q`.
fn behind(p: &Patch, q: &Patch) -> bool {
    let flat = 1e-12 * (p.centroid().distance(q.centroid()) + p.diameter() + q.diameter());
    p.corners().iter().all(|x| (*x - q.corner(0)).dot(q.normal()) <= flat)
}

/// Splits nodes and makes the next wave.
fn advance(
    tree: &mut Tree,
    light: &mut Light,
    fates: Vec<Fate>,
    links: &mut Vec<Link>,
) -> Result<Vec<Pair>, HierarchyError> {
    let mut wave = Vec::new();
    for fate in fates {
        match fate {
            Fate::Gone => {}
            Fate::Link(link) => links.push(link),
            Fate::Split(pair) => children(tree, light, pair, &mut wave)?,
        }
    }
    Ok(wave)
}

/// Appends the pairs that take the place of a pair whose first node is split.
fn children(
    tree: &mut Tree,
    light: &mut Light,
    pair: Pair,
    wave: &mut Vec<Pair>,
) -> Result<(), HierarchyError> {
    let Pair { nodes: [a, b], open, .. } = pair;
    tree.split(a)?;
    light.inherit(tree, a);
    let children = tree.nodes()[a as usize].children();
    if a == b {
        for (k, &child) in children.iter().enumerate() {
            wave.extend(children[k..].iter().map(|&other| Pair {
                nodes: [child, other],
                open,
                coarse: false,
            }));
        }
    } else {
        wave.extend(children.iter().map(|&child| Pair { nodes: [child, b], open, coarse: false }));
    }
    Ok(())
}

//! Random pairs of patches of every kind that a scene can hold, from a fixed seed.

use crate::reference::front;
use fredholm_mesh::{Patch, Vec3};
use std::f64::consts::{PI, TAU};

/// SplitMix64: G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014, doi:10.1145/2660193.2660195.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Even in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Even in the logarithm.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub fn direction(&mut self) -> Vec3 {
        let (z, angle) = (self.between(-1.0, 1.0), self.between(0.0, TAU));
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * angle.cos(), r * angle.sin(), z)
    }
}

/// Two unit vectors that span the plane with this normal, u × v = n.
pub fn axes(n: Vec3, random: &mut Random) -> [Vec3; 2] {
    let u = loop {
        let u = random.direction().cross(n);
        if u.length() > 0.1 {
            break u.normalize();
        }
    };
    [u, n.cross(u)]
}

/// A convex triangle or quad about `centre` facing `n`: points of an ellipse of half axes `size`
/// and `size / aspect`.
pub fn polygon(centre: Vec3, n: Vec3, size: f64, aspect: f64, random: &mut Random) -> Patch {
    let [u, v] = axes(n, random);
    let sides = 3 + random.below(2);
    loop {
        let start = random.between(0.0, TAU);
        let corners: Vec<Vec3> = (0..sides)
            .map(|k| start + TAU * (k as f64 + random.between(0.0, 0.7)) / sides as f64)
            .map(|t| centre + u * (size * t.cos()) + v * (size / aspect * t.sin()))
            .collect();
        if let Some(patch) = patch(&corners) {
            return patch;
        }
    }
}

pub fn patch(corners: &[Vec3]) -> Option<Patch> {
    match *corners {
        [a, b, c] => Patch::triangle([a, b, c]).ok(),
        [a, b, c, d] => Patch::quad([a, b, c, d]).ok().flatten(),
        _ => None,
    }
}

/// How two patches lie to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Apart,
    Near,
    SharedEdge,
    SharedCorner,
    /// A shared edge pulled apart by this part of the size.
    Gap(f64),
    /// Nearly in one plane: an edge shared under an angle just below 180°.
    Grazing,
    /// Plates face to face at this part of their size.
    Plates(f64),
    /// Aspect ratio, apart or near.
    Sliver(f64),
    /// Slivers that share their long edge.
    SliverEdge(f64),
    Crossing,
    /// Ratio of sizes.
    Sizes(f64),
    /// A small patch that stands on a large one, away from its edges.
    Standing(f64),
}

pub const KINDS: [Kind; 20] = [
    Kind::Apart,
    Kind::Near,
    Kind::SharedEdge,
    Kind::SharedCorner,
    Kind::Gap(1e-3),
    Kind::Gap(1e-6),
    Kind::Gap(1e-9),
    Kind::Grazing,
    Kind::Plates(0.1),
    Kind::Plates(1e-3),
    Kind::Sliver(1e2),
    Kind::Sliver(1e4),
    Kind::SliverEdge(1e2),
    Kind::SliverEdge(1e4),
    Kind::Crossing,
    Kind::Sizes(1e1),
    Kind::Sizes(1e2),
    Kind::Sizes(1e3),
    Kind::Standing(1e-1),
    Kind::Standing(1e-3),
];

/// A pair of which parts face each other.
pub fn pair(kind: Kind, random: &mut Random) -> [Patch; 2] {
    loop {
        if let Some([a, b]) = attempt(kind, random)
            && front(&a, &b).len() >= 3
            && front(&b, &a).len() >= 3
        {
            return [a, b];
        }
    }
}

fn attempt(kind: Kind, random: &mut Random) -> Option<[Patch; 2]> {
    let n = random.direction();
    match kind {
        Kind::Apart => Some(free(n, (1.0, 1.0), (3.0, 20.0), 1.0, random)),
        Kind::Near => Some(free(n, (1.0, 1.0), (0.3, 3.0), 1.0, random)),
        Kind::Crossing => Some(free(n, (1.0, 1.0), (0.3, 1.5), 1.0, random)),
        Kind::Sliver(aspect) => Some(free(n, (1.0, 1.0), (0.05, 5.0), aspect, random)),
        Kind::Sizes(ratio) => Some(free(n, (1.0, 1.0 / ratio), (0.1, 3.0), 1.0, random)),
        Kind::SharedEdge => folded(1.0, 0.0, random),
        Kind::SliverEdge(aspect) => folded(aspect, 0.0, random),
        Kind::Gap(gap) => folded(1.0, gap, random),
        Kind::SharedCorner => cornered(random),
        Kind::Grazing => grazing(random),
        Kind::Plates(gap) => {
            let a = polygon(Vec3::ZERO, n, 1.0, 1.0, random);
            let aside = random.direction() * 0.3;
            let centre = n * gap + aside - n * aside.dot(n);
            Some([a, polygon(centre, -n, 1.0, 1.0, random)])
        }
        Kind::Standing(size) => {
            let a = polygon(Vec3::ZERO, n, 1.0, 1.0, random);
            let [u, _] = axes(n, random);
            let start = a.centroid() + u * random.between(-0.1, 0.1);
            let height = n * (size * random.between(0.5, 2.0));
            let b = [start, start + u * size, start + u * size + height, start + height];
            let b = if random.below(2) == 0 { b } else { [b[1], b[0], b[3], b[2]] };
            patch(&b).map(|b| [a, b])
        }
    }
}

/// Two patches with centres at a random distance, the second one turned so that it may face the
/// first.
fn free(n: Vec3, size: (f64, f64), distance: (f64, f64), aspect: f64, random: &mut Random) -> [Patch; 2] {
    let towards = random.direction();
    let centre = towards * random.scale(distance.0, distance.1);
    let facing = (random.direction() - towards).normalize();
    let [one, two] = [aspect, if random.below(2) == 0 { aspect } else { 1.0 }];
    [polygon(Vec3::ZERO, n, size.0, one, random), polygon(centre, facing, size.1, two, random)]
}

/// A patch on an edge from `p` to `q`, in the half-plane of `across`, `depth` deep.
fn on_edge(p: Vec3, q: Vec3, across: Vec3, depth: f64, random: &mut Random) -> Option<Patch> {
    let along = q - p;
    let at = |s: f64, t: f64| p + along * s + across * (depth * t);
    let (s, t) = (random.between(-0.2, 0.4), random.between(0.3, 1.0));
    let far = [at(random.between(0.6, 1.2), random.between(0.3, 1.0)), at(s, t)];
    if random.below(2) == 0 { patch(&[p, q, far[0], far[1]]) } else { patch(&[p, q, far[0]]) }
}

/// Two patches on one edge that open by a random angle, or pulled apart by a gap.
fn folded(aspect: f64, gap: f64, random: &mut Random) -> Option<[Patch; 2]> {
    let angle = random.between(0.05, PI - 0.05);
    hinge(angle, aspect, gap, random)
}

fn grazing(random: &mut Random) -> Option<[Patch; 2]> {
    let angle = PI - random.scale(1e-6, 1e-1);
    hinge(angle, 1.0, 0.0, random)
}

fn hinge(angle: f64, aspect: f64, gap: f64, random: &mut Random) -> Option<[Patch; 2]> {
    let n = random.direction();
    let [u, v] = axes(n, random);
    let (p, q) = (Vec3::ZERO, u * random.between(0.5, 2.0));
    let a = on_edge(p, q, v, 1.0 / aspect, random)?;
    let across = v * angle.cos() + n * angle.sin();
    let middle = (v + across).normalize_or_zero() + n * 1e-3;
    let away = -middle * gap + u * (gap * random.between(-1.0, 1.0));
    let depth = if random.below(2) == 0 { 1.0 / aspect } else { 1.0 };
    let b = on_edge(q, p, across, depth, random)?;
    patch(&b.corners().iter().map(|&x| x - away).collect::<Vec<_>>()).map(|b| [a, b])
}

fn cornered(random: &mut Random) -> Option<[Patch; 2]> {
    let [a, b] = free(random.direction(), (1.0, 1.0), (0.5, 2.0), 1.0, random);
    let shift = a.corner(random.below(a.sides())) - b.corner(0);
    let mut moved: Vec<Vec3> = b.corners().iter().map(|&x| x + shift).collect();
    moved[0] = *a.corners().iter().min_by(|x, y| x.distance(moved[0]).total_cmp(&y.distance(moved[0])))?;
    patch(&moved).map(|b| [a, b])
}

/// The same pair at another size and place.
pub fn moved(pair: &[Patch; 2], scale: f64, shift: Vec3) -> Option<[Patch; 2]> {
    let put = |p: &Patch| patch(&p.corners().iter().map(|&x| x * scale + shift).collect::<Vec<_>>());
    Some([put(&pair[0])?, put(&pair[1])?])
}

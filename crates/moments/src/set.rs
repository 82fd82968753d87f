//! The triangles of some functions in every region, ready for the kernel: eight together,
//! neighbours in one eight.

use crate::element::{Element, Part, WHOLE};
use crate::element_kernel::{Table, Tests};
use crate::kernel::{Eight, Eights, WIDTH, Wanted};
use crate::operator::Kinds;
use crate::rules::{CLASSES, Rule};
use crate::{Basis, Order};
use fredholm_mesh::Vec3;
use fredholm_waves::Ground;
use std::sync::OnceLock;

/// A triangle with its circumscribed circle around the centroid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    pub(crate) centre: Vec3,
    /// Relative to the centre, m.
    pub(crate) corners: [Vec3; 3],
    /// As they were given, m.
    pub(crate) places: [Vec3; 3],
    pub(crate) radius: f64,
}

impl Shape {
    pub(crate) fn new(places: [Vec3; 3]) -> Self {
        let corners = places;
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let corners = corners.map(|corner| corner - centre);
        let radius = corners.iter().map(|corner| corner.length()).fold(0.0, f64::max);
        Self { centre, corners, places, radius }
    }

    /// The corners relative to another point, m.
    pub(crate) fn seen_from(&self, p: Vec3) -> [Vec3; 3] {
        self.places.map(|corner| corner - p)
    }

    /// The point with these weights of corners 1 and 2, relative to the centre.
    pub(crate) fn point(&self, [u, v]: [f64; 2]) -> Vec3 {
        let [a, b, c] = self.corners;
        a + u * (b - a) + v * (c - a)
    }
}

/// A half function of a set: the number of its F, the first of its unknowns among those of the set,
/// their number, its weight, and the units of the unknowns of both kinds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) number: usize,
    pub(crate) at: usize,
    pub(crate) kinds: usize,
    pub(crate) weight: f64,
    pub(crate) units: [f64; 2],
}

/// Some functions of a basis, prepared for filling blocks of a matrix.
#[derive(Debug)]
pub struct Set {
    /// Number of unknowns.
    pub(crate) len: usize,
    /// In every region.
    pub(crate) regions: Vec<Halves>,
    /// Their dual functions, where these test a part of the equation.
    pub(crate) dual: Option<Box<Self>>,
}

/// The halves of some functions in one region.
#[derive(Debug)]
pub(crate) struct Halves {
    /// Triangles in the order of their ranks.
    pub(crate) triangles: Vec<u32>,
    pub(crate) shapes: Vec<Shape>,
    pub(crate) eights: Vec<Eights>,
    /// Centres and radii once more, one array each.
    pub(crate) spheres: [Vec<f64>; 4],
    entries: Vec<Entry>,
    starts: Vec<usize>,
    points: [OnceLock<Vec<[Eight; 3]>>; CLASSES],
    /// Of functions of the first full order: the triangles themselves, with balls around them.
    pub(crate) elements: Vec<(Element, Part)>,
    tables: [OnceLock<Vec<Table>>; CLASSES],
    /// The image in the ground plane. Images of electric currents are turned over, so that their
    /// unit is −1, and those of magnetic ones are not.
    pub(crate) image: Option<Box<Self>>,
}

impl Set {
    /// Prepares some functions, which have unknowns of so many kinds, in so many regions.
    pub(crate) fn new(
        basis: &Basis,
        kinds: &[Kinds],
        regions: usize,
        functions: impl Iterator<Item = usize>,
    ) -> Self {
        let mut halves: Vec<Vec<(u32, u32, Entry)>> = vec![Vec::new(); regions];
        let mut len = 0;
        for function in functions {
            let Kinds { count, unit } = kinds[function];
            for half in &basis.functions()[function].halves {
                let number = half.number.into();
                let entry = Entry { number, at: len, kinds: count, weight: half.weight, units: [1.0, unit] };
                halves[half.region].push((basis.rank(half.triangle), half.triangle, entry));
            }
            len += count;
        }
        // Regions have numbers from that around the bodies on, which alone has a ground.
        let ground = |region: usize| basis.ground().filter(|_| region == 0);
        let in_region = |(region, halves)| Halves::new(basis, halves, ground(region));
        Self { len, regions: halves.into_iter().enumerate().map(in_region).collect(), dual: None }
    }
}

impl Halves {
    fn new(basis: &Basis, mut halves: Vec<(u32, u32, Entry)>, ground: Option<Ground>) -> Self {
        halves.sort_by_key(|&(rank, _, entry)| (rank, entry.at));
        let (mut triangles, mut starts) = (Vec::new(), Vec::new());
        for (place, &(_, triangle, _)) in halves.iter().enumerate() {
            if triangles.last() != Some(&triangle) {
                triangles.push(triangle);
                starts.push(place);
            }
        }
        starts.push(halves.len());
        let shapes: Vec<Shape> =
            triangles.iter().map(|&t| Shape::new(basis.surface().corners(t as usize))).collect();
        let elements: Vec<Element> = match basis.order() {
            Order::Lowest => Vec::new(),
            Order::First => triangles.iter().map(|&t| basis.surface().element(t as usize)).collect(),
        };
        let entries: Vec<Entry> = halves.into_iter().map(|(_, _, entry)| entry).collect();
        let image = ground.map(|ground| {
            let image = |shape: &Shape| Shape::new(shape.places.map(|place| ground.image(place)));
            let turned = |entry: &Entry| Entry { units: [-entry.units[0], entry.units[1]], ..*entry };
            let parts = (
                // No triangle has the name of an image.
                triangles.iter().map(|&triangle| !triangle).collect(),
                shapes.iter().map(image).collect(),
                entries.iter().map(turned).collect(),
                elements.iter().map(|element| element.moved(|place| ground.image(place))).collect(),
            );
            Box::new(Self::of(parts, starts.clone(), None))
        });
        Self::of((triangles, shapes, entries, elements), starts, image)
    }

    fn of(
        (triangles, shapes, entries, elements): (Vec<u32>, Vec<Shape>, Vec<Entry>, Vec<Element>),
        starts: Vec<usize>,
        image: Option<Box<Self>>,
    ) -> Self {
        let coordinate = |axis: usize| shapes.iter().map(|shape| shape.centre[axis]).collect();
        let radii = shapes.iter().map(|shape| shape.radius).collect();
        Self {
            eights: eights(&shapes),
            spheres: [coordinate(0), coordinate(1), coordinate(2), radii],
            entries,
            triangles,
            shapes,
            starts,
            points: Default::default(),
            elements: elements.into_iter().map(|element| (element, Part::new(&element, WHOLE))).collect(),
            tables: Default::default(),
            image,
        }
    }

    /// The half functions on a triangle.
    pub(crate) fn entries(&self, triangle: usize) -> &[Entry] {
        &self.entries[self.starts[triangle]..self.starts[triangle + 1]]
    }

    /// The points of a rule on eight triangles.
    pub(crate) fn points(&self, rule: &Rule, class: usize, eight: usize) -> &[[Eight; 3]] {
        let all = self.points[class].get_or_init(|| self.place(rule));
        &all[eight * rule.points.len()..(eight + 1) * rule.points.len()]
    }

    /// The functions of the first full order on a triangle, at the points of a rule.
    pub(crate) fn table(
        &self,
        rule: &Rule,
        class: usize,
        triangle: usize,
        wanted: (Wanted, Tests),
    ) -> &Table {
        let of = |(element, part): &(Element, Part)| Table::new(element, part, rule, wanted);
        &self.tables[class].get_or_init(|| self.elements.iter().map(of).collect())[triangle]
    }

    fn place(&self, rule: &Rule) -> Vec<[Eight; 3]> {
        let mut all = vec![[[0.0; WIDTH]; 3]; self.eights.len() * rule.points.len()];
        for lane in 0..self.eights.len() * WIDTH {
            let shape = &self.shapes[lane.min(self.shapes.len() - 1)];
            let first = lane / WIDTH * rule.points.len();
            for (place, &uv) in all[first..].iter_mut().zip(&rule.points) {
                let p = shape.point(uv);
                (0..3).for_each(|axis| place[axis][lane % WIDTH] = p[axis]);
            }
        }
        all
    }
}

/// Triangles in eights; the last is repeated.
fn eights(shapes: &[Shape]) -> Vec<Eights> {
    let pack = |chunk: &[Shape]| {
        let mut eights = Eights::default();
        for lane in 0..WIDTH {
            let shape = chunk[lane.min(chunk.len() - 1)];
            eights.set(lane, shape.centre, shape.corners);
        }
        eights
    };
    shapes.chunks(WIDTH).map(pack).collect()
}

//! Pairs sorted by what computes them, so that a block of lanes runs one kernel with one number of
//! points.

use super::patches::Outline;
use super::rules::MAX_POINTS;

/// Keys there can be: two outlines of two bits, two numbers of points of four bits.
const KEY_COUNT: usize = 1 << 12;
const OUTLINES: [Outline; 3] = [Outline::Parallelogram, Outline::Triangle, Outline::Quad];

/// What computes a pair, as a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Way(u16);

impl Way {
    /// Nothing to compute.
    pub(super) const BEHIND: Self = Self(0);
    /// Pair by pair.
    pub(super) const CLOSE: Self = Self(1);

    /// Gauss points along the edges, by lanes; [`Way::CLOSE`] with more than [`MAX_POINTS`].
    pub(super) fn gauss([a, b]: [Outline; 2], points: [usize; 2]) -> Self {
        if points[0].max(points[1]) > MAX_POINTS {
            return Self::CLOSE;
        }
        Self((a as u16) << 10 | (b as u16) << 8 | (points[0] << 4 | points[1]) as u16)
    }

    /// The outlines of both patches.
    pub(super) fn outlines(self) -> [Outline; 2] {
        [self.0 >> 10, self.0 >> 8].map(|bits| OUTLINES[usize::from(bits & 3) % OUTLINES.len()])
    }

    /// Points along the edges of both patches.
    pub(super) fn points(self) -> [usize; 2] {
        [self.0 >> 4, self.0].map(|bits| usize::from(bits & 15))
    }
}

/// Places in a list, sorted by way; equal ones keep their order.
#[derive(Clone, Debug, Default)]
pub(super) struct Buckets {
    counts: Vec<u32>,
    used: Vec<Way>,
    places: Vec<u32>,
}

impl Buckets {
    /// Sorts the places of `ways`, except those of pairs that lie behind each other.
    pub(super) fn sort(&mut self, ways: &[Way]) {
        self.count(ways);
        let total = self.place_starts();
        self.places.clear();
        self.places.resize(total as usize, 0);
        for (place, way) in ways.iter().enumerate().filter(|(_, way)| **way != Way::BEHIND) {
            let next = &mut self.counts[usize::from(way.0)];
            self.places[*next as usize] = place as u32;
            *next += 1;
        }
    }

    fn count(&mut self, ways: &[Way]) {
        self.counts.resize(KEY_COUNT, 0);
        self.used.drain(..).for_each(|way| self.counts[usize::from(way.0)] = 0);
        for &way in ways.iter().filter(|way| **way != Way::BEHIND) {
            let count = &mut self.counts[usize::from(way.0)];
            if *count == 0 {
                self.used.push(way);
            }
            *count += 1;
        }
    }

    /// Turns the counts of the used ways into the starts of their runs.
    fn place_starts(&mut self) -> u32 {
        let mut start = 0;
        for way in &self.used {
            let count = &mut self.counts[usize::from(way.0)];
            (*count, start) = (start, start + *count);
        }
        start
    }

    /// The used ways with the places of their pairs.
    pub(super) fn runs(&self) -> impl Iterator<Item = (Way, &[u32])> {
        let mut start = 0;
        self.used.iter().map(move |&way| {
            // After sorting, each count has moved on to the end of its run.
            let end = self.counts[usize::from(way.0)] as usize;
            (way, &self.places[std::mem::replace(&mut start, end)..end])
        })
    }
}

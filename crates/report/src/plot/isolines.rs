//! Lines of equal value through a grid of values, by marching squares: the plane case of W. E.
//! Lorensen, H. E. Cline, SIGGRAPH 1987, doi:10.1145/37402.37422. Where a cell has two corners
//! above the level across from each other, the mean of the four decides how they are joined.

use std::collections::BTreeMap;

use super::Point;

/// A grid of values, row by row.
pub(crate) struct Grid<'a> {
    pub(crate) values: &'a [f64],
    /// Values in a row.
    pub(crate) columns: usize,
    /// Whether two neighbours, by their numbers, lie on one surface, so that there are values
    /// between them.
    pub(crate) joined: &'a dyn Fn(usize, usize) -> bool,
}

/// A side of a cell: twice the number of its first value, and 1 where it goes down.
type Side = usize;

impl Grid<'_> {
    /// The lines on which the values are `level`: columns and rows of their points, counted from
    /// the first value. Closed lines end where they begin.
    pub(crate) fn isolines(&self, level: f64) -> Vec<Vec<Point>> {
        let segments = self.segments(level);
        let mut at: BTreeMap<Side, Vec<usize>> = BTreeMap::new();
        for (number, ends) in segments.iter().enumerate() {
            for end in ends {
                at.entry(*end).or_default().push(number);
            }
        }
        let mut used = vec![false; segments.len()];
        let mut lines = Vec::new();
        // Lines with ends from their ends, then what is left, which is closed.
        let open = at.iter().filter(|(_, of)| of.len() == 1);
        let begins: Vec<Side> = open.chain(&at).map(|(side, _)| *side).collect();
        for begin in begins {
            let mut sides = vec![begin];
            let mut here = begin;
            while let Some(&number) = at[&here].iter().find(|number| !used[**number]) {
                used[number] = true;
                let [a, b] = segments[number];
                here = if a == here { b } else { a };
                sides.push(here);
            }
            if sides.len() > 1 {
                lines.push(sides.into_iter().map(|side| self.crossing(side, level)).collect());
            }
        }
        lines
    }

    /// The pieces of lines in all cells, by the sides that they join.
    fn segments(&self, level: f64) -> Vec<[Side; 2]> {
        let w = self.columns;
        let rows = self.values.len() / w.max(1);
        let mut found = Vec::new();
        for y in 1..rows {
            for x in 1..w {
                // Corners and sides around the cell; side i goes from corner i to the next.
                let first = (y - 1) * w + x - 1;
                let corners = [first, first + 1, first + w + 1, first + w];
                let sides = [2 * first, 2 * (first + 1) + 1, 2 * (first + w), 2 * first + 1];
                let above = corners.map(|corner| self.values[corner] >= level);
                let crossed = [0, 1, 2, 3].map(|i| above[i] != above[(i + 1) % 4]);
                if crossed.iter().all(|crossed| !crossed)
                    || !(0..4).all(|i| (self.joined)(corners[i], corners[(i + 1) % 4]))
                {
                    continue;
                }
                if crossed.iter().all(|crossed| *crossed) {
                    let mean = 0.25 * corners.iter().map(|corner| self.values[*corner]).sum::<f64>();
                    // The corners that are unlike the middle are cut off.
                    let cut = usize::from(above[0] == (mean >= level));
                    found.extend([0, 2].map(|i| [sides[(i + cut + 3) % 4], sides[(i + cut) % 4]]));
                } else {
                    let mut ends = (0..4).filter(|&i| crossed[i]).map(|i| sides[i]);
                    found.extend(ends.next().zip(ends.next()).map(|(a, b)| [a, b]));
                }
            }
        }
        found
    }

    /// Where a side has the value.
    fn crossing(&self, side: Side, level: f64) -> Point {
        let (first, down) = (side / 2, side % 2);
        let next = if down == 1 { first + self.columns } else { first + 1 };
        let (a, b) = (self.values[first], self.values[next]);
        let share = ((level - a) / (b - a)).clamp(0.0, 1.0);
        let (x, y) = ((first % self.columns) as f64, (first / self.columns) as f64);
        if down == 1 { (x, y + share) } else { (x + share, y) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(size: usize, value: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        (0..size * size).map(|i| value((i % size) as f64, (i / size) as f64)).collect()
    }

    fn lines(values: &[f64], columns: usize, level: f64) -> Vec<Vec<Point>> {
        Grid { values, columns, joined: &|_, _| true }.isolines(level)
    }

    #[test]
    fn a_plane_has_one_straight_line() {
        let values = grid(9, |x, y| 2.0 * x + y);
        let found = lines(&values, 9, 9.3);
        assert_eq!(found.len(), 1);
        assert!(found[0].len() > 8 && found[0].iter().all(|(x, y)| (2.0 * x + y - 9.3).abs() < 1e-12));
    }

    #[test]
    fn a_cone_has_closed_circles() {
        let values = grid(41, |x, y| (x - 20.0).hypot(y - 20.0));
        let found = lines(&values, 41, 12.5);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].first(), found[0].last());
        for (x, y) in &found[0] {
            assert!(((x - 20.0).hypot(y - 20.0) - 12.5).abs() < 0.02, "{x} {y}");
        }
    }

    #[test]
    fn the_mean_decides_at_a_saddle() {
        // Corners 0 and 2 are above the level.
        for (high, joined) in [(4.0, true), (1.5, false)] {
            let found = lines(&[high, 0.0, 0.0, high], 2, 1.0);
            assert_eq!(found.len(), 2);
            // Where the two are joined, each line goes around a low corner.
            let around = |line: &Vec<Point>, corner: Point| {
                line.iter().all(|p| (p.0 - corner.0).abs() < 1.0 && (p.1 - corner.1).abs() < 1.0)
            };
            assert_eq!(found.iter().any(|line| around(line, (1.0, 0.0))), joined, "{found:?}");
            assert_eq!(found.iter().any(|line| around(line, (0.0, 0.0))), !joined, "{found:?}");
        }
    }

    #[test]
    fn lines_end_where_surfaces_do() {
        let values = grid(10, |_, y| y);
        let apart = |a: usize, b: usize| (a % 10 < 5) == (b % 10 < 5);
        let found = Grid { values: &values, columns: 10, joined: &apart }.isolines(4.5);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(lines(&values, 10, 20.0).is_empty() && lines(&[], 0, 1.0).is_empty());
    }
}

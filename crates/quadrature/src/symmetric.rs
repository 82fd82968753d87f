//! Fully symmetric rules on the unit triangle, degrees 1 to 30, with positive weights and all
//! points inside.
//!
//! H. Xiao, Z. Gimbutas, *A numerical algorithm for the construction of efficient quadrature rules
//! in two and higher dimensions*, Comput. Math. Appl. 59 (2010) 663,
//! doi:10.1016/j.camwa.2009.10.027. The tables list one point per orbit of the triangle's six
//! symmetries, as barycentric coordinates with the weight for a triangle of area 1.

use crate::{PlanePoint, RuleError};

/// The orbits of one rule.
struct Orbits {
    degree: usize,
    centroid: &'static [f64],
    medians: &'static [[f64; 2]],
    scalene: &'static [[f64; 3]],
}

#[allow(clippy::unreadable_literal, reason = "a table of numbers")]
static TABLE: &[Orbits] = &include!("../data/triangle_symmetric.in");

/// The rule of fewest points on u, v ≥ 0, u + v ≤ 1 that is exact to total degree `degree`; degree
/// 3 gets the rule of degree 4.
///
/// # Errors
/// [`RuleError::DegreeBeyondTable`] above degree 30.
///
/// ```
/// let rule = fredholm_quadrature::symmetric_triangle(20)?;
/// assert_eq!(rule.len(), 79);
/// let moment: f64 = rule.iter().map(|p| p.weight * p.u.powi(20)).sum();
/// assert!((moment - 1.0 / (21.0 * 22.0)).abs() < 1e-16);
/// # Ok::<(), fredholm_quadrature::RuleError>(())
/// ```
pub fn symmetric_triangle(degree: usize) -> Result<Vec<PlanePoint>, RuleError> {
    let highest = TABLE.last().map_or(0, |table| table.degree);
    let table = TABLE.iter().find(|table| table.degree >= degree);
    table.map(place).ok_or(RuleError::DegreeBeyondTable { degree, highest })
}

/// All points of all orbits.
fn place(table: &Orbits) -> Vec<PlanePoint> {
    let third = 1.0 / 3.0;
    let point = |u: f64, v: f64, weight: f64| PlanePoint { u, v, weight: 0.5 * weight };
    let mut points: Vec<_> = table.centroid.iter().map(|&w| point(third, third, w)).collect();
    for &[a, w] in table.medians {
        let c = 1.0 - 2.0 * a;
        points.extend([(a, a), (c, a), (a, c)].map(|(u, v)| point(u, v, w)));
    }
    for &[a, b, w] in table.scalene {
        let c = 1.0 - a - b;
        points.extend([(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)].map(|(u, v)| point(u, v, w)));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exactness::triangle_degree;

    #[test]
    fn every_rule_of_the_table_has_its_degree_and_no_more() {
        assert_eq!(TABLE.len(), 29);
        for table in TABLE {
            triangle_degree(&place(table), table.degree);
        }
    }

    #[test]
    fn all_points_lie_inside_with_positive_weights() {
        for table in TABLE {
            for p in place(table) {
                assert!(
                    p.weight > 0.0 && p.u > 0.0 && p.v > 0.0 && p.u + p.v < 1.0,
                    "degree {}",
                    table.degree
                );
            }
        }
    }

    #[test]
    fn gives_the_next_rule_for_a_degree_between_and_none_beyond() {
        assert_eq!(symmetric_triangle(0).unwrap().len(), 1);
        assert_eq!(symmetric_triangle(3).unwrap().len(), 6);
        assert_eq!(symmetric_triangle(30).unwrap().len(), 171);
        assert_eq!(symmetric_triangle(31), Err(RuleError::DegreeBeyondTable { degree: 31, highest: 30 }));
    }
}

//! The strength of the fringe currents of an edge on faces of finite depth.
//!
//! On a half-plane y = 0, x > 0 with its edge along z they are known in closed form (A. Sommerfeld,
//! Math. Ann. 47 (1896) 317): with F(a) = (e^{jπ/4}/√π) ∫_a^∞ e^{−jt²} dt, C = |cos φ′/2|, κ = k
//! sin β and w = √(2κx) C, the exact current has more than physical optics
//!
//! ```text
//! J_x = ∓4 H_z e^{jκx cos φ′} F(w)
//! J_z = (j/κ²) [k cos β ∂J_x/∂x − (k/η) E_z (−4jκ |sin φ′| e^{jκx cos φ′} F(w) + 2 √(2jκ/(πx)) sin(φ′/2) e^{−jκx})]
//! ```
//!
//! with the upper sign for φ′ < π. They run on the strip from each point of the edge along the ray
//! on the face to its far side, σ = ẑ cos β + x̂ sin β, so deep as the face is (A. Michaeli, IEEE
//! Trans. Antennas Propag. 34 (1986) 912; truncated: P. M. Johansen, the same 44 (1996) 989).
//! Towards u the strip has the phase e^{jκxc} with c = (u·σ − cos²β)/sin²β, cos φ on the cone of
//! diffracted rays. With S = √((1 − c)/2), ν = kL sin²β, v = √(2ν) S, w = √(2ν) C, E(a) = e^{ja²}
//! F(a) and E[w, v] its divided difference, the integrals over the strip are
//!
//! ```text
//! κ ∫ F(w) e^{jκx (c + cos φ′)} dx = √(2ν)/(2j (C + S)) [(½ − F(v))/v + e^{−jv²} E[w, v]]
//! f = −2 sin(φ′/2)/(C + S) [½ − e^{−jv²} (E(w) + v E[w, v])],   ∫ J_z dx = 2j f E_z/(kη sin²β) without H_z
//! ```
//!
//! which are finite for every pair of directions and have no jumps. Where the wave grazes the face,
//! what the far edge of the face leaves of H is met: it has the factor 1 − 2F(√(2ν) sin φ′/2) for
//! that.
//!
//! On a wedge of outer angle nπ the line currents of infinite strips are taken, f − f₀ and g − g₀
//! (P. Ya. Ufimtsev, Fundamentals of the Physical Theory of Diffraction, 2nd ed., Wiley 2014, ch.
//! 2), with that factor at both faces.

use super::fresnel::{divided, factor, scaled};
use crate::surface::GRAZING_COSINE;
use num_complex::Complex64;
use std::f64::consts::PI;

/// C + S, times √(2ν), below which the limit is taken.
const LIMIT_BELOW: f64 = 1e-4;
/// v below which (½ − F(v))/v is its series.
const SERIES_BELOW: f64 = 1e-3;
/// Angle beside a boundary of a wedge between which the coefficients are interpolated, rad.
const BOUNDARY_ANGLE: f64 = 2e-3;

/// The integrals over a strip of a half-plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    /// f.
    pub(super) soft: Complex64,
    /// κ ∫ J_x e^{jκxc} dx over H_z.
    pub(super) across: Complex64,
    /// J_x e^{jκxc} over H_z at the end of the strip less that at the edge.
    pub(super) ends: Complex64,
}

/// The strip of depth ν towards a direction of this c, for the angle φ′ of the source.
pub(super) fn half_plane(c: f64, source: f64, depth: f64) -> Strip {
    let (sin, cos) = (0.5 * source).sin_cos();
    // In the plane of the face physical optics has no current, and neither side is the lit one.
    let sign = if cos.abs() > 0.5 * GRAZING_COSINE { cos.signum() } else { 0.0 };
    let (root, s, cos, sin) = ((2.0 * depth).sqrt(), (0.5 * (1.0 - c)).max(0.0).sqrt(), cos.abs(), sin.abs());
    let (v, w) = (root * s, root * cos);
    let (phase, j) = (Complex64::cis(-v * v), Complex64::I);
    let (soft, across) = if v + w < LIMIT_BELOW {
        // To the second order in v and w.
        ((factor() - 0.5 * j * w) * root, Complex64::from(0.5 * depth))
    } else {
        let slope = divided(w, v);
        let soft = (0.5 - phase * (scaled(w) + slope * v)) / (cos + s);
        let across = (rest(v) + phase * slope) * (root / (2.0 * (cos + s))) / j;
        (soft, across)
    };
    let hard = grazing(depth, sin) * (-4.0 * sign);
    Strip { soft: soft * (-2.0 * sin), across: hard * across, ends: hard * (phase * scaled(w) - 0.5) }
}

/// (½ − F(v))/v.
fn rest(v: f64) -> Complex64 {
    if v < SERIES_BELOW {
        factor() * Complex64::new(1.0, -v * v / 3.0)
    } else {
        (0.5 - scaled(v) * Complex64::cis(-v * v)) / v
    }
}

/// 1 − 2F(√(2ν) s): 0 in the plane of a face, 1 away from it.
fn grazing(depth: f64, s: f64) -> Complex64 {
    let a = (2.0 * depth).sqrt() * s;
    1.0 - 2.0 * scaled(a) * Complex64::cis(-a * a)
}

/// f and g of a wedge of the outer angle nπ; 0 inside.
pub(super) fn wedge(n: f64, observer: f64, source: f64, depths: [f64; 2]) -> [Complex64; 2] {
    if !(0.0..n * PI).contains(&observer) || source >= n * PI {
        return [Complex64::ZERO; 2];
    }
    let [f, g] = fringe(n, observer, source);
    let at = |angle: f64| {
        let first = grazing(depths[0], (0.5 * angle).sin().abs());
        first * grazing(depths[1], (0.5 * (n * PI - angle)).sin().abs())
    };
    let fade = at(observer) * at(source) * behind(n, source, depths);
    [fade * f, fade * g]
}

/// Fades out waves that come along a face towards the edge, for which f₀ and g₀ are infinite.
fn behind(n: f64, source: f64, depths: [f64; 2]) -> Complex64 {
    let over = |angle: f64, depth: f64| grazing(depth, (0.5 * (PI - angle)).sin().abs());
    over(source, depths[0]) * over(n * PI - source, depths[1])
}

/// f − f₀ and g − g₀, across the boundaries of shadow and reflection by interpolation.
fn fringe(n: f64, observer: f64, source: f64) -> [f64; 2] {
    // Of the first face the boundary of its reflection, or of its shadow where it is not lit.
    let boundaries = [(PI - source).abs(), PI + source, (2.0 * n - 1.0) * PI - source];
    let Some(near) = boundaries.into_iter().find(|boundary| (observer - boundary).abs() < BOUNDARY_ANGLE)
    else {
        return difference(n, observer, source);
    };
    let share = 0.5 * (1.0 + (observer - near) / BOUNDARY_ANGLE);
    let [low, high] = [-BOUNDARY_ANGLE, BOUNDARY_ANGLE].map(|side| difference(n, near + side, source));
    [0, 1].map(|i| low[i] + share * (high[i] - low[i]))
}

fn difference(n: f64, observer: f64, source: f64) -> [f64; 2] {
    let (sin, cos) = (PI / n).sin_cos();
    let term = |angle: f64| sin / n / (cos - (angle / n).cos());
    let (minus, plus) = (term(observer - source), term(observer + source));
    let mut found = [minus - plus, minus + plus];
    // Angles from the second face run the other way round.
    for (o, s) in [(observer, source), (n * PI - observer, n * PI - source)] {
        if s < PI {
            let sum = o.cos() + s.cos();
            found[0] -= s.sin() / sum;
            found[1] -= -o.sin() / sum;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// On a deep half-plane, on the cone, they are Ufimtsev's f − f₀ and g − g₀ = −½ sin φ κ∫J_x j.
    #[test]
    fn deep_strips_have_the_coefficients_of_the_infinite_one() {
        for source in [0.5, 1.3, 2.8, 4.0, 5.5] {
            for observer in [0.4, 1.0, 2.2, 3.6, 5.9_f64] {
                let found = half_plane(observer.cos(), source, 1e12);
                let hard = found.across * Complex64::I * (0.5 * observer.sin());
                let expected = difference(2.0, observer, source);
                for (found, expected) in [found.soft, hard].into_iter().zip(expected) {
                    let scale = 1e-5 * (1.0 + expected.abs());
                    assert!((found - expected).norm() < scale, "{source} {observer}: {found} {expected}");
                }
            }
        }
    }

    /// The strip's integrals of the fringe current itself, by a fine rule, off the cone too.
    #[test]
    fn strips_are_the_integral_of_the_fringe_current() {
        let (depth, source, points) = (7.0, 1.1_f64, 100_000);
        for c in [1.0, 0.9, -0.3, -source.cos(), -1.0, -3.0] {
            let (mut across, mut soft) = (Complex64::ZERO, Complex64::ZERO);
            for i in 0..points {
                // κx = ν t² for the root at the edge.
                let t = (f64::from(i) + 0.5) / f64::from(points);
                let x = depth * t * t;
                let a = (2.0 * x).sqrt() * (0.5 * source).cos();
                let step = 2.0 * depth * t / f64::from(points);
                let current = scaled(a) * Complex64::cis(-a * a + x * source.cos());
                let phase = Complex64::cis(x * c);
                across += current * phase * (-4.0 * step);
                let root = factor() * (2.0 * (2.0 / x).sqrt() * (0.5 * source).sin()) * Complex64::cis(-x);
                soft += (current * Complex64::new(0.0, -4.0 * source.sin()) + root) * phase * step;
            }
            let found = half_plane(c, source, depth);
            let fade = grazing(depth, (0.5 * source).sin());
            assert!((found.across - across * fade).norm() < 1e-6, "{c}: {} {across}", found.across);
            // Δ∂E_z/∂y integrates to −2f.
            assert!((found.soft * -2.0 - soft).norm() < 1e-5, "{c}: {} {soft}", found.soft);
        }
    }

    /// No jump in the plane of the face, at the boundaries of light and shadow, nor where the wave
    /// grazes the face.
    #[test]
    fn they_are_continuous() {
        let step = 1e-9;
        let near = |a: Strip, b: Strip| (a.soft - b.soft).norm() + (a.across - b.across).norm();
        for depth in [0.3, 5.0, 60.0] {
            for source in [0.0, 0.4, 1.9, 4.4_f64] {
                for c in [-source.cos(), 1.0 - step, 0.0] {
                    let go = |d: f64| half_plane(c + d, source, depth);
                    // Beside c = 1 they go with the root of 1 − c.
                    let gap = near(go(-step), go(step));
                    assert!(gap < (1.0 + depth) * step.sqrt(), "{depth} {source} {c}: {gap}");
                }
            }
            // At π, where the wave comes over the face, only with physical optics, whose sides
            // change there.
            for c in [-0.8, 0.0, 0.9] {
                let go = |d: f64| half_plane(c, d.rem_euclid(TAU), depth);
                assert!(near(go(-step), go(step)) < 1e-6, "{depth} {c}");
                let [before, after] = [-step, step].map(|d| half_plane(c, PI + d, depth).soft);
                assert!((before - after).norm() < 1e-6, "{depth} {c}");
            }
            for source in [0.5, 0.8, 1.2, 2.5, 3.4, 4.1, 4.5] {
                for observer in [0.0, (PI - source).abs(), 2.0 * PI - source, 1.5 * PI] {
                    let go = |d: f64| wedge(1.5, observer + d, source, [depth; 2]);
                    let gap: f64 = [0, 1].map(|i| (go(-step)[i] - go(step)[i]).norm()).iter().sum();
                    let at: f64 = [0, 1].map(|i| (go(0.0)[i] - go(step)[i]).norm()).iter().sum();
                    assert!(gap < 1e-5 && at < 1e-5, "{depth} {source} {observer}: {gap} {at}");
                }
            }
        }
    }
}

//! The stochastic and the pixel method against closed forms.

use crate::generator::{Kind, Random, pair};
use crate::open;
use fredholm_coupling::form_factor::point_to_polygon;
use fredholm_coupling::method::Setting;

/// Of z = (value − exact)/(standard error), mean 0 with standard deviation n^(−1/2) and mean square
/// 1 with √(2/n).
#[test]
fn monte_carlo_scatters_as_its_standard_error_says() {
    let n = 400u64;
    for kind in [Kind::Apart, Kind::SharedEdge, Kind::Crossing, Kind::Sizes(10.0), Kind::Plates(0.1)] {
        let pair = pair(kind, &mut Random::new(41));
        let exact = open("schroeder-hanrahan", &pair, Setting::Fixed).value;
        let z = |seed: u64| {
            let got = open("monte-carlo", &pair, Setting::Samples { count: 512, seed });
            (got.value - exact) / got.error
        };
        let z: Vec<f64> = (0..n).map(z).collect();
        let mean = z.iter().sum::<f64>() / n as f64;
        let square = z.iter().map(|z| z * z).sum::<f64>() / n as f64;
        println!("{kind:?}: mean of z {mean:+.3}, mean square {square:.3}");
        assert!(mean.abs() < 4.0 / (n as f64).sqrt(), "{kind:?}: {mean}");
        assert!((square - 1.0).abs() < 5.0 * (2.0 / n as f64).sqrt(), "{kind:?}: {square}");
    }
}

#[test]
fn monte_carlo_repeats_itself_and_improves_with_the_root_of_its_samples() {
    let pair = pair(Kind::SharedEdge, &mut Random::new(42));
    let run = |count, seed| open("monte-carlo", &pair, Setting::Samples { count, seed });
    assert_eq!(run(1000, 7), run(1000, 7));
    assert!(run(1000, 7).value.to_bits() != run(1000, 8).value.to_bits());
    let ratio = run(1000, 7).error / run(64_000, 7).error;
    assert!((ratio - 8.0).abs() < 1.0, "{ratio}");
}

/// The limit of rising resolution is the closed factor of the centroid.
#[test]
fn the_hemicube_converges_with_its_resolution() {
    for kind in [Kind::Near, Kind::SharedEdge, Kind::Plates(0.1)] {
        let mut random = Random::new(43);
        let mut worst = [0f64; 3];
        for _ in 0..5 {
            let [a, b] = pair(kind, &mut random);
            let target: Vec<_> = crate::reference::front(&b, &a);
            let source = crate::reference::front(&a, &b);
            if source != a.corners() {
                continue;
            }
            let exact = point_to_polygon(a.normal(), target.iter().map(|&x| x - a.centroid()));
            for (worst, pixels) in worst.iter_mut().zip([16, 64, 256]) {
                let got = open("hemicube", &[a, b], Setting::Resolution(pixels));
                let error = (got.value / a.area() - exact).abs();
                assert!(error <= got.error / a.area(), "{kind:?} at {pixels}: {error} {got:?}");
                *worst = worst.max(error);
            }
        }
        println!("{kind:?}: {worst:.5?}");
        assert!(
            worst[0] > 0.0 && worst[1] < 0.5 * worst[0] && worst[2] < 0.5 * worst[1],
            "{kind:?}: {worst:?}"
        );
    }
}

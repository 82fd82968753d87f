//! Curved objects of many triangles: what clusters exchange agrees with particle tracing.

#![allow(clippy::unwrap_used, reason = "a test that cannot run should panic, in its helpers too")]

mod common;
#[path = "common/objects.rs"]
mod objects;
#[path = "common/shapes.rs"]
mod shapes;
#[path = "common/traced.rs"]
mod traced;

use traced::Parts;

/// Relative L2 errors of the parts less the noise of tracing, of all and of the object alone, and
/// what is stated.
fn errors(name: &str, (count, accuracy): (usize, f64), (whole_walls, batches): (bool, u64)) -> [f64; 3] {
    let bench = objects::bench(name, count);
    let parts = Parts::of(&bench, whole_walls);
    let solution = bench.solve(accuracy);
    let found = parts.solved(&bench, &solution);
    let [exact, noise] = parts.traced(&bench, batches);
    let areas = parts.areas(&bench);
    let error = |range: std::ops::Range<usize>| {
        let over = |f: &dyn Fn(usize) -> f64| range.clone().map(|k| areas[k] * f(k)).sum::<f64>();
        let square = over(&|k| (found[k] - exact[k]).powi(2) - noise[k].powi(2)).max(0.0);
        (square / over(&|k| exact[k].powi(2))).sqrt()
    };
    let (all, object) = (error(0..parts.count), error(parts.count - 16..parts.count));
    let stated = solution.error.unwrap().worst();
    let links = solution.links.len();
    println!(
        "{name} {count}, {accuracy}: all {all:.2e}, object {object:.2e}, stated {stated:.2e}, {links} links"
    );
    [all, object, stated]
}

#[test]
fn objects_agree_with_particle_tracing() {
    for name in ["ball", "ring", "bowl"] {
        let [all, object, stated] = errors(name, (800, 0.03), (true, 12));
        assert!(all < 0.01 && object < 0.015 && stated < 0.03, "{name}: {all:e} {object:e} {stated:e}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let bench = objects::bench("ring", 800);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bench.solve(0.05))
    };
    let one = with(1);
    let nodes = one.tree.nodes();
    assert!(one.links.iter().any(|link| nodes[link.a as usize].patch().is_none()));
    for threads in [2, 4] {
        let many = with(threads);
        assert!(one.links == many.links && one.radiosity == many.radiosity && one.means == many.means);
    }
}

/// `cargo test --release -p fredholm-hierarchical --test curved -- --ignored --nocapture`
#[test]
#[ignore = "traces hundreds of millions of segments"]
fn faces_agree_with_particle_tracing() {
    for name in ["ball", "ring", "bowl"] {
        for count in [500, 3000, 20_000] {
            let [all, object, stated] = errors(name, (count, 0.02), (false, 64));
            assert!(all < stated && object < stated, "{name} {count}: {all:e} {object:e} {stated:e}");
        }
    }
}

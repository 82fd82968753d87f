//! Batches give the answers of single queries, whatever the number of threads.

use fredholm_mesh::Vec3;
use fredholm_visibility::Occluders;
use rayon::ThreadPoolBuilder;

use crate::scenes::{Random, furnished, triangulated};

#[test]
fn the_number_of_threads_changes_nothing() {
    let patches = triangulated(&furnished());
    let occluders = Occluders::new(&patches).unwrap();
    let mut random = Random(3);
    let segments: Vec<(Vec3, Vec3)> = (0..20_000)
        .map(|k| (random.on(&patches[k % patches.len()]), random.on(&patches[(k / 7) % patches.len()])))
        .collect();
    let single: Vec<bool> = segments.iter().map(|&(p, q)| occluders.unoccluded(p, q)).collect();
    assert!(single.iter().filter(|&&free| free).count() > 4_000);
    assert!(single.iter().filter(|&&free| !free).count() > 4_000);
    for threads in [1, 2, 4] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let built = pool.install(|| Occluders::new(&patches).unwrap());
        assert_eq!(pool.install(|| built.unoccluded_batch(&segments)), single);
    }
}

#[test]
fn many_ends_of_one_point() {
    let occluders = Occluders::new(&furnished()).unwrap();
    let mut random = Random(5);
    let ends: Vec<Vec3> = (0..5_000).map(|_| random.cube()).collect();
    let p = Vec3::new(0.0, 0.0, 0.9);
    let expected: Vec<bool> = ends.iter().map(|&q| occluders.unoccluded(p, q)).collect();
    assert_eq!(occluders.unoccluded_from(p, &ends), expected);
    assert!(expected.contains(&true) && expected.contains(&false));
}

#[test]
fn both_directions_agree() {
    let patches = furnished();
    let occluders = Occluders::new(&patches).unwrap();
    let mut random = Random(9);
    for _ in 0..50_000 {
        let (p, q) = (random.cube() * 1.2, random.cube() * 1.2);
        assert_eq!(occluders.unoccluded(p, q), occluders.unoccluded(q, p), "between {p} and {q}");
    }
}

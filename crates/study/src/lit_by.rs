//! What lights an element most, for the page of a result: from links, or from a matrix.

use fredholm_coupling::Means;
use fredholm_linop::{PackedSymmetric, Storage};
use fredholm_mesh::{Mesh, Patch, Vec3};
use fredholm_report::ElementLinks;

use crate::pictures::Hierarchy;

/// Links of one element, at most.
const MOST_LINKS_OF_AN_ELEMENT: usize = 6;
/// Links of all elements, at most: some 200 kB of the page.
const MOST_LINKS: usize = 60_000;
/// Least share of the irradiance of an element that a link is kept for.
const LEAST_SHARE: f64 = 0.01;

/// Senders of one element with what they bring, W/m², the most first.
pub(crate) type Senders = Vec<(u32, f64)>;

/// How many links each of so many elements may have: none where that would be fewer than two.
fn most(elements: usize) -> usize {
    Some(MOST_LINKS / elements.max(1))
        .filter(|most| *most >= 2)
        .map_or(0, |most| most.min(MOST_LINKS_OF_AN_ELEMENT))
}

/// Adds a sender where it is among those that bring the most.
fn add(senders: &mut Senders, most: usize, sender: (u32, f64)) {
    let place = senders.partition_point(|known| known.1 >= sender.1);
    if place < most {
        senders.insert(place, sender);
        senders.truncate(most);
    }
}

/// A value of every element, all bands together.
fn together(values: &[f64], bands: usize) -> Vec<f64> {
    values.chunks_exact(bands.max(1)).map(|row| row.iter().sum()).collect()
}

/// The elements that light every element most, by a matrix of exchanges A_i F_ij, m².
pub(crate) fn by_matrix<S: Storage>(matrix: &PackedSymmetric<S>, mesh: &Mesh, means: &Means) -> Vec<Senders> {
    let most = most(mesh.len());
    if most == 0 {
        return Vec::new();
    }
    let sent = together(means.radiosity.as_slice(), means.radiosity.rhs_count());
    let area: Vec<f64> = mesh.patches().map(Patch::area).collect();
    let mut senders = vec![Senders::new(); mesh.len()];
    for i in 0..mesh.len() {
        for (j, exchange) in matrix.packed_row(i).iter().enumerate() {
            let exchange = exchange.to_f64();
            if exchange <= 0.0 {
                continue;
            }
            add(&mut senders[i], most, (j as u32, exchange * sent[j] / area[i]));
            if i != j {
                add(&mut senders[j], most, (i as u32, exchange * sent[i] / area[j]));
            }
        }
    }
    senders
}

/// The senders of a matrix as the page has them; none where there are none.
pub(crate) fn of_elements(senders: &[Senders], mesh: &Mesh, means: &Means) -> Option<ElementLinks> {
    let received = together(means.irradiance.as_slice(), means.irradiance.rhs_count());
    let links = senders.iter().zip(received).map(|(senders, all)| shares(senders, all)).collect();
    let centres = mesh.patches().map(Patch::centroid).collect();
    (!senders.is_empty()).then_some(ElementLinks { centres, links })
}

/// The nodes that light every element most, by links; none where there are too many elements.
pub(crate) fn by_links(hierarchy: &Hierarchy, mesh: &Mesh, means: &Means) -> Option<ElementLinks> {
    let most = most(mesh.len());
    if most == 0 {
        return None;
    }
    let Hierarchy { tree, links } = hierarchy;
    let nodes = tree.nodes();
    let leaves = tree.leaves();
    let sent = together(means.radiosity.as_slice(), means.radiosity.rhs_count());
    let received = together(means.irradiance.as_slice(), means.irradiance.rhs_count());
    // Area, moment and power of the elements below every node.
    let (mut area, mut moment, mut power) =
        (vec![0.0; nodes.len()], vec![Vec3::ZERO; nodes.len()], vec![0.0; nodes.len()]);
    let up = |leaf: u32| std::iter::successors(Some(leaf), |&node| nodes[node as usize].parent());
    for (i, &leaf) in leaves.iter().enumerate() {
        let (patch, own) = (mesh.patch(i), mesh.patch(i).area());
        for node in up(leaf).map(|node| node as usize) {
            area[node] += own;
            moment[node] += patch.centroid() * own;
            power[node] += own * sent[i];
        }
    }
    let mut of_node = vec![Senders::new(); nodes.len()];
    for link in links.iter() {
        for (receiver, sender) in [(link.a, link.b), (link.b, link.a)] {
            let [to, from] = [receiver, sender].map(|node| node as usize);
            if area[to] > 0.0 && area[from] > 0.0 {
                let brought = link.exchange() / area[to] * power[from] / area[from];
                of_node[to].push((sender, brought));
            }
        }
    }
    let of_leaf = |(&leaf, &all): (&u32, &f64)| {
        let mut senders = Senders::new();
        for node in up(leaf) {
            of_node[node as usize].iter().for_each(|sender| add(&mut senders, most, *sender));
        }
        shares(&senders, all)
    };
    let links = leaves.iter().zip(&received).map(of_leaf).collect();
    let centres =
        moment.iter().zip(&area).map(|(m, a)| if *a > 0.0 { *m / *a } else { Vec3::ZERO }).collect();
    Some(ElementLinks { centres, links })
}

/// Shares of what an element receives in all, W/m².
fn shares(senders: &Senders, all: f64) -> Vec<(u32, f64)> {
    let share = |&(sender, brought): &(u32, f64)| (sender, if all > 0.0 { brought / all } else { 0.0 });
    senders.iter().map(share).filter(|(_, share)| *share >= LEAST_SHARE).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm_linop::MultiVector;
    use fredholm_mesh::MeshBuilder;

    #[test]
    fn the_strongest_senders_come_first() {
        let mut senders = Senders::new();
        for (k, brought) in [0.3, 0.9, 0.1, 0.5].into_iter().enumerate() {
            add(&mut senders, 3, (k as u32, brought));
        }
        assert_eq!(senders, [(1, 0.9), (3, 0.5), (0, 0.3)]);
        assert_eq!([most(10), most(20_000), most(50_000)], [6, 3, 0]);
    }

    #[test]
    fn a_matrix_tells_shares_of_the_irradiance() {
        let mut builder = MeshBuilder::default();
        builder.surface("three", 0);
        for x in [0.0, 1.0, 2.0] {
            let corner = |u: f64, v: f64| Vec3::new(x + u, v, 0.0);
            let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
            builder.face(&[Patch::quad(corners).unwrap().unwrap()]).unwrap();
        }
        let mesh = builder.build();
        // G_10 = 0.2, G_20 = 0.1, G_21 = 0.
        let matrix = PackedSymmetric::new(3, vec![0.0, 0.2, 0.0, 0.1, 0.0, 0.0]).unwrap();
        let vector = |values: [f64; 3]| MultiVector::from_fn(3, 1, |i, _| values[i]);
        let means = Means { irradiance: vector([1.4, 0.2, 0.1]), radiosity: vector([1.0, 4.0, 6.0]) };
        let found = of_elements(&by_matrix(&matrix, &mesh, &means), &mesh, &means).unwrap();
        let first: Vec<u32> = found.links[0].iter().map(|link| link.0).collect();
        assert_eq!(first, [1, 2]);
        let shares: f64 = found.links[0].iter().map(|link| link.1).sum();
        assert!((shares - 1.0).abs() < 1e-12 && (found.links[1][0].1 - 1.0).abs() < 1e-12);
        assert_eq!(found.centres[2], Vec3::new(2.5, 0.5, 0.0));
    }
}

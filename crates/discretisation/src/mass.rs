//! The L² projection onto a space: M c = ∫ φ f dA with M_ab = ∫ φ_a φ_b dA.
//!
//! G. Peyré's article, eq. 1.56. M falls into blocks of unknowns that share elements: one block an
//! element in a discontinuous space, one a smooth face in a conforming one. Each block is
//! factorised once. Integrals over the receiving elements use the transfer's outer rule. M in m².

use crate::cholesky::Cholesky;
use crate::surface::Rules;
use crate::{DiscretisationError, Site, Space};

/// Mass matrix, factorised block by block, and the rule it is made with.
#[derive(Debug)]
pub(crate) struct Mass {
    rules: Rules,
    blocks: Vec<Block>,
}

#[derive(Debug)]
struct Block {
    dofs: Vec<usize>,
    factors: Cholesky,
}

impl Mass {
    pub(crate) fn new(space: &Space, rules: Rules) -> Result<Self, DiscretisationError> {
        let groups = groups(space);
        let mut place = vec![(0, 0); space.dim()];
        let mut sizes = vec![0; space.surface().len()];
        for (dof, &group) in groups.iter().enumerate() {
            place[dof] = (group, sizes[group]);
            sizes[group] += 1;
        }
        let mut matrices: Vec<Vec<f64>> = sizes.iter().map(|size| vec![0.0; size * size]).collect();
        for i in 0..space.surface().len() {
            add_element(space, i, &rules, &place, &sizes, &mut matrices);
        }
        let blocks = factorise(&groups, &sizes, matrices)?;
        Ok(Self { rules, blocks })
    }

    /// Points of element `i` with weights, m².
    pub(crate) fn sites(&self, space: &Space, i: usize) -> Vec<(Site, f64)> {
        let surface = space.surface();
        surface.place(i, self.rules.of(surface.chart(i).sides()))
    }

    /// Turns ∫ φ f dA, unknowns × `width`, into the coefficients of the projections.
    pub(crate) fn solve(&self, values: &mut [f64], width: usize) {
        for block in &self.blocks {
            let of = |dof: &usize| dof * width..(dof + 1) * width;
            let mut part: Vec<f64> = block.dofs.iter().flat_map(|dof| values[of(dof)].to_vec()).collect();
            block.factors.solve(&mut part, width);
            for (dof, row) in block.dofs.iter().zip(part.chunks_exact(width)) {
                values[of(dof)].copy_from_slice(row);
            }
        }
    }
}

/// The smallest element of the block of every unknown.
fn groups(space: &Space) -> Vec<usize> {
    let mut group: Vec<usize> = (0..space.surface().len()).collect();
    let mut first = vec![usize::MAX; space.dim()];
    for i in 0..space.surface().len() {
        for &dof in space.dofs(i) {
            let other = if first[dof] == usize::MAX { i } else { first[dof] };
            first[dof] = other;
            let (a, b) = (root(&group, i), root(&group, other));
            group[a.max(b)] = a.min(b);
        }
    }
    first.iter().map(|&i| root(&group, i)).collect()
}

fn root(group: &[usize], mut i: usize) -> usize {
    while group[i] != i {
        i = group[i];
    }
    i
}

fn add_element(
    space: &Space,
    i: usize,
    rules: &Rules,
    place: &[(usize, usize)],
    sizes: &[usize],
    matrices: &mut [Vec<f64>],
) {
    let (surface, dofs) = (space.surface(), space.dofs(i));
    for (site, weight) in surface.place(i, rules.of(surface.chart(i).sides())) {
        let values = space.basis(i).values(site.u, site.v);
        for (&a, phi) in dofs.iter().zip(values) {
            let (group, row) = place[a];
            for (&b, psi) in dofs.iter().zip(values) {
                matrices[group][row * sizes[group] + place[b].1] += weight * phi * psi;
            }
        }
    }
}

fn factorise(
    groups: &[usize],
    sizes: &[usize],
    matrices: Vec<Vec<f64>>,
) -> Result<Vec<Block>, DiscretisationError> {
    let mut dofs: Vec<Vec<usize>> = vec![Vec::new(); sizes.len()];
    groups.iter().enumerate().for_each(|(dof, &group)| dofs[group].push(dof));
    let blocks = matrices.into_iter().zip(dofs).enumerate().filter(|(_, (_, dofs))| !dofs.is_empty());
    let block = |(element, (matrix, dofs)): (usize, (Vec<f64>, Vec<usize>))| {
        let factors = Cholesky::new(dofs.len(), matrix).ok_or(DiscretisationError::Degenerate { element })?;
        Ok(Block { dofs, factors })
    };
    blocks.map(block).collect()
}

//! The kernel of the energy: constants that neither Dirichlet data nor a reaction hold.

use super::local::zero_local;
use super::space::Space;
use crate::mesh::{BoundaryPart, Components, Neighbour};
use crate::quadrature::Rule;
use crate::real::Real;

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// For each connected component of the space without a Dirichlet facet and without reaction, the
    /// unknowns of the function that is one there and zero elsewhere. Cells are connected if they share
    /// an unknown, or, with a facet form, a facet. A part of a mesh does not know the components of the whole and
    /// has none.
    pub fn kernel(&self, couples: bool) -> Vec<Vec<(u32, T)>> {
        let mesh = self.mesh;
        if mesh.is_supported() || mesh.is_part() {
            return Vec::new();
        }
        let n = self.per_cell();
        let mut components = Components::new(self.dofs.size());
        for cell in 0..mesh.n_cells() {
            (1..n).for_each(|i| components.join(self.dofs.of(cell, 0), self.dofs.of(cell, i)));
        }
        if let (true, Some(neighbours)) = (couples, &self.neighbours) {
            for cell in 0..mesh.n_cells() {
                for local in 0..=D {
                    if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local) {
                        components.join(self.dofs.of(cell, 0), self.dofs.of(other as usize, 0));
                    }
                }
            }
        }
        let mut is_supported = vec![false; self.dofs.size()];
        for (cell, _) in self.facets_of(BoundaryPart::Dirichlet) {
            is_supported[components.find(self.dofs.of(cell, 0))] = true;
        }
        let (facet_rule, cell_rule) = (Rule::new(D - 1, 1), Rule::new(D, 1));
        let terms = self.node_terms(&facet_rule, &cell_rule);
        let constants: Vec<T> =
            terms.iter().map(|terms| T::lit(terms.iter().map(|(_, w)| w).sum())).collect();
        for cell in 0..mesh.n_cells() {
            let root = components.find(self.dofs.of(cell, 0));
            is_supported[root] |= self.reaction_of(cell, &constants) > 0.0;
        }
        let mut values = vec![T::lit(0.0); self.dofs.size()];
        for cell in 0..mesh.n_cells() {
            (0..n).for_each(|i| values[self.dofs.of(cell, i)] = constants[i]);
        }
        let mut of_root = vec![None; values.len()];
        let mut kernel: Vec<Vec<(u32, T)>> = Vec::new();
        for (unknown, &value) in values.iter().enumerate() {
            let root = components.find(unknown);
            if is_supported[root] || value.to_f64() == 0.0 {
                continue;
            }
            let k = *of_root[root].get_or_insert_with(|| {
                kernel.push(Vec::new());
                kernel.len() - 1
            });
            kernel[k].push((unknown as u32, value));
        }
        kernel
    }

    /// The reaction term of the constant one on a cell.
    fn reaction_of(&self, cell: usize, constants: &[T]) -> f64 {
        let Some(reaction) = &self.reaction else { return 0.0 };
        let mut local = zero_local();
        reaction.add(self.mesh, cell, self.mesh.geometry(cell).volume, &mut local);
        let row = |i: usize| -> f64 {
            let terms = constants.iter().enumerate();
            terms.map(|(j, c)| (local[i][j] * *c * constants[i]).to_f64()).sum()
        };
        (0..constants.len()).map(row).sum()
    }
}

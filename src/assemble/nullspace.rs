//! The kernel of the energy: constants that neither Dirichlet data, Robin sides nor a reaction hold.

use super::bodies::FreeBodies;
use super::space::Space;
use crate::algebra::{Inequality, NO_INDEX};
use crate::mesh::Components;

impl<const D: usize> Space<'_, D> {
    /// Sets bodies and kernel of an inequality with a load. For each connected component of the space without a cell
    /// of a body that is held, the kernel has the unknowns of the function that is one there and zero elsewhere. Cells
    /// are connected if they share an unknown, or, with a facet form, a facet: a component may have several bodies that
    /// touch.
    pub fn set_kernel(
        &self,
        inequality: &mut Inequality<f64>,
        couples: bool,
        mut free: FreeBodies,
    ) {
        if free.bodies.is_empty() {
            return;
        }
        let mut components = self.components_of_unknowns(couples);
        let (n, n_cells) = (self.per_cell(), self.mesh.n_cells());
        let mut is_held = vec![false; self.dofs.size()];
        let mut values = vec![0.0; self.dofs.size()];
        let constants = self.constants();
        for cell in 0..n_cells {
            is_held[components.find(self.dofs.of(cell, 0))] |= free.of(cell).is_none();
            (0..n).for_each(|i| values[self.dofs.of(cell, i)] = constants[i]);
        }
        let mut of_root = vec![NO_INDEX; values.len()];
        let kernel = &mut inequality.kernel;
        for (unknown, &value) in values.iter().enumerate() {
            let root = components.find(unknown);
            if is_held[root] || value == 0.0 {
                continue;
            }
            if of_root[root] == NO_INDEX {
                of_root[root] = kernel.len() as u32;
                kernel.push(Vec::new());
            }
            kernel[of_root[root] as usize].push((unknown as u32, value));
        }
        for cell in 0..n_cells {
            let Some(body) = free.of(cell) else { continue };
            let vector = of_root[components.find(self.dofs.of(cell, 0))];
            free.bodies[body].kernel = (vector != NO_INDEX).then_some(vector as usize);
        }
        for body in &mut free.bodies {
            body.assembled = body.kernel.map_or(0.0, |vector| inequality.load_along(vector));
        }
        inequality.bodies = free.bodies;
    }

    /// The connected components of the unknowns.
    fn components_of_unknowns(&self, couples: bool) -> Components {
        let mut components = Components::new(self.dofs.size());
        for cell in 0..self.mesh.n_cells() {
            let first = self.dofs.of(cell, 0);
            (1..self.per_cell()).for_each(|i| components.join(first, self.dofs.of(cell, i)));
        }
        let facets = couples.then(|| self.form_facets()).into_iter().flatten();
        for (here, there) in facets.filter_map(|facet| Some((facet.here, facet.there?))) {
            components.join(self.dofs.of(here.0, 0), self.dofs.of(there.0, 0));
        }
        components
    }
}

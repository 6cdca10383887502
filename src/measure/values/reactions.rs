//! The forces of Dirichlet groups, by the equations of the scheme, and of Robin sides.

use std::collections::BTreeMap;

use crate::algebra::Contact;
use crate::assemble::Discretisation;
use crate::error::Error;
use crate::inequality::{Solution, residual};
use crate::measure::contact::SolvedInequality;
use crate::mesh::BoundaryCondition;

impl<const D: usize> Discretisation<'_, D> {
    /// By boundary group the force that its Dirichlet data, or its Robin data, exert on the body.
    pub(super) fn reactions(
        &self,
        (inequality, solution): SolvedInequality<'_>,
    ) -> Result<Vec<f64>, Error> {
        let space = &self.space;
        let mut reactions = vec![0.0; space.mesh.boundary_groups().len()];
        let facets: Vec<_> = space.grouped_facets_of(BoundaryCondition::Dirichlet).collect();
        // by the vertices of a node the facets with data around it: their groups and measures
        let mut around: BTreeMap<&[u32], Vec<(usize, f64)>> = BTreeMap::new();
        for &(facet, group) in &facets {
            let measure = space.facet_measure(facet);
            for i in space.nodes_on(facet.1) {
                let node = inequality.locations[space.dofs.of(facet.0, i)].vertices();
                around.entry(node).or_default().push((group, measure));
            }
        }
        let Solution { values, contact, jump_multipliers, .. } = solution;
        let mut rest = vec![0.0; inequality.size()];
        residual(inequality, values, jump_multipliers, &mut rest);
        inequality.add_slopes(&mut rest);
        let is_pressed = |i: usize| {
            let is_in_contact =
                inequality.bounds[i].is_inequality() && contact[i] != Contact::Inactive;
            is_in_contact || inequality.kink_of(i).is_some()
        };
        for (i, location) in inequality.locations.iter().enumerate() {
            let facets = around.get(location.vertices()).filter(|_| space.pins || is_pressed(i));
            let Some(facets) = facets else { continue };
            let all: f64 = facets.iter().map(|(_, measure)| measure).sum();
            for (group, measure) in facets {
                reactions[*group] -= rest[i] * (measure / all);
            }
        }
        if !space.pins && !facets.is_empty() {
            let penalised = inequality.penalised.as_ref();
            let are_known = penalised.is_some_and(|p| p.n_jumps() == jump_multipliers.len());
            let multipliers = are_known.then_some(&jump_multipliers[..]);
            let fluxes = self.facet_fluxes(values, multipliers, 1)?;
            for ((cell, local), group) in facets {
                reactions[group] += fluxes[cell * (D + 1) + local];
            }
        }
        if space.data.robin.is_given() {
            for (facet, group) in space.grouped_facets_of(BoundaryCondition::Neumann) {
                if space.data.robin.of(group).is_some() {
                    reactions[group] += space.neumann_flux(facet, group, values)?;
                }
            }
        }
        Ok(reactions)
    }
}

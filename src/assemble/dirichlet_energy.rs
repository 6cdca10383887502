//! What weak Dirichlet data change in the energy of a function, from the facet form's integrand.

use super::load::{FacetDatum, by_facet};
use super::local::{traces, view};
use super::owned_rows::lifted::{LiftTable, Lifting};
use super::space::Space;
use super::space::metric::Metrics;
use crate::algebra::{DirichletEnergy, DirichletTerm};
use crate::facet::{FacetForm, Trace};

impl<const D: usize> Space<'_, D> {
    /// The terms `B(v_i, u_D) + B(u_D, v_i)` and `B(u_D, u_D)` of a form `B` on Dirichlet facets, lifts
    /// included, for the moments of the data `u_D` on facets. Metrics are needed where jumps are lifted.
    pub fn dirichlet_energy<'m>(
        &self,
        form: &dyn FacetForm<D>,
        metrics: &dyn Fn() -> &'m Metrics,
        data: &[FacetDatum],
    ) -> DirichletEnergy {
        let n = self.per_cell();
        let table = self.facet_table(form.moments(self.basis_degree));
        let mut energy = DirichletEnergy::default();
        for (cell, (local, values)) in data {
            let metric = self.metric(*cell);
            let here = self.side(*cell, *local, &metric);
            let facet = view(self.mesh, &here, None);
            let penalty = form.penalty(&facet);
            let mut load = vec![0.0; n];
            let mut linear = vec![0.0; n];
            let mut constant = 0.0;
            for (k, (basis, &value)) in table.on(*local).iter().zip(values).enumerate() {
                let penalty = penalty * form.moment_weight(table.degrees[k]);
                let integrand = |v, u| facet.measure * form.integrand(&facet, v, u, penalty);
                let datum = Trace { jump: value, flux: 0.0 };
                let weighted = self.flux_derivatives((*cell, *local), None, 1.0, k);
                let functions = traces(form, &facet, &here, true, (basis, weighted.as_ref()), n);
                for (i, &v) in functions.iter().enumerate().take(n) {
                    let tested = integrand(v, datum);
                    load[i] += tested;
                    linear[i] += tested + integrand(datum, v);
                }
                constant += integrand(datum, datum);
            }
            energy.terms.extend((0..n).map(|i| DirichletTerm {
                unknown: self.dofs.of(*cell, i) as u32,
                load: load[i],
                linear: linear[i],
                constant: if i == 0 { constant } else { 0.0 },
            }));
        }
        if form.is_lifted() {
            self.add_lifted_energy(form, metrics(), data, &mut energy);
        }
        // a cell with two Dirichlet facets has two terms for an unknown
        energy.merge_terms();
        energy
    }

    /// Adds the products of lifts of the data with lifts of functions, and with one another.
    fn add_lifted_energy(
        &self,
        form: &dyn FacetForm<D>,
        metrics: &Metrics,
        data: &[FacetDatum],
        energy: &mut DirichletEnergy,
    ) {
        let table = LiftTable::new(self, form.lift_degree(self.basis_degree));
        let lifting = Lifting { space: self, form, metrics, table: &table };
        let mut load = vec![0.0; self.dofs.size()];
        for (cell, datum) in data {
            lifting.add_load(self.coupled_neighbours(), *cell, datum, &mut load);
        }
        let nonzero = load.iter().enumerate().filter(|&(_, &load)| load != 0.0);
        energy.terms.extend(nonzero.map(|(i, &load)| DirichletTerm {
            unknown: i as u32,
            load,
            linear: 2.0 * load,
            constant: 0.0,
        }));
        for of_cell in by_facet(data).chunk_by(|a, b| a.0 == b.0) {
            let neighbours = self.coupled_neighbours();
            for (cell, first) in of_cell {
                let products = of_cell
                    .iter()
                    .map(|(_, second)| lifting.product_of_data(neighbours, *cell, first, second));
                let (unknown, constant) = (self.dofs.of(*cell, 0) as u32, products.sum());
                energy.terms.push(DirichletTerm { unknown, load: 0.0, linear: 0.0, constant });
            }
        }
    }
}

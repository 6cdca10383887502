//! Dirichlet data that the facet form imposes: their share of the load, and what they change in the energy of a function.

use std::ops::Range;

use super::owned_rows::lifted::Lifting;
use super::space::form_facets::FormFacet;
use super::space::metric::Metrics;
use super::space::tables::FacetDatum;
use super::space::tables::FacetTable;
use super::space::{Space, checks};
use super::trace::traces;
use crate::algebra::{DirichletEnergy, DirichletTerm};
use crate::error::Error;
use crate::facet::{FacetForm, Trace};
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::parallel::map_groups;
use crate::quadrature::OrthonormalPolynomials;

/// Facets whose data one task integrates.
const FACETS_PER_TASK: usize = 64;

/// The form on one moment of a facet with a datum.
struct DatumMoment<'m> {
    cell: usize,
    /// Number of the moment.
    moment: usize,
    /// The traces of the basis functions of the cell.
    functions: &'m [Trace],
    datum: Trace,
    /// The form of a test and a trial trace.
    form: &'m dyn Fn(Trace, Trace) -> f64,
}

impl<const D: usize> Space<'_, D> {
    /// Whether Dirichlet data enter through the facet form.
    pub fn has_weak_data(&self) -> bool {
        !self.pins
            && self.problem.has_dirichlet_data()
            && self.mesh.has_condition(BoundaryCondition::Dirichlet)
    }

    /// Moments of Dirichlet data on a facet.
    fn dirichlet_moments(
        &self,
        polynomials: &OrthonormalPolynomials,
        (cell, local): HalfFacet,
        group: usize,
    ) -> Result<Vec<f64>, Error> {
        let mut sums = vec![0.0; polynomials.len()];
        for (point, w) in self.facet_rule.iter() {
            let x = self.facet_point(point, cell, local);
            let value = self.dirichlet_at(group, cell, &x);
            let value = checks::finite(value, "dirichlet", &x, cell)?;
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += w * value * polynomials.value(k, point);
            }
        }
        Ok(sums)
    }

    /// By moment, the jump of a discrete function over a facet that carries the form; on the boundary its difference
    /// from the datum. The moments are those of the table, by these polynomials on the facet.
    pub fn jump_on(
        &self,
        facet: FormFacet,
        u: &[f64],
        (table, polynomials): (&FacetTable, &OrthonormalPolynomials),
    ) -> Result<impl Fn(usize) -> f64, Error> {
        let FormFacet { here, there } = facet;
        let values_here = self.local_values(here.0, u);
        let values_there = there.map(|(cell, local)| (self.local_values(cell, u), local));
        let datum = match there {
            Some(_) => Vec::new(),
            None => self.dirichlet_moments(polynomials, here, self.group_of(here))?,
        };
        Ok(move |k: usize| {
            let there = match &values_there {
                Some((values, local)) => table.on(*local)[k].value(values),
                None => datum[k],
            };
            table.on(here.1)[k].value(&values_here) - there
        })
    }

    /// The Dirichlet data that the facet form imposes, in the order of cells and facets; empty where there are none.
    pub fn weak_data(&self, form: &dyn FacetForm<D>) -> Result<Vec<FacetDatum>, Error> {
        if !self.has_weak_data() {
            return Ok(Vec::new());
        }
        let polynomials = OrthonormalPolynomials::new(D - 1, form.moments(self.basis_degree));
        let facets: Vec<_> = self.grouped_facets_of(BoundaryCondition::Dirichlet).collect();
        let on_facet = |&(facet, group): &(HalfFacet, usize)| {
            Ok(FacetDatum { facet, moments: self.dirichlet_moments(&polynomials, facet, group)? })
        };
        let of_group = |range: Range<usize>| facets[range].iter().map(on_facet).collect::<Vec<_>>();
        map_groups(facets.len(), FACETS_PER_TASK, &of_group).into_iter().flatten().collect()
    }

    /// Visits all moments on all facets with data, one facet after the other.
    fn visit_weak_data(
        &self,
        form: &dyn FacetForm<D>,
        data: &[FacetDatum],
        visit: &mut dyn FnMut(DatumMoment<'_>),
    ) {
        let n = self.per_cell();
        let table = self.facet_table(form.moments(self.basis_degree));
        for datum in data {
            let (cell, local) = datum.facet;
            let metric = self.metric(cell);
            let facet = self.facet_view(FormFacet { here: datum.facet, there: None }, None);
            let penalty = form.penalty(&facet);
            for (k, (basis, &value)) in table.on(local).iter().zip(&datum.moments).enumerate() {
                let penalty = penalty * form.moment_weight(table.degrees[k]);
                let weighted = self.flux_derivatives(datum.facet, None, 1.0, k);
                let basis = (basis, weighted.as_ref());
                let side = (true, self.normal_component(datum.facet));
                visit(DatumMoment {
                    cell,
                    moment: k,
                    functions: &traces(form, &facet, (&metric, local), side, basis, n)[..n],
                    datum: Trace { jump: value, flux: 0.0 },
                    form: &|v, u| facet.measure * form.integrand(&facet, v, u, penalty),
                });
            }
        }
    }

    /// Adds the form at basis functions and data to the load by cell; metrics are needed where jumps are lifted.
    pub fn add_weak_data<'m>(
        &self,
        form: &dyn FacetForm<D>,
        metrics: &dyn Fn() -> &'m Metrics,
        data: &[FacetDatum],
        load: &mut [f64],
    ) {
        let n = self.per_cell();
        self.visit_weak_data(form, data, &mut |of| {
            let out = &mut load[of.cell * n..][..n];
            for (out, &v) in out.iter_mut().zip(of.functions) {
                *out += (of.form)(v, of.datum);
            }
        });
        if form.is_lifted() {
            let lifting = Lifting::new(self, form, metrics());
            data.iter().for_each(|datum| lifting.add_load(datum, load));
        }
    }

    /// The terms `B(v_i, u_D) + B(u_D, v_i)` and `B(u_D, u_D)` of a form `B` on Dirichlet facets, lifts
    /// included, for the data `u_D`. Metrics are needed where jumps are lifted.
    pub fn dirichlet_energy<'m>(
        &self,
        form: &dyn FacetForm<D>,
        metrics: &dyn Fn() -> &'m Metrics,
        data: &[FacetDatum],
    ) -> DirichletEnergy {
        let n = self.per_cell();
        let no_term = |unknown| DirichletTerm { unknown, load: 0.0, linear: 0.0, constant: 0.0 };
        let mut energy = DirichletEnergy::default();
        self.visit_weak_data(form, data, &mut |of| {
            if of.moment == 0 {
                let unknowns = (0..n).map(|i| self.dofs.of(of.cell, i) as u32);
                energy.terms.extend(unknowns.map(no_term));
            }
            let first = energy.terms.len() - n;
            let terms = &mut energy.terms[first..];
            for (term, &v) in terms.iter_mut().zip(of.functions) {
                let tested = (of.form)(v, of.datum);
                term.load += tested;
                term.linear += tested + (of.form)(of.datum, v);
            }
            terms[0].constant += (of.form)(of.datum, of.datum);
        });
        if form.is_lifted() {
            let lifting = Lifting::new(self, form, metrics());
            let mut load = vec![0.0; self.dofs.size()];
            data.iter().for_each(|datum| lifting.add_load(datum, &mut load));
            let nonzero = (0..).zip(load).filter(|&(_, load)| load != 0.0);
            energy.terms.extend(nonzero.map(|(unknown, load)| DirichletTerm {
                load,
                linear: 2.0 * load,
                ..no_term(unknown)
            }));
            for of_cell in data.chunk_by(|a, b| a.facet.0 == b.facet.0) {
                for first in of_cell {
                    let products =
                        of_cell.iter().map(|other| lifting.product_of_data(first, other));
                    let (unknown, constant) = (self.dofs.of(first.facet.0, 0), products.sum());
                    energy.terms.push(DirichletTerm { constant, ..no_term(unknown as u32) });
                }
            }
        }
        // a cell with two Dirichlet facets has two terms for an unknown
        energy.merge_terms();
        energy
    }
}

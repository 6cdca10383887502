//! Fluxes through facets that the form of a broken space balances with the load.

use std::ops::Range;

use super::Discretisation;
use super::facet_coefficients::FacetCoefficients;
use super::owned_rows::lifted::{Lifting, MAX_MOMENTS};
use super::space::form_facets::FormFacet;
use super::space::metric::Metrics;
use super::space::tables::FacetTable;
use crate::error::Error;
use crate::mesh::HalfFacet;
use crate::parallel::cells;
use crate::quadrature::OrthonormalPolynomials;

/// What all facets share: the basis functions on them, the polynomials of moments, and what the form needs of cells and
/// facets.
type TablesOfFacets<'t> =
    (&'t FacetTable, &'t OrthonormalPolynomials, &'t (Metrics, FacetCoefficients));

impl<const D: usize> Discretisation<'_, D> {
    /// By facet of each cell the first `kept` moments of a flux `q.n` out of the cell, times the measure of
    /// the facet: minus the facet form of `u` tested with the function in the cell that has this moment on
    /// the facet, zero elsewhere, without its flux. Both cells of a facet have the same moments with
    /// opposite signs, and the sum of the first ones over the facets of a cell is minus the integral of load
    /// and multiplier. Facets without a form have zeros.
    ///
    /// Of a form that is a penalty alone, the given multipliers are the products of weights and jumps:
    /// from differences of values they would lose their digits.
    pub(crate) fn facet_fluxes(
        &self,
        u: &[f64],
        jump_multipliers: Option<&[f64]>,
        kept: usize,
    ) -> Result<Vec<f64>, Error> {
        let (space, form) = (&self.space, self.form());
        let degree = form.moments(space.basis_degree);
        let table = space.facet_table(degree);
        let polynomials = OrthonormalPolynomials::new(D - 1, degree);
        let n_lifted = if form.is_lifted() { MAX_MOMENTS } else { 0 };
        let n_cells = space.mesh.n_cells();
        let stride = kept + n_lifted;
        let per_cell = (D + 1) * stride;
        let starts = jump_multipliers.map(|_| self.facet_starts());
        let prepared = self.prepared();
        // by facet of the cell here: fluxes, then the jumps that are lifted
        let mut here = vec![0.0; n_cells * per_cell];
        cells::for_each(n_cells, &|c| c * per_cell, &mut here, &|cells, out| {
            for (cell, out) in cells.zip(out.chunks_exact_mut(per_cell)) {
                let first = starts.as_ref().map(|starts| starts[cell] as usize);
                for (k, facet) in space.form_facets_of(cell).enumerate() {
                    let n = table.degrees.len();
                    let multipliers = jump_multipliers.zip(first);
                    let multipliers = multipliers.map(|(m, first)| &m[(first + k) * n..][..n]);
                    let tables = (&table, &polynomials, prepared);
                    let out = &mut out[facet.here.1 * stride..][..stride];
                    self.moments_on_facet(u, facet, tables, multipliers, kept, out)?;
                }
            }
            Ok::<(), Error>(())
        })?;
        let number = |(cell, local): HalfFacet| cell * (D + 1) + local;
        let mut fluxes = vec![0.0; n_cells * (D + 1) * kept];
        let mut jumps = vec![0.0; n_cells * (D + 1) * n_lifted];
        for facet in space.form_facets() {
            let of_facet = &here[number(facet.here) * stride..][..stride];
            let (moments, lifted) = of_facet.split_at(kept);
            for (side, sign) in [(Some(facet.here), 1.0), (facet.there, -1.0)] {
                let Some(side) = side.map(number) else { continue };
                let to = &mut fluxes[side * kept..][..kept];
                to.iter_mut().zip(moments).for_each(|(to, from)| *to = sign * from);
                let to = &mut jumps[side * n_lifted..][..n_lifted];
                to.iter_mut().zip(lifted).for_each(|(to, &from)| *to = sign * from);
            }
        }
        if form.is_lifted() {
            self.add_lifted_fluxes(&jumps, kept, &prepared.0, &mut fluxes);
        }
        Ok(fluxes)
    }

    /// For each cell the number of facets with the form that are counted with the cells before it.
    fn facet_starts(&self) -> Vec<u32> {
        let mut end = 0;
        let start = |cell| {
            let start = end;
            end += self.space.form_facets_of(cell).count() as u32;
            start
        };
        (0..self.space.mesh.n_cells()).map(start).collect()
    }

    /// The moments of the flux through a facet out of the cell here, after them those of the jump.
    fn moments_on_facet(
        &self,
        u: &[f64],
        facet: FormFacet,
        (table, polynomials, (metrics, weights)): TablesOfFacets<'_>,
        multipliers: Option<&[f64]>,
        kept: usize,
        out: &mut [f64],
    ) -> Result<(), Error> {
        let (space, form) = (&self.space, self.form());
        let n = space.per_cell();
        let FormFacet { here, there } = facet;
        let weight = weights.at::<D>(here, true, facet.kind());
        let jump = space.jump_on(facet, u, (table, polynomials))?;
        let measure = metrics.measure::<D>(here);
        let (fluxes, lifted) = out.split_at_mut(kept);
        for (k, out) in fluxes.iter_mut().enumerate().take(table.degrees.len()) {
            let penalty = weight.penalty * form.moment_weight(table.degrees[k]);
            let coefficients = weight.coefficients;
            let mut tested = match multipliers {
                Some(multipliers) => multipliers[k],
                None => (measure * coefficients.jump_jump.at(penalty)) * jump(k),
            };
            if form.uses_flux() {
                let flux_of = |own: HalfFacet, other, weight| {
                    let (metric, basis) = (metrics.at::<D>(own.0), &table.on(own.1)[k]);
                    let derivatives = match space.flux_derivatives(own, other, weight, k) {
                        Some(weighted) => metric.normal_derivatives(own.1, &weighted, n, 1.0),
                        None => metric.normal_derivatives(own.1, &basis.derivatives, n, weight),
                    };
                    let values = space.local_values(own.0, u);
                    values[..n].iter().zip(&derivatives).map(|(c, v)| c * v).sum::<f64>()
                };
                let mut flux = flux_of(here, there, weight.own_flux_weight);
                if let Some(there) = there {
                    flux -= flux_of(there, Some(here), weight.other_flux_weight);
                }
                tested += coefficients.jump_flux.at(penalty) * flux;
            }
            *out = -tested;
        }
        for (k, out) in lifted.iter_mut().enumerate().take(table.degrees.len()) {
            *out = jump(k);
        }
        Ok(())
    }

    /// Adds the fluxes that the products of lifts make, from the jumps as each cell sees them.
    fn add_lifted_fluxes(&self, jumps: &[f64], kept: usize, metrics: &Metrics, fluxes: &mut [f64]) {
        let (space, form) = (&self.space, self.form());
        let lifting = Lifting::new(space, form, metrics);
        let products = cells::map(space.mesh.n_cells(), &|centres: Range<usize>| {
            let of_centre = |centre: usize| {
                let jump = |local: usize, k: usize| match local <= D {
                    true => jumps[(centre * (D + 1) + local) * MAX_MOMENTS + k],
                    false => 0.0,
                };
                let jumps = std::array::from_fn(|local| std::array::from_fn(|k| jump(local, k)));
                lifting.products_with_moments(centre, &jumps, kept)
            };
            centres.map(of_centre).collect::<Vec<_>>()
        });
        for (centre, products) in products.iter().flatten().enumerate() {
            for (local, products) in products.iter().enumerate().take(D + 1) {
                for (k, &product) in products.iter().enumerate().take(kept) {
                    fluxes[(centre * (D + 1) + local) * kept + k] -= product;
                    let facet = space.form_facet((centre, local));
                    if let Some((cell, local)) = facet.and_then(|of| of.other((centre, local))) {
                        fluxes[(cell * (D + 1) + local) * kept + k] += product;
                    }
                }
            }
        }
    }
}

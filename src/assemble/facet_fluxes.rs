//! Fluxes through facets that the form of a broken space balances with the load.

use std::ops::Range;

use super::Discretisation;
use super::facet_coefficients::FacetCoefficients;
use super::load::FacetMoments;
use super::owned_rows::lifted::{LiftTable, Lifting, MAX_MOMENTS};
use super::space::metric::Metrics;
use super::space::tables::FacetTable;
use crate::error::Error;
use crate::facet::FacetKind;
use crate::mesh::{BoundaryPart, Neighbour};
use crate::parallel::cells;

/// The sum of coefficients times values.
fn product(coefficients: &[f64], values: &[f64]) -> f64 {
    coefficients.iter().zip(values).map(|(c, v)| c * v).sum()
}

/// The two cells of a facet that carries the form: cell and number of the facet in it.
type Sides = ((usize, usize), Option<(usize, usize)>);

/// What all facets share: the basis functions on them, the moments of Dirichlet data, and what the form needs of cells
/// and facets.
type TablesOfFacets<'t> = (&'t FacetTable, &'t FacetMoments<'t>, &'t (Metrics, FacetCoefficients));

impl<const D: usize> Discretisation<'_, D> {
    /// By facet of each cell the first `kept` moments of a flux `q.n` out of the cell, times the measure of
    /// the facet: minus the facet form of `u` tested with the function in the cell that has this moment on
    /// the facet, zero elsewhere, without its flux. Both cells of a facet have the same moments with
    /// opposite signs, and the sum of the first ones over the facets of a cell is minus the integral of load
    /// and multiplier. Facets without a form have zeros.
    ///
    /// Of a form that is a penalty alone, the given multipliers are the products of weights and jumps:
    /// from differences of values they would lose their digits.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub(crate) fn facet_fluxes(
        &self,
        u: &[f64],
        jump_multipliers: Option<&[f64]>,
        kept: usize,
    ) -> Result<Vec<f64>, Error> {
        let (space, form) = (&self.space, self.form());
        let degree = form.moments(space.basis_degree);
        let table = space.facet_table(degree);
        let data = FacetMoments::new(D, degree, &space.facet_rule);
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
                let mut facet = starts.as_ref().map(|starts| starts[cell] as usize);
                for (local, out) in out.chunks_exact_mut(stride).enumerate() {
                    let Some(sides) = self.sides((cell, local)) else { continue };
                    let n = table.degrees.len();
                    let multipliers = jump_multipliers.zip(facet).map(|(m, f)| &m[f * n..][..n]);
                    let tables = (&table, &data, prepared);
                    self.moments_on_facet(u, sides, tables, multipliers, kept, out)?;
                    facet = facet.map(|facet| facet + 1);
                }
            }
            Ok::<(), Error>(())
        })?;
        let place = |(cell, local): (usize, usize)| cell * (D + 1) + local;
        let mut fluxes = vec![0.0; n_cells * (D + 1) * kept];
        let mut jumps = vec![0.0; n_cells * (D + 1) * n_lifted];
        for (k, of_facet) in here.chunks_exact(stride).enumerate() {
            let Some((own, across)) = self.sides((k / (D + 1), k % (D + 1))) else { continue };
            for (side, sign) in [(Some(own), 1.0), (across, -1.0)] {
                let Some(side) = side.map(place) else { continue };
                let (moments, lifted) = of_facet.split_at(kept);
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

    /// The cells of a facet that carries the form, if it is told by the cell here.
    fn sides(&self, (cell, local): (usize, usize)) -> Option<Sides> {
        match self.space.coupled_neighbours().across(cell, local) {
            Neighbour::Cell { cell: other, local: there } if cell < other as usize => {
                Some(((cell, local), Some((other as usize, usize::from(there)))))
            }
            Neighbour::Boundary(BoundaryPart::Dirichlet) if !self.space.pins => {
                Some(((cell, local), None))
            }
            _ => None,
        }
    }

    /// By cell, how many facets that carry the form the cells before it tell.
    fn facet_starts(&self) -> Vec<u32> {
        let count = |cell| (0..D + 1).filter(|&local| self.sides((cell, local)).is_some()).count();
        let mut end = 0;
        let start = |cell| {
            end += count(cell) as u32;
            end - count(cell) as u32
        };
        (0..self.space.mesh.n_cells()).map(start).collect()
    }

    /// The moments of the flux through a facet out of the cell here, after them those of the jump.
    fn moments_on_facet(
        &self,
        u: &[f64],
        ((cell, local), across): Sides,
        (table, data, (metrics, weights)): TablesOfFacets<'_>,
        multipliers: Option<&[f64]>,
        kept: usize,
        out: &mut [f64],
    ) -> Result<(), Error> {
        let (space, form) = (&self.space, self.form());
        let n = space.per_cell();
        let kind = if across.is_some() { FacetKind::Interior } else { FacetKind::Dirichlet };
        let weight = weights.at::<D>((cell, local), true, kind);
        let own = space.local_values(cell, u);
        let other = across.map(|(other, local)| (space.local_values(other, u), local));
        let datum = match across {
            Some(_) => Vec::new(),
            None => {
                let group = space.mesh.boundary_group(cell, local);
                let group = group.expect("a boundary facet has a group");
                space.dirichlet_moments(data, (cell, local), group)?
            }
        };
        let jump = |k: usize| {
            let there = match &other {
                Some((values, local)) => product(&values[..n], &table.on(*local)[k].values),
                None => datum[k],
            };
            product(&own[..n], &table.on(local)[k].values) - there
        };
        let measure = metrics.at::<D>(cell).measures[local];
        let (fluxes, lifted) = out.split_at_mut(kept);
        for (k, out) in fluxes.iter_mut().enumerate().take(table.degrees.len()) {
            let penalty = weight.penalty * form.moment_weight(table.degrees[k]);
            let coefficients = weight.coefficients;
            let mut tested = match multipliers {
                Some(multipliers) => multipliers[k],
                None => (measure * coefficients.jump_jump.at(penalty)) * jump(k),
            };
            if form.uses_flux() {
                let derivatives = |(cell, local): (usize, usize), across, weight: f64| {
                    let metric = metrics.at::<D>(cell);
                    let side = space.side(cell, local, &metric);
                    match space.flux_derivatives((cell, local), across, weight, k) {
                        Some(weighted) => side.normal_derivatives(&weighted, n, 1.0),
                        None => {
                            let basis = &table.on(local)[k];
                            side.normal_derivatives(&basis.derivatives, n, weight)
                        }
                    }
                };
                let mut flux =
                    product(&own[..n], &derivatives((cell, local), across, weight.own_flux_weight));
                if let (Some(there), Some((values, _))) = (across, &other) {
                    let here = Some((cell, local));
                    flux -=
                        product(&values[..n], &derivatives(there, here, weight.other_flux_weight));
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

    /// Adds what the products of lifts tell of the fluxes, from the jumps as each cell sees them.
    fn add_lifted_fluxes(&self, jumps: &[f64], kept: usize, metrics: &Metrics, fluxes: &mut [f64]) {
        let (space, form) = (&self.space, self.form());
        let neighbours = space.coupled_neighbours();
        let table = LiftTable::new(space, form.lift_degree(space.basis_degree));
        let lifting = Lifting { space, form, metrics, table: &table };
        let products = cells::map(space.mesh.n_cells(), &|centres: Range<usize>| {
            let of_centre = |centre: usize| {
                let jump = |local: usize, k: usize| match local <= D {
                    true => jumps[(centre * (D + 1) + local) * MAX_MOMENTS + k],
                    false => 0.0,
                };
                let jumps = std::array::from_fn(|local| std::array::from_fn(|k| jump(local, k)));
                lifting.products_with_moments(neighbours, centre, &jumps, kept)
            };
            centres.map(of_centre).collect::<Vec<_>>()
        });
        for (centre, products) in products.iter().flatten().enumerate() {
            for (local, products) in products.iter().enumerate().take(D + 1) {
                for (k, &product) in products.iter().enumerate().take(kept) {
                    fluxes[(centre * (D + 1) + local) * kept + k] -= product;
                    if let Neighbour::Cell { cell, local } = neighbours.across(centre, local) {
                        let place = cell as usize * (D + 1) + usize::from(local);
                        fluxes[place * kept + k] += product;
                    }
                }
            }
        }
    }
}

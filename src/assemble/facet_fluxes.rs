//! Fluxes through facets that the form of a broken space balances with the load.

use super::Discretisation;
use super::load::FacetMoments;
use super::owned_rows::lifted::{LiftTable, Lifting, MAX_MOMENTS};
use crate::element::MAX_BASIS;
use crate::error::Error;
use crate::facet::FacetKind;
use crate::mesh::{BoundaryPart, Neighbour};
use crate::real::Real;

/// The sum of coefficients times values.
fn product<T: Real>(coefficients: &[f64; MAX_BASIS], values: &[T]) -> f64 {
    coefficients.iter().zip(values).map(|(c, v)| c * v.to_f64()).sum()
}

impl<T: Real, const D: usize> Discretisation<'_, T, D> {
    /// By facet of each cell the integral of a flux `q.n` out of the cell: minus the facet form of `u`
    /// tested with the function that is one in the cell and zero elsewhere. Both cells of a facet have
    /// the same flux with opposite signs, and the sum over the facets of a cell is minus the integral of
    /// load and multiplier. Facets without a form have zero.
    ///
    /// Of a form that is a penalty alone, the given multipliers are the products of weights and jumps:
    /// from differences of values they would lose their digits.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub(crate) fn facet_fluxes(
        &self,
        u: &[T],
        jump_multipliers: Option<&[f64]>,
    ) -> Result<Vec<f64>, Error> {
        let (space, form) = (&self.space, self.form());
        let (metrics, weights) = self.prepared();
        let degree = form.moments(space.basis_degree);
        let table = space.facet_table(degree);
        let n_moments = table.degrees.len();
        let moments = FacetMoments::new(D, degree, &space.facet_rule);
        let neighbours = space.coupled_neighbours();
        let (n, n_cells) = (space.per_cell(), space.mesh.n_cells());
        let place = |cell: usize, local: usize| cell * (D + 1) + local;
        let mut fluxes = vec![0.0; n_cells * (D + 1)];
        let n_lifted = if form.is_lifted() { MAX_MOMENTS } else { 0 };
        let mut jumps = vec![T::lit(0.0); fluxes.len() * n_lifted];
        let mut multipliers = jump_multipliers.map(|m| m.chunks_exact(n_moments));
        for cell in 0..n_cells {
            let own = space.local_values(cell, u);
            for local in 0..=D {
                let (kind, across) = match neighbours.across(cell, local) {
                    Neighbour::Cell { cell: other, local } if cell < other as usize => {
                        (FacetKind::Interior, Some((other as usize, local as usize)))
                    }
                    Neighbour::Boundary(BoundaryPart::Dirichlet) if !space.pins => {
                        (FacetKind::Dirichlet, None)
                    }
                    _ => continue,
                };
                let multiplier = multipliers.as_mut().and_then(Iterator::next);
                let weight = weights.at::<D>((cell, local), true, kind);
                let other = across.map(|(other, local)| (space.local_values(other, u), local));
                let datum = match across {
                    Some(_) => Vec::new(),
                    None => {
                        let group = space.mesh.boundary_group(cell, local).unwrap_or(0);
                        space.dirichlet_moments(&moments, (cell, local), group)?
                    }
                };
                let jump = |k: usize| {
                    let there = match &other {
                        Some((values, local)) => product(values, &table.on(*local)[k].values),
                        None => datum[k],
                    };
                    product(&own, &table.on(local)[k].values) - there
                };
                let metric = metrics.at::<D>(cell);
                let measure = metric.measures[local];
                let penalty = weight.penalty * T::lit(form.moment_weight(0));
                let coefficients = weight.coefficients;
                let mut tested = match multiplier {
                    Some(multiplier) => multiplier[0],
                    None => (measure * coefficients.jump_jump.at(penalty)).to_f64() * jump(0),
                };
                if form.uses_flux() {
                    let derivatives = |(cell, local): (usize, usize), across, weight: T| {
                        let metric = metrics.at::<D>(cell);
                        let side = space.side(cell, local, &metric);
                        match space.flux_derivatives((cell, local), across, weight, 0) {
                            Some(weighted) => side.normal_derivatives(&weighted, n, T::lit(1.0)),
                            None => {
                                let basis = &table.on(local)[0];
                                side.normal_derivatives(&basis.derivatives, n, weight)
                            }
                        }
                    };
                    let mut flux =
                        product(&own, &derivatives((cell, local), across, weight.own_flux_weight));
                    if let (Some(there), Some((values, _))) = (across, &other) {
                        let here = Some((cell, local));
                        flux -=
                            product(values, &derivatives(there, here, weight.other_flux_weight));
                    }
                    tested += coefficients.jump_flux.at(penalty).to_f64() * flux;
                }
                fluxes[place(cell, local)] = -tested;
                if let Some((other, other_local)) = across {
                    fluxes[place(other, other_local)] = tested;
                }
                for k in 0..n_lifted.min(n_moments) {
                    let jump = T::lit(jump(k));
                    jumps[place(cell, local) * n_lifted + k] = jump;
                    if let Some((other, other_local)) = across {
                        jumps[place(other, other_local) * n_lifted + k] = -jump;
                    }
                }
            }
        }
        if form.is_lifted() {
            let table = LiftTable::new(space, form.lift_degree(space.basis_degree));
            let lifting = Lifting { space, form, metrics, table: &table };
            for centre in 0..n_cells {
                let jumps = std::array::from_fn(|local| match local <= D {
                    true => std::array::from_fn(|k| jumps[place(centre, local) * n_lifted + k]),
                    false => [T::lit(0.0); MAX_MOMENTS],
                });
                let products = lifting.products_with_means(neighbours, centre, &jumps);
                for (local, &product) in products.iter().enumerate().take(D + 1) {
                    fluxes[place(centre, local)] -= product;
                    if let Neighbour::Cell { cell, local } = neighbours.across(centre, local) {
                        fluxes[place(cell as usize, local as usize)] += product;
                    }
                }
            }
        }
        Ok(fluxes)
    }
}

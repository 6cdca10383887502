//! The rows of one cell of linear elements, in closed form.
//!
//! The closed form needs two things: gradients of basis functions are those of barycentric coordinates times a factor,
//! and the form has one weight for all jumps and at most one moment of fluxes. A facet then comes down to four numbers
//! and a few constants of the reference cell. Each entry is one expression, which stays in registers;
//! [`rows`](crate::assemble::owned_rows::rows) is the general case, with loops over moments.

use super::Filling;
use super::rows::Rows;
use super::rows_by_cell::for_each_cell;
use crate::arrays::array_of;
use crate::assemble::facet_coefficients::FacetWeight;
use crate::assemble::space::metric::CellMetric;
use crate::facet::FacetKind;
use crate::mesh::{BoundaryCondition, Neighbour};

/// Constants of the reference cell, of which dimension `D` uses the first `D + 1` facets.
struct Reference<const N: usize> {
    /// Gradients of basis functions are those of barycentric coordinates times this.
    gradient: f64,
    /// By facet: products of jumps.
    own: [[[f64; N]; N]; 4],
    /// By facet and by the number that the other cell has for it.
    other: [[[[f64; N]; N]; 4]; 4],
    /// By facet: means of the basis functions.
    means: [[f64; N]; 4],
}

/// The factors of one facet of a cell: of products of jumps, and for each test function of the fluxes and of the means
/// of trial functions.
struct OnFacet<const N: usize> {
    jump_jump: f64,
    by_flux: [f64; N],
    by_jump: [f64; N],
}

impl<const D: usize> Filling<'_, '_, D> {
    /// Whether [`Filling::fill_linear`] assembles all terms of the form.
    pub(crate) fn is_linear(&self) -> bool {
        self.gradient.is_some() && self.jumps.weights.len() == 1 && self.flux_moments.len() < 2
    }

    /// The rows of all cells, for elements of `N = D + 1` functions.
    pub(crate) fn fill_linear<const N: usize>(&self, row_starts: &[u32], values: &mut [f64]) {
        if self.flux_moments.is_empty() {
            self.fill_by_moments::<N, false>(row_starts, values);
        } else {
            self.fill_by_moments::<N, true>(row_starts, values);
        }
    }

    /// The rows of all cells; `FLUX` says whether the form has fluxes.
    fn fill_by_moments<const N: usize, const FLUX: bool>(
        &self,
        row_starts: &[u32],
        values: &mut [f64],
    ) {
        let reference = self.reference::<N>();
        for_each_cell(row_starts, N, values, |cell, entries| {
            if self.lifted {
                entries.fill(0.0);
            }
            let rows = Rows::new(N, entries, self.positions(cell));
            self.write_linear::<N, FLUX>(&reference, cell, rows);
        });
    }

    fn reference<const N: usize>(&self) -> Reference<N> {
        let of = |m: &[[f64; _]; _]| array_of(|i| array_of(|j| m[i][j]));
        let facet = |local: usize| local.min(D);
        Reference {
            gradient: self.gradient.unwrap_or(1.0),
            own: array_of(|l| of(&self.jumps.own(facet(l))[0])),
            other: array_of(|l| array_of(|m| of(&self.jumps.other(facet(l), facet(m))[0]))),
            means: array_of(|l| array_of(|i| self.facets.on(facet(l))[0].values[i])),
        }
    }

    /// Writes the rows of a cell: its stiffness and the form on its facets.
    #[inline(always)]
    fn write_linear<const N: usize, const FLUX: bool>(
        &self,
        reference: &Reference<N>,
        cell: usize,
        mut rows: Rows<'_>,
    ) {
        let metric = self.metrics.at::<D>(cell);
        let gradient = reference.gradient;
        let scale = self.space.alpha(cell) * gradient * gradient;
        let mut own = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..N {
                own[i][j] = scale * metric.products[i][j];
            }
        }
        for local in 0..=D {
            match self.neighbours.across(cell, local) {
                Neighbour::Cell { cell: other, local: other_local } => {
                    let (other, other_local) = (other as usize, other_local as usize);
                    let from_here = cell < other;
                    let here = if from_here { (cell, local) } else { (other, other_local) };
                    let weight = self.weights.at::<D>(here, from_here, FacetKind::Interior);
                    let facet =
                        self.add_linear::<N, FLUX>(reference, &metric, local, &weight, &mut own);
                    let products = &reference.other[local][other_local & 3];
                    let means = &reference.means[other_local & 3];
                    let mut flux = [0.0; N];
                    if FLUX {
                        let scale = (D as f64) * gradient * weight.other_flux_weight;
                        let row = self.metrics.products_of::<D>(other, other_local);
                        flux = std::array::from_fn(|i| scale * row[i]);
                    }
                    for i in 0..N {
                        let out = rows.block::<N>(rows.others[local], i);
                        for j in 0..N {
                            let jumps = facet.jump_jump * products[i][j];
                            out[j] = if FLUX {
                                facet.by_flux[i] * flux[j] - facet.by_jump[i] * means[j] - jumps
                            } else {
                                -jumps
                            };
                        }
                    }
                }
                Neighbour::Boundary(BoundaryCondition::Dirichlet) if !self.space.pins => {
                    let weight = self.weights.at::<D>((cell, local), true, FacetKind::Dirichlet);
                    self.add_linear::<N, FLUX>(reference, &metric, local, &weight, &mut own);
                }
                Neighbour::Boundary(_) | Neighbour::Cut => {}
            }
        }
        for (i, row) in own.iter().enumerate() {
            rows.block::<N>(rows.own, i).copy_from_slice(row);
        }
    }

    /// Adds the form on a facet to the columns of the cell whose rows these are. Normals point out of this cell.
    #[inline(always)]
    fn add_linear<const N: usize, const FLUX: bool>(
        &self,
        reference: &Reference<N>,
        metric: &CellMetric<D>,
        local: usize,
        weight: &FacetWeight<'_>,
        own: &mut [[f64; N]; N],
    ) -> OnFacet<N> {
        let form = weight.coefficients;
        let measure = metric.measures[local];
        let penalty = weight.penalty * self.jumps.weights[0];
        let jump_jump = measure * form.jump_jump.at(penalty);
        let products = &reference.own[local];
        let zero = [0.0; N];
        let mut facet = OnFacet { jump_jump, by_flux: zero, by_jump: zero };
        if !FLUX {
            for i in 0..N {
                for j in 0..N {
                    own[i][j] += jump_jump * products[i][j];
                }
            }
            return facet;
        }
        let means = &reference.means[local];
        let scale = (-(D as f64)) * reference.gradient * weight.own_flux_weight;
        let flux: [f64; N] = std::array::from_fn(|i| scale * metric.products[local][i]);
        let (jump_flux, flux_jump) = (form.jump_flux.at(penalty), form.flux_jump.at(penalty));
        let flux_flux = form.flux_flux.at(penalty) / measure;
        facet.by_flux = std::array::from_fn(|i| jump_flux * means[i] + flux_flux * flux[i]);
        facet.by_jump = flux.map(|flux| flux_jump * flux);
        for i in 0..N {
            for j in 0..N {
                own[i][j] += jump_jump * products[i][j]
                    + (facet.by_flux[i] * flux[j] + facet.by_jump[i] * means[j]);
            }
        }
        facet
    }
}

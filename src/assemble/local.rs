//! What one cell and one facet contribute.

use super::space::metric::CellMetric;
use super::space::tables::{BasisAt, CellTable, Derivatives};
use crate::element::MAX_BASIS;
use crate::facet::{FacetForm, FacetView, Side, Trace};
use crate::mesh::Mesh;

/// Most moments of fluxes on a facet: cubics on a triangle, for linears with a bubble in space.
pub(crate) const MAX_FLUX_MOMENTS: usize = 10;

/// A small dense matrix, of which an element uses the upper left corner.
pub(crate) type Local = [[f64; MAX_BASIS]; MAX_BASIS];

pub(crate) fn zero_local() -> Local {
    [[0.0; MAX_BASIS]; MAX_BASIS]
}

/// The stiffness of the reference element: for each pair `k < l` of barycentric coordinates what
/// their product of gradients contributes. Pairs are enough, because gradients sum to zero.
pub(crate) struct StiffnessTable {
    pairs: Vec<Local>,
}

impl StiffnessTable {
    /// From the basis at the points of a rule that integrates products of derivatives.
    pub fn new(dimension: usize, table: &CellTable) -> Self {
        let mut pairs = Vec::new();
        for k in 0..dimension {
            for l in k + 1..=dimension {
                let mut pair: Local = zero_local();
                for (basis, &weight) in table.basis.iter().zip(&table.weights) {
                    let along = basis.derivatives.map(|d| d[k] - d[l]);
                    for i in 0..MAX_BASIS {
                        for j in 0..MAX_BASIS {
                            pair[i][j] -= weight * along[i] * along[j];
                        }
                    }
                }
                pairs.push(pair.map(|row| row));
            }
        }
        Self { pairs }
    }
    /// Entry `(i, j)` of `(grad phi_j, grad phi_i)` over a cell.
    #[inline(always)]
    pub fn entry<const D: usize>(&self, metric: &CellMetric<D>, i: usize, j: usize) -> f64 {
        let mut sum = 0.0;
        let mut pair = 0;
        for k in 0..D {
            for l in k + 1..=D {
                sum += metric.products[k][l] * self.pairs[pair][i][j];
                pair += 1;
            }
        }
        sum
    }
    /// Adds `alpha (grad phi_j, grad phi_i)` over a cell.
    #[inline(always)]
    pub fn add<const D: usize>(
        &self,
        n: usize,
        metric: &CellMetric<D>,
        coefficient: f64,
        out: &mut Local,
    ) {
        for i in 0..n {
            for j in 0..n {
                out[i][j] += coefficient * self.entry(metric, i, j);
            }
        }
    }
}

/// A cell seen from one of its facets.
#[derive(Clone, Copy)]
pub(crate) struct CellSide<'a, const D: usize> {
    pub cell: usize,
    pub local: usize,
    pub metric: &'a CellMetric<D>,
    /// The largest coefficient on the facet.
    pub coefficient: f64,
    /// The least coefficient in the cell.
    pub least_coefficient: f64,
}

impl<const D: usize> CellSide<'_, D> {
    #[inline(always)]
    fn seen(&self) -> Side {
        let measure = self.metric.measures[self.local];
        Side {
            coefficient: self.coefficient,
            least_coefficient: self.least_coefficient,
            volume: self.metric.volume,
            surface: self.metric.surface(),
            height: (D as f64) * self.metric.volume / measure,
        }
    }
    /// The derivatives of the first `n` basis functions along the outward normal, of one moment and
    /// times the measure of the facet and a factor.
    #[inline(always)]
    pub fn normal_derivatives(
        &self,
        derivatives: &Derivatives,
        n: usize,
        factor: f64,
    ) -> [f64; MAX_BASIS] {
        super::count::normal_derivatives(n);
        let products = &self.metric.products[self.local];
        let scale = (-(D as f64)) * factor;
        vector(n, |i| {
            let mut sum = derivatives[i][0] * products[0];
            for k in 1..=D {
                sum += derivatives[i][k] * products[k];
            }
            scale * sum
        })
    }
}

/// The first `n` entries of a vector; the others are zero and never read.
#[inline(always)]
pub(crate) fn vector(n: usize, entry: impl Fn(usize) -> f64) -> [f64; MAX_BASIS] {
    let mut out = [0.0; MAX_BASIS];
    for (i, out) in out.iter_mut().enumerate().take(n) {
        *out = entry(i);
    }
    out
}

/// The view of a facet from the cell here, and from the cell there if there is one.
#[inline(always)]
pub(crate) fn view<'m, const D: usize>(
    mesh: &'m Mesh<D>,
    here: &CellSide<'_, D>,
    there: Option<&CellSide<'_, D>>,
) -> FacetView<'m, D> {
    let measure = here.metric.measures[here.local];
    FacetView::new(mesh, (here.cell, here.local), measure, here.seen(), there.map(CellSide::seen))
}

/// The weight of a cell's normal derivative in the flux of a facet: the conductance of the facet
/// times the average weight that the form gives to the cell here or there.
#[inline(always)]
pub(crate) fn flux_weight<const D: usize>(
    facet: &FacetView<D>,
    average_weight: f64,
    is_here: bool,
) -> f64 {
    match facet.there {
        None => facet.here.coefficient,
        Some(_) => {
            let own = if is_here { average_weight } else { 1.0 - average_weight };
            facet.conductance(average_weight) * own
        }
    }
}

/// Traces of the first `n` basis functions of a cell: one moment on a facet. Where the coefficient varies
/// the derivatives with their weights in the flux are given.
///
/// Fluxes are not numbers if the form does not use them, so that a form which reads what it did not
/// ask for fails its first test.
pub(crate) fn traces<const D: usize>(
    form: &dyn FacetForm<D>,
    facet: &FacetView<D>,
    side: &CellSide<'_, D>,
    is_here: bool,
    (basis, weighted): (&BasisAt, Option<&Derivatives>),
    n: usize,
) -> [Trace; MAX_BASIS] {
    let sign = if is_here { 1.0 } else { -1.0 };
    let mut out = [Trace { jump: 0.0, flux: f64::NAN }; MAX_BASIS];
    for (trace, &value) in out.iter_mut().zip(&basis.values).take(n) {
        trace.jump = sign * value;
    }
    if form.uses_flux() {
        let (derivatives, weight) = match weighted {
            Some(derivatives) => (derivatives, 1.0),
            None => (&basis.derivatives, flux_weight(facet, form.average_weight(facet), is_here)),
        };
        let derivatives = side.normal_derivatives(derivatives, n, sign * weight / facet.measure);
        for (trace, derivative) in out.iter_mut().zip(derivatives).take(n) {
            trace.flux = derivative;
        }
    }
    out
}

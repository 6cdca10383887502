//! What one cell and one facet contribute.

use super::space::metric::CellMetric;
use super::space::tables::{BasisAt, CellTable, Derivatives};
use crate::element::MAX_BASIS;
use crate::facet::{FacetForm, FacetView, Side, Trace};
use crate::mesh::Mesh;
use crate::real::Real;

/// Most moments of fluxes on a facet: cubics on a triangle, for linears with a bubble in space.
pub(crate) const MAX_FLUX_MOMENTS: usize = 10;

/// A small dense matrix, of which an element uses the upper left corner.
pub(crate) type Local<T> = [[T; MAX_BASIS]; MAX_BASIS];

pub(crate) fn zero_local<T: Real>() -> Local<T> {
    [[T::lit(0.0); MAX_BASIS]; MAX_BASIS]
}

/// The stiffness of the reference element: for each pair `k < l` of barycentric coordinates what
/// their product of gradients contributes. Pairs are enough, because gradients sum to zero.
pub(crate) struct StiffnessTable<T> {
    pairs: Vec<Local<T>>,
}

impl<T: Real> StiffnessTable<T> {
    /// From the basis at the points of a rule that integrates products of derivatives.
    pub fn new(dimension: usize, table: &CellTable<f64>) -> Self {
        let mut pairs = Vec::new();
        for k in 0..dimension {
            for l in k + 1..=dimension {
                let mut pair: Local<f64> = zero_local();
                for (basis, &weight) in table.basis.iter().zip(&table.weights) {
                    let along = basis.derivatives.map(|d| d[k] - d[l]);
                    for i in 0..MAX_BASIS {
                        for j in 0..MAX_BASIS {
                            pair[i][j] -= weight * along[i] * along[j];
                        }
                    }
                }
                pairs.push(pair.map(|row| row.map(T::lit)));
            }
        }
        Self { pairs }
    }
    /// Entry `(i, j)` of `(grad phi_j, grad phi_i)` over a cell.
    #[inline(always)]
    pub fn entry<const D: usize>(&self, metric: &CellMetric<T, D>, i: usize, j: usize) -> T {
        let mut sum = T::lit(0.0);
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
        metric: &CellMetric<T, D>,
        coefficient: T,
        out: &mut Local<T>,
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
pub(crate) struct CellSide<'a, T, const D: usize> {
    pub cell: usize,
    pub local: usize,
    pub metric: &'a CellMetric<T, D>,
    /// The largest coefficient on the facet.
    pub coefficient: T,
    /// The least coefficient in the cell.
    pub least_coefficient: T,
}

impl<T: Real, const D: usize> CellSide<'_, T, D> {
    #[inline(always)]
    fn seen(&self) -> Side<T> {
        let measure = self.metric.measures[self.local];
        Side {
            coefficient: self.coefficient,
            least_coefficient: self.least_coefficient,
            volume: self.metric.volume,
            surface: self.metric.surface(),
            height: T::lit(D as f64) * self.metric.volume / measure,
        }
    }
    /// The derivatives of the first `n` basis functions along the outward normal, of one moment and
    /// times the measure of the facet and a factor.
    #[inline(always)]
    pub fn normal_derivatives(
        &self,
        derivatives: &Derivatives<T>,
        n: usize,
        factor: T,
    ) -> [T; MAX_BASIS] {
        super::count::normal_derivatives(n);
        let products = &self.metric.products[self.local];
        let scale = T::lit(-(D as f64)) * factor;
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
pub(crate) fn vector<T: Real>(n: usize, entry: impl Fn(usize) -> T) -> [T; MAX_BASIS] {
    let mut out = [T::lit(0.0); MAX_BASIS];
    for (i, out) in out.iter_mut().enumerate().take(n) {
        *out = entry(i);
    }
    out
}

/// The view of a facet from the cell here, and from the cell there if there is one.
#[inline(always)]
pub(crate) fn view<'m, T: Real, const D: usize>(
    mesh: &'m Mesh<T, D>,
    here: &CellSide<'_, T, D>,
    there: Option<&CellSide<'_, T, D>>,
) -> FacetView<'m, T, D> {
    let measure = here.metric.measures[here.local];
    FacetView::new(mesh, (here.cell, here.local), measure, here.seen(), there.map(CellSide::seen))
}

/// The weight of a cell's normal derivative in the flux of a facet: the conductance of the facet
/// times the average weight that the form gives to the cell here or there.
#[inline(always)]
pub(crate) fn flux_weight<T: Real, const D: usize>(
    facet: &FacetView<T, D>,
    average_weight: T,
    is_here: bool,
) -> T {
    match facet.there {
        None => facet.here.coefficient,
        Some(_) => {
            let own = if is_here { average_weight } else { T::lit(1.0) - average_weight };
            facet.conductance(average_weight) * own
        }
    }
}

/// Traces of the first `n` basis functions of a cell: one moment on a facet. Where the coefficient varies
/// the derivatives with their weights in the flux are given.
///
/// Fluxes are not numbers if the form does not use them, so that a form which reads what it did not
/// ask for fails its first test.
pub(crate) fn traces<T: Real, const D: usize>(
    form: &dyn FacetForm<T, D>,
    facet: &FacetView<T, D>,
    side: &CellSide<'_, T, D>,
    is_here: bool,
    (basis, weighted): (&BasisAt<T>, Option<&Derivatives<T>>),
    n: usize,
) -> [Trace<T>; MAX_BASIS] {
    let sign = T::lit(if is_here { 1.0 } else { -1.0 });
    let mut out = [Trace { jump: T::lit(0.0), flux: T::lit(f64::NAN) }; MAX_BASIS];
    for (trace, &value) in out.iter_mut().zip(&basis.values).take(n) {
        trace.jump = sign * value;
    }
    if form.uses_flux() {
        let (derivatives, weight) = match weighted {
            Some(derivatives) => (derivatives, T::lit(1.0)),
            None => (&basis.derivatives, flux_weight(facet, form.average_weight(facet), is_here)),
        };
        let derivatives = side.normal_derivatives(derivatives, n, sign * weight / facet.measure);
        for (trace, derivative) in out.iter_mut().zip(derivatives).take(n) {
            trace.flux = derivative;
        }
    }
    out
}

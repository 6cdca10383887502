//! What one cell and one facet contribute.

use super::metric::CellMetric;
use super::tables::{BasisAt, CellTable};
use crate::element::{MAX_BASIS, ReferenceElement};
use crate::facet::{FacetForm, FacetView, Side, Trace};
use crate::mesh::Mesh;
use crate::real::Real;

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
    pub fn new<E: ReferenceElement<T, D>, const D: usize>() -> Self {
        let table = CellTable::<T>::new::<E, D>(2 * (E::DEGREE - 1));
        let mut pairs = Vec::new();
        for k in 0..D {
            for l in k + 1..=D {
                let mut pair = zero_local();
                for (basis, &weight) in table.basis.iter().zip(&table.weights) {
                    let d = &basis.derivatives;
                    for i in 0..E::N {
                        for j in 0..E::N {
                            pair[i][j] -= weight * (d[i][k] - d[i][l]) * (d[j][k] - d[j][l]);
                        }
                    }
                }
                pairs.push(pair);
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
    pub fn add<E: ReferenceElement<T, D>, const D: usize>(
        &self,
        metric: &CellMetric<T, D>,
        coefficient: T,
        out: &mut Local<T>,
    ) {
        for i in 0..E::N {
            for j in 0..E::N {
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
    pub coefficient: T,
}

impl<T: Real, const D: usize> CellSide<'_, T, D> {
    #[inline(always)]
    fn seen(&self) -> Side<T> {
        let measure = self.metric.measures[self.local];
        Side {
            coefficient: self.coefficient,
            volume: self.metric.volume,
            surface: self.metric.surface(),
            height: T::lit(D as f64) * self.metric.volume / measure,
        }
    }
    /// The derivative of each basis function along the outward normal, of one moment and times the
    /// measure of the facet.
    #[inline(always)]
    pub fn normal_derivatives<E: ReferenceElement<T, D>>(
        &self,
        basis: &BasisAt<T>,
    ) -> [T; MAX_BASIS] {
        super::count::normal_derivatives(E::N);
        let mut out = [T::lit(0.0); MAX_BASIS];
        let products = &self.metric.products[self.local];
        for i in 0..E::N {
            let mut sum = T::lit(0.0);
            for k in 0..=D {
                sum += basis.derivatives[i][k] * products[k];
            }
            out[i] = T::lit(-(D as f64)) * sum;
        }
        out
    }
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

/// The share of a facet's flux that a cell's normal derivative has: the conductance of the facet
/// times the share the form gives to the cell here or there.
#[inline(always)]
pub(crate) fn flux_share<T: Real, const D: usize, F: FacetForm<T, D>>(
    form: &F,
    facet: &FacetView<T, D>,
    is_here: bool,
) -> T {
    match facet.there {
        None => facet.here.coefficient,
        Some(_) => {
            let share = form.share(facet);
            let own = if is_here { share } else { T::lit(1.0) - share };
            facet.conductance(share) * own
        }
    }
}

/// Traces of a cell's basis functions: one moment on a facet.
///
/// Fluxes are not numbers if the form does not use them, so that a form which reads what it did not
/// ask for fails its first test.
#[inline(always)]
pub(crate) fn traces<T: Real, const D: usize, E: ReferenceElement<T, D>, F: FacetForm<T, D>>(
    form: &F,
    facet: &FacetView<T, D>,
    side: &CellSide<'_, T, D>,
    is_here: bool,
    basis: &BasisAt<T>,
) -> [Trace<T>; MAX_BASIS] {
    let sign = T::lit(if is_here { 1.0 } else { -1.0 });
    let mut out = [Trace { jump: T::lit(0.0), flux: T::lit(f64::NAN) }; MAX_BASIS];
    for (trace, &value) in out.iter_mut().zip(&basis.values).take(E::N) {
        trace.jump = sign * value;
    }
    if F::USES_FLUX {
        let scale = sign * flux_share(form, facet, is_here) / facet.measure;
        for (trace, derivative) in out.iter_mut().zip(side.normal_derivatives::<E>(basis)) {
            trace.flux = scale * derivative;
        }
    }
    out
}

//! What one cell and one facet contribute.

use super::tables::{BasisAt, CellTable};
use crate::element::{MAX_BASIS, ReferenceElement};
use crate::facet::{FacetForm, FacetView, Side, Trace};
use crate::mesh::{CellGeometry, Mesh};
use crate::real::{Point, Real};

/// A small dense matrix, of which an element uses the upper left corner.
pub(crate) type Local<T> = [[T; MAX_BASIS]; MAX_BASIS];

pub(crate) fn zero_local<T: Real>() -> Local<T> {
    [[T::lit(0.0); MAX_BASIS]; MAX_BASIS]
}

/// Gradients in space of all basis functions at a point.
#[inline(always)]
pub(crate) fn gradients<T: Real, const D: usize, E: ReferenceElement<T, D>>(
    geometry: &CellGeometry<T, D>,
    basis: &BasisAt<T>,
) -> [Point<T, D>; MAX_BASIS] {
    let mut out = [Point::zeros(); MAX_BASIS];
    for i in 0..E::N {
        for k in 0..=D {
            out[i] += geometry.gradient(k) * basis.derivatives[i][k];
        }
    }
    out
}

/// Adds `alpha (grad phi_j, grad phi_i)` over a cell; `table` integrates products of gradients.
#[inline(always)]
pub(crate) fn add_stiffness<T: Real, const D: usize, E: ReferenceElement<T, D>>(
    geometry: &CellGeometry<T, D>,
    coefficient: T,
    table: &CellTable<T>,
    out: &mut Local<T>,
) {
    for (basis, &weight) in table.basis.iter().zip(&table.weights) {
        let g = gradients::<T, D, E>(geometry, basis);
        let scale = coefficient * geometry.volume * weight;
        for i in 0..E::N {
            for j in 0..E::N {
                out[i][j] += scale * g[i].dot(&g[j]);
            }
        }
    }
}

/// The two cells of a facet in the order the facet has them, and what a form may ask of them.
pub(crate) struct FacetGeometry<T, const D: usize> {
    pub view: FacetView<T>,
    /// From here to there.
    pub normal: Point<T, D>,
}

/// A cell seen from one of its facets.
pub(crate) struct CellSide<'a, T, const D: usize> {
    pub cell: usize,
    pub local: usize,
    pub geometry: &'a CellGeometry<T, D>,
    pub coefficient: T,
}

impl<T: Real, const D: usize> FacetGeometry<T, D> {
    #[inline(always)]
    pub fn new(
        mesh: &Mesh<T, D>,
        here: &CellSide<'_, T, D>,
        there: Option<&CellSide<'_, T, D>>,
    ) -> Self {
        let side = |s: &CellSide<'_, T, D>| Side {
            coefficient: s.coefficient,
            volume: s.geometry.volume,
            surface: s.geometry.surface(),
            height: s.geometry.height(s.local),
        };
        let diameter = match (D, there) {
            (1, None) => here.geometry.volume,
            (1, Some(there)) => (here.geometry.volume + there.geometry.volume) * T::lit(0.5),
            _ => mesh.facet_diameter(here.cell, here.local),
        };
        let view = FacetView {
            measure: here.geometry.facet_measure(here.local),
            diameter,
            here: side(here),
            there: there.map(side),
        };
        Self { view, normal: here.geometry.normal(here.local) }
    }
}

/// Traces of a cell's basis functions at one sample of a facet.
///
/// `sign` is one for the cell here and minus one for the cell there. Fluxes are not numbers if the
/// form does not use them, so that a form which reads what it did not ask for fails its first test.
#[inline(always)]
pub(crate) fn traces<T: Real, const D: usize, E: ReferenceElement<T, D>, F: FacetForm<T, D>>(
    facet: &FacetGeometry<T, D>,
    geometry: &CellGeometry<T, D>,
    sign: T,
    basis: &BasisAt<T>,
) -> [Trace<T>; MAX_BASIS] {
    let mut out = [Trace { jump: T::lit(0.0), flux: T::lit(f64::NAN) }; MAX_BASIS];
    for (trace, &value) in out.iter_mut().zip(&basis.values).take(E::N) {
        trace.jump = sign * value;
    }
    if F::USES_FLUX {
        super::count::normal_derivatives(E::N);
        let mean = if facet.view.there.is_some() { T::lit(0.5) } else { T::lit(1.0) };
        let scale = facet.view.coefficient() * mean;
        let g = gradients::<T, D, E>(geometry, basis);
        for i in 0..E::N {
            out[i].flux = scale * g[i].dot(&facet.normal);
        }
    }
    out
}

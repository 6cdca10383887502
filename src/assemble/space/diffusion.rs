//! The diffusion coefficient in cells and on facets, and what it makes of derivatives in a flux.

use super::Space;
use super::coefficient::VaryingCoefficient;
use super::tables::Derivatives;
use crate::mesh::HalfFacet;
use crate::real::Point;

impl<const D: usize> Space<'_, D> {
    /// The diffusion coefficient at the barycentre of a cell.
    #[inline(always)]
    pub fn alpha(&self, cell: usize) -> f64 {
        self.coefficients.as_ref().map_or_else(|| 1.0, |a| a[cell])
    }
    /// The coefficient and its values in a cell, if it varies there and the element sees it.
    #[inline(always)]
    pub fn varying_in(&self, cell: usize) -> Option<(&VaryingCoefficient, &[f64])> {
        let varying = self.varying.as_ref()?;
        varying.in_cell(cell).map(|values| (varying, values))
    }
    /// Whether the element sees the coefficient vary in some cell.
    pub fn has_varying_coefficient(&self) -> bool {
        self.varying.is_some()
    }
    /// The coefficient at a point of a cell.
    pub fn alpha_at(&self, cell: usize, x: &Point<D>) -> f64 {
        match self.data.coefficient.of(self.mesh.region(cell)) {
            Some(alpha) if self.varying_in(cell).is_some() => self.at(alpha, cell, x),
            _ => self.alpha(cell),
        }
    }
    /// The largest value of the coefficient on a facet from its cell, and the least in the cell, at the
    /// points that the element sees.
    #[inline(always)]
    pub fn extreme_coefficients(&self, (cell, local): HalfFacet) -> [f64; 2] {
        let extremes = self.varying.as_ref().and_then(|varying| varying.extremes((cell, local)));
        extremes.unwrap_or([self.alpha(cell); 2])
    }
    /// Whether the coefficient varies in one of the cells of a facet.
    pub fn varies_at(&self, own: HalfFacet, other: Option<HalfFacet>) -> bool {
        let varies = |cell| self.varying_in(cell).is_some();
        varies(own.0) || other.is_some_and(|(cell, _)| varies(cell))
    }
    /// The factor of a cell's normal derivative in the flux, at each point of a facet where the coefficient varies in
    /// one of the two cells: the harmonic mean with the average weights, times the weight of the cell; on the boundary
    /// the coefficient.
    #[inline(always)]
    fn flux_weights(
        &self,
        own: HalfFacet,
        other: Option<HalfFacet>,
        own_weight: f64,
    ) -> Option<(&VaryingCoefficient, impl Fn(usize) -> f64)> {
        let varying = self.varying.as_ref().filter(|_| self.varies_at(own, other))?;
        let at = move |facet: HalfFacet, q: usize| match varying.on_facet(facet) {
            Some(values) => values[q],
            None => self.alpha(facet.0),
        };
        let weight = move |q: usize| {
            let a = at(own, q);
            let Some(other) = other else { return a };
            let b = at(other, q);
            own_weight * a * b / (own_weight * b + (1.0 - own_weight) * a)
        };
        Some((varying, weight))
    }
    /// Moment `k` on a facet of the derivatives of its cell's basis with their weight in the flux, where
    /// the coefficient varies in one of the two cells.
    #[inline(always)]
    pub fn flux_derivatives(
        &self,
        own: HalfFacet,
        other: Option<HalfFacet>,
        own_weight: f64,
        k: usize,
    ) -> Option<Derivatives> {
        let (varying, weight) = self.flux_weights(own, other, own_weight)?;
        Some(varying.weighted_derivatives(own.1, k, weight))
    }
    /// By two moments on a facet, their product with the weight of a cell in the flux, where the coefficient varies in
    /// one of the two cells.
    pub fn flux_products(
        &self,
        own: HalfFacet,
        other: Option<HalfFacet>,
        own_weight: f64,
    ) -> Option<impl Fn(usize, usize) -> f64> {
        let (varying, weight) = self.flux_weights(own, other, own_weight)?;
        Some(move |k, l| varying.weighted_product(k, l, &weight))
    }
}

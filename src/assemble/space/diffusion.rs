//! The diffusion coefficient in cells and on facets, what it makes of derivatives in a flux, and the matrix of a cell.

use super::Space;
use super::coefficient::tensor::{TensorCoefficient, TensorFactor};
use super::coefficient::{VaryingCoefficient, limited};
use super::metric::shape;
use super::tables::Derivatives;
use crate::arrays::array_of;
use crate::assemble::stiffness::{StiffnessTable, zero_local};
use crate::element::MAX_BASIS;
use crate::mesh::HalfFacet;
use crate::real::Point;

impl<const D: usize> Space<'_, D> {
    /// The diffusion coefficient at the barycentre of a cell.
    #[inline(always)]
    pub fn alpha(&self, cell: usize) -> f64 {
        self.coefficients.as_ref().map_or_else(|| 1.0, |a| a[cell])
    }
    /// The diffusion coefficient at the barycentre of a cell; with a tensor, times the mean of its eigenvalues.
    pub fn mean_coefficient(&self, cell: usize) -> f64 {
        let of_tensor = self.tensor_in(cell).map_or(1.0, |tensor| tensor.mean_eigenvalue());
        self.alpha(cell) * of_tensor
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
    /// The coefficient at a point of a cell, as the element sees it.
    pub fn alpha_at(&self, cell: usize, x: &Point<D>) -> f64 {
        match self.data.coefficient.of(self.mesh.region(cell)) {
            Some(alpha) if self.varying_in(cell).is_some() => {
                limited(self.at(alpha, cell, x), self.alpha(cell))
            }
            _ => self.alpha(cell),
        }
    }
    /// The largest value of the coefficient on a facet from its cell, at the points that the element sees.
    #[inline(always)]
    pub fn largest_coefficient(&self, own: HalfFacet) -> f64 {
        let largest = self.varying.as_ref().and_then(|varying| varying.largest(own));
        largest.unwrap_or(self.alpha(own.0))
    }
    /// The coefficient of a cell in bounds of its flux through a facet, see [`Side::bound_coefficient`].
    #[inline(always)]
    pub fn bound_coefficient(&self, own: HalfFacet, other: Option<HalfFacet>) -> f64 {
        match self.varying_in(own.0) {
            None => self.alpha(own.0),
            Some(in_cell) => self.varying_bound_coefficient(in_cell, own, other),
        }
    }
    fn varying_bound_coefficient(
        &self,
        (varying, values): (&VaryingCoefficient, &[f64]),
        own: HalfFacet,
        other: Option<HalfFacet>,
    ) -> f64 {
        let half = 0.5;
        let Some((_, weight)) = self.flux_weights(own, other, half) else {
            return self.alpha(own.0);
        };
        let a = self.largest_coefficient(own);
        let of_largest = match other.map(|other| self.largest_coefficient(other)) {
            None => a,
            Some(b) => mean_weight(half, a, b),
        };
        // in units of the largest weight: squares of weights may have no exponent
        let largest = varying.largest_flux(own.1, values, |q| weight(q) / of_largest);
        1.0 / largest
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
            mean_weight(own_weight, a, at(other, q))
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

/// The matrix of a cell.
impl<const D: usize> Space<'_, D> {
    /// The entries `(alpha grad phi_j, grad phi_i)` over a cell with these products of gradients, from the table of the
    /// reference element, for an element of `N` functions, or of fewer for the largest `N`.
    #[inline(always)]
    pub fn stiffness<const N: usize>(
        &self,
        table: &StiffnessTable,
        cell: usize,
        products: &[[f64; 4]; 4],
    ) -> [[f64; N]; N] {
        let n = if N == MAX_BASIS { self.per_cell() } else { N };
        let mut out = [[0.0; N]; N];
        match self.varying_in(cell) {
            None => {
                let alpha = self.alpha(cell);
                table.for_each_entry::<D>(products, n, |i, j, entry| {
                    (out[i][j], out[j][i]) = (alpha * entry, alpha * entry);
                });
            }
            Some((varying, values)) => {
                for i in 0..n {
                    for j in i..n {
                        let entry = varying.stiffness::<D>(values, products, i, j);
                        (out[i][j], out[j][i]) = (entry, entry);
                    }
                }
            }
        }
        out
    }

    /// Adds the reaction term of a cell to its matrix.
    pub fn add_reaction<const N: usize>(
        &self,
        cell: usize,
        volume: f64,
        matrix: &mut [[f64; N]; N],
    ) {
        let Some(reaction) = &self.reaction else { return };
        let mut terms = zero_local();
        reaction.add(self.mesh, cell, volume, &mut terms);
        for (row, terms) in matrix.iter_mut().zip(&terms) {
            row.iter_mut().zip(terms).for_each(|(entry, term)| *entry += term);
        }
    }
}

/// The tensor of the coefficient.
impl<const D: usize> Space<'_, D> {
    /// The tensor of the coefficient in a cell, at its barycentre; none without tensors.
    #[inline(always)]
    pub fn tensor_in(&self, cell: usize) -> Option<&TensorFactor<D>> {
        self.tensor.as_ref().map(|tensor| tensor.in_cell(cell))
    }
    /// The tensor at a point of a cell.
    #[inline(always)]
    pub fn tensor_at(&self, cell: usize, x: &Point<D>) -> Option<TensorFactor<D>> {
        self.tensor.as_ref().map(|tensor| tensor.at(self.mesh, cell, x))
    }
    /// Whether the coefficient has a tensor.
    pub fn has_tensor(&self) -> bool {
        self.tensor.is_some()
    }
    /// A lower bound of the least eigenvalue of the tensor of a cell.
    pub fn least_of_tensor(&self, cell: usize) -> f64 {
        self.tensor_in(cell).map_or(1.0, TensorFactor::least)
    }
    /// Whether tensors are functions of space.
    pub fn has_varying_tensor(&self) -> bool {
        self.tensor.as_ref().is_some_and(TensorCoefficient::varies)
    }
    /// The volume of a cell and the integrals of the products of its gradients, times a factor.
    #[inline(always)]
    pub fn shape(&self, cell: usize, scale: f64) -> (f64, [[f64; 4]; 4]) {
        match &self.tensor {
            None => shape(self.mesh, cell, scale),
            Some(tensor) => tensor.shape(self.mesh, cell, scale),
        }
    }
    /// `n . T n` with the normal of a facet, the tensor from inside its cell.
    #[inline(always)]
    pub fn normal_component(&self, (cell, local): HalfFacet) -> f64 {
        self.tensor_in(cell).map_or(1.0, |factor| {
            factor.gradient(&self.mesh.geometry(cell).normal(local)).norm_squared()
        })
    }
    /// A gradient in a cell in the coordinates in which the coefficient has no direction.
    #[inline(always)]
    pub fn isotropic_gradient(&self, cell: usize, gradient: &Point<D>) -> Point<D> {
        self.tensor_in(cell).map_or(*gradient, |factor| factor.gradient(gradient))
    }
    /// The tensor times a gradient in a cell.
    #[inline(always)]
    pub fn tensor_times(&self, cell: usize, gradient: &Point<D>) -> Point<D> {
        self.tensor_in(cell).map_or(*gradient, |factor| factor.flux(gradient))
    }
    /// The corners of a cell in these coordinates.
    #[inline(always)]
    pub fn isotropic_corners(&self, cell: usize) -> [Point<D>; 4] {
        let corners = self.mesh.corners(cell);
        self.tensor_in(cell).map_or(corners, |factor| array_of(|k| factor.vector(&corners[k])))
    }
    /// The diameter of a cell in these coordinates.
    #[inline(always)]
    pub fn isotropic_diameter(&self, cell: usize) -> f64 {
        if self.tensor.is_none() {
            return self.mesh.cell_diameter(cell);
        }
        let corners = self.isotropic_corners(cell);
        let lengths =
            |x: &Point<D>| corners[..=D].iter().map(|y| (x - y).norm()).fold(0.0, f64::max);
        corners[..=D].iter().map(lengths).fold(0.0, f64::max)
    }
}

/// The factor of the normal derivative of a cell with the coefficient `a` in the flux: the harmonic mean of `a` and `b`
/// times the average weight of the cell.
#[inline(always)]
fn mean_weight(own_weight: f64, a: f64, b: f64) -> f64 {
    own_weight * a * b / (own_weight * b + (1.0 - own_weight) * a)
}

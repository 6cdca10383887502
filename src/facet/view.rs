//! A facet and its cells, as a penalty may see them.

use crate::mesh::{HalfFacet, Mesh};
use crate::real::Point;

/// One cell as its facet sees it.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The diffusion coefficient of the cell; where it varies within the cell and the element sees it, the
    /// largest value on the facet.
    pub coefficient: f64,
    /// The coefficient `a` with which the energy in the cell bounds the flux through the facet,
    /// `|alpha_F d_n v|_F^2 <= C_p alpha_F^2 / a |F| / |K| |alpha^1/2 grad v|_K^2` with the constant of
    /// [`proven_bound`](super::proven_bound): the diffusion coefficient of the cell. Where it varies within the cell and
    /// the element sees it, `alpha_F` on the left is a function on the facet, on the right it is made of
    /// [`Side::coefficient`], integrals are sums over the points at which the element sees the coefficient, and `a` is
    /// made of the largest eigenvalue of the form on the facet against that in the cell.
    pub bound_coefficient: f64,
    /// The volume of the cell.
    pub volume: f64,
    /// The measure of the cell's whole boundary.
    pub surface: f64,
    /// The height of the cell over the facet.
    pub height: f64,
}

/// The facets that carry a form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FacetKind {
    /// Between two cells.
    Interior,
    /// On the Dirichlet boundary.
    Dirichlet,
}

/// A facet and its cells: what a form may depend on.
///
/// Diameter, normal and coefficient are methods, computed only for forms that call them.
#[derive(Clone, Copy, Debug)]
pub struct FacetView<'a, const D: usize> {
    mesh: &'a Mesh<D>,
    /// The facet seen from the cell here.
    half: HalfFacet,
    /// The measure of the facet; one in one dimension.
    pub measure: f64,
    /// The cell here.
    pub here: Side,
    /// The cell there; none on the boundary.
    pub there: Option<Side>,
}

impl<'a, const D: usize> FacetView<'a, D> {
    /// The view of a facet: the facet seen from the cell here, its measure and its cells.
    #[inline(always)]
    pub fn new(
        mesh: &'a Mesh<D>,
        half: HalfFacet,
        measure: f64,
        here: Side,
        there: Option<Side>,
    ) -> Self {
        Self { mesh, half, measure, here, there }
    }
    /// Whether the facet lies between two cells or on the Dirichlet boundary.
    #[inline(always)]
    pub fn kind(&self) -> FacetKind {
        if self.there.is_some() { FacetKind::Interior } else { FacetKind::Dirichlet }
    }
    /// The diameter `h_F` of the facet; in one dimension the mean length of the cells it joins.
    #[inline(always)]
    pub fn diameter(&self) -> f64 {
        match (D, &self.there) {
            (1, None) => self.here.volume,
            (1, Some(there)) => (self.here.volume + there.volume) * 0.5,
            _ => self.mesh.facet_diameter(self.half.0, self.half.1),
        }
    }
    /// The unit normal, from here to there, outward on the boundary.
    pub fn normal(&self) -> Point<D> {
        self.mesh.geometry(self.half.0).normal(self.half.1)
    }
    /// The harmonic mean of the coefficients, `2 a b / (a + b)`; on the boundary the coefficient.
    #[inline(always)]
    pub fn coefficient(&self) -> f64 {
        self.conductance(0.5)
    }
    /// The harmonic mean of the coefficients with this average weight of the cell here; on the
    /// boundary the coefficient.
    #[inline(always)]
    pub fn conductance(&self, weight: f64) -> f64 {
        match &self.there {
            None => self.here.coefficient,
            Some(there) => {
                let (a, b) = (self.here.coefficient, there.coefficient);
                a * b / (weight * b + (1.0 - weight) * a)
            }
        }
    }
    /// The larger of a quantity on the two sides.
    #[inline(always)]
    pub fn largest(&self, quantity: impl Fn(&Side) -> f64) -> f64 {
        let here = quantity(&self.here);
        match &self.there {
            Some(there) if quantity(there) > here => quantity(there),
            _ => here,
        }
    }
    /// The sum of a quantity over the sides.
    #[inline(always)]
    pub fn sum(&self, quantity: impl Fn(&Side) -> f64) -> f64 {
        quantity(&self.here) + self.there.as_ref().map_or(0.0, quantity)
    }
}

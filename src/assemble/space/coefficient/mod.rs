//! The diffusion coefficient in cells in which it varies, for elements of degree two and more.
//!
//! Linear elements take one value in each cell, at its barycentre, which leaves an error of their own
//! order. Elements whose basis functions have degree `b > 1` take values at the points of rules of
//! degree `2 b`: exact for products of gradients times a quadratic coefficient. Rules exact for the
//! products alone keep the orders, with larger errors on coarse meshes (P. G. Ciarlet, P.-A. Raviart, The
//! combined effect of curved boundaries and numerical integration, in A. K. Aziz (ed.), 1972, 409-474).
//! On facets these are values from inside the cell, so that a coefficient may jump between cells. It may
//! vanish at the boundary of a cell, as `r` does on the axis of a body of revolution: no point of a rule
//! lies there. In a cell in which the coefficient jumps no rule keeps the order, see [`limited`].

pub(crate) mod tensor;
pub(crate) mod weighted_polynomials;

use self::weighted_polynomials::{Factor, WeightedPolynomials};
use super::checks::coefficient_at;
use super::tables::{BasisAt, CellTable, Derivatives};
use crate::arrays::map_entries;
use crate::assemble::stiffness::StiffnessTable;
use crate::element::{Element, MAX_BASIS};
use crate::error::Error;
use crate::mesh::{HalfFacet, Mesh};
use crate::problem::DataByGroup;
use crate::quadrature::{FullySymmetric, OrthonormalPolynomials, Quadrature, Rule, facet_to_cell};

/// Samples that differ from the value at the barycentre by no more than this, in units of rounding, are
/// those of a constant.
const ROUNDINGS: f64 = 16.0;

/// By what factor a value may differ from that at the barycentre of its cell: in a cell beside an axis the square of the
/// distance does so by 19.7 on a line, by 13 in the plane.
const MOST_TIMES_BARYCENTRE: f64 = 20.0;

/// The share of the way to the barycentre by which a point of a facet is moved to see the cell's own side
/// of a jump.
pub(crate) const INWARD: f64 = 1e-8;

/// A value of the coefficient in a cell as elements see it: within a twentieth and twenty times that at the
/// barycentre. Beyond lies a jump within the cell, with which the penalty that the proof of coercivity asks for would
/// grow; a coefficient that vanishes on an axis lies beyond where it does not count.
pub(super) fn limited(value: f64, at_barycentre: f64) -> f64 {
    let (least, most) =
        (at_barycentre / MOST_TIMES_BARYCENTRE, at_barycentre * MOST_TIMES_BARYCENTRE);
    value.max(least).min(most)
}

/// The start of a cell in which the coefficient is a constant.
const CONSTANT: u32 = u32::MAX;

/// The values of a coefficient in the cells in which it varies, and the reference cell at the points of
/// the rules.
pub(crate) struct VaryingCoefficient {
    /// By cell, where its values start.
    starts: Vec<u32>,
    /// For each cell in which the coefficient varies the values at the points of the rule in the cell,
    /// then facet by facet at those of the rule on facets.
    values: Vec<f64>,
    /// By point of the rule in the cell, the stiffness of the reference element with its weight.
    stiffness: Vec<StiffnessTable>,
    /// The weights of the rule on facets.
    facet_weights: Vec<f64>,
    /// By moment and point of the facet, the polynomial, up to the degree of the basis functions.
    polynomials: Vec<f64>,
    /// The number of moments that have a flux: those below that degree.
    flux_moments: usize,
    /// By facet, moment and point of the facet, the derivatives of the basis times polynomial and weight.
    derivatives: Vec<Derivatives>,
    /// The polynomials of the cell at the points of its rule.
    in_cell: WeightedPolynomials,
}

impl VaryingCoefficient {
    /// Samples a coefficient; none if it varies in no cell. `constants` are the values at the
    /// barycentres.
    ///
    /// # Errors
    /// [`Error::CoefficientNotPositive`], [`Error::Parameter`] for a value whose square is no floating-point number.
    pub fn new<const D: usize>(
        alpha: &DataByGroup<D>,
        mesh: &Mesh<D>,
        constants: &[f64],
        element: &dyn Element<D>,
    ) -> Result<Option<Self>, Error> {
        let basis_degree = element.basis_degree();
        // the same whatever the order of vertices
        let rule = |dimension| FullySymmetric.rule(dimension, 2 * basis_degree);
        let (cell_rule, facet_rule) = (rule(D)?, rule(D - 1)?);
        let points = sampled_points(D, &cell_rule, &facet_rule);
        let mut starts = vec![CONSTANT; mesh.n_cells()];
        let mut values: Vec<f64> = Vec::new();
        for (cell, start) in starts.iter_mut().enumerate() {
            let (corners, constant) = (mesh.corners(cell), constants[cell]);
            let first = values.len();
            for point in &points {
                let x = corners.iter().zip(point).map(|(corner, &b)| corner * b).sum();
                values.push(limited(coefficient_at(alpha, mesh, cell, &x)?, constant));
            }
            let is_same = |v: &f64| (v / constant - 1.0).abs() <= ROUNDINGS * f64::EPSILON;
            if values[first..].iter().all(is_same) {
                values.truncate(first);
            } else {
                *start = first as u32;
            }
        }
        if values.is_empty() {
            return Ok(None);
        }
        let at_point = |(&point, &weight)| {
            let rule = Rule { points: vec![point], weights: vec![weight] };
            StiffnessTable::new(D, &CellTable::new(rule, element), None)
        };
        let polynomials = OrthonormalPolynomials::new(D - 1, basis_degree);
        let moments = 0..polynomials.len();
        let flux_moments = moments.filter(|&k| polynomials.degree(k) < basis_degree).count();
        let mut derivatives = Vec::new();
        for local in 0..=D {
            for k in 0..flux_moments {
                for (point, weight) in facet_rule.iter() {
                    let scale = weight * polynomials.value(k, point);
                    let basis = BasisAt::new(element, &facet_to_cell(point, local));
                    derivatives.push(map_entries(basis.derivatives, |row| {
                        map_entries(row, |d| scale * d)
                    }));
                }
            }
        }
        let mut at_points = Vec::with_capacity(polynomials.len() * facet_rule.points.len());
        for k in 0..polynomials.len() {
            for point in &facet_rule.points {
                at_points.push(polynomials.value(k, point));
            }
        }
        Ok(Some(Self {
            starts,
            values,
            stiffness: cell_rule.points.iter().zip(&cell_rule.weights).map(at_point).collect(),
            facet_weights: facet_rule.weights.to_vec(),
            polynomials: at_points,
            flux_moments,
            derivatives,
            in_cell: WeightedPolynomials::new(D, basis_degree, &cell_rule),
        }))
    }

    /// The values in a cell in which the coefficient varies: at the points of the rule in the cell, and
    /// after them on its facets.
    #[inline(always)]
    fn of_cell(&self, cell: usize) -> Option<&[f64]> {
        let start = self.starts[cell];
        (start != CONSTANT).then(|| &self.values[start as usize..])
    }
    /// The values at the points of the rule in a cell, if the coefficient varies there.
    #[inline(always)]
    pub fn in_cell(&self, cell: usize) -> Option<&[f64]> {
        self.of_cell(cell).map(|values| &values[..self.stiffness.len()])
    }
    /// The values on a facet from its cell, if the coefficient varies in the cell.
    #[inline(always)]
    pub fn on_facet(&self, (cell, local): HalfFacet) -> Option<&[f64]> {
        let n = self.facet_weights.len();
        self.of_cell(cell).map(|values| &values[self.stiffness.len() + local * n..][..n])
    }
    /// The largest value on a facet, at the points of its rule, if the coefficient varies in the cell.
    pub fn largest(&self, own: HalfFacet) -> Option<f64> {
        Some(self.on_facet(own)?.iter().fold(0.0, |a, &b| if b > a { b } else { a }))
    }
    /// The factor of the products of the polynomials of a degree, at most that of the basis functions, in a cell with
    /// these values.
    pub fn factor(&self, degree: usize, values: &[f64]) -> Factor {
        self.in_cell.factor(degree, values)
    }
    /// By how much moments on facet `local` of polynomials of the degree of derivatives, times a weight at its points,
    /// exceed their energy in a cell with these values: one where coefficient and weight are.
    pub fn largest_flux(&self, local: usize, values: &[f64], weight: impl Fn(usize) -> f64) -> f64 {
        let weighted = |k: usize, l: usize| self.weighted_product(k, l, &weight);
        self.in_cell.largest_flux(local, values, &weighted)
    }
    /// Entry `(i, j)` of `(alpha grad phi_j, grad phi_i)` over a cell with these values and products of gradients.
    pub fn stiffness<const D: usize>(
        &self,
        values: &[f64],
        products: &[[f64; 4]; 4],
        i: usize,
        j: usize,
    ) -> f64 {
        let points = self.stiffness.iter().zip(values);
        points.fold(0.0, |sum, (table, &alpha)| sum + alpha * table.entry::<D>(products, i, j))
    }
    /// Moment `k` on facet `local` of the derivatives of the basis, with a weight at each point. Moments
    /// of the degree of the basis functions and above are left out of fluxes.
    pub fn weighted_derivatives(
        &self,
        local: usize,
        k: usize,
        weight: impl Fn(usize) -> f64,
    ) -> Derivatives {
        let n = self.facet_weights.len();
        let mut sum = [[0.0; 4]; MAX_BASIS];
        if k < self.flux_moments {
            let start = (local * self.flux_moments + k) * n;
            for (q, table) in self.derivatives[start..start + n].iter().enumerate() {
                let weight = weight(q);
                for (sum, row) in sum.iter_mut().zip(table) {
                    for (sum, &d) in sum.iter_mut().zip(row) {
                        *sum += weight * d;
                    }
                }
            }
        }
        sum
    }
    /// Moment `k` of a weight times moment `l`, by the points of a facet. Moments with and without a flux
    /// are not mixed: the lift of a jump tested with gradients is then its flux.
    pub fn weighted_product(&self, k: usize, l: usize, weight: impl Fn(usize) -> f64) -> f64 {
        let n = self.facet_weights.len();
        let is_beyond = k.max(l) >= self.polynomials.len() / n;
        if is_beyond || (k < self.flux_moments) != (l < self.flux_moments) {
            return 0.0;
        }
        let term = |q: usize| {
            self.facet_weights[q]
                * weight(q)
                * self.polynomials[k * n + q]
                * self.polynomials[l * n + q]
        };
        (0..n).fold(0.0, |sum, q| sum + term(q))
    }
}

/// The points of the rule in the cell, then by facet those of the rule on facets, moved inward.
fn sampled_points(dimension: usize, cell_rule: &Rule, facet_rule: &Rule) -> Vec<[f64; 4]> {
    let middle = 1.0 / (dimension + 1) as f64;
    let mut points = cell_rule.points.clone();
    for local in 0..=dimension {
        for point in &facet_rule.points {
            let mut point = facet_to_cell(point, local);
            for b in &mut point[..=dimension] {
                *b += (middle - *b) * INWARD;
            }
            points.push(point);
        }
    }
    points
}

//! Squares of errors, integrated over cells.

use std::ops::Range;
use std::sync::Arc;

use super::admissible::InCells;
use super::errors::Errors;
use super::evaluation::Reference;
use crate::assemble::cut_simplices::CutRule;
use crate::assemble::space::tables::{BasisAt, CellTable};
use crate::assemble::space::{Space, Terms, data};
use crate::error::Error;
use crate::parallel::cells;
use crate::problem::{Exact, Field};
use crate::quadrature::Rule;
use crate::real::{Point, Real, point_f64};

/// Degree of the rule for error norms: the exact solution is not polynomial, and the rule must not
/// limit what it measures. Cells that the exact free boundary or a jump of the load cuts are divided. For
/// basis functions of degree `b` the degree of the rule is at least `2 b + 2`, that of the square of the
/// largest part of the error.
const fn error_degree(dimension: usize) -> usize {
    match dimension {
        1 | 2 => 19,
        _ => 9,
    }
}

/// Degree of the rule for means over facets.
const MEAN_DEGREE: usize = 5;

/// Squares of the norms of the error.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SquaredErrors {
    /// Square of the L2 norm.
    l2: f64,
    /// Square of the broken H1 seminorm.
    h1: f64,
    /// Square of the energy norm.
    pub energy: f64,
    /// Square of the broken energy norm.
    pub broken_energy: f64,
    /// Maximum over nodes.
    max: f64,
    /// Square of the energy norm of the error of a function in cells.
    pub of_function: f64,
}

impl SquaredErrors {
    fn add(&mut self, other: &Self) {
        self.l2 += other.l2;
        self.h1 += other.h1;
        self.broken_energy += other.broken_energy;
        self.max = self.max.max(other.max);
        self.of_function += other.of_function;
    }
    /// The norms.
    pub fn roots(&self) -> Errors {
        Errors {
            l2: Some(self.l2.sqrt()),
            h1: Some(self.h1.sqrt()),
            energy: Some(self.energy.sqrt()),
            broken_energy: Some(self.broken_energy.sqrt()),
            max: Some(self.max),
        }
    }
}

/// What the errors of all cells read.
struct Measure<'m, 'r, 'f, T: Real, const D: usize> {
    exact: &'m Reference<'r, T, D>,
    table: CellTable<f64>,
    /// The rule on cells that kinks cut.
    cut_rule: Option<CutRule>,
    /// By region the function whose zeros are kinks.
    kinks: Vec<Option<Field<D>>>,
    /// The functional of each node.
    nodes: Vec<Terms>,
    u: Option<&'m [T]>,
    function: Option<InCells<'f, D>>,
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// Squares of the errors of a vector of unknowns and of a function in cells over all cells.
    pub(super) fn cell_errors(
        &self,
        exact: &Reference<'_, T, D>,
        u: Option<&[T]>,
        function: Option<InCells<'_, D>>,
    ) -> Result<SquaredErrors, Error> {
        let degree = match exact {
            Reference::Exact(_) => error_degree(D).max(2 * self.basis_degree + 2),
            // the square of a difference of polynomials
            Reference::Coarse { space, .. } => 2 * self.basis_degree.max(space.basis_degree),
        };
        let cell_rule = Rule::new(D, degree);
        let nodes = self.node_terms(&Rule::new(D - 1, MEAN_DEGREE), &cell_rule);
        let kinks: Vec<Option<Field<D>>> =
            (0..self.mesh.regions().len()).map(|region| self.kinks(exact, region)).collect();
        let cut_rule = kinks.iter().any(Option::is_some).then(|| CutRule::new(D, degree));
        let table = self.cell_table(cell_rule);
        let measure = Measure { exact, table, cut_rule, kinks, nodes, u, function };
        // partial sums are added in order, so the result does not depend on threads
        let parts = cells::map(self.mesh.n_cells(), &|mut cells: Range<usize>| {
            cells.try_fold(SquaredErrors::default(), |mut sum, cell| {
                sum.add(&self.cell_error(&measure, cell)?);
                Ok::<_, Error>(sum)
            })
        });
        parts.into_iter().try_fold(SquaredErrors::default(), |mut total, part| {
            total.add(&part?);
            Ok(total)
        })
    }

    /// The function whose zeros are those of the level of the load of a region and, with an obstacle, the exact free
    /// boundary: second derivatives of the exact solution jump there.
    fn kinks(&self, exact: &Reference<'_, T, D>, region: usize) -> Option<Field<D>> {
        let Reference::Exact(Exact { contact, .. }) = exact else { return None };
        let contact = contact.as_ref().filter(|_| self.problem.has_obstacle());
        let indicator = contact.map(|set| set.indicator.clone());
        let levels = self.data.source.of(region).and_then(|f| f.level()).cloned();
        let product = |a: Field<D>, b: Field<D>| -> Field<D> { Arc::new(move |x| a(x) * b(x)) };
        indicator.into_iter().chain(levels).reduce(product)
    }

    /// The squares of a cell.
    fn cell_error(
        &self,
        of: &Measure<'_, '_, '_, T, D>,
        cell: usize,
    ) -> Result<SquaredErrors, Error> {
        let geometry = self.mesh.geometry(cell);
        let (volume, region) = (geometry.volume.to_f64(), self.mesh.region(cell));
        let local = of.u.map(|u| self.local_values(cell, u));
        let function = of.function.map(|f| f(cell));
        let n = self.per_cell();
        let mut sum = SquaredErrors::default();
        // the derivatives of linear functions are those at any point
        let is_linear = self.basis_degree <= 1;
        let shares_of = |basis: &BasisAt<f64>| -> [Point<f64, D>; 4] {
            std::array::from_fn(|k| match (k <= D, &local) {
                (true, Some(local)) => {
                    let slope: f64 = (0..n).map(|i| local[i] * basis.derivatives[i][k]).sum();
                    point_f64(geometry.gradient(k)) * slope
                }
                _ => Point::zeros(),
            })
        };
        let of_linear = is_linear.then(|| shares_of(&of.table.basis[0]));
        let [coefficient, reaction] =
            [&self.data.coefficient, &self.data.reaction].map(|data| data.of(region));
        let mut add = |point: &[f64; 4], x: &Point<f64, D>, weight: f64, basis: &BasisAt<f64>| {
            let weight = weight * volume;
            let gradient = of.exact.gradient(cell, x);
            let value = data::finite(of.exact.value(cell, x), "exact solution", x, cell)?;
            let reaction = reaction.map_or(0.0, |c| c.at(x));
            if let Some(local) = &local {
                let shares = of_linear.unwrap_or_else(|| shares_of(basis));
                let error = shares[..=D].iter().fold(-gradient, |sum, share| sum + share);
                let difference = basis.value(local) - value;
                let square = data::finite(error.norm_squared(), "exact gradient", x, cell)?;
                let alpha = self.alpha_at(cell, x);
                sum.l2 += weight * difference * difference;
                sum.h1 += weight * square;
                sum.broken_energy += weight * (alpha * square + reaction * difference * difference);
            }
            if let Some(function) = &function {
                let (own, slope) = function.at(point, x);
                let alpha = coefficient.map_or(1.0, |alpha| alpha.at(x));
                let (square, difference) = ((gradient - slope).norm_squared(), value - own);
                sum.of_function += weight * (alpha * square + reaction * difference * difference);
            }
            Ok::<_, Error>(())
        };
        let cut = of.cut_rule.as_ref().zip(of.kinks[region].as_ref());
        let mut outcome = Ok(());
        let is_cut = cut.is_some_and(|(rule, level)| {
            rule.visit_if_cut(self.mesh, cell, level, &mut |point, x, weight| {
                if outcome.is_ok() {
                    outcome = add(point, x, weight, &self.basis_at(point));
                }
            })
        });
        outcome?;
        if !is_cut {
            let CellTable { points, basis, weights } = &of.table;
            for ((point, basis), &weight) in points.iter().zip(basis).zip(weights) {
                add(point, &self.cell_point(point, cell), weight, basis)?;
            }
        }
        for ((node, terms), value) in self.nodes.iter().zip(&of.nodes).zip(local.iter().flatten()) {
            let exact =
                |(p, w): &([f64; 4], f64)| w * of.exact.value(cell, &self.cell_point(p, cell));
            let exact_value: f64 = terms.iter().map(exact).sum();
            let x = self.node_point(cell, node);
            let exact_value = data::finite(exact_value, "exact solution", &x, cell)?;
            sum.max = sum.max.max((value - exact_value).abs());
        }
        Ok(sum)
    }
}

//! Squares of errors, integrated over cells.

use std::ops::Range;

use super::admissible::{Admissible, InCells};
use super::evaluation::Reference;
use super::squared_errors::{SquaredErrors, Squares};
use crate::arrays::array_of;
use crate::assemble::cut_simplices::{CutRule, in_space};
use crate::assemble::space::tables::{BasisAt, CellTable};
use crate::assemble::space::{Space, Terms, checks};
use crate::element::MAX_BASIS;
use crate::error::Error;
use crate::parallel::cells;
use crate::problem::{Datum, Exact, Field};
use crate::quadrature::{FullySymmetric, Quadrature, Rule};
use crate::real::{Point, maximum};

/// Degrees of the rule for error norms, by dimension those of linears and of quadratics: at least two above that of the
/// square of the largest term of the error. The exact solution is not polynomial, and the rule must not limit what it
/// measures: with two degrees less the errors of quadratics on cone-2d move by 5 %.
const ERROR_DEGREES: [[usize; 2]; 4] = [[0; 2], [19; 2], [6, 10], [6, 8]];

/// Degree of the rule for means over facets.
const MEAN_DEGREE: usize = 5;

/// Whether a cell counts in a sum over cells.
pub(crate) type Counts<'c> = &'c (dyn Fn(usize) -> bool + Sync);

/// The data that the errors of all cells read.
struct Measure<'m, 'r, 'f, const D: usize> {
    exact: &'m Reference<'r, D>,
    table: CellTable,
    /// The rule on cells that kinks cut.
    cut: CutRule,
    /// By region the functions whose zeros are kinks.
    kinks: Vec<Vec<Field<D>>>,
    /// The functional of each node.
    nodes: Vec<Terms>,
    u: Option<&'m [f64]>,
    function: Option<InCells<'f, D>>,
}

/// What the error is made of in a cell.
struct InCell<'c, const D: usize> {
    exact: &'c Reference<'c, D>,
    cell: usize,
    /// What was taken off the values of the discrete function.
    constant: f64,
    volume: f64,
    /// The gradients of the barycentric coordinates.
    gradients: [Point<D>; 4],
    /// The unknowns of the discrete function, if its error is measured.
    discrete: Option<[f64; MAX_BASIS]>,
    /// The admissible function, if its error is measured.
    admissible: Option<Admissible<'c, D>>,
    /// The diffusion coefficient in the energy norm of the discrete function, where it is constant in the cell.
    alpha: f64,
    /// The diffusion coefficient where the scheme evaluates it at the points of a rule.
    varying: Option<&'c Datum<D>>,
    coefficient: Option<&'c Datum<D>>,
    space: &'c Space<'c, D>,
    reaction: Option<&'c Datum<D>>,
}

impl<const D: usize> InCell<'_, D> {
    /// Adds the squares of the error at a point, with the weight of the point.
    fn add(
        &self,
        sums: &mut Squares,
        (point, x): (&[f64; 4], &Point<D>),
        weight: f64,
        basis: &BasisAt,
    ) {
        let weight = weight * self.volume;
        let value = self.exact.value(self.cell, x, self.constant);
        let gradient = self.exact.gradient(self.cell, x);
        let reaction = self.reaction.map_or(0.0, |c| c.at(x));
        if let Some(discrete) = &self.discrete {
            let difference = basis.gradient(discrete, &self.gradients) - gradient;
            let square = difference.norm_squared();
            let in_energy = match self.space.tensor_in(self.cell) {
                None => square,
                Some(tensor) => tensor.gradient(&difference).norm_squared(),
            };
            let of_value = (basis.value(discrete) - value).powi(2);
            let alpha = self.varying.map_or(self.alpha, |alpha| alpha.at(x));
            sums[0] += weight * of_value;
            sums[1] += weight * square;
            sums[2] += weight * (alpha * in_energy + reaction * of_value);
        }
        if let Some(admissible) = &self.admissible {
            let (own, slope) = admissible.at(point, x);
            let alpha = self.coefficient.map_or(1.0, |alpha| alpha.at(x));
            let difference = slope - gradient;
            let tensor = self.space.tensor_at(self.cell, x);
            let difference = tensor.map_or(difference, |tensor| tensor.gradient(&difference));
            let square = difference.norm_squared();
            sums[3] += weight * (alpha * square + reaction * (own - value).powi(2));
        }
    }

    /// Adds the square of the error at a point of a Robin side to those of the energy, with the weight of the point.
    fn add_on_side(
        &self,
        sums: &mut Squares,
        (point, x): (&[f64; 4], &Point<D>),
        weight: f64,
        basis: &BasisAt,
    ) {
        let value = self.exact.value(self.cell, x, self.constant);
        if let Some(discrete) = &self.discrete {
            sums[2] += weight * (basis.value(discrete) - value).powi(2);
        }
        if let Some(admissible) = &self.admissible {
            sums[3] += weight * (admissible.at(point, x).0 - value).powi(2);
        }
    }

    /// Finds whether the exact solution is finite at a point.
    fn check(&self, x: &Point<D>) -> Result<(), Error> {
        let value = self.exact.value(self.cell, x, self.constant);
        checks::finite(value, "exact solution", x, self.cell)?;
        let square = self.exact.gradient(self.cell, x).norm_squared();
        checks::finite(square, "exact gradient", x, self.cell).map(|_| ())
    }
}

impl<const D: usize> Space<'_, D> {
    /// Squares of the errors of a vector of unknowns and of a function in cells over the cells that count.
    pub(super) fn cell_errors(
        &self,
        exact: &Reference<'_, D>,
        u: Option<&[f64]>,
        function: Option<InCells<'_, D>>,
        counts: Counts<'_>,
    ) -> Result<SquaredErrors, Error> {
        let degree = match exact {
            Reference::Exact(_) => ERROR_DEGREES[D][usize::from(self.basis_degree > 1)],
            // exact: the integrand is the square of a difference of polynomials
            Reference::Coarse { space, .. } => 2 * self.basis_degree.max(space.basis_degree),
        };
        let rule = FullySymmetric.rule(D, degree)?;
        let regions = 0..self.mesh.regions().len();
        let measure = Measure {
            exact,
            table: self.cell_table(rule),
            cut: CutRule::new(D, degree),
            kinks: regions.map(|region| self.kinks(exact, region)).collect(),
            nodes: self.node_terms(&Rule::new(D - 1, MEAN_DEGREE)),
            u,
            function,
        };
        // partial sums are added in order, so the result does not depend on threads
        let chunks = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            let mut sum = SquaredErrors::default();
            for cell in cells.filter(|&cell| counts(cell)) {
                let in_cell = self.in_cell(&measure, cell);
                sum.add(&self.squares_in(&measure, &in_cell)?);
                sum.max = maximum(sum.max, self.largest_at_nodes(&measure, &in_cell)?);
            }
            Ok::<_, Error>(sum)
        });
        chunks.into_iter().try_fold(SquaredErrors::default(), |total, sum| Ok(total.merge(sum?)))
    }

    /// The functions whose zeros are kinks of the exact solution in a region: that of the exact free boundary, where
    /// there is an obstacle, and the levels of load, coefficient and reaction.
    fn kinks(&self, exact: &Reference<'_, D>, region: usize) -> Vec<Field<D>> {
        let Reference::Exact(Exact { contact, .. }) = exact else { return Vec::new() };
        let contact = contact.as_ref().filter(|_| self.problem.has_obstacle());
        let indicator = contact.map(|set| set.indicator.clone());
        let data = [&self.data.source, &self.data.coefficient, &self.data.reaction];
        let of_data = data.map(|data| data.of(region).and_then(|f| f.level()).cloned());
        indicator.into_iter().chain(of_data.into_iter().flatten()).collect()
    }

    fn in_cell<'c, 'f: 'c>(&'c self, of: &'c Measure<'_, '_, 'f, D>, cell: usize) -> InCell<'c, D> {
        let geometry = self.mesh.geometry(cell);
        let gradient = |k: usize| (k <= D).then(|| *geometry.gradient(k));
        let coefficient = self.data.coefficient.of(self.mesh.region(cell));
        InCell {
            exact: of.exact,
            cell,
            constant: self.body_constants.of_cell(cell),
            volume: geometry.volume,
            gradients: array_of(|k| gradient(k).unwrap_or_else(Point::zeros)),
            discrete: of.u.map(|u| self.local_values(cell, u)),
            admissible: of.function.map(|function| function(cell)),
            alpha: self.alpha(cell),
            varying: coefficient.filter(|_| self.varying_in(cell).is_some()),
            coefficient,
            space: self,
            reaction: self.data.reaction.of(self.mesh.region(cell)),
        }
    }

    /// The squares of a cell, divided where kinks cut it.
    fn squares_in(
        &self,
        of: &Measure<'_, '_, '_, D>,
        in_cell: &InCell<'_, D>,
    ) -> Result<Squares, Error> {
        let (mut sums, cell) = (Squares::default(), in_cell.cell);
        let kinks = &of.kinks[self.mesh.region(cell)];
        let is_cut = of.cut.visit_if_cut(self.mesh, cell, kinks, &mut |point, x, weight| {
            in_cell.add(&mut sums, (point, x), weight, &self.basis_at(point));
        });
        if let Some(reaction) = self.reaction.as_ref().filter(|_| self.data.robin.is_given()) {
            reaction.visit_sides(self.mesh, cell, &mut |point, x, weight| {
                in_cell.add_on_side(&mut sums, (point, x), weight, &self.basis_at(point));
            });
        }
        let corners = self.mesh.corners(cell);
        if !is_cut {
            let CellTable { points, basis, weights } = &of.table;
            for ((point, basis), &weight) in points.iter().zip(basis).zip(weights) {
                in_cell.add(&mut sums, (point, &in_space(point, &corners)), weight, basis);
            }
        }
        // sums are not finite either where values of the discrete function are not
        if !sums.iter().all(|square| square.is_finite()) {
            let mut outcome = Ok(());
            of.cut.visit(&corners, kinks, &mut |point, _| {
                if outcome.is_ok() {
                    outcome = in_cell.check(&in_space(point, &corners));
                }
            });
            outcome?;
        }
        Ok(sums)
    }

    /// The largest error at the nodes of a cell.
    fn largest_at_nodes(
        &self,
        of: &Measure<'_, '_, '_, D>,
        in_cell: &InCell<'_, D>,
    ) -> Result<f64, Error> {
        let (Some(discrete), cell) = (&in_cell.discrete, in_cell.cell) else { return Ok(0.0) };
        let mut largest = 0.0_f64;
        for ((node, terms), own) in self.nodes.iter().zip(&of.nodes).zip(discrete) {
            let at = |(point, weight): &([f64; 4], f64)| {
                weight * of.exact.value(cell, &self.cell_point(point, cell), in_cell.constant)
            };
            let value = terms.iter().map(at).sum();
            checks::finite(value, "exact solution", &self.node_point(cell, node), cell)?;
            largest = maximum(largest, (own - value).abs());
        }
        Ok(largest)
    }
}

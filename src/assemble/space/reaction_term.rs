//! The reaction term in the matrix of a cell.

use super::data::finite;
use super::tables::{BasisAt, CellTable};
use crate::assemble::count;
use crate::assemble::cut_simplices::{CutRule, Visit};
use crate::assemble::local::Local;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::problem::{Datum, Field};
use crate::quadrature::Rule;
use crate::real::{Point, Real, point_f64};

/// The reaction term, with the rule that integrates it.
pub(crate) struct ReactionTerm<'a, T, const D: usize> {
    datum: &'a Datum<D>,
    table: CellTable<T>,
    /// For a datum with a level: the level, and the rule on cells that its zero set cuts.
    cut: Option<(&'a Field<D>, CutRule)>,
    basis: fn(&[f64; 4]) -> BasisAt<f64>,
    n: usize,
}

impl<'a, T: Real, const D: usize> ReactionTerm<'a, T, D> {
    /// The term of a datum with `n` basis functions at the points of a rule. A rule at vertices alone,
    /// which lumps the term, is used on cells that are cut too.
    pub fn new(
        datum: &'a Datum<D>,
        rule: Rule,
        degree: usize,
        basis: fn(&[f64; 4]) -> BasisAt<f64>,
        n: usize,
    ) -> Self {
        let is_lumped = rule.points.iter().all(|point| point.contains(&1.0));
        let level = datum.level().filter(|_| !is_lumped);
        let cut = level.map(|level| (level, CutRule::new(D, degree)));
        Self { datum, table: CellTable::new(rule, basis).rounded(), cut, basis, n }
    }
    /// Adds `(c phi_j, phi_i)` over a cell.
    pub fn add(&self, mesh: &Mesh<T, D>, cell: usize, volume: T, out: &mut Local<T>) {
        let mut add = |c: f64, weight: T, basis: &BasisAt<T>| {
            count::reaction(1);
            let scale = T::lit(c) * volume * weight;
            for i in 0..self.n {
                for j in 0..self.n {
                    out[i][j] += scale * basis.values[i] * basis.values[j];
                }
            }
        };
        if self.visit_cut(mesh, cell, &mut |point, x, weight| {
            add(self.datum.at(x), T::lit(weight), &(self.basis)(point).rounded());
        }) {
            return;
        }
        let table = &self.table;
        for ((point, basis), &weight) in table.points.iter().zip(&table.basis).zip(&table.weights) {
            let c = match self.datum {
                Datum::Constant(c) => *c,
                datum => datum.at(&point_f64(&mesh.point(cell, &point[..=D]))),
            };
            add(c, weight, basis);
        }
    }
    /// Whether the datum is not negative at the points of the rule.
    pub fn is_nonnegative(&self, mesh: &Mesh<T, D>) -> bool {
        if let Datum::Constant(c) = self.datum {
            return *c >= 0.0;
        }
        let mut is_nonnegative = true;
        for cell in 0..mesh.n_cells() {
            self.visit_points(mesh, cell, &mut |x| is_nonnegative &= self.datum.at(x) >= 0.0);
        }
        is_nonnegative
    }
    /// Finds the point at which the datum is not finite.
    pub fn check(&self, mesh: &Mesh<T, D>) -> Result<(), Error> {
        for cell in 0..mesh.n_cells() {
            let mut outcome = Ok(0.0);
            self.visit_points(mesh, cell, &mut |x| {
                if outcome.is_ok() {
                    outcome = finite(self.datum.at(x), "reaction", x, cell);
                }
            });
            outcome?;
        }
        Ok(())
    }
    /// Visits the points of the rule on a cell, in space.
    fn visit_points(&self, mesh: &Mesh<T, D>, cell: usize, visit: &mut dyn FnMut(&Point<f64, D>)) {
        if !self.visit_cut(mesh, cell, &mut |_, x, _| visit(x)) {
            for point in &self.table.points {
                visit(&point_f64(&mesh.point(cell, &point[..=D])));
            }
        }
    }
    /// Whether a cell is cut; if it is, its points of the rule are visited: in barycentric coordinates, in
    /// space, and with their weights.
    fn visit_cut(&self, mesh: &Mesh<T, D>, cell: usize, visit: Visit<'_, D>) -> bool {
        let cut = self.cut.as_ref();
        cut.is_some_and(|(level, rule)| rule.visit_if_cut(mesh, cell, level, visit))
    }
}

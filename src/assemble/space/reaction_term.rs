//! The reaction term in the matrix of a cell.

use std::slice::from_ref;
use std::sync::Arc;

use super::checks::finite;
use super::tables::{BasisAt, CellTable};
use crate::assemble::cut_simplices::{CutRule, Visit};
use crate::assemble::stiffness::Local;
use crate::element::Element;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::problem::{DataByGroup, Datum};
use crate::quadrature::Rule;
use crate::real::Point;

/// The reaction term, with the rule that integrates it.
pub(crate) struct ReactionTerm<const D: usize> {
    data: DataByGroup<D>,
    table: CellTable,
    /// Where a datum has a level: the rule on cells that its zero set cuts.
    cut: Option<CutRule>,
    element: Arc<dyn Element<D>>,
    n: usize,
}

impl<const D: usize> ReactionTerm<D> {
    /// The term of data with the basis of an element at the points of a rule. A rule at vertices alone,
    /// which lumps the term, is used on cells that are cut too.
    pub fn new(
        data: DataByGroup<D>,
        rule: Rule,
        degree: usize,
        element: Arc<dyn Element<D>>,
    ) -> Self {
        let is_lumped = rule.points.iter().all(|point| point.contains(&1.0));
        let has_level = data.any(&|datum| datum.level().is_some());
        let cut = (has_level && !is_lumped).then(|| CutRule::new(D, degree));
        Self { data, table: CellTable::new(rule, &*element), cut, n: element.per_cell(), element }
    }
    /// Adds `(c phi_j, phi_i)` over a cell.
    pub fn add(&self, mesh: &Mesh<D>, cell: usize, volume: f64, out: &mut Local) {
        let Some(datum) = self.data.of(mesh.region(cell)) else { return };
        let mut add = |c: f64, weight: f64, basis: &BasisAt| {
            let scale = c * volume * weight;
            for i in 0..self.n {
                for j in 0..self.n {
                    out[i][j] += scale * basis.values[i] * basis.values[j];
                }
            }
        };
        if self.visit_cut(datum, mesh, cell, &mut |point, x, weight| {
            add(datum.in_cell(mesh, cell, x), weight, &BasisAt::new(&*self.element, point));
        }) {
            return;
        }
        let table = &self.table;
        for ((point, basis), &weight) in table.points.iter().zip(&table.basis).zip(&table.weights) {
            let at = || datum.in_cell(mesh, cell, &mesh.point(cell, &point[..=D]));
            add(datum.constant().unwrap_or_else(at), weight, basis);
        }
    }
    /// Whether the data are not negative at the points of the rule.
    pub fn is_nonnegative(&self, mesh: &Mesh<D>) -> bool {
        if self.data.every(&|datum| datum.constant().is_some_and(|c| c >= 0.0)) {
            return true;
        }
        let mut is_nonnegative = true;
        for cell in 0..mesh.n_cells() {
            self.visit_values(mesh, cell, &mut |c, _| is_nonnegative &= c >= 0.0);
        }
        is_nonnegative
    }
    /// Finds the point at which a datum is not finite.
    pub fn check(&self, mesh: &Mesh<D>) -> Result<(), Error> {
        for cell in 0..mesh.n_cells() {
            let mut outcome = Ok(0.0);
            self.visit_values(mesh, cell, &mut |c, x| {
                if outcome.is_ok() {
                    outcome = finite(c, "reaction", x, cell);
                }
            });
            outcome?;
        }
        Ok(())
    }
    /// Visits the values of the datum at the points of the rule on a cell.
    fn visit_values(&self, mesh: &Mesh<D>, cell: usize, visit: &mut dyn FnMut(f64, &Point<D>)) {
        let Some(datum) = self.data.of(mesh.region(cell)) else { return };
        if !self.visit_cut(datum, mesh, cell, &mut |_, x, _| visit(datum.in_cell(mesh, cell, x), x))
        {
            for point in &self.table.points {
                let x = mesh.point(cell, &point[..=D]);
                visit(datum.in_cell(mesh, cell, &x), &x);
            }
        }
    }
    /// Whether the level of a datum cuts a cell; if it does, its points of the rule are visited: in barycentric coordinates, in
    /// space, and with their weights.
    fn visit_cut(
        &self,
        datum: &Datum<D>,
        mesh: &Mesh<D>,
        cell: usize,
        visit: Visit<'_, D>,
    ) -> bool {
        let cut = self.cut.as_ref().zip(datum.level());
        cut.is_some_and(|(rule, level)| rule.visit_if_cut(mesh, cell, from_ref(level), visit))
    }
}

//! The reaction term in the matrix of a cell, with that of Robin sides.

use std::slice::from_ref;
use std::sync::Arc;

use super::checks::{finite, not_negative};
use super::tables::{BasisAt, CellTable};
use crate::assemble::cut_simplices::{CutRule, Visit};
use crate::assemble::stiffness::Local;
use crate::element::Element;
use crate::error::Error;
use crate::mesh::{BoundaryFacet, HalfFacet, Mesh};
use crate::problem::{DataByGroup, DataOnMesh, Datum, Robin};
use crate::quadrature::{Rule, facet_to_cell};
use crate::real::Point;

/// The reaction term, with the rule that integrates it.
pub(crate) struct ReactionTerm<const D: usize> {
    data: DataByGroup<D>,
    table: CellTable,
    /// Where a datum has a level: the rule on cells that its zero set cuts.
    cut: Option<CutRule>,
    element: Arc<dyn Element<D>>,
    n: usize,
    /// The facets of Robin sides, by cell and number in the cell.
    sides: Vec<(HalfFacet, Robin<D>)>,
    /// The rule on them.
    facet_rule: Rule,
}

impl<const D: usize> ReactionTerm<D> {
    /// The term of data with the basis of an element at the points of a rule. A rule at vertices alone,
    /// which lumps the term, is used on cells that are cut too.
    pub fn new(
        (data, mesh): (&DataOnMesh<D>, &Mesh<D>),
        (rule, facet_rule): (Rule, Rule),
        degree: usize,
        element: Arc<dyn Element<D>>,
    ) -> Self {
        let is_lumped = rule.points.iter().all(|point| point.contains(&1.0));
        let data_of_sides = |f: &BoundaryFacet| {
            let side = data.robin.of(usize::from(f.group)).cloned()?;
            Some(((f.cell as usize, usize::from(f.local)), side))
        };
        let sides = mesh.boundary().iter().filter_map(data_of_sides).collect();
        let data = data.reaction.clone();
        let has_level = data.any(&|datum| datum.level().is_some());
        let cut = (has_level && !is_lumped).then(|| CutRule::new(D, degree));
        let (table, n) = (CellTable::new(rule, &*element), element.per_cell());
        Self { data, table, cut, n, element, sides, facet_rule }
    }
    /// Adds `(c phi_j, phi_i)` over a cell, and `(k phi_j, phi_i)` over its facets on Robin sides.
    pub fn add(&self, mesh: &Mesh<D>, cell: usize, volume: f64, out: &mut Local) {
        let mut add = |c: f64, weight: f64, basis: &BasisAt| {
            let scale = c * weight;
            for i in 0..self.n {
                for j in 0..self.n {
                    out[i][j] += scale * basis.values[i] * basis.values[j];
                }
            }
        };
        self.visit_sides(mesh, cell, &mut |point, _, weight| {
            add(weight, 1.0, &BasisAt::new(&*self.element, point));
        });
        let Some(datum) = self.data.of(mesh.region(cell)) else { return };
        let mut add = |c: f64, weight: f64, basis: &BasisAt| add(c * volume, weight, basis);
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
    /// The facets of Robin sides with their data.
    pub fn sides(&self) -> &[(HalfFacet, Robin<D>)] {
        &self.sides
    }
    /// Visits the points of the rule on the facets of a cell on Robin sides: in barycentric coordinates of the cell, in
    /// space, and with weight, measure and coefficient multiplied.
    pub fn visit_sides(&self, mesh: &Mesh<D>, cell: usize, visit: Visit<'_, D>) {
        let first = self.sides.partition_point(|((of, _), _)| *of < cell);
        for ((_, local), side) in self.sides[first..].iter().take_while(|((of, _), _)| *of == cell)
        {
            let measure = mesh.geometry(cell).facet_measure(*local);
            for (point, weight) in self.facet_rule.iter() {
                let point = facet_to_cell(point, *local);
                let x = mesh.point(cell, &point[..=D]);
                visit(&point, &x, weight * measure * side.coefficient.in_cell(mesh, cell, &x));
            }
        }
    }
    /// Refuses a coefficient of a Robin side that is negative or not finite at a point of the rule.
    pub fn check_sides(&self, mesh: &Mesh<D>) -> Result<(), Error> {
        for ((cell, local), side) in &self.sides {
            for (point, _) in self.facet_rule.iter() {
                let x = mesh.point(*cell, &facet_to_cell(point, *local)[..=D]);
                let datum = "coefficient of the Robin side";
                not_negative(side.coefficient.in_cell(mesh, *cell, &x), datum, &x, *cell)?;
            }
        }
        Ok(())
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

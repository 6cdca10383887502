//! Squares of errors of linear functions in cells with constant data.

use super::Measure;
use super::cubic::Cubic;
use super::integrand::{CellIntegrand, LocalFunction};
use crate::arrays::{array_of, map_entries};
use crate::assemble::space::Space;
use crate::element::{Entity, Node};
use crate::measure::evaluation::Reference;
use crate::measure::squared_errors::Squares;
use crate::parallel::vectors::collect;
use crate::real::Point;

impl<const D: usize> Space<'_, D> {
    /// The values of an exact solution at the vertices of the mesh, if these are all nodes or with gradients.
    pub(super) fn exact_at_vertices(
        &self,
        exact: &Reference<'_, D>,
        with_gradients: bool,
    ) -> Option<Vec<(f64, Point<D>)>> {
        let Reference::Exact(exact) = exact else { return None };
        let is_vertex = |node: &Node| matches!(node.entity(), Entity::Vertex(_));
        let vertices = self.mesh.vertices();
        let at = |x: &Point<D>| {
            let gradient = if with_gradients { (exact.gradient)(x) } else { Point::zeros() };
            (exact.value.at(x), gradient)
        };
        let is_known = with_gradients || self.nodes.iter().all(is_vertex);
        is_known.then(|| collect(vertices.len(), |v| at(&vertices[v])))
    }

    /// The squares of a cell where both functions are linear and data are constant, with the share that is not smooth;
    /// none elsewhere, and where the exact solution is not finite at a vertex or at the barycentre.
    pub(super) fn squares_of_linear(
        &self,
        of: &Measure<'_, '_, '_, D>,
        integrand: &CellIntegrand<'_, D>,
        corners: &[Point<D>; 4],
    ) -> Option<(f64, Squares)> {
        let (basis, at_vertices) = of.linear.as_ref().zip(of.at_vertices.as_ref())?;
        let coefficient = integrand.coefficient.map_or(Some(1.0), |datum| datum.constant())?;
        let reaction = integrand.reaction.map_or(Some(0.0), |datum| datum.constant())?;
        let admissible = integrand.admissible.as_ref();
        if !admissible.is_none_or(|function| function.is_linear(corners)) {
            return None;
        }
        let (mut values, mut gradients) = ([0.0; 4], [Point::zeros(); 4]);
        for (k, &v) in self.mesh.cell(integrand.cell).iter().enumerate() {
            (values[k], gradients[k]) = at_vertices[v as usize];
        }
        let middle = corners[..=D].iter().sum::<Point<D>>() / (D + 1) as f64;
        let gradient = match D {
            3 => of.exact.gradient(integrand.cell, &middle),
            _ => Point::zeros(),
        };
        let at_middle = (of.exact.value(integrand.cell, &middle), gradient);
        let cubic = Cubic::new(corners, &integrand.gradients, (&values, &gradients), at_middle);
        let squares_of = |at: &dyn Fn(usize) -> f64, slope: Point<D>| {
            let differences = array_of(|k| if k <= D { at(k) - values[k] } else { 0.0 });
            cubic.squares(&differences, &map_entries(gradients, |gradient| slope - gradient))
        };
        let (mut squares, mut rough) = (Squares::default(), 0.0_f64);
        if let Some(LocalFunction { values, slope, .. }) = &integrand.discrete {
            let at = |k: usize| basis[k].value(values);
            let ([of_value, of_gradient], share) = squares_of(&at, (*slope)?);
            let energy = integrand.alpha * of_gradient + reaction * of_value;
            squares[..3].copy_from_slice(&[of_value, of_gradient, energy]);
            rough = share;
        }
        if let Some(function) = admissible {
            let at = |k: usize| function.values[k];
            let ([of_value, of_gradient], share) = squares_of(&at, function.gradient);
            squares[3] = coefficient * of_gradient + reaction * of_value;
            rough = rough.max(share);
        }
        squares.iter_mut().for_each(|square| *square *= integrand.volume);
        squares.iter().all(|square| square.is_finite()).then_some((rough, squares))
    }
}

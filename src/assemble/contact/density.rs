//! The multiplier as a density at vertices.

use super::Carrier;
use super::pieces::{Piece, in_space};
use crate::algebra::{Contact, Inequality};
use crate::assemble::data;
use crate::assemble::space::Space;
use crate::error::Error;
use crate::mesh::BoundaryPart;
use crate::problem::{ContactSet, Field};
use crate::quadrature::Rule;
use crate::real::Real;
use crate::solve::Solution;

/// Degree of the rule on a simplex that the free boundary does not cut, and on the pieces of one
/// that it does.
const DEGREES: [usize; 2] = [5, 2];

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The lumped L2 norm of the error of the density; none if no vertex is far enough from the
    /// free boundary.
    pub(super) fn multiplier_error(
        &self,
        multiplier: &Field<D>,
        set: Option<&ContactSet<D>>,
        carriers: &[Carrier],
        inequality: &Inequality<T>,
        solution: &Solution<T>,
    ) -> Result<Option<f64>, Error> {
        let mut weights = vec![0.0; self.mesh.vertices().len()];
        let mut forces = self.vertex_forces(inequality, solution);
        for &carrier in carriers {
            self.subtract_exact(multiplier, set, carrier, &mut weights, &mut forces)?;
        }
        let skipped = self.near_jumps(set, carriers);
        let counted = |v: &usize| weights[*v] > 0.0 && !skipped[*v];
        if std::env::var("CANDIDATES").is_ok() {
            let dirichlet = self.near_jumps(None, carriers);
            let n = |keep: &dyn Fn(usize) -> bool, p: i32| -> f64 {
                (0..weights.len())
                    .filter(|&v| weights[v] > 0.0 && keep(v))
                    .map(|v| weights[v] * (forces[v] / weights[v]).abs().powi(p))
                    .sum()
            };
            let all = |v: usize| !dirichlet[v];
            eprintln!(
                "candidates: L1 all {:.4e} L2 all {:.4e} L2 off {:.4e} L1 off {:.4e}",
                n(&all, 1),
                n(&all, 2).sqrt(),
                n(&|v| !skipped[v], 2).sqrt(),
                n(&|v| !skipped[v], 1)
            );
        }
        if !(0..weights.len()).any(|v| counted(&v)) {
            return Ok(None);
        }
        let squares = (0..weights.len()).filter(counted).map(|v| forces[v] * forces[v] / weights[v]);
        Ok(Some(squares.sum::<f64>().sqrt()))
    }

    /// The force of all constrained unknowns in contact, shared by the vertices around them.
    fn vertex_forces(&self, inequality: &Inequality<T>, solution: &Solution<T>) -> Vec<f64> {
        let mut deficit = vec![0.0; inequality.size()];
        inequality.matrix.residual_f64(&inequality.load, &solution.values, &mut deficit);
        let mut forces = vec![0.0; self.mesh.vertices().len()];
        for (unknown, &deficit) in deficit.iter().enumerate() {
            let touches = solution.contact[unknown] != Contact::Open;
            if touches && inequality.bounds[unknown].is_inequality() {
                let around = inequality.places[unknown].vertices();
                let share = -deficit / around.len() as f64;
                around.iter().for_each(|&v| forces[v as usize] += share);
            }
        }
        forces
    }

    /// Subtracts the exact multiplier tested with the hat functions of a carrier, and adds their
    /// integrals to the weights.
    fn subtract_exact(
        &self,
        multiplier: &Field<D>,
        set: Option<&ContactSet<D>>,
        carrier: Carrier,
        weights: &mut [f64],
        forces: &mut [f64],
    ) -> Result<(), Error> {
        let dimension = carrier.dimension::<D>();
        let rules = DEGREES.map(|degree| Rule::of_degree(dimension, degree));
        let corners = self.corner_points(carrier);
        let mut tested = [0.0; 4];
        let mut failure = None;
        let mut add = |piece: &Piece| {
            for (point, weight) in rules[usize::from(!piece.is_whole())].iter() {
                let hats = piece.point(point);
                let x = in_space(&hats, &corners);
                match data::finite(multiplier(&x), "exact multiplier", &x, carrier.cell) {
                    Ok(density) => tested
                        .iter_mut()
                        .zip(hats)
                        .for_each(|(sum, hat)| *sum += weight * piece.share * density * hat),
                    Err(why) => failure = Some(why),
                }
            }
        };
        match set {
            Some(set) => Piece::whole(dimension).split(&corners, &set.indicator, &mut add),
            None => add(&Piece::whole(dimension)),
        }
        if let Some(why) = failure {
            return Err(why);
        }
        let measure = self.measure_of(carrier);
        for (k, local) in carrier.corners::<D>().enumerate() {
            let vertex = self.mesh.cell(carrier.cell)[local] as usize;
            weights[vertex] += measure / (dimension + 1) as f64;
            forces[vertex] -= measure * tested[k];
        }
        Ok(())
    }

    /// The vertices on the Dirichlet part and those of two layers of carriers around the exact free
    /// boundary.
    fn near_jumps(&self, set: Option<&ContactSet<D>>, carriers: &[Carrier]) -> Vec<bool> {
        let vertex = |carrier: &Carrier, k: usize| self.mesh.cell(carrier.cell)[k] as usize;
        let mut near = vec![false; self.mesh.vertices().len()];
        if let Some(set) = set {
            let is_cut = |carrier: &Carrier| {
                let corners = self.corner_points(*carrier);
                Piece::whole(carrier.dimension::<D>()).is_cut(&corners, &set.indicator)
            };
            let mut layer: Vec<bool> = carriers.iter().map(is_cut).collect();
            for _ in 0..LAYERS {
                let within = carriers.iter().zip(&layer).filter(|(_, within)| **within);
                for (carrier, _) in within {
                    carrier.corners::<D>().for_each(|k| near[vertex(carrier, k)] = true);
                }
                let touches = |c: &Carrier| c.corners::<D>().any(|k| near[vertex(c, k)]);
                layer = carriers.iter().map(touches).collect();
            }
        }
        for (cell, local) in self.facets_of(BoundaryPart::Dirichlet) {
            self.mesh.facet_vertices(cell, local).for_each(|v| near[v as usize] = true);
        }
        near
    }
}

/// Layers of cells around the free boundary in which densities are not compared.
const LAYERS: usize = 2;

//! The multiplier as a density at vertices.

use super::Carrier;
use super::clipped_simplices::{Piece, in_space};
use crate::algebra::{Contact, Inequality};
use crate::assemble::space::{Space, data};
use crate::error::Error;
use crate::inequality::Solution;
use crate::problem::{ContactSet, Field};
use crate::quadrature::Rule;
use crate::real::Real;

/// Degree of the rule on a simplex that the free boundary does not cut, and on the pieces of one
/// that it does.
const DEGREES: [usize; 2] = [5, 2];

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The errors of the density in L1 and lumped L2; none if no vertex counts.
    pub(super) fn multiplier_errors(
        &self,
        multiplier: &Field<D>,
        set: Option<&ContactSet<D>>,
        carriers: &[Carrier],
        inequality: &Inequality<T>,
        solution: &Solution<T>,
    ) -> Result<Option<[f64; 2]>, Error> {
        let mut weights = vec![0.0; self.mesh.vertices().len()];
        let mut forces = self.vertex_forces(inequality, solution);
        // for facets and for cells
        let rules = [D - 1, D].map(|d| DEGREES.map(|degree| Rule::new(d, degree)));
        for &carrier in carriers {
            let rules = &rules[usize::from(carrier.dimension::<D>() == D)];
            self.subtract_exact((multiplier, set), carrier, rules, &mut weights, &mut forces)?;
        }
        let given = self.on_dirichlet_part();
        let counted = |v: &usize| weights[*v] > 0.0 && !given[*v];
        let vertices = || (0..weights.len()).filter(counted);
        let squares: f64 = vertices().map(|v| forces[v] * forces[v] / weights[v]).sum();
        let sum: f64 = vertices().map(|v| forces[v].abs()).sum();
        Ok(vertices().next().map(|_| [sum, squares.sqrt()]))
    }

    /// The force of all constrained unknowns in contact, shared by the vertices around them.
    pub(crate) fn vertex_forces(
        &self,
        inequality: &Inequality<T>,
        solution: &Solution<T>,
    ) -> Vec<f64> {
        let mut deficit = vec![0.0; inequality.size()];
        inequality.residual_f64(&solution.values, &mut deficit);
        let mut forces = vec![0.0; self.mesh.vertices().len()];
        for (unknown, &deficit) in deficit.iter().enumerate() {
            let touches = solution.contact[unknown] != Contact::Inactive;
            if touches && inequality.bounds[unknown].is_inequality() {
                let around = inequality.supports[unknown].vertices();
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
        (multiplier, set): (&Field<D>, Option<&ContactSet<D>>),
        carrier: Carrier,
        rules: &[Rule; 2],
        weights: &mut [f64],
        forces: &mut [f64],
    ) -> Result<(), Error> {
        let dimension = carrier.dimension::<D>();
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
}

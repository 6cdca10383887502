//! Solution, obstacle, multiplier and contact set on cells, for pictures.

use super::contact::DiscreteContact;
use crate::algebra::{Contact, Inequality};
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::inequality::Solution;
use crate::instances::compiled;
use crate::mesh::{BoundaryPart, edge_vertices};
use crate::real::{Real, point_f64};

/// Fields on the cells of the mesh, for pictures.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Fields {
    /// The solution at the vertices of each cell.
    pub u: Vec<f64>,
    /// The obstacle at the vertices of each cell.
    pub obstacle: Option<Vec<f64>>,
    /// Density of the multiplier in each cell: nodal multipliers over the volume for an obstacle,
    /// over the measure of the contact boundary for Signorini.
    pub multiplier: Vec<f64>,
    /// Share of each cell's constrained unknowns in contact.
    pub contact: Vec<f64>,
    /// A solution that is not linear on cells, at the midpoints of each cell's edges; empty for a
    /// linear one.
    pub midpoints: Vec<f64>,
    /// The discrete contact set, and the multiplier's density at vertices.
    pub discrete_contact: DiscreteContact,
}

impl<T: Real, const D: usize> Discretisation<'_, T, D> {
    /// Solution, obstacle, multiplier and contact set on cells, for pictures.
    ///
    /// A nodal multiplier over the measure that belongs to its unknown is a density, of volume for
    /// obstacles and of the contact boundary for Signorini. A cell shows the mean over its unknowns
    /// that have such a measure.
    pub fn fields(&self, inequality: &Inequality<T>, solution: &Solution<T>) -> Fields {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>, &Inequality<T>, &Solution<T>) -> Fields
                = |of, inequality, solution| of.space.fields(inequality, solution)
        )(self, inequality, solution)
    }
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// Fields of a solution; see `Discretisation::fields`.
    pub fn fields(&self, inequality: &Inequality<T>, solution: &Solution<T>) -> Fields {
        let u = &solution.values;
        let corner = |&v: &u32| point_f64(&self.mesh.vertices()[v as usize]);
        let obstacle = |cell: usize| {
            let region = self.mesh.region(cell);
            let psi = self.data.lower.of(region).or(self.data.upper.of(region));
            let at = move |v| psi.map_or(f64::NAN, |psi| psi.at(&corner(v)));
            self.mesh.cell(cell).iter().map(at)
        };
        let measures = self.constrained_measures();
        let n_cells = self.mesh.n_cells();
        let mut multiplier = Vec::with_capacity(n_cells);
        let mut contact = Vec::with_capacity(n_cells);
        for cell in 0..n_cells {
            let (mut density, mut with_measure, mut constrained, mut touching) = (0.0, 0, 0, 0);
            for i in 0..self.per_cell() {
                let k = self.dofs.of(cell, i);
                if measures[k] > 0.0 && inequality.bounds[k].is_inequality() {
                    let residual = inequality.matrix.row_dot(k, u) - inequality.load[k];
                    let in_contact = solution.contact[k] != Contact::Inactive;
                    if in_contact {
                        density += residual.to_f64() / measures[k];
                    }
                    with_measure += 1;
                    constrained += 1;
                    touching += usize::from(in_contact);
                }
            }
            multiplier.push(density / f64::from(with_measure.max(1)));
            contact.push(touching as f64 / f64::from(constrained.max(1)));
        }
        Fields {
            u: self.vertex_values(u),
            obstacle: self
                .problem
                .has_obstacle()
                .then(|| (0..n_cells).flat_map(obstacle).collect()),
            multiplier,
            contact,
            midpoints: self.midpoint_values(u),
            discrete_contact: self.discrete_contact(inequality, solution),
        }
    }

    /// The values of a function that is not linear on cells at the midpoints of each cell's edges, in
    /// the order of [`edge_vertices`]; none for a linear one, which its vertex values determine.
    fn midpoint_values(&self, u: &[T]) -> Vec<f64> {
        if self.basis_degree < 2 {
            return Vec::new();
        }
        let middle = |&[i, j]: &[usize; 2]| {
            let mut point = [0.0; 4];
            (point[i], point[j]) = (0.5, 0.5);
            self.basis_at(&point)
        };
        let midpoints: Vec<_> = edge_vertices(D).iter().map(middle).collect();
        let of_cell = |cell| {
            let local = self.local_values(cell, u);
            midpoints.iter().map(move |basis| basis.value(&local))
        };
        (0..self.mesh.n_cells()).flat_map(of_cell).collect()
    }

    /// The measure of domain or contact boundary that belongs to each unknown of the constraint
    /// set.
    fn constrained_measures(&self) -> Vec<f64> {
        let mut measures = vec![0.0; self.dofs.size()];
        if self.problem.has_obstacle() {
            for cell in 0..self.mesh.n_cells() {
                let volume = self.mesh.geometry(cell).volume.to_f64();
                let share = volume / self.bounded_nodes().count() as f64;
                for (i, _) in self.bounded_nodes() {
                    measures[self.dofs.of(cell, i)] += share;
                }
            }
        } else if self.problem.has_gap() {
            for (cell, local) in self.facets_of(BoundaryPart::Contact) {
                let measure = self.mesh.geometry(cell).facet_measure(local).to_f64();
                let share = measure / self.bounded_nodes_on(local).count() as f64;
                for (i, _) in self.bounded_nodes_on(local) {
                    measures[self.dofs.of(cell, i)] += share;
                }
            }
        }
        measures
    }
}

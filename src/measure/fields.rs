//! Solution, obstacle, multiplier and contact set on cells, for pictures.

use super::contact::DiscreteContact;
use crate::algebra::{Contact, Inequality};
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::inequality::Solution;
use crate::instances::compiled;
use crate::mesh::{BoundaryPart, edge_vertices};
use crate::quadrature::facet_to_cell;
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
    /// The facets of the contact boundary: cell, and number in the cell.
    pub contact_boundary: Vec<(usize, usize)>,
    /// The contact pressure on each of these facets: the mean over the vertices of the facet of the nodal
    /// multipliers, gathered at vertices, over the integrals of hat functions. Its integral over the
    /// contact boundary is the sum of the multipliers, the total contact force.
    pub pressure: Vec<f64>,
    /// The gap that is left on each of these facets: the mean of `u - g`.
    pub gap: Vec<f64>,
}

impl Fields {
    /// The values of the solution cell by cell: at the vertices, then at the midpoints of the edges unless
    /// the solution is linear. An element of higher degree is interpolated in degree two.
    #[cfg(feature = "report")]
    pub(crate) fn values_by_cell(&self, dimension: usize) -> Vec<f64> {
        let n_edges = dimension * (dimension + 1) / 2;
        let mut midpoints = self.midpoints.chunks_exact(n_edges);
        let of_cell = |corners: &[f64]| [corners, midpoints.next().unwrap_or_default()].concat();
        self.u.chunks_exact(dimension + 1).flat_map(of_cell).collect()
    }
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
        let contact_boundary: Vec<(usize, usize)> = match self.problem.has_gap() {
            true => self.facets_of(BoundaryPart::Contact).collect(),
            false => Vec::new(),
        };
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
            pressure: self.contact_pressure(&contact_boundary, inequality, solution),
            gap: contact_boundary.iter().map(|&place| self.mean_gap(place, u)).collect(),
            contact_boundary,
        }
    }

    /// The contact pressure on facets; see [`Fields::pressure`].
    fn contact_pressure(
        &self,
        facets: &[(usize, usize)],
        inequality: &Inequality<T>,
        solution: &Solution<T>,
    ) -> Vec<f64> {
        let mut bound = vec![false; self.dofs.size()];
        let mut hats = vec![0.0; self.mesh.vertices().len()];
        for &(cell, local) in facets {
            self.bounded_nodes_on(local).for_each(|(i, _)| bound[self.dofs.of(cell, i)] = true);
            let share = self.mesh.geometry(cell).facet_measure(local).to_f64() / D as f64;
            self.mesh.facet_vertices(cell, local).for_each(|v| hats[v as usize] += share);
        }
        let multipliers = match facets {
            [] => Vec::new(),
            _ => self.vertex_multipliers(inequality, solution, |unknown| bound[unknown]),
        };
        let density = |v: u32| multipliers[v as usize] / hats[v as usize];
        let mean = |&(cell, local): &(usize, usize)| {
            self.mesh.facet_vertices(cell, local).map(density).sum::<f64>() / D as f64
        };
        facets.iter().map(mean).collect()
    }

    /// The mean of `u - g` over a facet.
    fn mean_gap(&self, (cell, local): (usize, usize), u: &[T]) -> f64 {
        let values = self.local_values(cell, u);
        let group = self.mesh.boundary_group(cell, local);
        let gap = group.and_then(|group| self.data.gap.of(group));
        let at = |point: &[f64; 4]| {
            let gap = gap.map_or(0.0, |gap| gap.at(&self.facet_point(point, cell, local)));
            self.basis_at(&facet_to_cell(point, local)).value(&values) - gap
        };
        self.facet_rule.iter().map(|(point, weight)| weight * at(point)).sum()
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

//! Solution, obstacle, multiplier and contact set on cells, for pictures.

use super::contact::{DiscreteContact, SolvedInequality};
use super::penetration::middle;
use crate::algebra::{Contact, Inequality};
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::inequality::Solution;
use crate::instances::compiled;
use crate::mesh::{HalfFacet, edge_vertices};
use crate::quadrature::facet_to_cell;

/// Fields on the cells of the mesh, for pictures.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Fields {
    /// The solution at the vertices of each cell.
    pub u: Vec<f64>,
    /// Density of an obstacle's multiplier in each cell: the mean over the vertices of the cell of the
    /// nodal multipliers of the unknowns to which the obstacle of its region gives the active bound, gathered at
    /// vertices, over the integrals of hat functions. Its integral over the domain is the sum of these multipliers.
    /// Not a number where rounding leaves no digit; empty without an obstacle.
    pub multiplier: Vec<f64>,
    /// Share of each cell's constrained unknowns in contact.
    pub contact: Vec<f64>,
    /// A solution that is not linear on cells, at the midpoints of each cell's edges; empty for a
    /// linear one.
    pub midpoints: Vec<f64>,
    /// The discrete contact set.
    pub discrete_contact: DiscreteContact,
    /// The facets of the contact boundary and those with friction: cell, and number in the cell.
    pub contact_boundary: Vec<HalfFacet>,
    /// The contact pressure on each of these facets: as `multiplier`, of the unknowns to which the gap of its boundary
    /// group gives the active bound, or of friction. Its integral over a group is the force there.
    pub pressure: Vec<f64>,
    /// The gap that is left on each of these facets: the mean of `u - g`, of `u` with friction.
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

impl<const D: usize> Discretisation<'_, D> {
    /// Solution, multiplier and contact set on cells, for pictures.
    pub fn fields(&self, inequality: &Inequality<f64>, solution: &Solution<f64>) -> Fields {
        self.demand_length(&solution.values);
        compiled!(const D: fn(&Discretisation<'_, D>, &Inequality<f64>, &Solution<f64>) -> Fields
                = |of, inequality, solution| of.space.fields((inequality, solution))
        )(self, inequality, solution)
    }
}

impl<const D: usize> Space<'_, D> {
    /// Fields of a solution; see `Discretisation::fields`.
    fn fields(&self, solved: SolvedInequality<'_>) -> Fields {
        let (inequality, solution) = solved;
        let u = &solution.values;
        let share = |cell| {
            let unknowns = (0..self.per_cell()).map(|i| self.dofs.of(cell, i));
            let constrained = unknowns.filter(|&k| inequality.bounds[k].is_inequality());
            let (mut all, mut touching) = (0, 0);
            for k in constrained {
                all += 1;
                touching += usize::from(solution.contact[k] != Contact::Inactive);
            }
            touching as f64 / f64::from(all.max(1))
        };
        let n_cells = self.mesh.n_cells();
        let contact_boundary: Vec<HalfFacet> = match self.problem.acts_on_boundary() {
            true => self.facets_of_forces().map(|(facet, _)| facet).collect(),
            false => Vec::new(),
        };
        let multipliers = self.problem.is_constrained().then(|| self.multipliers(solved)).flatten();
        let of_obstacles = multipliers.as_ref().filter(|_| self.problem.has_obstacle());
        let on_boundary = multipliers.as_ref().filter(|_| self.problem.acts_on_boundary());
        Fields {
            u: self.vertex_values(u),
            multiplier: match of_obstacles {
                Some(of) => self.densities_of_obstacles(inequality, of),
                None if self.problem.has_obstacle() => vec![f64::NAN; n_cells],
                None => Vec::new(),
            },
            contact: (0..n_cells).map(share).collect(),
            midpoints: self.midpoint_values(u),
            discrete_contact: self.discrete_contact(solved),
            pressure: match on_boundary {
                Some(of) => self.densities_on_boundary(inequality, of),
                None => vec![f64::NAN; contact_boundary.len()],
            },
            gap: contact_boundary.iter().map(|&facet| self.mean_gap(facet, u)).collect(),
            contact_boundary,
        }
    }

    /// The mean of `u - g` over a facet.
    fn mean_gap(&self, (cell, local): HalfFacet, u: &[f64]) -> f64 {
        let values = self.local_values(cell, u);
        let group = self.mesh.boundary_group(cell, local);
        let gap = group.and_then(|group| self.data.gap.of(group));
        let constant = self.body_constants.of_cell(cell);
        let at = |point: &[f64; 4]| {
            let x = self.facet_point(point, cell, local);
            let gap = gap.map_or(-constant, |gap| self.at(gap, cell, &x));
            self.basis_at(&facet_to_cell(point, local)).value(&values) - gap
        };
        self.facet_rule.iter().map(|(point, weight)| weight * at(point)).sum()
    }

    /// The values of a function that is not linear on cells at the midpoints of each cell's edges, in
    /// the order of [`edge_vertices`]; none for a linear one, which its vertex values determine.
    fn midpoint_values(&self, u: &[f64]) -> Vec<f64> {
        if self.basis_degree < 2 {
            return Vec::new();
        }
        let at_middle = |ends: &[usize; 2]| self.basis_at(&middle(*ends));
        let midpoints: Vec<_> = edge_vertices(D).iter().map(at_middle).collect();
        let mut values = Vec::with_capacity(self.mesh.n_cells() * midpoints.len());
        for cell in 0..self.mesh.n_cells() {
            let local = self.local_values(cell, u);
            let constant = self.body_constants.of_cell(cell);
            values.extend(midpoints.iter().map(|basis| basis.value(&local) + constant));
        }
        values
    }
}

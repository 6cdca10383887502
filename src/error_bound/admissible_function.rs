//! The admissible function of a discrete solution.

use super::PrimalDualPair;
use super::flux::Flux;
use crate::algebra::{Bound, Contact};
use crate::arrays::map_entries;
use crate::assemble::space::Space;
use crate::assemble::space::tables::BasisAt;
use crate::element::Node;
use crate::mesh::{BoundaryCondition, Edges, HalfFacet, edge_vertices};
use crate::problem::Datum;
use crate::real::Point;

/// The nodes of the admissible function: the vertices of the mesh and, for quadratics, after them the
/// midpoints of its edges.
struct FunctionNodes<'m> {
    n_vertices: usize,
    n_edges: usize,
    /// By cell the numbers of its edges; empty for linears.
    edges: &'m [u32],
}

/// A node of the function of a pair: two vertices of a cell, whose midpoint the node is, and the number of the node. For a
/// node at a vertex the two are equal.
pub(super) type PairNode = ([usize; 2], usize);

impl FunctionNodes<'_> {
    /// The edges of a cell that have a node: their two vertices in the cell and the number of the node.
    fn of_edges(
        &self,
        dimension: usize,
        cell: usize,
    ) -> impl Iterator<Item = (&'static [usize; 2], usize)> {
        let pairs = edge_vertices(dimension);
        let edges = self.edges.get(cell * pairs.len()..).unwrap_or_default();
        pairs.iter().zip(edges).map(|(pair, &edge)| (pair, self.n_vertices + edge as usize))
    }
}

impl<const D: usize> Space<'_, D> {
    /// The nodes of the function of a pair in a cell.
    pub(super) fn pair_nodes(
        &self,
        pair: &PrimalDualPair<D>,
        cell: usize,
    ) -> impl Iterator<Item = PairNode> {
        let n_vertices = self.mesh.vertices().len();
        let nodes = FunctionNodes { n_vertices, n_edges: 0, edges: &pair.edges };
        let vertices = self.mesh.cell(cell).iter().enumerate();
        let of_edges: Vec<_> = nodes.of_edges(D, cell).map(|(ends, node)| (*ends, node)).collect();
        vertices.map(|(k, &v)| ([k; 2], v as usize)).chain(of_edges)
    }

    /// The nodes of the function of a pair on a facet.
    pub(super) fn pair_nodes_on(
        &self,
        pair: &PrimalDualPair<D>,
        (cell, local): HalfFacet,
    ) -> impl Iterator<Item = PairNode> {
        self.pair_nodes(pair, cell).filter(move |(ends, _)| !ends.contains(&local))
    }

    /// The admissible function of a discrete function: of the same degree, without a flux. At nodes all of whose cells
    /// are in contact with an obstacle it has the least value that the constraints allow: at vertices that of the
    /// obstacle, at midpoints that with its Bernstein coefficient.
    pub(super) fn admissible_function(
        &self,
        u: &[f64],
        states: (&[Bound<f64>], &[Contact]),
    ) -> PrimalDualPair<D> {
        let degree = self.degree;
        let (n_edges, edges) = match degree {
            1 => (0, Vec::new()),
            _ => {
                let (edges, numbers) = Edges::with_cell_edges(self.mesh);
                (edges.len(), numbers)
            }
        };
        let n_vertices = self.mesh.vertices().len();
        let nodes = FunctionNodes { n_vertices, n_edges, edges: &edges };
        let mut function = self.means(u, &nodes);
        if let Some(states) = self.states_of_nodes(states, &nodes) {
            for (value, state) in function.iter_mut().zip(states) {
                // a value beyond all bounds becomes that of the obstacle
                *value = match state {
                    Contact::Inactive => *value,
                    Contact::Lower => f64::NEG_INFINITY,
                    Contact::Upper => f64::INFINITY,
                };
            }
        }
        self.clip_at_vertices(&mut function[..n_vertices]);
        if n_edges > 0 {
            self.clip_at_midpoints(&nodes, &mut function);
        }
        PrimalDualPair { degree, function, edges, flux: Flux::zero(degree - 1, 0) }
    }

    /// For each node the obstacle that all unknowns of all cells around touch, where these are no values at the nodes.
    /// An unknown whose basis function has no positive mean does not count.
    fn states_of_nodes(
        &self,
        (bounds, contact): (&[Bound<f64>], &[Contact]),
        nodes: &FunctionNodes<'_>,
    ) -> Option<Vec<Contact>> {
        let has_means = self.nodes.iter().any(|node| node.point().is_none());
        if !has_means || !self.problem.has_obstacle() || contact.len() != bounds.len() {
            return None;
        }
        let decides = self.unknowns_with_positive_mean();
        let mut states: Vec<Option<Contact>> = vec![None; nodes.n_vertices + nodes.n_edges];
        for cell in 0..self.mesh.n_cells() {
            let mut of_unknowns = decides
                .iter()
                .map(|&i| self.dofs.of(cell, i))
                .filter(|&unknown| bounds[unknown].is_inequality())
                .map(|unknown| contact[unknown]);
            let first = of_unknowns.next().unwrap_or_default();
            let obstacle = match first {
                Contact::Inactive => None,
                Contact::Lower => self.data.lower.of(self.mesh.region(cell)),
                Contact::Upper => self.data.upper.of(self.mesh.region(cell)),
            };
            let touches = obstacle.is_some() && of_unknowns.all(|state| state == first);
            let state = if touches { first } else { Contact::Inactive };
            let vertices = self.mesh.cell(cell).iter().map(|&v| v as usize);
            for node in vertices.chain(nodes.of_edges(D, cell).map(|(_, node)| node)) {
                let merged = states[node].is_none_or(|before| before == state);
                states[node] = Some(if merged { state } else { Contact::Inactive });
            }
        }
        Some(states.into_iter().map(Option::unwrap_or_default).collect())
    }

    /// At each node the mean of the values in the cells around, with the coefficient as weights.
    fn means(&self, u: &[f64], nodes: &FunctionNodes<'_>) -> Vec<f64> {
        if self.is_conforming_linear() && nodes.n_edges == 0 {
            return u.to_vec();
        }
        let midpoints = if nodes.n_edges > 0 { edge_vertices(D).len() } else { 0 };
        let basis: Vec<BasisAt> = (0..D + 1)
            .map(Node::vertex)
            .chain((0..midpoints).map(Node::midpoint))
            .map(|node| self.basis_at(&node.centre(D)))
            .collect();
        let n = self.per_cell();
        let mut sums = vec![(0.0, 0.0); nodes.n_vertices + nodes.n_edges];
        for cell in 0..self.mesh.n_cells() {
            let (alpha, local) = (self.alpha(cell), self.local_values(cell, u));
            let vertices = self.mesh.cell(cell).iter().map(|&v| v as usize);
            let all = vertices.chain(nodes.of_edges(D, cell).map(|(_, node)| node));
            for (node, basis) in all.zip(&basis) {
                let (sum, weight) = &mut sums[node];
                let value: f64 = (0..n).map(|i| local[i] * basis.values[i]).sum();
                *sum += alpha * value;
                *weight += alpha;
            }
        }
        sums.into_iter().map(|(sum, weight)| sum / weight).collect()
    }

    /// Sets values at vertices to Dirichlet data, and moves the others into the constraints.
    fn clip_at_vertices(&self, values: &mut [f64]) {
        let mut bounds = vec![(f64::NEG_INFINITY, f64::INFINITY); values.len()];
        let mut add = |v: usize, cell: usize| {
            let region = self.mesh.region(cell);
            let x = self.mesh.vertices()[v];
            let (low, high) = &mut bounds[v];
            *low = self.data.lower.of(region).map_or(*low, |psi| self.at(psi, cell, &x).max(*low));
            *high =
                self.data.upper.of(region).map_or(*high, |psi| self.at(psi, cell, &x).min(*high));
        };
        if self.data.obstacles_differ() {
            for cell in 0..self.mesh.n_cells() {
                self.mesh.cell(cell).iter().for_each(|&v| add(v as usize, cell));
            }
        } else if self.problem.has_obstacle() {
            (0..values.len()).for_each(|v| add(v, 0));
        }
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            let Some(gap) = self.data.gap.of(group) else { continue };
            for v in self.mesh.facet_vertices(cell, local) {
                let x = self.mesh.vertices()[v as usize];
                let low = &mut bounds[v as usize].0;
                *low = low.max(self.at(gap, cell, &x));
            }
        }
        let groups = self.dirichlet_groups();
        for (v, value) in values.iter_mut().enumerate() {
            *value = match groups[v] {
                Some(group) => self.dirichlet_at(group, &(self.mesh.vertices()[v])),
                None => value.min(bounds[v].1).max(bounds[v].0),
            };
        }
    }

    /// Moves values at midpoints of edges into the constraints, and sets those on the Dirichlet boundary: a quadratic that
    /// exceeds an obstacle at the vertices exceeds it everywhere if its Bernstein coefficients on the edges,
    /// `2 v_m - (v_a + v_b) / 2`, do not lie below those of the obstacle.
    fn clip_at_midpoints(&self, nodes: &FunctionNodes<'_>, values: &mut [f64]) {
        let (at_vertices, at_midpoints) = values.split_at_mut(nodes.n_vertices);
        let mut bounds = vec![(f64::NEG_INFINITY, f64::INFINITY); at_midpoints.len()];
        // what a datum asks of the value at the midpoint of an edge
        let least = |datum: &Datum<D>, cell: usize, &[a, b]: &[usize; 2]| {
            let ends = map_entries([a, b], |k| self.mesh.cell(cell)[k] as usize);
            let [x, y] = map_entries(ends, |v| self.mesh.vertices()[v]);
            let at = |x: &Point<D>| self.at(datum, cell, x);
            let middle = at(&midpoint(&x, &y));
            let [of_x, of_y] = map_entries(ends, |v| at_vertices[v]);
            middle + (of_x + of_y - at(&x) - at(&y)) / 4.0
        };
        for cell in 0..self.mesh.n_cells() {
            let region = self.mesh.region(cell);
            let (lower, upper) = (self.data.lower.of(region), self.data.upper.of(region));
            if lower.is_none() && upper.is_none() {
                continue;
            }
            for (edge, node) in nodes.of_edges(D, cell) {
                let (low, high) = &mut bounds[node - nodes.n_vertices];
                *low = lower.map_or(*low, |psi| least(psi, cell, edge).max(*low));
                *high = upper.map_or(*high, |psi| least(psi, cell, edge).min(*high));
            }
        }
        let on_facet = |local: usize, edge: &[usize; 2]| !edge.contains(&local);
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            let Some(gap) = self.data.gap.of(group) else { continue };
            for (edge, node) in nodes.of_edges(D, cell).filter(|(e, _)| on_facet(local, e)) {
                let low = &mut bounds[node - nodes.n_vertices].0;
                *low = low.max(least(gap, cell, edge));
            }
        }
        for (value, (low, high)) in at_midpoints.iter_mut().zip(bounds) {
            *value = value.min(high).max(low);
        }
        let mut ranks = vec![usize::MAX; at_midpoints.len()];
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Dirichlet) {
            for (&[a, b], node) in nodes.of_edges(D, cell).filter(|(e, _)| on_facet(local, e)) {
                let edge = node - nodes.n_vertices;
                let rank = self.data.dirichlet_rank[group];
                if rank < ranks[edge] {
                    ranks[edge] = rank;
                    let [x, y] = map_entries([a, b], |k| self.mesh.cell(cell)[k] as usize);
                    let [x, y] = map_entries([x, y], |v| self.mesh.vertices()[v]);
                    at_midpoints[edge] = self.dirichlet_at(group, &midpoint(&x, &y));
                }
            }
        }
    }
}

/// The middle of two points.
fn midpoint<const D: usize>(x: &Point<D>, y: &Point<D>) -> Point<D> {
    (x + y) * 0.5
}

//! The admissible function of a discrete solution.

use std::convert::Infallible;

use super::PrimalDualPair;
use super::flux::Flux;
use crate::algebra::{Bound, Contact};
use crate::arrays::map_entries;
use crate::assemble::shared_rows::places::for_each_place;
use crate::assemble::space::Space;
use crate::assemble::space::dofs::Dofs;
use crate::assemble::space::tables::BasisAt;
use crate::element::{Layout, Node};
use crate::mesh::{BoundaryCondition, HalfFacet, edge_vertices};
use crate::parallel::vectors::{collect, for_each_chunk};
use crate::problem::Datum;
use crate::real::Point;

/// A node of the function of a pair: two vertices of a cell, whose midpoint the node is, and the number of the node. For a
/// node at a vertex the two are equal.
pub(super) type PairNode = ([usize; 2], usize);

impl<const D: usize> Space<'_, D> {
    /// The nodes of the function of a pair in a cell.
    pub(super) fn pair_nodes(
        &self,
        pair: &PrimalDualPair<D>,
        cell: usize,
    ) -> impl Iterator<Item = PairNode> {
        let (pairs, n_vertices) = (edge_vertices(D), self.mesh.vertices().len());
        let edges = pair.edges.get(cell * pairs.len()..).unwrap_or_default();
        let vertices = self.mesh.cell(cell).iter().enumerate();
        let of_edges = pairs.iter().zip(edges);
        vertices
            .map(|(k, &v)| ([k; 2], v as usize))
            .chain(of_edges.map(move |(ends, &edge)| (*ends, n_vertices + edge as usize)))
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
        let (degree, n_vertices) = (self.degree, self.mesh.vertices().len());
        // the nodes are the unknowns of conforming functions: vertices and, for quadratics, after them edges
        let layout = Layout { vertex: 1, edge: degree - 1, facet: 0, cell: 0 };
        let nodes = Dofs::new(layout, self.mesh, None);
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
        let mut edges = Vec::new();
        if degree > 1 {
            self.clip_at_midpoints(&nodes, &mut function);
            let n_edges = edge_vertices(D).len();
            let edge = |k: usize| nodes.of(k / n_edges, D + 1 + k % n_edges) - n_vertices;
            edges = collect(self.mesh.n_cells() * n_edges, |k| edge(k) as u32);
        }
        PrimalDualPair {
            degree,
            function,
            edges,
            flux: Flux::zero(degree - 1, 0),
            forces: Vec::new(),
        }
    }

    /// For each node the obstacle that all unknowns of all cells around touch, where these are no values at the nodes.
    /// An unknown whose basis function has no positive mean does not count.
    fn states_of_nodes(
        &self,
        (bounds, contact): (&[Bound<f64>], &[Contact]),
        nodes: &Dofs<'_>,
    ) -> Option<Vec<Contact>> {
        let has_means = self.nodes.iter().any(|node| node.point().is_none());
        if !has_means || !self.problem.has_obstacle() || contact.len() != bounds.len() {
            return None;
        }
        let decides = self.unknowns_with_positive_mean();
        let of_cells = collect(self.mesh.n_cells(), |cell| {
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
            if touches { first } else { Contact::Inactive }
        });
        let mut states: Vec<Option<Contact>> = vec![None; nodes.size()];
        let Ok(()) = for_each_place::<D, _, Infallible>(nodes, &mut states, |state, (cell, _)| {
            let merged = state.is_none_or(|before| before == of_cells[cell]);
            *state = Some(if merged { of_cells[cell] } else { Contact::Inactive });
            Ok(())
        });
        Some(states.into_iter().map(Option::unwrap_or_default).collect())
    }

    /// At each node the mean of the values in the cells around, with the coefficient as weights; cells with the node on a
    /// Robin side weigh more, so that a large coefficient holds the value of these.
    fn means(&self, u: &[f64], nodes: &Dofs<'_>) -> Vec<f64> {
        if self.is_conforming_linear() {
            return u.to_vec();
        }
        let midpoints = nodes.per_cell() - (D + 1);
        let basis: Vec<BasisAt> = (0..D + 1)
            .map(Node::vertex)
            .chain((0..midpoints).map(Node::midpoint))
            .map(|node| self.basis_at(&node.centre(D)))
            .collect();
        let n = self.per_cell();
        let of_sides = self.weights_of_sides(nodes);
        let mut sums = vec![(0.0, 0.0); nodes.size()];
        let Ok(()) = for_each_place::<D, _, Infallible>(nodes, &mut sums, |of_node, (cell, i)| {
            let local = self.local_values(cell, u);
            let of_side = of_sides.get(cell * nodes.per_cell() + i).unwrap_or(&0.0);
            let weight = self.mean_coefficient(cell) + of_side;
            let value: f64 = (0..n).map(|j| local[j] * basis[i].values[j]).sum();
            of_node.0 += weight * value;
            of_node.1 += weight;
            Ok(())
        });
        sums.into_iter().map(|(sum, weight)| sum / weight).collect()
    }

    /// By cell and node the coefficient of the Robin side on which the node lies, times the diameter of the cell; empty
    /// without Robin sides.
    fn weights_of_sides(&self, nodes: &Dofs<'_>) -> Vec<f64> {
        let Some(reaction) = self.reaction.as_ref().filter(|_| self.data.robin.is_given()) else {
            return Vec::new();
        };
        let mut weights = vec![0.0; self.mesh.n_cells() * nodes.per_cell()];
        for ((cell, local), side) in reaction.sides() {
            let x = self.mesh.facet_barycentre(*cell, *local);
            let weight = self.at(&side.coefficient, *cell, &x) * self.mesh.cell_diameter(*cell);
            let vertices = (0..D + 1).map(|k| [k, k]);
            let all = vertices.chain(edge_vertices(D).iter().copied()).take(nodes.per_cell());
            for (i, _) in all.enumerate().filter(|(_, ends)| !ends.contains(local)) {
                weights[cell * nodes.per_cell() + i] += weight;
            }
        }
        weights
    }

    /// Sets values at vertices to Dirichlet data, and moves the others into the constraints.
    pub(super) fn clip_at_vertices(&self, values: &mut [f64]) {
        let restrict = |(low, high): &mut (f64, f64), v: usize, cell: usize| {
            let region = self.mesh.region(cell);
            let x = self.mesh.vertices()[v];
            *low = self.data.lower.of(region).map_or(*low, |psi| self.at(psi, cell, &x).max(*low));
            *high =
                self.data.upper.of(region).map_or(*high, |psi| self.at(psi, cell, &x).min(*high));
        };
        let has_one_obstacle = self.problem.has_obstacle() && !self.data.obstacles_differ();
        let mut bounds = collect(values.len(), |v| {
            let mut bounds = (f64::NEG_INFINITY, f64::INFINITY);
            if has_one_obstacle {
                restrict(&mut bounds, v, 0);
            }
            bounds
        });
        if self.data.obstacles_differ() {
            for cell in 0..self.mesh.n_cells() {
                let vertices = self.mesh.cell(cell).iter().map(|&v| v as usize);
                vertices.for_each(|v| restrict(&mut bounds[v], v, cell));
            }
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
        for_each_chunk(values, |range, values| {
            for (v, value) in range.zip(values) {
                *value = match groups[v] {
                    Some((group, cell)) => {
                        self.dirichlet_at(group, cell, &(self.mesh.vertices()[v]))
                    }
                    None => value.min(bounds[v].1).max(bounds[v].0),
                };
            }
        });
    }

    /// Moves values at midpoints of edges into the constraints, and sets those on the Dirichlet boundary: a quadratic that
    /// exceeds an obstacle at the vertices exceeds it everywhere if its Bernstein coefficients on the edges,
    /// `2 v_m - (v_a + v_b) / 2`, do not lie below those of the obstacle.
    fn clip_at_midpoints(&self, nodes: &Dofs<'_>, values: &mut [f64]) {
        let (pairs, n_vertices) = (edge_vertices(D), self.mesh.vertices().len());
        let (at_vertices, at_midpoints) = values.split_at_mut(n_vertices);
        // what a datum asks of the value at the midpoint of an edge
        let least = |datum: &Datum<D>, cell: usize, &[a, b]: &[usize; 2]| {
            let ends = map_entries([a, b], |k| self.mesh.cell(cell)[k] as usize);
            let [x, y] = map_entries(ends, |v| self.mesh.vertices()[v]);
            let at = |x: &Point<D>| self.at(datum, cell, x);
            let middle = at(&midpoint(&x, &y));
            let [of_x, of_y] = map_entries(ends, |v| at_vertices[v]);
            middle + (of_x + of_y - at(&x) - at(&y)) / 4.0
        };
        let mut bounds = vec![(f64::NEG_INFINITY, f64::INFINITY); nodes.size()];
        let Ok(()) =
            for_each_place::<D, _, Infallible>(nodes, &mut bounds, |(low, high), (cell, i)| {
                let Some(edge) = i.checked_sub(D + 1).map(|k| &pairs[k]) else { return Ok(()) };
                let region = self.mesh.region(cell);
                let (lower, upper) = (self.data.lower.of(region), self.data.upper.of(region));
                *low = lower.map_or(*low, |psi| least(psi, cell, edge).max(*low));
                *high = upper.map_or(*high, |psi| least(psi, cell, edge).min(*high));
                Ok(())
            });
        // the edges of a facet, with their nodes
        let edges_of = |(cell, local): HalfFacet| {
            let of_facet = pairs.iter().enumerate().filter(move |(_, ends)| !ends.contains(&local));
            of_facet.map(move |(k, ends)| (ends, nodes.of(cell, D + 1 + k)))
        };
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            let Some(gap) = self.data.gap.of(group) else { continue };
            for (edge, node) in edges_of((cell, local)) {
                let low = &mut bounds[node].0;
                *low = low.max(least(gap, cell, edge));
            }
        }
        for (value, (low, high)) in at_midpoints.iter_mut().zip(&bounds[n_vertices..]) {
            *value = value.min(*high).max(*low);
        }
        let mut ranks = vec![usize::MAX; at_midpoints.len()];
        for (facet, group) in self.grouped_facets_of(BoundaryCondition::Dirichlet) {
            for (ends, node) in edges_of(facet) {
                let (edge, rank) = (node - n_vertices, self.data.dirichlet_rank[group]);
                if rank < ranks[edge] {
                    ranks[edge] = rank;
                    let [x, y] = map_entries(*ends, |k| self.mesh.cell(facet.0)[k] as usize);
                    let [x, y] = map_entries([x, y], |v| self.mesh.vertices()[v]);
                    at_midpoints[edge] = self.dirichlet_at(group, facet.0, &midpoint(&x, &y));
                }
            }
        }
    }
}

/// The middle of two points.
fn midpoint<const D: usize>(x: &Point<D>, y: &Point<D>) -> Point<D> {
    (x + y) * 0.5
}

//! The bounds of each unknown: Dirichlet values, obstacles, the Signorini condition.

use std::ops::Range;
use std::sync::Mutex;

use super::contradictions::{BoundedNode, Contradiction, DIRICHLET};
use super::obstacle_coefficients::Binding;
use super::{Space, Terms, checks};
use crate::algebra::Bound;
use crate::assemble::shared_rows::places::for_each_place;
use crate::constraint::BoundBy;
use crate::element::Node;
use crate::error::Error;
use crate::mesh::{BoundaryCondition, HalfFacet};
use crate::parallel::vectors::collect;
use crate::parallel::{cells, lock};
use crate::problem::Datum;
use crate::real::Point;

/// Sorts facets by the ranks of their groups; not generic, so that the sorting code is compiled once.
fn sort_by_rank(facets: &mut [(HalfFacet, usize)], ranks: &[usize]) {
    facets.sort_by_key(|&(_, group)| ranks[group]);
}

impl<const D: usize> Space<'_, D> {
    /// The bounds of all unknowns, see `Discretisation::bounds`, and those of which a lower one exceeds an upper
    /// one.
    pub fn bounds(&self) -> Result<(Vec<Bound<f64>>, Vec<Contradiction<D>>), Error> {
        let mut bounds = collect(self.dofs.size(), |_| Bound::Free);
        let mut found = Vec::new();
        if self.problem.has_obstacle() {
            self.bound_by_obstacles(&mut bounds, &mut found)?;
        }
        if self.problem.has_gap() {
            self.bound_by_contact(&mut bounds, &mut found)?;
        }
        if self.pins {
            self.pin(&mut bounds, &mut found)?;
        }
        self.compare_between_nodes(&mut found)?;
        Ok((bounds, found))
    }

    fn bound_by_obstacles(
        &self,
        bounds: &mut [Bound<f64>],
        found: &mut Vec<Contradiction<D>>,
    ) -> Result<(), Error> {
        let bounded: Vec<(usize, BoundBy)> = self.bounded_nodes().collect();
        let terms = self.node_terms(&self.facet_rule);
        let n = self.per_cell();
        let found_by_all = Mutex::new(Vec::new());
        let restrict = |bound: &mut Bound<f64>, cell, node| -> Result<(), Error> {
            let mut found = Vec::new();
            self.restrict_by_obstacles(&terms, cell, node, bound, &mut found)?;
            if !found.is_empty() {
                lock(&found_by_all).append(&mut found);
            }
            Ok(())
        };
        if self.broken {
            // no other cell has the unknowns of a cell
            let bound_chunk =
                |cells: Range<usize>, bounds: &mut [Bound<f64>]| -> Result<(), Error> {
                    for (cell, bounds) in cells.zip(bounds.chunks_exact_mut(n)) {
                        for &node in &bounded {
                            restrict(&mut bounds[node.0], cell, node)?;
                        }
                    }
                    Ok(())
                };
            cells::for_each(self.mesh.n_cells(), &|cell| cell * n, bounds, &bound_chunk)?;
        } else {
            // beside a jump coefficients of two cells differ
            let differ = self.data.obstacles_differ() || self.has_coefficients();
            for_each_place::<D, _, _>(&self.dofs, bounds, |bound, (cell, i)| {
                match bounded.iter().find(|node| node.0 == i) {
                    Some(&node) if *bound == Bound::Free || differ => restrict(bound, cell, node),
                    _ => Ok(()),
                }
            })?;
        }
        found.append(&mut lock(&found_by_all));
        // the order of tasks depends on the threads
        found.sort_by_key(|contradiction| (contradiction.node.cell, contradiction.node.unknown));
        Ok(())
    }

    /// Restricts the bound of node `i` of a cell by the obstacles in the cell: of the obstacles of two cells both hold.
    fn restrict_by_obstacles(
        &self,
        terms: &[Terms],
        cell: usize,
        (i, by): (usize, BoundBy),
        bound: &mut Bound<f64>,
        found: &mut Vec<Contradiction<D>>,
    ) -> Result<(), Error> {
        let (region, node) = (self.mesh.region(cell), &self.nodes[i]);
        let at = |binding, psi: Option<&Datum<D>>| {
            psi.map(|psi| self.bound(by, &terms[i], (cell, node), (binding, psi))).transpose()
        };
        let lower = at(Binding::Lower, self.data.lower.of(region))?;
        let upper = at(Binding::Upper, self.data.upper.of(region))?;
        let (unknown, x) = (self.dofs.of(cell, i), self.node_point(cell, node));
        intersect(bound, [lower, upper], BoundedNode { unknown, cell, x }, found);
        Ok(())
    }

    fn bound_by_contact(
        &self,
        bounds: &mut [Bound<f64>],
        found: &mut Vec<Contradiction<D>>,
    ) -> Result<(), Error> {
        let terms = self.node_terms(&self.facet_rule);
        let given = self.dirichlet_groups();
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            let Some(gap) = self.data.gap.of(group) else { continue };
            // a function that jumps along the boundary, down to the Dirichlet data, has no finite energy
            for (k, v) in self.mesh.facet_vertices(cell, local).enumerate() {
                let Some((dirichlet, beside)) = given[v as usize] else { continue };
                let x = self.mesh.vertices()[v as usize];
                let datum = self.dirichlet_at(dirichlet, beside, &x);
                let datum = checks::finite(datum, "dirichlet", &x, cell)?;
                // the node at the vertex, where the element has one, else one of the facet
                let node = self.nodes_on(local).take(k + 1).last();
                let node = node.expect("an element has nodes on facets if there is a gap");
                let unknown = self.dofs.of(cell, node);
                let of = (["gap", DIRICHLET], Some(dirichlet));
                let values = [self.at(gap, cell, &x), datum];
                BoundedNode { unknown, cell, x }.compare(of, values, found);
            }
            for (i, by) in self.bounded_nodes_on(local) {
                let node = &self.nodes[i];
                let value = self.bound(by, &terms[i], (cell, node), (Binding::Gap(local), gap))?;
                let (unknown, x) = (self.dofs.of(cell, i), self.node_point(cell, node));
                let node = BoundedNode { unknown, cell, x };
                intersect(&mut bounds[unknown], [Some(value), None], node, found);
            }
        }
        Ok(())
    }

    /// The bound that a datum imposes at a node.
    pub(super) fn bound(
        &self,
        by: BoundBy,
        terms: &Terms,
        (cell, node): (usize, &Node),
        (binding, datum): (Binding, &Datum<D>),
    ) -> Result<f64, Error> {
        let name = binding.name();
        match by {
            BoundBy::Functional if node.is_coefficient() => {
                Ok(self.obstacle_coefficient(terms, cell, (binding, datum))?.0)
            }
            BoundBy::Functional => self.at_node(terms, cell, name, &|x| self.at(datum, cell, x)),
            BoundBy::Value => {
                let x = self.node_point(cell, node);
                checks::finite(self.at(datum, cell, &x), name, &x, cell)
            }
        }
    }

    fn pin(
        &self,
        bounds: &mut [Bound<f64>],
        found: &mut Vec<Contradiction<D>>,
    ) -> Result<(), Error> {
        let terms = self.node_terms(&self.facet_rule);
        let zero = !self.problem.has_dirichlet_data();
        let (lowers, uppers) = (&self.data.lower, &self.data.upper);
        let mut facets: Vec<_> = self.grouped_facets_of(BoundaryCondition::Dirichlet).collect();
        // the first facet decides on an unknown
        sort_by_rank(&mut facets, &self.data.dirichlet_rank);
        for ((cell, local), group) in facets {
            let region = self.mesh.region(cell);
            let datum = |x: &Point<D>| self.dirichlet_at(group, cell, x);
            for i in self.nodes_on(local) {
                let unknown = self.dofs.of(cell, i);
                if let Bound::Fixed(_) = bounds[unknown] {
                    continue;
                }
                let at = |name, datum: &dyn Fn(&Point<D>) -> f64| {
                    self.at_node(&terms[i], cell, name, datum)
                };
                let value = if zero { 0.0 } else { at("dirichlet", &datum)? };
                bounds[unknown] = Bound::Fixed(value);
                // obstacles must leave room for the datum; a mean is compared with a mean: over a
                // curved obstacle the value at the barycentre may lie above the mean of a datum
                // that touches it. A datum that touches an obstacle at a point may lie beyond it in a
                // coefficient: there the values at the point are compared
                let x = self.node_point(cell, &self.nodes[i]);
                let is_coefficient = self.nodes[i].is_coefficient();
                let obstacle = |psi: &Datum<D>| match is_coefficient {
                    true => checks::finite(self.at(psi, cell, &x), "obstacle", &x, cell),
                    false => at("obstacle", &|x| self.at(psi, cell, x)),
                };
                let value = if is_coefficient && !zero { datum(&x) } else { value };
                let node = BoundedNode { unknown, cell, x };
                if let Some(psi) = lowers.of(region) {
                    let of = (["lower obstacle", DIRICHLET], Some(group));
                    node.compare(of, [obstacle(psi)?, value], found);
                }
                if let Some(psi) = uppers.of(region) {
                    let of = ([DIRICHLET, "upper obstacle"], Some(group));
                    node.compare(of, [value, obstacle(psi)?], found);
                }
            }
        }
        Ok(())
    }

    /// By how much Dirichlet values lie beyond an obstacle in a Bernstein coefficient at most, and where; none if they
    /// do so nowhere.
    pub(crate) fn data_beyond_coefficients(&self) -> Result<Option<(f64, Point<D>)>, Error> {
        if !self.problem.has_obstacle() || !self.has_coefficients() {
            return Ok(None);
        }
        let terms = self.node_terms(&self.facet_rule);
        let (mut largest, mut place) = (0.0, None);
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Dirichlet) {
            let region = self.mesh.region(cell);
            let sides = [
                (1.0, Binding::Lower, self.data.lower.of(region)),
                (-1.0, Binding::Upper, self.data.upper.of(region)),
            ];
            for i in self.nodes_on(local) {
                let datum = |x: &Point<D>| self.dirichlet_at(group, cell, x);
                let value = self.at_node(&terms[i], cell, "dirichlet", &datum)?;
                for (sign, binding, psi) in sides {
                    let Some(psi) = psi else { continue };
                    let (bound, _) = self.obstacle_coefficient(&terms[i], cell, (binding, psi))?;
                    if sign * (bound - value) > largest {
                        largest = sign * (bound - value);
                        place = Some(self.node_point(cell, &self.nodes[i]));
                    }
                }
            }
        }
        Ok(place.map(|x| (largest, x)))
    }

    /// The functional of a node at a datum.
    fn at_node(
        &self,
        terms: &Terms,
        cell: usize,
        name: &'static str,
        datum: &dyn Fn(&Point<D>) -> f64,
    ) -> Result<f64, Error> {
        let at = |(point, weight): &([f64; 4], f64)| {
            let x = self.cell_point(point, cell);
            Ok(weight * checks::finite(datum(&x), name, &x, cell)?)
        };
        terms.iter().map(at).sum()
    }
}

/// Narrows a bound by a lower and an upper one, of which each may be absent.
fn intersect<const D: usize>(
    bound: &mut Bound<f64>,
    [lower, upper]: [Option<f64>; 2],
    node: BoundedNode<D>,
    found: &mut Vec<Contradiction<D>>,
) {
    let both = |old: Option<f64>, new: Option<f64>, choose: fn(f64, f64) -> f64| {
        new.map(|new| old.map_or(new, |old| choose(old, new))).or(old)
    };
    let lower = both(bound.lower(), lower, f64::max);
    let upper = both(bound.upper(), upper, f64::min);
    *bound = match (lower, upper) {
        (None, None) => Bound::Free,
        (Some(l), None) => Bound::Lower(l),
        (None, Some(u)) => Bound::Upper(u),
        (Some(l), Some(u)) => {
            node.compare((["lower bound", "upper bound"], None), [l, u], found);
            Bound::Both(l, l.max(u))
        }
    };
}

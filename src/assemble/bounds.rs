//! What each unknown may be: Dirichlet values, obstacles, the Signorini condition.

use super::space::Space;
use super::{count, data};
use crate::algebra::Bound;
use crate::element::Node;
use crate::error::Error;
use crate::mesh::{BoundaryPart, describe_point};
use crate::problem::Field;
use crate::quadrature::Rule;
use crate::real::{Point, Real};

/// Two bounds contradict each other if they do so by more than this share of their size: less is
/// rounding in the data.
const RELATIVE_SLACK: f64 = 1e-9;

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The bounds of all unknowns; see `Discretisation::bounds`.
    pub fn bounds(&self) -> Result<Vec<Bound<T>>, Error> {
        let mut bounds = vec![Bound::Free; self.dofs.size()];
        let mut conflicts = Vec::new();
        if self.problem.has_obstacle() {
            self.bound_by_obstacles(&mut bounds, &mut conflicts)?;
        }
        if let Some(gap) = &self.problem.gap {
            self.bound_by_contact(gap, &mut bounds, &mut conflicts)?;
        }
        if self.pins {
            self.pin(&mut bounds, &mut conflicts)?;
        }
        judge::<T, D>(&bounds, conflicts)?;
        Ok(bounds)
    }

    fn bound_by_obstacles(
        &self,
        bounds: &mut [Bound<T>],
        conflicts: &mut Vec<Conflict<D>>,
    ) -> Result<(), Error> {
        for cell in 0..self.mesh.n_cells() {
            for i in 0..self.per_cell() {
                let unknown = self.dofs.of(cell, i);
                if bounds[unknown] != Bound::Free {
                    continue;
                }
                count::bounds(1);
                let x = self.node_point(cell, self.nodes[i]);
                let at = |psi: &Option<Field<D>>| match psi {
                    Some(psi) => data::finite(psi(&x), "obstacle", &x, cell).map(Some),
                    None => Ok(None),
                };
                let (lower, upper) = (at(&self.problem.lower)?, at(&self.problem.upper)?);
                bounds[unknown] = between(lower, upper, unknown, x, conflicts);
            }
        }
        Ok(())
    }

    fn bound_by_contact(
        &self,
        gap: &Field<D>,
        bounds: &mut [Bound<T>],
        conflicts: &mut Vec<Conflict<D>>,
    ) -> Result<(), Error> {
        let rule = Rule::of_degree(D - 1, self.quadrature.facet);
        for (cell, local) in self.facets_of(BoundaryPart::Contact) {
            for i in self.nodes_on(local) {
                count::bounds(1);
                let node = self.nodes[i];
                let x = self.node_point(cell, node);
                let value = match node {
                    Node::Vertex(_) => data::finite(gap(&x), "gap", &x, cell)?,
                    Node::FacetMean(_) => self.facet_mean(&rule, cell, local, "gap", gap)?,
                };
                let unknown = self.dofs.of(cell, i);
                let old = bounds[unknown];
                let lower = old.lower().map_or(value, |l| l.to_f64().max(value));
                let upper = old.upper().map(Real::to_f64);
                bounds[unknown] = between(Some(lower), upper, unknown, x, conflicts);
            }
        }
        Ok(())
    }

    fn pin(&self, bounds: &mut [Bound<T>], conflicts: &mut Vec<Conflict<D>>) -> Result<(), Error> {
        let rule = Rule::of_degree(D - 1, self.quadrature.facet);
        let zero = !self.problem.has_dirichlet_data();
        for (cell, local) in self.facets_of(BoundaryPart::Dirichlet) {
            for i in self.nodes_on(local) {
                let unknown = self.dofs.of(cell, i);
                if let Bound::Fixed(_) = bounds[unknown] {
                    continue;
                }
                let node = self.nodes[i];
                let x = self.node_point(cell, node);
                let value = match node {
                    _ if zero => 0.0,
                    Node::Vertex(_) => {
                        count::dirichlet(1);
                        data::finite(self.problem.dirichlet_at(&x), "dirichlet", &x, cell)?
                    }
                    Node::FacetMean(_) => {
                        let datum = |x: &Point<f64, D>| self.problem.dirichlet_at(x);
                        self.facet_mean(&rule, cell, local, "dirichlet", &datum)?
                    }
                };
                // obstacles must leave room for the datum
                let [lower, upper] = [&self.problem.lower, &self.problem.upper].map(|psi| {
                    psi.as_ref().map(|psi| match node {
                        Node::Vertex(_) => Ok(psi(&x)),
                        // a mean is compared with a mean: over a curved obstacle the value at the
                        // barycentre may lie above the mean of a datum that touches it
                        Node::FacetMean(_) => self.facet_mean(&rule, cell, local, "obstacle", psi),
                    })
                });
                if let Some(lower) = lower {
                    note(lower?, value, unknown, x, conflicts);
                }
                if let Some(upper) = upper {
                    note(value, upper?, unknown, x, conflicts);
                }
                bounds[unknown] = Bound::Fixed(T::lit(value));
            }
        }
        Ok(())
    }

    /// The mean of a datum over a facet.
    fn facet_mean(
        &self,
        rule: &Rule,
        cell: usize,
        local: usize,
        name: &'static str,
        datum: &dyn Fn(&Point<f64, D>) -> f64,
    ) -> Result<f64, Error> {
        let terms = rule.iter().map(|(point, weight)| {
            if name == "dirichlet" {
                count::dirichlet(1);
            }
            let x = self.facet_point(point, cell, local);
            data::finite(datum(&x), name, &x, cell).map(|value| weight * value)
        });
        terms.sum()
    }
}

/// A lower bound above an upper one: the unknown, its node, the two values.
type Conflict<const D: usize> = (usize, Point<f64, D>, f64, f64);

/// Notes two values of which the first must not exceed the second.
fn note<const D: usize>(
    lower: f64,
    upper: f64,
    unknown: usize,
    x: Point<f64, D>,
    conflicts: &mut Vec<Conflict<D>>,
) {
    if lower > upper {
        conflicts.push((unknown, x, lower, upper));
    }
}

/// The bound between two values, of which each may be absent.
fn between<T: Real, const D: usize>(
    lower: Option<f64>,
    upper: Option<f64>,
    unknown: usize,
    x: Point<f64, D>,
    conflicts: &mut Vec<Conflict<D>>,
) -> Bound<T> {
    match (lower, upper) {
        (None, None) => Bound::Free,
        (Some(l), None) => Bound::Lower(T::lit(l)),
        (None, Some(u)) => Bound::Upper(T::lit(u)),
        (Some(l), Some(u)) => {
            note(l, u, unknown, x, conflicts);
            Bound::Both(T::lit(l), T::lit(l.max(u)))
        }
    }
}

/// Tells contradictions from rounding. Two values that are equal but for rounding may be zero but
/// for rounding, so only the size of all data can tell.
fn judge<T: Real, const D: usize>(
    bounds: &[Bound<T>],
    conflicts: Vec<Conflict<D>>,
) -> Result<(), Error> {
    if conflicts.is_empty() {
        return Ok(());
    }
    let values = |b: &Bound<T>| match *b {
        Bound::Free => [None, None],
        Bound::Fixed(a) | Bound::Lower(a) | Bound::Upper(a) => [Some(a), None],
        Bound::Both(a, b) => [Some(a), Some(b)],
    };
    let sizes = bounds.iter().flat_map(values).flatten().map(|x| x.to_f64().abs());
    let size = conflicts.iter().map(|c| c.2.abs().max(c.3.abs())).chain(sizes).fold(0.0, f64::max);
    let slack = RELATIVE_SLACK.max(16.0 * T::EPSILON) * size;
    match conflicts.into_iter().find(|(_, _, lower, upper)| lower - upper > slack) {
        Some((unknown, x, lower, upper)) => {
            Err(Error::EmptyConstraint { unknown, at: describe_point(&x), lower, upper })
        }
        None => Ok(()),
    }
}

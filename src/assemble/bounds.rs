//! What each unknown may be: Dirichlet values, obstacles, the Signorini condition.

use super::{Discretisation, count, data};
use crate::algebra::Bound;
use crate::element::{Node, ReferenceElement};
use crate::error::Error;
use crate::mesh::{BoundaryPart, describe_point};
use crate::problem::Field;
use crate::quadrature::Rule;
use crate::real::{Point, Real, point_f64};
use crate::scheme::{DirichletBy, Scheme};

/// Two bounds contradict each other if they do so by more than this share of their size: less is
/// rounding in the data.
const RELATIVE_SLACK: f64 = 1e-9;

impl<T: Real, const D: usize, S: Scheme<T, D>> Discretisation<'_, T, D, S> {
    /// The bounds of all unknowns.
    ///
    /// Obstacles bind every unknown at its node: a vertex, or the barycentre of a facet. The
    /// Signorini condition binds the unknowns of contact facets on the cell that has the facet:
    /// vertex values against the gap there, facet means against the mean of the gap. An unknown
    /// pinned by Dirichlet data is not constrained besides.
    ///
    /// # Errors
    /// [`Error::EmptyConstraint`], [`Error::DataNotFinite`].
    pub fn bounds(&self) -> Result<Vec<Bound<T>>, Error> {
        let mut bounds = vec![Bound::Free; self.unknowns()];
        if self.problem.lower.is_some() || self.problem.upper.is_some() {
            self.bound_by_obstacles(&mut bounds)?;
        }
        if let Some(gap) = &self.problem.gap {
            self.bound_by_contact(gap, &mut bounds)?;
        }
        if S::DIRICHLET == DirichletBy::Pinning {
            self.pin(&mut bounds)?;
        }
        Ok(bounds)
    }

    fn bound_by_obstacles(&self, bounds: &mut [Bound<T>]) -> Result<(), Error> {
        for cell in 0..self.mesh.n_cells() {
            for i in 0..Self::N {
                let unknown = self.dofs.of(cell, i);
                if bounds[unknown] != Bound::Free {
                    continue;
                }
                count::bounds(1);
                let x = self.node_point(cell, S::Element::node(i));
                let at = |psi: &Option<Field<D>>| match psi {
                    Some(psi) => data::finite(psi(&x), "obstacle", &x, cell).map(Some),
                    None => Ok(None),
                };
                let (lower, upper) = (at(&self.problem.lower)?, at(&self.problem.upper)?);
                bounds[unknown] = between(lower, upper, unknown, &x)?;
            }
        }
        Ok(())
    }

    fn bound_by_contact(&self, gap: &Field<D>, bounds: &mut [Bound<T>]) -> Result<(), Error> {
        let rule = Rule::of_degree(D - 1, self.quadrature.facet);
        for facet in self.facets_of(BoundaryPart::Contact) {
            let (cell, local) = (facet.cell as usize, facet.local as usize);
            for i in self.nodes_on(local) {
                count::bounds(1);
                let node = S::Element::node(i);
                let x = self.node_point(cell, node);
                let value = match node {
                    Node::Vertex(_) => data::finite(gap(&x), "gap", &x, cell)?,
                    Node::FacetMean(_) => self.facet_mean(&rule, cell, local, "gap", gap)?,
                };
                let unknown = self.dofs.of(cell, i);
                let old = bounds[unknown];
                let lower = old.lower().map_or(value, |l| l.to_f64().max(value));
                let upper = old.upper().map(Real::to_f64);
                bounds[unknown] = between(Some(lower), upper, unknown, &x)?;
            }
        }
        Ok(())
    }

    fn pin(&self, bounds: &mut [Bound<T>]) -> Result<(), Error> {
        let rule = Rule::of_degree(D - 1, self.quadrature.facet);
        let zero = !self.problem.has_dirichlet_data();
        let mut pinned = Vec::new();
        for facet in self.facets_of(BoundaryPart::Dirichlet) {
            let (cell, local) = (facet.cell as usize, facet.local as usize);
            for i in self.nodes_on(local) {
                let unknown = self.dofs.of(cell, i);
                if let Bound::Fixed(_) = bounds[unknown] {
                    continue;
                }
                let node = S::Element::node(i);
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
                pinned.push((unknown, value, x));
            }
        }
        // obstacles must leave room for the datum; where both are zero but for rounding, only the
        // size of all data tells that it is rounding
        let of_bounds = bounds.iter().flat_map(|b| [b.lower(), b.upper()]).flatten();
        let sizes = of_bounds.map(Real::to_f64).chain(pinned.iter().map(|p| p.1));
        let size = sizes.fold(0.0, |size: f64, value| size.max(value.abs()));
        for (unknown, value, x) in pinned {
            let lower = bounds[unknown].lower().map(Real::to_f64);
            let upper = bounds[unknown].upper().map(Real::to_f64);
            if !matches!(bounds[unknown], Bound::Fixed(_)) {
                check_room::<T, D>(lower, Some(value), size, unknown, &x)?;
                check_room::<T, D>(Some(value), upper, size, unknown, &x)?;
            }
            bounds[unknown] = Bound::Fixed(T::lit(value));
        }
        Ok(())
    }

    /// The basis functions whose nodes lie on facet `local`.
    pub(super) fn nodes_on(&self, local: usize) -> impl Iterator<Item = usize> + use<T, D, S> {
        (0..Self::N).filter(move |&i| match S::Element::node(i) {
            Node::Vertex(k) => k != local,
            Node::FacetMean(k) => k == local,
        })
    }
    /// The point at which a node sits.
    pub(super) fn node_point(&self, cell: usize, node: Node) -> Point<f64, D> {
        point_f64(&match node {
            Node::Vertex(k) => self.mesh.vertices()[self.mesh.cell(cell)[k] as usize],
            Node::FacetMean(k) => self.mesh.facet_barycentre(cell, k),
        })
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

/// The bound between two values, of which each may be absent.
fn between<T: Real, const D: usize>(
    lower: Option<f64>,
    upper: Option<f64>,
    unknown: usize,
    x: &Point<f64, D>,
) -> Result<Bound<T>, Error> {
    Ok(match (lower, upper) {
        (None, None) => Bound::Free,
        (Some(l), None) => Bound::Lower(T::lit(l)),
        (None, Some(u)) => Bound::Upper(T::lit(u)),
        (Some(l), Some(u)) => {
            check_room::<T, D>(lower, upper, l.abs() + u.abs(), unknown, x)?;
            Bound::Both(T::lit(l), T::lit(l.max(u)))
        }
    })
}

/// Whether there is room between two values, up to the rounding of data of this size.
fn check_room<T: Real, const D: usize>(
    lower: Option<f64>,
    upper: Option<f64>,
    size: f64,
    unknown: usize,
    x: &Point<f64, D>,
) -> Result<(), Error> {
    let slack = RELATIVE_SLACK.max(16.0 * T::EPSILON) * size;
    match (lower, upper) {
        (Some(lower), Some(upper)) if lower - upper > slack => {
            Err(Error::EmptyConstraint { unknown, at: describe_point(x), lower, upper })
        }
        _ => Ok(()),
    }
}

//! Numbers of a solution by name: at points, extremes, means, integrals, reactions, contact forces.

mod largest;
mod reactions;

use super::contact::SolvedInequality;
use crate::algebra::Inequality;
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::error::Error;
use crate::inequality::Solution;
use crate::instances::compiled;
use crate::mesh::{BoundaryCondition, BoundaryFacet, HalfFacet};
use crate::problem::{ROUNDING, ValueOf};
use crate::quadrature::{Rule, facet_to_cell};
use crate::real::Point;

/// The degree of rules for means and integrals, at least.
const DEGREE: usize = 5;

/// A number of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FoundValue<const D: usize> {
    /// The number; none at a point outside of the mesh, and for a contact force of which rounding left no digit.
    pub value: Option<f64>,
    /// Where the solution has it, for the largest and the smallest value.
    pub place: Option<Point<D>>,
}

impl<const D: usize> FoundValue<D> {
    fn number(value: Option<f64>) -> Self {
        Self { value, place: None }
    }
}

/// A function by cell and barycentric point, and whether it is linear in cells.
struct InCells<'f> {
    value: &'f dyn Fn(usize, &[f64; 4]) -> f64,
    is_linear: bool,
}

impl<const D: usize> Discretisation<'_, D> {
    /// Numbers of a solution. Means and integrals are those of the discrete function, by rules of degree five at least.
    /// Extremes are those at vertices and, of functions that are not linear in cells, of the quadratic function in each
    /// cell with the values at vertices and midpoints.
    ///
    /// *Reactions* are those of the equations of the scheme, not integrals of normal derivatives. Where Dirichlet data
    /// fix unknowns they are the entries of `A u - b` there; an unknown of several boundary groups is divided among
    /// them by the measure of their facets around its node. Where the facet form imposes the data they are the form on the
    /// facets of the group, tested with one: the flux that balances the load of the cells. Forces of obstacles and gaps at
    /// nodes of these facets are parts of them, as in [`Discretisation::resultant`]. For every scheme, and up to what
    /// the solver leaves,
    ///
    /// ```text
    /// loads - integral of reaction coefficient times u + reactions of all groups + resultant = 0
    /// ```
    ///
    /// where the reaction of a Robin side is the integral of `k (g - u)`.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`] for a name that the mesh does not have; [`Error::DataNotFinite`]; [`Error::Parameter`]
    /// unless the solution has one value for each unknown.
    pub fn values_of(
        &self,
        wanted: &[ValueOf<D>],
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
    ) -> Result<Vec<FoundValue<D>>, Error> {
        self.check_length(&solution.values)?;
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &[ValueOf<D>],
                &Inequality<f64>,
                &Solution<f64>,
            ) -> Result<Vec<FoundValue<D>>, Error>
                = |of, wanted, inequality, solution| of.find_values(wanted, (inequality, solution))
        )(self, wanted, inequality, solution)
    }

    /// The numbers of the exact solution of the problem on this mesh; none without one, and no integrals and means on a
    /// mesh with a [shape](crate::mesh::Mesh::with_shape), which is another domain. Reactions and contact forces are
    /// integrals of its normal flux.
    ///
    /// # Errors
    /// Those of [`Self::values_of`].
    pub fn exact_values_of(&self, wanted: &[ValueOf<D>]) -> Result<Vec<Option<f64>>, Error> {
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &[ValueOf<D>],
            ) -> Result<Vec<Option<f64>>, Error>
                = |of, wanted| of.find_exact_values(wanted)
        )(self, wanted)
    }

    fn find_values(
        &self,
        wanted: &[ValueOf<D>],
        solved: SolvedInequality<'_>,
    ) -> Result<Vec<FoundValue<D>>, Error> {
        self.check_values(wanted)?;
        let (space, u) = (&self.space, &solved.1.values);
        let value = |cell: usize, point: &[f64; 4]| {
            let local = space.local_values(cell, u);
            space.basis_at(point).value(&local) + space.body_constants.of_cell(cell)
        };
        let function = InCells { value: &value, is_linear: space.basis_degree == 1 };
        let asks = |of: fn(&ValueOf<D>) -> bool| wanted.iter().any(of);
        let reactions = match asks(|of| matches!(of, ValueOf::Reaction(_))) {
            true => self.reactions(solved)?,
            false => Vec::new(),
        };
        let forces = asks(|of| matches!(of, ValueOf::Force(_)))
            .then(|| space.forces_of_groups(solved))
            .flatten();
        let of_groups = |name: &str, by_group: &[f64]| -> f64 {
            let groups = self.mesh().boundary_groups().iter().zip(by_group);
            let meant = groups.filter(|(group, _)| ValueOf::<D>::is_meant(name, &group.names));
            meant.map(|(_, force)| force).sum()
        };
        let found = wanted.iter().map(|of| match of {
            ValueOf::Reaction(name) => FoundValue::number(Some(of_groups(name, &reactions))),
            ValueOf::Force(name) => {
                FoundValue::number(forces.as_deref().map(|forces| of_groups(name, forces)))
            }
            _ => space.value_of(&function, of),
        });
        Ok(found.collect())
    }

    fn find_exact_values(&self, wanted: &[ValueOf<D>]) -> Result<Vec<Option<f64>>, Error> {
        self.check_values(wanted)?;
        let space = &self.space;
        let Some(exact) = &self.problem().exact else { return Ok(vec![None; wanted.len()]) };
        let value =
            |cell: usize, point: &[f64; 4]| exact.value.at(&self.mesh().point(cell, &point[..=D]));
        let function = InCells { value: &value, is_linear: false };
        let flux = |facet: HalfFacet, point: &[f64; 4]| space.exact_flux(exact, facet, point);
        // the mesh is another domain
        let is_polygon = self.mesh().has_shapes();
        let found = wanted.iter().map(|of| match of {
            ValueOf::Mean(_) | ValueOf::Integral(_) | ValueOf::Reaction(_) | ValueOf::Force(_)
                if is_polygon =>
            {
                None
            }
            ValueOf::Reaction(name) => Some(space.on_group(name, &|f| space.holds(f), &flux)),
            ValueOf::Force(name) => {
                let is_contact = |f: &BoundaryFacet| {
                    f.condition == BoundaryCondition::Contact
                        || space.data.friction.of(usize::from(f.group)).is_some()
                };
                Some(space.on_group(name, &is_contact, &flux))
            }
            _ => space.value_of(&function, of).value,
        });
        Ok(found.collect())
    }

    /// Refuses names that the mesh does not have.
    fn check_values(&self, wanted: &[ValueOf<D>]) -> Result<(), Error> {
        let named = wanted.iter().filter(|of| !matches!(of, ValueOf::At(_)));
        match named.filter_map(|of| of.fault(self.problem(), self.mesh())).next() {
            None => Ok(()),
            Some(fault) => Err(Error::UnknownGroup(fault)),
        }
    }
}

impl<const D: usize> Space<'_, D> {
    /// A number of a function, other than forces.
    fn value_of(&self, function: &InCells<'_>, of: &ValueOf<D>) -> FoundValue<D> {
        match of {
            ValueOf::At(x) => {
                let (mut sum, mut count) = (0.0, 0.0);
                for cell in self.mesh.cells_containing(x, ROUNDING) {
                    sum += (function.value)(cell, &self.mesh.barycentric(cell, x));
                    count += 1.0;
                }
                FoundValue::number((count > 0.0).then(|| sum / count))
            }
            ValueOf::Mean(name) => {
                let rule = Rule::new(D, DEGREE.max(self.basis_degree));
                let (mut integral, mut volume) = (0.0, 0.0);
                for cell in self.cells_of(name) {
                    let own = self.mesh.geometry(cell).volume;
                    let terms = rule.iter().map(|(x, weight)| weight * (function.value)(cell, x));
                    integral += own * terms.sum::<f64>();
                    volume += own;
                }
                FoundValue::number(Some(integral / volume))
            }
            ValueOf::Largest(name) => self.largest(function, name, 1.0),
            ValueOf::Smallest(name) => self.largest(function, name, -1.0),
            ValueOf::Integral(name) => {
                let value = |(cell, local): HalfFacet, point: &[f64; 4]| {
                    (function.value)(cell, &facet_to_cell(point, local))
                };
                FoundValue::number(Some(self.on_group(name, &|_| true, &value)))
            }
            ValueOf::Reaction(_) | ValueOf::Force(_) => FoundValue::number(None),
        }
    }

    /// The cells of a region.
    fn cells_of(&self, name: &str) -> impl Iterator<Item = usize> {
        let regions = self.mesh.regions().iter();
        let is_meant: Vec<bool> =
            regions.map(|names| ValueOf::<D>::is_meant(name, names)).collect();
        (0..self.mesh.n_cells()).filter(move |&cell| is_meant[self.mesh.region(cell)])
    }

    /// Whether a boundary facet holds the body: it has Dirichlet data or lies on a Robin side.
    fn holds(&self, facet: &BoundaryFacet) -> bool {
        facet.condition == BoundaryCondition::Dirichlet
            || self.data.robin.of(usize::from(facet.group)).is_some()
    }

    /// The integral over the facets of a boundary group that are meant.
    fn on_group(
        &self,
        name: &str,
        is_meant: &dyn Fn(&BoundaryFacet) -> bool,
        value: &dyn Fn(HalfFacet, &[f64; 4]) -> f64,
    ) -> f64 {
        let rule = Rule::new(D - 1, DEGREE.max(self.basis_degree));
        let groups = self.mesh.boundary_groups();
        let mut integral = 0.0;
        for of in self.mesh.boundary() {
            if is_meant(of) && ValueOf::<D>::is_meant(name, &groups[usize::from(of.group)].names) {
                let facet = (of.cell as usize, usize::from(of.local));
                let terms = rule.iter().map(|(point, weight)| weight * value(facet, point));
                integral += self.facet_measure(facet) * terms.sum::<f64>();
            }
        }
        integral
    }
}

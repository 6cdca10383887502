//! Errors of multipliers and contact sets, in terms that do not depend on the unknowns of a scheme.
//!
//! The functions use the locations of unknowns only (a vertex, a facet, an edge), so that schemes
//! with different unknowns can be compared.

mod contact_set;
mod deciding_nodes;
mod difference;
mod entity;
mod exact_contact;
mod free_boundary;
mod multiplier_density;
mod multiplier_shares;
mod nodal_multipliers;

pub use contact_set::DiscreteContact;
pub(crate) use difference::contact_difference;

use std::ops::Range;

use super::errors::ContactErrors;
use crate::algebra::{Bound, Contact, Inequality};
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::error::Error;
use crate::inequality::Solution;
use crate::instances::compiled;
use crate::parallel::cells;
use crate::parallel::vectors::collect;
use crate::real::Point;
use entity::ContactEntity;
pub(super) use entity::SolvedInequality;

/// A Dirichlet datum this close to a bound, in units of the largest unknown, touches it.
const TOUCHING: f64 = 1e-9;

impl<const D: usize> Discretisation<'_, D> {
    /// Distances of multiplier and contact set of a solution from the exact ones; none where these
    /// are not known, or where an obstacle and a contact boundary bind at once.
    ///
    /// *Multiplier.* The residual of a constrained unknown in contact is its nodal multiplier. Each
    /// is divided equally among the vertices whose barycentre is the unknown's node; for every
    /// element here the sum at a vertex is then the residual tested with the hat function `phi` of
    /// that vertex, whatever the unknowns. Over the integral of `phi` it is a density, and so is
    /// the exact multiplier tested with `phi`. Their difference is measured in L1 and in L2, with
    /// the integral of `phi` as the weight of its vertex (the lumped norms of piecewise linear
    /// functions), over the vertices off the Dirichlet boundary. These are weaker than norms of the
    /// multiplier itself: nodal multipliers of over-penalised schemes that cancel within a patch
    /// have no effect. In general only the norm dual to the energy norm is bounded by the energy
    /// error (A. Veeser, SIAM J. Numer. Anal. 39 (2001), 146-167). With an obstacle the exact
    /// density jumps across the free boundary, so that every scheme is wrong by the size of the
    /// jump in a layer of width `h`: the L1 norm can be of order one, the L2 norm of one half at
    /// best.
    ///
    /// *Contact set.* A vertex, edge or facet is in contact if some unknown there is: on both sides of a facet, in
    /// all cells at a vertex. The nodal multipliers of a discontinuous scheme there need not all have the sign of
    /// their sum (those of over-penalised schemes on curved obstacles do not). On the Dirichlet boundary, where some
    /// schemes have no unknowns and others satisfy the datum approximately, it is in contact if the datum is. A cell,
    /// or a facet of the contact boundary, is in contact if all its unknowns are that have bounds and basis functions
    /// with a positive mean over it (those of quadratics at vertices of triangles and tetrahedra have none); where no
    /// unknown has both, if all its unknowns with bounds are; `docs/conventions.md` says where this set is too small.
    /// The area error is the measure of the symmetric difference with the exact set. The distance is that of
    /// Hausdorff between the points that state the exact free boundary and the vertices of cells in contact and of
    /// others.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`], [`Error::Parameter`] unless the solution has one value for each unknown.
    pub fn contact_errors(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
    ) -> Result<ContactErrors, Error> {
        self.check_length(&solution.values)?;
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &Inequality<f64>,
                &Solution<f64>,
            ) -> Result<ContactErrors, Error>
                = |of, inequality, solution| of.space.contact_errors((inequality, solution))
        )(self, inequality, solution)
    }

    /// The measure of the discrete contact set: the volume of the cells in contact where there are
    /// obstacles, else the area of the facets in contact (the number of points in one dimension), with the
    /// definitions of [`Discretisation::contact_errors`]; contact with friction is stick. None without an inequality.
    pub fn contact_measure(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
    ) -> Option<f64> {
        self.demand_length(&solution.values);
        self.contact_measure_of(inequality, solution, &|_| true)
    }

    /// The measure of the contact set on the cells for which `counts` is true, or on their facets.
    pub(crate) fn contact_measure_of(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
        counts: &dyn Fn(usize) -> bool,
    ) -> Option<f64> {
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &Inequality<f64>,
                &Solution<f64>,
                &dyn Fn(usize) -> bool,
            ) -> Option<f64>
                = |of, inequality, solution, counts| {
                    of.space.contact_measure((inequality, solution), counts)
                }
        )(self, inequality, solution, counts)
    }

    /// The total contact force, of all obstacles and gaps: the multiplier tested with the function one, which is the
    /// sum of the entries of `A u - b` at the constrained unknowns in contact, because every unknown is the value or a
    /// mean of the function. It is positive where a lower bound pushes upward. None without an inequality, and
    /// where rounding leaves no digit. Nodes with weakly imposed Dirichlet data do not count: where an obstacle
    /// equals the datum, their entries contain the flux through the boundary.
    ///
    /// Where only contact holds the body, without Dirichlet boundary and reaction, it is the negative of the
    /// total load, for every scheme: constants have no energy. It approximates the integral of the
    /// multiplier over domain and contact boundary.
    pub fn resultant(&self, inequality: &Inequality<f64>, solution: &Solution<f64>) -> Option<f64> {
        self.multipliers(inequality, solution).map(|multipliers| multipliers.iter().sum())
    }

    /// By unknown the force of its active bound: see [`Discretisation::resultant`].
    pub fn multipliers(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
    ) -> Option<Vec<f64>> {
        self.demand_length(&solution.values);
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &Inequality<f64>,
                &Solution<f64>,
            ) -> Option<Vec<f64>>
                = |of, inequality, solution| {
                    let multipliers = || of.space.nodal_multipliers((inequality, solution));
                    of.problem().is_constrained().then(multipliers).flatten()
                }
        )(self, inequality, solution)
    }
}

impl<const D: usize> Space<'_, D> {
    fn contact_errors(&self, solved: SolvedInequality<'_>) -> Result<ContactErrors, Error> {
        let mut errors = ContactErrors::default();
        let Some(exact) = &self.problem.exact else { return Ok(errors) };
        let is_known = exact.multiplier.is_some() || exact.contact.is_some();
        // with both an obstacle and a contact boundary there are two multipliers of different kind
        if !is_known || self.problem.has_obstacle() == self.problem.acts_on_boundary() {
            return Ok(errors);
        }
        let entities = self.entities();
        let on_entities = self.exact_contact(exact, &entities)?;
        let measures = self.measures_of(&entities);
        if exact.multiplier.is_some() {
            let of_entities = (&entities[..], &measures[..]);
            [errors.multiplier_l1, errors.multiplier_l2] =
                self.multiplier_errors(of_entities, &on_entities, solved);
        }
        if let Some(set) = &exact.contact {
            let touching = self.in_contact(&entities, solved);
            let states = measures.iter().zip(&touching).zip(&on_entities);
            let wrong = states
                .map(|((measure, touches), exact)| exact.shares[usize::from(!touches)] * measure);
            errors.contact_area_error = Some(wrong.sum());
            errors.free_boundary_distance = self.free_boundary_distance(set, &entities, &touching);
        }
        Ok(errors)
    }

    fn contact_measure(
        &self,
        solved: SolvedInequality<'_>,
        counts: &dyn Fn(usize) -> bool,
    ) -> Option<f64> {
        let mut entities = self.problem.is_constrained().then(|| self.entities())?;
        entities.retain(|entity| counts(entity.cell));
        let touching = self.in_contact(&entities, solved);
        let measures = self.measures_of(&entities);
        let in_contact = measures.iter().zip(touching).filter(|(_, touches)| *touches);
        Some(in_contact.fold(0.0, |sum, (measure, _)| sum + measure))
    }

    fn entities(&self) -> Vec<ContactEntity> {
        if self.problem.has_obstacle() {
            let is_bounded = |cell: &usize| {
                let region = self.mesh.region(*cell);
                self.data.lower.of(region).is_some() || self.data.upper.of(region).is_some()
            };
            return (0..self.mesh.n_cells())
                .filter(is_bounded)
                .map(|cell| ContactEntity { cell, facet: None })
                .collect();
        }
        let facets = self.facets_of_forces();
        facets.map(|((cell, local), _)| ContactEntity { cell, facet: Some(local) }).collect()
    }

    /// The volumes of cells and the areas of facets.
    fn measures_of(&self, entities: &[ContactEntity]) -> Vec<f64> {
        collect(entities.len(), |k| {
            let geometry = self.mesh.geometry(entities[k].cell);
            match entities[k].facet {
                None => geometry.volume,
                Some(local) => geometry.facet_measure(local),
            }
        })
    }

    /// Corners of an entity in space; one point more than its dimension of them are used.
    fn corner_points(&self, entity: ContactEntity) -> [Point<D>; 4] {
        let mut points = [Point::zeros(); 4];
        for (point, k) in points.iter_mut().zip(entity.corners::<D>()) {
            *point = self.mesh.vertices()[self.mesh.cell(entity.cell)[k] as usize];
        }
        points
    }

    /// Which entities are in contact.
    fn in_contact(
        &self,
        entities: &[ContactEntity],
        (inequality, solution): SolvedInequality<'_>,
    ) -> Vec<bool> {
        // the locations where some unknown is in contact: vertices, and others sorted by their vertices
        let states = inequality.states_at_bounds(&solution.contact);
        let locations_of = |touches: &dyn Fn(usize) -> bool| {
            let mut vertices = vec![false; self.mesh.vertices().len()];
            let mut locations: Vec<&[u32]> = Vec::new();
            for k in (0..inequality.size()).filter(|&k| touches(k)) {
                match inequality.locations[k].vertices() {
                    _ if !inequality.bounds[k].is_inequality() => {}
                    &[v] => vertices[v as usize] = true,
                    several => locations.push(several),
                }
            }
            locations.sort_unstable();
            locations.dedup();
            (vertices, locations)
        };
        let at_bounds = locations_of(&|k| states[k] != Contact::Inactive);
        let has_friction = !inequality.kinks.is_empty();
        let at_kinks = has_friction.then(|| locations_of(&|k| states[k] != solution.contact[k]));
        let given = self.dirichlet_groups();
        let mut largest = [solution.values.iter().map(|u| u.abs()).fold(0.0, f64::max)];
        inequality.distribution().largest(&mut largest);
        let rounding = 64.0 * self.body_constants.rounding();
        let slack = largest[0] * TOUCHING.max(64.0 * solution.precision.epsilon()) + rounding;
        let support_touches = |entity: ContactEntity, unknown: usize| {
            let location = inequality.locations[unknown].vertices();
            let groups = location.iter().map(|&v| given[v as usize].map(|(group, _)| group));
            let rank = |group: &usize| self.data.dirichlet_rank[*group];
            let group = groups.clone().flatten().min_by_key(rank);
            if let Some(group) = group.filter(|_| groups.clone().all(|g| g.is_some())) {
                self.datum_touches(entity, group, location, slack)
            } else {
                let is_facet_of_friction = entity.facet.is_some_and(|local| {
                    let group = self.mesh.boundary_group(entity.cell, local);
                    group.is_some_and(|group| self.data.friction.of(group).is_some())
                });
                let of_friction = at_kinks.as_ref().filter(|_| is_facet_of_friction);
                let (vertices, locations) = of_friction.unwrap_or(&at_bounds);
                match location {
                    &[v] => vertices[v as usize],
                    several => locations.binary_search(&several).is_ok(),
                }
            }
        };
        let deciding = self.deciding_nodes();
        let state = |&entity: &ContactEntity| {
            // the list of the cell is the last one
            let nodes = &deciding[entity.facet.unwrap_or(D + 1)];
            let unknowns = nodes.iter().map(|&i| self.dofs.of(entity.cell, i));
            let mut unknowns =
                unknowns.filter(|&unknown| inequality.bounds[unknown] != Bound::Free).peekable();
            unknowns.peek().is_some() && unknowns.all(|unknown| support_touches(entity, unknown))
        };
        let states = |range: Range<usize>| entities[range].iter().map(state).collect::<Vec<_>>();
        cells::map(entities.len(), &states).concat()
    }

    /// Whether the Dirichlet datum of a boundary group at the barycentre of a location differs from a bound
    /// on an entity by at most the slack.
    fn datum_touches(
        &self,
        entity: ContactEntity,
        group: usize,
        location: &[u32],
        slack: f64,
    ) -> bool {
        let corner = |&v: &u32| self.mesh.vertices()[v as usize];
        let x = location.iter().map(corner).sum::<Point<D>>() / location.len() as f64;
        let region = self.mesh.region(entity.cell);
        let contact = entity.facet.and_then(|local| self.mesh.boundary_group(entity.cell, local));
        let gap = contact.and_then(|group| self.data.gap.of(group));
        let bounds = [self.data.lower.of(region), self.data.upper.of(region), gap];
        let place = contact.filter(|&group| self.data.friction.of(group).is_some());
        let place = place.map(|_| -self.body_constants.of_cell(entity.cell));
        let value = self.dirichlet_at(group, entity.cell, &x);
        let bounds = bounds.into_iter().flatten().map(|bound| self.at(bound, entity.cell, &x));
        bounds.chain(place).any(|bound| (value - bound).abs() <= slack)
    }
}

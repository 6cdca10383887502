//! An admissible function and a flux that belong to a discrete solution.

use std::cell::OnceCell;

use super::NoBound;
use super::contact_forces::NodeForce;
use super::exchange::ROUNDING;
use super::facet_forces::FacetForce;
use super::flux::Flux;
use crate::algebra::{Bound, Contact, Inequality};
use crate::arrays::map_entries;
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::assemble::stiffness::zero_local;
use crate::element::Entity;
use crate::inequality::{Solution, residual as residual_of};
use crate::instances::compiled;
use crate::measure::Counts;
use crate::mesh::{BoundaryCondition, Neighbour, Neighbours};
use crate::parallel::vectors::{collect, largest};

/// A continuous, piecewise linear or quadratic function within the constraints, and a flux of the space of
/// Raviart and Thomas of degree one less, whose normal component is single-valued but for forces of obstacles on facets:
/// what a bound on the error is computed from.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PrimalDualPair<const D: usize> {
    /// The degree of the function, one or two.
    pub degree: usize,
    /// The values of the function `v` at the vertices of the mesh and, for degree two, after them at the
    /// midpoints of its edges, in the order of `mesh::Edges`: means of the values of the
    /// discrete solution in the cells around, with the coefficient as weights, Dirichlet values on the
    /// Dirichlet boundary, moved into the constraints at all others; less the [constants](Discretisation::constants) of
    /// bodies, as the vectors of the inequality.
    pub function: Vec<f64>,
    /// For degree two, by cell the numbers of its edges.
    pub edges: Vec<u32>,
    /// The flux `q`, of degree one less.
    pub flux: Flux<D>,
    /// The forces of obstacles on facets, in ascending order of facets: the normal component of the flux jumps by them.
    pub forces: Vec<FacetForce>,
}

impl<const D: usize> Discretisation<'_, D> {
    /// The pair of a solution.
    ///
    /// *Broken linears.* The flux through a facet is minus the facet form tested with the function that is
    /// one in the cell and zero elsewhere: the discrete equations balance it with the load. Every form has
    /// such a flux, by its own integrand. *Crouzeix-Raviart.* The integral over a facet is half of the
    /// difference of the two cells' residuals at the unknown of the facet (L. D. Marini, SIAM J. Numer.
    /// Anal. 22 (1985), 493-496). *Conforming functions.* The flux with the least norm is added on the cells
    /// around each vertex (D. Braess, J. Schöberl, Math. Comp. 77 (2008), 651-672). On contact facets the
    /// flux is the contact force of the nodes on the facet. *Quadratics.* Facets have moments of degree zero
    /// and one; inside cells the divergence balances load and multiplier tested with linear functions.
    ///
    /// Where obstacles press on facets, multipliers of cells move there ([`PrimalDualPair::forces`]), if that makes the
    /// bound `discrete` smaller. Where obstacles bind, multipliers of cells are then exchanged for flux through the facets
    /// of the cells, and contact forces of quadratics between facets, which makes mismatch and complementarity smaller: see
    /// [`docs::bound`](crate::docs::bound).
    ///
    /// # Errors
    /// [`NoBound`].
    ///
    /// # Panics
    /// Unless the solution has one value for each unknown.
    pub fn primal_dual_pair(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
    ) -> Result<PrimalDualPair<D>, NoBound> {
        self.demand_length(&solution.values);
        self.check_flux()?;
        self.pair_of_cells(inequality, solution, &|_| true)
    }
    /// The pair of a solution for the cells that count: all, or on a part of a mesh, with linear functions, those of
    /// the part. Multipliers are exchanged between these alone. All parts call it.
    ///
    /// # Errors
    /// [`NoBound`].
    pub(crate) fn pair_of_cells(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
        counts: Counts<'_>,
    ) -> Result<PrimalDualPair<D>, NoBound> {
        match inequality.is_in_parts() && self.space.degree == 1 {
            true => self.check_element()?,
            false => self.check_flux()?,
        }
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &Inequality<f64>,
                &Solution<f64>,
                Counts<'_>,
            ) -> Result<PrimalDualPair<D>, NoBound>
                = |of, inequality, solution, counts| of.pair(inequality, solution, counts)
        )(self, inequality, solution, counts)
    }
    /// A pair of linears with another function of values at vertices, moved into the constraints, beside the same flux.
    pub(crate) fn with_function(
        &self,
        pair: &PrimalDualPair<D>,
        values: &[f64],
    ) -> PrimalDualPair<D> {
        let mut function = values.to_vec();
        self.space.clip_at_vertices(&mut function);
        PrimalDualPair { function, ..pair.clone() }
    }
    /// Checks that a flux is known for the element: broken and conforming linears and quadratics, and
    /// that of Crouzeix and Raviart, and that the mesh is a whole one.
    ///
    /// # Errors
    /// [`NoBound::Element`], [`NoBound::Part`].
    pub(crate) fn check_flux(&self) -> Result<(), NoBound> {
        self.check_element()?;
        if self.space.mesh.is_part() { Err(NoBound::Part) } else { Ok(()) }
    }
    fn check_element(&self) -> Result<(), NoBound> {
        let space = &self.space;
        let is_linear = space.basis_degree == 1 && space.gradient_factor().is_some();
        let has_means = || !space.broken && space.nodes.iter().all(|node| node.is_facet_mean());
        let is_known = match space.degree {
            1 => is_linear && (self.owns_rows() || space.is_conforming_linear() || has_means()),
            2 => space.basis_degree == 2 && (self.owns_rows() || space.is_conforming_quadratic()),
            _ => false,
        };
        if is_known { Ok(()) } else { Err(NoBound::Element) }
    }
    /// The pair with forces of obstacles on facets where its bound `discrete` is smaller, else that without.
    fn pair(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
        counts: Counts<'_>,
    ) -> Result<PrimalDualPair<D>, NoBound> {
        let (space, u) = (&self.space, &solution.values[..]);
        let jump_multipliers = inequality.penalised.as_ref().map(|p| {
            match solution.jump_multipliers.len() == p.n_jumps() {
                true => solution.jump_multipliers.clone(),
                false => p.jump_multipliers(|i| u[i]),
            }
        });
        let mut residual = vec![0.0; space.dofs.size()];
        residual_of(inequality, u, &solution.jump_multipliers, &mut residual);
        inequality.distribution().update(&mut residual);
        let bounds = &inequality.own_bounds()[..];
        let contact = &inequality.states_at_bounds(&solution.contact)[..];
        let obstacles = &space.active_obstacles(bounds, contact);
        let friction = take_friction(inequality, &solution.contact, &mut residual);
        let mut forces = space.contact_forces(bounds, contact, (&residual, obstacles), u);
        forces.extend(space.friction_forces(inequality, &friction, u)?);
        for (kink, force) in inequality.kinks.iter().zip(&friction) {
            residual[kink.unknown as usize] -= force;
        }
        let (of_solver, forces) = ((&residual[..], obstacles), &forces);
        let computed = OnceCell::new();
        let neighbours = match &space.neighbours {
            Some(neighbours) => neighbours,
            None => computed.get_or_init(|| Neighbours::new(space.mesh)),
        };
        let found = Found {
            u,
            inequality,
            bounds,
            contact,
            jump_multipliers: jump_multipliers.as_deref(),
            of_solver,
            forces,
            neighbours,
        };
        let pair = space.admissible_function(u, (bounds, contact));
        let with_flux = |on_facets: bool| match space.degree {
            2 => self.with_flux_of_quadratics(pair.clone(), &found, on_facets),
            _ => self.with_flux_of_linears(pair.clone(), &found, counts, on_facets),
        };
        let with = with_flux(true)?;
        if with.forces.is_empty() {
            return Ok(with);
        }
        // without this choice the bounds of quadratics on pyramid-2d at 4 are 1.4 times as large
        let without = with_flux(false)?;
        let is_better = space.discrete_bound(&with, u)? < space.discrete_bound(&without, u)?;
        Ok(if is_better { with } else { without })
    }

    /// The pair of a linear function; if `on_facets`, with forces of obstacles on facets.
    fn with_flux_of_linears(
        &self,
        mut pair: PrimalDualPair<D>,
        found: &Found<'_>,
        counts: Counts<'_>,
        on_facets: bool,
    ) -> Result<PrimalDualPair<D>, NoBound> {
        let space = &self.space;
        let &Found { u, of_solver, forces, neighbours, .. } = found;
        let has_obstacle = space.problem.has_obstacle();
        let by_unknown = match has_obstacle {
            true => space.multipliers_by_cell(of_solver, found.contact, forces),
            false => Vec::new(),
        };
        let n = space.per_cell();
        let of_cell = |cell: usize| &by_unknown[cell * n..][..n];
        let centres: Vec<[f64; 4]> = space.nodes.iter().map(|node| node.centre(D)).collect();
        let tested = |cell: usize, own: usize| {
            let terms = of_cell(cell).iter().zip(&centres);
            [terms.map(|(multiplier, at)| multiplier * at[own]).sum(), 0.0, 0.0, 0.0]
        };
        let presses = |cell: usize| of_cell(cell).iter().any(|m| *m != 0.0);
        let pressing = match has_obstacle && on_facets {
            true => space.pressing(&mut pair, (&tested, &presses), neighbours)?,
            false => None,
        };
        pair.flux = if self.owns_rows() {
            Flux::of_integrals(self.facet_fluxes(u, found.jump_multipliers, 1)?)
        } else if space.is_conforming_linear() {
            let forces = (forces, pressing.as_ref().map(|p| (p, &by_unknown[..])));
            space.flux_of_linears(u, of_solver, forces, neighbours)?
        } else {
            space.crouzeix_raviart_fluxes(u, of_solver.1)?
        };
        space.set_boundary_fluxes(forces, u, &mut pair.flux)?;
        if let Some(pressing) = &pressing {
            match space.is_conforming_linear() {
                true => add_boundary_forces(&mut pair),
                false => space.move_to_facets(&mut pair, pressing, &tested, neighbours),
            }
        }
        if has_obstacle {
            let sum = |cell: usize| of_cell(cell).iter().sum::<f64>();
            let mut multipliers = collect(space.mesh.n_cells(), sum);
            let largest = largest(multipliers.len(), |cell| multipliers[cell].abs());
            if let Some(pressing) = &pressing {
                let moved = pressing.moved_by_cell(space.mesh, &tested);
                multipliers.iter_mut().zip(moved).for_each(|(m, [moved, ..])| *m -= moved);
            }
            space.exchange_linears(&mut pair, (&multipliers, largest), (neighbours, counts));
        }
        Ok(pair)
    }

    /// The pair of a quadratic function; if `on_facets`, with forces of obstacles on facets.
    fn with_flux_of_quadratics(
        &self,
        mut pair: PrimalDualPair<D>,
        found: &Found<'_>,
        on_facets: bool,
    ) -> Result<PrimalDualPair<D>, NoBound> {
        let space = &self.space;
        let &Found { u, inequality, of_solver, forces, neighbours, .. } = found;
        // multipliers of jumps alone may contain a flux without divergence that alternates between facets
        // and that jumps hardly see: that of WOPSIP has an error of first order in the plane. Its
        // equations, tested with hat functions, are those of a conforming function
        let has_facet_fluxes = self.owns_rows() && inequality.penalised.is_none();
        let numbers = match has_facet_fluxes {
            true => None,
            false => space.node_numbers(&pair.edges),
        };
        let states = (found.bounds, found.contact);
        let loads = space.cell_loads(u, of_solver, states, forces, numbers)?;
        let known = match has_facet_fluxes {
            true => None,
            false => Some(space.known_cells(u, &pair)),
        };
        let tested = |cell: usize, own: usize| loads.multiplier_at(cell, own);
        let largest = largest(space.mesh.n_cells(), |cell| loads.strength(cell));
        let presses = |cell: usize| loads.strength(cell) > ROUNDING * largest;
        let pressing = match space.problem.has_obstacle() && on_facets {
            true => space.pressing(&mut pair, (&tested, &presses), neighbours)?,
            false => None,
        };
        let is_conforming = known.is_some();
        pair.flux = match known {
            None => space.flux_of_moments(&self.facet_fluxes(u, found.jump_multipliers, D)?),
            Some(known) => space.flux_of_quadratics(known, neighbours, &loads, pressing.as_ref()),
        };
        space.add_boundary_fluxes(&loads, &mut pair.flux);
        if let Some(pressing) = &pressing {
            match is_conforming {
                true => add_boundary_forces(&mut pair),
                false => space.move_to_facets(&mut pair, pressing, &tested, neighbours),
            }
        }
        let moved = pressing.map_or(Vec::new(), |p| p.moved_by_cell(space.mesh, &tested));
        space.balance((&loads, &moved), &mut pair.flux);
        if space.problem.has_obstacle() {
            space.exchange_quadratics(&mut pair, (&loads, &moved), neighbours);
        }
        if space.problem.has_gap() && D > 1 {
            space.exchange_forces(&mut pair, neighbours);
        }
        Ok(pair)
    }
}

/// What a solver found, and what follows from it.
struct Found<'f> {
    u: &'f [f64],
    inequality: &'f Inequality<f64>,
    /// Bounds and contact states, without kinks.
    bounds: &'f [Bound<f64>],
    contact: &'f [Contact],
    /// The multipliers of jumps of over-penalties.
    jump_multipliers: Option<&'f [f64]>,
    /// The residual, and which obstacles give active bounds.
    of_solver: (&'f [f64], &'f ActiveObstacles),
    /// The forces on contact facets.
    forces: &'f [NodeForce],
    neighbours: &'f Neighbours,
}

/// The forces of friction, by kink, and the residual without them: a kink that does not hold its unknown has its
/// largest force, and what exceeds that is rounding or what the solver left.
fn take_friction(
    inequality: &Inequality<f64>,
    contact: &[Contact],
    residual: &mut [f64],
) -> Vec<f64> {
    let mut take = |k: usize| {
        let (kink, slope) = (&inequality.kinks[k], inequality.slope_at(k));
        let rest = &mut residual[kink.unknown as usize];
        *rest += slope;
        let sticks = inequality.sticks(k, contact);
        let force = if sticks { (-*rest).clamp(-kink.slope, kink.slope) } else { -slope };
        *rest += force;
        force
    };
    (0..inequality.kinks.len()).map(&mut take).collect()
}

/// Adds the forces of a pair on the boundary to its flux.
fn add_boundary_forces<const D: usize>(pair: &mut PrimalDualPair<D>) {
    for force in pair.forces.iter().filter(|force| force.other.is_none()) {
        let (cell, local) = force.facet;
        pair.flux.add_densities(cell, local, &force.densities);
    }
}

impl<const D: usize> Space<'_, D> {
    /// Sets the fluxes through the boundary but for the Dirichlet boundary: Neumann data and contact forces. Residuals
    /// there are multipliers, and sums of patches are rounding, which may have the wrong sign for a contact force.
    fn set_boundary_fluxes(
        &self,
        forces: &[NodeForce],
        u: &[f64],
        flux: &mut Flux<D>,
    ) -> Result<(), NoBound> {
        for f in self.mesh.boundary().iter().filter(|f| f.condition != BoundaryCondition::Dirichlet)
        {
            flux.set_zero_on(f.cell as usize, f.local.into());
        }
        if self.problem.has_neumann_data() {
            for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Neumann) {
                flux.add_through(cell, local, self.neumann_flux((cell, local), group, u)?);
            }
        }
        for force in forces {
            flux.add_through(force.cell, force.local, force.value);
        }
        Ok(())
    }

    /// Stiffness and reaction of a cell at the values of a function, less its load: one number for each
    /// unknown of the cell.
    fn cell_residual(&self, cell: usize, u: &[f64], load: &[f64]) -> [f64; 4] {
        let gradient = self.gradient_factor().unwrap_or(1.0);
        let scale = self.alpha(cell) * gradient * gradient;
        let values = self.local_values(cell, u);
        let (volume, products) = self.shape(cell, 1.0);
        let mut residual = self.reaction_less_load(cell, volume, &values, load);
        for (residual, products) in residual.iter_mut().zip(&products).take(D + 1) {
            // gradients sum to zero: without their common value a constant adds no rounding
            *residual +=
                (1..=D).map(|j| scale * products[j] * (values[j] - values[0])).sum::<f64>();
        }
        residual
    }

    /// The reaction of a cell at the values of a function, less its load.
    pub(super) fn reaction_less_load(
        &self,
        cell: usize,
        volume: f64,
        values: &[f64],
        load: &[f64],
    ) -> [f64; 4] {
        let mut left = [0.0; 4];
        if let Some(reaction) = &self.reaction {
            let mut products = zero_local();
            reaction.add(self.mesh, cell, volume, &mut products);
            for (left, products) in left.iter_mut().zip(&products).take(D + 1) {
                *left = products.iter().zip(values).map(|(product, value)| product * value).sum();
            }
        }
        // without sources the list is empty
        let load = load.iter().skip(cell * (D + 1));
        left[..=D].iter_mut().zip(load).for_each(|(left, load)| *left -= load);
        left
    }

    /// The fluxes of the element of Crouzeix and Raviart, without those of Neumann data and contact. Of two cells that
    /// both carry a share of the multiplier of their facet, or neither, each has half of it.
    fn crouzeix_raviart_fluxes(
        &self,
        u: &[f64],
        obstacles: &ActiveObstacles,
    ) -> Result<Flux<D>, NoBound> {
        let load = self.load_by_cell()?;
        let n_cells = self.mesh.n_cells();
        let mut own = vec![0.0; n_cells * (D + 1)];
        let mut unknown_of_facet = [0; 4];
        for (i, node) in self.nodes.iter().enumerate() {
            if let Entity::Facet(local) = node.entity() {
                unknown_of_facet[local] = i;
            }
        }
        for (cell, own) in own.chunks_exact_mut(D + 1).enumerate() {
            let residual = self.cell_residual(cell, u, &load);
            for (own, &i) in own.iter_mut().zip(&unknown_of_facet) {
                *own = residual[i];
            }
        }
        let mut flux = own.clone();
        for cell in 0..n_cells {
            for local in 0..=D {
                if let Neighbour::Cell { cell: other, local: there } =
                    self.coupled_neighbours().across(cell, local)
                {
                    let facet = cell * (D + 1) + local;
                    let facet_there = other as usize * (D + 1) + there as usize;
                    let act = map_entries([(cell, local), (other as usize, there as usize)], {
                        |(cell, local)| obstacles.act_in(cell, unknown_of_facet[local])
                    });
                    flux[facet] = match act {
                        [true, false] => -own[facet_there],
                        [false, true] => own[facet],
                        _ => 0.5 * (own[facet] - own[facet_there]),
                    };
                }
            }
        }
        Ok(Flux::of_integrals(flux))
    }
}

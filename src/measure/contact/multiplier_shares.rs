//! Multipliers divided among the data that give the active bounds, and among the cells and facets on which these act.

use std::collections::BTreeMap;

use super::entity::{ContactEntity, SolvedInequality};
use crate::algebra::{Bound, Contact, Inequality};
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::assemble::space::active_obstacles::ActiveObstacles;
use crate::inequality::Solution;
use crate::instances::compiled;
use crate::mesh::{BoundaryCondition, HalfFacet};

/// The share of the multiplier of an unknown that acts on one of several cells or contact facets.
#[derive(Clone, Copy, Debug)]
struct Share {
    /// The position of the cell or facet in the list of cells or of contact facets.
    place: usize,
    unknown: usize,
    value: f64,
}

/// Multipliers in contact by unknown, and which of them obstacles have.
pub(crate) struct Multipliers {
    /// Of obstacles and gaps.
    by_unknown: Vec<f64>,
    /// Of friction, by kink.
    friction: Vec<f64>,
    obstacles: ActiveObstacles,
}

/// Which unknowns and which cells count: all, or those of a part of a mesh.
type Own<'c> = [&'c dyn Fn(usize) -> bool; 2];

impl<const D: usize> Discretisation<'_, D> {
    /// The resultant of each obstacle (`lower`, `upper`) and of each contact group by its name; their sum is that of
    /// all ([`Discretisation::resultant`]). The multiplier of an unknown belongs to the datum that gives its active
    /// bound: where obstacle and gap are equal to the obstacle, where gaps of several groups are, to each by the
    /// measure of its facets there. None without an inequality, and where rounding leaves no digit.
    pub fn resultants(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
    ) -> Option<BTreeMap<String, f64>> {
        self.demand_length(&solution.values);
        self.resultants_of(inequality, solution, [&|_| true, &|_| true])
    }

    /// The resultants of the unknowns and, for contact groups, of the facets of cells that count.
    pub(crate) fn resultants_of(
        &self,
        inequality: &Inequality<f64>,
        solution: &Solution<f64>,
        own: Own<'_>,
    ) -> Option<BTreeMap<String, f64>> {
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &Inequality<f64>,
                &Solution<f64>,
                Own<'_>,
            ) -> Option<BTreeMap<String, f64>>
                = |of, inequality, solution, own| of.space.resultants((inequality, solution), own)
        )(self, inequality, solution, own)
    }
}

impl<const D: usize> Space<'_, D> {
    fn resultants(
        &self,
        solved: SolvedInequality<'_>,
        [of_unknowns, of_cells]: Own<'_>,
    ) -> Option<BTreeMap<String, f64>> {
        if !self.problem.is_constrained() {
            return None;
        }
        let mut sums: BTreeMap<String, f64> =
            self.names_of_resultants().into_iter().map(|name| (name, 0.0)).collect();
        let multipliers = self.multipliers(solved)?;
        let (inequality, solution) = solved;
        for (unknown, value) in multipliers.by_unknown.iter().enumerate() {
            if *value != 0.0 && multipliers.obstacles.act_at(unknown) && of_unknowns(unknown) {
                let is_upper = solution.contact[unknown] == Contact::Upper;
                let name = if is_upper { "upper" } else { "lower" };
                *sums.entry(name.to_owned()).or_default() += value;
            }
        }
        let names: Vec<String> =
            (0..self.mesh.boundary_groups().len()).map(|group| self.name_of_gap(group)).collect();
        let facets: Vec<(HalfFacet, usize)> = self.facets_of_forces().collect();
        for share in self.shares_on_boundary(inequality, &multipliers) {
            let ((cell, _), group) = facets[share.place];
            if of_cells(cell) {
                *sums.entry(names[group].clone()).or_default() += share.value;
            }
        }
        Some(sums)
    }

    /// By boundary group the contact force on its facets; none where rounding leaves no digit.
    pub(in crate::measure) fn forces_of_groups(
        &self,
        solved: SolvedInequality<'_>,
    ) -> Option<Vec<f64>> {
        let multipliers = self.multipliers(solved)?;
        let facets: Vec<_> = self.facets_of_forces().collect();
        let mut forces = vec![0.0; self.mesh.boundary_groups().len()];
        for share in self.shares_on_boundary(solved.0, &multipliers) {
            forces[facets[share.place].1] += share.value;
        }
        Some(forces)
    }

    /// The shares of forces on all facets that can be in contact: of gaps and of friction.
    fn shares_on_boundary(&self, inequality: &Inequality<f64>, of: &Multipliers) -> Vec<Share> {
        let mut shares = self.shares_of_gaps(&inequality.bounds, of);
        if !inequality.kinks.is_empty() {
            self.add_shares_of_friction(inequality, of, &mut shares);
        }
        shares
    }

    /// The shares of the forces of friction: that of an unknown by its weights on the facets.
    fn add_shares_of_friction(
        &self,
        inequality: &Inequality<f64>,
        of: &Multipliers,
        shares: &mut Vec<Share>,
    ) {
        for (place, (facet, group)) in self.facets_of_forces().enumerate() {
            let weights = self.friction_weights(facet, group);
            for (node, weight) in weights.expect("the assembly found weights") {
                let unknown = self.dofs.of(facet.0, node);
                if let Some(k) = inequality.kink_of(unknown) {
                    let value = of.friction[k] * (weight / inequality.kinks[k].slope);
                    shares.push(Share { place, unknown, value });
                }
            }
        }
    }

    /// The names of all resultants: the same on all parts of a mesh.
    fn names_of_resultants(&self) -> Vec<String> {
        let obstacles = [("lower", &self.data.lower), ("upper", &self.data.upper)];
        let given = obstacles.into_iter().filter(|(_, data)| data.is_given());
        let mut names: Vec<String> = given.map(|(name, _)| name.to_owned()).collect();
        for (group, of_group) in self.mesh.boundary_groups().iter().enumerate() {
            let is_contact = of_group.condition == Some(BoundaryCondition::Contact);
            let has_friction = self.data.friction.of(group).is_some();
            if is_contact && self.data.gap.of(group).is_some() || has_friction {
                names.push(self.name_of_gap(group));
            }
        }
        names
    }

    /// The name under which the contact force of a boundary group is shown.
    fn name_of_gap(&self, group: usize) -> String {
        let names = &self.mesh.boundary_groups()[group].names;
        let given = self.problem.gap.names().chain(self.problem.friction.names());
        let mut given = given.chain(names.iter().map(String::as_str));
        match given.find(|name| names.iter().any(|n| n == name)) {
            None => "contact".to_owned(),
            Some(name @ ("lower" | "upper")) => format!("{name} (contact)"),
            Some(name) => name.to_owned(),
        }
    }

    /// The multipliers of a solution, none where rounding leaves no digit; all parts of a mesh call it.
    pub(crate) fn multipliers(&self, solved: SolvedInequality<'_>) -> Option<Multipliers> {
        let (inequality, contact) = (solved.0, &solved.1.contact);
        let mut by_unknown = self.nodal_multipliers(solved)?;
        // a kink that does not hold its unknown has its largest force
        let mut share = |k: usize| {
            let all = &mut by_unknown[inequality.kinks[k].unknown as usize];
            let own = if inequality.sticks(k, contact) { *all } else { -inequality.slope_at(k) };
            let friction = if *all == 0.0 { 0.0 } else { own };
            *all -= friction;
            friction
        };
        let friction = (0..inequality.kinks.len()).map(&mut share).collect();
        let states = inequality.states_at_bounds(contact);
        let obstacles = self.active_obstacles(&inequality.own_bounds(), &states);
        Some(Multipliers { by_unknown, friction, obstacles })
    }

    /// The shares of the multipliers of obstacles in all cells: that of a shared unknown by volume among the cells
    /// whose obstacle gives the bound.
    fn shares_of_obstacles(&self, of: &Multipliers) -> Vec<Share> {
        let n_cells = self.mesh.n_cells();
        let volume = |cell: usize| self.mesh.geometry(cell).volume;
        let acting = |cell: usize| {
            let unknowns = (0..self.per_cell()).map(move |i| (i, self.dofs.of(cell, i)));
            let presses = |unknown: usize| of.by_unknown[unknown] != 0.0;
            unknowns
                .filter(move |(_, k)| presses(*k) && of.obstacles.act_at(*k))
                .filter(move |(i, _)| of.obstacles.act_in(cell, *i))
                .map(|(_, unknown)| unknown)
        };
        let mut totals = vec![0.0; of.by_unknown.len()];
        for cell in 0..n_cells {
            acting(cell).for_each(|unknown| totals[unknown] += volume(cell));
        }
        let mut shares = Vec::new();
        for cell in 0..n_cells {
            shares.extend(acting(cell).map(|unknown| {
                let value = of.by_unknown[unknown] * (volume(cell) / totals[unknown]);
                Share { place: cell, unknown, value }
            }));
        }
        shares
    }

    /// The shares of the multipliers of gaps on all contact facets: by measure among the facets whose gap gives the
    /// bound.
    fn shares_of_gaps(&self, bounds: &[Bound<f64>], of: &Multipliers) -> Vec<Share> {
        let terms = self.node_terms(&self.facet_rule);
        let mut shares = Vec::new();
        // of each unknown whether a gap gives the bound, and the measure of its facets with the best answer
        let mut best = vec![(false, 0.0); if self.problem.has_gap() { bounds.len() } else { 0 }];
        let mut gives_of_share = Vec::new();
        let facets = self.grouped_facets_of(BoundaryCondition::Contact).enumerate();
        for (place, ((cell, local), group)) in
            facets.filter(|(_, (_, group))| self.data.gap.of(*group).is_some())
        {
            let measure = self.facet_measure((cell, local));
            for node in self.bounded_nodes_on(local) {
                let unknown = self.dofs.of(cell, node.0);
                if of.by_unknown[unknown] == 0.0 || of.obstacles.act_at(unknown) {
                    continue;
                }
                let gives = self.gap_gives(((cell, local), group), node, &terms, bounds[unknown]);
                match &mut best[unknown] {
                    (of_best, all) if *of_best == gives => *all += measure,
                    lower if gives => *lower = (true, measure),
                    _ => {}
                }
                shares.push(Share { place, unknown, value: measure });
                gives_of_share.push(gives);
            }
        }
        for (share, gives) in shares.iter_mut().zip(gives_of_share) {
            let (of_best, all) = best[share.unknown];
            let fraction = if gives == of_best { share.value / all } else { 0.0 };
            share.value = fraction * of.by_unknown[share.unknown];
        }
        shares
    }

    /// The density of the multipliers of obstacles in each cell, by regions where obstacles have names.
    pub(crate) fn densities_of_obstacles(
        &self,
        inequality: &Inequality<f64>,
        of: &Multipliers,
    ) -> Vec<f64> {
        let by_region = self.data.lower.has_names() || self.data.upper.has_names();
        let group = |cell: usize| if by_region { self.mesh.region(cell) } else { 0 };
        let entity = |cell: usize| (ContactEntity { cell, facet: None }, group(cell));
        let cells = (0..self.mesh.n_cells()).map(entity);
        self.densities(&cells.collect::<Vec<_>>(), &self.shares_of_obstacles(of), inequality)
    }

    /// The density of the multipliers of gaps and of friction on each facet that can be in contact, by groups.
    pub(crate) fn densities_on_boundary(
        &self,
        inequality: &Inequality<f64>,
        of: &Multipliers,
    ) -> Vec<f64> {
        let entity = |(cell, local)| ContactEntity { cell, facet: Some(local) };
        let facets = self.facets_of_forces().map(|(facet, group)| (entity(facet), group));
        let shares = self.shares_on_boundary(inequality, of);
        self.densities(&facets.collect::<Vec<_>>(), &shares, inequality)
    }

    /// The density of multipliers on cells or on facets, group by group: the mean over their vertices of what acts on
    /// the group there, each share divided equally among the vertices around its node, over the integrals of the hat
    /// functions on the group.
    fn densities(
        &self,
        places: &[(ContactEntity, usize)],
        shares: &[Share],
        inequality: &Inequality<f64>,
    ) -> Vec<f64> {
        let mut groups: Vec<usize> = places.iter().map(|(_, group)| *group).collect();
        groups.sort_unstable();
        groups.dedup();
        let mut densities = vec![0.0; places.len()];
        for group in groups {
            let of_group: Vec<usize> =
                (0..places.len()).filter(|&k| places[k].1 == group).collect();
            let entities: Vec<ContactEntity> = of_group.iter().map(|&k| places[k].0).collect();
            let mut at_vertices = vec![0.0; self.mesh.vertices().len()];
            for share in shares.iter().filter(|share| places[share.place].1 == group) {
                let around = inequality.locations[share.unknown].vertices();
                let at_vertex = share.value / around.len() as f64;
                around.iter().for_each(|&v| at_vertices[v as usize] += at_vertex);
            }
            let hats = self.hat_integrals(&entities, &self.measures_of(&entities));
            at_vertices.iter_mut().zip(hats).for_each(|(density, hat)| *density /= hat);
            for (&k, entity) in of_group.iter().zip(&entities) {
                let corners = entity.corners::<D>().map(|c| self.mesh.cell(entity.cell)[c]);
                let sum: f64 = corners.map(|v| at_vertices[v as usize]).sum();
                densities[k] = sum / (entity.dimension::<D>() + 1) as f64;
            }
        }
        densities
    }
}

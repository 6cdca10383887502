//! Bodies that neither Dirichlet data, Robin sides nor a reaction hold, with the resultants of their data.
//!
//! A body is a set of cells that are connected through facets, whatever the scheme. Its resultant is the integral of
//! source and Neumann data, by the finer of two rules that are the same for every scheme. Where it is at most twice
//! the difference of both, or rounding, the data as integrated do not tell it from zero: it is undecided.

use std::ops::Range;
use std::slice::from_ref;

use super::cut_simplices::CutRule;
use super::space::{Space, checks};
use super::stiffness::zero_local;
use crate::algebra::{FreeBody, NO_INDEX, RESULTANT_ROUNDING, Sum};
use crate::error::Error;
use crate::mesh::{BoundaryCondition, Components, Neighbours};
use crate::parallel::cells;
use crate::problem::Datum;
use crate::quadrature::Rule;

/// The degrees of the two rules on facets.
const FACET_DEGREES: [usize; 2] = [15, 19];

/// The degrees of the two rules on cells of a dimension. On a cell in which a source jumps the errors of both have any
/// sign. They agree by chance, so that their difference hides them, for none of 128 jumps on meshes of the line with
/// these degrees (six with 7 and 13), and for one of 56 in the plane (eight with 7 and 15).
const fn cell_degrees(dimension: usize) -> [usize; 2] {
    match dimension {
        1 => [7, 41],
        _ => [7, 13],
    }
}

/// The bodies of a mesh that neither Dirichlet data, Robin sides nor a reaction hold.
#[derive(Default)]
pub(crate) struct FreeBodies {
    /// The body of each cell; none if it is held. Empty if there are no free bodies.
    of_cell: Vec<u32>,
    /// The bodies; [`FreeBody::kernel`] is not set yet.
    pub bodies: Vec<FreeBody>,
    measures: Vec<f64>,
}

impl FreeBodies {
    /// The body of a cell; none if it is held.
    pub fn of(&self, cell: usize) -> Option<usize> {
        self.of_cell.get(cell).filter(|&&body| body != NO_INDEX).map(|&body| body as usize)
    }
}

/// Integrals by the coarse and the fine rule, and the integral of absolute values by the fine one.
type Integrals = [f64; 3];

struct CellRules {
    rules: [Rule; 2],
    /// Where a datum has a level: the rules on cells that its zero set cuts.
    cut: Option<[CutRule; 2]>,
}

/// Adds a weighted value at a point of rule `k`.
fn add(integrals: &mut Integrals, k: usize, term: f64) {
    integrals[k] += term;
    if k == 1 {
        integrals[2] += term.abs();
    }
}

impl<const D: usize> Space<'_, D> {
    /// The free bodies with their resultants. A part of a mesh does not know the bodies of the whole and has none.
    pub fn free_bodies(&self) -> Result<FreeBodies, Error> {
        if self.mesh.is_supported() || self.mesh.is_part() {
            return Ok(FreeBodies::default());
        }
        let mut bodies = self.find_bodies();
        if !bodies.bodies.is_empty() {
            self.find_stops(&mut bodies);
            self.integrate_resultants(&mut bodies)?;
        }
        Ok(bodies)
    }

    /// The bodies of the mesh without those that a Dirichlet facet or a reaction holds.
    fn find_bodies(&self) -> FreeBodies {
        let mesh = self.mesh;
        let own;
        let neighbours = match &self.neighbours {
            Some(neighbours) => neighbours,
            None => {
                own = Neighbours::new(mesh);
                &own
            }
        };
        let mut components = Components::of_cells(neighbours);
        let mut is_held = vec![false; mesh.n_cells()];
        for (cell, _) in self.facets_of(BoundaryCondition::Dirichlet) {
            is_held[components.find(cell)] = true;
        }
        let constants = self.constants();
        for cell in 0..mesh.n_cells() {
            let root = components.find(cell);
            is_held[root] = is_held[root] || self.reaction_of(cell, &constants) != 0.0;
        }
        let mut bodies = FreeBodies::default();
        let mut of_cell = vec![NO_INDEX; mesh.n_cells()];
        for cell in 0..mesh.n_cells() {
            // the root is the first cell of its component
            let root = components.find(cell);
            if is_held[root] {
                continue;
            }
            if root == cell {
                of_cell[cell] = bodies.bodies.len() as u32;
                bodies.bodies.push(FreeBody::unloaded());
                bodies.measures.push(0.0);
            }
            of_cell[cell] = of_cell[root];
            bodies.measures[of_cell[cell] as usize] += mesh.geometry(cell).volume;
        }
        bodies.of_cell = of_cell;
        bodies
    }

    /// The values of the unknowns of a cell of the constant one.
    pub fn constants(&self) -> Vec<f64> {
        let terms = self.node_terms(&Rule::new(D - 1, 1));
        terms.iter().map(|terms| terms.iter().map(|(_, w)| w).sum()).collect()
    }

    /// The reaction term of the constant one on a cell.
    pub fn reaction_of(&self, cell: usize, constants: &[f64]) -> f64 {
        let Some(reaction) = &self.reaction else { return 0.0 };
        let mut local = zero_local();
        reaction.add(self.mesh, cell, self.mesh.geometry(cell).volume, &mut local);
        let row = |i: usize| -> f64 {
            let terms = constants.iter().enumerate();
            terms.map(|(j, c)| local[i][j] * *c * constants[i]).sum()
        };
        (0..constants.len()).map(row).sum()
    }

    /// Which bounds stop each body.
    fn find_stops(&self, bodies: &mut FreeBodies) {
        for cell in 0..self.mesh.n_cells() {
            let Some(body) = bodies.of(cell) else { continue };
            let (body, region) = (&mut bodies.bodies[body], self.mesh.region(cell));
            body.stops_below |= self.data.lower.of(region).is_some();
            body.stops_above |= self.data.upper.of(region).is_some();
        }
        for ((cell, _), group) in self.grouped_facets_of(BoundaryCondition::Contact) {
            if let (Some(body), Some(_)) = (bodies.of(cell), self.data.gap.of(group)) {
                bodies.bodies[body].stops_below = true;
            }
        }
    }

    /// Sets the resultants and their uncertainties.
    fn integrate_resultants(&self, bodies: &mut FreeBodies) -> Result<(), Error> {
        let n_cells = self.mesh.n_cells();
        let mut by_cell: Vec<Integrals> = vec![[0.0; 3]; n_cells];
        let has_level = self.data.source.any(&|f| f.level().is_some());
        let rules = CellRules {
            rules: cell_degrees(D).map(|degree| Rule::new(D, degree)),
            cut: has_level.then(|| cell_degrees(D).map(|degree| CutRule::new(D, degree))),
        };
        let integrate = |cells: Range<usize>, integrals: &mut [Integrals]| -> Result<(), Error> {
            for (cell, integrals) in cells.zip(integrals) {
                let source = self.data.source.of(self.mesh.region(cell));
                if let (Some(_), Some(source)) = (bodies.of(cell), source) {
                    *integrals = self.integrate_source(source, cell, &rules)?;
                }
            }
            Ok(())
        };
        cells::for_each(n_cells, &|cell| cell, &mut by_cell, &integrate)?;
        let mut sums = vec![[Sum::default(); 3]; bodies.bodies.len()];
        let mut add_to = |body: usize, integrals: Integrals| {
            sums[body].iter_mut().zip(integrals).for_each(|(sum, term)| sum.add(term));
        };
        for (cell, integrals) in by_cell.into_iter().enumerate() {
            bodies.of(cell).into_iter().for_each(|body| add_to(body, integrals));
        }
        if self.problem.has_neumann_data() {
            let rules = FACET_DEGREES.map(|degree| Rule::new(D - 1, degree));
            for (facet, group) in self.grouped_facets_of(BoundaryCondition::Neumann) {
                let Some(body) = bodies.of(facet.0) else { continue };
                let (mut integrals, measure) = ([0.0; 3], self.facet_measure(facet));
                for (k, rule) in rules.iter().enumerate() {
                    for (point, weight) in rule.iter() {
                        let flux = self.neumann_at(facet, group, point, None)?;
                        add(&mut integrals, k, weight * measure * flux);
                    }
                }
                add_to(body, integrals);
            }
        }
        for (body, sums) in bodies.bodies.iter_mut().zip(&sums) {
            let [coarse, fine, absolute] = sums.map(Sum::value);
            body.resultant = fine;
            let rounding = RESULTANT_ROUNDING * f64::EPSILON * absolute;
            body.uncertainty = (2.0 * (fine - coarse).abs()).max(rounding);
        }
        Ok(())
    }

    /// The integrals of the source over a cell.
    fn integrate_source(
        &self,
        source: &Datum<D>,
        cell: usize,
        rules: &CellRules,
    ) -> Result<Integrals, Error> {
        let volume = self.mesh.geometry(cell).volume;
        if let Some(constant) = source.constant() {
            return Ok([volume * constant, volume * constant, (volume * constant).abs()]);
        }
        let mut integrals = [0.0; 3];
        for k in 0..2 {
            let cut = rules.cut.as_ref().map(|cut| &cut[k]).zip(source.level());
            let mut outcome = Ok(());
            let is_cut = cut.is_some_and(|(rule, level)| {
                rule.visit_if_cut(self.mesh, cell, from_ref(level), &mut |_, x, weight| {
                    match checks::finite(self.at(source, cell, x), "source", x, cell) {
                        Ok(value) => add(&mut integrals, k, weight * volume * value),
                        Err(error) => outcome = Err(error),
                    }
                })
            });
            outcome?;
            if is_cut {
                continue;
            }
            for (point, weight) in rules.rules[k].iter() {
                let x = self.cell_point(point, cell);
                let value = self.at(source, cell, &x);
                let value = checks::finite(value, "source", &x, cell)?;
                add(&mut integrals, k, weight * volume * value);
            }
        }
        Ok(integrals)
    }

    /// Adds a constant source to the load of each body's cells, so that its sum is the resultant of the body, or zero
    /// where that is undecided: the rule of the scheme has an error, by which a body that is pressed might be pulled.
    /// Loads that differ by rounding are not changed.
    pub fn correct_resultants(&self, bodies: &FreeBodies, by_cell: &mut [f64]) {
        let (n, constants) = (self.per_cell(), self.constants());
        let mut sums = vec![(Sum::default(), 0.0); bodies.bodies.len()];
        for (cell, entries) in by_cell.chunks_exact(n).enumerate() {
            let Some(body) = bodies.of(cell) else { continue };
            for (entry, constant) in entries.iter().zip(&constants) {
                let term = *entry * *constant;
                sums[body].0.add(term);
                sums[body].1 += term.abs();
            }
        }
        let correction = |(body, (sum, absolute)): (usize, (Sum, f64))| {
            let missing = bodies.bodies[body].decided_resultant() - sum.value();
            let is_rounding = missing.abs() <= RESULTANT_ROUNDING * f64::EPSILON * absolute;
            if is_rounding { 0.0 } else { missing / bodies.measures[body] }
        };
        let corrections: Vec<f64> = sums.into_iter().enumerate().map(correction).collect();
        if corrections.iter().all(|&source| source == 0.0) {
            return;
        }
        let means = self.basis_means();
        for (cell, entries) in by_cell.chunks_exact_mut(n).enumerate() {
            let Some(body) = bodies.of(cell) else { continue };
            let scale = corrections[body] * self.mesh.geometry(cell).volume;
            for (entry, mean) in entries.iter_mut().zip(&means) {
                *entry += scale * mean;
            }
        }
    }
}

//! A hierarchy of nested meshes and the conforming P1 solution on each, which provides the initial guess
//! of every scheme.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use crate::algebra::{Bound, Contact, Start};
use crate::assemble::{DataQuadrature, Discretisation};
use crate::constraint::Nodes;
use crate::error::Error;
use crate::inequality::{InequalitySolver, InitialGuess, Outcome};
use crate::instances::compiled;
use crate::linear::{CoarseLevel, CoarseSpaces, P1Level, Prolongation};
use crate::mesh::{Domain, Mesh, Refinement};
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::ConformingP1;

/// The conforming P1 solution on a level, or its prolongation from the coarser level.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct P1Solution<T> {
    /// The contact state of every vertex.
    pub contact: Vec<Contact>,
    /// The value at every vertex; empty if the solve did not converge.
    pub values: Vec<T>,
    /// The conforming P1 spaces of this and all coarser levels.
    pub coarse_spaces: CoarseSpaces<T>,
    /// Seconds of assembly, solve and prolongation on this level and all coarser ones.
    pub seconds: f64,
    /// Number of levels on which conforming P1 was solved.
    pub levels_solved: usize,
}

/// A mesh and its P1 solution.
#[derive(Debug)]
struct Level<T, const D: usize> {
    mesh: Mesh<T, D>,
    /// The coarser level, and the refinement of its mesh that gives this one.
    coarser: Option<(usize, Refinement)>,
    /// The prolongation of P1 functions from the coarser level.
    prolongation: Option<Arc<Prolongation<T>>>,
    /// Seconds for the meshes of this and all coarser levels.
    mesh_seconds: f64,
    p1_solution: Option<Arc<P1Solution<T>>>,
}

/// The nested meshes of a problem and their P1 solutions, computed on demand and kept.
///
/// Level `n` of a built-in domain has `n` subdivisions of its shortest side. It is the refinement of
/// level `n / 2` if `n` is even and `n / 2` is at least 4. Level `k` of an input mesh is its
/// `k`-th uniform refinement.
pub struct Hierarchy<'a, T, const D: usize> {
    problem: &'a Problem<D>,
    domain: &'a Domain<D>,
    input_mesh: Option<&'a Mesh<T, D>>,
    levels: BTreeMap<usize, Level<T, D>>,
}

impl<T, const D: usize> std::fmt::Debug for Hierarchy<'_, T, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Hierarchy").field("levels", &self.levels.keys()).finish_non_exhaustive()
    }
}

/// Fewest subdivisions of a level that serves as a coarser one.
const COARSEST: usize = 4;

/// Relative tolerance in the energy norm for iterative solvers of P1, whose solution serves as an
/// initial guess only: below the discretisation error of all meshes that fit into memory.
const P1_ENERGY_TOLERANCE: f64 = 1e-4;

impl<'a, T: Real, const D: usize> Hierarchy<'a, T, D> {
    /// The empty hierarchy of a problem on an input mesh if there is one, else on a built-in domain.
    #[must_use]
    pub fn new(
        problem: &'a Problem<D>,
        domain: &'a Domain<D>,
        input_mesh: Option<&'a Mesh<T, D>>,
    ) -> Self {
        Self { problem, domain, input_mesh, levels: BTreeMap::new() }
    }

    /// The level whose refinement is a given one.
    fn coarser_level(&self, level: usize) -> Option<usize> {
        match self.input_mesh {
            Some(_) => level.checked_sub(1),
            None => (level.is_multiple_of(2) && level / 2 >= COARSEST).then_some(level / 2),
        }
    }

    /// Builds the meshes of a level and of all coarser ones.
    ///
    /// # Errors
    /// [`Error::Parameter`] for level zero of a built-in domain and for one with more cells than can be
    /// numbered or with cells too small for the scalar, [`Error::Mesh`] if the domain has no mesh.
    pub fn build(&mut self, level: usize) -> Result<(), Error> {
        compiled!(
            T, D: fn(&mut Hierarchy<'_, T, D>, usize) -> Result<(), Error>
                = |levels, level| levels.build_meshes(level)
        )(self, level)
    }
    fn build_meshes(&mut self, level: usize) -> Result<(), Error> {
        if self.levels.contains_key(&level) {
            return Ok(());
        }
        let mut missing = vec![level];
        while let Some(&finer) = missing.last() {
            match self.coarser_level(finer) {
                Some(coarser) if !self.levels.contains_key(&coarser) => missing.push(coarser),
                _ => break,
            }
        }
        self.check_size(level)?;
        for level in missing.into_iter().rev() {
            let coarser =
                self.coarser_level(level).and_then(|c| self.levels.get(&c).map(|l| (c, l)));
            let clock = Instant::now();
            let (mesh, coarser, before) = match coarser {
                Some((coarser, entry)) => {
                    let (mesh, refinement) = match self.input_mesh {
                        Some(_) => entry.mesh.refine()?,
                        None => self.domain.refine(&entry.mesh)?,
                    };
                    (mesh, Some((coarser, refinement)), entry.mesh_seconds)
                }
                None => (self.coarsest_mesh(level)?, None, 0.0),
            };
            let mesh_seconds = before + clock.elapsed().as_secs_f64();
            let entry =
                Level { mesh, coarser, prolongation: None, mesh_seconds, p1_solution: None };
            self.levels.insert(level, entry);
        }
        Ok(())
    }

    /// The number of cells of a level.
    pub(crate) fn cells(&self, level: usize) -> f64 {
        match self.input_mesh {
            Some(mesh) => (mesh.n_cells() as f64) * 2_f64.powi(D as i32).powf(level as f64),
            None => self.domain.cells(level),
        }
    }

    /// Checks the number and size of the cells of a level before any mesh is built.
    pub(crate) fn check_size(&self, level: usize) -> Result<(), Error> {
        let cells = self.cells(level);
        // 32-bit indices number the unknowns and matrix entries of a discontinuous space
        let limit = f64::from(u32::MAX) / ((D + 1) * (D + 1) * (D + 2)) as f64;
        if cells > limit {
            return Err(Error::Parameter {
                parameter: "level",
                value: level.to_string(),
                allowed: format!(
                    "it would have {cells:.1e} cells, at most {limit:.1e} are possible"
                ),
            });
        }
        if level == 0 && self.input_mesh.is_none() {
            return Err(Error::Parameter {
                parameter: "level",
                value: "0".to_owned(),
                allowed: "a built-in mesh has at least one subdivision".to_owned(),
            });
        }
        self.check_scalar(level)
    }

    /// Checks that squares and volumes of cells, and their reciprocals, are in the range of the scalar.
    /// The constructor of an input mesh checks its cells.
    fn check_scalar(&self, level: usize) -> Result<(), Error> {
        let fits = |x: f64| {
            let error = (T::lit(x).to_f64() / x - 1.0).abs();
            x.is_normal() && error <= T::EPSILON
        };
        let power = D.max(2) as i32;
        let outside = |&h: &f64| !(fits(h.powi(power)) && fits(h.powi(-power)));
        let spacings = self.domain.spacings(level);
        match spacings.into_iter().find(outside).filter(|_| self.input_mesh.is_none()) {
            None => Ok(()),
            Some(h) => Err(Error::Parameter {
                parameter: "precision",
                value: T::NAME.to_owned(),
                allowed: format!(
                    "cannot hold the volume of cells of size {h:.1e}; choose another precision, scale or level"
                ),
            }),
        }
    }

    /// The mesh of a level that is no refinement.
    fn coarsest_mesh(&self, level: usize) -> Result<Mesh<T, D>, Error> {
        match self.input_mesh {
            Some(mesh) => Ok(mesh.clone()),
            None => Ok(self.domain.mesh(level)?),
        }
    }

    /// The mesh of a level that was built, and the seconds for it and all coarser ones.
    #[must_use]
    pub fn mesh(&self, level: usize) -> Option<(&Mesh<T, D>, f64)> {
        self.levels.get(&level).map(|l| (&l.mesh, l.mesh_seconds))
    }

    /// The prolongation of the coarser P1 solution to a level that was built; `None` on the coarsest
    /// level. A new vertex is active if both ends of its edge are.
    ///
    /// # Errors
    /// Those of assembly.
    pub fn prolonged_p1_solution(
        &mut self,
        level: usize,
        solver: &dyn InequalitySolver<T>,
        quadrature: DataQuadrature,
        repeat: usize,
    ) -> Result<Option<Arc<P1Solution<T>>>, Error> {
        compiled!(
            T, D: fn(
                &mut Hierarchy<'_, T, D>,
                usize,
                &dyn InequalitySolver<T>,
                DataQuadrature,
                usize,
            ) -> Result<Option<Arc<P1Solution<T>>>, Error>
                = |levels, level, solver, quadrature, repeat|
                    levels.prolong_p1_solution(level, solver, quadrature, repeat)
        )(self, level, solver, quadrature, repeat)
    }
    fn prolong_p1_solution(
        &mut self,
        level: usize,
        solver: &dyn InequalitySolver<T>,
        quadrature: DataQuadrature,
        repeat: usize,
    ) -> Result<Option<Arc<P1Solution<T>>>, Error> {
        let Some((coarser, _)) = self.levels.get(&level).and_then(|l| l.coarser.as_ref()) else {
            return Ok(None);
        };
        let coarser = *coarser;
        let coarse = self.p1_solution(coarser, solver, quadrature, repeat)?;
        let clock = Instant::now();
        let Some(entry) = self.levels.get_mut(&level) else { unreachable!("found above") };
        let Some((_, refinement)) = &entry.coarser else { return Ok(None) };
        let parents = &refinement.parents;
        let contact = parents
            .iter()
            .map(|&[a, b]| match (coarse.contact[a as usize], coarse.contact[b as usize]) {
                (one, other) if one == other => one,
                _ => Contact::Inactive,
            })
            .collect();
        let new = || Arc::new(Prolongation::midpoints(parents.clone(), coarse.contact.len()));
        let prolongation = entry.prolongation.get_or_insert_with(new);
        let values = match coarse.values.len() == coarse.contact.len() {
            true => prolongation.prolongate(&coarse.values),
            false => Vec::new(),
        };
        let coarse_level = match &coarse.coarse_spaces {
            CoarseSpaces::SameMesh(same) => CoarseLevel::new(same.clone(), prolongation.clone()),
            _ => None,
        };
        let seconds = coarse.seconds + clock.elapsed().as_secs_f64();
        let coarse_spaces = coarse_level.map_or(CoarseSpaces::Unknown, CoarseSpaces::CoarseLevel);
        let levels_solved = coarse.levels_solved;
        let solution = P1Solution { contact, values, coarse_spaces, seconds, levels_solved };
        Ok(Some(Arc::new(solution)))
    }

    /// The conforming P1 solution on a level, by nested iteration over all coarser levels.
    ///
    /// # Errors
    /// Those of assembly and of [`Hierarchy::build`].
    pub fn p1_solution(
        &mut self,
        level: usize,
        solver: &dyn InequalitySolver<T>,
        quadrature: DataQuadrature,
        repeat: usize,
    ) -> Result<Arc<P1Solution<T>>, Error> {
        compiled!(
            T, D: fn(
                &mut Hierarchy<'_, T, D>,
                usize,
                &dyn InequalitySolver<T>,
                DataQuadrature,
                usize,
            ) -> Result<Arc<P1Solution<T>>, Error>
                = |levels, level, solver, quadrature, repeat|
                    levels.solve_p1_on(level, solver, quadrature, repeat)
        )(self, level, solver, quadrature, repeat)
    }
    fn solve_p1_on(
        &mut self,
        level: usize,
        solver: &dyn InequalitySolver<T>,
        quadrature: DataQuadrature,
        repeat: usize,
    ) -> Result<Arc<P1Solution<T>>, Error> {
        if let Some(known) = self.levels.get(&level).and_then(|l| l.p1_solution.clone()) {
            return Ok(known);
        }
        self.build(level)?;
        let start = self.prolonged_p1_solution(level, solver, quadrature, repeat)?;
        let problem = self.problem;
        let Some(entry) = self.levels.get_mut(&level) else { unreachable!("built above") };
        let found = Arc::new(solve_p1(problem, &entry.mesh, start, solver, quadrature, repeat)?);
        entry.p1_solution = Some(found.clone());
        Ok(found)
    }
}

/// Solves conforming P1 on a mesh from the prolonged solution; the seconds are the smallest of `repeat`
/// runs.
fn solve_p1<T: Real, const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<T, D>,
    start: Option<Arc<P1Solution<T>>>,
    solver: &dyn InequalitySolver<T>,
    quadrature: DataQuadrature,
    repeat: usize,
) -> Result<P1Solution<T>, Error> {
    let (seconds_before, levels) =
        start.as_ref().map_or((0.0, 0), |s| (s.seconds, s.levels_solved));
    // the constraint set of the problem is for the scheme that starts from here
    let problem = &problem.clone().on(Nodes);
    let mut seconds = f64::INFINITY;
    let mut last = None;
    for _ in 0..repeat.max(1) {
        let clock = Instant::now();
        let space = Discretisation::new(&ConformingP1, problem, mesh, quadrature)?;
        let mut inequality = space.inequality()?;
        let mut guess = InitialGuess::default().energy_tolerance(P1_ENERGY_TOLERANCE);
        if let Some(start) = &start {
            inequality.start = Start::Contact(start.contact.clone());
            guess = guess.values(start.values.clone()).coarse_spaces(start.coarse_spaces.clone());
        }
        let solution = solver.solve_from(&inequality, &guess);
        seconds = seconds.min(clock.elapsed().as_secs_f64());
        last = Some((inequality, solution));
    }
    let Some((inequality, solution)) = last else { unreachable!("at least one run") };
    let clock = Instant::now();
    // an initial guess need not be right: after a failure it is inactive everywhere
    let (contact, values) = match solution.outcome {
        Outcome::Converged => (solution.contact, solution.values),
        _ => (vec![Contact::Inactive; inequality.size()], Vec::new()),
    };
    // in one dimension factors are as sparse as the matrix: no multigrid is needed
    let coarse_spaces = if D == 1 {
        CoarseSpaces::Unknown
    } else {
        let fixed = inequality.bounds.iter().map(|b| matches!(b, Bound::Fixed(_))).collect();
        let coarser = start.and_then(|start| match &start.coarse_spaces {
            CoarseSpaces::CoarseLevel(coarser) => Some(coarser.clone()),
            _ => None,
        });
        CoarseSpaces::SameMesh(Arc::new(P1Level::new(inequality.matrix, fixed, coarser)))
    };
    let seconds = seconds_before + seconds + clock.elapsed().as_secs_f64();
    Ok(P1Solution { contact, values, coarse_spaces, seconds, levels_solved: levels + 1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    #[test]
    fn level_zero_of_a_built_in_domain_is_refused_by_its_name() {
        let scene = scenes::radial::<2>(1.0);
        let mut levels = Hierarchy::<f64, 2>::new(&scene.problem, &scene.domain, None);
        let error = levels.build(0).unwrap_err();
        assert!(matches!(error, Error::Parameter { parameter: "level", .. }), "{error}");
    }
}

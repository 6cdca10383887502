//! Nested levels of a problem, and the contact set of conforming P1 on each: what every scheme starts
//! from.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use crate::algebra::{Bound, Contact, Start};
use crate::assemble::{DataQuadrature, Discretisation};
use crate::error::Error;
use crate::inequality::{InequalitySolver, InitialGuess, Outcome};
use crate::instances::compiled;
use crate::linear::{CoarseLevel, CoarseSpaces, P1Level, Prolongation};
use crate::mesh::{Domain, Mesh, Refinement};
use crate::problem::Problem;
use crate::real::Real;
use crate::scheme::ConformingP1;

/// Contact and value of every vertex, found by conforming P1, with what it cost.
#[derive(Clone, Debug)]
pub struct P1Solution<T> {
    /// The state of every vertex.
    pub contact: Vec<Contact>,
    /// The value at every vertex; empty if no solution was found.
    pub values: Vec<T>,
    /// The conforming linear functions of this and coarser levels.
    pub functions: CoarseSpaces<T>,
    /// Seconds spent on this level and all coarser ones.
    pub seconds: f64,
    /// How many levels were solved.
    pub levels: usize,
}

struct Level<T, const D: usize> {
    mesh: Mesh<T, D>,
    /// The coarser level, and how this one came from it.
    from: Option<(usize, Refinement)>,
    /// How functions of the coarser level are written on this one.
    transfer: Option<Arc<Prolongation<T>>>,
    seconds: f64,
    contact: Option<Arc<P1Solution<T>>>,
}

/// The levels of a problem, made when asked for and kept.
///
/// Level `n` of a built-in domain has `n` subdivisions of its shortest side and is the refinement of
/// level `n / 2` as long as that is whole and not tiny. Level `k` of a given mesh is its `k`-th uniform
/// refinement.
pub struct Hierarchy<'a, T, const D: usize> {
    problem: &'a Problem<D>,
    domain: &'a Domain<D>,
    given: Option<&'a Mesh<T, D>>,
    levels: BTreeMap<usize, Level<T, D>>,
}

/// Fewest subdivisions of a level that is worth a start of its own.
const COARSEST: usize = 4;

/// How well an iterative solver solves what only something else starts from: relative to the
/// energy, below the discretisation error of all meshes that fit into memory.
const START_ACCURACY: f64 = 1e-4;

impl<'a, T: Real, const D: usize> Hierarchy<'a, T, D> {
    /// Hierarchy of a problem on a built-in domain, or on a mesh given instead.
    pub fn new(
        problem: &'a Problem<D>,
        domain: &'a Domain<D>,
        given: Option<&'a Mesh<T, D>>,
    ) -> Self {
        Self { problem, domain, given, levels: BTreeMap::new() }
    }

    fn coarser(&self, level: usize) -> Option<usize> {
        match self.given {
            Some(_) => level.checked_sub(1),
            None => (level.is_multiple_of(2) && level / 2 >= COARSEST).then_some(level / 2),
        }
    }

    /// Makes the mesh of a level and of all coarser ones it is refined from.
    ///
    /// # Errors
    /// [`Error::Mesh`] if there would be more cells than can be numbered, [`Error::Parameter`] for
    /// a level of zero on a built-in domain.
    pub fn make(&mut self, level: usize) -> Result<(), Error> {
        compiled!(
            T, D: fn(&mut Hierarchy<'_, T, D>, usize) -> Result<(), Error>
                = |levels, level| levels.make_meshes(level)
        )(self, level)
    }
    fn make_meshes(&mut self, level: usize) -> Result<(), Error> {
        if self.levels.contains_key(&level) {
            return Ok(());
        }
        let mut chain = vec![level];
        while let Some(&last) = chain.last() {
            match self.coarser(last) {
                Some(coarser) if !self.levels.contains_key(&coarser) => chain.push(coarser),
                _ => break,
            }
        }
        self.check_size(level)?;
        for level in chain.into_iter().rev() {
            let before = self.coarser(level).and_then(|c| self.levels.get(&c).map(|l| (c, l)));
            let start = Instant::now();
            let (mesh, from, spent) = match before {
                Some((coarser, entry)) => {
                    let (mesh, refinement) = match self.given {
                        Some(_) => entry.mesh.refine()?,
                        None => self.domain.refine(&entry.mesh)?,
                    };
                    (mesh, Some((coarser, refinement)), entry.seconds)
                }
                None => (self.coarsest(level)?, None, 0.0),
            };
            let seconds = spent + start.elapsed().as_secs_f64();
            self.levels.insert(level, Level { mesh, from, transfer: None, seconds, contact: None });
        }
        Ok(())
    }

    /// How many cells a level has.
    pub(crate) fn cells(&self, level: usize) -> f64 {
        match self.given {
            Some(mesh) => (mesh.n_cells() as f64) * 2_f64.powi(D as i32).powf(level as f64),
            None => self.domain.cells(level),
        }
    }

    /// Refuses a level before any of its coarser ones is made.
    pub(crate) fn check_size(&self, level: usize) -> Result<(), Error> {
        let cells = self.cells(level);
        // beyond this a discontinuous space has more unknowns and entries than 32-bit numbers reach
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
        self.check_scalar(level)
    }

    /// Refuses cells so small or large that their squares or volumes, or the reciprocals of these,
    /// are out of the range of the scalar. Meshes that are given were checked when they were made.
    fn check_scalar(&self, level: usize) -> Result<(), Error> {
        let fits = |x: f64| {
            let error = (T::lit(x).to_f64() / x - 1.0).abs();
            x.is_normal() && error <= T::EPSILON
        };
        let power = D.max(2) as i32;
        let outside = |&h: &f64| !(fits(h.powi(power)) && fits(h.powi(-power)));
        let spacings = self.domain.spacings(level);
        match spacings.into_iter().find(outside).filter(|_| self.given.is_none()) {
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

    fn coarsest(&self, level: usize) -> Result<Mesh<T, D>, Error> {
        match self.given {
            Some(mesh) => Ok(mesh.clone()),
            None => Ok(self.domain.mesh(level)?),
        }
    }

    /// The mesh of a level that was made, and the seconds it took with all coarser ones.
    pub fn mesh(&self, level: usize) -> Option<(&Mesh<T, D>, f64)> {
        self.levels.get(&level).map(|l| (&l.mesh, l.seconds))
    }

    /// Contact and values of the coarser level, carried to the vertices of a level that was made: a
    /// new vertex is in contact if both its parents are.
    pub fn start_from_coarser(
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
                    levels.carry_from_coarser(level, solver, quadrature, repeat)
        )(self, level, solver, quadrature, repeat)
    }
    fn carry_from_coarser(
        &mut self,
        level: usize,
        solver: &dyn InequalitySolver<T>,
        quadrature: DataQuadrature,
        repeat: usize,
    ) -> Result<Option<Arc<P1Solution<T>>>, Error> {
        let Some((coarser, _)) = self.levels.get(&level).and_then(|l| l.from.as_ref()) else {
            return Ok(None);
        };
        let coarser = *coarser;
        let coarse = self.contact(coarser, solver, quadrature, repeat)?;
        let clock = Instant::now();
        let Some(entry) = self.levels.get_mut(&level) else { unreachable!("made above") };
        let Some((_, refinement)) = &entry.from else { return Ok(None) };
        let parents = &refinement.parents;
        let contact = parents
            .iter()
            .map(|&[a, b]| match (coarse.contact[a as usize], coarse.contact[b as usize]) {
                (one, other) if one == other => one,
                _ => Contact::Inactive,
            })
            .collect();
        let make = || Arc::new(Prolongation::midpoints(parents.clone(), coarse.contact.len()));
        let transfer = entry.transfer.get_or_insert_with(make);
        let values = match coarse.values.len() == coarse.contact.len() {
            true => transfer.values(&coarse.values),
            false => Vec::new(),
        };
        let functions = match &coarse.functions {
            CoarseSpaces::Same(same) => CoarseLevel::new(same.clone(), transfer.clone()),
            _ => None,
        };
        let seconds = coarse.seconds + clock.elapsed().as_secs_f64();
        let functions = functions.map_or(CoarseSpaces::Unknown, CoarseSpaces::CoarseLevel);
        let levels = coarse.levels;
        Ok(Some(Arc::new(P1Solution { contact, values, functions, seconds, levels })))
    }

    /// The contact set of conforming P1 on a level that was made.
    ///
    /// # Errors
    /// Those of assembly.
    pub fn contact(
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
                    levels.find_contact(level, solver, quadrature, repeat)
        )(self, level, solver, quadrature, repeat)
    }
    fn find_contact(
        &mut self,
        level: usize,
        solver: &dyn InequalitySolver<T>,
        quadrature: DataQuadrature,
        repeat: usize,
    ) -> Result<Arc<P1Solution<T>>, Error> {
        if let Some(known) = self.levels.get(&level).and_then(|l| l.contact.clone()) {
            return Ok(known);
        }
        self.make(level)?;
        let start = self.start_from_coarser(level, solver, quadrature, repeat)?;
        let problem = self.problem;
        let Some(entry) = self.levels.get_mut(&level) else { unreachable!("made above") };
        let found = Arc::new(solve_p1(problem, &entry.mesh, start, solver, quadrature, repeat)?);
        entry.contact = Some(found.clone());
        Ok(found)
    }
}

fn solve_p1<T: Real, const D: usize>(
    problem: &Problem<D>,
    mesh: &Mesh<T, D>,
    start: Option<Arc<P1Solution<T>>>,
    solver: &dyn InequalitySolver<T>,
    quadrature: DataQuadrature,
    repeat: usize,
) -> Result<P1Solution<T>, Error> {
    let (spent, levels) = start.as_ref().map_or((0.0, 0), |s| (s.seconds, s.levels));
    let mut seconds = f64::INFINITY;
    let mut last = None;
    for _ in 0..repeat.max(1) {
        let clock = Instant::now();
        let space = Discretisation::new(&ConformingP1, problem, mesh, quadrature)?;
        let mut inequality = space.inequality()?;
        let mut nearby = InitialGuess { accuracy: Some(START_ACCURACY), ..InitialGuess::default() };
        if let Some(start) = &start {
            inequality.start = Start::Contact(start.contact.clone());
            nearby.values = Some(start.values.clone());
            nearby.functions = start.functions.clone();
        }
        let solution = solver.solve_from(&inequality, &nearby);
        seconds = seconds.min(clock.elapsed().as_secs_f64());
        last = Some((inequality, solution));
    }
    let Some((inequality, solution)) = last else { unreachable!("at least one run") };
    let clock = Instant::now();
    // a start need not be right; all open, one that failed is as good as none
    let (contact, values) = match solution.outcome {
        Outcome::Converged => (solution.contact, solution.values),
        _ => (vec![Contact::Inactive; inequality.size()], Vec::new()),
    };
    // in one dimension factors are as sparse as the matrix
    let functions = if D == 1 {
        CoarseSpaces::Unknown
    } else {
        let fixed = inequality.bounds.iter().map(|b| matches!(b, Bound::Fixed(_))).collect();
        let coarser = start.and_then(|start| match &start.functions {
            CoarseSpaces::CoarseLevel(coarser) => Some(coarser.clone()),
            _ => None,
        });
        CoarseSpaces::Same(Arc::new(P1Level::new(inequality.matrix, fixed, coarser)))
    };
    let seconds = spent + seconds + clock.elapsed().as_secs_f64();
    Ok(P1Solution { contact, values, functions, seconds, levels: levels + 1 })
}

//! What ran of a sweep, seen from one scheme at one place.

use std::cell::RefCell;

use super::place::{self, Norm, Place};
use crate::algebra::{Inequality, SparseMatrix};
use crate::assemble::DataQuadrature;
use crate::error::Error;
use crate::in_its_dimension;
use crate::inequality::{ActiveSet, InequalitySolver, InteriorPoint, in_precision};
use crate::linear::{LinearMethod, is_positive_definite};
use crate::measure::fit_order;
use crate::mesh::Mesh;
use crate::nested::{Hierarchy, Solved};
use crate::real::maximum;
use crate::scenes::{AnyScene, Scene};
use crate::scheme::NamedScheme;
use crate::study::{Row, Study};

/// A scheme at a place: a row for each solver, and what figures need of the solution of the first.
#[derive(Default)]
pub(crate) struct Run {
    rows: Vec<Row>,
    /// Values at the vertices of all cells.
    values: Option<Vec<f64>>,
    /// See [`imbalance`].
    imbalance: Option<f64>,
}

/// Runs a scheme at a place.
pub(crate) fn run(place: &Place, scheme: &NamedScheme) -> Result<Run, Error> {
    in_its_dimension!(&place.scene, |scene| run_on(scene, place, scheme))
}

fn run_on<const D: usize>(
    scene: &Scene<D>,
    place: &Place,
    scheme: &NamedScheme,
) -> Result<Run, Error> {
    let found = RefCell::new(Run::default());
    // factors on every level, so that no tolerance of an iterative solver enters
    let solver = ActiveSet::default().linear(LinearMethod::Direct);
    let mut solvers: Vec<Box<dyn InequalitySolver<f64>>> =
        vec![in_precision(place.precision, solver)];
    if place.has_interior_point {
        solvers.push(Box::new(InteriorPoint));
    }
    let study = Study::<D>::new(scene.clone()).named_scheme(scheme).levels([place.level]);
    let study = solvers.into_iter().fold(study, Study::boxed_solver).cold_start(place.is_cold);
    let study = study.each_solution(|_, _, solved| {
        let mut found = found.borrow_mut();
        // those of the first solver
        if found.imbalance.is_none() && found.values.is_none() {
            found.values = solved.fields().filter(|_| solved.converged()).map(|fields| fields.u);
            found.imbalance = imbalance(solved);
        }
        Ok(())
    });
    let rows = study.run()?.rows;
    drop(study);
    Ok(Run { rows, ..found.into_inner() })
}

/// The imbalance of forces: the load less reaction, contact forces and fluxes through facets with weakly imposed
/// Dirichlet data, over the sum of absolute loads. None without forces or without jump multipliers of the solver, which
/// are the fluxes.
fn imbalance<const D: usize>(solved: &Solved<'_, D>) -> Option<f64> {
    let (inequality, solution) = (solved.inequality(), solved.solution());
    let penalised = inequality.penalised.as_ref()?;
    let forces = solved.multiplier()?;
    if solution.jump_multipliers.len() != penalised.n_jumps() {
        return None;
    }
    let mut left = -forces.iter().sum::<f64>();
    for i in 0..inequality.size() {
        // the stiffness of a function has the sum zero
        left += penalised.stiffness(i, |j| solution.values[j]);
        left -= inequality.load[i];
    }
    for (jump, multiplier) in solution.jump_multipliers.iter().enumerate() {
        if penalised.jumps.blocks_of(jump).iter().any(Option::is_none) {
            let weights = penalised.terms_of(jump).iter().map(|term| term.weight);
            left += weights.sum::<f64>() * multiplier;
        }
    }
    let size: f64 = inequality.load.iter().map(|load| load.abs()).sum();
    Some(left.abs() / size)
}

/// The schemes that ran at the places of a sweep, each with its runs.
pub(crate) struct Ran<'s> {
    /// The name of the parameter.
    pub parameter: &'static str,
    pub places: &'s [Place],
    pub runs: Vec<(NamedScheme, Vec<Run>)>,
}

/// A scheme at a place of what ran.
#[derive(Clone, Copy)]
pub(crate) struct At<'r> {
    pub ran: &'r Ran<'r>,
    pub scheme: usize,
    pub place: usize,
}

impl<'r> At<'r> {
    /// Another scheme at the same place, which the sweep names.
    pub fn beside(self, name: &str) -> Self {
        let wanted = place::scheme(name);
        let scheme = self.ran.runs.iter().position(|(scheme, _)| *scheme == wanted);
        Self { scheme: scheme.expect("the sweep runs the schemes to which figures refer"), ..self }
    }
    /// The same scheme at the first place.
    pub fn first(self) -> Self {
        Self { place: 0, ..self }
    }
    /// The same scheme at the place before.
    pub fn before(self) -> Option<Self> {
        Some(Self { place: self.place.checked_sub(1)?, ..self })
    }
    /// The scheme.
    pub fn scheme(&self) -> &'r NamedScheme {
        &self.ran.runs[self.scheme].0
    }
    pub fn place(&self) -> &'r Place {
        &self.ran.places[self.place]
    }
    fn run(&self) -> &'r Run {
        &self.ran.runs[self.scheme].1[self.place]
    }
    /// The rows of all solvers; none of a run that ended in an error.
    pub fn rows(&self) -> &'r [Row] {
        &self.run().rows
    }
    /// The value of the parameter.
    pub fn value(&self) -> Option<f64> {
        let options = self.scheme().options();
        match self.ran.parameter {
            "eta" => options.eta,
            "sigma" => options.sigma,
            _ => self.place().value,
        }
    }
    /// One over the level that is shown.
    pub fn size(&self) -> f64 {
        self.place().shown.map_or(f64::NAN, |n| 1.0 / n as f64)
    }

    /// A figure of the run, if it converged.
    pub fn of(&self, figure: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
        figure(self.rows().first().filter(|row| row.converged())?)
    }
    /// An error over that of another scheme.
    pub fn over(&self, name: &str, (_, error): Norm) -> Option<f64> {
        Some(self.of(error)? / self.beside(name).of(error)?)
    }
    /// Outer steps of a solver.
    pub fn outer(&self, solver: usize) -> Option<f64> {
        let row = self.rows().get(solver).filter(|row| row.converged())?;
        row.iterations.outer.map(|n| n as f64)
    }
    /// The largest violation of the complementarity conditions.
    pub fn violation(&self) -> Option<f64> {
        self.of(|row| Some(row.certificate.largest()))
    }
    /// The values of the solution at the vertices of all cells, if the run converged.
    pub fn values(&self) -> Option<&'r [f64]> {
        self.run().values.as_deref()
    }
    /// The largest difference of the values from those at the first place and a constant; none unless both runs converged.
    pub fn difference(&self, constant: f64) -> Option<f64> {
        let (here, first) = (self.values()?, self.first().values()?);
        let apart = |(here, first): (&f64, &f64)| (first + constant - here).abs();
        Some(here.iter().zip(first).map(apart).fold(0.0, maximum))
    }
    /// What is left of the load by reaction, forces and fluxes, over the absolute load.
    pub fn imbalance(&self) -> Option<f64> {
        self.run().imbalance
    }
    /// The order of an error over all places; none unless all runs converged.
    pub fn fitted_order(&self, error: fn(&Row) -> Option<f64>) -> Option<f64> {
        let all = (0..self.ran.places.len()).map(|place| Self { place, ..*self });
        let points: Option<Vec<(f64, f64)>> =
            all.map(|at| Some((at.size(), at.of(error)?))).collect();
        fit_order(&points?).map(|fit| fit.order)
    }

    /// The scene in the plane.
    pub fn scene(&self) -> Option<&'r Scene<2>> {
        match &self.place().scene {
            AnyScene::Two(scene) => Some(scene),
            _ => None,
        }
    }
    /// The mesh in the plane to which values belong.
    pub fn mesh(&self) -> Option<Mesh<2>> {
        let meshes = Hierarchy::of_domain(&self.scene()?.domain, self.place().level).ok()?;
        Some(meshes.finest().clone())
    }
    /// The inequality; none where it cannot be assembled, of which the row says why.
    fn inequality(&self, placement: Option<&str>) -> Option<Inequality<f64>> {
        let (place, mut scheme) = (self.place(), *self.scheme());
        if let Some(placement) = placement {
            scheme = scheme.or_placement(placement);
        }
        in_its_dimension!(&place.scene, |scene| {
            let mesh = scene.domain.mesh(place.level).ok()?;
            let mut problem = scene.problem.clone();
            problem.constraint_set = scheme.constraint_set().or(problem.constraint_set);
            scheme.make().inequality(&problem, &mesh, DataQuadrature::default()).ok()
        })
    }
    /// The matrix of the free unknowns, on request with another placement of bounds where the scheme names none.
    pub fn matrix(&self, placement: Option<&str>) -> Option<SparseMatrix<f64>> {
        let inequality = self.inequality(placement)?;
        Some(inequality.matrix.submatrix(&inequality.free_unknowns()))
    }
    /// Whether the matrix is symmetric positive definite: 1 or 0; none if the scheme is not symmetric or the
    /// factorisation failed.
    pub fn definite(&self) -> Option<f64> {
        let inequality = self.inequality(None).filter(|of| of.symmetric)?;
        let answer = is_positive_definite(&inequality.matrix, true, &inequality.free_unknowns());
        answer.ok().map(|is| f64::from(u8::from(is)))
    }

    /// Errors, iterations and whatever went wrong of a run, in a few words.
    pub fn figures(&self) -> String {
        let mut parts = Vec::new();
        if let Some(row) = self.rows().first() {
            if !row.converged() {
                parts.push(row.status.to_string());
            }
            let errors = [("L2", row.error.l2), ("H1", row.error.h1), ("energy", row.error.energy)];
            parts
                .extend(errors.iter().filter_map(|(name, e)| e.map(|e| format!("{name} {e:.2e}"))));
            if let Some(outer) = row.iterations.outer.filter(|&n| n > 1) {
                parts.push(format!("{outer} active sets"));
            }
        }
        parts.join(", ")
    }
}

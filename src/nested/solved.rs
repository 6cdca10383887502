//! The result of a solve.

use std::fmt;
#[cfg(feature = "report")]
use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

use super::adaptive_meshes::AdaptiveMeshes;
use super::hierarchy::Hierarchy;
use crate::algebra::{Contact, Inequality, Start};
use crate::assemble::Discretisation;
use crate::error::Error;
#[cfg(feature = "report")]
use crate::error::write_error;
use crate::error_bound::{BoundFigures, ErrorBound, NoBound, PrimalDualPair};
use crate::inequality::{
    Certificate, Outcome, Solution, certify_with_jump_multipliers, count_active, energy_norm,
};
#[cfg(feature = "report")]
use crate::instances::compiled;
use crate::measure::{ContactErrors, Errors, Fields, contact_difference};
use crate::mesh::Mesh;
#[cfg(feature = "report")]
use crate::paraview::VtuFile;
#[cfg(feature = "report")]
use crate::problem::DataOnMesh;
use crate::problem::Exact;
use crate::real::{Point, Real};

/// A true error that is smaller than this share of the energy norm of the solution is rounding, and its ratio to a bound
/// says nothing.
const ERROR_ROUNDING: f64 = 1e-8;

/// The largest certificate of a solution to a tolerance, divided by the tolerance: both are relative to the
/// energy norm.
const CERTIFICATE_TO_TOLERANCE: f64 = 10.0;

/// Adds to a file of fields.
#[cfg(feature = "report")]
type Complete<'c, const D: usize> = &'c dyn for<'f> Fn(VtuFile<'f, D>) -> VtuFile<'f, D>;

/// A discrete solution with the space, the algebraic inequality and the mesh to which it belongs.
///
/// Some outcomes have no iterate ([`Solved::has_iterate`]): then there are no errors, energies and
/// fields, and the certificate is [`Certificate::INVALID`].
pub struct Solved<'a, T: Real, const D: usize> {
    discretisation: Discretisation<'a, T, D>,
    inequality: Inequality<T>,
    solution: Solution<T>,
    certificate: Certificate,
    has_iterate: bool,
    /// The hierarchy that has the mesh, and its position there.
    hierarchy: Option<(&'a Hierarchy<T, D>, usize)>,
    /// The adaptive meshes that have the mesh, and its position there.
    pub(super) adaptive: Option<(&'a AdaptiveMeshes<T, D>, usize)>,
    /// The bound with the pair that gives it and the seconds of both, once computed.
    bound: OnceLock<(PrimalDualPair, ErrorBound, f64)>,
    /// Seconds for the mesh and all coarser ones, if it is one of several.
    pub(crate) mesh_seconds: f64,
    /// Seconds of assembly.
    pub(crate) assemble_seconds: f64,
    /// Seconds of the solve on this mesh.
    pub(crate) solve_seconds: f64,
    /// Seconds of the start: the P1 solutions on this and all coarser meshes.
    pub(crate) start_seconds: f64,
    pub(crate) coarser_levels: usize,
    pub(crate) start_cycles: usize,
    pub(crate) warnings: Vec<String>,
}

impl<T: Real, const D: usize> fmt::Debug for Solved<'_, T, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Solved")
            .field("unknowns", &self.values().len())
            .field("outcome", &self.outcome())
            .field("certificate", &self.certificate)
            .finish_non_exhaustive()
    }
}

impl<'a, T: Real, const D: usize> Solved<'a, T, D> {
    /// A solution with its certificate. One to a tolerance on the relative error in the energy norm is within
    /// the limits that follow from the tolerance.
    pub(super) fn new(
        discretisation: Discretisation<'a, T, D>,
        inequality: Inequality<T>,
        mut solution: Solution<T>,
        hierarchy: Option<(&'a Hierarchy<T, D>, usize)>,
        energy_tolerance: Option<f64>,
    ) -> Self {
        let u = &solution.values;
        let is_of_failure = matches!(
            solution.outcome,
            Outcome::NotCoercive
                | Outcome::Singular
                | Outcome::NotFinite
                | Outcome::OutOfMemory
                | Outcome::NoSolution
                | Outcome::OutOfRange
                | Outcome::Malformed
        );
        let has_iterate = !is_of_failure && u.iter().all(|v| v.to_f64().is_finite());
        let certificate = match has_iterate {
            true => certify_with_jump_multipliers(&inequality, u, &solution.jump_multipliers)
                .with_algebraic_bound(solution.algebraic_bound),
            false => Certificate::INVALID,
        };
        let is_within_tolerance = energy_tolerance
            .is_some_and(|tolerance| certificate.largest() <= CERTIFICATE_TO_TOLERANCE * tolerance);
        let is_within_limits = is_within_tolerance || certificate.is_within_limits::<T>();
        if solution.outcome == Outcome::Converged && !is_within_limits {
            // whatever a solver says of itself
            solution.outcome = Outcome::Stalled;
        }
        Self {
            mesh_seconds: hierarchy.map_or(0.0, |(h, position)| h.seconds(position)),
            discretisation,
            inequality,
            solution,
            certificate,
            has_iterate,
            hierarchy,
            adaptive: None,
            bound: OnceLock::new(),
            assemble_seconds: 0.0,
            solve_seconds: 0.0,
            start_seconds: 0.0,
            coarser_levels: 0,
            start_cycles: 0,
            warnings: Vec::new(),
        }
    }

    /// The solution of another run of a solver that starts from this one, to a tolerance or to the ordinary
    /// limits. Iterations and seconds are those of all runs.
    pub(super) fn continued(
        mut self,
        energy_tolerance: Option<f64>,
        run: impl FnOnce(&mut Inequality<T>) -> (Solution<T>, f64),
    ) -> Self {
        self.inequality.start = Start::Contact(self.solution.contact.clone());
        let (mut solution, seconds) = run(&mut self.inequality);
        solution.outer += self.solution.outer;
        solution.linear += self.solution.linear;
        solution.stages.splice(0..0, self.solution.stages);
        let continued = Self::new(
            self.discretisation,
            self.inequality,
            solution,
            self.hierarchy,
            energy_tolerance,
        );
        Self {
            adaptive: self.adaptive,
            mesh_seconds: self.mesh_seconds,
            assemble_seconds: self.assemble_seconds,
            solve_seconds: self.solve_seconds + seconds,
            start_seconds: self.start_seconds,
            coarser_levels: self.coarser_levels,
            start_cycles: self.start_cycles,
            warnings: self.warnings,
            ..continued
        }
    }

    /// Whether the solution converged to a tolerance and not to the ordinary limits.
    pub(super) fn is_inexact(&self) -> bool {
        self.converged() && !self.certificate.is_within_limits::<T>()
    }
    /// The energy norm to which tolerances and certificates are relative.
    pub(super) fn energy_norm(&self) -> f64 {
        energy_norm(&self.inequality, self.values(), &self.solution.jump_multipliers)
    }
    /// How the solve ended.
    pub fn outcome(&self) -> Outcome {
        self.solution.outcome
    }
    /// Whether the solve converged.
    pub fn converged(&self) -> bool {
        self.outcome() == Outcome::Converged
    }
    /// Whether there are values to evaluate; a solve without factors, for instance, has none.
    pub fn has_iterate(&self) -> bool {
        self.has_iterate
    }
    /// The unknowns.
    pub fn values(&self) -> &[T] {
        &self.solution.values
    }
    /// Which bound, if any, is active at each unknown.
    pub fn contact(&self) -> &[Contact] {
        &self.solution.contact
    }
    /// The multiplier of each unknown: its entry of `A u - b` where a bound is active, positive at
    /// lower and negative at upper bounds; zero elsewhere. Its density is in [`Solved::fields`].
    pub fn multiplier(&self) -> Vec<f64> {
        let Inequality { matrix, load, .. } = &self.inequality;
        let at = |(i, &state): (usize, &Contact)| match state {
            Contact::Inactive => 0.0,
            _ => matrix.row_dot_f64(i, self.values()) - load[i].to_f64(),
        };
        self.contact().iter().enumerate().map(at).collect()
    }
    /// Number of outer iterations on this mesh, by [`Solution::outer`]; none without an iterate.
    pub fn outer(&self) -> Option<usize> {
        self.has_iterate.then_some(self.solution.outer)
    }
    /// Number of constrained unknowns in contact; none without an iterate.
    pub fn active(&self) -> Option<usize> {
        self.has_iterate.then(|| count_active(&self.inequality, self.contact()))
    }
    /// The objective `a(u,u)/2 - l(u)` with all terms of the scheme; none for schemes that are not
    /// symmetric and without an iterate.
    pub fn objective(&self) -> Option<f64> {
        let is_minimum = self.inequality.symmetric && self.has_iterate;
        is_minimum.then(|| self.inequality.objective(self.values()))
    }
    /// The energy of the solution, by one formula for every scheme: see [`Discretisation::energy`]. None
    /// without an iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn energy(&self) -> Result<Option<f64>, Error> {
        let energy = || self.discretisation.energy(self.values());
        self.has_iterate.then(energy).transpose()
    }
    /// The measure of the discrete contact set, see [`Discretisation::contact_measure`]; none for a problem
    /// without inequality and for an outcome without iterate.
    pub fn contact_measure(&self) -> Option<f64> {
        let measure = || self.discretisation.contact_measure(&self.inequality, &self.solution);
        self.has_iterate.then(measure).flatten()
    }
    /// The total contact force, positive where a lower bound pushes upward: see
    /// [`Discretisation::resultant`]; none for a problem without inequality and for an outcome without iterate.
    pub fn resultant(&self) -> Option<f64> {
        let resultant = || self.discretisation.resultant(&self.inequality, &self.solution);
        self.has_iterate.then(resultant).flatten()
    }
    /// The certificate: violations of the complementarity conditions.
    pub fn certificate(&self) -> Certificate {
        self.certificate
    }
    /// What the solver returned: values, contact states, numbers of iterations.
    pub fn solution(&self) -> &Solution<T> {
        &self.solution
    }
    /// The algebraic inequality.
    pub fn inequality(&self) -> &Inequality<T> {
        &self.inequality
    }
    /// The discretisation: scheme, problem and mesh joined.
    pub fn discretisation(&self) -> &Discretisation<'a, T, D> {
        &self.discretisation
    }
    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<T, D> {
        self.discretisation.mesh()
    }
    /// Warnings by type, as text: a penalty below its proven bound, say.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The value at a point, in the first cell that contains the point; none outside the mesh. The
    /// search takes a time proportional to the number of cells.
    pub fn value_at(&self, point: &Point<f64, D>) -> Option<f64> {
        self.discretisation.value_at(self.values(), point)
    }
    /// Errors against the exact solution of the problem; none if the problem has no exact solution
    /// or there is no iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn errors(&self) -> Result<Errors, Error> {
        match self.has_iterate {
            true => self.discretisation.errors(self.values()),
            false => Ok(Errors::default()),
        }
    }
    /// Errors against a function with its gradient; none without an iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn errors_against(&self, exact: &Exact<D>) -> Result<Errors, Error> {
        match self.has_iterate {
            true => self.discretisation.errors_against(exact, self.values()),
            false => Ok(Errors::default()),
        }
    }
    /// Norms of the difference from another solution on the same mesh or on another mesh of the same
    /// hierarchy, computed on the finer mesh: L2 norm, broken H1 seminorm and the maximum over the
    /// nodes of the finer space. None without two iterates.
    ///
    /// On a mesh whose refinement moves vertices, as on a disc, a coarse function is continued beyond its
    /// cells as the polynomial that it is.
    ///
    /// # Errors
    /// [`Error::NotNested`] if the two meshes do not belong to one hierarchy.
    pub fn difference(&self, other: &Self) -> Result<Errors, Error> {
        let refinements = match (self.hierarchy, other.hierarchy) {
            _ if std::ptr::eq(self.mesh(), other.mesh()) => 0,
            (Some((one, a)), Some((two, b))) if std::ptr::eq(one, two) => a as isize - b as isize,
            _ => return Err(Error::NotNested),
        };
        let (fine, coarse) = if refinements < 0 { (other, self) } else { (self, other) };
        if !(fine.has_iterate && coarse.has_iterate) {
            return Ok(Errors::default());
        }
        let coarse = (&coarse.discretisation, coarse.values(), refinements.unsigned_abs());
        fine.discretisation.difference(fine.values(), coarse)
    }
    /// The solution with the outcome of values that no solver of the library found.
    pub(super) fn found_elsewhere(mut self) -> Self {
        if self.solution.outcome == Outcome::Stalled {
            self.solution.outcome = Outcome::NotASolution;
        }
        self
    }
    /// The value of this solution at a point of a cell of a coarser mesh of the same hierarchy, which is at
    /// this position; the cell of this mesh is found through the cells between.
    #[cfg(feature = "report")]
    fn value_within(&self, position: usize, cell: usize, x: &Point<f64, D>) -> f64 {
        let Some((hierarchy, own)) = self.hierarchy else { return f64::NAN };
        let child = |parent: usize, position: usize| {
            let least = |child: usize| {
                let lambda = hierarchy.mesh(position).barycentric(child, x);
                lambda[..=D].iter().copied().fold(f64::INFINITY, f64::min)
            };
            let children = parent << D..(parent + 1) << D;
            children.max_by(|&a, &b| least(a).total_cmp(&least(b))).unwrap_or(parent)
        };
        let cell = (position + 1..=own).fold(cell, child);
        self.discretisation.value_in(self.values(), cell, x)
    }
    /// Distances of multiplier and contact set from those of a solution on a finer mesh of the same
    /// hierarchy, or on the same mesh; the distance of free boundaries is not computed. None without two
    /// iterates.
    ///
    /// # Errors
    /// [`Error::NotNested`] if the mesh of `reference` is not a refinement of this one.
    pub fn contact_difference(&self, reference: &Self) -> Result<ContactErrors, Error> {
        let refinements: Vec<_> = match (self.hierarchy, reference.hierarchy) {
            _ if std::ptr::eq(self.mesh(), reference.mesh()) => Vec::new(),
            (Some((one, a)), Some((two, b))) if std::ptr::eq(one, two) && a <= b => {
                (a + 1..=b).filter_map(|k| one.refinement(k)).map(|(by, _)| by).collect()
            }
            _ => return Err(Error::NotNested),
        };
        if !(self.has_iterate && reference.has_iterate) {
            return Ok(ContactErrors::default());
        }
        let own = (&self.discretisation, &self.inequality, &self.solution);
        let fine = (&reference.discretisation, &reference.inequality, &reference.solution);
        Ok(contact_difference(own, fine, &refinements))
    }
    /// Distances of multiplier and contact set from the exact ones; none without an iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn contact_errors(&self) -> Result<ContactErrors, Error> {
        match self.has_iterate {
            true => self.discretisation.contact_errors(&self.inequality, &self.solution),
            false => Ok(ContactErrors::default()),
        }
    }
    /// An admissible function and an equilibrated flux: see [`Discretisation::primal_dual_pair`].
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn primal_dual_pair(&self) -> Result<PrimalDualPair, NoBound> {
        match self.has_iterate {
            true => self.discretisation.primal_dual_pair(&self.inequality, &self.solution),
            false => Err(NoBound::NoIterate),
        }
    }
    /// A bound on the error from solution and data alone: see [`crate::error_bound`]. It is computed once.
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn bound(&self) -> Result<ErrorBound, NoBound> {
        self.pair_and_bound().map(|(_, bound, _)| bound.clone())
    }
    pub(super) fn pair_and_bound(&self) -> Result<&(PrimalDualPair, ErrorBound, f64), NoBound> {
        if let Some(known) = self.bound.get() {
            return Ok(known);
        }
        let clock = Instant::now();
        let pair = self.primal_dual_pair()?;
        let coarser = self.adaptive.map_or_else(Vec::new, |(meshes, k)| meshes.coarser_cells(k));
        let bound = self.discretisation.error_bound_on_levels(&pair, self.values(), &coarser)?;
        Ok(self.bound.get_or_init(|| (pair, bound, clock.elapsed().as_secs_f64())))
    }
    /// Seconds of the bound; none if it is not known, or not yet.
    pub(crate) fn bound_seconds(&self) -> Option<f64> {
        self.bound.get().map(|(_, _, seconds)| *seconds)
    }
    /// The figures of the bound, with its effectivity if asked for and the exact solution is known.
    pub(crate) fn bound_figures(&self, with_effectivity: bool) -> BoundFigures {
        let pair = self.pair_and_bound().ok().filter(|_| with_effectivity);
        self.figures(pair.and_then(|(pair, ..)| self.discretisation.error_of_pair(pair)))
    }
    /// The errors against the exact solution, and the figures of the bound with its effectivity.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub(crate) fn errors_and_bound_figures(&self) -> Result<(Errors, BoundFigures), Error> {
        let pair = self.pair_and_bound().ok().map(|(pair, ..)| pair);
        let (errors, error) = match self.has_iterate {
            true => self.discretisation.errors_and_error_of_pair(Some(self.values()), pair)?,
            false => (Errors::default(), None),
        };
        Ok((errors, self.figures(error)))
    }
    /// The figures of the bound; an error of its function below `ERROR_ROUNDING` is left out.
    fn figures(&self, error: Option<f64>) -> BoundFigures {
        let error = error.filter(|error| *error > ERROR_ROUNDING * self.energy_norm());
        BoundFigures::new(self.pair_and_bound().map(|(_, bound, _)| bound), error)
    }
    /// Solution, obstacle, multiplier and contact set on cells; none without an iterate.
    pub fn fields(&self) -> Option<Fields> {
        self.has_iterate.then(|| self.discretisation.fields(&self.inequality, &self.solution))
    }
    /// Writes a `.vtu` file, and its folder if there is none, with 32-bit numbers: see
    /// [`Self::write_vtu_with`].
    ///
    /// # Errors
    /// [`Error::Write`], also without an iterate.
    #[cfg(feature = "report")]
    pub fn write_vtu(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.write_vtu_with(path, |file| file)
    }
    /// Writes a `.vtu` file to which `complete` adds fields or sets the scalar, and its folder if there is
    /// none.
    ///
    /// The solution `u` is written in its degree; above two it is interpolated in degree two. Point data:
    /// `obstacle` (the lower one, or the upper one where there is no lower one), `upper_obstacle` where
    /// there are both, `error`, which is `u` less the exact solution where that is known (for rows of a study
    /// with a reference: less the reference). Cell data of
    /// obstacle problems: `multiplier` and `contact` of [`Fields`]; of all for which there is one, `bound`, the share of
    /// the cell in the square of the error bound ([`ErrorBound::cells`]). Signorini problems have the facets of
    /// the contact boundary as further cells with `pressure` and `gap` of [`Fields`] and `contact`, which is
    /// one on facets in contact as a whole; the integral of `pressure` over the cells of `dimension`
    /// `D - 1` is the total contact force.
    ///
    /// # Errors
    /// [`Error::Write`], also without an iterate.
    #[cfg(feature = "report")]
    pub fn write_vtu_with(
        &self,
        path: impl AsRef<Path>,
        complete: impl for<'f> Fn(VtuFile<'f, D>) -> VtuFile<'f, D>,
    ) -> Result<(), Error> {
        self.write_vtu_against(path.as_ref(), None, complete)
    }
    /// As [`Self::write_vtu_with`]; where there is a solution on a finer mesh of the same hierarchy, `error` is
    /// the difference from that.
    #[cfg(feature = "report")]
    pub(crate) fn write_vtu_against(
        &self,
        path: &Path,
        reference: Option<&Solved<'_, T, D>>,
        complete: impl for<'f> Fn(VtuFile<'f, D>) -> VtuFile<'f, D>,
    ) -> Result<(), Error> {
        compiled!(
            T, D: for<'s, 'x, 'p, 'r, 'y, 'c> fn(
                &'s Solved<'x, T, D>,
                &'p Path,
                Option<&'r Solved<'y, T, D>>,
                Complete<'c, D>,
            ) -> Result<(), Error>
                = |solved, path, reference, complete| {
                    solved.write_fields(path, reference, complete)
                }
        )(self, path, reference, &complete)
    }
    #[cfg(feature = "report")]
    fn write_fields(
        &self,
        path: &Path,
        reference: Option<&Solved<'_, T, D>>,
        complete: Complete<'_, D>,
    ) -> Result<(), Error> {
        let Some(fields) = self.fields() else {
            return Err(write_error(path, format!("no solution: {}", self.outcome())));
        };
        let problem = self.discretisation.problem();
        let u = fields.values_by_cell(D);
        // facets in contact are listed in the order of the contact boundary
        let mut touching = fields.discrete_contact.facets.iter().peekable();
        let state = |place| if touching.next_if_eq(&place).is_some() { 1.0 } else { 0.0 };
        let in_contact: Vec<f64> = fields.contact_boundary.iter().map(state).collect();
        let (mesh, data) = (self.mesh(), DataOnMesh::new(problem, self.mesh())?);
        let regions: Vec<f64> = match mesh.regions().len() {
            1 => Vec::new(),
            _ => (0..mesh.n_cells()).map(|cell| mesh.region(cell) as f64).collect(),
        };
        let shares = self.bound().map_or_else(|_| Vec::new(), |bound| bound.cells);
        let mut file = VtuFile::new(mesh, &u);
        let bounds = [&data.lower, &data.upper].into_iter().filter(|bound| bound.is_given());
        for (name, bound) in ["obstacle", "upper_obstacle"].into_iter().zip(bounds) {
            file = file.function_in_cells(name, |cell, x| {
                bound.of(mesh.region(cell)).map_or(f64::NAN, |bound| bound.at(x))
            });
        }
        if !regions.is_empty() {
            file = file.on_cells("region", &regions);
        }
        if !shares.is_empty() {
            file = file.on_cells("bound", &shares);
        }
        match (reference.filter(|r| r.has_iterate).zip(self.hierarchy), &problem.exact) {
            (Some((reference, (_, own))), _) => {
                file =
                    file.error_from_in_cells(move |cell, x| reference.value_within(own, cell, x));
            }
            (None, Some(exact)) => file = file.error_from(&*exact.value),
            (None, None) => {}
        }
        if problem.has_obstacle() {
            file = file.on_cells("multiplier", &fields.multiplier);
            file = file.on_cells("contact", &fields.contact);
        }
        if problem.has_gap() {
            file = file.facets(&fields.contact_boundary).on_facets("pressure", &fields.pressure);
            file = file.on_facets("gap", &fields.gap);
        }
        if problem.has_gap() && !problem.has_obstacle() {
            file = file.on_facets("contact", &in_contact);
        }
        complete(file).write(path)
    }
}

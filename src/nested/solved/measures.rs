//! Errors of a result, its distances from other results, and the bound on its error.

use std::time::Instant;

use super::Solved;
use crate::error::Error;
use crate::error_bound::{BoundFigures, ErrorBound, NoBound, PrimalDualPair, TrueErrors};
use crate::measure::{ContactErrors, Errors, Rounding, contact_difference};
use crate::parallel::once;
use crate::problem::Exact;
use crate::real::Point;

impl<const D: usize> Solved<'_, D> {
    /// The value at a point, in the first cell that contains the point; none outside the mesh and without an iterate. The
    /// search takes a time proportional to the number of cells; that of [`Solved::function`] is fast.
    pub fn value_at(&self, point: &Point<D>) -> Option<f64> {
        let value = || self.discretisation().value_at(&self.solution.values, point);
        self.has_iterate.then(value).flatten()
    }
    /// Errors against the exact solution of the problem; none if the problem has no exact solution
    /// or there is no iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn errors(&self) -> Result<Errors, Error> {
        match &self.discretisation().problem().exact {
            Some(exact) => self.errors_against(exact),
            None => Ok(Errors::default()),
        }
    }
    /// Errors against a function with its gradient; none without an iterate.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn errors_against(&self, exact: &Exact<D>) -> Result<Errors, Error> {
        if !self.has_iterate {
            return Ok(Errors::default());
        }
        let counts = |cell| self.system.owns(cell);
        let own = self.discretisation().squared_errors(exact, &self.solution.values, &counts);
        Ok(self.system.merged(own)?.norms())
    }
    /// Norms of the difference from another solution on the same mesh or on another mesh of the same
    /// hierarchy, computed on the finer mesh: L2 norm, broken H1 seminorm and the maximum over the
    /// nodes of the finer space. None without two iterates.
    ///
    /// On a mesh whose refinement moves vertices, as on a disc, a coarse function is continued beyond its
    /// cells as the polynomial that it is.
    ///
    /// # Errors
    /// [`Error::NotNested`] if the two meshes do not belong to one hierarchy, and on parts of a mesh.
    pub fn difference(&self, other: &Self) -> Result<Errors, Error> {
        let refinements = match (self.hierarchy, other.hierarchy) {
            _ if self.part().is_some() => return Err(Error::NotNested),
            _ if std::ptr::eq(self.mesh(), other.mesh()) => 0,
            (Some((one, a)), Some((two, b))) if std::ptr::eq(one, two) => a as isize - b as isize,
            _ => return Err(Error::NotNested),
        };
        let (fine, coarse) = if refinements < 0 { (other, self) } else { (self, other) };
        if !(fine.has_iterate && coarse.has_iterate) {
            return Ok(Errors::default());
        }
        let coarse =
            (coarse.discretisation(), &coarse.solution.values[..], refinements.unsigned_abs());
        fine.discretisation().difference(&fine.solution.values, coarse)
    }
    /// Distances of multiplier and contact set from those of a solution on a finer mesh of the same
    /// hierarchy, or on the same mesh; the distance of free boundaries is not computed. None without two
    /// iterates.
    ///
    /// # Errors
    /// [`Error::NotNested`] if the mesh of `reference` is not a refinement of this one, and on parts of a mesh.
    pub fn contact_difference(&self, reference: &Self) -> Result<ContactErrors, Error> {
        let refinements: Vec<_> = match (self.hierarchy, reference.hierarchy) {
            _ if self.part().is_some() => return Err(Error::NotNested),
            _ if std::ptr::eq(self.mesh(), reference.mesh()) => Vec::new(),
            (Some((one, a)), Some((two, b))) if std::ptr::eq(one, two) && a <= b => {
                (a + 1..=b).filter_map(|k| one.refinement(k)).collect()
            }
            _ => return Err(Error::NotNested),
        };
        if !(self.has_iterate && reference.has_iterate) {
            return Ok(ContactErrors::default());
        }
        let own = (self.discretisation(), self.inequality(), &self.solution);
        let fine = (reference.discretisation(), reference.inequality(), &reference.solution);
        Ok(contact_difference(own, fine, &refinements))
    }
    /// Distances of multiplier and contact set from the exact ones; none without an iterate, and on parts of a mesh.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn contact_errors(&self) -> Result<ContactErrors, Error> {
        match self.has_iterate && self.part().is_none() {
            true => self.discretisation().contact_errors(self.inequality(), &self.solution),
            false => Ok(ContactErrors::default()),
        }
    }
    /// An admissible function and an equilibrated flux: see
    /// [`primal_dual_pair`](crate::assemble::Discretisation::primal_dual_pair). On a part of a mesh they are right on own
    /// cells alone, and those of linear functions.
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn primal_dual_pair(&self) -> Result<PrimalDualPair<D>, NoBound> {
        if !self.has_iterate {
            return Err(NoBound::NoIterate);
        }
        let (of, inequality) = (self.discretisation(), self.inequality());
        let counts = |cell| self.system.owns(cell);
        self.system.agreed_bound(of.pair_of_cells(inequality, &self.solution, &counts))
    }
    /// A bound on the error from solution and data alone: see [`crate::error_bound`]. It is computed once. Over the
    /// parts of a mesh it has the shares of own cells; multipliers are exchanged for flux inside parts alone, so that it
    /// depends on these a little, and no forces of obstacles act on facets, without which it may be large.
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn bound(&self) -> Result<ErrorBound, NoBound> {
        self.pair_and_bound().map(|(_, bound, _)| bound.clone())
    }
    pub(super) fn pair_and_bound(&self) -> Result<&(PrimalDualPair<D>, ErrorBound, f64), NoBound> {
        if let Some(known) = self.bound.get() {
            return Ok(known);
        }
        let clock = Instant::now();
        let mut pair = self.primal_dual_pair()?;
        let (of, u) = (self.discretisation(), &self.solution.values);
        let bound_of = |pair: &PrimalDualPair<D>| {
            let own = of.part_of_bound(pair, u, &|cell| self.system.owns(cell));
            let own = self.system.agreed_bound(own)?;
            self.system.agreed_bound(own.bound(self.inequality().distribution()))
        };
        let mut bound = bound_of(&pair)?;
        // on stretched cells the means of broken functions are far from them
        if !self.conforming.is_empty() {
            let other = of.with_function(&pair, &self.conforming);
            let of_other = bound_of(&other)?;
            if of_other.total < bound.total {
                (pair, bound) = (other, of_other);
            }
        }
        Ok(once(&self.bound, || (pair, bound, clock.elapsed().as_secs_f64())))
    }
    /// The bound on the algebraic error, or what the solver adds to the error bound if that is more, over the error bound
    /// without it; none without one of these bounds.
    pub(in crate::nested) fn algebraic_share(&self) -> Option<f64> {
        let (_, ErrorBound { discrete, terms, .. }, _) = self.pair_and_bound().ok()?;
        let own = self.solution.algebraic_bound? * self.energy_norm / discrete;
        Some(own.max(terms.algebra.sqrt()) / (1.0 - terms.algebra).max(0.0).sqrt())
    }
    /// Seconds of the bound; none if it is not known, or not yet.
    pub(crate) fn bound_seconds(&self) -> Option<f64> {
        self.bound.get().map(|(_, _, seconds)| *seconds)
    }
    /// The figures of the bound, with the error of the solution where it is known and, if asked for, that of `v` where
    /// the exact solution is.
    pub(crate) fn bound_figures(&self, of_solution: Option<f64>, with_v: bool) -> BoundFigures {
        let pair = self.pair_and_bound().ok().map(|(pair, ..)| pair).filter(|_| with_v);
        let of_v = pair.and_then(|pair| self.errors_beside(None, Some(pair)).ok()?.1);
        self.figures(TrueErrors { of_solution, of_v })
    }
    /// The errors against the exact solution, and the figures of the bound with its effectivity.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub(crate) fn errors_and_bound_figures(&self) -> Result<(Errors, BoundFigures), Error> {
        let pair = self.pair_and_bound().ok().map(|(pair, ..)| pair);
        let (errors, of_v) = match self.has_iterate {
            true => self.errors_beside(Some(&self.solution.values), pair)?,
            false => (Errors::default(), None),
        };
        let of_solution = errors.broken_energy;
        Ok((errors, self.figures(TrueErrors { of_solution, of_v })))
    }
    /// The errors of values against the exact solution, and the error of the function of a pair; none without these.
    fn errors_beside(
        &self,
        u: Option<&[f64]>,
        pair: Option<&PrimalDualPair<D>>,
    ) -> Result<(Errors, Option<f64>), Error> {
        if self.discretisation().problem().exact.is_none() {
            return Ok(Default::default());
        }
        let counts = |cell| self.system.owns(cell);
        let own = self.discretisation().squared_errors_beside(u, pair, &counts);
        let squares = self.system.merged(own)?;
        let errors = if u.is_some() { squares.norms() } else { Errors::default() };
        Ok((errors, pair.map(|_| squares.of_function())))
    }
    /// The figures of the bound.
    fn figures(&self, errors: TrueErrors) -> BoundFigures {
        let bound = self.pair_and_bound().map(|(_, bound, _)| bound);
        BoundFigures::of_solution(bound, errors, (self.energy_norm, self.rounding()))
    }
    /// Adds to the bound on the algebraic error of quadratics, which is one of the rounded inequality alone, what rounding of
    /// the matrix does: relative to the energy norm twice machine epsilon times `n^2` on `n^D` cells. A quarter of it is
    /// observed with `sipg-p2` on signorini-2d, less elsewhere, on 16 to 64 subdivisions.
    pub(in crate::nested) fn add_rounding_to_algebraic_bound(&mut self) {
        let [cells, ..] = self.sizes();
        let rounding =
            2.0 * self.solution.precision.epsilon() * (cells as f64).powf(2.0 / D as f64);
        let sum = self.solution.algebraic_bound.map(|bound| bound + rounding);
        self.solution.algebraic_bound = sum;
        self.certificate = self.certificate.with_algebraic_bound(sum);
    }
    /// Rounding errors in the figures of the solution; none without an iterate.
    pub fn rounding(&self) -> Option<Rounding> {
        let [cells, ..] = self.has_iterate.then(|| self.sizes())?;
        let of = (cells as usize, self.energy_norm);
        let rounding = || self.discretisation().rounding(self.inequality(), &self.solution, of);
        once(&self.rounding, rounding).clone()
    }
}

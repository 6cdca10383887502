//! The bound of a pair: its terms, and what of it is proven.

use std::ops::Range;

use super::eigenvalue::least_eigenvalue;
use super::friedrichs::FriedrichsData;
use super::integrals::Totals;
use super::{NoBound, PrimalDualPair};
use crate::algebra::{Distribution, OnePart};
use crate::assemble::Discretisation;
use crate::assemble::cut_simplices::CutRule;
use crate::assemble::space::Space;
use crate::error::Error;
use crate::instances::compiled;
use crate::measure::{Counts, SquaredErrors};
use crate::parallel::cells;
use crate::quadrature::Rule;

/// A term of a bound that is not proven for a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "report", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "report", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Unproven {
    /// Integrals of data that are functions: a rule need not be exact. Least values of a reaction whose degree is not
    /// known to be at most two, or whose Bernstein coefficients are not all positive.
    Quadrature,
    /// Dirichlet data of a higher degree than `v` on facets: `v` takes them at its nodes only.
    Boundary,
    /// Obstacles and gaps of a higher degree than `v` in cells, or of degree two where the Bernstein coefficients of
    /// `v` do not exceed theirs: `v` satisfies them at points only.
    Obstacle,
    /// The part of the domain between the mesh and the [shape](crate::mesh::Mesh::with_shape) of a boundary group: the
    /// bound is for the problem on the polygon or polyhedron that the mesh is.
    Shape,
    /// The residual that the solver left, where no constant of Friedrichs' inequality is known and the reaction
    /// vanishes somewhere.
    Algebra,
}

/// Shares of the square of a bound; their sum is one, or zero where the bound is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BoundTerms {
    /// The difference of `alpha grad v` and the flux and, with a reaction, of `v` and the discrete solution.
    pub mismatch: f64,
    /// The complementarity of the obstacles.
    pub obstacle: f64,
    /// The complementarity of contact.
    pub contact: f64,
    /// Data less their means in cells and on Neumann facets; for quadratics also what the multiplier and contact
    /// forces have of the other sign.
    pub oscillation: f64,
    /// What the flux does not balance: the residual of an inexact solution.
    pub algebra: f64,
}

/// A bound on the error of a discrete solution.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ErrorBound {
    /// Bound on the energy norm of `u - v`, `u` the exact solution and `v` the admissible function.
    pub total: f64,
    /// The distance of `v` from the discrete solution `u_h` in the broken energy norm.
    pub distance: f64,
    /// Bound on the broken energy norm of `u - u_h`: that of the midpoint of function and flux, at most `total +
    /// distance`. See [`docs::bound`](crate::docs::bound).
    pub discrete: f64,
    /// Of what `total` is made.
    pub terms: BoundTerms,
    /// The share of each cell in the square of `total`, without the term of the solver.
    pub cells: Vec<f64>,
    /// The terms that are not proven; empty where the bound is guaranteed.
    pub unproven: Vec<Unproven>,
}

impl ErrorBound {
    /// Whether every term of the bound is proven.
    pub fn is_guaranteed(&self) -> bool {
        self.unproven.is_empty()
    }
}

impl<const D: usize> Discretisation<'_, D> {
    /// The bound that an admissible function and a flux give, and the distance of the function from the
    /// discrete function `u`. A pair gives a bound if its function has the Dirichlet data, and if its flux has
    /// equal and opposite values on the two sides of facets, the mean of the datum on Neumann facets, both but for the
    /// forces of the pair, and no negative mean on contact facets. What the flux does not balance counts with a constant of Friedrichs'
    /// inequality, or with the reaction.
    ///
    /// Between vertices the function is the larger one of its interpolant and the lower obstacle, or the
    /// smaller one with the upper obstacle; on contact facets the larger one with the gap counts. The
    /// multiplier of a cell is what the flux leaves of the load, where an obstacle has its sign.
    ///
    /// # Errors
    /// [`NoBound`].
    ///
    /// # Panics
    /// If the pair is not one of this mesh, or `u` has not one value for each unknown.
    pub fn error_bound(&self, pair: &PrimalDualPair<D>, u: &[f64]) -> Result<ErrorBound, NoBound> {
        self.demand_length(u);
        self.part_of_bound(pair, u, &|_| true)?.bound(&OnePart)
    }

    /// The energy norm of the difference of the exact solution and the admissible function of a pair; none
    /// where the exact solution is not known, or not finite.
    ///
    /// # Panics
    /// If the pair is not one of this mesh.
    pub fn error_of_pair(&self, pair: &PrimalDualPair<D>) -> Option<f64> {
        self.problem().exact.as_ref()?;
        Some(self.squared_errors_beside(None, Some(pair), &|_| true).ok()?.of_function())
    }

    /// What the cells that count, those of a part of a mesh, add to the bound that a pair gives.
    ///
    /// # Errors
    /// [`NoBound`].
    pub(crate) fn part_of_bound(
        &self,
        pair: &PrimalDualPair<D>,
        u: &[f64],
        counts: Counts<'_>,
    ) -> Result<PartOfBound<D>, NoBound> {
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &PrimalDualPair<D>,
                &[f64],
                Counts<'_>,
            ) -> Result<PartOfBound<D>, NoBound>
                = |of, pair, u, counts| of.space.part_of_bound(pair, u, counts)
        )(self, pair, u, counts)
    }

    /// As [`Self::squared_errors`], with the square of the error of the admissible function of a pair; zero without
    /// an exact solution.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub(crate) fn squared_errors_beside(
        &self,
        u: Option<&[f64]>,
        pair: Option<&PrimalDualPair<D>>,
        counts: Counts<'_>,
    ) -> Result<SquaredErrors, Error> {
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                Option<&[f64]>,
                Option<&PrimalDualPair<D>>,
                Counts<'_>,
            ) -> Result<SquaredErrors, Error>
                = |of, u, pair, counts| {
                    let Some(exact) = &of.problem().exact else { return Ok(Default::default()) };
                    match pair {
                        Some(pair) => of.squares_beside(
                            exact,
                            u,
                            Some(&|cell| of.space.admissible_in(pair, cell)),
                            counts,
                        ),
                        None => of.squares_beside(exact, u, None, counts),
                    }
                }
        )(self, u, pair, counts)
    }
}

impl ErrorBound {
    /// The bound of these sums, with the term of the solver and the square that each cell adds.
    fn new(
        totals: &Totals,
        of_solver: f64,
        squares: Vec<f64>,
        unproven: Vec<Unproven>,
    ) -> Result<Self, NoBound> {
        let &Totals { mismatch, with_oscillation, obstacle, contact, .. } = totals;
        let of_flux = (with_oscillation.sqrt() + of_solver).powi(2);
        let square = of_flux + obstacle + contact;
        let [total, discrete] = totals.bounds(of_solver);
        if !square.is_finite() || totals.least_coefficient <= 0.0 {
            return Err(NoBound::NotFinite);
        }
        let share = |term: f64| if square > 0.0 { term / square } else { 0.0 };
        let distance = totals.distance.sqrt();
        Ok(Self {
            total,
            distance,
            // the sum is never less but for rounding, and where a rule has weights of both signs
            discrete: discrete.min(total + distance),
            terms: BoundTerms {
                mismatch: share(mismatch),
                obstacle: share(obstacle),
                contact: share(contact),
                // differences of equal numbers but for rounding
                oscillation: share((with_oscillation - mismatch).max(0.0)),
                algebra: share((of_flux - with_oscillation).max(0.0)),
            },
            cells: squares.into_iter().map(share).collect(),
            unproven,
        })
    }
}

/// The sums of one part of a mesh for a bound.
#[derive(Debug)]
pub(crate) struct PartOfBound<const D: usize> {
    totals: Totals,
    friedrichs: FriedrichsData<D>,
    /// The constant where these data give none and one is needed.
    by_eigenvalue: Option<f64>,
    /// The part of each cell; zero for cells that do not count.
    squares: Vec<f64>,
    unproven: Vec<Unproven>,
}

impl<const D: usize> PartOfBound<D> {
    /// The bound over all parts of a mesh, or over the one part that is the mesh, with the shares of the cells of this
    /// part. All parts call it.
    pub fn bound(self, distribution: &dyn Distribution) -> Result<ErrorBound, NoBound> {
        let Self { mut totals, mut friedrichs, by_eigenvalue, squares, mut unproven } = self;
        totals.add_over_parts(distribution);
        friedrichs = friedrichs.over_parts(distribution);
        let of_all =
            [Unproven::Quadrature, Unproven::Boundary, Unproven::Obstacle, Unproven::Shape];
        let mut is_found = of_all.map(|term| f64::from(u8::from(unproven.contains(&term))));
        distribution.largest(&mut is_found);
        let found = of_all.into_iter().zip(is_found).filter(|(_, is_found)| *is_found != 0.0);
        unproven = found.map(|(term, _)| term).collect();
        let of_solver = totals.of_solver(friedrichs.constant().or(by_eigenvalue))?;
        if of_solver.is_none() {
            unproven.push(Unproven::Algebra);
        }
        ErrorBound::new(&totals, of_solver.unwrap_or(0.0), squares, unproven)
    }
}

impl<const D: usize> Space<'_, D> {
    /// The sums of the cells that count for a bound.
    fn part_of_bound(
        &self,
        pair: &PrimalDualPair<D>,
        u: &[f64],
        counts: Counts<'_>,
    ) -> Result<PartOfBound<D>, NoBound> {
        let (totals, squares) = self.terms_of_bound((pair, u), counts)?;
        let unproven = self.unproven_terms(pair, totals.reaction_from_below >= 0.0, counts);
        let friedrichs = FriedrichsData::of(self.mesh);
        let by_eigenvalue = match totals.needs_constant() && friedrichs.constant().is_none() {
            true => least_eigenvalue(self.mesh)?.map(|eigenvalue| 1.0 / eigenvalue.sqrt()),
            false => None,
        };
        Ok(PartOfBound { totals, friedrichs, by_eigenvalue, squares, unproven })
    }

    /// The bound `discrete` of a pair, without the term of the solver.
    pub(super) fn discrete_bound(
        &self,
        pair: &PrimalDualPair<D>,
        u: &[f64],
    ) -> Result<f64, NoBound> {
        let [_, discrete] = self.terms_of_bound((pair, u), &|_| true)?.0.bounds(0.0);
        Ok(discrete)
    }

    /// The degree of the rule for the terms of cells: exact for polynomial data, at least that of the load elsewhere.
    fn degree_of_terms(&self, of_pair: usize) -> usize {
        let data = [
            &self.data.source,
            &self.data.reaction,
            &self.data.coefficient,
            &self.data.lower,
            &self.data.upper,
        ];
        let degrees = data.map(|data| self.degree_of(data));
        let [source, reaction, coefficient, lower, upper] = degrees.map(Option::unwrap_or_default);
        let least = match degrees.iter().all(Option::is_some) {
            true => 0,
            false => self.cell_degree,
        };
        // squares of flux, load and reaction, and multipliers times distances from obstacles
        let squares = (2 * (coefficient + of_pair)).max(2 * source);
        let of_obstacles = of_pair - 1 + of_pair.max(lower).max(upper);
        squares.max(2 * (reaction + of_pair)).max(of_obstacles).max(least)
    }

    /// The terms of the cells that count together, and the square that each cell adds; zero for cells that do not
    /// count.
    fn terms_of_bound(
        &self,
        (pair, u): (&PrimalDualPair<D>, &[f64]),
        counts: Counts<'_>,
    ) -> Result<(Totals, Vec<f64>), NoBound> {
        let table = self.cell_table(Rule::new(D, self.degree_of_terms(pair.degree)));
        let has_level = self.data.source.any(&|f| f.level().is_some());
        let cut = has_level.then(|| CutRule::new(D, self.cell_degree));
        let boundary = self.boundary_terms(pair, u)?;
        let rules = (&table, cut.as_ref());
        let chunks = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            let mut totals = Totals::NONE;
            let mut squares = vec![0.0; cells.len()];
            for (cell, square) in cells.zip(&mut squares).filter(|(cell, _)| counts(*cell)) {
                let terms = self.cell_terms(pair, u, cell, rules, &boundary);
                totals.add(&terms);
                *square = terms.square();
            }
            (totals, squares)
        });
        let (mut totals, mut squares) = (Totals::NONE, Vec::with_capacity(self.mesh.n_cells()));
        for (of_chunk, of_cells) in chunks {
            totals.add(&of_chunk);
            squares.extend(of_cells);
        }
        Ok((totals, squares))
    }
}

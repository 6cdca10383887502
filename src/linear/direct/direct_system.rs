//! The linear systems of an inequality with the matrix `A + D` on some unknowns, `D` a nonnegative diagonal, solved with
//! factors. Of a penalised matrix `A = K + M^T S M` the jump multipliers are unknowns too.

use super::error::FactorError;
use super::factors::{Factors, add_to_diagonal};
use super::static_condensation::{CondensedFactors, StaticCondensation};
use super::symbolic_factor::{SymbolicFactor, symbolic_factor};
use crate::algebra::{Inequality, JumpTerm};
use crate::parallel::vectors::indices;
use crate::real::Real;

/// A vector of a [`DirectSystem`]: entries for the unknowns, and for the jump multipliers of a penalised matrix (else
/// empty).
#[derive(Clone, Debug)]
pub(crate) struct MixedVector {
    pub values: Vec<f64>,
    pub jump_multipliers: Vec<f64>,
}

/// The factors of a matrix on its free unknowns.
pub(crate) enum SystemFactors<T> {
    /// The factors of the assembled matrix.
    Assembled(Factors<T>),
    /// The factors of a penalised matrix, by static condensation.
    Condensed(Box<CondensedFactors<T>>),
}

/// The systems of an inequality.
pub(crate) struct DirectSystem<'a, T> {
    inequality: &'a Inequality<T>,
    /// The static condensation of a penalised matrix. There is none where means over the sides of a block are dependent
    /// functions, as those of quadratics in the plane and in space: then the assembled matrix is factored. Rounding in it
    /// is a relative error of size `eps cond(A)` in a solution; corrections by the residual of values and jump multipliers,
    /// in which no weight is added to a stiffness, have all digits in the end.
    condensation: Option<StaticCondensation<'a, T>>,
}

impl<'a, T: Real> DirectSystem<'a, T> {
    /// The systems of an inequality, which must be well formed.
    pub fn new(inequality: &'a Inequality<T>) -> Self {
        let condensation = inequality.penalised.as_ref().and_then(StaticCondensation::new);
        Self { inequality, condensation }
    }

    /// Number of jump multipliers.
    pub fn n_jumps(&self) -> usize {
        self.inequality.penalised.as_ref().map_or(0, |penalised| penalised.n_jumps())
    }

    /// Factors `A + D` on the free unknowns; `shift` is the diagonal of `D`, or empty for zero. `known` keeps the symbolic
    /// factor of the assembled matrix for the same unknowns and another `D`.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(
        &self,
        is_free: &[bool],
        shift: &[f64],
        known: &mut Option<SymbolicFactor>,
    ) -> Result<SystemFactors<T>, FactorError> {
        if let Some(condensation) = &self.condensation {
            let factors = condensation.factor(is_free, shift)?;
            return Ok(SystemFactors::Condensed(Box::new(factors)));
        }
        let Inequality { matrix, symmetric, .. } = self.inequality;
        let free = indices(is_free.len(), |i| is_free[i]);
        let mut submatrix = match symmetric {
            true => matrix.lower_triangle(&free),
            false => matrix.submatrix(&free),
        };
        add_to_diagonal(&mut submatrix, &free, shift)?;
        let factors = match (symmetric, known) {
            (false, _) => Factors::lu(&submatrix),
            (true, Some(known)) => Factors::cholesky(&mut submatrix, known),
            (true, none) => {
                let symbolic = symbolic_factor(&submatrix)?;
                Factors::cholesky(&mut submatrix, none.insert(symbolic))
            }
        };
        factors.map(SystemFactors::Assembled)
    }

    /// Replaces a right-hand side `r`, with `t` in place of jump multipliers, by the solution of `(A + D) u = r`, or of
    /// `(K + D) u + M^T p = r` and `M u - S^-1 p = t`, on the free unknowns, with zeros for the others. Returns the energy
    /// `u.r - p.t`. `factors` must come from [`DirectSystem::factor`] for these unknowns.
    pub fn solve(
        &self,
        factors: &SystemFactors<T>,
        is_free: &[bool],
        right: &mut MixedVector,
    ) -> f64 {
        let MixedVector { values, jump_multipliers } = right;
        debug_assert_eq!(jump_multipliers.len(), self.n_jumps());
        match (factors, &self.condensation) {
            (SystemFactors::Assembled(factors), _) => {
                self.solve_assembled(factors, is_free, values, jump_multipliers)
            }
            (SystemFactors::Condensed(factors), Some(condensation)) => {
                condensation.solve(factors, is_free, values, jump_multipliers)
            }
            (SystemFactors::Condensed(_), None) => {
                unreachable!("condensed factors come from a condensation")
            }
        }
    }

    /// [`DirectSystem::solve`] by the factors of `A`: `A u = r + M^T S t`, `p = S (M u - t)`.
    fn solve_assembled(
        &self,
        factors: &Factors<T>,
        is_free: &[bool],
        r: &mut [f64],
        t: &mut [f64],
    ) -> f64 {
        let mut load = r.to_vec();
        if let Some(penalised) = &self.inequality.penalised {
            for (jump, t) in t.iter().enumerate() {
                let weighted = penalised.weights[jump].to_f64() * t;
                for term in penalised.terms_of(jump) {
                    let product = term.weight.to_f64() * weighted;
                    for (unknown, sign) in [(term.here, 1.0), (term.there, -1.0)] {
                        if unknown != JumpTerm::<T>::NO_UNKNOWN {
                            load[unknown as usize] += sign * product;
                        }
                    }
                }
            }
        }
        let free = || (0..is_free.len()).filter(|&i| is_free[i]);
        let mut x: Vec<T> = free().map(|i| T::lit(load[i])).collect();
        factors.solve_in_place(&mut x, 1);
        let mut energy = 0.0;
        load.fill(0.0);
        for (i, x) in free().zip(x) {
            load[i] = x.to_f64();
            energy += load[i] * r[i];
        }
        r.copy_from_slice(&load);
        if let Some(penalised) = &self.inequality.penalised {
            for (jump, t) in t.iter_mut().enumerate() {
                let jump_of_solution = penalised.jump(jump, |i| r[i]);
                let multiplier = penalised.weights[jump].to_f64() * (jump_of_solution - *t);
                energy -= multiplier * *t;
                *t = multiplier;
            }
        }
        energy
    }

    /// The residual `b - A u`; with jump multipliers `p`, `c - K u - M^T p` and `g - M u + S^-1 p`.
    pub fn residual(
        &self,
        u: impl Fn(usize) -> f64 + Sync,
        jump_multiplier: impl Fn(usize) -> f64 + Sync,
    ) -> MixedVector {
        let Inequality { penalised, load, .. } = self.inequality;
        let mut values = vec![0.0; load.len()];
        let mut jump_multipliers = vec![0.0; self.n_jumps()];
        match penalised {
            Some(penalised) => {
                penalised.residual_with_jump_multipliers(load, &u, &jump_multiplier, &mut values);
                for (jump, out) in jump_multipliers.iter_mut().enumerate() {
                    *out = penalised.jump_residual(jump, &u, jump_multiplier(jump));
                }
            }
            None => self.inequality.residual_of(u, &mut values),
        }
        MixedVector { values, jump_multipliers }
    }

    /// The entry `(A u)_i`; of a penalised matrix `(K u)_i`.
    pub fn stiffness(&self, i: usize, u: impl Fn(usize) -> f64) -> f64 {
        if let Some(penalised) = &self.inequality.penalised {
            return penalised.stiffness(i, u);
        }
        let (columns, entries) = self.inequality.matrix.row(i);
        columns.iter().zip(entries).map(|(&j, a)| a.to_f64() * u(j as usize)).sum()
    }
}

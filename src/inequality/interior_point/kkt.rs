//! LinearMethod systems with a matrix plus a nonnegative diagonal, multiplied out or factored.

use crate::algebra::Inequality;
use crate::algebra::Submatrix;
use crate::inequality::certificate::positive_diagonal;
use crate::linear::direct::{
    CondensedFactors, EliminationOrder, FactorError, Factors, StaticCondensation, SymbolicFactor,
};
use crate::real::Real;

/// Values, and the forces of jumps where the matrix is kept factored (else none).
#[derive(Clone)]
pub(crate) struct Pair {
    pub values: Vec<f64>,
    pub forces: Vec<f64>,
}

/// The matrix of an inequality, to be shifted.
pub(crate) struct Shifted<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    hybrid: Option<&'h StaticCondensation<'a, T>>,
    free: Vec<u32>,
    is_free: Vec<bool>,
    half: Option<Half<T>>,
}

/// What is on and left of the diagonal of a symmetric matrix on its free unknowns, and where its
/// factors are: the same for every shift.
struct Half<T> {
    matrix: Submatrix<T>,
    analysis: SymbolicFactor,
}

impl<T: Real> Half<T> {
    fn new(inequality: &Inequality<T>, free: &[u32]) -> Result<Self, FactorError> {
        let matrix = Submatrix::lower_triangle(&inequality.matrix, free);
        let order =
            EliminationOrder::for_inequality(inequality)?.restricted_to(free, inequality.size());
        let analysis = SymbolicFactor::new(&matrix, Some(order))?;
        Ok(Self { matrix, analysis })
    }
}

/// The factors of the matrix with a shift.
pub(crate) enum ShiftedFactors<T> {
    Assembled(Factors<T>),
    StaticCondensation(CondensedFactors<T>),
}

impl<'h, 'a, T: Real> Shifted<'h, 'a, T> {
    /// The matrix on all unknowns that are not given.
    pub fn new(
        inequality: &'a Inequality<T>,
        hybrid: Option<&'h StaticCondensation<'a, T>>,
    ) -> Self {
        let free = inequality.free_unknowns();
        let mut is_free = vec![false; inequality.size()];
        free.iter().for_each(|&i| is_free[i as usize] = true);
        Self { inequality, hybrid, free, is_free, half: None }
    }

    /// The unknowns that are not given.
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// The stiffness of an unknown by itself: without penalties where they are kept apart.
    pub fn stiffness(&self, i: usize) -> f64 {
        let own = self.inequality.penalised.as_ref().map_or(0.0, |f| f.stiffness_diagonal(i));
        if own > 0.0 { own } else { positive_diagonal(self.inequality, i) }
    }

    /// Factors of the matrix plus a diagonal.
    ///
    /// # Errors
    /// See [`FactorError`].
    pub fn factor(&mut self, shift: &[f64]) -> Result<ShiftedFactors<T>, FactorError> {
        if let Some(hybrid) = self.hybrid {
            return hybrid
                .factor_shifted(&self.is_free, shift)
                .map(ShiftedFactors::StaticCondensation);
        }
        let factors = if self.inequality.symmetric {
            let half = match &mut self.half {
                Some(half) => half,
                none => none.insert(Half::new(self.inequality, &self.free)?),
            };
            let mut matrix = half.matrix.clone();
            add_diagonal(&mut matrix, &self.free, shift)?;
            Factors::cholesky(&mut matrix, &half.analysis)?
        } else {
            let mut matrix = Submatrix::new(&self.inequality.matrix, &self.free);
            add_diagonal(&mut matrix, &self.free, shift)?;
            Factors::lu(&matrix)?
        };
        Ok(ShiftedFactors::Assembled(factors))
    }

    /// Solves in place; zero where unknowns are given.
    pub fn solve(&self, factors: &ShiftedFactors<T>, right: &mut Pair) {
        match (factors, self.hybrid) {
            (ShiftedFactors::StaticCondensation(factors), Some(hybrid)) => {
                hybrid.solve(factors, &self.is_free, &mut right.values, &mut right.forces);
            }
            (ShiftedFactors::Assembled(factors), _) => {
                let free = || self.free.iter().map(|&i| i as usize);
                let mut x: Vec<T> = free().map(|i| T::lit(right.values[i])).collect();
                factors.solve_in_place(&mut x, 1);
                right.values.fill(0.0);
                free().zip(x).for_each(|(i, x)| right.values[i] = x.to_f64());
            }
            (ShiftedFactors::StaticCondensation(_), None) => unreachable!("made by this matrix"),
        }
    }

    /// What is missing to `A u = b` at `at`: `b - A u`, and by how much jumps and forces disagree.
    /// Returns the size of energies there.
    pub fn deficit(&self, at: &Pair, out: &mut Pair) -> f64 {
        let Inequality { load, penalised: factored, .. } = self.inequality;
        let value = |i: usize| at.values[i];
        let (load, energy) = match factored {
            Some(factored) if self.hybrid.is_some() => {
                let force = |jump: usize| at.forces[jump];
                factored.residual_with_jump_multipliers(value, force, &mut out.values);
                for (jump, out) in out.forces.iter_mut().enumerate() {
                    *out = factored.jump_residual(jump, value, at.forces[jump]);
                }
                (&factored.load, factored.energy(value, force))
            }
            _ => {
                self.inequality.residual_of(&value, &mut out.values);
                let terms = at.values.iter().zip(load);
                (load, terms.map(|(x, b)| (x * b.to_f64()).abs()).sum())
            }
        };
        let loads = load.iter().enumerate();
        let own: f64 = loads.map(|(i, b)| b.to_f64().powi(2) / self.stiffness(i)).sum();
        if energy + own > 0.0 { energy + own } else { 1.0 }
    }
}

/// Adds the shift of each free unknown to its diagonal entry; an error if there is none to add to.
fn add_diagonal<T: Real>(
    matrix: &mut Submatrix<T>,
    free: &[u32],
    shift: &[f64],
) -> Result<(), FactorError> {
    for (k, &i) in free.iter().enumerate().filter(|(_, i)| shift[**i as usize] > 0.0) {
        let (columns, values) = matrix.row_mut(k);
        let place = columns.binary_search(&(k as u32)).map_err(|_| FactorError::NotPositive)?;
        values[place] += T::lit(shift[i as usize]);
    }
    Ok(())
}

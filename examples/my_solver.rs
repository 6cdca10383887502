//! A solver in one file: projected successive over-relaxation, beside the solver of the library.
//! `cargo run --release --example my_solver` prints iterations, errors and certificates of both.
//!
//! C. W. Cryer, SIAM J. Control 9 (1971), 385-392.

use unilateral::algebra::{Contact, Inequality};
use unilateral::inequality::{
    ActiveSet, InequalitySolver, InitialGuess, Outcome, Solution, certify,
};
use unilateral::prelude::*;
use unilateral::real::Precision;

/// Relaxation by this factor, between one and two.
struct ProjectedSor(f64);

impl InequalitySolver<f64> for ProjectedSor {
    fn name(&self) -> &'static str {
        "projected-sor"
    }
    fn solve(&self, inequality: &Inequality<f64>) -> Solution<f64> {
        self.solve_from(inequality, &InitialGuess::default())
    }
    fn solve_from(&self, inequality: &Inequality<f64>, guess: &InitialGuess<f64>) -> Solution<f64> {
        let Inequality { matrix, bounds, .. } = inequality;
        let load = inequality.assembled_load();
        let zeros = || vec![0.0; bounds.len()];
        let mut u = guess.values.clone().filter(|u| u.len() == bounds.len()).unwrap_or_else(zeros);
        let mut sweeps = 0;
        while sweeps < 10_000
            && certify(inequality, &u).largest() > Precision::Double.certificate_limit()
        {
            for (i, bound) in bounds.iter().enumerate() {
                let step = (load[i] - matrix.row_dot(i, &u)) / matrix.get(i, i);
                u[i] = bound.nearest(u[i] + self.0 * step);
            }
            sweeps += 1;
        }
        let outcome = if sweeps < 10_000 { Outcome::Converged } else { Outcome::IterationLimit };
        let states = u.iter().zip(bounds).map(|(u, bound)| match (bound.lower(), bound.upper()) {
            (Some(lower), _) if *u <= lower => Contact::Lower,
            (_, Some(upper)) if *u >= upper => Contact::Upper,
            _ => Contact::Inactive,
        });
        let states = states.collect();
        Solution::new(u, states, outcome).iterations(sweeps, sweeps).linear_solver("sor")
    }
}

fn main() -> Result<(), Error> {
    let report = Study::<2>::new(scenes::radial(1.0))
        .scheme(ConformingP1)
        .scheme(Sipg::default())
        .solver(ActiveSet::default())
        .solver(ProjectedSor(1.6))
        .levels([8, 16, 32])
        .run()?;
    print!("{report}");
    Ok(())
}

//! A primal-dual interior point method: where to start when the active set does not settle.

use super::certificate::positive_diagonal;
use super::linear::Factors;
use crate::algebra::{Contact, Inequality};
use crate::real::Real;

/// Share of the way to the nearest bound that a step goes.
const SHARE: f64 = 0.995;

/// Complementarity over energy below which contact and gap are told apart.
const CLOSE: f64 = 1e-18;

/// Complementarity over energy to start with.
const START: f64 = 1e-2;

/// The same below which contact is believed if it was the same a step before.
const NEAR: f64 = 1e-9;

/// Most steps.
const MOST: usize = 60;

/// Where so many steps do not halve the products of gaps and forces, rounding rules.
const PATIENCE: usize = 5;

/// One bound of one unknown: `side` times the unknown is above `side` times the bound by `gap`.
struct Wall {
    unknown: usize,
    side: f64,
    gap: f64,
    force: f64,
    gap_step: f64,
    force_step: f64,
}

impl Wall {
    /// The steps of gap and force where the unknown moves by `step` and their product is to become
    /// `target`.
    fn follow(&mut self, step: f64, target: f64) {
        self.gap_step = self.side * step;
        self.force_step = (target - self.force * self.gap_step) / self.gap - self.force;
    }
    /// The longest step, at most one, that leaves gap and force positive.
    fn longest(&self) -> f64 {
        let reach = |value: f64, step: f64| if step < 0.0 { -value / step } else { f64::INFINITY };
        reach(self.gap, self.gap_step).min(reach(self.force, self.force_step)).min(1.0)
    }
}

/// The predictor-corrector method of Mehrotra (SIAM J. Optim. 2 (1992) 575-601) for
/// `A u - b = z_lower - z_upper`, gaps and forces `z` positive, products of both equal to a number
/// that falls to zero.
///
/// Every step solves with `A` plus a positive diagonal, so that it works for every matrix whose
/// symmetric part is positive semidefinite, and knows no combinatorics: two dozen steps do whatever
/// the matrix, the penalty and the number of unknowns (Wright, Primal-Dual Interior-Point Methods,
/// SIAM 1997, proves a number that grows with the root of the unknowns at most). What it finds is
/// known up to rounding in energy only; contact is where the force exceeds the gap times the
/// diagonal.
pub(super) struct InteriorPoint<'a, T> {
    inequality: &'a Inequality<T>,
    free: Vec<u32>,
    values: Vec<f64>,
    diagonal: Vec<f64>,
    walls: Vec<Wall>,
    /// Linear systems solved.
    pub steps: usize,
}

impl<'a, T: Real> InteriorPoint<'a, T> {
    /// Starts on the central path near given values.
    pub fn new(inequality: &'a Inequality<T>, near: &[T]) -> Self {
        let bounds = &inequality.bounds;
        let n = inequality.size();
        let values: Vec<f64> =
            (0..n).map(|i| bounds[i].only_value().unwrap_or(near[i]).to_f64()).collect();
        let free: Vec<u32> =
            (0..n).filter(|&i| bounds[i].only_value().is_none()).map(|i| i as u32).collect();
        let diagonal: Vec<f64> = (0..n).map(|i| positive_diagonal(inequality, i)).collect();
        let mut point = Self { inequality, free, values, diagonal, walls: Vec::new(), steps: 0 };
        let mut deficit = vec![0.0; n];
        let energy = point.deficit(&mut deficit);
        let count = |i: &u32| bounds[*i as usize].is_inequality();
        let product = START * energy / point.free.iter().filter(|i| count(i)).count().max(1) as f64;
        for k in 0..point.free.len() {
            point.wall(point.free[k] as usize, &deficit, product);
        }
        point
    }

    /// Moves an unknown to where gap and force have a given product, both as near as may be to what
    /// they are: without neighbours the step of Jacobi's method ends at `along` from the bound, and
    /// on the central path `gap - product / (diagonal gap)` is that number.
    fn wall(&mut self, i: usize, deficit: &[f64], product: f64) {
        let bound = &self.inequality.bounds[i];
        let (lower, upper) = (bound.lower().map(T::to_f64), bound.upper().map(T::to_f64));
        let jacobi = self.values[i] + deficit[i] / self.diagonal[i];
        let noise = product / self.diagonal[i];
        let off = |along: f64| 0.5 * along.hypot(2.0 * noise.sqrt()) + 0.5 * along;
        self.values[i] = match (lower, upper) {
            (Some(l), Some(u)) => {
                let margin = off(0.0).min(0.25 * (u - l));
                jacobi.clamp(l + margin, u - margin)
            }
            (Some(l), None) => l + off(jacobi - l),
            (None, Some(u)) => u - off(u - jacobi),
            (None, None) => return,
        };
        for (bound, side) in [(lower, 1.0), (upper, -1.0)] {
            if let Some(bound) = bound {
                let gap = side * (self.values[i] - bound);
                let force = product / gap;
                self.walls.push(Wall { unknown: i, side, gap, force, gap_step: 0.0, force_step: 0.0 });
            }
        }
    }

    /// Approaches the solution; the contact states found, or `None` if a matrix has no factors or
    /// a number is not finite.
    pub fn run(&mut self) -> Option<Vec<Contact>> {
        let mut deficit = vec![0.0; self.values.len()];
        let (mut least, mut idle) = (f64::INFINITY, 0);
        let mut before = Vec::new();
        while self.steps < MOST {
            let energy = self.deficit(&mut deficit);
            let mean = self.mean_product();
            if !mean.is_finite() || !energy.is_finite() {
                return None;
            }
            idle = if mean < 0.5 * least { 0 } else { idle + 1 };
            least = if idle == 0 { mean } else { least };
            let share = mean * self.walls.len() as f64 / energy;
            let contact = self.contact();
            let is_steady = share <= NEAR && contact == before;
            if std::env::var("DBG").is_ok() { eprintln!("    ip {} share {share:.1e} contact {} moved {}", self.steps, contact.iter().filter(|c| **c != Contact::Open).count(), contact.iter().zip(&before).filter(|(a, b)| a != b).count()); }
            before = contact;
            if is_steady || share <= CLOSE || idle > PATIENCE {
                break;
            }
            self.step(&deficit, mean)?;
        }
        Some(self.contact())
    }

    /// The values, inside their bounds.
    pub fn values(&self) -> Vec<T> {
        let nearest = |(x, bound): (&f64, &crate::algebra::Bound<T>)| bound.nearest(T::lit(*x));
        self.values.iter().zip(&self.inequality.bounds).map(nearest).collect()
    }

    /// One step; `None` without factors.
    fn step(&mut self, deficit: &[f64], mean: f64) -> Option<()> {
        self.steps += 1;
        let mut matrix = self.inequality.matrix.clone();
        for wall in &self.walls {
            let i = wall.unknown;
            let start = matrix.row_starts[i] as usize;
            let place = matrix.row(i).0.binary_search(&(i as u32)).ok()?;
            matrix.values[start + place] += T::lit(wall.force / wall.gap);
        }
        let factors = Factors::new(&matrix, self.inequality.symmetric, &self.free).ok()?;
        // the predictor heads for zero, the corrector for what the predictor's length suggests
        let zero = vec![0.0; self.walls.len()];
        self.direct(&factors, deficit, &zero);
        let length = self.longest();
        let products = |w: &Wall| (w.gap + length * w.gap_step) * (w.force + length * w.force_step);
        let reached = self.walls.iter().map(products).sum::<f64>() / self.walls.len().max(1) as f64;
        let centre = mean * (reached / mean).powi(3);
        let targets: Vec<f64> =
            self.walls.iter().map(|w| centre - w.gap_step * w.force_step).collect();
        let step = self.direct(&factors, deficit, &targets);
        let longest = self.longest();
        let length = if longest < 1.0 { SHARE * longest } else { 1.0 };
        for (&i, step) in self.free.iter().zip(&step) {
            self.values[i as usize] += length * step.to_f64();
        }
        for wall in &mut self.walls {
            wall.gap += length * wall.gap_step;
            wall.force += length * wall.force_step;
        }
        Some(())
    }

    /// The Newton step for given products of gaps and forces.
    fn direct(&mut self, factors: &Factors<T>, deficit: &[f64], targets: &[f64]) -> Vec<T> {
        let mut right = deficit.to_vec();
        for (wall, target) in self.walls.iter().zip(targets) {
            // the force after the step if the unknown did not move
            right[wall.unknown] += wall.side * (target / wall.gap - wall.force);
        }
        let mut step: Vec<T> = self.free.iter().map(|&i| T::lit(right[i as usize])).collect();
        factors.solve_in_place(&mut step, 1);
        for (&i, step) in self.free.iter().zip(&step) {
            right[i as usize] = step.to_f64();
        }
        for (wall, target) in self.walls.iter_mut().zip(targets) {
            wall.follow(right[wall.unknown], *target);
        }
        step
    }

    fn longest(&self) -> f64 {
        self.walls.iter().map(Wall::longest).fold(1.0, f64::min)
    }

    fn mean_product(&self) -> f64 {
        self.walls.iter().map(|w| w.gap * w.force).sum::<f64>() / self.walls.len().max(1) as f64
    }

    /// `b - A u` and the forces of all bounds; returns the energy.
    fn deficit(&self, deficit: &mut [f64]) -> f64 {
        let Inequality { matrix, load, .. } = self.inequality;
        for i in 0..deficit.len() {
            let (columns, entries) = matrix.row(i);
            let terms = columns.iter().zip(entries);
            let product: f64 = terms.map(|(&j, a)| a.to_f64() * self.values[j as usize]).sum();
            deficit[i] = load[i].to_f64() - product;
        }
        let energy = self.energy();
        for wall in &self.walls {
            deficit[wall.unknown] += wall.side * wall.force;
        }
        energy
    }

    /// The size of energies in this problem.
    fn energy(&self) -> f64 {
        let terms = self.values.iter().zip(&self.inequality.load).zip(&self.diagonal);
        let load: f64 =
            terms.map(|((x, b), d)| (x * b.to_f64()).abs() + b.to_f64().powi(2) / d).sum();
        if load > 0.0 { load } else { 1.0 }
    }

    /// Contact where the force is larger than what the diagonal makes of the gap.
    fn contact(&self) -> Vec<Contact> {
        let mut contact = vec![Contact::Open; self.values.len()];
        for wall in &self.walls {
            if wall.force > self.diagonal[wall.unknown] * wall.gap {
                let side = if wall.side > 0.0 { Contact::Lower } else { Contact::Upper };
                contact[wall.unknown] = side;
            }
        }
        contact
    }
}

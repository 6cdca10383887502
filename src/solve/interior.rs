//! A primal-dual interior point method: where to start when the active set does not settle.

use super::hybrid::Hybrid;
use super::shifted::{Pair, Shifted, ShiftedFactors};
use crate::algebra::{Contact, Inequality};
use crate::real::Real;

/// Share of the way to the nearest bound that a step goes.
const SHARE: f64 = 0.995;

/// Complementarity over energy below which contact and gap are told apart.
const CLOSE: f64 = 1e-18;

/// Complementarity over energy to start with.
const START: f64 = 1e-2;

/// The same below which contact is believed where it is plain and was the same a step before.
const NEAR: f64 = 1e-9;

/// The same above which slow progress is due to the start, not to rounding.
const FAR: f64 = 1e-8;

/// How far the shares that a step leaves of gap and force are apart where contact is plain to see.
const CLEAR: f64 = 0.5;

/// Most steps.
pub(super) const MOST: usize = 60;

/// Where so many steps do not halve the products of gaps and forces, rounding rules, or the start
/// was bad.
const PATIENCE: usize = 3;

/// One bound of one unknown: `side` times the unknown is above `side` times the bound by `gap`. Both
/// gap and force are about to move along parabolas.
struct Wall {
    unknown: usize,
    side: f64,
    gap: f64,
    force: f64,
    gap_step: [f64; 2],
    force_step: [f64; 2],
    /// What share of themselves the last step left of gap and force.
    left: [f64; 2],
}

impl Wall {
    /// Gap and force after a step of this length.
    fn at(&self, length: f64) -> (f64, f64) {
        let along = |[slope, bend]: [f64; 2]| length * (slope + length * bend);
        (self.gap + along(self.gap_step), self.force + along(self.force_step))
    }

    /// The longest step, at most one, that leaves gap and force positive.
    fn longest(&self) -> f64 {
        first_zero(self.gap, self.gap_step).min(first_zero(self.force, self.force_step)).min(1.0)
    }
}

/// The least positive zero of `value + slope t + bend t^2`, infinity if there is none; the value is
/// positive.
fn first_zero(value: f64, [slope, bend]: [f64; 2]) -> f64 {
    let discriminant = slope * slope - 4.0 * bend * value;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    // the form of the formula in which nothing cancels
    let root = discriminant.sqrt();
    let zero = 2.0 * value / (root - slope);
    if zero > 0.0 { zero } else { f64::INFINITY }
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
///
/// Where the matrix is kept factored the forces of jumps are unknowns too, and what they and jumps
/// disagree by falls with the deficit: no weight meets a stiffness, and a start that is moved off
/// its bounds does not set loose the forces of its penalties.
pub(super) struct InteriorPoint<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    matrix: Shifted<'h, 'a, T>,
    at: Pair,
    diagonal: Vec<f64>,
    walls: Vec<Wall>,
    /// Linear systems solved.
    pub steps: usize,
}

impl<'h, 'a, T: Real> InteriorPoint<'h, 'a, T> {
    /// Starts on the central path near given values and forces of jumps.
    pub fn new(
        inequality: &'a Inequality<T>,
        hybrid: Option<&'h Hybrid<'a, T>>,
        near: &[T],
        forces: &[T],
    ) -> Self {
        let bounds = inequality.bounds.iter().zip(near);
        let values = bounds.map(|(bound, &x)| bound.only_value().unwrap_or(x).to_f64()).collect();
        let forces = forces.iter().map(|force| force.to_f64()).collect();
        let matrix = Shifted::new(inequality, hybrid);
        let diagonal = (0..inequality.size()).map(|i| matrix.stiffness(i)).collect();
        let at = Pair { values, forces };
        let mut point = Self { inequality, matrix, at, diagonal, walls: Vec::new(), steps: 0 };
        point.start(START);
        point
    }

    /// Goes to the central path near the values as they are, where complementarity over energy is a
    /// given number.
    fn start(&mut self, share: f64) {
        self.walls.clear();
        let mut deficit = self.at.clone();
        let energy = self.deficit(&mut deficit);
        let bounds = &self.inequality.bounds;
        let free = self.matrix.free();
        let bounded = free.iter().filter(|&&i| bounds[i as usize].is_inequality()).count();
        let product = share * energy / bounded.max(1) as f64;
        for k in 0..free.len() {
            self.wall(self.matrix.free()[k] as usize, &deficit.values, product);
        }
    }

    /// Moves an unknown to where gap and force have a given product, both as near as may be to what
    /// they are: without neighbours the step of Jacobi's method ends at `along` from the bound, and
    /// on the central path `gap - product / (diagonal gap)` is that number.
    fn wall(&mut self, i: usize, deficit: &[f64], product: f64) {
        let bound = &self.inequality.bounds[i];
        let (lower, upper) = (bound.lower().map(T::to_f64), bound.upper().map(T::to_f64));
        let jacobi = self.at.values[i] + deficit[i] / self.diagonal[i];
        let noise = product / self.diagonal[i];
        let off = |along: f64| 0.5 * along.hypot(2.0 * noise.sqrt()) + 0.5 * along;
        self.at.values[i] = match (lower, upper) {
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
                let gap = side * (self.at.values[i] - bound);
                let force = product / gap;
                self.walls.push(Wall {
                    unknown: i,
                    side,
                    gap,
                    force,
                    gap_step: [0.0; 2],
                    force_step: [0.0; 2],
                    left: [1.0; 2],
                });
            }
        }
    }

    /// Approaches the solution; the contact states found, or `None` if a matrix has no factors or
    /// a number is not finite.
    pub fn run(&mut self) -> Option<Vec<Contact>> {
        let mut deficit = self.at.clone();
        let (mut least, mut idle) = (f64::INFINITY, 0);
        let mut before = Vec::new();
        let mut is_restarted = false;
        while self.steps < MOST {
            let energy = self.deficit(&mut deficit);
            let mean = self.mean_product();
            if !mean.is_finite() || !energy.is_finite() {
                return None;
            }
            let share = mean * self.walls.len() as f64 / energy;
            idle = if share < 0.5 * least { 0 } else { idle + 1 };
            least = if idle == 0 { share } else { least };
            let contact = self.contact();
            let is_steady = share <= NEAR && self.is_clear() && contact == before;
            before = contact;
            if share > FAR && idle > PATIENCE && !is_restarted {
                // a start too close to bounds is stuck there
                (is_restarted, idle, least) = (true, 0, f64::INFINITY);
                self.start(1.0);
                continue;
            }
            if is_steady || share <= CLOSE || idle > PATIENCE {
                break;
            }
            self.step(&deficit, mean)?;
        }
        Some(self.contact())
    }

    /// The forces of jumps.
    pub fn forces(&self) -> Vec<T> {
        self.at.forces.iter().map(|&force| T::lit(force)).collect()
    }

    /// The values, inside their bounds.
    pub fn values(&self) -> Vec<T> {
        let nearest = |(x, bound): (&f64, &crate::algebra::Bound<T>)| bound.nearest(T::lit(*x));
        self.at.values.iter().zip(&self.inequality.bounds).map(nearest).collect()
    }

    /// One step; `None` without factors.
    fn step(&mut self, deficit: &Pair, mean: f64) -> Option<()> {
        self.steps += 1;
        let mut shift = vec![0.0; self.at.values.len()];
        for wall in &self.walls {
            shift[wall.unknown] += wall.force / wall.gap;
        }
        let factors = self.matrix.factor(&shift).ok()?;
        // the first curve ends at zero, the second at what the length of the first suggests
        self.curve(&factors, deficit, 0.0);
        let reached = self.products_at(self.longest());
        let centre = mean * (reached / mean).clamp(0.0, 1.0).powi(3);
        let [slope, bend] = self.curve(&factors, deficit, centre);
        let longest = self.longest();
        let length = if longest < 1.0 { SHARE * longest } else { 1.0 };
        let go = |at: &mut [f64], slope: &[f64], bend: &[f64]| {
            for (x, (slope, bend)) in at.iter_mut().zip(slope.iter().zip(bend)) {
                *x += length * (slope + length * bend);
            }
        };
        go(&mut self.at.values, &slope.values, &bend.values);
        go(&mut self.at.forces, &slope.forces, &bend.forces);
        for wall in &mut self.walls {
            let (gap, force) = wall.at(length);
            wall.left = [gap / wall.gap, force / wall.force];
            (wall.gap, wall.force) = (gap, force);
        }
        Some(())
    }

    /// The parabola that follows the path on which deficit and products, these less `centre`, fall
    /// like `(1 - t)^2`: its slope and its bend.
    fn curve(&mut self, factors: &ShiftedFactors<T>, deficit: &Pair, centre: f64) -> [Pair; 2] {
        let excess = |wall: &Wall| wall.gap * wall.force - centre;
        let rates: Vec<f64> = self.walls.iter().map(|wall| -2.0 * excess(wall)).collect();
        let slope = self.direct(factors, deficit, 2.0, &rates);
        for (wall, rate) in self.walls.iter_mut().zip(&rates) {
            wall.gap_step[0] = wall.gap_step[1];
            wall.force_step[0] = (rate - wall.force * wall.gap_step[0]) / wall.gap;
        }
        let rates: Vec<f64> = self
            .walls
            .iter()
            .map(|wall| excess(wall) - wall.gap_step[0] * wall.force_step[0])
            .collect();
        let bend = self.direct(factors, deficit, -1.0, &rates);
        for (wall, rate) in self.walls.iter_mut().zip(&rates) {
            wall.force_step[1] = (rate - wall.force * wall.gap_step[1]) / wall.gap;
        }
        [slope, bend]
    }

    /// The direction in which the deficit falls at a multiple of itself, products change at given
    /// rates; that of every gap goes into the second place.
    fn direct(
        &mut self,
        factors: &ShiftedFactors<T>,
        deficit: &Pair,
        share: f64,
        rates: &[f64],
    ) -> Pair {
        let mut step = deficit.clone();
        step.values.iter_mut().chain(&mut step.forces).for_each(|r| *r *= share);
        for (wall, rate) in self.walls.iter().zip(rates) {
            step.values[wall.unknown] += wall.side * rate / wall.gap;
        }
        self.matrix.solve(factors, &mut step);
        for wall in &mut self.walls {
            wall.gap_step[1] = wall.side * step.values[wall.unknown];
        }
        step
    }

    fn longest(&self) -> f64 {
        self.walls.iter().map(Wall::longest).fold(1.0, f64::min)
    }

    /// The mean product that a step of this length leaves.
    fn products_at(&self, length: f64) -> f64 {
        let product = |wall: &Wall| {
            let (gap, force) = wall.at(length);
            gap * force
        };
        self.walls.iter().map(product).sum::<f64>() / self.walls.len().max(1) as f64
    }

    fn mean_product(&self) -> f64 {
        self.walls.iter().map(|w| w.gap * w.force).sum::<f64>() / self.walls.len().max(1) as f64
    }

    /// `b - A u` and the forces of all bounds; returns the size of energies.
    fn deficit(&self, deficit: &mut Pair) -> f64 {
        let energy = self.matrix.deficit(&self.at, deficit);
        for wall in &self.walls {
            deficit.values[wall.unknown] += wall.side * wall.force;
        }
        energy
    }

    /// Whether contact is plain to see at every bound: one of gap and force keeps what it has and
    /// the other loses it (El-Bakry, Tapia, Zhang, SIAM Rev. 36 (1994) 45-72).
    fn is_clear(&self) -> bool {
        self.walls.iter().all(|wall| (wall.left[0] - wall.left[1]).abs() > CLEAR)
    }

    /// Contact where more is left of the force than of the gap.
    fn contact(&self) -> Vec<Contact> {
        let mut contact = vec![Contact::Open; self.at.values.len()];
        for wall in self.walls.iter().filter(|wall| wall.left[1] > wall.left[0]) {
            contact[wall.unknown] = if wall.side > 0.0 { Contact::Lower } else { Contact::Upper };
        }
        contact
    }
}

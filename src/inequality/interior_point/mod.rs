//! A primal-dual interior point method: where to start when the active set does not settle.

mod barrier;
mod kkt;

use crate::algebra::{Contact, Inequality};
use crate::linear::direct::StaticCondensation;
use crate::real::Real;
use barrier::{MOST_POWERS, Rest, Wall, longest_step, mean_product};
use kkt::{Pair, Shifted, ShiftedFactors};

/// Complementarity over energy below which contact and gap are told apart.
const CLOSE: f64 = 1e-18;

/// Complementarity over energy to start with.
const START: f64 = 0.1;

/// The same below which contact is believed where it is plain and was the same a step before.
const NEAR: f64 = 1e-10;

/// By how much that is lowered where contact was believed too early.
const NEARER: f64 = 1e-2;

/// The same above which slow progress is due to the start, not to rounding.
const FAR: f64 = 1e-8;

/// How far the shares that a step leaves of gap and force are apart where contact is plain to see.
const CLEAR: f64 = 0.5;

/// Most steps.
pub(crate) const MOST: usize = 60;

/// Where so many steps do not halve the products of gaps and forces, rounding rules, or the start
/// was bad.
const PATIENCE: usize = 3;

/// Powers of the first curve of a step, which only tells how far the second may aim.
const FIRST_POWERS: usize = 2;

/// What another power must leave of the products that a step leaves without, to be worth a solution
/// with the factors there are.
const WORTHWHILE: f64 = 0.95;

/// Powers in vain after which no more are asked for.
const IN_VAIN: usize = 3;

/// Where the interior point method stopped because contact was plain.
pub(crate) struct Path {
    at: Pair,
    walls: Vec<Rest>,
    near: f64,
}

/// A way to go: powers of the length for values and forces, how far, and what that leaves of
/// products.
struct Way {
    powers: Vec<Pair>,
    length: f64,
    left: f64,
}

/// The predictor-corrector method of Mehrotra (SIAM J. Optim. 2 (1992) 575-601) for
/// `A u - b = z_lower - z_upper`, gaps and forces `z` positive, products of both equal to a number
/// that falls to zero.
///
/// The path is followed along its power series (Monteiro, Adler, Resende, Math. Oper. Res. 15
/// (1990) 191-214): every power costs a solution with the factors of the step, which is less than
/// they do.
///
/// Every step solves with `A` plus a positive diagonal, so that it works for every matrix whose
/// symmetric part is positive semidefinite, and knows no combinatorics: a dozen steps or two do
/// whatever the matrix, the penalty and the number of unknowns (Wright, Primal-Dual Interior-Point
/// Methods, SIAM 1997, proves a number that grows with the root of the unknowns at most). What it
/// finds is known up to rounding in energy only; contact is where the last step left more of the
/// force than of the gap.
///
/// Where the matrix is kept factored the forces of jumps are unknowns too, and what they and jumps
/// disagree by falls with the deficit: no weight meets a stiffness, and a start that is moved off
/// its bounds does not set loose the forces of its penalties.
pub(crate) struct InteriorPoint<'h, 'a, T> {
    inequality: &'a Inequality<T>,
    matrix: Shifted<'h, 'a, T>,
    at: Pair,
    diagonal: Vec<f64>,
    walls: Vec<Wall>,
    /// LinearMethod systems solved.
    pub steps: usize,
    /// See [`NEAR`].
    near: f64,
    /// Whether there is nowhere to go from here.
    is_done: bool,
}

impl<'h, 'a, T: Real> InteriorPoint<'h, 'a, T> {
    /// Starts on the central path near given values and forces of jumps.
    pub fn new(
        inequality: &'a Inequality<T>,
        hybrid: Option<&'h StaticCondensation<'a, T>>,
        near: &[T],
        forces: &[T],
    ) -> Self {
        let bounds = inequality.bounds.iter().zip(near);
        let values = bounds.map(|(bound, &x)| bound.fixed_value().unwrap_or(x).to_f64()).collect();
        let forces = forces.iter().map(|force| force.to_f64()).collect();
        let path = Path { at: Pair { values, forces }, walls: Vec::new(), near: NEAR };
        let mut point = Self::resume(inequality, hybrid, path);
        point.start(START);
        point
    }

    /// Starts where it stopped before.
    pub fn resume(
        inequality: &'a Inequality<T>,
        hybrid: Option<&'h StaticCondensation<'a, T>>,
        path: Path,
    ) -> Self {
        let Path { at, walls, near } = path;
        let walls = walls.into_iter().map(Wall::from).collect();
        let matrix = Shifted::new(inequality, hybrid);
        let diagonal = (0..inequality.size()).map(|i| matrix.stiffness(i)).collect();
        Self { inequality, matrix, at, diagonal, walls, steps: 0, near, is_done: false }
    }

    /// What is needed to go on if contact was believed too early, where there is any way to go.
    pub fn into_path(self) -> Option<Path> {
        let near = NEARER * self.near;
        let walls = self.walls.into_iter().map(Rest::from);
        (!self.is_done).then(|| Path { at: self.at, walls: walls.collect(), near })
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
                self.walls.push(Wall::new(i, side, gap, product / gap));
            }
        }
    }

    /// Approaches the solution; the contact states found, or `None` if a matrix has no factors, a
    /// number is not finite, or no step led anywhere.
    pub fn run(&mut self) -> Option<Vec<Contact>> {
        let mut deficit = self.at.clone();
        let (mut least, mut idle) = (f64::INFINITY, 0);
        let mut before = Vec::new();
        let mut is_restarted = false;
        // a path that is resumed had steps before
        let has_moved = self.walls.iter().any(|wall| wall.left != [1.0; 2]);
        let mut last = has_moved.then(|| self.contact());
        while self.steps < MOST {
            let energy = self.deficit(&mut deficit);
            let mean = mean_product(&self.walls, 0.0, 0);
            if !mean.is_finite() || !energy.is_finite() {
                return None;
            }
            let share = mean * self.walls.len() as f64 / energy;
            idle = if share < 0.5 * least { 0 } else { idle + 1 };
            least = if idle == 0 { share } else { least };
            let contact = self.contact();
            let is_steady = share <= self.near && self.is_clear() && contact == before;
            before = contact;
            if share > FAR && idle > PATIENCE && !is_restarted {
                // a start too close to bounds is stuck there
                (is_restarted, idle, least) = (true, 0, f64::INFINITY);
                self.start(1.0);
                continue;
            }
            self.is_done = share <= CLOSE || idle > PATIENCE;
            if is_steady || self.is_done {
                break;
            }
            if !self.step(&deficit, mean)? {
                self.is_done = true;
                return last;
            }
            last = Some(self.contact());
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

    /// One step, unless it leads nowhere: whether it was made; `None` without factors.
    fn step(&mut self, deficit: &Pair, mean: f64) -> Option<bool> {
        self.steps += 1;
        let mut shift = vec![0.0; self.at.values.len()];
        for wall in &self.walls {
            shift[wall.unknown] += wall.force / wall.gap;
        }
        let factors = self.matrix.factor(&shift).ok()?;
        // the first curve ends at zero, the second at what the length of the first suggests
        let reached = self.curve(&factors, deficit, 0.0, FIRST_POWERS).left;
        let centre = mean * (reached / mean).clamp(0.0, 1.0).powi(3);
        let Way { powers, length, .. } = self.curve(&factors, deficit, centre, MOST_POWERS);
        // no power at all if directions are no numbers
        if powers.is_empty() || length <= 0.0 {
            return Some(false);
        }
        let go = |at: &mut [f64], powers: Vec<&[f64]>| {
            for (i, x) in at.iter_mut().enumerate() {
                *x += powers.iter().rev().fold(0.0, |sum, power| length * (sum + power[i]));
            }
        };
        go(&mut self.at.values, powers.iter().map(|power| &power.values[..]).collect());
        go(&mut self.at.forces, powers.iter().map(|power| &power.forces[..]).collect());
        self.walls.iter_mut().for_each(|wall| wall.go(length, powers.len()));
        Some(true)
    }

    /// The curve that follows the path on which deficit and products, these less `centre`, fall
    /// like `(1 - t)^2`; as many powers of it as make the way longer.
    fn curve(
        &mut self,
        factors: &ShiftedFactors<T>,
        deficit: &Pair,
        centre: f64,
        most: usize,
    ) -> Way {
        let mut best = Way { powers: Vec::new(), length: 0.0, left: f64::INFINITY };
        let mut beyond = Vec::new();
        for k in 0..most {
            beyond.push(self.power(factors, deficit, centre, k));
            let powers = k + 1;
            // one alone may go nowhere
            if powers < FIRST_POWERS {
                continue;
            }
            let length = longest_step(&self.walls, powers);
            let left = mean_product(&self.walls, length, powers);
            if left < WORTHWHILE * best.left {
                (best.length, best.left) = (length, left);
                best.powers.append(&mut beyond);
            } else if beyond.len() >= IN_VAIN {
                break;
            }
        }
        best
    }

    /// The coefficient of power `k + 1` of the curve, all lower ones being known.
    fn power(
        &mut self,
        factors: &ShiftedFactors<T>,
        deficit: &Pair,
        centre: f64,
        k: usize,
    ) -> Pair {
        // 1 - (1 - t)^2
        let share = [2.0, -1.0].get(k).copied().unwrap_or(0.0);
        let rate = |wall: &Wall| share * (centre - wall.product()) - wall.mixed(k);
        let rates: Vec<f64> = self.walls.iter().map(rate).collect();
        let step = self.direct(factors, deficit, share, &rates);
        for (wall, rate) in self.walls.iter_mut().zip(rates) {
            wall.set_power(k, wall.side * step.values[wall.unknown], rate);
        }
        step
    }

    /// The direction in which the deficit falls at a multiple of itself, products change at given
    /// rates.
    fn direct(
        &self,
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
        step
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
        let mut contact = vec![Contact::Inactive; self.at.values.len()];
        for wall in self.walls.iter().filter(|wall| wall.left[1] > wall.left[0]) {
            contact[wall.unknown] = if wall.side > 0.0 { Contact::Lower } else { Contact::Upper };
        }
        contact
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::{Bound, SparseMatrix, Start};

    /// Two unknowns above zero that pull at each other, and a load of which twice as much is no number
    /// of the scalar, so that no direction is one.
    fn huge() -> Inequality<f32> {
        let (row_starts, columns) = (vec![0, 2, 4], vec![0, 1, 0, 1]);
        Inequality {
            matrix: SparseMatrix { row_starts, columns, values: vec![1.0, -0.9, -0.9, 1.0] },
            symmetric: true,
            bounds: vec![Bound::Lower(0.0); 2],
            load: vec![3e38; 2],
            supports: vec![],
            points: vec![],
            start: Start::Cold,
            penalised: None,
        }
    }

    #[test]
    fn a_step_that_leads_nowhere_says_nothing() {
        let inequality = huge();
        let mut point = InteriorPoint::new(&inequality, None, &[0.0; 2], &[]);
        let before = point.at.values.clone();
        assert_eq!(point.run(), None);
        assert_eq!((point.at.values.clone(), point.steps), (before, 1));
        assert!(point.into_path().is_none());
    }

    /// What the steps before it said stands.
    #[test]
    fn a_step_that_leads_nowhere_unsays_nothing() {
        let inequality = huge();
        let mut point = InteriorPoint::new(&inequality, None, &[0.0; 2], &[]);
        let lefts = [[0.1, 1.0], [1.0, 0.1]];
        point.walls.iter_mut().zip(lefts).for_each(|(wall, left)| wall.left = left);
        let path = point.into_path().unwrap();
        let mut point = InteriorPoint::resume(&inequality, None, path);
        let before = point.at.values.clone();
        assert_eq!(point.run(), Some(vec![Contact::Lower, Contact::Inactive]));
        assert_eq!(point.steps, 1);
        assert_eq!(point.at.values, before);
        assert!(point.into_path().is_none());
    }
}

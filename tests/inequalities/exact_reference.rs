//! Solves of over-penalised inequalities against references of twice the digits of `f64`: the energy of the
//! difference, which certificates bound little beside large penalties.

use crate::double_precision::{Double, Envelope};
use unilateral::algebra::{Contact, Inequality, JumpTerm, PenalisedMatrix};
use unilateral::assemble::DataQuadrature;
use unilateral::inequality::{ActiveSet, InequalitySolver, Outcome, Solution};
use unilateral::prelude::*;
use unilateral::scenes::{self, AnyScene, Scene};

/// Violations of bounds below this multiple of the largest value, and multipliers of wrong sign below this multiple
/// of the largest load, are rounding in twice the digits beside penalties of up to 1e16 times the stiffness.
const ROUNDING: [f64; 2] = [1e-26, 1e-13];

/// The solution of an inequality whose matrix is penalised, by the primal-dual active set method from the contact of
/// a solution, one change at a time where many do not settle.
struct Reference<'a> {
    inequality: &'a Inequality<f64>,
    penalised: &'a PenalisedMatrix<f64>,
    values: Vec<Double>,
    contact: Vec<Contact>,
    /// The number of active sets.
    steps: usize,
}

/// The unknowns of a jump with their coefficients in it.
fn coefficients(penalised: &PenalisedMatrix<f64>, jump: usize) -> Vec<(usize, f64)> {
    let of_term = |t: &JumpTerm<f64>| [(t.here, t.weight), (t.there, -t.weight)];
    let terms = penalised.terms_of(jump).iter().flat_map(of_term);
    let terms = terms.filter(|&(i, _)| i != JumpTerm::<f64>::NO_UNKNOWN);
    terms.map(|(i, weight)| (i as usize, weight)).collect()
}

impl<'a> Reference<'a> {
    fn new(inequality: &'a Inequality<f64>, solution: &Solution<f64>) -> Self {
        let penalised = inequality.penalised.as_ref().unwrap();
        let values = solution.values.iter().map(|&x| x.into()).collect();
        let contact = solution.contact.clone();
        let mut reference = Self { inequality, penalised, values, contact, steps: 0 };
        loop {
            reference.solve();
            reference.steps += 1;
            let changes = reference.changes();
            let all = if reference.steps <= 30 { changes.len() } else { 1 };
            changes.iter().rev().take(all).for_each(|&(i, state)| reference.contact[i] = state);
            if changes.is_empty() {
                return reference;
            }
            assert!(reference.steps < 2000, "{} changes", changes.len());
        }
    }

    /// The value that an unknown has because of its bounds and its contact state.
    fn prescribed(&self, i: usize) -> Option<f64> {
        let bound = &self.inequality.bounds[i];
        match self.contact[i] {
            _ if bound.fixed_value().is_some() => bound.fixed_value(),
            Contact::Inactive => None,
            Contact::Lower => bound.lower(),
            Contact::Upper => bound.upper(),
        }
    }

    /// The jump multipliers.
    fn jump_multipliers(&self) -> Vec<Double> {
        let multiplier = |k: usize| {
            let terms = self.penalised.terms_of(k).iter();
            let value = |i: u32| match i {
                JumpTerm::<f64>::NO_UNKNOWN => Double::ZERO,
                i => self.values[i as usize],
            };
            let data = Double::ZERO - self.penalised.jump_data[k].into();
            let term = |t: &JumpTerm<f64>| (value(t.here) - value(t.there)) * t.weight.into();
            terms.fold(data, |sum, t| sum + term(t)) * self.penalised.weights[k].into()
        };
        (0..self.penalised.n_jumps()).map(multiplier).collect()
    }

    /// `c - K u - M^T p`.
    fn residual(&self) -> Vec<Double> {
        let (n, blocks) = (self.penalised.block_size(), &self.penalised.blocks);
        let load = &self.inequality.load;
        let entry = |i: usize, j: usize| -> Double { blocks[i * n + j % n].into() };
        let of_block = |i: usize| {
            let columns = i / n * n..i / n * n + n;
            columns.fold(Double::from(load[i]), |sum, j| sum - entry(i, j) * self.values[j])
        };
        let mut residual: Vec<Double> = (0..load.len()).map(of_block).collect();
        for (jump, p) in self.jump_multipliers().into_iter().enumerate() {
            for (i, weight) in coefficients(self.penalised, jump) {
                residual[i] = residual[i] - p * weight.into();
            }
        }
        residual
    }

    /// Solves the system of the present contact, with corrections.
    fn solve(&mut self) {
        let n = self.penalised.block_size();
        let size = self.values.len();
        let mut number = vec![usize::MAX; size];
        let mut inactive = Vec::new();
        for i in 0..size {
            match self.prescribed(i) {
                Some(value) => self.values[i] = value.into(),
                None => {
                    number[i] = inactive.len();
                    inactive.push(i);
                }
            }
        }
        let mut entries: Vec<(usize, usize, Double)> = Vec::new();
        let of_blocks = (0..size).flat_map(|i| (i / n * n..i / n * n + n).map(move |j| (i, j)));
        entries.extend(of_blocks.map(|(i, j)| (i, j, self.penalised.blocks[i * n + j % n].into())));
        for jump in 0..self.penalised.n_jumps() {
            let terms = coefficients(self.penalised, jump);
            let weight = Double::from(self.penalised.weights[jump]);
            for &(i, a) in &terms {
                let of_row = |&(j, b): &(usize, f64)| (i, j, weight * a.into() * b.into());
                entries.extend(terms.iter().map(of_row));
            }
        }
        let is_inactive = |i: usize| number[i] < usize::MAX;
        entries.retain(|&(i, j, _)| is_inactive(i) && is_inactive(j) && j <= i);
        let mut firsts: Vec<usize> = (0..inactive.len()).collect();
        for &(i, j, _) in &entries {
            firsts[number[i]] = firsts[number[i]].min(number[j]);
        }
        let mut matrix = Envelope::new(firsts);
        entries.into_iter().for_each(|(i, j, a)| matrix.add(number[i], number[j], a));
        matrix.factor();
        for _ in 0..3 {
            let residual = self.residual();
            let mut correction: Vec<Double> = inactive.iter().map(|&i| residual[i]).collect();
            matrix.solve(&mut correction);
            for (&i, correction) in inactive.iter().zip(correction) {
                self.values[i] = self.values[i] + correction;
            }
        }
    }

    /// The unknowns whose contact state is wrong, and the right states.
    fn changes(&self) -> Vec<(usize, Contact)> {
        let [of_values, of_loads] = ROUNDING;
        let residual = self.residual();
        let largest = self.values.iter().map(|x| x.high.abs()).fold(0.0, f64::max);
        let largest_load = self.inequality.load.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let mut changes = Vec::new();
        for (i, bound) in self.inequality.bounds.iter().enumerate() {
            let beyond = |b: f64, side: f64| (self.values[i] - b.into()).high * side;
            let (r, limit) = (residual[i].high, of_loads * largest_load);
            let state = match (self.contact[i], bound.lower(), bound.upper()) {
                _ if !bound.is_inequality() => continue,
                (Contact::Lower, ..) if r > limit => Contact::Inactive,
                (Contact::Upper, ..) if r < -limit => Contact::Inactive,
                (Contact::Inactive, Some(l), _) if beyond(l, -1.0) > of_values * largest => {
                    Contact::Lower
                }
                (Contact::Inactive, _, Some(u)) if beyond(u, 1.0) > of_values * largest => {
                    Contact::Upper
                }
                _ => continue,
            };
            changes.push((i, state));
        }
        changes
    }

    /// The energy norm of the difference of a solution from this one divided by the energy norm of this one, with
    /// jump multipliers.
    fn distance(&self, solution: &Solution<f64>) -> f64 {
        let PenalisedMatrix { weights, jump_data, .. } = self.penalised;
        let difference = |i: usize| (Double::from(solution.values[i]) - self.values[i]).high;
        let exact = self.jump_multipliers();
        let multiplier = |k: usize| match solution.jump_multipliers.get(k) {
            Some(&p) => Double::from(p) - exact[k],
            None => {
                let jump = self.penalised.jump(k, |i| solution.values[i]) - jump_data[k];
                Double::from(weights[k] * jump) - exact[k]
            }
        };
        let energy = |u: &dyn Fn(usize) -> f64, p: &dyn Fn(usize) -> f64| {
            let values = (0..self.values.len()).map(|i| u(i) * self.penalised.stiffness(i, u));
            let jumps = weights.iter().enumerate().map(|(k, weight)| p(k).powi(2) / weight);
            values.sum::<f64>() + jumps.sum::<f64>()
        };
        let error = energy(&difference, &|k| multiplier(k).high);
        (error / energy(&|i| self.values[i].high, &|k| exact[k].high)).max(0.0).sqrt()
    }
}

/// The inequality of WOPSIP on quadratics on a scene, with bounds at nodes.
fn of(scene: &Scene<2>, eta: &str, level: usize) -> Inequality<f64> {
    let name = if eta == "default" { "wopsip-p2".into() } else { format!("wopsip-p2@eta={eta}") };
    let scheme: NamedScheme = name.parse().unwrap();
    let made = scheme.make::<2>();
    let mesh = scene.domain.mesh(level).unwrap();
    let space = made.discretise(&scene.problem, &mesh, DataQuadrature::default());
    space.unwrap().inequality().unwrap()
}

/// The scenes of the pages on solvers.
const SCENES: [&str; 6] =
    ["radial-2d", "torsion-2d", "lshape-2d", "ball-2d", "disc-2d", "contrast-2d"];

const ETAS: [&str; 6] = ["default", "1e-2", "1e2", "1e4", "1e7", "1e10"];

/// A scene of the catalogue.
fn made(name: &str) -> AnyScene {
    scenes::by_name(name).unwrap().make(&scenes::Parameters::default()).unwrap()
}

/// The distance of a solve with factors from the reference, with the number of its systems.
fn solve(name: &str, eta: &str, level: usize) -> (f64, usize) {
    let AnyScene::Two(scene) = made(name) else { panic!("{name}") };
    let inequality = of(&scene, eta, level);
    let solution = ActiveSet::default().solve(&inequality);
    assert_eq!(solution.outcome, Outcome::Converged, "{name} {eta} {level}");
    (Reference::new(&inequality, &solution).distance(&solution), solution.outer)
}

#[test]
fn quadratics_have_the_digits_of_an_exact_reference_for_every_penalty() {
    for name in SCENES {
        for eta in ETAS {
            let (distance, _) = solve(name, eta, 4);
            // the last active set does not settle there, and the values are those of the interior point method
            let is_interior =
                [("lshape-2d", "1e10"), ("contrast-2d", "1e7")].contains(&(name, eta));
            let limit = if is_interior { 1e-8 } else { 1e-10 };
            assert!(distance < limit, "{name} {eta}: {distance:e}");
        }
    }
    // violations below the rounding of the largest value remain
    let (distance, _) = solve("contrast-2d", "1e4", 8);
    assert!(distance < 1e-8, "contrast-2d: {distance:e}");
}

/// Twice the digits hold: the pivots of this matrix of Hilbert are lost in `f64`.
#[test]
fn systems_in_twice_the_digits_are_exact() {
    let n = 14;
    let mut matrix = Envelope::new(vec![0; n]);
    let entry = |i: usize, j: usize| Double::from(1.0) / Double::from((i + j + 1) as f64);
    (0..n * n).for_each(|k| matrix.add(k / n, k % n, entry(k / n, k % n)));
    // row sums, so that the solution is one everywhere
    let sum = |i: usize| (0..n).fold(Double::ZERO, |s, j| s + entry(i, j));
    let mut x: Vec<Double> = (0..n).map(sum).collect();
    matrix.factor();
    matrix.solve(&mut x);
    let error = x.iter().map(|&x| (x - 1.0.into()).high.abs()).fold(0.0, f64::max);
    assert!(error < 1e-11, "{error:e}");
}

#[test]
#[ignore = "takes minutes: prints the distances"]
fn distances_table() {
    let levels = std::env::var("LEVELS").unwrap_or("8,16".into());
    let levels: Vec<usize> = levels.split(',').map(|n| n.parse().unwrap()).collect();
    for name in SCENES {
        for eta in ETAS {
            let found = levels.iter().map(|&level| solve(name, eta, level));
            let cells: Vec<String> = found.map(|(d, steps)| format!("{d:.0e} ({steps})")).collect();
            println!("| {name} | {eta} | {} |", cells.join(" | "));
        }
    }
}

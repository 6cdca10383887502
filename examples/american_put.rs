//! An American put by implicit steps: a share with the price `S` may be sold for the strike `K` at any time up to expiry.
//! In `x = ln(S / K)` and the time `t` to expiry, with the variance `2 a = sigma^2` and the rate `r`, the worth
//! `K e^(g x) u` of the put solves, with `g = (a - r) / (2 a)` and `c = r + (r - a)^2 / (4 a)`,
//!
//! ```text
//! du/dt - a u'' + c u >= 0,   u >= psi = e^(-g x) max(1 - e^x, 0),   one of both with equality,   u = psi at t = 0
//! ```
//!
//! (F. Black, M. Scholes, J. Polit. Econ. 81 (1973), 637-654; R. C. Merton, Bell J. Econ. 4 (1973), 141-183.) Each step is
//! an obstacle problem with the reaction `c + 1/dt` and the load `u_old / dt`, and starts from the last contact set. The
//! put is exercised below a price that falls from `K` with the time to expiry. Both are compared with a binomial tree
//! (J. C. Cox, S. A. Ross, M. Rubinstein, J. Financial Econ. 7 (1979), 229-263).
//!
//! `cargo run --release --example american_put` prints errors and orders, and the exercise price over time.

use unilateral::nested::KeptSolution;
use unilateral::prelude::*;

/// Strike, rate and volatility of a put that expires after one year.
const STRIKE: f64 = 100.0;
const RATE: f64 = 0.05;
const VOLATILITY: f64 = 0.2;
/// The domain in `x` is `(-WIDTH, WIDTH)`: five standard deviations.
const WIDTH: f64 = 1.0;
/// Times to expiry at which the exercise price is printed.
const PRINTED: usize = 16;

/// The worth of a put at the strike a year before expiry with its first and second derivative by the price, and the exercise
/// prices at times to expiry.
pub struct Worth {
    pub at_strike: f64,
    pub delta: f64,
    pub gamma: f64,
    pub exercise: Vec<[f64; 2]>,
}

/// The exercise price from the worth above that of immediate exercise at points `x` beyond the exercise price, ascending:
/// the excess grows like the square of the distance in `x`, and its root is continued to zero from two points.
fn exercise_price(mut excess: impl Iterator<Item = (f64, f64)>) -> f64 {
    match (excess.next(), excess.next()) {
        (Some((x, e)), Some((y, f))) if f > e => {
            STRIKE * (x - e.sqrt() * (y - x) / (f.sqrt() - e.sqrt())).exp()
        }
        _ => f64::NAN,
    }
}

/// The worth by a binomial tree with so many steps in the last year before expiry. It begins before, so that its prices
/// a year before expiry are many.
pub fn by_tree(steps: usize) -> Worth {
    let (dt, all) = (1.0 / steps as f64, steps + 2 * (steps / 4));
    let up = VOLATILITY * dt.sqrt();
    let p = ((RATE * dt).exp() - (-up).exp()) / (up.exp() - (-up).exp());
    let discount = (-RATE * dt).exp();
    let x = |n: usize, j: usize| (2.0 * j as f64 - n as f64) * up;
    let payoffs: Vec<f64> = (0..=2 * all).map(|k| 1.0 - (x(2 * all, k) / 2.0).exp()).collect();
    let payoff = |n: usize, j: usize| payoffs[all + 2 * j - n].max(0.0);
    let mut worth: Vec<f64> = (0..=all).map(|j| payoff(all, j)).collect();
    let mut exercise = vec![[0.0, STRIKE]];
    for n in (all - steps..all).rev() {
        for j in 0..=n {
            let held = discount * (p * worth[j + 1] + (1.0 - p) * worth[j]);
            worth[j] = held.max(payoff(n, j));
        }
        let done = all - n;
        if done * PRINTED % steps < PRINTED {
            let excess = (0..=n).map(|j| (x(n, j), worth[j] - payoff(n, j)));
            exercise.push([done as f64 * dt, exercise_price(excess.filter(|(_, e)| *e > 1e-12))]);
        }
    }
    let middle = (all - steps) / 2;
    let [below, at, above] = [middle - 1, middle, middle + 1].map(|j| worth[j]);
    let delta = (above - below) / (4.0 * up);
    let gamma = ((above - 2.0 * at + below) / (2.0 * up).powi(2) - delta) / STRIKE;
    Worth { at_strike: STRIKE * at, delta, gamma, exercise }
}

/// The worth by a scheme on so many cells and with so many implicit steps.
pub fn by_steps(scheme: &dyn Scheme<1>, cells: usize, steps: usize) -> Result<Worth, Error> {
    let dt = 1.0 / steps as f64;
    let a = VOLATILITY * VOLATILITY / 2.0;
    let (g, c) = ((a - RATE) / (2.0 * a), RATE + (RATE - a).powi(2) / (4.0 * a));
    let psi = move |x: &Point<1>| (-g * x[0]).exp() * (1.0 - x[0].exp()).max(0.0);
    let mesh = Mesh::<1>::kuhn_box(&BoxDomain::centred(WIDTH), [cells])?;
    let step = Problem::new()
        .coefficient(move |_| a)
        .reaction(c + 1.0 / dt)
        .obstacle_below(psi)
        .dirichlet(psi);
    let mut last: Option<KeptSolution<1>> = None;
    let mut exercise = vec![[0.0, STRIKE]];
    for k in 1..=steps {
        let problem = match &last {
            None => step.clone().source(move |x| psi(x) / dt),
            Some(last) => step.clone().source_in("default", last.function.times(1.0 / dt)),
        };
        let mut iteration = NestedIteration::new(&problem, &mesh);
        if let Some(last) = &last {
            iteration = iteration.start_from(&last.solution);
        }
        let u = iteration.solve(scheme)?;
        assert!(u.converged(), "step {k} of {steps}: {}", u.outcome());
        last = u.keep();
        if let (Some(last), Some(fields), true) = (&last, u.fields(), k * PRINTED % steps < PRINTED)
        {
            let touching = fields.discrete_contact.cells.iter().flat_map(|&cell| mesh.cell(cell));
            let ends = touching.map(|&v| mesh.vertices()[v as usize][0]);
            let end = ends.fold(-WIDTH, f64::max);
            let excess = |x: &Point<1>| Some((x[0], last.function.value_at(x)? - psi(x)));
            let beyond = mesh.vertices().iter().filter(|x| x[0] > end).filter_map(excess);
            exercise.push([k as f64 * dt, exercise_price(beyond)]);
        }
    }
    let function = last.expect("there is at least one step").function;
    // vertices in the order of x, one of them at the strike
    let (slopes, middle) = (function.recovered_gradient(), cells / 2);
    let [below, slope, above] = [middle - 1, middle, middle + 1].map(|v| slopes[v][0]);
    let curvature = (above - below) * cells as f64 / (4.0 * WIDTH);
    let at = function.value_at(&Point::zeros()).unwrap_or(f64::NAN);
    let delta = g * at + slope;
    let gamma = (g * g * at + 2.0 * g * slope + curvature - delta) / STRIKE;
    Ok(Worth { at_strike: STRIKE * at, delta, gamma, exercise })
}

fn main() -> Result<(), Error> {
    let schemes: [Box<dyn Scheme<1>>; 3] =
        [Box::new(ConformingP1), Box::new(Sipg::default()), Box::new(Wopsip::default())];
    // means over an even and an odd number of steps do not oscillate, and have errors of order one
    let mean = |steps| (by_tree(steps).at_strike + by_tree(steps + 1).at_strike) / 2.0;
    let [coarse, fine] = [2048, 4096].map(mean);
    let price = 2.0 * fine - coarse;
    println!("binomial tree: {price:.5}, last extrapolated by {:.0e}", (fine - coarse).abs());
    let tree = by_tree(8192);
    println!("delta {:.4}, gamma {:.5}", tree.delta, tree.gamma);
    let mut curves = vec![("tree", tree.exercise.clone())];
    for scheme in &schemes {
        let on_fine = by_steps(&**scheme, 2048, 16)?.at_strike;
        for (what, levels, exact) in [
            ("space and time", [(32, 16), (64, 64), (128, 256), (256, 1024)], price),
            ("time", [(1024, 16), (1024, 32), (1024, 64), (1024, 128)], price),
            ("space, against 2048 cells", [(64, 16), (128, 16), (256, 16), (512, 16)], on_fine),
        ] {
            println!("\n{}, refined in {what}", scheme.name());
            println!(
                "cells steps   price    error (order)  exercise price (error)  delta    gamma"
            );
            let mut before: Option<f64> = None;
            for (cells, steps) in levels {
                let found = by_steps(&**scheme, cells, steps)?;
                let error = (found.at_strike - exact).abs();
                let order = before.map_or(String::new(), |b| format!("{:.2}", (b / error).log2()));
                let last = [&found, &tree].map(|w| w.exercise[PRINTED][1]);
                print!("{cells:5} {steps:5} {:.5} {error:.2e} ({order:>4})", found.at_strike);
                print!("  {:.3} ({:.1e})        ", last[0], (last[0] - last[1]).abs());
                println!(" {:.4}  {:.5}", found.delta, found.gamma);
                before = Some(error);
                if (cells, steps) == (256, 1024) {
                    curves.push((scheme.name(), found.exercise));
                }
            }
        }
    }
    let names: Vec<&str> = curves.iter().map(|(name, _)| *name).collect();
    println!("\ntime to expiry, exercise price by {}", names.join(", "));
    for k in 0..=PRINTED {
        print!("{:.4}", curves[0].1[k][0]);
        curves.iter().for_each(|(_, prices)| print!(" {:8.3}", prices[k][1]));
        println!();
    }
    Ok(())
}

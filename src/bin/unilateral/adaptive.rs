//! The option `--adaptive`.

use unilateral::input::excerpt;
use unilateral::nested::Adaptivity;

use crate::shared::Request;

/// A bound that is the goal, such as `1e-2`, or keys such as `theta=0.5,steps=12,unknowns=1e6,goal=1e-2`.
pub fn adaptivity(text: &str) -> Request<Adaptivity> {
    if let Ok(goal) = text.parse() {
        return checked(Adaptivity::to_bound(goal));
    }
    let mut of = Adaptivity::default();
    for item in text.split(',') {
        let (key, value) = item.split_once('=').unwrap_or((item, ""));
        let wrong = |kind: &str| format!("{key} takes {kind}, not \"{}\"", excerpt(value));
        let number = || value.parse::<f64>().map_err(|_| wrong("a number, such as 0.5 or 1e6"));
        let count = || match number()? {
            n if n >= 0.0 && n.fract() == 0.0 && n <= 1e15 => Ok(n as usize),
            _ => Err(wrong("a whole number, such as 12 or 1e6")),
        };
        of = match key {
            "theta" => of.theta(number()?),
            "goal" => of.goal(number()?),
            "steps" => of.steps(count()?),
            "unknowns" => of.unknowns(count()?),
            _ => {
                let key = excerpt(item);
                return Err(format!(
                    "\"{key}\" is neither a bound nor one of theta=X, goal=X, steps=N, unknowns=N"
                ));
            }
        };
    }
    checked(of)
}

fn checked(of: Adaptivity) -> Request<Adaptivity> {
    of.check().map(|()| of).map_err(|e| e.to_string())
}

/// The refinement in one line, for what a report says of its request.
pub fn words(of: &Adaptivity) -> String {
    let Adaptivity { theta, goal, steps, unknowns, .. } = of;
    let goal = goal.map_or_else(String::new, |goal| format!(" to the bound {goal:?}"));
    format!("theta {theta:?}{goal}, at most {steps} steps and {unknowns} unknowns")
}

//! Values for the constants of a problem file.

use std::path::Path;

use clap::Args;
use unilateral::input::excerpt;
use unilateral::problem_file::{ProblemFile, read_with};

use crate::asked::PROBLEM;
use crate::shared::{Request, each_once};

/// The option that replaces constants.
#[derive(Args, Clone, Debug, Default)]
pub struct Constants {
    /// Another value of a constant of PROBLEM.toml, or a sweep of several
    #[arg(help_heading = PROBLEM, long, value_name = "NAME=X[,X...]", value_parser = constant)]
    pub set: Vec<(String, Vec<f64>)>,
}

impl Constants {
    /// The problems of a file, one for each combination of values; warnings of its mesh file go to `warn`.
    pub fn problems(&self, path: &Path, warn: &dyn Fn(String)) -> Request<Vec<ProblemFile>> {
        let names: Vec<&String> = self.set.iter().map(|(name, _)| name).collect();
        if let Some(name) = (1..names.len()).find(|&k| names[..k].contains(&names[k])) {
            let name = excerpt(names[name]);
            return Err(format!("--set {name}: twice; several values stand in one: {name}=1,2"));
        }
        let problems = read_with(path, &self.set).map_err(|e| e.to_string())?;
        let warnings = problems.iter().flat_map(|read| &read.warnings);
        each_once(&warnings.collect::<Vec<_>>()).iter().for_each(|w| warn(format!("warning: {w}")));
        Ok(problems)
    }

    /// Refuses constants of a problem where there is none.
    pub fn check_absent(&self) -> Request<()> {
        match self.set.first() {
            None => Ok(()),
            Some((name, _)) => Err(format!(
                "--set {}: a constant of PROBLEM.toml, and none is named",
                excerpt(name)
            )),
        }
    }

    /// The constants with one value, which no name of a problem says.
    pub fn unnamed(&self) -> impl Iterator<Item = (&str, f64)> {
        self.set.iter().filter_map(|(name, values)| match values[..] {
            [value] => Some((&name[..], value)),
            _ => None,
        })
    }
}

/// A name and its values.
fn constant(text: &str) -> Request<(String, Vec<f64>)> {
    let wrong = || "expected NAME=X[,X...], as load=1,2.5".to_owned();
    let (name, values) = text.split_once('=').ok_or_else(wrong)?;
    let value = |text: &str| text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong);
    let values = values.split(',').map(value).collect::<Request<Vec<f64>>>()?;
    if let Some(k) = (1..values.len()).find(|&k| values[..k].contains(&values[k])) {
        return Err(format!("{} stands twice", values[k]));
    }
    Ok((name.to_owned(), values))
}

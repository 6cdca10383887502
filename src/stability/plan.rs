//! The jobs of a stability study.

use super::choice::{Choice, NAMES};
use super::row::StabilityRow;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::scheme::NamedScheme;
use crate::study::row::distinct;

/// How many meshes and values of each sweep are run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// The coarsest meshes: figures mean little, but every criterion has its rows.
    Trial,
    /// Coarse meshes and few places of each sweep; every criterion has its rows.
    #[default]
    Quick,
    /// All sweeps.
    Full,
}

/// A function that takes rows as they are computed.
pub(crate) type Sink<'s> = &'s mut dyn FnMut(StabilityRow);

/// A function that computes rows.
type Run<'p> = Box<dyn Fn(Sink<'_>) -> Result<(), Error> + 'p>;

/// A unit of work whose rows do not depend on other jobs.
pub(super) struct Job<'p> {
    pub(super) case: &'static str,
    pub(super) label: String,
    pub(super) run: Run<'p>,
}

/// The jobs of a study.
pub(crate) struct Plan<'p> {
    pub(super) effort: Effort,
    /// The schemes that users ask for; all of the study if there is none.
    pub(super) wanted: Vec<NamedScheme>,
    /// Meshes that users give, with their names.
    pub(super) given: &'p [(String, Mesh<3>)],
    /// The case to which jobs are added.
    pub(super) case: &'static str,
    pub(super) jobs: Vec<Job<'p>>,
}

impl<'p> Plan<'p> {
    /// One of two, by effort.
    pub fn pick<T>(&self, quick: T, full: T) -> T {
        if self.effort == Effort::Full { full } else { quick }
    }
    /// One of three, by effort.
    pub fn pick_of<T>(&self, trial: T, quick: T, full: T) -> T {
        if self.effort == Effort::Trial { trial } else { self.pick(quick, full) }
    }
    /// The schemes that every case compares: those of the study and those that users ask for besides.
    pub fn compared(&self) -> Vec<Choice> {
        let of_study = NAMES[..6].iter().map(|name| Choice::of(name));
        let besides = self.wanted.iter().filter(|scheme| !NAMES.contains(&&scheme.to_string()[..]));
        of_study.chain(besides.copied().map(Choice::new)).collect()
    }
    /// The same, followed by further choices of this case.
    pub fn compared_and(&self, of_case: &[Choice]) -> Vec<Choice> {
        distinct(self.compared().into_iter().chain(of_case.iter().copied()))
    }
    /// Adds work on a scheme, if users ask for this choice or for its scheme without choices.
    pub fn add(
        &mut self,
        choice: Choice,
        what: &str,
        run: impl Fn(&Choice, Sink<'_>) -> Result<(), Error> + 'p,
    ) {
        let names = [choice.label(), choice.scheme()];
        let is_wanted = |scheme: &NamedScheme| names.contains(&scheme.to_string());
        if self.wanted.is_empty() || self.wanted.iter().any(is_wanted) {
            let label = format!("{} {what}", names[0]);
            let run = Box::new(move |sink: Sink<'_>| run(&choice, sink));
            self.jobs.push(Job { case: self.case, label, run });
        }
    }
}

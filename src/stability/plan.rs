//! The jobs of a stability study.

use super::choice::{Choice, NAMES};
use super::row::StabilityRow;
use crate::error::Error;
use crate::mesh::Mesh;

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

/// The work on one scheme, which is yet to be chosen.
type RunChoice<'p> = Box<dyn Fn(&Choice, Sink<'_>) -> Result<(), Error> + 'p>;

/// A unit of work whose rows do not depend on other jobs.
pub(super) struct Job<'p> {
    pub(super) case: &'static str,
    pub(super) label: String,
    pub(super) run: Run<'p>,
}

/// The jobs of a study.
pub(crate) struct Plan<'p> {
    pub(super) effort: Effort,
    /// The schemes of the study that are wanted; all of them if there is neither one nor a further one.
    pub(super) schemes: Vec<&'static str>,
    /// Schemes as users wrote them, compared besides.
    pub(super) further: Vec<Choice>,
    pub(super) given: &'p [(String, Mesh<3>)],
    pub(super) jobs: Vec<Job<'p>>,
}

impl<'p> Plan<'p> {
    /// Whether all sweeps run.
    pub fn is_full(&self) -> bool {
        self.effort == Effort::Full
    }
    /// One of two, by effort.
    pub fn pick<T>(&self, quick: T, full: T) -> T {
        if self.is_full() { full } else { quick }
    }
    /// One of three, by effort.
    pub fn pick_of<T>(&self, trial: T, quick: T, full: T) -> T {
        if self.effort == Effort::Trial { trial } else { self.pick(quick, full) }
    }
    /// The schemes that every case compares, with default penalties and as users wrote them.
    pub fn compared(&self) -> Vec<Choice> {
        let own = NAMES[..6].iter().map(|name| Choice::default(name));
        own.chain(self.further.iter().copied()).collect()
    }
    /// The same, followed by further choices of this case.
    pub fn compared_and(&self, of_case: &[Choice]) -> Vec<Choice> {
        let mut all = self.compared();
        all.extend_from_slice(of_case);
        all
    }
    /// Adds work on a scheme, if that scheme is wanted.
    pub fn add(
        &mut self,
        case: &'static str,
        choice: Choice,
        what: &str,
        run: impl Fn(&Choice, Sink<'_>) -> Result<(), Error> + 'p,
    ) {
        self.add_boxed(case, choice, what, Box::new(run));
    }
    fn add_boxed(&mut self, case: &'static str, choice: Choice, what: &str, run: RunChoice<'p>) {
        let all = self.schemes.is_empty() && self.further.is_empty();
        if all || self.schemes.contains(&choice.scheme) || self.further.contains(&choice) {
            let label = format!("{} {} {what}", choice.scheme, choice.words());
            let run = Box::new(move |sink: Sink<'_>| run(&choice, sink));
            self.jobs.push(Job { case, label, run });
        }
    }
}

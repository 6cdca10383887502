//! Studies whose cases run alone, round by round.

use std::time::{Duration, Instant};

use crate::error::Error;
use crate::inequality::Outcome;
use crate::instances::compiled;
use crate::study::{Program, Progress, Report, Row, Study, Variant, fill_orders};

/// The least time between two calls of what keeps the rows within a round.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// Studies under one clock. In every round each case, a scheme with a solver on a level or on all adaptive meshes, runs
/// once and reuses nothing of other runs: its time includes its mesh and its start from coarser levels. Rounds
/// alternate in direction, so that drift of the machine affects all cases equally. Before the first one the coarsest
/// case of every scheme runs once unmeasured.
///
/// ```
/// use unilateral::prelude::*;
/// use unilateral::work_precision::{Rounds, WorkPrecision};
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let study = Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).scheme(Wopsip::default());
/// let report = Rounds::new(2).run(&[study.levels([4, 8])])?;
/// assert_eq!(report.rows.len(), 4);
/// print!("{}", WorkPrecision::of(&report).to_text(100));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rounds {
    count: usize,
    limit: f64,
}

/// A function that keeps the report of the rows so far.
type Keep<'k> = dyn FnMut(&Report) -> Result<(), Error> + 'k;

/// A case with its rows so far: one, or on adaptive meshes one for each step.
struct Case<'s, const D: usize> {
    study: Study<'s, D>,
    /// The study that has the observer.
    of: &'s Study<'s, D>,
    variant: Variant,
    level: usize,
    /// The case one level coarser, by its place in the list.
    coarser: Option<usize>,
    rows: Vec<Row>,
}

impl Rounds {
    /// So many rounds, at least one.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { count: count.max(1), limit: f64::INFINITY }
    }
    /// A run that took longer than this many seconds is not repeated, and no finer level of its scheme is tried: the
    /// rows of these have the status `time-limit`. The solves against a reference have no limit.
    #[must_use]
    pub fn limit(mut self, seconds: f64) -> Self {
        self.limit = seconds;
        self
    }

    /// Checks everything without a run. Returns the number of runs that observers see, fewer if some exceed the limit
    /// of time: each case in every round, and before them the reference and each case against it.
    ///
    /// # Errors
    /// Those of [`Study::check`]; [`Error::NotEnoughMemory`]; [`Error::EqualNames`] for studies with the same schemes,
    /// solvers and kind of meshes.
    pub fn check<const D: usize>(&self, studies: &[Study<'_, D>]) -> Result<usize, Error> {
        compiled!(
            const D: fn(&Rounds, &[Study<'_, D>]) -> Result<usize, Error> = |rounds, studies| {
                studies.iter().try_for_each(Study::check_memory)?;
                let against: usize = studies.iter().map(Study::runs_against_reference).sum();
                Ok(cases(studies)?.len() * rounds.count + against)
            }
        )(self, studies)
    }

    /// Runs the studies, all on one scene. A study with a reference has its errors against that from one more solve of
    /// every case, outside the clock.
    ///
    /// # Errors
    /// Those of [`Self::check`] and of [`Study::run`].
    pub fn run<const D: usize>(&self, studies: &[Study<'_, D>]) -> Result<Report, Error> {
        let threads = rayon::current_num_threads();
        let precision = studies.first().map_or("", |study| study.precision().name());
        let program = Program::new("work-precision", precision, threads, self.count);
        let mut report = Report::new(program, Vec::new());
        self.run_into(studies, &mut report, &mut |_| Ok(()))?;
        Ok(report)
    }

    /// Runs the studies and adds their rows to a report of other scenes. The function receives the report after every
    /// round, and within one once a second.
    ///
    /// # Errors
    /// Those of [`Self::run`] and of the function.
    pub fn run_into<const D: usize>(
        &self,
        studies: &[Study<'_, D>],
        report: &mut Report,
        keep: &mut dyn FnMut(&Report) -> Result<(), Error>,
    ) -> Result<(), Error> {
        compiled!(
            const D: fn(&Rounds, &[Study<'_, D>], &mut Report, &mut Keep<'_>) -> Result<(), Error>
                = |rounds, studies, report, keep| rounds.run_cases(studies, report, keep)
        )(self, studies, report, keep)
    }

    fn run_cases<const D: usize>(
        &self,
        studies: &[Study<'_, D>],
        report: &mut Report,
        keep: &mut Keep<'_>,
    ) -> Result<(), Error> {
        let mut cases = cases(studies)?;
        let mut known = Vec::new();
        for study in studies {
            known.extend(study.rows_against_reference()?);
        }
        // threads, pages and instructions are there when the clock starts
        for case in cases.iter().filter(|c| c.coarser.is_none() && !c.study.is_adaptive()) {
            case.study.run()?;
        }
        let before = report.rows.len();
        let mut kept = Instant::now();
        for round in 0..self.count {
            // by level, so that a level that takes too long is known before the next
            let mut order: Vec<usize> = (0..cases.len()).collect();
            sort_by(&mut order, &|k| (cases[k].study.is_adaptive(), cases[k].level));
            if round % 2 == 1 {
                order.reverse();
            }
            for (done, &k) in order.iter().enumerate() {
                let Case { of, variant, level, .. } = &cases[k];
                of.notify(Progress::Started(&variant.scene, &variant.label, *level));
                self.run_case(&mut cases, k, round, &known)?;
                if done + 1 == order.len() || kept.elapsed() > WRITE_INTERVAL {
                    report.rows.truncate(before);
                    report.rows.extend(cases.iter().flat_map(|case| case.rows.iter().cloned()));
                    fill_orders(&mut report.rows[before..]);
                    keep(report)?;
                    kept = Instant::now();
                }
            }
        }
        Ok(())
    }

    /// Runs a case, unless it has failed or takes too long.
    fn run_case<const D: usize>(
        &self,
        cases: &mut [Case<'_, D>],
        k: usize,
        round: usize,
        known: &[Row],
    ) -> Result<(), Error> {
        let is_slow = |row: &Row| row.seconds.total > self.limit;
        if cases[k].rows.last().is_some_and(|row| is_slow(row) || !row.converged()) {
            return Ok(());
        }
        let coarser = cases[k].coarser.and_then(|coarser| cases[coarser].rows.last());
        let why = coarser.filter(|_| round == 0).and_then(|row| match row.status {
            Outcome::TimeLimit => Some(format!("not run: level {} was not, either", row.level)),
            _ => is_slow(row)
                .then(|| format!("not run: level {} took {:.1} s", row.level, row.seconds.total)),
        });
        let case = &mut cases[k];
        if let Some(why) = why {
            case.rows.push(case.study.row_not_run(why));
            return Ok(());
        }
        let is_reset = reset_peak_memory();
        for (step, mut row) in case.study.run()?.rows.into_iter().enumerate() {
            // an adaptive step has no peak of its own
            let has_peak = is_reset && !case.study.is_adaptive();
            row.peak_memory_bytes = row.peak_memory_bytes.filter(|_| has_peak);
            case.of.notify(Progress::Finished(&row));
            match case.rows.get_mut(step) {
                Some(first) => first.add_run(&row),
                None => {
                    take_errors(&mut row, known);
                    row.runs = Some(vec![row.seconds.total]);
                    case.rows.push(row);
                }
            }
        }
        Ok(())
    }
}

/// All cases, each checked.
fn cases<'s, const D: usize>(studies: &'s [Study<'s, D>]) -> Result<Vec<Case<'s, D>>, Error> {
    let mut cases: Vec<Case<'_, D>> = Vec::new();
    for of in studies {
        of.check()?;
        for study in of.cases() {
            let (variant, level) = study.variant();
            if cases.iter().any(|other| other.variant == variant && other.level == level) {
                return Err(Error::equal_schemes(&variant.label));
            }
            cases.push(Case { study, of, variant, level, coarser: None, rows: Vec::new() });
        }
    }
    for k in 0..cases.len() {
        let Case { variant, level, .. } = &cases[k];
        let is_coarser = |other: &usize| {
            let other = &cases[*other];
            other.variant == *variant && other.level < *level
        };
        let coarser = (0..cases.len()).filter(is_coarser);
        cases[k].coarser = coarser.max_by_key(|&other| cases[other].level);
    }
    match cases.is_empty() {
        false => Ok(cases),
        true => Err(Error::parameter("studies", "none", "at least one")),
    }
}

/// Gives a row the errors against a reference, where they are known.
fn take_errors(row: &mut Row, known: &[Row]) {
    let variant = Variant::of(row);
    let same = |of: &&Row| of.level == row.level && Variant::of(of) == variant;
    if let Some(known) = known.iter().find(same) {
        row.against.clone_from(&known.against);
        row.warnings.clone_from(&known.warnings);
        (row.error, row.contact) = (known.error.clone(), known.contact);
        row.bound.clone_from(&known.bound);
    }
}

/// Resets the peak of the resident set that the kernel records; `true` if it was reset. Linux only.
fn reset_peak_memory() -> bool {
    cfg!(target_os = "linux") && std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// Sorts indices by their keys; not generic, so that the sorting code is compiled once.
fn sort_by(order: &mut [usize], key: &dyn Fn(usize) -> (bool, usize)) {
    order.sort_by_key(|&k| key(k));
}

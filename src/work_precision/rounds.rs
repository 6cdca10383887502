//! Studies whose cases run alone, round by round.

use std::time::{Duration, Instant};

use crate::error::Error;
use crate::inequality::Outcome;
use crate::instances::compiled;
use crate::study::{Program, Progress, Report, Row, Study, Variant, fill_orders};

/// The least time between two calls of what keeps the rows within a round.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// The cases of a study under one clock. In every round each case, a scheme with a solver on a level or on all adaptive meshes, runs
/// once and reuses nothing of other runs: its time includes its mesh and its start from coarser levels. Rounds
/// alternate in direction, so that drift of the machine affects all cases equally. Before the first one the coarsest
/// case of every scheme runs once unmeasured.
///
/// ```
/// use unilateral::prelude::*;
/// use unilateral::work_precision::Rounds;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let study = Study::<2>::new(scenes::radial(1.0)).scheme(ConformingP1).scheme(Wopsip::default());
/// let report = Rounds::new(2).run(&study.levels([4, 8]))?;
/// assert_eq!(report.rows.len(), 4);
/// print!("{}", report.work_to_text(100));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Rounds {
    count: usize,
    limit: f64,
}

/// A function that keeps the rows so far.
type Keep<'k> = dyn FnMut(&[Row]) -> Result<(), Error> + 'k;

/// A case with its rows so far: one, or on adaptive meshes one for each step.
struct Case<'s, const D: usize> {
    study: Study<'s, D>,
    variant: Variant,
    level: usize,
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

    /// Runs a study. One with a reference has its errors against that from one more solve of every case, outside the
    /// clock.
    ///
    /// # Errors
    /// Those of [`Study::run`].
    pub fn run<const D: usize>(&self, study: &Study<'_, D>) -> Result<Report, Error> {
        let (threads, precision) = (rayon::current_num_threads(), study.precision().name());
        let program = Program::new("work-precision", precision, threads, self.count);
        Ok(Report::new(program, self.rows(study, &mut |_| Ok(()))?))
    }

    /// Runs a study. The function receives the rows so far after every round, and within one once a second.
    ///
    /// # Errors
    /// Those of [`Self::run`] and of the function.
    pub fn rows<const D: usize>(
        &self,
        study: &Study<'_, D>,
        keep: &mut dyn FnMut(&[Row]) -> Result<(), Error>,
    ) -> Result<Vec<Row>, Error> {
        compiled!(
            const D: fn(&Rounds, &Study<'_, D>, &mut Keep<'_>) -> Result<Vec<Row>, Error>
                = |rounds, study, keep| rounds.run_cases(study, keep)
        )(self, study, keep)
    }

    fn run_cases<const D: usize>(
        &self,
        of: &Study<'_, D>,
        keep: &mut Keep<'_>,
    ) -> Result<Vec<Row>, Error> {
        of.check()?;
        let known = of.rows_against_reference()?;
        let mut cases: Vec<Case<'_, D>> = of.cases().into_iter().map(Case::new).collect();
        // threads, pages and instructions are there when the clock starts
        for (k, case) in cases.iter().enumerate() {
            if coarser(&cases, k).is_none() && !of.is_adaptive() {
                case.study.run()?;
            }
        }
        let mut kept = Instant::now();
        for round in 0..self.count {
            // by level, so that a level that takes too long is known before the next
            let mut order: Vec<usize> = (0..cases.len()).collect();
            sort_by(&mut order, &|k| cases[k].level);
            if round % 2 == 1 {
                order.reverse();
            }
            for (done, &k) in order.iter().enumerate() {
                let Case { variant, level, .. } = &cases[k];
                of.notify(Progress::Started(&variant.scene, &variant.label, *level));
                let found = self.run_case(&cases, k, round)?;
                for row in &found {
                    of.notify(Progress::Finished(row));
                }
                cases[k].add(found, &known);
                if done + 1 == order.len() || kept.elapsed() > WRITE_INTERVAL {
                    keep(&rows_of(&cases))?;
                    kept = Instant::now();
                }
            }
        }
        Ok(rows_of(&cases))
    }

    /// The rows of one more run of a case, none if it has failed or takes too long.
    fn run_case<const D: usize>(
        &self,
        cases: &[Case<'_, D>],
        k: usize,
        round: usize,
    ) -> Result<Vec<Row>, Error> {
        let case = &cases[k];
        let is_slow = |row: &Row| row.seconds.total > self.limit;
        if case.rows.last().is_some_and(|row| is_slow(row) || !row.converged()) {
            return Ok(Vec::new());
        }
        let before = coarser(cases, k).filter(|_| round == 0).and_then(|case| case.rows.last());
        let why = before.and_then(|row| match row.status {
            Outcome::TimeLimit => Some(format!("not run: level {} was not, either", row.level)),
            _ => is_slow(row)
                .then(|| format!("not run: level {} took {:.1} s", row.level, row.seconds.total)),
        });
        match why {
            Some(why) => Ok(vec![case.study.row_not_run(why)]),
            None => Ok(case.study.run()?.rows),
        }
    }
}

impl<'s, const D: usize> Case<'s, D> {
    fn new(study: Study<'s, D>) -> Self {
        let (variant, level) = study.variant();
        Self { study, variant, level, rows: Vec::new() }
    }
    /// Adds the rows of a run; the first have their errors against a reference from those that are known.
    fn add(&mut self, found: Vec<Row>, known: &[Row]) {
        for (step, mut row) in found.into_iter().enumerate() {
            match self.rows.get_mut(step) {
                Some(first) => first.add_run(&row),
                None => {
                    take_errors(&mut row, known);
                    let is_run = row.status != Outcome::TimeLimit;
                    row.runs = is_run.then(|| vec![row.seconds.total]);
                    self.rows.push(row);
                }
            }
        }
    }
}

/// The case one level coarser.
fn coarser<'c, 's, const D: usize>(cases: &'c [Case<'s, D>], k: usize) -> Option<&'c Case<'s, D>> {
    let Case { variant, level, .. } = &cases[k];
    let coarser = cases.iter().filter(|of| of.variant == *variant && of.level < *level);
    coarser.max_by_key(|of| of.level)
}

/// The rows of all cases, with their orders.
fn rows_of<const D: usize>(cases: &[Case<'_, D>]) -> Vec<Row> {
    let mut rows: Vec<Row> = cases.iter().flat_map(|case| case.rows.iter().cloned()).collect();
    fill_orders(&mut rows);
    rows
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

/// Sorts indices by their keys; not generic, so that the sorting code is compiled once.
fn sort_by(order: &mut [usize], key: &dyn Fn(usize) -> usize) {
    order.sort_by_key(|&k| key(k));
}

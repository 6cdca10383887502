//! The studies of a comparison, each checked before any runs.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::options::Options;
use super::watcher::Watcher;
use crate::shared::{Request, draw_solution, each_once};

use unilateral::error::Error;
use unilateral::inequality::solver_by_name;
use unilateral::real::Precision;
use unilateral::scenes::Scene;
use unilateral::scheme::NamedScheme;
use unilateral::study::{Journal, Row, RowKey, Study, file_name};
use unilateral::work_precision::Rounds;

/// A study that has been checked.
pub struct Run<'a> {
    /// The keys of its rows.
    pub keys: Vec<RowKey>,
    /// Problem file, or scene and mesh, for messages.
    pub place: String,
    /// Runs it.
    pub run: Box<dyn FnOnce(&'a Journal) -> Result<Vec<Row>, Error> + 'a>,
}

/// Most cells of a solution that is drawn: pictures of more are large and show no more.
const MOST_CELLS: usize = 5000;

/// A study with schemes, levels, files and what shows its progress.
pub fn study<'a, const D: usize>(
    scene: Scene<D>,
    options: &'a Options,
    schemes: &[NamedScheme],
    watcher: &'a Watcher,
) -> Study<'a, D> {
    let levels = match &options.asked.levels[..] {
        [] if options.asked.adaptive.is_some() => Vec::new(),
        [] if scene.domain.is_mesh() => vec![0, 1],
        [] if D == 3 => vec![2, 4, 8],
        [] => vec![8, 16, 32, 64, 128],
        some => each_once(some),
    };
    let study = Study::new(scene).levels(levels).observer(|progress| watcher.tell(&progress));
    let study = schemes.iter().fold(study, Study::named_scheme);
    if options.no_fields || options.rounds.is_some() {
        study
    } else {
        study.fields_to(&options.out)
    }
}

/// Whether a study that has been checked fits the mesh. One that does not is an error if its scene was named.
pub fn fits(checked: Result<(), Error>, options: &Options, place: &str) -> Request<bool> {
    match checked {
        Err(Error::UnfitMesh(_) | Error::UnknownGroup(_)) if !options.asked.scenes_are_named() => {
            Ok(false)
        }
        other => other.map(|()| true).map_err(|e| format!("{place}: {e}")),
    }
}

/// Checks a study. Nothing is left of one that does not fit the mesh and was not asked for by name.
pub fn prepare<'a, const D: usize>(
    scene: Scene<D>,
    options: &'a Options,
    (schemes, solvers): (&[NamedScheme], &[String]),
    watcher: &'a Watcher,
) -> Request<Option<Run<'a>>> {
    let place = options.asked.place(&scene.name);
    let scene_name = scene.name.clone();
    let has_mesh = scene.domain.is_mesh();
    let is_known = scene.problem.exact.is_some() || options.asked.reference.is_some();
    let mut study = study(scene, options, schemes, watcher);
    study = study.repeat(options.repeat).history(options.history).steps(watcher.steps());
    let drawn = RefCell::new(BTreeMap::new());
    let is_drawn = options.rounds.is_none();
    study = study.each_solution(move |label, level, solved| {
        let finest = *drawn.borrow().get(label).unwrap_or(&0);
        if is_drawn && solved.mesh().n_cells() <= MOST_CELLS && level >= finest {
            drawn.borrow_mut().insert(label.to_owned(), level);
            // one on a finer mesh takes the place of a coarser one
            let name = format!("{scene_name}-{label}");
            let title = format!("{name}, level {level}");
            if let Err(why) = draw_solution(&title, solved, &options.out, &file_name(&name)) {
                watcher.warn_once(format!("warning: no picture of {name}: {why}"));
            }
        }
        Ok(())
    });
    if options.fields_of_all_levels {
        study = study.fields_of_all_levels();
    }
    if let Some(directory) = &options.dump {
        study = study.inequalities_to(directory);
    }
    study = with_solvers(study, solvers, options)?;
    if let Some(share) = options.tolerance {
        study = study.tolerance(share);
    }
    if let Some(of) = options.asked.adaptive {
        study = study.adaptive(of);
    }
    if let Some((scheme, level)) = &options.asked.reference {
        study = study.named_reference(scheme, *level);
    }
    if !fits(study.check(), options, &place)? {
        return Ok(None);
    }
    let keys = study.keys();
    // how many steps a bound takes is not known before
    if options.asked.adaptive.is_none() {
        // rounds solve once more against a reference
        let once_more = usize::from(options.asked.reference.is_some());
        for _ in 0..options.rounds.map_or(1, |count| count + once_more) {
            watcher.expect(D, has_mesh, keys.iter().map(|key| key.level));
        }
    }
    let Some(count) = options.rounds else {
        let run = move |journal| Ok(study.journal(journal).run()?.rows);
        return Ok(Some(Run { keys, place, run: Box::new(run) }));
    };
    if !is_known {
        watcher.warn_once(format!(
            "warning: {place}: only bounds are reached, for no error is known; --reference N measures against a fine solution"
        ));
    }
    let rounds = Rounds::new(count).limit(options.limit);
    let run = move |journal: &Journal| {
        // of the scenes before
        let before = journal.report().rows.len();
        rounds.rows(&study, &mut |rows| journal.replace_after(before, rows))
    };
    Ok(Some(Run { keys, place, run: Box::new(run) }))
}

/// A study with the solvers of these names.
pub fn with_solvers<'a, const D: usize>(
    study: Study<'a, D>,
    solvers: &[String],
    options: &Options,
) -> Request<Study<'a, D>> {
    let precision = Precision::by_name(&options.precision);
    let precision = precision.expect("the command line takes the names of precisions alone");
    solvers.iter().try_fold(study, |study, name| {
        let solver = solver_by_name(name, options.linear(), precision);
        let solver = solver.ok_or_else(|| format!("there is no solver {name}"))?;
        Ok(study.boxed_solver(solver))
    })
}

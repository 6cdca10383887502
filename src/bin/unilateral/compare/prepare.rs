//! The studies of a comparison, each checked before any runs.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::options::Options;
use super::watcher::Watcher;
use crate::shared::{Request, draw_solution, each_once};

use unilateral::error::Error;
use unilateral::inequality::solver_by_name;
use unilateral::linear::LinearMethod;
use unilateral::real::Precision;
use unilateral::scenes::Scene;
use unilateral::scheme::NamedScheme;
use unilateral::study::{Journal, Row, RowKey, Study, file_name};

/// A study that has been checked.
pub struct Run<'a> {
    /// The keys of its rows.
    pub keys: Vec<RowKey>,
    /// The constants of its problem.
    pub constants: BTreeMap<String, f64>,
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
    let has_rounds = options.rounds.is_some();
    let levels = match &options.asked.levels[..] {
        [] if options.asked.adaptive.is_some() && !has_rounds => Vec::new(),
        [] => default_levels(D, scene.domain.is_mesh(), has_rounds),
        some => each_once(some),
    };
    let study = Study::new(scene).levels(levels).observer(|progress| watcher.tell(&progress));
    let study = schemes.iter().fold(study, Study::named_scheme);
    if options.no_fields || has_rounds { study } else { study.fields_to(&options.out) }
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
    let constants = scene.problem.constants.clone();
    let has_mesh = scene.domain.is_mesh();
    let linear = options.linear()[0].1;
    let mut study = study(scene, options, schemes, watcher);
    study = study.repeat(options.repeat).history(options.history).steps(watcher.steps());
    let drawn = RefCell::new(BTreeMap::new());
    study = study.each_solution(move |label, level, solved| {
        let finest = *drawn.borrow().get(label).unwrap_or(&0);
        if solved.mesh().n_cells() <= MOST_CELLS && level >= finest {
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
    study = with_solvers(study, solvers, linear, options)?;
    if let Some(of) = options.asked.adaptive {
        study = study.adaptive(of);
    }
    if let Some((scheme, level)) = &options.asked.reference {
        study = study.named_reference(scheme, *level);
    }
    match study.check() {
        Err(Error::UnfitMesh(_)) if !options.asked.scenes_are_named() => return Ok(None),
        other => other.map_err(|e| format!("{place}: {e}"))?,
    }
    let keys = study.keys();
    // how many steps a bound takes is not known before
    if options.asked.adaptive.is_none() {
        watcher.expect(D, has_mesh, keys.iter().map(|key| key.level));
    }
    let run = move |journal| Ok(study.journal(journal).run()?.rows);
    Ok(Some(Run { keys, constants, place, run: Box::new(run) }))
}

/// A study with the solvers of these names.
pub fn with_solvers<'a, const D: usize>(
    study: Study<'a, D>,
    solvers: &[String],
    linear: LinearMethod,
    options: &Options,
) -> Request<Study<'a, D>> {
    let precision = Precision::by_name(&options.precision);
    let precision = precision.expect("the command line takes the names of precisions alone");
    solvers.iter().try_fold(study, |study, name| {
        let solver = solver_by_name(name, linear, precision);
        let solver = solver.ok_or_else(|| format!("there is no solver {name}"))?;
        Ok(study.boxed_solver(solver))
    })
}

/// The levels where none are named: with rounds one more on meshes and in space.
fn default_levels(dimension: usize, on_mesh: bool, has_rounds: bool) -> Vec<usize> {
    match dimension {
        _ if on_mesh => (0..2 + usize::from(has_rounds)).collect(),
        3 => [2, 4, 8].into_iter().chain(has_rounds.then_some(16)).collect(),
        _ => vec![8, 16, 32, 64, 128],
    }
}

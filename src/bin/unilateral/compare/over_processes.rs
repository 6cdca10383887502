//! A comparison over the processes of an MPI job: `mpirun -n R unilateral compare …`.
//!
//! Every process runs the same requests on its part of the meshes. The first one prints, and writes the report.

use unilateral::distributed::Process;
use unilateral::distributed::petsc::Processes;
use unilateral::in_its_dimension;
use unilateral::processes::{ExchangeError, agree};
use unilateral::scenes::{AnyScene, Scene};
use unilateral::scheme::NamedScheme;
use unilateral::study::{Journal, Report, Row, Study};

use super::options::{Options, check_numbers};
use super::prepare::{fits, study};
use super::watcher::Watcher;
use super::{Chosen, NO_SCENE_FITS, check_output, processes_of_job, program, write_all};
use crate::shared::{Request, complain, use_threads};

/// Whether every row converged: the same in all processes. The first one has said what went wrong.
pub fn run(options: &Options) -> Request<bool> {
    let processes = Processes::start().map_err(|e| e.to_string())?;
    let process = processes.own();
    let result = run_process(options, &process);
    // before the end: a launcher kills the others once a process has ended with a code
    if let (0, Err(why)) = (process.number, &result) {
        complain(why);
    }
    let own = result.map_or(2.0, |is_good| if is_good { 0.0 } else { 1.0 });
    let code = process.exchange.largest(&[own]).map_or(2.0, |largest| largest[0]);
    drop(process);
    processes.end().map_err(|e| e.to_string())?;
    if code == 2.0 { Err(String::new()) } else { Ok(code == 0.0) }
}

fn run_process(options: &Options, process: &Process) -> Request<bool> {
    agreed(check_request(options, process), process)?;
    let is_first = process.number == 0;
    let mut quiet = options.clone();
    quiet.asked.quiet |= !is_first;
    let watcher = Watcher::new(&quiet);
    let chosen = agreed(Chosen::new(options, &watcher), process)?;
    let Chosen { scenes, schemes, fingerprints: files, inputs, .. } = chosen;
    check_equal(&format!("{options:?} {files:?}"), process)?;
    let program = program(options, &files)
        .with_request("processes", process.count())
        .with_request("engine", process.engine.name());
    let new_journal = || {
        check_output(options, &inputs)?;
        Journal::create(&options.out, program.clone()).map_err(|e| e.to_string())
    };
    let all = AllRuns { options, schemes: &schemes, process, watcher: &watcher };
    // nothing runs and nothing is replaced before all is checked
    let scenes = agreed(all.fitting(scenes), process)?;
    let journal = agreed(is_first.then(new_journal).transpose(), process)?;
    let (mut rows, mut messages) = (Vec::new(), Vec::new());
    let journal = journal.as_ref();
    let mut add = |found: Result<Vec<Row>, String>| match found {
        Ok(found) => rows.extend(found),
        Err(why) => messages.push(why),
    };
    for scene in scenes {
        add(in_its_dimension!(scene, |scene| all.run(scene, journal)));
    }
    watcher.clear();
    // a scene that ended by an error has rows in the journal
    let report = match journal {
        Some(journal) if !messages.is_empty() => journal.report(),
        _ => Report::new(program, rows),
    };
    if is_first {
        messages.iter().for_each(|text| complain(text));
    }
    agreed(if is_first { write_all(options, &report) } else { Ok(()) }, process)?;
    Ok(messages.is_empty() && report.rows.iter().all(Row::converged))
}

/// Checks what needs no file: numbers, options, the launcher, threads.
fn check_request(options: &Options, process: &Process) -> Request<()> {
    check_numbers(options)?;
    check_options(options)?;
    let (started, found) = (processes_of_job(), process.count());
    if started != found {
        return Err(format!(
            "the launcher has started {started} processes, and MPI knows of {found}: start the program by the mpirun of the MPI that it is linked with"
        ));
    }
    use_threads(Some(options.asked.threads.unwrap_or_else(threads_of_process)))
}

/// Refuses processes with other options or files than the first one.
fn check_equal(request: &str, process: &Process) -> Request<()> {
    let own: Vec<u64> = request.bytes().map(u64::from).collect();
    let received = process.exchange.exchange(vec![own; process.count()]);
    let received = received.map_err(|error| error.to_string())?;
    match received.iter().position(|other| *other != received[0]) {
        None => Ok(()),
        Some(other) => Err(format!(
            "process {other} has other options, or files with other bytes, than the first one: all need the same"
        )),
    }
}

/// The result of this process if no process failed; else in all the message of the first that did.
fn agreed<T>(result: Request<T>, process: &Process) -> Request<T> {
    agree(result, &*process.exchange).map_err(|error| match error {
        ExchangeError::Failed { message, .. } => message,
        other => other.to_string(),
    })
}

/// The options, schemes, process and progress that all runs share.
struct AllRuns<'r> {
    options: &'r Options,
    schemes: &'r [NamedScheme],
    process: &'r Process,
    watcher: &'r Watcher,
}

impl<'r> AllRuns<'r> {
    /// The scenes without those that do not fit the mesh and were not asked for by name.
    fn fitting(&self, scenes: Vec<AnyScene>) -> Request<Vec<AnyScene>> {
        let mut fitting = Vec::new();
        for scene in scenes {
            if in_its_dimension!(scene.clone(), |scene| self.fits(scene))? {
                fitting.push(scene);
            }
        }
        match fitting.is_empty() {
            true => Err(NO_SCENE_FITS.to_owned()),
            false => Ok(fitting),
        }
    }

    fn fits<const D: usize>(&self, scene: Scene<D>) -> Request<bool> {
        let place = self.options.asked.place(&scene.name);
        fits(self.study(scene).check_on_parts(self.process), self.options, &place)
    }

    fn study<const D: usize>(&self, scene: Scene<D>) -> Study<'r, D> {
        study(scene, self.options, self.schemes, self.watcher)
    }

    /// The rows of one scene or problem.
    fn run<const D: usize>(&self, scene: Scene<D>, journal: Option<&Journal>) -> Request<Vec<Row>> {
        let Self { options, process, watcher, .. } = *self;
        let place = options.asked.place(&scene.name);
        let has_mesh = scene.domain.is_mesh();
        let mut study = self.study(scene);
        watcher.expect(D, has_mesh, study.keys().iter().map(|key| key.level));
        if let Some(journal) = journal {
            study = study.journal(journal);
        }
        let report = study.run_on_parts(process);
        report.map(|report| report.rows).map_err(|e| format!("{place}: {e}"))
    }
}

/// Refuses options that processes do not support.
fn check_options(options: &Options) -> Request<()> {
    let asked = [
        ("--adaptive", options.asked.adaptive.is_some()),
        ("--reference", options.asked.reference.is_some()),
        ("--dump", options.dump.is_some()),
        ("--resume", options.resume),
        ("--precision f32", options.precision == "f32"),
        ("--repeat", options.repeat > 1),
        ("--history", options.history),
        ("--tolerance", options.tolerance.is_some()),
        ("--fields-of-all-levels", options.fields_of_all_levels),
        ("--linear direct", options.linear == "direct"),
        ("--rounds", options.rounds.is_some()),
        ("--solver", options.solvers.iter().any(|name| name != "active-set")),
    ];
    match asked.iter().find(|(_, is_asked)| *is_asked) {
        None => Ok(()),
        Some((option, _)) => {
            Err(format!("{option}: not over the processes of mpirun; a run in one process has it"))
        }
    }
}

/// The cores of the machine divided by the processes that share them, at least one.
fn threads_of_process() -> usize {
    let variables = ["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", "SLURM_NTASKS_PER_NODE"];
    let share = |name: &&str| std::env::var(name).ok()?.parse::<usize>().ok();
    let processes = variables.iter().find_map(share).unwrap_or(1).max(1);
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get());
    (cores / processes).max(1)
}

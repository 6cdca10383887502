//! Rows that are on disk as soon as they are finished.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};

use unilateral::inequality::Outcome;
use unilateral::prelude::*;
use unilateral::scenes::Scene;
use unilateral::study::{Journal, Program, Progress, Row, fill_orders};

use crate::rows;
use crate::support::scratch::Scratch;

fn program() -> Program {
    Program::new("test", "f64", 1, 1).with_request("load", 5)
}

/// A study of six rows.
fn study<'a>() -> Study<'a, 2> {
    let study = Study::new(scenes::radial::<2>(1.0)).scheme(ConformingP1).scheme(Sipg::default());
    study.levels([4, 8, 16])
}

/// Rows without what may differ from run to run.
fn without_times(rows: &[Row]) -> Vec<Row> {
    let plain = |row: &Row| {
        let mut row = row.clone();
        row.seconds = Default::default();
        row.peak_memory_bytes = None;
        row
    };
    rows.iter().map(plain).collect()
}

#[test]
fn rows_are_read_as_they_were_written() {
    let mut rows = rows::rows();
    rows[0].mesh_size = 1.0 / 3.0;
    rows[1].status = Outcome::NoSolution;
    rows[1].message = Some("two\nlines and \"quotes\"".into());
    rows[1].certificate = unilateral::inequality::Certificate::INVALID;
    let report = rows::report(rows.clone());
    let scratch = Scratch::new("journal-rows");
    report.write(&scratch.0).unwrap();
    assert!(Report::read(&scratch.0).unwrap() == report);

    let journal = Journal::create(&scratch.0, program()).unwrap();
    rows.iter().for_each(|row| journal.add(row).unwrap());
    // orders are those of the rows that are there
    fill_orders(&mut rows);
    let read = Report::read(&scratch.0).unwrap();
    assert!(read.rows == rows && !read.complete);
    assert_eq!(scratch.read("report.jsonl").lines().count(), 18);
    // a run that failed has a mesh size of NaN, which is null in the file
    let failed = Row::new("a", 2, "p1", 4, Outcome::NotFinite);
    journal.add(&failed).unwrap();
    let read = Report::read(&scratch.0).unwrap();
    let last = read.rows.last().unwrap();
    assert!(last.mesh_size.is_nan() && last.certificate == failed.certificate);
    assert!(
        !fs::read_dir(&scratch.0)
            .unwrap()
            .any(|f| { f.unwrap().file_name().to_string_lossy().starts_with('.') })
    );
}

#[test]
fn an_outcome_has_one_name() {
    for outcome in [Outcome::Converged, Outcome::IterationLimit, Outcome::OutOfMemory] {
        assert_eq!(serde_json::to_value(outcome).unwrap(), outcome.name());
    }
}

#[test]
fn a_study_goes_on_from_its_journal() {
    let scratch = Scratch::new("journal-resume");
    let whole = study().run().unwrap();
    let folder = scratch.0.join("made by the journal");
    let journal = Journal::create(&folder, program()).unwrap();
    study().levels([4, 8]).journal(&journal).run().unwrap();
    // what a kill leaves of a line
    let path = folder.join("report.jsonl");
    let mut text = fs::read_to_string(&path).unwrap();
    text += "{\"scene\":\"radial-2d\",\"dim";
    fs::write(&path, text).unwrap();
    assert_eq!(Report::read(&folder).unwrap().rows.len(), 4);

    let journal = Journal::resume(&folder, program(), &study().keys()).unwrap();
    let told = std::cell::RefCell::new(Vec::new());
    let note = |progress: Progress<'_>| match progress {
        Progress::Kept(row) => told.borrow_mut().push((true, row.level)),
        Progress::Finished(row) => told.borrow_mut().push((false, row.level)),
        _ => {}
    };
    let report = study().journal(&journal).observer(note).run().unwrap();
    let each = [(true, 4), (true, 8), (false, 16)];
    assert_eq!(*told.borrow(), [each, each].concat());
    for (found, expected) in without_times(&report.rows).iter().zip(without_times(&whole.rows)) {
        assert_eq!(*found, expected);
    }
    assert_eq!(Report::read(&folder).unwrap().rows.len(), 6);
    // nothing is left to do
    report.write(&folder).unwrap();
    let journal = Journal::resume(&folder, program(), &study().keys()).unwrap();
    let again = study().journal(&journal).run().unwrap();
    assert!(again.rows == report.rows);
}

/// The error says what the report has and what the run has.
#[track_caller]
fn is_of_another_request(error: &Error, [found, wanted]: [&str; 2]) {
    let said = format!("the report of another request: it has {found}, this run has {wanted}; ");
    assert!(matches!(error, Error::OtherRequest(why) if why.contains(&said)), "{error}");
}

#[test]
fn another_request_is_refused_and_nothing_changes() {
    let scratch = Scratch::new("journal-other");
    let journal = Journal::create(&scratch.0, program()).unwrap();
    study().levels([4]).journal(&journal).run().unwrap();
    let files = || ["report.json", "report.jsonl"].map(|name| scratch.read(name));
    let before = files();
    let other = |program: Program, keys: &[_], expected: [&str; 2]| {
        let error = Journal::resume(&scratch.0, program, keys).unwrap_err();
        is_of_another_request(&error, expected);
        assert_eq!(files(), before);
    };
    let keys = study().keys();
    let single = Program::new("test", "f32", 1, 1).with_request("load", 5);
    other(single, &keys, ["precision f64", "precision f32"]);
    let twice = Program::new("test", "f64", 1, 2).with_request("load", 5);
    other(twice, &keys, ["repeat 1", "repeat 2"]);
    let load = program().with_request("load", 6);
    other(load, &keys, ["load 5", "load 6"]);
    let mesh = program().with_request("mesh", "a");
    other(mesh, &keys, ["nothing of that", "mesh a"]);
    let row = "a row of sipg by active-set on radial-2d at level 4";
    let others: Vec<_> = keys.iter().filter(|key| key.label == "p1").cloned().collect();
    other(program(), &others, [row, "nothing of that"]);
    // threads change times only
    let mut threads = program();
    threads.threads = 7;
    Journal::resume(&scratch.0, threads, &keys).unwrap();
    // of the request beside the rows the same holds where the report has been deleted
    let report = scratch.read("report.json");
    let rows = scratch.read("report.jsonl");
    fs::remove_file(scratch.0.join("report.json")).unwrap();
    let error = Journal::resume(&scratch.0, program().with_request("load", 6), &keys).unwrap_err();
    is_of_another_request(&error, ["load 5", "load 6"]);
    assert!(!scratch.0.join("report.json").exists() && scratch.read("report.jsonl") == rows);
    fs::write(scratch.0.join("report.json"), report).unwrap();
    fs::write(scratch.0.join("report.json"), "{\"program\"").unwrap();
    let error = Report::read(&scratch.0).unwrap_err().to_string();
    assert!(error.contains("report.json: EOF while parsing"), "{error}");
}

#[test]
fn rows_without_their_report_are_taken_up() {
    let scratch = Scratch::new("journal-alone");
    let journal = Journal::create(&scratch.0, program()).unwrap();
    let whole = study().journal(&journal).run().unwrap();
    fs::remove_file(scratch.0.join("report.json")).unwrap();
    let keys = study().keys();
    let error = Journal::resume(&scratch.0, program(), &keys[..3]).unwrap_err().to_string();
    assert!(error.contains("a row of sipg by active-set on radial-2d at level 4"), "{error}");
    let resumed = Journal::resume(&scratch.0, program(), &keys).unwrap();
    let again = study().journal(&resumed).run().unwrap();
    assert!(again.rows == whole.rows);
    // a line that is no row is named
    fs::remove_file(scratch.0.join("report.json")).unwrap();
    let path = scratch.0.join("report.jsonl");
    let lines = scratch.read("report.jsonl");
    let lines: Vec<&str> = lines.lines().collect();
    fs::write(&path, [lines[0], "{\"scene\": 3}", lines[2], ""].join("\n")).unwrap();
    let error = Journal::resume(&scratch.0, program(), &keys).unwrap_err().to_string();
    let expected = "report.jsonl: line 2: invalid type";
    assert!(error.contains(expected) && error.contains("delete it, its row runs again"), "{error}");
    fs::write(&path, [lines[0], lines[2], ""].join("\n")).unwrap();
    let resumed = Journal::resume(&scratch.0, program(), &keys).unwrap();
    assert_eq!(resumed.report().rows.len(), 2);
    // rows of which nothing says whose they are are not taken
    fs::remove_file(scratch.0.join("report.json")).unwrap();
    for (request, why) in [(Some("{\"name\""), "EOF while parsing"), (None, "No such file")] {
        let path = scratch.0.join("request.json");
        match request {
            Some(text) => fs::write(path, text).unwrap(),
            None => fs::remove_file(path).unwrap(),
        }
        let error = Journal::resume(&scratch.0, program(), &keys).unwrap_err().to_string();
        let rest = "the rows of report.jsonl may be those of another request: delete them too";
        assert!(error.contains(why) && error.contains(rest), "{error}");
    }
    fs::remove_file(&path).unwrap();
    assert!(Journal::resume(&scratch.0, program(), &keys).unwrap().report().rows.is_empty());
}

#[test]
fn a_panic_in_a_datum_leaves_the_finished_rows() {
    let scratch = Scratch::new("journal-panic");
    let journal = Journal::create(&scratch.0, program()).unwrap();
    let source = |x: &Point<2>| {
        // a level-16 mesh evaluates the load nearer to the corner than a coarser one
        assert!(x.norm() > 0.01, "the load has no value at the corner");
        -1.0
    };
    let problem = Problem::new().source(source).obstacle_below(|_| -0.05);
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let study = Study::<2>::new(Scene::new("mine", domain, problem)).scheme(ConformingP1);
    let study = study.levels([4, 8, 64]).journal(&journal);
    assert!(catch_unwind(AssertUnwindSafe(|| study.run())).is_err());
    let report = Report::read(&scratch.0).unwrap();
    assert!(!report.complete);
    assert_eq!(report.rows.iter().map(|r| r.level).collect::<Vec<_>>(), [4, 8]);
    assert!(journal.report().rows == report.rows);
}

/// The rows before and after a level at which a datum has no value.
#[test]
fn a_run_that_fails_is_a_row_with_its_message() {
    let source = |x: &Point<2>| if x.norm() > 0.01 { -1.0 } else { f64::NAN };
    let problem = Problem::new().source(source).obstacle_below(|_| -0.05);
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let study = Study::<2>::new(Scene::new("mine", domain, problem));
    let study = study.scheme(ConformingP1).scheme(Sipg::default()).levels([4, 64, 8]);
    let rows = study.run().unwrap().rows;
    for series in rows.chunks(3) {
        let [good, bad, again] = series else { unreachable!() };
        assert!(good.converged() && again.converged());
        assert_eq!(bad.status, Outcome::NotFinite);
        let message = bad.message.as_ref().unwrap();
        assert!(message.starts_with("source is NaN at (0.0"), "{message}");
        assert_eq!((bad.cells, bad.energy, bad.nonzeros), (8192, None, None));
        assert!(bad.unknowns.is_some() && bad.mesh_size > 0.0 && bad.active.is_none());
    }
}

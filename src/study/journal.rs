//! A journal of rows: each is on disk as soon as it is finished.

use std::fmt::Display;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::orders::fill_orders;
use super::program::Program;
use super::report::Report;
use super::row::{Row, RowKey};
use crate::error::{Error, read_error, write_error};
use crate::files::{remove_drafts, replace};
use crate::input::read_file;

const REPORT: &str = "report.json";
const ROWS: &str = "report.jsonl";
const REQUEST: &str = "request.json";

/// The rows of a run in a directory: `report.jsonl` has each finished row as one line of JSON, written
/// before the next row begins, `request.json` the program whose rows these are, and `report.json` the program with
/// `"complete": false`. However the run ends, [`Report::read`] finds the rows, and [`Journal::resume`] goes on from
/// them. A run that ends of itself replaces `report.json` by the whole report ([`Report::write`]). Two runs at a time
/// need two directories: the program `unilateral` locks its own.
///
/// ```
/// use unilateral::prelude::*;
/// use unilateral::study::{Journal, Program};
/// # fn main() -> Result<(), unilateral::error::Error> {
/// # let directory = std::env::temp_dir().join(format!("unilateral-journal-{}", std::process::id()));
/// let journal = Journal::create(&directory, Program::new("mine", "f64", 1, 1))?;
/// let study = Study::<1>::new(scenes::radial(1.0)).scheme(ConformingP1).levels([4, 8]);
/// study.journal(&journal).run()?;
/// assert_eq!(Report::read(&directory)?.rows.len(), 2);
/// # std::fs::remove_dir_all(&directory).unwrap();
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    program: Program,
    rows: Mutex<Rows>,
}

#[derive(Debug)]
struct Rows {
    file: File,
    /// Bytes of whole lines.
    length: u64,
    /// The rows of this run, and those of an earlier one that this run has asked for.
    finished: Vec<Row>,
    /// The rows of an earlier run that this run has not asked for yet.
    kept: Vec<Row>,
    is_closed: bool,
}

impl Journal {
    /// An empty journal in a directory, which is made if need be. It takes the place of an earlier one.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn create(directory: impl AsRef<Path>, program: Program) -> Result<Self, Error> {
        Self::with_rows(directory.as_ref(), program, Vec::new())
    }

    /// The journal of a directory with its rows, for a run that asks for rows with these keys
    /// ([`Study::keys`](super::Study::keys)); an empty one where there is none.
    ///
    /// # Errors
    /// [`Error::OtherRequest`] if version, precision, number of runs or request of the program are not
    /// those of the journal, or if it has a row that is not asked for; [`Error::Read`], also of rows without a
    /// `request.json`, which says whose they are; [`Error::Write`]. Nothing is written before these checks.
    pub fn resume(
        directory: impl AsRef<Path>,
        program: Program,
        keys: &[RowKey],
    ) -> Result<Self, Error> {
        let directory = directory.as_ref();
        let (earlier, rows) = match directory.join(ROWS).exists() {
            true => (program_of_rows(directory)?, rows_of(&directory.join(ROWS))?),
            false => (program.clone(), Vec::new()),
        };
        let words = |p: &Program| {
            let own = [&p.name, &p.version, &p.precision].map(String::clone);
            let own = ["program", "version", "precision"].map(str::to_owned).into_iter().zip(own);
            let repeat = ("repeat".to_owned(), p.repeat.to_string());
            own.chain([repeat]).chain(p.request.clone()).collect::<Vec<_>>()
        };
        let (mut found, wanted) = (words(&earlier), words(&program));
        let unasked = rows.iter().map(Row::key).find(|key| !keys.contains(key));
        found.extend(unasked.map(|RowKey { scene, label, solver, level }| {
            ("a row".to_owned(), format!("of {label} by {solver} on {scene} at level {level}"))
        }));
        let other = |of: &[(String, String)], than: &[(String, String)]| {
            let other = of.iter().filter(|word| !than.contains(word));
            let other: Vec<String> = other.map(|(name, value)| format!("{name} {value}")).collect();
            if other.is_empty() { "nothing of that".to_owned() } else { other.join(", ") }
        };
        if found != wanted {
            return Err(Error::OtherRequest(format!(
                "{} has the report of another request: it has {}, this run has {}; repeat that request or choose another directory",
                directory.display(),
                other(&found, &wanted),
                other(&wanted, &found)
            )));
        }
        Self::with_rows(directory, program, rows)
    }

    fn with_rows(directory: &Path, program: Program, kept: Vec<Row>) -> Result<Self, Error> {
        let path = directory.join(ROWS);
        // before the program of the new run, so that it never stands beside the rows of another run
        let (file, length) = written(&path, &kept)?;
        replace(&directory.join(REQUEST), |draft| fs::write(draft, json(&program)))?;
        let report = Report { program, complete: false, rows: kept };
        replace(&directory.join(REPORT), |draft| fs::write(draft, json(&report)))?;
        let Report { program, rows: kept, .. } = report;
        let rows = Mutex::new(Rows { file, length, finished: Vec::new(), kept, is_closed: false });
        Ok(Self { path, program, rows })
    }

    /// The rows, also after a panic of a thread that held them: every change leaves them whole.
    fn rows(&self) -> MutexGuard<'_, Rows> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The program whose rows these are.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// Adds a finished row. The row is in the system's hands when the call returns.
    ///
    /// # Errors
    /// [`Error::Write`], which closes the journal, and after [`Journal::close`]; the lines before stay whole.
    pub fn add(&self, row: &Row) -> Result<(), Error> {
        let mut rows = self.rows();
        if rows.is_closed {
            return Err(write_error(&self.path, "the journal is closed"));
        }
        rows.finished.push(row.clone());
        let line = line(row);
        if let Err(why) = rows.file.write_all(line.as_bytes()) {
            // a reader leaves out the rest of a line that stays
            let _ = rows.file.set_len(rows.length);
            rows.is_closed = true;
            return Err(write_error(&self.path, why));
        }
        rows.length += line.len() as u64;
        Ok(())
    }

    /// Puts rows in place of all finished ones but the first `count`: those of cases that run several times.
    ///
    /// # Errors
    /// Those of [`Journal::add`].
    pub fn replace_after(&self, count: usize, new: &[Row]) -> Result<(), Error> {
        let mut rows = self.rows();
        if rows.is_closed {
            return Err(write_error(&self.path, "the journal is closed"));
        }
        rows.finished.truncate(count);
        rows.finished.extend_from_slice(new);
        let file = written(&self.path, &rows.finished);
        rows.is_closed = file.is_err();
        (rows.file, rows.length) = file?;
        Ok(())
    }

    /// Removes what this process has begun to write in the directory and has not finished.
    pub fn remove_drafts(&self) {
        remove_drafts(self.path.parent().unwrap_or(Path::new(".")));
    }

    /// Takes the row of an earlier run, if there is one, as a row of this run.
    pub fn take(&self, key: &RowKey) -> Option<Row> {
        let mut rows = self.rows();
        let at = rows.kept.iter().position(|row| row.key() == *key)?;
        let row = rows.kept.remove(at);
        rows.finished.push(row.clone());
        Some(row)
    }

    /// Whether no row is added any more.
    pub fn is_closed(&self) -> bool {
        self.rows().is_closed
    }

    /// The incomplete report, to which no row is added any more: a study that runs in another thread ends
    /// with an error at its next row.
    pub fn close(&self) -> Report {
        self.rows().is_closed = true;
        self.report()
    }

    /// The rows that are finished and those of an earlier run, as an incomplete report.
    pub fn report(&self) -> Report {
        let rows = self.rows();
        let mut all = [&rows.finished[..], &rows.kept[..]].concat();
        fill_orders(&mut all);
        Report { program: self.program.clone(), complete: false, rows: all }
    }
}

/// A row as a line of JSON.
fn line(row: &Row) -> String {
    serde_json::to_string(row).expect("a row is plain data with string keys") + "\n"
}

/// A program or a report as JSON.
fn json(of: &impl serde::Serialize) -> String {
    serde_json::to_string_pretty(of).expect("a report is plain data with string keys") + "\n"
}

/// The file of rows with these, to which others are added, and its length.
fn written(path: &Path, rows: &[Row]) -> Result<(File, u64), Error> {
    let text: String = rows.iter().map(line).collect();
    replace(path, |draft| fs::write(draft, &text))?;
    let file = OpenOptions::new().append(true).open(path).map_err(|e| write_error(path, e))?;
    Ok((file, text.len() as u64))
}

/// The program whose rows a directory has.
fn program_of_rows(directory: &Path) -> Result<Program, Error> {
    let path = directory.join(REQUEST);
    let wrong = |why: &dyn Display| {
        let rest = format!("the rows of {ROWS} may be those of another request: delete them too");
        read_error(&path, format!("{why}; {rest}"))
    };
    let bytes = read_file(&path).map_err(|why| wrong(&why))?;
    serde_json::from_slice(&bytes).map_err(|why| wrong(&why))
}

impl Report {
    /// The report of a directory: `report.json`, or, where that is incomplete, its program with the rows of
    /// `report.jsonl`. A last line without an end, which a run left that was killed, is left out.
    ///
    /// # Errors
    /// [`Error::Read`].
    pub fn read(directory: impl AsRef<Path>) -> Result<Self, Error> {
        let (path, lines) = (directory.as_ref().join(REPORT), directory.as_ref().join(ROWS));
        let bytes = read_file(&path).map_err(|why| read_error(&path, why))?;
        let mut report: Self =
            serde_json::from_slice(&bytes).map_err(|why| read_error(&path, why))?;
        if !report.complete && lines.exists() {
            report.rows = rows_of(&lines)?;
            fill_orders(&mut report.rows);
        }
        Ok(report)
    }
}

/// The rows of a file of lines, none where there is no file, without a last line that has no end.
fn rows_of(path: &Path) -> Result<Vec<Row>, Error> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let bytes = read_file(path).map_err(|why| read_error(path, why))?;
    let lines = bytes.split_inclusive(|&b| b == b'\n').filter(|line| line.ends_with(b"\n"));
    let row = |(at, line): (usize, &[u8])| {
        let is_wrong = |why| format!("line {}: {why}: delete it, its row runs again", at + 1);
        serde_json::from_slice(line).map_err(|why| read_error(path, is_wrong(why)))
    };
    lines.enumerate().map(row).collect()
}

//! The commands share messages, printing, threads, progress and drawing.

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use unilateral::error::Error;
use unilateral::input::{beginning, read_file};
use unilateral::nested::Solved;
use unilateral::plot::Picture;
use unilateral::scheme::NamedScheme;

/// The error of a wrong request is one message.
pub type Request<T> = Result<T, String>;

/// Why a command ended early.
#[derive(Debug)]
pub enum Failure {
    /// The request was wrong, found before any work: exit code 2.
    Request(String),
    /// The work could not go on: exit code 1.
    Work(String),
}

impl Failure {
    /// An error that ended the work.
    pub fn of_work(error: impl ToString) -> Self {
        Self::Work(error.to_string())
    }
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Request(message)
    }
}

/// Makes sure before the work, not after it, that a file can be written that is none of those which the run reads. A new
/// file is not left there.
pub fn check_writable(path: &Path, inputs: &[PathBuf]) -> Request<()> {
    let own = fs::canonicalize(path).ok();
    let is_own = |input: &&PathBuf| own.is_some() && fs::canonicalize(input).ok() == own;
    if let Some(input) = inputs.iter().find(is_own) {
        let why = format!("this run reads {}; choose another place", input.display());
        return Err(cannot_write(path, why));
    }
    let open = OpenOptions::new().append(true).create(true).open(path);
    open.map_err(|e| cannot_write(path, e))?;
    match own {
        Some(_) => Ok(()),
        None => fs::remove_file(path).map_err(|e| cannot_write(path, e)),
    }
}

/// The exit code of an interrupted run.
pub const INTERRUPTED: i32 = 130;

/// Lets SIGINT and SIGTERM, and Ctrl-C elsewhere, end the process with the exit code of an interrupt. What is
/// on disk stays there: files are replaced as a whole.
pub fn end_at_interrupt(left: &'static str) -> Request<()> {
    ctrlc::set_handler(move || {
        complain(&format!("interrupted; {left}"));
        std::process::exit(INTERRUPTED);
    })
    .map_err(|e| format!("cannot handle interrupts: {e}"))
}

/// Prints to standard output.
pub fn print(text: &str) -> Request<()> {
    print_to(std::io::stdout(), text)
}

/// Characters in a line of the terminal; a hundred where there is none.
pub fn terminal_width() -> usize {
    console::Term::stdout().size_checked().map_or(100, |(_, columns)| columns.into())
}

/// Prints to a stream; a closed pipe is no error.
pub fn print_to(mut stream: impl Write, text: &str) -> Request<()> {
    match stream.write_all(text.as_bytes()).and_then(|()| stream.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(format!("cannot print: {e}")),
        _ => Ok(()),
    }
}

/// Prints an error to standard error, in one line.
pub fn complain(message: &str) {
    warn(&format!("error: {message}"));
}

/// Prints one line to standard error. No path or name in it is longer than this many characters.
pub fn warn(message: &str) {
    const LONGEST: usize = 300;
    let words: Vec<String> =
        message.split(' ').map(|word| beginning(word.as_bytes(), LONGEST)).collect();
    let _ = writeln!(std::io::stderr(), "{}", words.join(" "));
}

pub fn read(path: &Path) -> Request<Vec<u8>> {
    read_file(path).map_err(|e| format!("cannot read {}: {e}", path.display()))
}

pub fn write(path: &Path, text: impl AsRef<[u8]>) -> Request<()> {
    fs::write(path, text).map_err(|e| cannot_write(path, e))
}

/// The message for a file that cannot be written.
pub fn cannot_write(path: &Path, why: impl std::fmt::Display) -> String {
    format!("cannot write {}: {why}", path.display())
}

/// More threads than this hardly help anyone, and the system may fail to start them.
pub const MOST_THREADS: usize = 1024;

/// Sets the number of threads; without one, all cores are used.
pub fn use_threads(threads: Option<usize>) -> Request<()> {
    let Some(threads) = threads else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build_global().map_err(|e| format!("--threads {threads}: {e}"))
}

/// The schemes of an option whose value was cut at commas, or the default ones.
pub fn schemes(asked: &[String], default: &[&'static str]) -> Request<Vec<NamedScheme>> {
    let found = match asked {
        [] => NamedScheme::list(default.iter().copied()),
        asked => NamedScheme::list(asked.iter().map(String::as_str)),
    };
    found.map_err(|e| e.to_string())
}

/// Each item once, in order of first occurrence.
pub fn each_once<T: Clone + PartialEq>(items: &[T]) -> Vec<T> {
    let mut once = Vec::new();
    for item in items {
        if !once.contains(item) {
            once.push(item.clone());
        }
    }
    once
}

/// A bar without a length yet on a terminal, nothing elsewhere. The bar does not [`tick`] yet.
pub fn bar(quiet: bool, template: &str) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(0);
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Lets a bar that is shown redraw itself five times a second.
pub fn tick(bar: &ProgressBar) {
    if !bar.is_hidden() {
        bar.enable_steady_tick(Duration::from_millis(200));
    }
}

/// The scheme and the level of a reference: `6`, `sipg-p2@level=6`, `wopsip@eta=1e2,level=6`.
pub fn reference(text: &str) -> Request<(NamedScheme, usize)> {
    let (scheme, level) = match text.rsplit_once("level=") {
        Some((scheme, level)) => (scheme.trim_end_matches(['@', ',']), level),
        None => ("p2", text),
    };
    let level = level.parse().map_err(|_| "expected a level, or SCHEME@level=N".to_owned())?;
    Ok((scheme.parse().map_err(|e: unilateral::scheme::SchemeNameError| e.to_string())?, level))
}

/// Draws a solution as `STEM.svg`. Returns the file; none without an iterate.
pub fn draw_solution<const D: usize>(
    title: &str,
    solved: &Solved<'_, D>,
    directory: &Path,
    stem: &str,
) -> Result<Option<PathBuf>, Error> {
    let Some(fields) = solved.fields() else { return Ok(None) };
    let problem = solved.discretisation().problem();
    Picture::of(title, problem, solved.mesh(), &fields)?.write(directory, stem).map(Some)
}

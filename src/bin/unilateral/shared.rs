//! The commands share messages, printing, threads, progress and drawing.

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use unilateral::error::Error;
use unilateral::input::{beginning, excerpt, read_file};
use unilateral::nested::Solved;
use unilateral::plot::Picture;
use unilateral::scenes;
use unilateral::scenes::{AnyScene, Parameters};
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

/// Makes sure before the work, not after it, that files can be written. A new file is not left there.
pub fn check_writable<'p>(paths: impl IntoIterator<Item = &'p PathBuf>) -> Request<()> {
    for path in paths {
        let file_is_new = !path.exists();
        let open = OpenOptions::new().append(true).create(true).open(path);
        open.map_err(|e| cannot_write(path, e))?;
        if file_is_new {
            fs::remove_file(path).map_err(|e| cannot_write(path, e))?;
        }
    }
    Ok(())
}

/// The ends of the names of files that runs write into a directory.
const WRITTEN: [&str; 9] = ["json", "jsonl", "csv", "md", "tex", "html", "svg", "vtu", "pvd"];

/// Refuses before the work files that are among those which the run has read, and directories in which one of these has
/// a name as files of reports have.
pub fn check_apart<'p>(
    inputs: &[PathBuf],
    files: impl IntoIterator<Item = &'p PathBuf>,
    directories: impl IntoIterator<Item = &'p PathBuf>,
) -> Request<()> {
    let refuse = |output: &Path, input: &Path| {
        let why = format!("this run reads {}; choose another place", input.display());
        Err(cannot_write(output, why))
    };
    for output in files {
        if let Some(input) = inputs.iter().find(|input| is_same(input, output)) {
            return refuse(output, input);
        }
    }
    for directory in directories {
        let is_written = |input: &&PathBuf| {
            let end = input.extension().unwrap_or_default().to_ascii_lowercase();
            // a file in the current directory has an empty path before its name
            let folder = std::path::absolute(input).ok();
            let folder = folder.as_ref().and_then(|path| path.parent());
            WRITTEN.iter().any(|written| end == *written)
                && folder.is_some_and(|folder| is_same(folder, directory))
        };
        if let Some(input) = inputs.iter().find(is_written) {
            return refuse(&directory.join(input.file_name().unwrap_or_default()), input);
        }
    }
    Ok(())
}

/// Whether two paths lead to one file or directory, by links too.
fn is_same(one: &Path, other: &Path) -> bool {
    #[cfg(unix)]
    let file = |path: &Path| {
        use std::os::unix::fs::MetadataExt;
        fs::metadata(path).ok().map(|about| (about.dev(), about.ino()))
    };
    #[cfg(not(unix))]
    let file = |path: &Path| fs::canonicalize(path).ok();
    file(one).is_some_and(|own| file(other) == Some(own))
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

/// Refuses more threads in the variable that sets their number where no option does.
pub fn check_environment() -> Request<()> {
    const VARIABLE: &str = "RAYON_NUM_THREADS";
    let threads = std::env::var(VARIABLE).ok().and_then(|text| text.parse::<usize>().ok());
    match threads.filter(|&n| n > MOST_THREADS) {
        Some(n) => Err(format!("{VARIABLE} {n}: must be at most {MOST_THREADS}")),
        None => Ok(()),
    }
}

/// Sets the number of threads; without one, all cores are used.
pub fn use_threads(threads: Option<usize>) -> Request<()> {
    let Some(threads) = threads else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build_global().map_err(|e| format!("--threads {threads}: {e}"))
}

/// A scene by name, with its default parameters.
pub fn scene(name: &str) -> Request<AnyScene> {
    let entry = scenes::by_name(name).ok_or_else(|| {
        let names: Vec<String> = scenes::catalogue().into_iter().map(|e| e.name).collect();
        format!("there is no scene {}; there are: {}", excerpt(name), names.join(", "))
    })?;
    entry.make(&Parameters::default()).map_err(|e| e.to_string())
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

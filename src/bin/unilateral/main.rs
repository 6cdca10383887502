//! Finite element schemes on variational inequalities, from the command line.
//!
//! `cargo run --release` compares schemes with the defaults, `cargo run --release -- --help` names
//! the other commands. Exit codes: 0 if the command succeeded, 1 if a run did not converge, a check
//! failed or the work ended in an error, 2 if the request was wrong, 130 if it was interrupted.

mod adaptive;
mod asked;
mod compare;
mod constants;
mod judge;
mod mesh_file;
mod one_run;
mod pictures;
mod shared;
mod stability;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
#[cfg(unix)]
use nix::sys::signal::{SigSet, Signal};
use shared::{Failure, Request, complain, print};
use unilateral::input::excerpt;

/// Finite element schemes on variational inequalities: comparisons, measurements, pictures.
#[derive(Parser)]
#[command(name = "unilateral", version, about)]
#[command(after_help = "Without a command, its options are those of `compare`.")]
struct Program {
    #[command(subcommand)]
    command: Command,
}

/// A name for `compare` with rounds, of which there are [`ROUNDS`] unless their number is given.
const WORK_PRECISION: &str = "work-precision";
const ROUNDS: &str = "--rounds=5";

#[derive(Subcommand)]
enum Command {
    #[command(visible_alias = WORK_PRECISION)]
    Compare(Box<compare::Options>),
    Stability(stability::Options),
    Pictures(Box<pictures::Options>),
    Judge(judge::Options),
    /// Names every scene, scheme, constraint placement and solver, as `compare --list` does
    List,
}

fn main() -> ExitCode {
    #[cfg(unix)]
    take_full_files_as_errors();
    let (code, message) =
        match parse(std::env::args_os().collect()).map_err(Failure::from).and_then(run) {
            Ok(is_good) => (u8::from(!is_good), String::new()),
            Err(Failure::Work(message)) => (1, message),
            Err(Failure::Request(message)) => (2, message),
        };
    // of several processes the first one says why
    if !message.is_empty() {
        complain(&message);
    }
    ExitCode::from(code)
}

/// Lets a write beyond the largest size of a file (`ulimit -f`) fail, as on a full disk; by default a signal ends the
/// process. All threads inherit this.
#[cfg(unix)]
fn take_full_files_as_errors() {
    let mut signals = SigSet::empty();
    signals.add(Signal::SIGXFSZ);
    signals.thread_block().expect("the signal exists");
}

/// Runs a command; false for exit code 1.
fn run(command: Command) -> Result<bool, Failure> {
    match command {
        Command::Compare(options) => Ok(compare::run(&options)?),
        Command::Stability(options) => stability::run(&options),
        Command::Pictures(options) => pictures::run(&options),
        Command::Judge(options) => Ok(judge::run(&options)?),
        Command::List => Ok(print(&compare::list()).map(|()| true)?),
    }
}

/// The command of a command line. Help and version are answered here and end the program.
fn parse(words: Vec<OsString>) -> Request<Command> {
    let words = with_command(words);
    match Program::try_parse_from(&words) {
        Ok(program) => Ok(program.command),
        Err(wrong) if wrong.use_stderr() => Err(one_line(&wrong, &words)),
        Err(answer) => answer.exit(),
    }
}

/// The words of the command line, `compare` inserted where no command is named, and its rounds where they have a name.
fn with_command(mut words: Vec<OsString>) -> Vec<OsString> {
    const OF_THE_PROGRAM: [&str; 4] = ["-h", "--help", "-V", "--version"];
    let first = words.get(1).map(|word| word.to_string_lossy());
    let is_option = |word: &str| word.starts_with('-') && !OF_THE_PROGRAM.contains(&word);
    if first.is_none_or(|word| is_option(&word)) {
        words.resize_with(words.len().max(1), OsString::new);
        words.insert(1, "compare".into());
    } else if words[1] == WORK_PRECISION {
        let is_rounds = |word: &OsString| word.to_string_lossy().starts_with("--rounds");
        let has_rounds = words.iter().any(is_rounds);
        words[1] = "compare".into();
        words.splice(2..2, (!has_rounds).then(|| ROUNDS.into()));
    }
    words
}

/// The error of the parser of options in one line, without its hints on usage.
fn one_line(wrong: &clap::Error, words: &[OsString]) -> String {
    let words = || words.iter().map(|word| word.to_string_lossy());
    let shortened = |text: String, word: &str| {
        let foreign = word.split(['=', ',']).filter(|part| excerpt(part) != *part);
        foreign.fold(text, |text, part| text.replace(part, &excerpt(part)))
    };
    let text = words().fold(wrong.to_string(), |text, word| shortened(text, &word));
    let hint = |line: &str| line.starts_with("Usage:") || line.starts_with("For more information");
    let lines: Vec<&str> =
        text.lines().map(str::trim).filter(|line| !line.is_empty() && !hint(line)).collect();
    let message = lines.join("; ").replacen("error: ", "", 1);
    let program = Program::command();
    let names: Vec<String> = match wrong.kind() {
        ErrorKind::UnknownArgument => {
            let command = words().nth(1).and_then(|name| program.find_subcommand(&*name));
            let arguments = command.unwrap_or(&program).get_arguments();
            let options = arguments.filter(|a| !a.is_hide_set()).filter_map(|a| a.get_long());
            options.chain(["help"]).map(|name| format!("--{name}")).collect()
        }
        ErrorKind::InvalidSubcommand => {
            program.get_subcommands().map(|command| command.get_name().to_owned()).collect()
        }
        _ => return message,
    };
    format!("{message}; there are: {}", names.join(", "))
}

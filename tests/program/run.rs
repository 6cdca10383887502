//! Running the program.

use std::path::Path;
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;

pub use crate::support::scratch::Scratch;

/// A command of the program, which cargo builds before the tests.
pub fn command(name: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_unilateral"));
    command.arg(name);
    command
}

/// The command `compare`.
pub fn program() -> Command {
    command("compare")
}

/// The tables and the report of the request without options, which runs once for all tests.
pub fn default_request() -> &'static (String, Value) {
    static DONE: OnceLock<(String, Value)> = OnceLock::new();
    DONE.get_or_init(|| {
        let scratch = Scratch::new("default");
        let output = scratch.run("--no-fields");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (stdout(&output), read_json(&scratch.0.join("out/report.json")))
    })
}

impl Scratch {
    pub fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
    /// Runs the program with a report in `out`, unless the options say where.
    pub fn run(&self, options: &str) -> Output {
        self.run_split(&options.split_whitespace().collect::<Vec<_>>())
    }
    pub fn run_split(&self, options: &[&str]) -> Output {
        let mut command = program();
        if !options.contains(&"--out") {
            command.args(["--out", &self.path("out")]);
        }
        command.args(options).output().unwrap()
    }
    /// The report of a run that succeeded.
    pub fn report(&self, options: &str) -> Value {
        let output = self.run(options);
        assert_eq!(output.status.code(), Some(0), "{options}: {}", stderr(&output));
        read_json(&self.0.join("out/report.json"))
    }
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A problem of the test data, with its mesh.
pub fn data(name: &str) -> String {
    format!("{}/tests/data/problems/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// A number of a row, under keys within each other.
pub fn number(row: &Value, keys: &[&str]) -> f64 {
    let value = keys.iter().fold(row, |value, key| &value[*key]);
    value.as_f64().unwrap_or_else(|| panic!("{keys:?} is {value} in {}", row["label"]))
}

pub fn read_json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

pub fn rows(report: &Value) -> &[Value] {
    report["rows"].as_array().unwrap()
}

/// What every wrong request must get: exit 2, one line that says `expected`, and no report.
pub fn refused(scratch: &Scratch, options: &[&str], expected: &[&str]) {
    let output = scratch.run_split(options);
    let (out, message) = (stdout(&output), stderr(&output));
    assert_eq!(output.status.code(), Some(2), "{options:?}: {message}");
    assert_eq!(out, "", "{options:?}");
    assert!(message.starts_with("error: "), "{options:?}: {message}");
    assert!(message.ends_with('\n') && message.lines().count() == 1, "{options:?}: {message}");
    assert!(!message.contains("panicked"), "{options:?}: {message}");
    for part in expected {
        assert!(message.contains(part), "{options:?}: no {part:?} in {message}");
    }
    assert!(!scratch.0.join("out").exists(), "{options:?} left a report");
}

//! A panic leaves the finished rows. No request is known that makes the program panic: its own handler runs here, in a
//! process that panics.

use std::path::PathBuf;
use std::process::{Command, exit};
use std::{env, fs, thread};

use super::interrupt_of_program::Interrupt;
use super::run::{Scratch, stderr};
use unilateral::prelude::*;
use unilateral::study::Program;

/// Names the directory of the report in the process that panics.
const DIRECTORY: &str = "UNILATERAL_TEST_OF_A_PANIC";

/// Finishes a row, then panics in a thread. Ends with exit code 3 if the handler does not end the process.
fn panic_after_a_row(directory: PathBuf) -> ! {
    let journal = Journal::create(&directory, Program::new("test", "f64", 1, 1)).unwrap();
    let journal: &'static Journal = Box::leak(Box::new(journal));
    let write = move |report: &Report| {
        let text = format!("{} rows", report.rows.len());
        fs::write(directory.join("written"), text).map_err(|e| e.to_string())
    };
    let interrupt = Interrupt::install(true, write).unwrap();
    interrupt.watch(journal);
    let study = Study::<1>::new(scenes::radial(1.0)).levels([4]);
    study.scheme(ConformingP1).journal(journal).run().unwrap();
    let _ = thread::spawn(|| panic!("a deliberate panic")).join();
    exit(3)
}

#[test]
fn a_panic_of_any_thread_writes_the_finished_rows_and_ends_the_process() {
    if let Some(directory) = env::var_os(DIRECTORY) {
        panic_after_a_row(directory.into());
    }
    let scratch = Scratch::new("panic");
    let test = "panics::a_panic_of_any_thread_writes_the_finished_rows_and_ends_the_process";
    let output = Command::new(env::current_exe().unwrap())
        .args([test, "--exact", "--nocapture"])
        .env(DIRECTORY, scratch.0.join("out"))
        .output()
        .unwrap();
    let messages = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{messages}");
    assert_eq!(scratch.read("out/written"), "1 rows");
    let place = messages.find("a deliberate panic");
    let report = messages.find(
        "error: stopped by a panic; 1 finished row is in the report, --resume goes on from there",
    );
    assert!(place.is_some() && place < report, "{messages}");
}

//! Inputs without an end, limits of the system, and messages that quote foreign text.

#[cfg(unix)]
use std::process::Command;
use std::process::Output;

use super::run::{Scratch, command, data, read_json, refused, rows, stderr};
use super::square::Square;
use unilateral::input::LARGEST_FILE;

#[test]
fn inputs_without_an_end_are_refused() {
    let scratch = Scratch::new("endless");
    refused(&scratch, &["--repeat", "1001"], &["--repeat 1001", "at most 1000"]);
    refused(&scratch, &["--repeat", "18446744073709551615"], &["at most 1000"]);
    let sparse = scratch.file("sparse.msh", &Square::sound());
    std::fs::File::options()
        .write(true)
        .open(&sparse)
        .and_then(|file| file.set_len(LARGEST_FILE + 1))
        .unwrap();
    refused(&scratch, &["--mesh", &sparse], &["cannot read", "sparse.msh", "2147483648 bytes"]);
}

#[test]
#[cfg(unix)]
fn devices_and_pipes_are_not_read() {
    let scratch = Scratch::new("devices");
    let pipe = scratch.path("pipe.msh");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in ["/dev/zero", "/dev/urandom", &pipe] {
        refused(&scratch, &["--mesh", path], &["cannot read", path, "not a regular file"]);
    }
}

/// One line, not much longer than the lists it may contain, without control characters.
fn check_message(output: &Output, what: &str) {
    let message = stderr(output);
    assert_eq!(output.status.code(), Some(2), "{what}: {message}");
    assert!(message.starts_with("error: ") && message.ends_with('\n'), "{what}: {message}");
    assert!(!message.trim_end().chars().any(char::is_control), "{what}: {message:?}");
    assert!(message.len() < 1500, "{what}: {} bytes, {message}", message.len());
}

#[test]
fn messages_quote_foreign_text_in_part_only() {
    let scratch = Scratch::new("foreign");
    let long = "x".repeat(100_000);
    for word in [&long[..], "red\u{1b}[31m\u{7}", "two\nlines"] {
        for (name, option) in [
            ("compare", "--scene"),
            ("compare", "--scheme"),
            ("compare", "--solver"),
            ("compare", "--linear"),
            ("compare", "--constraint"),
            ("compare", "--precision"),
            ("compare", "--levels"),
            ("work-precision", "--scene"),
            ("work-precision", "--scheme"),
            ("work-precision", "--subject"),
            ("stability", "--case"),
            ("stability", "--scheme"),
            ("stability", "--mesh"),
            ("pictures", "--scene"),
            ("pictures", "--scheme"),
        ] {
            let what = format!("{name} {option} {}", &word[..9]);
            for words in
                [vec![option.to_owned(), word.to_owned()], vec![format!("{option}={word}")]]
            {
                check_message(&command(name).args(words).output().unwrap(), &what);
            }
        }
        check_message(&command(word).output().unwrap(), "a command");
        // groups and sections of a mesh; a line ends a name
        if !word.contains('\n') {
            let wall = Square::sound().replace("\"dirichlet\"", &format!("\"{word}\""));
            let wall = scratch.file("wall.msh", &wall);
            check_message(&scratch.run_split(&["--mesh", &wall]), "a group");
            let boundary = ["--mesh", &wall, "--boundary", &format!("{word}s=neumann")];
            check_message(&scratch.run_split(&boundary), "--boundary");
            let section = Square::sound().replace("$Elements", &format!("${word}\n$Elements"));
            let section = scratch.file("section.msh", &section);
            check_message(&scratch.run_split(&["--mesh", &section]), "a section");
        }
    }
}

/// Where the largest mesh does not fit into the memory, its row says so and the others are solved.
#[test]
#[cfg(target_os = "linux")]
fn more_than_the_memory_is_a_row() {
    let total = std::fs::read_to_string("/proc/meminfo").unwrap();
    let total = total.lines().find_map(|line| line.strip_prefix("MemTotal:")).unwrap();
    if total.trim().trim_end_matches(" kB").parse::<u64>().unwrap() > 100_000_000 {
        return;
    }
    let scratch = Scratch::new("memory");
    let output = scratch.run("--scheme sipg --scene ball-2d --levels 8,7000");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let report = read_json(&scratch.0.join("out/report.json"));
    let [small, large] = rows(&report) else { panic!("{report}") };
    assert_eq!(
        (&small["status"], &large["status"]),
        (&"converged".into(), &"out-of-memory".into())
    );
    let message = large["message"].as_str().unwrap();
    for part in ["sipg", "level 7000", "GB of memory", "lower level"] {
        assert!(message.contains(part), "no {part} in {message}");
    }
}

/// Of a box whose sides differ by 1e7 no mesh is built to look at the data.
#[test]
fn a_box_with_too_many_cells_is_refused() {
    let scratch = Scratch::new("long-box");
    refused(&scratch, &[&data("aspect_box")], &["cells, at most"]);
}

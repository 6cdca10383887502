//! Inputs without an end, limits of the system, and messages that quote foreign text.

#[cfg(unix)]
use std::process::Command;
use std::process::Output;

#[cfg(target_os = "linux")]
use super::run::data;
use super::run::{Scratch, command, program, refused, stderr};
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

#[test]
fn the_variable_for_threads_has_the_limit_of_the_option() {
    for name in ["list", "compare", "stability", "pictures", "orders", "work-precision"] {
        let output = command(name).env("RAYON_NUM_THREADS", "100000").output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{name}");
        let expected = "error: RAYON_NUM_THREADS 100000: must be at most 1024\n";
        assert_eq!(stderr(&output), expected, "{name}");
    }
    let listed = program().arg("--list").env("RAYON_NUM_THREADS", "1024").output().unwrap();
    assert_eq!(listed.status.code(), Some(0), "{}", stderr(&listed));
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

/// A command under limits that a shell sets.
#[cfg(target_os = "linux")]
fn limited(scratch: &Scratch, limit: &str, command: &str, options: &str) -> Output {
    Command::new("sh")
        .args(["-c", &format!("ulimit {limit} && exec \"$0\" \"$@\"")])
        .args([env!("CARGO_BIN_EXE_unilateral"), command, "--out", &scratch.path("out")])
        .args(options.split(' '))
        .output()
        .unwrap()
}

/// On a machine with more than 100 GB the limit stands for the memory.
#[test]
#[cfg(target_os = "linux")]
fn more_than_the_memory_is_refused() {
    let scratch = Scratch::new("memory");
    let options = "--scheme sipg --scene ball-2d --levels 8,7000";
    let output = limited(&scratch, "-v 100000000", "compare", options);
    check_message(&output, "memory");
    let message = stderr(&output);
    for part in ["ball-2d", "sipg", "level 7000", "GB of memory", "lower level"] {
        assert!(message.contains(part), "no {part} in {message}");
    }
    assert!(!scratch.0.join("out").exists());
}

#[test]
#[cfg(target_os = "linux")]
fn a_limit_of_the_process_is_known_before_the_work() {
    let scratch = Scratch::new("limits");
    for limit in ["-v 500000", "-d 400000"] {
        let options = "--scene radial-2d --scheme wopsip --threads 2 --levels 8,512";
        let output = limited(&scratch, limit, "compare", options);
        check_message(&output, limit);
        let message = stderr(&output);
        for part in ["radial-2d", "wopsip", "level 512", "GB of memory", "choose a lower level"] {
            assert!(message.contains(part), "{limit}: no {part} in {message}");
        }
        assert!(!scratch.0.join("out").exists(), "{limit}");
        let output = limited(
            &scratch,
            limit,
            "compare",
            "--scene radial-2d --scheme wopsip --threads 2 --levels 8 --quiet",
        );
        assert_eq!(output.status.code(), Some(0), "{limit}: {}", stderr(&output));
        std::fs::remove_dir_all(scratch.0.join("out")).unwrap();
    }
}

/// Of a box whose sides differ by 1e7 no mesh is built to look at the data.
#[test]
#[cfg(target_os = "linux")]
fn no_command_begins_what_does_not_fit() {
    let scratch = Scratch::new("every-command");
    let long = data("aspect_box");
    let needs = "would need about";
    for (command, options, expected) in [
        ("compare", format!("{long} --levels 1"), needs),
        ("compare", long.clone(), "cells, at most"),
        ("compare", "--scene lshape-2d --scheme sipg --adaptive unknowns=1e9".to_owned(), needs),
        ("compare", "--scheme p1 --scene radial-2d --levels 4 --reference 4096".to_owned(), needs),
        ("pictures", "--level 4000".to_owned(), needs),
        ("pictures", "--level 4 --series 8,4000".to_owned(), needs),
        ("pictures", format!("{long} --level 1"), needs),
        ("work-precision", "--scene radial-2d --levels 8,4000".to_owned(), needs),
        ("work-precision", format!("{long} --levels 1 --quiet"), needs),
    ] {
        let output = limited(&scratch, "-v 5000000", command, &options);
        let what = format!("{command} {options}");
        check_message(&output, &what);
        assert!(stderr(&output).contains(expected), "{what}: {}", stderr(&output));
        assert!(!scratch.0.join("out").exists(), "{what}");
    }
}

//! Runs that are interrupted, killed or out of disk: no finished row is lost.

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use unilateral::study::Report;

use super::rows::without_times;
use super::run::{Scratch, program, read_json, refused, stderr};

const REQUEST: &str =
    "--scene radial-2d,signorini-2d --scheme p1,sipg,wopsip --levels 4,8,16 --threads 1";

/// Scene, label, solver and level of the lines of finished rows.
fn told(progress: &str) -> BTreeSet<String> {
    let line = |line: &str| Some(line.split_once(": converged, ")?.0.to_owned());
    progress.lines().filter_map(line).collect()
}

/// The same of the rows that the library reads.
fn found(out: &Path) -> BTreeSet<String> {
    let rows = Report::read(out).unwrap().rows;
    let name = |r: &unilateral::study::Row| {
        format!("{}, {}, {}, level {}", r.scene, r.label, r.solver, r.level)
    };
    rows.iter().map(name).collect()
}

/// Every file but drafts and the journal is whole.
fn check_files(out: &Path) {
    for entry in fs::read_dir(out).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let bytes = fs::read(&path).unwrap();
        let ends_with = |end: &str| bytes.trim_ascii_end().ends_with(end.as_bytes());
        let is_whole = match name.rsplit_once('.').unwrap() {
            ("", _) | (_, "jsonl") => true,
            _ if name.starts_with('.') => true,
            (_, "json") => serde_json::from_slice::<Value>(&bytes).is_ok(),
            (_, "csv") => bytes.is_empty() || bytes.ends_with(b"\n"),
            (_, "svg") => ends_with("</svg>"),
            (_, "vtu" | "pvd") => ends_with("</VTKFile>"),
            (_, "html") => ends_with("</html>"),
            (_, "md") => bytes.ends_with(b"\n"),
            (_, "tex") => bytes.ends_with(b"\n"),
            _ => panic!("{name}"),
        };
        assert!(is_whole, "{name} is not whole");
    }
}

/// Numbers between zero and one, the same in every run of the test.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 7_u64;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1_u64 << 24) as f64
    }
}

/// Kills runs at random moments by each signal in turn, and takes up what is left.
fn kill(runs: usize) {
    let scratch = Scratch::new(&format!("kill-{runs}"));
    let clock = Instant::now();
    let whole = without_times(scratch.report(REQUEST));
    let duration = clock.elapsed().as_secs_f64();
    let mut random = numbers();
    let (mut told_rows, mut left_rows, mut ended) = (0, 0, 0);
    for run in 0..runs {
        let out = scratch.0.join(format!("run-{run}"));
        let words = format!("{REQUEST} --out {}", out.display());
        let child = program()
            .args(words.split(' '))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let signal = ["INT", "TERM", "KILL"][run % 3];
        std::thread::sleep(Duration::from_secs_f64(random() * duration));
        let _ =
            Command::new("kill").args([&format!("-{signal}"), &child.id().to_string()]).output();
        let output = child.wait_with_output().unwrap();
        let what = format!("run {run}, {signal}: {}", stderr(&output));
        match (output.status.code(), output.status.signal()) {
            // the run was faster, or slower than the handler of signals
            (Some(0), _) => ended += 1,
            (Some(130), _) if signal != "KILL" => {}
            (None, Some(9)) if signal == "KILL" => {}
            (None, Some(2 | 15)) => assert!(!out.exists(), "{what}"),
            other => panic!("{other:?}, {what}"),
        }
        let told = told(&stderr(&output));
        told_rows += told.len();
        if out.join("report.json").exists() {
            let found = found(&out);
            left_rows += found.len();
            assert!(found.is_superset(&told), "{what}: {found:?}");
            if signal != "KILL" {
                let report = read_json(&out.join("report.json"));
                let has_ended = output.status.code() == Some(0);
                assert!(!has_ended || report["complete"] == true, "{what}");
                let rows = report["rows"].as_array().unwrap().len();
                assert!(rows >= told.len(), "{what}: {rows} rows in report.json");
            }
            check_files(&out);
        } else {
            assert!(told.is_empty(), "{what}");
        }
        let again = scratch.run(&format!("{words} --resume --quiet"));
        assert_eq!(again.status.code(), Some(0), "{what}, resumed: {}", stderr(&again));
        assert_eq!(without_times(read_json(&out.join("report.json"))), whole, "{what}");
        check_files(&out);
        fs::remove_dir_all(&out).unwrap();
    }
    println!("{runs} runs, {ended} ended before: {told_rows} rows told, {left_rows} found");
    assert!(told_rows > 0 && ended < runs, "the runs are too long or too short to be killed");
}

#[test]
fn no_finished_row_is_lost_in_ten_kills() {
    kill(10);
}

#[test]
#[ignore = "takes minutes"]
fn no_finished_row_is_lost_in_two_hundred_kills() {
    kill(200);
}

/// A limit on the size of a file stands for a full disk: first in the journal, then in a picture. Shells
/// count in blocks of 512 or 1024 bytes.
#[test]
fn a_full_disk_leaves_the_finished_rows() {
    let scratch = Scratch::new("disk");
    for (scene, scheme, levels, blocks, file) in [
        ("radial-1d", "all", "4,5,6,7", 40, "report.jsonl"),
        ("radial-2d", "p1", "4,8,32", 30, "radial-2d-p1.vtu"),
    ] {
        let out = scratch.0.join(scene);
        let output = Command::new("sh")
            .args(["-c", "ulimit -f \"$0\" && exec \"$@\"", &blocks.to_string()])
            .args([env!("CARGO_BIN_EXE_unilateral"), "compare", "--out"])
            .arg(&out)
            .args(["--scene", scene, "--scheme", scheme, "--levels", levels])
            .output()
            .unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{message}");
        let cannot = format!("cannot write {}", out.join(file).display());
        assert!(message.contains("error: ") && message.contains(&cannot), "{message}");
        let told = told(&message);
        assert!(told.len() >= 2, "{message}");
        assert!(found(&out).is_superset(&told), "{message}");
        assert!(!Report::read(&out).unwrap().complete);
        check_files(&out);
    }
}

#[test]
fn another_request_is_not_mixed_with_a_report() {
    let scratch = Scratch::new("other");
    let out = scratch.path("taken");
    let small = format!("--scene radial-1d --scheme p1 --quiet --out {out}");
    assert!(scratch.run(&format!("{small} --levels 4,8")).status.success());
    let before = fs::read(Path::new(&out).join("report.json")).unwrap();
    for (options, expected) in [
        ("--levels 4,8 --precision f32 --resume", "this run has precision f32"),
        ("--levels 4,8 --scale 2 --resume", "this run has scale 2.0"),
        ("--levels 4 --resume", "a row of p1 by active-set on radial-1d at level 8"),
    ] {
        let words = format!("{small} {options}");
        refused(
            &scratch,
            &words.split(' ').collect::<Vec<_>>(),
            &["another request", expected, &out],
        );
        assert_eq!(fs::read(Path::new(&out).join("report.json")).unwrap(), before, "{options}");
    }
    // more levels are the same request, of which a part is there
    let output = scratch.run(&format!("{small} --levels 4,8,16 --resume"));
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report = read_json(&Path::new(&out).join("report.json"));
    let fresh = scratch.report("--scene radial-1d --scheme p1 --quiet --levels 4,8,16");
    assert_eq!(without_times(report), without_times(fresh));
}

/// The other commands end with the code of an interrupt too, and leave what is finished.
#[test]
fn the_other_commands_end_at_an_interrupt() {
    let scratch = Scratch::new("other-interrupts");
    let out = scratch.path("out");
    for (name, options, file) in [
        ("work-precision", format!("--levels 8,16,32,64 --rounds 50 --out {out}"), "report.json"),
        ("stability", format!("--out {out}"), "stability.json"),
    ] {
        let mut command = super::run::command(name);
        let child = command.args(options.split(' ')).stderr(Stdio::piped()).spawn().unwrap();
        let clock = Instant::now();
        while !scratch.0.join("out").join(file).exists() && clock.elapsed().as_secs() < 60 {
            std::thread::sleep(Duration::from_millis(20));
        }
        let id = child.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(130), "{name}: {message}");
        assert!(message.contains("interrupted; "), "{name}: {message}");
        let report = read_json(&scratch.0.join("out").join(file));
        assert_eq!(report["complete"], false, "{name}");
        fs::remove_dir_all(scratch.0.join("out")).unwrap();
    }
}

//! One directory has one run at a time, and no file beside the report costs a row.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use unilateral::study::Report;

use super::run::{Scratch, command, stderr, stdout};
use super::square::Square;

/// A run that has finished its first rows, and goes on.
struct Running {
    child: Child,
    out: PathBuf,
}

impl Running {
    /// Starts `compare` with at most 3 GB of memory and waits for two rows.
    fn start(out: PathBuf, options: &str) -> Self {
        let child = Command::new("sh")
            .args(["-c", "ulimit -v 3000000 && exec \"$0\" \"$@\""])
            .args([env!("CARGO_BIN_EXE_unilateral"), "compare", "--threads", "1", "--out"])
            .arg(&out)
            .args(options.split(' '))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let running = Self { child, out };
        let clock = Instant::now();
        while running.journal().lines().count() < 2 {
            assert!(clock.elapsed() < Duration::from_secs(60), "no row of {options}");
            std::thread::sleep(Duration::from_millis(10));
        }
        running
    }
    fn journal(&self) -> String {
        fs::read_to_string(self.out.join("report.jsonl")).unwrap_or_default()
    }
    fn end(self, signal: &str) -> Output {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
        self.child.wait_with_output().unwrap()
    }
}

#[test]
fn a_second_run_into_a_directory_is_refused() {
    let scratch = Scratch::new("two-runs");
    let out = scratch.path("out");
    let options = "--scene radial-2d --scheme wopsip --levels 4,8,600";
    let first = Running::start(scratch.0.join("out"), options);
    for (name, options) in [
        ("compare", ""),
        ("compare", "--resume"),
        ("work-precision", "--rounds 2"),
        ("stability", "--quick"),
        ("pictures", "--level 4"),
    ] {
        let mut second = command(name);
        let output = second.args(["--out", &out]).args(options.split_whitespace()).output();
        let output = output.unwrap();
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        assert!(message.starts_with(&format!("error: {out}: another process")), "{message}");
        assert!(message.contains("choose another directory"), "{name}: {message}");
    }
    // the inequalities of two runs do not mix either
    let dump = ["--out", &scratch.path("other"), "--dump", &out];
    assert_eq!(command("compare").args(dump).output().unwrap().status.code(), Some(2));
    let before = first.journal();
    first.end("-KILL");
    let rows = Report::read(&out).unwrap().rows;
    assert!(rows.len() >= 2 && before.lines().count() <= rows.len());
    // the lock has gone with its process
    let options =
        format!("--scene radial-1d --scheme p1 --levels 4 --quiet --out {out} --dump {out}");
    let output = scratch.run(&options);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// So many steps need no memory before they are made.
#[test]
fn an_interrupted_adaptive_run_promises_no_resumption() {
    let scratch = Scratch::new("adaptive-interrupt");
    for (out, options, resumes) in [
        ("adaptive", "--scene lshape-2d --scheme p1 --adaptive theta=0.1,steps=1e8", false),
        ("uniform", "--scene radial-2d --scheme wopsip --levels 4,8,600", true),
    ] {
        let output = Running::start(scratch.0.join(out), options).end("-TERM");
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(130), "{message}");
        let end = message.lines().last().unwrap();
        assert!(end.contains("finished rows are in the report"), "{message}");
        assert_eq!(end.contains("--resume goes on from there"), resumes, "{message}");
    }
}

/// Directories stand where a field and a picture would be written.
#[test]
fn a_file_that_cannot_be_written_costs_no_row() {
    let scratch = Scratch::new("no-field");
    for file in ["radial-1d-p1.vtu", "radial-1d-cr.svg"] {
        fs::create_dir_all(scratch.0.join("out").join(file)).unwrap();
    }
    let output = scratch.run("--scene radial-1d,radial-2d --scheme p1,cr --levels 4,8");
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    let field = scratch.0.join("out/radial-1d-p1.vtu");
    let expected = format!("error: scene radial-1d: cannot write {}: ", field.display());
    assert_eq!(message.matches(&expected).count(), 1, "{message}");
    assert!(message.contains("warning: no picture of radial-1d-cr: cannot write"), "{message}");
    // all rows are printed, and the report is not complete
    assert!(stdout(&output).contains("The incomplete report is in"), "{}", stdout(&output));
    assert!(stdout(&output).contains("radial-2d, level 8"), "{}", stdout(&output));
    let rows = Report::read(scratch.0.join("out")).unwrap().rows;
    assert_eq!(rows.iter().filter(|row| row.converged()).count(), 8, "{message}");
    assert!(Path::new(&scratch.path("out/radial-1d-cr.vtu")).is_file());
    // the rows stay
    fs::remove_dir(&field).unwrap();
    let resume = "--scene radial-1d,radial-2d --scheme p1,cr --levels 4,8 --resume";
    let output = scratch.run(resume);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(Report::read(scratch.0.join("out")).unwrap().rows == rows);
    // rows without their report are known by the request beside them
    fs::remove_file(scratch.0.join("out/report.json")).unwrap();
    assert_eq!(stderr(&scratch.run(resume)).matches("error").count(), 0);
    assert!(Report::read(scratch.0.join("out")).unwrap().rows == rows);
}

/// A file of a dump takes the place of a link.
#[cfg(unix)]
#[test]
fn a_dump_writes_over_no_other_file() {
    let scratch = Scratch::new("dump-link");
    let own = scratch.file("mine.txt", "mine");
    let request = scratch.0.join("dump/radial-1d-p1-4/request.json");
    fs::create_dir_all(request.parent().unwrap()).unwrap();
    std::os::unix::fs::symlink(&own, &request).unwrap();
    let dump = scratch.path("dump");
    let options = format!("--scene radial-1d --scheme p1 --levels 4 --quiet --dump {dump}");
    assert!(scratch.run(&options).status.success());
    assert_eq!(scratch.read("mine.txt"), "mine");
    assert!(fs::read_to_string(request).unwrap().contains("radial-1d"));
}

/// Nothing that a run reads is written over, by whatever name.
#[test]
fn an_output_that_is_an_input_is_refused() {
    let scratch = Scratch::new("over-inputs");
    let text = "mesh = \"square.msh\"\n[source]\ndefault = -1\n[boundary.dirichlet]\n\
        kind = \"dirichlet\"\n";
    let problem = scratch.file("mm.toml", text);
    let mesh = scratch.file("square.msh", &Square::sound());
    #[cfg(unix)]
    std::os::unix::fs::symlink(&mesh, scratch.0.join("link")).unwrap();
    let here = scratch.0.display().to_string();
    let before = files(&scratch.0);
    let scene = ["--scene", "radial-2d", "--mesh", &mesh];
    let dots = format!("{here}/../{}/mm.toml", scratch.0.file_name().unwrap().to_str().unwrap());
    let link = scratch.path("link");
    let requests = [
        ("compare", vec![&problem[..], "--json", &problem], &problem, &problem),
        ("compare", vec![&problem, "--json", &dots], &dots, &problem),
        ("compare", vec![&problem, "--json", &mesh], &mesh, &mesh),
        ("compare", [&scene[..], &["--json", &mesh]].concat(), &mesh, &mesh),
        #[cfg(unix)]
        ("compare", vec![&problem, "--json", &link], &link, &mesh),
    ];
    for (name, options, output, input) in requests {
        let mut command = command(name);
        let found = command.args(["--out", &scratch.path("out")]).args(&options).output().unwrap();
        let message = stderr(&found);
        assert_eq!(found.status.code(), Some(2), "{name} {options:?}: {message}");
        let expected =
            format!("error: cannot write {output}: this run reads {input}; choose another place\n");
        assert!(message.ends_with(&expected), "{name} {options:?}: {message}");
        assert!(files(&scratch.0) == before, "{name} {options:?} has written");
    }
}

/// The files of a directory, with their contents.
fn files(directory: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let paths = fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = paths.map(|path| (path.clone(), fs::read(path).unwrap())).collect();
    files.sort();
    files
}

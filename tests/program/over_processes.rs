//! The program over several processes.

use crate::run::Scratch;

/// Without PETSc every process would do the whole work and write the same files.
#[cfg(not(feature = "petsc"))]
#[test]
fn a_program_without_petsc_refuses_several_processes() {
    use crate::run::{program, refused, stderr};

    let scratch = Scratch::new("without-petsc");
    let expected = ["cargo build --release --features petsc"];
    refused(&scratch, &["--engine", "petsc"], &expected);
    // what a launcher of MPI jobs sets
    let mut command = program();
    command.args(["--out", &scratch.path("out")]).env("OMPI_COMM_WORLD_SIZE", "2");
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains(expected[0]));
    let unknown = ["petsc", "trilinos"];
    refused(&scratch, &["--engine", "trilinos"], &unknown);
}

/// With the feature `petsc`, where `mpirun` is.
#[cfg(feature = "petsc")]
mod needs_petsc {
    use super::*;
    use crate::run::{command, read_json, rows, stderr};
    use serde_json::Value;
    use std::process::{Child, Command, Output, Stdio};
    use std::time::{Duration, Instant};

    /// Within so many seconds every process of a job with a failure ends.
    const PATIENCE: Duration = Duration::from_secs(60);

    /// How often a fault is provoked.
    const REPETITIONS: usize = 10;

    fn mpirun() -> Command {
        let mut mpirun = Command::new("mpirun");
        mpirun.arg("--oversubscribe");
        mpirun.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
        mpirun
    }

    /// The command of a job.
    fn job(processes: usize, scratch: &Scratch, options: &str) -> Command {
        let mut mpirun = mpirun();
        mpirun.args(["-n", &processes.to_string()]);
        mpirun.arg(env!("CARGO_BIN_EXE_unilateral")).args(["compare", "--engine", "petsc"]);
        mpirun.args(["--threads", "1", "--out", &scratch.path(&format!("out-{processes}"))]);
        mpirun.args(options.split_whitespace());
        mpirun
    }

    fn report(processes: usize, scratch: &Scratch) -> Value {
        read_json(&scratch.0.join(format!("out-{processes}/report.json")))
    }

    /// Waits for the end of a job.
    fn end(mut child: Child) -> Output {
        let clock = Instant::now();
        while child.try_wait().unwrap().is_none() {
            if clock.elapsed() > PATIENCE {
                child.kill().unwrap();
                panic!("the job did not end");
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        child.wait_with_output().unwrap()
    }

    fn number(row: &Value, path: &str) -> f64 {
        row.pointer(path).unwrap().as_f64().unwrap()
    }

    /// The errors are those of one process without MPI, and iterations do not depend on the number of processes.
    #[test]
    #[ignore = "needs PETSc and mpirun"]
    fn any_number_of_processes_has_the_rows_of_one() {
        let scratch = Scratch::new("ranks");
        let plane = "--scene radial-2d,signorini-2d --levels 32,64 --scheme p1,cr,sipg,nipg,ldg,br2,wopsip,wopsip:facet-means";
        let space = "--scene radial-3d --levels 8 --scheme p1,sipg,wopsip:facet-means";
        for options in [plane, space] {
            let mut serial = command("compare");
            serial.args(["--no-fields", "--quiet", "--out", &scratch.path("serial")]);
            assert!(serial.args(options.split_whitespace()).status().unwrap().success());
            let serial = read_json(&scratch.0.join("serial/report.json"));
            let mut counts: Vec<f64> = Vec::new();
            for processes in [1, 2, 4] {
                let output =
                    job(processes, &scratch, &format!("{options} --quiet")).output().unwrap();
                assert!(output.status.success(), "{}", stderr(&output));
                let report = report(processes, &scratch);
                assert_eq!(rows(&report).len(), rows(&serial).len());
                for (k, (row, one)) in rows(&report).iter().zip(rows(&serial)).enumerate() {
                    let label = format!("{processes} processes: {row}");
                    for key in ["scene", "label", "level", "unknowns", "nonzeros", "active"] {
                        assert_eq!(row[key], one[key], "{key}, {label}");
                    }
                    let [found, expected] = [row, one].map(|row| number(row, "/error/l2"));
                    assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected} {label}");
                    let linear = number(row, "/iterations/linear");
                    match counts.get(k).copied() {
                        None => counts.push(linear),
                        Some(first) => {
                            let most = (0.1 * first).max(2.0);
                            assert!((linear - first).abs() <= most, "{first} {linear} {label}");
                        }
                    }
                }
            }
        }
    }

    /// Data that are no numbers: all end, and the first says where.
    #[test]
    #[ignore = "needs PETSc and mpirun"]
    fn data_that_are_no_numbers_end_all_processes() {
        let scratch = Scratch::new("nan-of-rank");
        let text = "name = \"corner\"\nbox = [[0, 0], [1, 1]]\n[source]\ndefault = \"sqrt(1.8 - x - y)\"\n[obstacle]\nlower.default = -1.0\n[boundary.left]\nkind = \"dirichlet\"\nvalue = 0\n[boundary.right]\nkind = \"dirichlet\"\nvalue = 0\n[boundary.bottom]\nkind = \"dirichlet\"\nvalue = 0\n[boundary.top]\nkind = \"dirichlet\"\nvalue = 0\n";
        let problem = scratch.file("corner.toml", text);
        let options = format!("{problem} --levels 8 --scheme p1,sipg --quiet");
        for _ in 0..REPETITIONS {
            let child = job(3, &scratch, &options).stderr(Stdio::piped()).spawn().unwrap();
            let output = end(child);
            assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
            assert!(one_sentence(&output).contains("corner.toml:4:11: source.default is NaN at"));
        }
    }

    /// The one sentence of a job that was refused or has failed.
    #[track_caller]
    fn one_sentence(output: &Output) -> String {
        let message = stderr(output);
        let lines: Vec<&str> = message.lines().filter(|line| line.starts_with("error: ")).collect();
        assert_eq!(lines.len(), 1, "{message}");
        lines[0].to_owned()
    }

    /// A process that is killed, the first one too, ends the job; rows that are finished are on disk.
    #[test]
    #[ignore = "needs PETSc and mpirun"]
    fn a_killed_process_ends_all() {
        for victim in [0, 1].repeat(REPETITIONS) {
            let scratch = Scratch::new(&format!("killed-{victim}"));
            let options =
                "--scene radial-2d --levels 16,32,64,128,256,512 --scheme p1,sipg,wopsip --quiet";
            let child = job(2, &scratch, options).stderr(Stdio::piped()).spawn().unwrap();
            let rows_on_disk = scratch.0.join("out-2/report.jsonl");
            let count = || {
                let text = std::fs::read_to_string(&rows_on_disk).unwrap_or_default();
                text.lines().filter(|line| serde_json::from_str::<Value>(line).is_ok()).count()
            };
            let clock = Instant::now();
            while count() < 3 {
                assert!(clock.elapsed() < PATIENCE, "no row");
                std::thread::sleep(Duration::from_millis(20));
            }
            let mut processes = processes_of(child.id());
            processes.sort_unstable();
            assert_eq!(processes.len(), 2);
            let killed = Command::new("kill").args(["-9", &processes[victim].to_string()]).status();
            assert!(killed.unwrap().success());
            let before = count();
            assert!(!end(child).status.success());
            assert!(count() >= before && before >= 3);
        }
    }

    /// The processes that a process has started.
    fn processes_of(parent: u32) -> Vec<u32> {
        let all = std::fs::read_dir("/proc").unwrap().filter_map(Result::ok);
        let numbers = all.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
        let is_child = |number: &u32| {
            let stat = std::fs::read_to_string(format!("/proc/{number}/stat")).unwrap_or_default();
            let after = stat.rsplit(") ").next().unwrap_or_default();
            after.split(' ').nth(1) == Some(&parent.to_string())
        };
        numbers.filter(is_child).collect()
    }

    /// The second process panics while the first one waits for it.
    #[test]
    #[ignore = "needs PETSc and mpirun"]
    fn a_panic_of_one_process_ends_all() {
        for _ in 0..REPETITIONS {
            let mut mpirun = mpirun();
            mpirun.args(["-n", "2"]).arg(std::env::current_exe().unwrap());
            let name = "over_processes::in_a_job::the_second_process_panics";
            mpirun.args(["--ignored", "--exact", name, "--nocapture"]);
            let output = end(mpirun.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap());
            assert!(!output.status.success());
            let message = stderr(&output);
            assert!(message.contains("the second process has a fault"), "{message}");
        }
    }

    /// A matrix without factors ends its row, with the status of one process, and no other row.
    #[test]
    #[ignore = "needs PETSc and mpirun"]
    fn a_failure_ends_one_row() {
        let scratch = Scratch::new("one-row");
        for scene in ["radial-1d", "radial-2d"] {
            let options = format!("--scene {scene} --scheme sipg@sigma=1,p1 --levels 16 --quiet");
            let output = job(2, &scratch, &options).output().unwrap();
            assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
            let report = report(2, &scratch);
            let statuses: Vec<&Value> = rows(&report).iter().map(|row| &row["status"]).collect();
            assert_eq!(statuses, ["not-coercive", "converged"], "{scene}");
        }
    }

    /// A file of fields that cannot be written is an error of the run; its row is kept.
    #[test]
    #[ignore = "needs PETSc and mpirun"]
    fn a_row_whose_fields_are_not_written_is_kept() {
        let scratch = Scratch::new("no-fields");
        std::fs::create_dir_all(scratch.0.join("out-2/radial-2d-p1.1.vtu")).unwrap();
        let options = "--scene radial-2d --scheme p1 --levels 8 --quiet";
        let child = job(2, &scratch, options).stderr(Stdio::piped()).spawn().unwrap();
        let output = end(child);
        assert!(!output.status.success());
        assert!(one_sentence(&output).contains("radial-2d-p1"), "{}", stderr(&output));
        let journal = scratch.read("out-2/report.jsonl");
        assert!(journal.contains("\"converged\""), "{journal}");
    }

    /// Processes with other options than the first one are refused; none waits for another.
    #[test]
    #[ignore = "needs PETSc and mpirun"]
    fn processes_with_different_requests_are_refused() {
        let scratch = Scratch::new("different");
        let of_second = ["--levels 16", "--levels 8 --repeat 2", "--levels 8 --scheme sipg,p1"];
        for (k, options) in of_second.into_iter().enumerate() {
            let mut mpirun = mpirun();
            for (process, options) in ["--levels 8", options].into_iter().enumerate() {
                mpirun.args(if process > 0 { &[":", "-n", "1"][..] } else { &["-n", "1"] });
                mpirun.arg(env!("CARGO_BIN_EXE_unilateral")).args(["compare", "--engine", "petsc"]);
                mpirun.args(["--scene", "radial-2d", "--quiet", "--out", &scratch.path("out")]);
                mpirun.args(options.split_whitespace());
            }
            let output = end(mpirun.stderr(Stdio::piped()).spawn().unwrap());
            assert_eq!(output.status.code(), Some(2), "{k}: {}", stderr(&output));
            let expected = if k == 1 { "--repeat" } else { "process 1 has other options" };
            assert!(one_sentence(&output).contains(expected), "{}", stderr(&output));
        }
    }

    /// Options that processes do not support are refused with one sentence.
    #[test]
    #[ignore = "needs PETSc and mpirun"]
    fn what_processes_do_not_support_is_refused() {
        let scratch = Scratch::new("unsupported");
        for option in
            ["--precision f32", "--adaptive 0.1", "--solver monotone-multigrid", "--resume"]
        {
            let output = job(2, &scratch, option).output().unwrap();
            assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
            assert!(one_sentence(&output).contains(option.split(' ').next().unwrap()));
        }
    }
}

/// What another test runs by `mpirun`: a panic here ends the whole program of tests.
#[cfg(feature = "petsc")]
mod in_a_job {
    use unilateral::distributed::petsc::Processes;

    #[test]
    #[ignore = "runs in the processes of another test"]
    fn the_second_process_panics() {
        let processes = Processes::start().unwrap();
        assert_ne!(processes.rank(), 1, "the second process has a fault");
        let own = processes.own();
        assert_eq!(own.exchange.largest(&[1.0]).unwrap(), [1.0]);
    }
}

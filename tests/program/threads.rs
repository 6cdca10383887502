//! Many threads on small meshes: the program ends.

use std::fs;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::run::{Scratch, program, read_json, rows};

/// A process whose threads take no processor time for so long waits for itself.
const LONGEST_WAIT: Duration = Duration::from_secs(10);

/// Clock ticks of the processor that a process has taken so far, in its own code and in the system's.
fn ticks(process: &Child) -> u64 {
    let stat = fs::read_to_string(format!("/proc/{}/stat", process.id())).unwrap();
    // the name of the program, in parentheses, may contain blanks
    let (_, after_name) = stat.rsplit_once(')').unwrap();
    let field = |k: usize| after_name.split_whitespace().nth(k).unwrap().parse::<u64>().unwrap();
    field(11) + field(12)
}

/// Broken schemes on meshes with fewer chunks of cells than threads: a thread that waits for its own parallel work
/// takes up other tasks, and must not ask for a lock that it holds.
#[test]
fn sixteen_threads_finish_small_meshes_of_broken_schemes() {
    let scratch = Scratch::new("sixteen-threads");
    let schemes = "sipg,nipg,iipg,ldg,br2,wopsip,wopsip:facet-means";
    let levels: Vec<String> = (24..32).step_by(2).map(|level: u32| level.to_string()).collect();
    let (levels, out) = (levels.join(","), scratch.path("out"));
    let options = ["--scene", "radial-2d,signorini-2d", "--scheme", schemes, "--levels", &levels];
    let mut command = program();
    command.args(options).args(["--threads", "16", "--no-fields", "--out", &out]);
    let mut process = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let (mut last, mut since) = (0, Instant::now());
    let status = loop {
        if let Some(status) = process.try_wait().unwrap() {
            break status;
        }
        let now = ticks(&process);
        if now != last {
            (last, since) = (now, Instant::now());
        }
        if since.elapsed() > LONGEST_WAIT {
            process.kill().unwrap();
            process.wait().unwrap();
            let finished = scratch.read("out/report.jsonl");
            panic!("no processor time in {LONGEST_WAIT:?} after {}", finished.lines().count());
        }
        sleep(Duration::from_millis(100));
    };
    assert_eq!(status.code(), Some(0));
    assert_eq!(rows(&read_json(&scratch.0.join("out/report.json"))).len(), 2 * 7 * 4);
}

//! Runs that would not fit into the memory, and what a process has and may have.

use unilateral::element::P2;
use unilateral::inequality::{ActiveSet, Outcome};
use unilateral::linear::LinearMethod;
use unilateral::prelude::*;
use unilateral::study::peak_memory_bytes;

use crate::support::scratch::Scratch;

/// Level 200 has 4.8e7 tetrahedra, whose factors take more memory than machines have.
fn study<'a>() -> Study<'a, 3> {
    let direct = ActiveSet::default().linear(LinearMethod::Direct);
    Study::new(scenes::radial::<3>(1.0)).scheme(Sipg::default()).solver(direct)
}

#[test]
fn a_level_that_does_not_fit_is_a_row_and_its_mesh_is_not_built() {
    let study = study().levels([2, 200, 3]);
    let error = study.check_memory().unwrap_err();
    let Error::NotEnoughMemory(why) = error else { panic!("{error}") };
    let gigabytes = |words: &str| -> f64 {
        let rest = why.split_once(words).unwrap_or_else(|| panic!("{why}")).1;
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    let [needed, available] = ["would need about ", "GB of memory, "].map(gigabytes);
    assert!(needed > 1e3 && available < needed, "{why}");
    let report = study.run().unwrap();
    let status: Vec<Outcome> = report.rows.iter().map(|row| row.status).collect();
    assert_eq!(status, [Outcome::Converged, Outcome::OutOfMemory, Outcome::Converged]);
    let row = &report.rows[1];
    let message = row.message.as_deref().unwrap();
    assert!(message.starts_with("scheme sipg, level 200: would need about "), "{message}");
    assert!(message.ends_with("are available; choose a lower level"), "{message}");
    assert_eq!((row.cells, row.unknowns), (48_000_000, None));
    let scratch = Scratch::new("memory");
    report.write(&scratch.0).unwrap();
    assert!(scratch.read("report.md").contains("out-of-memory"));
}

#[test]
fn the_first_mesh_of_a_refinement_is_held_against_the_memory_before_it_is_built() {
    let study = study().levels([200]).adaptive(Adaptivity::default().unknowns(1000));
    let error = study.check().unwrap_err();
    assert!(matches!(error, Error::NotEnoughMemory(_)), "{error}");
    let study = self::study().levels([2]).adaptive(Adaptivity::default().unknowns(1_000_000_000));
    study.check().unwrap();
    let message = study.check_memory().unwrap_err().to_string();
    assert!(message.contains("sipg, 1000000000 unknowns: would need about"), "{message}");
    assert!(message.ends_with("choose fewer unknowns"), "{message}");
    assert!(study.keys().is_empty());
}

/// Broken quadratics in space have 500 entries a cell: 4.3e9 at level 113.
#[test]
fn a_matrix_with_too_many_entries_is_refused_before_a_mesh_is_built() {
    let study = |level: usize| {
        let study = Study::<3>::new(scenes::radial(1.0)).scheme(ConformingP1);
        study.scheme(Sipg::default().on(P2)).levels([2, level])
    };
    study(112).check().unwrap();
    let error = study(113).check().unwrap_err();
    assert!(matches!(error, Error::Parameter(_)), "{error}");
    let message = error.to_string();
    assert!(
        message.starts_with("level = 113: the matrix of sipg-p2 there may have 4.3e9 entries"),
        "{message}"
    );
    assert!(message.ends_with("a coarser level, a lower degree or more processes"), "{message}");
}

/// On Linux the peak is the one that the kernel keeps, which never falls.
#[test]
fn the_peak_is_read_and_nothing_is_made_up() {
    let by_kernel = || {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        Some(1024 * line.split_whitespace().next()?.parse::<u64>().ok()?)
    };
    let before = by_kernel();
    let peak = peak_memory_bytes();
    assert!(before <= peak && peak <= by_kernel(), "{peak:?}");
    assert_eq!(peak.is_some(), cfg!(target_os = "linux"));
}

/// Files of the system that say what a process may have.
#[cfg(target_os = "linux")]
mod limits {
    use super::Scratch;
    use unilateral::study::allowed_memory_bytes;

    /// What the process has in these files.
    const OWN: u64 = 1024 << 10;

    fn put(root: &Scratch, name: &str, text: &str) {
        let path = root.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// A system without limits.
    fn system(name: &str) -> Scratch {
        let root = Scratch::new(name);
        put(&root, "proc/self/status", "VmPeak:\t 999 kB\nVmRSS:\t   1024 kB\nVmData:\t 7 kB\n");
        put(&root, "proc/meminfo", "MemTotal: 9 kB\n");
        root
    }

    #[test]
    fn sizes_are_read_and_nothing_is_made_up() {
        let root = system("memory-of-machine");
        let allowed = || allowed_memory_bytes(&root.0);
        assert_eq!(allowed(), None);
        for (text, left) in [
            ("MemTotal: 9 kB\nMemAvailable:   2048 kB\n", Some(2048 << 10)),
            ("MemAvailable: many kB\n", None),
            ("MemAvailable: 2048\n", None),
            ("MemAvailable: 18446744073709551615 kB\n", None),
        ] {
            put(&root, "proc/meminfo", text);
            assert_eq!(allowed(), left.map(|left: u64| left + OWN), "{text}");
        }
        put(&root, "proc/meminfo", "MemAvailable:   2048 kB\n");
        put(&root, "proc/self/status", "VmPeak:\t 999 kB\n");
        assert_eq!(allowed(), None);
    }

    #[test]
    fn the_least_limit_of_the_process_counts() {
        let root = system("memory-of-process");
        let reserved = rayon::current_num_threads() as u64 * (66 << 20);
        let space = |left: u64| (reserved + left).to_string();
        let least = |space: &str, data: &str| {
            let limits = format!(
                "Limit                     Soft Limit           Hard Limit           Units\n\
                 Max cpu time              unlimited            unlimited            seconds\n\
                 Max data size             {data}            unlimited            bytes\n\
                 Max address space         {space}            4096            bytes\n"
            );
            put(&root, "proc/self/limits", &limits);
            allowed_memory_bytes(&root.0)
        };
        assert_eq!(least("unlimited", "unlimited"), None);
        assert_eq!(least(&space(9216), "unlimited"), Some(9216));
        assert_eq!(least(&space(10240), "5120"), Some(5120));
        assert_eq!(least("512", "unlimited"), Some(0));
        // beside what the machine leaves
        put(&root, "proc/meminfo", "MemAvailable: 8 kB\n");
        assert_eq!(least("unlimited", "5120"), Some(5120));
        assert_eq!(least("unlimited", &(2 * OWN).to_string()), Some(OWN + 8192));
        put(&root, "proc/self/limits", "");
        assert_eq!(allowed_memory_bytes(&root.0), Some(OWN + 8192));
    }

    #[test]
    fn the_least_limit_of_the_groups_counts() {
        let root = system("memory-of-groups");
        let group = |path: &str, files: &[(&str, &str)]| {
            files.iter().for_each(|(name, text)| put(&root, &format!("{path}/{name}"), text));
        };
        let all = "sys/fs/cgroup";
        let job = format!("{all}/job");
        group(&job, &[("memory.max", "5000\n"), ("memory.current", "1200\n")]);
        group(&job, &[("memory.stat", "anon 1000\ninactive_file 200\n")]);
        let step = [("memory.max", "max\n"), ("memory.current", "600\n")];
        group(&format!("{job}/step"), &step);
        let first = format!("{all}/memory");
        group(&first, &[("memory.limit_in_bytes", "3000"), ("memory.usage_in_bytes", "2500")]);
        group(&first, &[("memory.stat", "inactive_file 1\ntotal_inactive_file 100\n")]);
        let left = |groups: &str| {
            put(&root, "proc/self/cgroup", groups);
            allowed_memory_bytes(&root.0).map(|bytes| bytes - OWN)
        };
        assert_eq!(left("0::/job/step\n"), Some(4000));
        // of a group and of those around it the one counts that leaves least
        let other = [("memory.max", "7000\n"), ("memory.current", "600\n")];
        group(&format!("{job}/other"), &other);
        assert_eq!(left("0::/job/other\n"), Some(4000));
        assert_eq!(left("0::/job\n"), Some(4000));
        assert_eq!(left("0::/\n"), None);
        // a group of version 1 that is not found inside a container
        assert_eq!(left("7:cpu:/x\n9:hugetlb,memory:/docker/abc\n0::/job\n"), Some(600));
        assert_eq!(left("9:memoryless:/job\n"), None);
        assert_eq!(left("no group\n"), None);
        // a group that has more than its limit
        group(&job, &[("memory.current", "9000\n")]);
        assert_eq!(left("0::/job\n"), Some(0));
    }
}

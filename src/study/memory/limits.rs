//! Limits on the memory of this process and of its control group, which a batch system may set far
//! below the memory of the machine.

use std::fs::read_to_string;
use std::path::Path;

/// A number of a file of the system in bytes; it is given in units of 1024 bytes, called kB.
pub(super) fn kilobytes(text: &str, key: &str) -> Option<u64> {
    let value = text.lines().find_map(|l| l.strip_prefix(key))?;
    let kilobytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// Address space that each thread reserves: 64 MiB for its allocations and 2 MiB for its stack.
const PER_THREAD: u64 = 66 << 20;

/// The limits on address space and data less what threads reserve, in bytes; none without such limits.
pub(super) fn limit_of_process() -> Option<u64> {
    let limits = read_to_string("/proc/self/limits").ok()?;
    least_limit(&limits, rayon::current_num_threads() as u64 * PER_THREAD)
}

/// The least limit in the text of the file `limits` of a process, of address space less `reserved` bytes.
fn least_limit(limits: &str, reserved: u64) -> Option<u64> {
    let left = |&(limit, reserved): &(&str, u64)| {
        let rest = limits.lines().find_map(|line| line.strip_prefix(limit))?;
        // the limit in force stands before the highest one that the process may set
        let most: u64 = rest.split_whitespace().next()?.parse().ok()?;
        Some(most.saturating_sub(reserved))
    };
    [("Max address space", reserved), ("Max data size", 0)].iter().filter_map(left).min()
}

/// The memory left to the control group of this process and to those around it, in bytes; none without a limit.
pub(super) fn left_to_group() -> Option<u64> {
    let groups = read_to_string("/proc/self/cgroup").ok()?;
    below_groups(Path::new("/sys/fs/cgroup"), &groups)
}

/// The memory left to control groups, in bytes, from the folder of all groups and the text that names
/// the groups of a process: lines
/// `0::GROUP` of version 2, `NUMBER:CONTROLLERS:GROUP` of version 1.
fn below_groups(folder: &Path, groups: &str) -> Option<u64> {
    let of_line = |line: &str| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, group) = (parts.next()?, parts.next()?);
        let (version, files) = match controllers {
            "" => ("", ["memory.max", "memory.current", "inactive_file "]),
            some if some.split(',').any(|name| name == "memory") => (
                "memory",
                ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "],
            ),
            _ => return None,
        };
        let folder = folder.join(version);
        // in a container the name may be that outside, of which only the last folder exists
        let groups = Path::new(group.trim_start_matches('/')).ancestors();
        groups.filter_map(|group| left_in(&folder.join(group), files)).min()
    };
    groups.lines().filter_map(of_line).min()
}

/// The memory left to one group: its limit less its usage, in which pages of files that can go do not count.
fn left_in(group: &Path, [limit, usage, inactive]: [&str; 3]) -> Option<u64> {
    let number = |file: &str| read_to_string(group.join(file)).ok()?.trim().parse::<u64>().ok();
    let (limit, usage) = (number(limit)?, number(usage)?);
    let stat = read_to_string(group.join("memory.stat")).unwrap_or_default();
    let pages = stat.lines().find_map(|line| line.strip_prefix(inactive)?.parse::<u64>().ok());
    Some(limit.saturating_sub(usage.saturating_sub(pages.unwrap_or(0))))
}

#[cfg(test)]
mod tests {
    use super::{below_groups, least_limit};
    use std::fs;

    #[test]
    fn the_least_limit_of_the_process_counts() {
        let limits = |space: &str, data: &str| {
            format!(
                "Limit                     Soft Limit           Hard Limit           Units\n\
                 Max cpu time              unlimited            unlimited            seconds\n\
                 Max data size             {data}            unlimited            bytes\n\
                 Max address space         {space}            4096            bytes\n"
            )
        };
        let least = |space: &str, data: &str| least_limit(&limits(space, data), 1024);
        assert_eq!(least("unlimited", "unlimited"), None);
        assert_eq!(least("10240", "unlimited"), Some(9216));
        assert_eq!(least("10240", "5120"), Some(5120));
        assert_eq!(least("512", "unlimited"), Some(0));
        assert_eq!(least_limit("", 0), None);
    }

    #[test]
    fn the_least_limit_of_the_groups_counts() {
        let root = std::env::temp_dir().join(format!("unilateral-groups-{}", std::process::id()));
        let group = |path: &str, files: &[(&str, &str)]| {
            fs::create_dir_all(root.join(path)).unwrap();
            for (name, text) in files {
                fs::write(root.join(path).join(name), text).unwrap();
            }
        };
        group("job", &[("memory.max", "5000\n"), ("memory.current", "1200\n")]);
        group("job", &[("memory.stat", "anon 1000\ninactive_file 200\n")]);
        group("job/step", &[("memory.max", "max\n"), ("memory.current", "600\n")]);
        group("memory", &[("memory.limit_in_bytes", "3000"), ("memory.usage_in_bytes", "2500")]);
        group("memory", &[("memory.stat", "inactive_file 1\ntotal_inactive_file 100\n")]);
        let left = |groups: &str| below_groups(&root, groups);
        assert_eq!(left("0::/job/step\n"), Some(4000));
        assert_eq!(left("0::/job\n"), Some(4000));
        assert_eq!(left("0::/\n"), None);
        // a group of version 1 that is not found inside a container
        assert_eq!(left("7:cpu:/x\n9:hugetlb,memory:/docker/abc\n0::/job\n"), Some(600));
        assert_eq!(left("9:memoryless:/job\n"), None);
        assert_eq!(left("no group\n"), None);
        fs::remove_dir_all(&root).unwrap();
    }
}

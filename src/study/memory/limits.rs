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

/// The limits on address space and data less what threads reserve, in bytes; none without such limits. The files of the
/// system lie below `root`.
pub(super) fn limit_of_process(root: &Path) -> Option<u64> {
    let limits = read_to_string(root.join("proc/self/limits")).ok()?;
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

/// The memory left to the control group of this process and to those around it, in bytes; none without a limit. The
/// files of the system lie below `root`.
pub(super) fn left_to_group(root: &Path) -> Option<u64> {
    let groups = read_to_string(root.join("proc/self/cgroup")).ok()?;
    below_groups(&root.join("sys/fs/cgroup"), &groups)
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

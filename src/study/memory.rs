//! How much memory the process has needed so far.

/// The largest resident set of this process so far, where the system tells: on Linux the peak the
/// kernel keeps (`VmHWM`), elsewhere nothing.
pub fn peak_memory_bytes() -> Option<u64> {
    if !cfg!(target_os = "linux") {
        return None;
    }
    peak_of_status(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// The peak in the text of a status file, which gives it in units of 1024 bytes and calls them kB.
fn peak_of_status(status: &str) -> Option<u64> {
    let value = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = value.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::peak_of_status;

    #[test]
    fn the_peak_is_read_and_nothing_is_made_up() {
        let status = "VmPeak:\t  999 kB\nVmHWM:\t   2048 kB\nVmRSS:\t 12 kB\n";
        assert_eq!(peak_of_status(status), Some(2048 * 1024));
        assert_eq!(peak_of_status("VmRSS:\t 12 kB\n"), None);
        assert_eq!(peak_of_status("VmHWM:\t many kB\n"), None);
    }
}

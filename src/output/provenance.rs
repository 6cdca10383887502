//! Time and machine of a report.

use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

/// Time and machine of a report, as far as the system reports them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Provenance {
    /// When the study began: the system's clock, in universal time.
    pub date: Option<String>,
    /// The processor's name, on Linux.
    pub processor: Option<String>,
    /// Rounds asked for.
    pub rounds: usize,
    /// Whether all rounds are complete; false in the report of an interrupted study.
    pub complete: bool,
}

impl Provenance {
    /// The present time and this machine, with no rounds complete.
    pub fn now(rounds: usize) -> Self {
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).ok().map(|d| d.as_secs());
        let processor = std::fs::read_to_string("/proc/cpuinfo").ok();
        Provenance {
            date: seconds.map(date_of),
            processor: processor.as_deref().and_then(processor_of),
            rounds,
            complete: false,
        }
    }
}

/// The first processor's name in the text the kernel gives.
fn processor_of(text: &str) -> Option<String> {
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Date and time of day of a number of seconds after the beginning of 1970.
fn date_of(seconds: u64) -> String {
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    // years begin in March here, so that the day that comes and goes is their last
    let day = days + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    let year = 400 * era + year + next;
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::{date_of, processor_of};

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date_of(0), "1970-01-01T00:00:00Z");
        assert_eq!(date_of(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(date_of(1_000_000_000), "2001-09-09T01:46:40Z");
        assert_eq!(date_of(1_709_251_199), "2024-02-29T23:59:59Z");
        assert_eq!(date_of(4_107_542_400), "2100-03-01T00:00:00Z");
    }

    #[test]
    fn the_processor_is_read_and_not_made_up() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nmodel name\t: Other\n";
        assert_eq!(processor_of(text).as_deref(), Some("Some CPU @ 2 GHz"));
        assert_eq!(processor_of("processor\t: 0\n"), None);
    }
}

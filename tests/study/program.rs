//! What a report says of the program and the machine that made it.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use unilateral::study::Program;

fn program() -> Program {
    Program::new("compare", "f64", 2, 1)
}

#[test]
fn dates_are_those_of_the_calendar() {
    let date = |seconds: u64| program().begun_at(UNIX_EPOCH + Duration::from_secs(seconds)).date;
    for (seconds, expected) in [
        (0, "1970-01-01T00:00:00Z"),
        (951_782_400, "2000-02-29T00:00:00Z"),
        (1_000_000_000, "2001-09-09T01:46:40Z"),
        (1_709_251_199, "2024-02-29T23:59:59Z"),
        (4_107_542_400, "2100-03-01T00:00:00Z"),
    ] {
        assert_eq!(date(seconds).as_deref(), Some(expected));
    }
    assert_eq!(program().begun_at(UNIX_EPOCH - Duration::from_secs(1)).date, None);
}

#[test]
fn a_program_begins_when_it_is_described() {
    let at = |time: SystemTime| program().begun_at(time).date;
    let before = at(SystemTime::now());
    let now = program().date;
    assert!(before <= now && now <= at(SystemTime::now()), "{now:?}");
    assert!(now.is_some());
}

/// The name that the kernel gives to its first processor, or none: on some machines it gives none.
#[test]
fn the_processor_is_read_and_not_made_up() {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let mut lines = text.lines().map(words);
    let named = lines.find(|words| words.starts_with(&["model".into(), "name".into()]));
    let name = named.map(|words| words[3..].join(" "));
    let found = program().processor;
    assert_eq!(found.as_deref().map(|name| words(name).join(" ")), name);
    assert!(found.is_none_or(|name| name.trim() == name));
}

//! What a report says of the program and the machine that made it.

use unilateral::study::Program;

/// The name that the kernel gives to its first processor, or none: on some machines it gives none.
#[test]
fn the_processor_is_read_and_not_made_up() {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let mut lines = text.lines().map(words);
    let named = lines.find(|words| words.starts_with(&["model".into(), "name".into()]));
    let name = named.map(|words| words[3..].join(" "));
    let found = Program::new("compare", "f64", 2, 1).processor;
    assert_eq!(found.as_deref().map(|name| words(name).join(" ")), name);
    assert!(found.is_none_or(|name| name.trim() == name));
}

//! The pages of help: groups of options, two examples, and the height of a screen.

use super::run::{command, stdout};

const HEIGHT: usize = 50;
const WIDTH: usize = 100;

/// A command of several rounds has a name of its own.
#[test]
fn work_precision_is_compare_with_rounds() {
    let page = |name: &str| stdout(&command(name).arg("--help").output().unwrap());
    assert_eq!(page("work-precision"), page("compare"));
}

#[test]
fn pages_of_help_fit_a_screen_and_have_groups_and_examples() {
    for (name, groups) in [
        ("compare", &["Problem:", "Schemes:", "Meshes:", "Solver:", "Output:"][..]),
        ("stability", &["Problem:", "Schemes:", "Meshes:", "Solver:", "Output:"]),
        ("pictures", &["Problem:", "Schemes:", "Meshes:", "Solver:", "Output:"]),
        ("judge", &["Problem:", "Output:"]),
    ] {
        let page = |option: &str| stdout(&command(name).arg(option).output().unwrap());
        let text = page("--help");
        assert_eq!(text, page("-h"), "{name} has one page of help");
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines.len() <= HEIGHT, "{name}: {} lines\n{text}", lines.len());
        assert!(lines.iter().all(|line| line.chars().count() <= WIDTH), "{name}\n{text}");
        let heads = lines.iter().filter(|line| line.ends_with(':') && !line.starts_with(' '));
        let heads: Vec<&str> = heads.copied().collect();
        let own = [groups, &["Options:", "Examples:"]].concat();
        // help and version stand alone
        assert!(heads.len() == own.len() && own.iter().all(|h| heads.contains(h)), "{heads:?}");
        let start = format!("  unilateral {name} ");
        let examples: Vec<&&str> = lines.iter().filter(|line| line.starts_with(&start)).collect();
        assert_eq!(examples.len(), 2, "{text}");
        // no example has an option that there is not
        for word in examples.iter().flat_map(|line| line.split(' ')) {
            let is_known = || lines.iter().any(|line| line.trim_start().starts_with(word));
            assert!(!word.starts_with("--") || is_known(), "{word}: {text}");
        }
    }
}

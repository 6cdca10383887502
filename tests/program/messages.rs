//! What is said of a problem is said once, of its file and of its groups.

use super::run::{Scratch, data, read_json, refused, rows, stderr, stdout};
use super::square::Square;
use unilateral::input::{excerpt, excerpts};

#[test]
fn an_obstacle_above_a_dirichlet_value_is_said_once_with_the_group() {
    let scratch = Scratch::new("above-wall");
    let path = data("obstacle_above_wall");
    let output = scratch.run(&format!("{path} --scheme p1,cr --levels 2,4"));
    assert_eq!(output.status.code(), Some(1));
    let printed = stdout(&output);
    let lines = printed.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    let once = "the lower obstacle, 0.1, exceeds the Dirichlet value on `left`, 0";
    assert_eq!(lines.matches(once).count(), 1, "{printed}");
    assert!(lines.contains("p1, cr at 2, 4: infeasible: "), "{printed}");
    assert!(!printed.contains("active-set/\n"), "{printed}");
    let markdown = scratch.read("out/report.md");
    assert_eq!(markdown.matches("exceeds the Dirichlet value on").count(), 1, "{markdown}");
    // a message to the user of a file names the file
    let scratch = Scratch::new("named-file");
    refused(&scratch, &[&path, "--levels", "0"], &[&format!("error: {path}: level = 0")]);
}

/// Names of files, groups and options that turn the direction of text are shown with escapes.
#[test]
fn text_in_messages_is_not_turned() {
    let scratch = Scratch::new("turned");
    let turned = |text: &str| text.chars().any(|c| "\u{202e}\u{2066}\u{200f}".contains(c));
    let mesh = Square::sound().replace("contact", "a\u{2066}b");
    let mesh = scratch.file("c\u{200f}d.msh", &mesh.replace("1 1 2 1 1 1 2", "1 1 2 2 1 1 2"));
    let wrong = scratch.file("e\u{202e}f.toml", "name = 3\nbox = [[0], [1]]\n");
    for (options, expected) in [
        (vec!["a\u{202e}b.toml"], "a\\u{202e}b.toml"),
        (vec![&wrong[..]], "e\\u{202e}f.toml:1:8: `name` must be"),
        (vec!["--scene", "radial-2d", "--mesh", &mesh], "boundary group a\\u{2066}b"),
        (vec!["--scene", "radial-2d", "--mesh", &mesh], "c\\u{200f}d.msh"),
        (vec!["--scene", "r\u{202e}"], "r\\u{202e}"),
        (vec!["--repeat", "r\u{202e}"], "r\\u{202e}"),
        (vec!["--r\u{202e}"], "r\\u{202e}"),
    ] {
        refused(&scratch, &options, &[expected]);
        let message = stderr(&scratch.run_split(&options));
        assert!(!turned(&message), "{message}");
    }
}

/// A name of any length and with control characters is cut and shown with escapes, in tables, in files and in their
/// names.
#[test]
fn names_of_problems_are_cut() {
    let scratch = Scratch::new("long-name");
    let rest = std::fs::read_to_string(data("obstacle_above_wall")).unwrap();
    let rest = rest.replace("default = 0.1", "default = -0.1");
    for name in ["x".repeat(100_000), "red\\u001b[31m\\nline".to_owned()] {
        let path = scratch.file("own.toml", &format!("name = \"{name}\"\n{rest}"));
        let output = scratch.run(&format!("{path} --scheme p1 --levels 2,4"));
        assert_eq!(output.status.code(), Some(0));
        let printed = stdout(&output);
        assert!(!printed.chars().any(|c| c.is_control() && c != '\n'), "{printed:?}");
        assert!(printed.lines().all(|line| line.chars().count() < 150), "{printed}");
        let report = read_json(&scratch.0.join("out/report.json"));
        let scene = rows(&report)[0]["scene"].as_str().unwrap();
        assert!(scene.chars().count() <= 81 && !scene.chars().any(char::is_control), "{scene}");
        let fields = std::fs::read_dir(scratch.0.join("out")).unwrap();
        let is_field = |path: &std::path::Path| path.extension().is_some_and(|e| e == "vtu");
        assert_eq!(fields.filter(|file| is_field(&file.as_ref().unwrap().path())).count(), 1);
    }
}

#[test]
fn foreign_text_is_short_and_printable() {
    assert_eq!(excerpt("contact"), "contact");
    assert_eq!(excerpt("a\u{1b}[31m\nb\u{85}"), "a\\u{1b}[31m\\nb\\u{85}");
    assert_eq!(excerpt(b"\xffend"), "\u{fffd}end");
    // what turns the direction of text could make a name look like another; letters stay
    assert_eq!(excerpt("a\u{202e}b.toml"), "a\\u{202e}b.toml");
    let turning = ('\u{202a}'..='\u{202e}').chain('\u{2066}'..='\u{2069}');
    for c in turning.chain(['\u{200e}', '\u{200f}', '\u{61c}']) {
        assert_eq!(excerpt(c.to_string()), c.escape_unicode().to_string());
    }
    assert_eq!(excerpt("שלום, سلام"), "שלום, سلام");
    for c in ["x", "é", "漢", "🦀"] {
        assert_eq!(excerpt(c.repeat(40)), c.repeat(40));
        assert_eq!(excerpt(c.repeat(41)), c.repeat(40) + "…");
        assert_eq!(excerpt(c.repeat(100_000)), c.repeat(40) + "…");
    }
    assert_eq!(excerpts(["b", "a", "b"]), "a, b");
    let many: Vec<String> = (100..200).map(|k| format!("{k}{}", "x".repeat(1000))).collect();
    let shown = excerpts(&many);
    assert!(
        shown.starts_with("100xx")
            && shown.ends_with("…, 119xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx… and 80 more"),
        "{shown}"
    );
}

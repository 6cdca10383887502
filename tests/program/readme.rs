//! What README.md shows is what the program prints and what Cargo.toml says.

use super::run::default_request;

fn read(name: &str) -> String {
    let path = format!("{}/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

/// The words of a line without the dots before best entries: which time is the best is chance.
fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().filter(|word| *word != "\u{2022}").collect()
}

/// Whether two words are one: orders to a hundredth, errors to three digits, all others letter by letter.
fn agree(ours: &str, theirs: &str) -> bool {
    let number = |word: &str| word.trim_matches(['(', ')', '*']).parse::<f64>().ok();
    match (number(ours), number(theirs)) {
        (Some(a), Some(b)) if ours.starts_with('(') => (a - b).abs() < 0.011,
        (Some(a), Some(b)) if ours.contains('.') => (a - b).abs() < 6e-3 * a.abs().max(b.abs()),
        _ => ours == theirs,
    }
}

#[test]
fn the_table_is_the_one_that_the_first_command_prints() {
    let readme = read("README.md");
    let shown = readme.split("```text\n").nth(1).unwrap().split("```").next().unwrap();
    let (printed, _) = default_request();
    let lines: Vec<&str> = printed.lines().collect();
    let shown: Vec<&str> = shown.lines().collect();
    assert!(shown.len() > 8 && lines.len() >= shown.len(), "{printed}");
    for (shown, printed) in shown.iter().zip(&lines) {
        let (shown_words, mut printed_words) = (words(shown), words(printed));
        assert_eq!(shown_words.len(), printed_words.len(), "{shown}\n{printed}");
        if let [.., seconds, "converged"] = &mut printed_words[..] {
            // times are those of the machine
            *seconds = shown_words[shown_words.len() - 2];
        }
        let pairs = shown_words.iter().zip(&printed_words);
        assert!(pairs.clone().all(|(a, b)| agree(a, b)), "{shown}\n{printed}");
    }
}

#[test]
fn the_features_are_those_of_the_manifest() {
    let (readme, manifest) = (read("README.md"), read("Cargo.toml"));
    let features = manifest.split("[features]\n").nth(1).unwrap().split("\n[").next().unwrap();
    let entry =
        |line: &str| line.split_once(" = ").map(|(name, of)| (name.to_owned(), of.to_owned()));
    let mut names: Vec<(String, String)> =
        features.lines().filter(|line| !line.starts_with('#')).filter_map(entry).collect();
    let default = names.iter().position(|(name, _)| name == "default").unwrap();
    let (_, default) = names.remove(default);
    let table = readme.split("| feature |").nth(1).unwrap().split("\n\n").next().unwrap();
    let rows: Vec<Vec<&str>> =
        table.lines().skip(2).map(|line| line.split('|').map(str::trim).collect()).collect();
    let mut shown: Vec<&str> = rows.iter().map(|row| row[1].trim_matches('`')).collect();
    for row in &rows {
        let is_default = default.contains(&row[1].replace('`', "\""));
        assert_eq!(row[3] == "yes", is_default, "{row:?}");
    }
    let mut names: Vec<&str> = names.iter().map(|(name, _)| &name[..]).collect();
    names.sort_unstable();
    shown.sort_unstable();
    assert_eq!(shown, names);
}

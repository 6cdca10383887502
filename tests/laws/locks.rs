//! No lock is held while a value is computed: `parallel::once` alone fills a cell that threads share.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// A thread that waits for its own parallel work takes other tasks. Under `OnceLock::get_or_init` or `LazyLock` it
/// holds a lock meanwhile, and waits for itself if such a task asks for the same cell.
#[test]
fn cells_that_threads_share_are_filled_by_one_function() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&source, &mut files);
    let code = |path: &PathBuf| {
        let text = fs::read_to_string(path).unwrap();
        let lines = text.lines().map(|line| line.split("//").next().unwrap_or("").to_owned());
        lines.collect::<Vec<_>>().join("\n")
    };
    let texts: Vec<(PathBuf, String)> =
        files.into_iter().map(|path| (path.clone(), code(&path))).collect();
    // the fields and arguments that are such cells, whatever file uses them
    let mut names = BTreeSet::new();
    for (_, text) in &texts {
        let before = text.split("OnceLock<").map(|part| part.trim_end_matches(['&', ' ']));
        let named = before.filter_map(|part| part.strip_suffix(':'));
        names.extend(named.filter_map(|part| part.split_whitespace().last().map(str::to_owned)));
    }
    assert!(names.len() > 5, "{names:?}: the test looks in the wrong place");
    let mut wrong = Vec::new();
    for (path, text) in texts.iter().filter(|(path, _)| *path != source.join("parallel/mod.rs")) {
        let fills = |name: &String| {
            ["get_or_init", "get_or_try_init"]
                .iter()
                .any(|fill| text.contains(&format!("{name}.{fill}(")))
        };
        if text.contains("LazyLock") || names.iter().any(fills) {
            wrong.push(path);
        }
    }
    assert!(wrong.is_empty(), "these files fill cells while they hold them: {wrong:?}");
}

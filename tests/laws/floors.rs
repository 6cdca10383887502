//! The plan of the crate as docs/house.md states it, held against every import.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The floor of each room, from the first table of docs/house.md.
fn floors() -> BTreeMap<String, usize> {
    let page = fs::read_to_string(Path::new(ROOT).join("docs/house.md")).unwrap();
    let cells = |line: &str| line.split('|').map(|c| c.trim().to_owned()).collect::<Vec<_>>();
    page.lines()
        .map(cells)
        .filter_map(|row| {
            let floor = row.get(1)?.parse().ok()?;
            Some((row[2].trim_matches('`').to_owned(), floor))
        })
        .collect()
}

/// The source files of the library, with the path of their module.
fn modules() -> Vec<(PathBuf, Vec<String>)> {
    let source = Path::new(ROOT).join("src");
    let mut found = Vec::new();
    let mut folders = vec![source.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && path != source.join("bin") {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let inside = path.strip_prefix(&source).unwrap().with_extension("");
                let mut module: Vec<String> =
                    inside.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
                if module.last().is_some_and(|last| last == "mod") {
                    module.pop();
                }
                if module != ["lib"] {
                    found.push((path, module));
                }
            }
        }
    }
    found.sort();
    found
}

/// The text of a file without comments.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or(""));
    lines.collect::<Vec<_>>().join("\n")
}

/// The paths that a `use` declaration or an expression names, as lists of segments: `a::{b, c::d}`
/// is `a::b` and `a::c::d`.
fn expand(tree: &str, prefix: &[String], out: &mut Vec<Vec<String>>) {
    let segments = |text: &str| {
        let parts = text.split("::").map(|s| s.split_whitespace().next().unwrap_or("").to_owned());
        parts.filter(|s| !s.is_empty()).collect::<Vec<_>>()
    };
    let Some((head, rest)) = tree.split_once('{') else {
        out.push([prefix, &segments(tree)].concat());
        return;
    };
    let prefix = [prefix, &segments(head)].concat();
    let inner = &rest[..rest.rfind('}').unwrap_or(rest.len())];
    let (mut depth, mut start) = (0, 0);
    for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !inner[start..at].trim().is_empty() {
                    expand(inner[start..at].trim(), &prefix, out);
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}

/// A path that a file names.
struct Named {
    /// From the root of the crate.
    path: Vec<String>,
    /// Whether the file only passes the item on, by `pub use`.
    passed_on: bool,
}

/// All paths within the crate that a file names.
fn named(code: &str, module: &[String]) -> Vec<Named> {
    let mut found = Vec::new();
    let children: Vec<&str> = code
        .lines()
        .filter_map(|line| line.trim().strip_suffix(';')?.rsplit_once("mod ").map(|(_, m)| m))
        .collect();
    let resolve = |path: Vec<String>| -> Option<Vec<String>> {
        let up = path.iter().take_while(|s| *s == "super").count();
        match path.first()?.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "super" if up <= module.len() => {
                Some([&module[..module.len() - up], &path[up..]].concat())
            }
            "self" => Some([module, &path[1..]].concat()),
            first if children.contains(&first) => Some([module, &path[..]].concat()),
            _ => None,
        }
    };
    let mut expressions = String::new();
    for declaration in code.split(';') {
        let lines: Vec<&str> = declaration.lines().collect();
        let is_use = |line: &&str| {
            let line = line.trim_start();
            line.starts_with("use ") || line.starts_with("pub") && line.contains(" use ")
        };
        let first = lines.iter().rposition(is_use);
        expressions.extend(lines[..first.unwrap_or(lines.len())].iter().flat_map(|l| [l, "\n"]));
        let Some(first) = first else { continue };
        let passed_on = lines[first].trim_start().starts_with("pub");
        let tree = lines[first..].join(" ");
        let Some((_, tree)) = tree.split_once("use ") else { continue };
        let mut paths = Vec::new();
        expand(tree, &[], &mut paths);
        let paths = paths.into_iter().filter_map(resolve);
        found.extend(paths.map(|path| Named { path, passed_on }));
    }
    // paths within expressions and types: from the root, or through a module declared here
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let roots = ["crate", "super", "self"].into_iter().chain(children.iter().copied());
    for root in roots {
        for (at, _) in expressions.match_indices(&format!("{root}::")) {
            let before = expressions[..at].chars().next_back();
            if before.is_some_and(is_path) {
                continue;
            }
            let text = expressions[at..].split(|c| !is_path(c)).next().unwrap_or("");
            let mut paths = Vec::new();
            expand(text.trim_end_matches(':'), &[], &mut paths);
            found.extend(
                paths.into_iter().filter_map(resolve).map(|path| Named { path, passed_on: false }),
            );
        }
    }
    found
}

#[test]
fn every_room_stands_on_a_floor() {
    let stated: BTreeSet<String> = floors().into_keys().collect();
    let present: BTreeSet<String> = modules().into_iter().map(|(_, m)| m[0].clone()).collect();
    assert_eq!(stated, present, "rooms of docs/house.md, and rooms of src");
}

/// Cargo would compile the library a second time for tests in `src`, which the manifest does not even run.
#[test]
fn the_library_has_no_unit_tests() {
    for (path, _) in modules() {
        let code = code(&path);
        assert!(!code.contains("cfg(test)") && !code.contains("#[test]"), "{}", path.display());
    }
}

#[test]
fn rooms_import_from_lower_floors_only() {
    let floors = floors();
    let mut wrong = BTreeSet::new();
    let mut imports = 0;
    for (path, module) in modules() {
        let room = &module[0];
        for Named { path: named, .. } in named(&code(&path), &module) {
            let Some(other) = named.first().filter(|other| *other != room) else { continue };
            imports += 1;
            let Some(floor) = floors.get(other) else { continue };
            if *floor >= floors[room] {
                wrong.insert(format!("{}: {}", path.display(), named.join("::")));
            }
        }
    }
    assert!(imports > 500, "only {imports} imports were read");
    assert!(wrong.is_empty(), "imports from the same or a higher floor:\n{wrong:#?}");
}

/// The circles of files that stand, each with its reason. No other file is in a circle.
const CIRCLES: [(&[&str], &str); 1] = [(
    &["assemble/owned_rows", "assemble/owned_rows/lifted"],
    "the rows of a cell, and what lifted forms add to them",
)];

/// The file that defines what a path names, if it is another one: an item that a module only passes
/// on is that of the file it comes from.
fn target(
    path: &[String],
    files: &BTreeMap<Vec<String>, (PathBuf, String)>,
) -> Option<Vec<String>> {
    let mut path = path.to_vec();
    for _ in 0..8 {
        let end = (1..=path.len()).rev().find(|&n| files.contains_key(&path[..n]))?;
        let (module, rest) = path.split_at(end);
        let (_, code) = &files[module];
        let next = rest.first().and_then(|item| {
            let passed = named(code, module).into_iter().filter(|n| n.passed_on);
            passed.map(|n| n.path).find(|p| p.last() == Some(item))
        });
        match next {
            Some(source) if source[..] != path[..] => path = source,
            _ => return Some(module.to_vec()),
        }
    }
    None
}

#[test]
fn files_import_without_circles() {
    let files: BTreeMap<Vec<String>, (PathBuf, String)> = modules()
        .into_iter()
        .filter(|(_, m)| m[0] != "prelude" && m[0] != "docs")
        .map(|(path, module)| (module, (path.clone(), code(&path))))
        .collect();
    let uses = |module: &Vec<String>| -> BTreeSet<Vec<String>> {
        let (_, code) = &files[module];
        let all = named(code, module).into_iter().filter(|n| !n.passed_on);
        all.filter_map(|n| target(&n.path, &files)).filter(|other| other != module).collect()
    };
    let mut remaining: BTreeMap<Vec<String>, BTreeSet<Vec<String>>> =
        files.keys().map(|module| (module.clone(), uses(module))).collect();
    // files that import nothing that remains are in no circle, nor are those nothing imports
    loop {
        let before = remaining.len();
        let present: BTreeSet<Vec<String>> = remaining.keys().cloned().collect();
        remaining.retain(|_, uses| uses.iter().any(|u| present.contains(u)));
        let used: BTreeSet<Vec<String>> = remaining.values().flatten().cloned().collect();
        remaining.retain(|module, _| used.contains(module));
        if remaining.len() == before {
            break;
        }
    }
    let found: BTreeSet<String> = remaining.keys().map(|module| module.join("/")).collect();
    let stated = CIRCLES.iter().flat_map(|(files, _)| files.iter().map(|f| (*f).to_owned()));
    assert_eq!(found, stated.collect(), "files in circles of imports: {remaining:#?}");
}

#[test]
fn folders_are_small() {
    let mut sizes: BTreeMap<PathBuf, usize> = BTreeMap::new();
    for (path, _) in modules() {
        *sizes.entry(path.parent().unwrap().to_owned()).or_default() += 1;
    }
    // the catalogue of scenes has a file for each formula
    sizes.remove(&Path::new(ROOT).join("src/scenes"));
    let large: Vec<_> = sizes.iter().filter(|(_, n)| **n > 15).collect();
    assert!(large.is_empty(), "folders with more than 15 files: {large:?}");
}

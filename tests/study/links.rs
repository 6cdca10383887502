//! Links, pictures and sizes of the pages of the repository, links of the built documentation.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

const LABELS: &str = "src/docs/labels.md";

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("cannot read {}: {e}", path.display()))
}

/// Files of a folder and of the folders in it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let of = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    entries.flat_map(|entry| of(entry.unwrap().path())).collect()
}

/// All pages: those of the folder `docs` with results, README and CHANGELOG.
fn pages() -> Vec<PathBuf> {
    let docs = files(&root().join("docs")).into_iter();
    let pages = docs.filter(|path| path.extension().is_some_and(|end| end == "md"));
    pages.chain(["README.md", "CHANGELOG.md"].map(|name| root().join(name))).collect()
}

/// The pages that the documentation of the crate includes.
fn included() -> Vec<PathBuf> {
    let is_included =
        |path: &PathBuf| path.parent() == Some(&root().join("docs")) || path.ends_with("README.md");
    pages().into_iter().filter(is_included).collect()
}

/// The path without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                plain.pop();
            }
            other => plain.push(other),
        }
    }
    plain
}

fn is_elsewhere(target: &str) -> bool {
    ["https://", "http://", "mailto:"].iter().any(|start| target.starts_with(start))
}

/// Lines of a page outside code blocks.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut in_code = false;
    text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        !in_code && !is_fence
    })
}

/// Definitions `[label]: target` of a page.
fn definitions(text: &str) -> BTreeMap<String, String> {
    let definition = |line: &str| {
        let (label, target) = line.strip_prefix('[')?.split_once("]: ")?;
        Some((label.to_lowercase(), target.trim().to_owned()))
    };
    prose(text).filter_map(definition).collect()
}

/// Targets of `[text](target)` and of definitions.
fn targets(text: &str) -> Vec<String> {
    let mut found: Vec<String> = definitions(text).into_values().collect();
    for line in prose(text) {
        let words: String = line.split('`').step_by(2).collect();
        let parts = words.split("](").skip(1);
        found.extend(parts.filter_map(|rest| Some(rest.split_once(')')?.0.to_owned())));
    }
    found
}

/// The anchor that a heading gets: lower case, hyphens for spaces, no punctuation.
fn anchor(heading: &str) -> String {
    let keep = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    heading.trim().to_lowercase().chars().filter(keep).collect::<String>().replace(' ', "-")
}

fn has_heading(page: &str, wanted: &str) -> bool {
    prose(page)
        .filter(|line| line.starts_with('#'))
        .any(|line| anchor(line.trim_start_matches('#')) == wanted)
}

#[test]
fn pages_of_the_repository_have_no_dead_link() {
    let mut dead = Vec::new();
    for path in pages() {
        let text = read(&path);
        for target in targets(&text).iter().filter(|target| !is_elsewhere(target)) {
            let (file, heading) = target.split_once('#').unwrap_or((target, ""));
            let file =
                if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            let lives = file.exists() && (heading.is_empty() || has_heading(&read(&file), heading));
            if !lives {
                dead.push(format!("{}: {target}", path.display()));
            }
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}

/// The documentation of the crate replaces the files that labels name by modules: a label without a line in the file of
/// labels, and a link without a label, would be dead there.
#[test]
fn labels_of_pages_are_modules_of_the_documentation() {
    let labels = definitions(&read(&root().join(LABELS)));
    for path in included() {
        let text = read(&path);
        let own = definitions(&text);
        for (label, file) in own.iter().filter(|(_, file)| !is_elsewhere(file)) {
            let name = Path::new(file).file_name().unwrap().to_str().unwrap();
            assert_eq!(name.trim_end_matches(".md"), label, "{}: [{label}]", path.display());
            assert!(labels.contains_key(label), "{LABELS} has no [{label}] of {}", path.display());
        }
        for target in targets(&text) {
            let has_label = own.values().any(|file| *file == target);
            let is_here = target.starts_with('#');
            assert!(has_label || is_here || is_elsewhere(&target), "{}: {target}", path.display());
        }
    }
}

#[test]
fn files_of_the_documentation_are_small_and_shown() {
    let mut lines = 0;
    let mut shown = BTreeSet::new();
    let included = included();
    for path in pages() {
        let text = read(&path);
        lines += if included.contains(&path) { text.lines().count() } else { 0 };
        let folder = path.parent().unwrap();
        shown.extend(targets(&text).iter().map(|target| normal(&folder.join(target))));
    }
    shown.extend(included);
    assert!(lines <= 1650, "README and docs have {lines} lines: 150 and 1500 are enough");
    for file in files(&root().join("docs")) {
        let bytes = fs::metadata(&file).unwrap().len();
        assert!(bytes <= 60_000, "{}: {bytes} bytes", file.display());
        // the folder of results is linked as a whole, which shows its pages
        let is_page = file.extension().is_some_and(|end| end == "md");
        let is_shown = shown.contains(&file) || is_page && shown.contains(file.parent().unwrap());
        assert!(is_shown, "no page shows {}", file.display());
    }
}

/// What a page of HTML points to, and the anchors it has.
struct Html {
    links: Vec<String>,
    anchors: BTreeSet<String>,
}

fn attributes<'a>(html: &'a str, name: &'a str) -> impl Iterator<Item = String> + 'a {
    html.match_indices(name).filter_map(move |(start, _)| {
        // an attribute follows a space and stands in quotes, or bare as in the pages of the source
        let before = html[..start].chars().next_back()?;
        let value = html[start + name.len()..].strip_prefix('=')?;
        let value = match value.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"')?.0,
            None => value.split_whitespace().next()?,
        };
        before.is_whitespace().then(|| value.replace("&amp;", "&").replace("&#38;", "&"))
    })
}

/// The text without scripts, whose strings are no attributes.
fn without_scripts(html: &str) -> String {
    html.split("<script")
        .enumerate()
        .map(|(k, part)| match (k, part.split_once('>'), part.split_once("</script>")) {
            (0, ..) => part.to_owned(),
            (_, Some((tag, _)), Some((_, rest))) => format!("<script{tag}>{rest}"),
            _ => String::new(),
        })
        .collect()
}

/// The tags of a page, one a line: code that a page shows has quoted attributes too, which are none.
fn tags(html: &str) -> String {
    let tags = html.split('<').skip(1).map(|rest| rest.split('>').next().unwrap_or_default());
    tags.collect::<Vec<_>>().join("\n")
}

fn parse(html: &str) -> Html {
    let html = tags(&without_scripts(html));
    Html {
        links: attributes(&html, "href").chain(attributes(&html, "src")).collect(),
        anchors: attributes(&html, "id").collect(),
    }
}

fn html_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            html_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "html") {
            found.push(path);
        }
    }
}

/// Whether a page has the anchor. Pages of the source have one for each line; a range of lines is
/// marked by their script.
fn has_anchor(page: &Html, wanted: &str) -> bool {
    let first_line = wanted.split('-').next().unwrap_or_default();
    let is_lines = wanted.chars().all(|c| c.is_ascii_digit() || c == '-');
    page.anchors.contains(wanted) || is_lines && page.anchors.contains(first_line)
}

/// The documentation, in the target directory of this test, so that a `cargo doc` just before is used.
fn build_documentation() -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("a target directory");
    let status = Command::new(env!("CARGO"))
        .args(["doc", "--no-deps", "--lib", "--target-dir"])
        .arg(target)
        .current_dir(root())
        .status()
        .expect("cargo runs");
    assert!(status.success(), "cargo doc failed");
    target.join("doc")
}

#[test]
#[ignore = "builds the documentation: cargo test -- --ignored built_documentation"]
fn built_documentation_has_no_dead_link() {
    let doc = build_documentation();
    let mut files = Vec::new();
    html_files(&doc.join("unilateral"), &mut files);
    html_files(&doc.join("src/unilateral"), &mut files);
    let pages: BTreeMap<PathBuf, Html> =
        files.into_iter().map(|file| (file.clone(), parse(&read(&file)))).collect();
    let mut dead = BTreeSet::new();
    let mut checked = 0;
    for (file, page) in &pages {
        for link in &page.links {
            if is_elsewhere(link) || link.starts_with("data:") || link.starts_with("javascript:") {
                continue;
            }
            checked += 1;
            let (target, wanted) = link.split_once('#').unwrap_or((link, ""));
            let target = target.split('?').next().unwrap_or_default();
            let path = if target.is_empty() {
                file.clone()
            } else {
                normal(&file.parent().unwrap().join(target))
            };
            // no reader follows it: the script with implementors in other crates, which rustdoc writes
            // only for traits that have implementors in this one
            if path.starts_with(doc.join("trait.impl")) {
                continue;
            }
            let lives = path.starts_with(&doc) && path.is_file();
            let anchored =
                wanted.is_empty() || pages.get(&path).is_none_or(|page| has_anchor(page, wanted));
            if !(lives && anchored) {
                dead.insert(format!("{}: {link}", file.strip_prefix(&doc).unwrap().display()));
            }
        }
    }
    assert!(checked > 1000, "only {checked} links found: are these the pages of rustdoc?");
    let list: Vec<String> = dead.into_iter().collect();
    assert!(list.is_empty(), "{} dead links:\n{}", list.len(), list.join("\n"));
}

//! Links, pictures and sizes of the pages of the repository, programs of the gallery, links of the built documentation.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::process::Command;

/// Pages of the repository. Orders and stability are tables that the program writes.
const PAGES: [&str; 15] = [
    "README.md",
    "CHANGELOG.md",
    "docs/adaptive.md",
    "docs/assembly.md",
    "docs/bound.md",
    "docs/choosing.md",
    "docs/conventions.md",
    "docs/gallery.md",
    "docs/house.md",
    "docs/orders.md",
    "docs/own_problems.md",
    "docs/pictures.md",
    "docs/reproduce.md",
    "docs/solvers.md",
    "docs/stability.md",
];
const LABELS: &str = "src/guide/links.md";
const PICTURES: &str = "src/guide/pictures.md";

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("cannot read {}: {e}", path.display()))
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
    for page in PAGES {
        let path = root().join(page);
        let text = read(&path);
        for target in targets(&text).iter().filter(|target| !is_elsewhere(target)) {
            let (file, heading) = target.split_once('#').unwrap_or((target, ""));
            let file =
                if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            let lives = file.exists() && (heading.is_empty() || has_heading(&read(&file), heading));
            if !lives {
                dead.push(format!("{page}: {target}"));
            }
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
}

#[test]
fn labels_of_chapters_are_items_of_the_crate() {
    let mut items = definitions(&read(&root().join(LABELS)));
    items.extend(definitions(&read(&root().join(PICTURES))));
    for page in PAGES {
        for (label, target) in definitions(&read(&root().join(page))) {
            assert!(
                is_elsewhere(&target) || items.contains_key(&label),
                "{page} defines [{label}], but neither {LABELS} nor {PICTURES} does"
            );
        }
    }
}

/// A drawing as the target of a link in angle brackets, in text that compresses as well as the file.
fn inline(svg: &str) -> String {
    let mut text = String::from("<data:image/svg+xml,");
    for c in svg.chars().filter(|c| *c != '\n') {
        match c {
            '"' => text.push('\''),
            '%' | '#' | '<' | '>' | '\\' => text += &format!("%{:02X}", u32::from(c)),
            c => text.push(c),
        }
    }
    text + ">"
}

/// The definitions of all pictures of the pages, each with its text.
fn embedded_pictures() -> String {
    let mut lines = BTreeSet::new();
    for page in PAGES {
        let path = root().join(page);
        for (label, target) in definitions(&read(&path)) {
            let file = path.parent().unwrap().join(&target);
            if target.ends_with(".svg") {
                lines.insert(format!("[{label}]: {}\n", inline(&read(&file))));
            }
        }
    }
    lines.into_iter().collect::<String>() + "\n"
}

/// With the variable UNILATERAL_WRITE_PICTURES in the environment the file is written first.
#[test]
fn pictures_of_the_guide_are_those_of_the_pages() {
    if std::env::var_os("UNILATERAL_WRITE_PICTURES").is_some() {
        fs::write(root().join(PICTURES), embedded_pictures()).unwrap();
    }
    assert!(
        read(&root().join(PICTURES)) == embedded_pictures(),
        "{PICTURES} is not up to date: UNILATERAL_WRITE_PICTURES=1 cargo test --test study links"
    );
}

/// Files of a folder and of the folders in it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let of = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    entries.flat_map(|entry| of(entry.unwrap().path())).collect()
}

#[test]
fn files_of_the_documentation_are_small_and_shown() {
    let shown: BTreeSet<PathBuf> = PAGES
        .iter()
        .flat_map(|page| {
            let path = root().join(page);
            let targets = targets(&read(&path));
            targets.into_iter().map(move |target| normal(&path.parent().unwrap().join(target)))
        })
        .chain(PAGES.iter().map(|page| root().join(page)))
        .collect();
    for file in files(&root().join("docs")) {
        let bytes = fs::metadata(&file).unwrap().len();
        assert!(bytes <= 60_000, "{}: {bytes} bytes", file.display());
        assert!(shown.contains(&file), "no page shows {}", file.display());
    }
}

/// The sections of the gallery and their programs.
const PROGRAMS: [(&str, &str); 6] = [
    ("A mesh of one's own", "one_problem.rs"),
    ("A scheme", "my_scheme.rs"),
    ("An element and a constraint set", "my_element.rs"),
    ("A study against a reference", "against_a_reference.rs"),
    ("Out to SciPy and back", "solve_elsewhere.py"),
    ("The contact force", "contact_force.rs"),
];

#[test]
fn lines_of_the_gallery_are_lines_of_the_examples() {
    let page = read(&root().join("docs/gallery.md"));
    for (heading, program) in PROGRAMS {
        let text = read(&root().join("examples").join(program));
        let mut rest = text.lines();
        let section = page.split(&format!("\n## {heading}\n")).nth(1).expect(heading);
        let section = section.split("\n## ").next().unwrap_or_default();
        let mut shown = 0;
        for block in section.split("\n```").skip(1).step_by(2) {
            let Some(code) = block.strip_prefix("rust,ignore\n").or(block.strip_prefix("python\n"))
            else {
                continue;
            };
            for line in code.lines().filter(|line| !line.trim().is_empty()) {
                let found = rest.any(|of_file| of_file.trim() == line.trim());
                assert!(found, "{program} has no such line, or not in this place: {line}");
                shown += 1;
            }
        }
        assert!(shown >= 5, "{heading}: {shown} lines");
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

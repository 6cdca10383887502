//! The program `compare` as its users and their scripts meet it: wrong requests, right requests.
//!
//! `cargo test` builds the program first. `cargo test --test program` does not: it runs whatever
//! `cargo build --example compare` left.

#[path = "rows/keys.rs"]
mod keys;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use keys::ROW_KEYS;
use serde_json::Value;
use unilateral::prelude::*;
use unilateral::problem::Datum;
use unilateral::scenes::{BoxDomain, Regularity, Scene};
use unilateral::study::Row;

/// The example, which cargo builds next to the tests.
fn program() -> PathBuf {
    let test = std::env::current_exe().expect("a running test has a path");
    let target = test.parent().and_then(Path::parent).expect("tests lie in a folder of target");
    let name = format!("compare{}", std::env::consts::EXE_SUFFIX);
    let program = target.join("examples").join(name);
    assert!(program.exists(), "{program:?} is missing: `cargo build --example compare` makes it");
    program
}

/// A directory of its own for a test, gone when the test is over.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let name = format!("unilateral-program-{}-{name}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Scratch(path)
    }
    /// A file with this text, and its path.
    fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    }
    fn path(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }
    /// Runs the program with a report in `out`, unless the options say where.
    fn run(&self, options: &str) -> Output {
        self.run_split(&options.split_whitespace().collect::<Vec<_>>())
    }
    fn run_split(&self, options: &[&str]) -> Output {
        let mut command = Command::new(program());
        if !options.contains(&"--out") {
            command.args(["--out", &self.path("out")]);
        }
        command.args(options).output().unwrap()
    }
    /// The report of a run that succeeded.
    fn report(&self, options: &str) -> Value {
        let output = self.run(options);
        assert_eq!(output.status.code(), Some(0), "{options}: {}", stderr(&output));
        read_json(&self.0.join("out/report.json"))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn read_json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn rows(report: &Value) -> &[Value] {
    report["rows"].as_array().unwrap()
}

/// What every wrong request must get: exit 2, one line that says `expected`, and no report.
fn refused(scratch: &Scratch, options: &[&str], expected: &[&str]) {
    let output = scratch.run_split(options);
    let (out, message) = (stdout(&output), stderr(&output));
    assert_eq!(output.status.code(), Some(2), "{options:?}: {message}");
    assert_eq!(out, "", "{options:?}");
    assert!(message.starts_with("error: "), "{options:?}: {message}");
    assert!(message.ends_with('\n') && message.lines().count() == 1, "{options:?}: {message}");
    assert!(!message.contains("panicked"), "{options:?}: {message}");
    for part in expected {
        assert!(message.contains(part), "{options:?}: no {part:?} in {message}");
    }
    assert!(!scratch.0.join("out").exists(), "{options:?} left a report");
}

#[test]
fn wrong_options_are_refused() {
    let scratch = Scratch::new("options");
    let schemes = "there are: p1";
    let (penalty, at_least) = ("must be positive and finite", "must be at least 1");
    let (whole, number) = ("expected a whole number", "expected a number");
    let cases: &[(&str, &[&str])] = &[
        ("--scene nowhere", &["unknown scene \"nowhere\"", "radial-2d", "signorini-2d", "all"]),
        ("--scene radial-2d,", &["unknown scene \"\"", "radial-2d"]),
        ("--scheme p7", &["unknown scheme \"p7\"", schemes, "wopsip"]),
        ("--scheme all,p7", &["unknown scheme \"p7\"", schemes]),
        ("--solver magic", &["unknown solver \"magic\"", "active-set"]),
        ("--linear magic", &["unknown linear solver \"magic\"", "direct"]),
        ("--constraint edges", &["edges", "vertices", "facet-means"]),
        ("--precision f16", &["f16", "f64", "f32"]),
        ("--levels 0", &["level = 0", "at least one"]),
        ("--levels 4,0", &["level = 0", "at least one"]),
        ("--levels 1000000000", &["level = 1000000000", "cells", "at most"]),
        ("--levels 99999999999999999999", &["99999999999999999999", whole]),
        ("--levels -4", &["'-4'", "--levels", whole]),
        ("--levels four", &["'four'", "--levels", whole]),
        ("--levels 4.5", &["'4.5'", whole]),
        ("--levels 4,,8", &["''", "--levels", whole]),
        ("--levels=", &["''", "--levels", whole]),
        ("--levels", &["--levels", "value is required"]),
        ("--repeat 0", &["--repeat 0", at_least]),
        ("--repeat -1", &["'-1'", whole]),
        ("--threads 0", &["--threads 0", at_least]),
        ("--threads 100000", &["--threads 100000", "at most"]),
        ("--sigma 0", &["--sigma 0", penalty]),
        ("--sigma -1", &["--sigma -1", penalty]),
        ("--sigma NaN", &["--sigma NaN", penalty]),
        ("--sigma inf", &["--sigma inf", penalty]),
        ("--sigma much", &["'much'", "--sigma", number]),
        ("--sigma 4 --sigma 5", &["--sigma", "multiple times"]),
        ("--eta 0", &["--eta 0", penalty]),
        ("--eta -1", &["--eta -1", penalty]),
        ("--eta NaN", &["--eta NaN", penalty]),
        ("--eta inf", &["--eta inf", penalty]),
        ("--eta much", &["'much'", "--eta", number]),
        ("--scale 0", &["scale = 0", "positive and finite"]),
        ("--scale NaN", &["scale = NaN", "positive and finite"]),
        ("--scale -1", &["scale = -1", "positive and finite"]),
        ("--scale 1e300", &["scale = 1e300", "1e100"]),
        ("--scale 2 --scene ball-2d", &["--scale 2", "none of the scenes chosen", "radial-2d"]),
        ("--scale 1e-30 --precision f32", &["precision = f32", "radial-2d", "scale"]),
        ("--contrast 3 --scene ball-2d", &["--contrast 3", "none of the scenes chosen"]),
        ("--load 3 --scene ball-2d", &["--load 3", "none of the scenes chosen"]),
        ("--levles 4", &["--levles", "--levels"]),
        ("--nonsense", &["--nonsense", "there are: --list, --scene", "--quiet"]),
        ("radial-2d", &["radial-2d", "there are: --list, --scene"]),
    ];
    for (options, expected) in cases {
        let options: Vec<&str> = options.split(' ').collect();
        refused(&scratch, &options, expected);
    }
}

/// Names of schemes may be promised before they exist; whether one does, the list tells.
#[test]
fn schemes_that_do_not_exist_yet_are_refused_with_the_list() {
    let scratch = Scratch::new("planned");
    let listed = stdout(&scratch.run("--list"));
    let exists = |name: &str| {
        listed.lines().any(|l| l.starts_with("  ") && l.split_whitespace().next() == Some(name))
    };
    for name in ["p2", "nipg", "iipg", "ldg", "br2", "sipg-p2", "ldg-p2", "P1", "p1 "] {
        if !exists(name) {
            let unknown = format!("unknown scheme \"{name}\"");
            refused(&scratch, &["--scheme", name], &[&unknown, "there are: p1", "sipg"]);
        }
    }
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let scratch = Scratch::new("places");
    let file = scratch.file("file", "");
    let below = scratch.path("file/report");
    refused(&scratch, &["--out", &file], &["cannot write", &file]);
    refused(&scratch, &["--out", &below], &["cannot write", &below]);
    refused(&scratch, &["--json", &below], &["cannot write", &below]);
    let directory = scratch.0.display().to_string();
    refused(&scratch, &["--json", &directory], &["cannot write", &directory]);
    assert!(std::fs::read(file).unwrap().is_empty());
}

#[test]
fn more_than_the_memory_is_refused() {
    let Some(memory) = unilateral::study::available_memory_bytes() else { return };
    let needed = 250e9;
    if memory as f64 > needed {
        return;
    }
    let scratch = Scratch::new("memory");
    let options = ["--scheme", "sipg", "--scene", "ball-2d", "--levels", "8,7000"];
    refused(&scratch, &options, &["ball-2d", "sipg", "level 7000", "GB of memory", "lower level"]);
}

/// A unit square of four triangles around its centre, in MSH 2.2, to be spoiled.
struct Square {
    names: Vec<&'static str>,
    nodes: Vec<&'static str>,
    elements: Vec<&'static str>,
}

impl Square {
    fn new() -> Self {
        Self {
            names: vec!["1 1 \"dirichlet\"", "1 2 \"contact\"", "1 3 \"neumann\""],
            nodes: vec!["1 0 0 0", "2 1 0 0", "3 1 1 0", "4 0 1 0", "5 0.5 0.5 0"],
            elements: vec![
                "1 1 2 1 1 1 2",
                "2 1 2 1 1 2 3",
                "3 1 2 1 1 3 4",
                "4 1 2 1 1 4 1",
                "5 2 2 9 1 1 2 5",
                "6 2 2 9 1 2 3 5",
                "7 2 2 9 1 3 4 5",
                "8 2 2 9 1 4 1 5",
            ],
        }
    }
    fn with(spoil: impl FnOnce(&mut Self)) -> String {
        let mut square = Self::new();
        spoil(&mut square);
        let section = |name: &str, lines: &[&str]| {
            format!("${name}\n{}\n{}\n$End{name}\n", lines.len(), lines.join("\n"))
        };
        ["$MeshFormat\n2.2 0 8\n$EndMeshFormat\n".to_owned()]
            .into_iter()
            .chain((!square.names.is_empty()).then(|| section("PhysicalNames", &square.names)))
            .chain([section("Nodes", &square.nodes), section("Elements", &square.elements)])
            .collect()
    }
    fn sound() -> String {
        Self::with(|_| {})
    }
    /// The same with its lower side in contact.
    fn in_contact() -> String {
        Self::with(|s| s.elements[0] = "1 1 2 2 1 1 2")
    }
}

#[test]
fn wrong_meshes_are_refused() {
    let scratch = Scratch::new("meshes");
    let sound = Square::sound();
    let without_groups = Square::with(|s| {
        s.names.clear();
        s.elements = vec!["1 1 0 1 2", "5 2 0 1 2 5", "6 2 0 2 3 5", "7 2 0 3 4 5", "8 2 0 4 1 5"];
    });
    let all_neumann = Square::with(|s| {
        s.elements[..4].copy_from_slice(&[
            "1 1 2 3 1 1 2",
            "2 1 2 3 1 2 3",
            "3 1 2 3 1 3 4",
            "4 1 2 3 1 4 1",
        ]);
    });
    let cases: &[(&str, &str, String, &[&str])] = &[
        ("radial-2d", "empty", String::new(), &["not a Gmsh mesh"]),
        ("radial-2d", "prose", "Dear reader,\n".into(), &["not a Gmsh mesh", "$MeshFormat"]),
        ("radial-2d", "half", sound[..sound.len() / 2].into(), &["the file ends", "line"]),
        ("radial-2d", "three-quarters", sound[..sound.len() * 3 / 4].into(), &["the file ends"]),
        ("radial-2d", "groups", without_groups, &["physical group", "dirichlet"]),
        (
            "radial-2d",
            "wall",
            Square::with(|s| s.names[0] = "1 1 \"wall\""),
            &["\"wall\"", "dirichlet, neumann and contact"],
        ),
        ("radial-2d", "words", Square::with(|s| s.nodes[0] = "1 zero 0 0"), &["`zero`", "line 1"]),
        ("radial-2d", "nan", Square::with(|s| s.nodes[0] = "1 nan 0 0"), &["NaN", "finite"]),
        (
            "radial-2d",
            "flat",
            Square::with(|s| s.nodes[4] = "5 0.5 0 0"),
            &["degenerate", "element 5"],
        ),
        (
            "radial-2d",
            "twice",
            Square::with(|s| s.elements.push("9 2 2 9 1 5 1 2")),
            &["same vertices", "element 9"],
        ),
        (
            "radial-2d",
            "untagged",
            Square::with(|s| s.elements.retain(|e| !e.starts_with("1 "))),
            &["no boundary part", "dirichlet, neumann, contact"],
        ),
        (
            "radial-2d",
            "both",
            Square::with(|s| s.elements.push("9 1 2 3 1 1 2")),
            &["two boundary parts", "dirichlet and neumann"],
        ),
        (
            "radial-2d",
            "range",
            Square::with(|s| s.elements[7] = "8 2 2 9 1 4 1 6"),
            &["element 8", "node 6"],
        ),
        ("radial-2d", "floating", all_neumann, &["neither a dirichlet nor a contact", "4 cells"]),
        ("radial-2d", "touching", Square::in_contact(), &["radial-2d", "\"contact\""]),
        ("signorini-2d", "free", sound.clone(), &["signorini-2d", "\"contact\""]),
        ("radial-3d", "plane", sound.clone(), &["dimension 2", "radial-3d", "--list"]),
        ("nowhere", "fine", sound.clone(), &["unknown scene \"nowhere\"", "radial-2d"]),
    ];
    for (scene, name, mesh, expected) in cases {
        let path = scratch.file(&format!("{name}.msh"), mesh);
        refused(&scratch, &["--scene", scene, "--mesh", &path], expected);
        let names_file = expected[0].contains("dimension") || expected[0].contains("unknown");
        if !names_file {
            refused(&scratch, &["--scene", scene, "--mesh", &path], &[&format!("{name}.msh")]);
        }
    }
    let missing = scratch.path("missing.msh");
    refused(&scratch, &["--mesh", &missing], &["cannot read", "missing.msh"]);
    let directory = scratch.0.display().to_string();
    refused(&scratch, &["--mesh", &directory], &["cannot read", &directory]);
    let path = scratch.file("sound.msh", &sound);
    refused(
        &scratch,
        &["--scene", "radial-2d", "--mesh", &path, "--levels", "40"],
        &["level = 40"],
    );
}

/// A scene on the unit square with these data, held on its sides.
fn scene(problem: Problem<2>) -> Scene<2> {
    Scene {
        name: "mine".into(),
        summary: "",
        domain: BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0))
            .side(
                1,
                0,
                if problem.gap.is_some() { BoundaryPart::Contact } else { BoundaryPart::Neumann },
            )
            .into(),
        problem,
        regularity: Regularity { sobolev: 2.0, strictly_complementary: true },
    }
}

fn study(problem: Problem<2>) -> Result<Report, Error> {
    Study::<f64, 2>::new(scene(problem))
        .scheme(ConformingP1)
        .scheme(Sipg::default())
        .levels([4])
        .run()
}

/// A datum that is bad right of the middle only.
fn partly(bad: f64) -> impl Fn(&Point<f64, 2>) -> f64 + Send + Sync + Copy + 'static {
    move |x| if x[0] > 0.5 { bad } else { 1.0 }
}

#[test]
fn data_that_are_not_finite_are_named_with_the_point() {
    let problem = || Problem::new().constant_source(1.0);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let value = partly(bad);
        for (name, problem) in [
            ("source", Problem::new().source(value)),
            ("source", Problem::new().constant_source(bad)),
            ("dirichlet", problem().dirichlet(value)),
            ("neumann", problem().neumann(move |x, _| value(x))),
            ("obstacle", problem().obstacle_below(value)),
            ("obstacle", problem().obstacle_above(value)),
            ("gap", problem().signorini(value)),
            ("reaction", problem().reaction(Datum::Function(Box::new(value)))),
            ("reaction", problem().reaction(bad)),
        ] {
            match study(problem) {
                Err(Error::DataNotFinite { datum, value, at, .. }) => {
                    assert_eq!(datum, name);
                    assert!(!value.is_finite());
                    assert!(at.starts_with('(') && at.contains(", "), "{at}");
                }
                Err(other) => panic!("{name} {bad}: {other}"),
                Ok(_) => panic!("{name} {bad} went unnoticed"),
            }
        }
    }
}

#[test]
fn coefficients_must_be_positive_and_obstacles_leave_room() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = study(Problem::new().coefficient(partly(bad)));
        assert!(matches!(found, Err(Error::CoefficientNotPositive { .. })), "{bad}");
    }
    let crossed = Problem::new().obstacle_below(|_| 0.5).obstacle_above(|x| 1.0 - x[0]);
    let Err(Error::EmptyConstraint { lower, upper, .. }) = study(crossed) else {
        panic!("crossed obstacles went unnoticed")
    };
    assert!(lower > upper);
    let over_datum = Problem::new().obstacle_below(|_| 0.5);
    assert!(matches!(study(over_datum), Err(Error::EmptyConstraint { .. })));
}

/// Obstacles that touch the Dirichlet datum leave room, whatever rounding makes of them.
#[test]
fn obstacles_may_touch_the_datum() {
    fn touching<T: Real>() -> Result<Report, Error> {
        let value = |x: &Point<f64, 2>| 0.1 + (x[0] * 7.0).sin();
        let again = |x: &Point<f64, 2>| ((x[0] * 7.0).sin() - 1.0) + 1.1;
        let problem = Problem::new().dirichlet(value).obstacle_below(again);
        Study::<T, 2>::new(scene(problem)).scheme(ConformingP1).levels([6]).run()
    }
    for report in [touching::<f64>(), touching::<f32>()] {
        assert!(report.unwrap().rows.iter().all(Row::converged));
    }
}

/// Keys of inner objects, and which of their values may be null in a row that converged.
const INNER_KEYS: [(&str, &[&str], bool); 7] = [
    ("parameters", &["sigma", "eta", "rule"], true),
    ("error", &["l2", "h1", "energy", "max"], true),
    ("order", &["l2", "h1", "energy", "max"], true),
    ("expected_order", &["l2", "h1"], true),
    ("iterations", &["outer", "linear", "levels"], false),
    ("certificate", &["feasibility", "multiplier", "complementarity", "residual"], false),
    ("seconds", &["mesh", "assemble", "solve", "total"], false),
];

/// Every key is there, with a value of its type.
fn check_row(row: &Value) {
    for key in ROW_KEYS {
        let value = &row[key];
        let fits = match key {
            "scene" | "scheme" | "constraint" | "status" => value.is_string(),
            "dimension" | "level" | "cells" | "unknowns" | "nonzeros" | "active" => value.is_u64(),
            "peak_memory_bytes" => value.is_u64() || value.is_null(),
            "mesh_size" => value.is_f64(),
            "objective" => value.is_number() || value.is_null(),
            _ => value.is_object(),
        };
        assert!(row.get(key).is_some() && fits, "{key}: {value}");
    }
    let converged = row["status"] == "converged";
    for (outer, keys, may_be_null) in INNER_KEYS {
        for key in keys {
            let value = row[outer].get(key).unwrap_or_else(|| panic!("no {outer}.{key}"));
            let null = value.is_null() && (may_be_null || !converged);
            let fits = if *key == "rule" { value.is_string() } else { value.is_number() };
            assert!(null || fits, "{outer}.{key}: {value}");
        }
    }
    assert!(row["certificate"].get("algebraic_bound").is_some());
}

#[test]
fn the_report_has_every_key_and_file() {
    let scratch = Scratch::new("report");
    let output = scratch.run("--levels 4,8");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "", "progress where there is no terminal");
    let tables = stdout(&output);
    assert!(tables.contains("radial-2d") && tables.contains("signorini-2d"), "{tables}");
    assert!(tables.contains("seconds") && tables.contains(&scratch.path("out")), "{tables}");

    let report = read_json(&scratch.0.join("out/report.json"));
    for key in ["name", "version", "threads", "precision", "repeat", "target_cpu"] {
        assert!(report["program"].get(key).is_some_and(|v| !v.is_null()), "program.{key}");
    }
    assert_eq!(rows(&report).len(), 2 * 3 * 2);
    rows(&report).iter().for_each(check_row);

    let csv = std::fs::read_to_string(scratch.0.join("out/report.csv")).unwrap();
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let inner = |outer| INNER_KEYS.iter().find(|(name, ..)| *name == outer);
    for key in ROW_KEYS {
        match inner(key) {
            None => assert!(header.contains(&key), "{key}"),
            Some((_, keys, _)) => keys.iter().for_each(|k| {
                assert!(header.contains(&&*format!("{key}.{k}")), "{key}.{k}");
            }),
        }
    }
    assert_eq!(csv.lines().count(), 1 + rows(&report).len());

    let mut files = vec!["report.json".to_owned(), "report.csv".to_owned()];
    for plot in ["convergence", "work_precision"] {
        files.extend(["svg", "png"].map(|ending| format!("{plot}.{ending}")));
    }
    for scene in ["radial-2d", "signorini-2d"] {
        files.extend(["p1", "sipg", "wopsip"].map(|scheme| format!("{scene}-{scheme}.vtu")));
    }
    let mut found: Vec<String> = std::fs::read_dir(scratch.0.join("out"))
        .unwrap()
        .map(|f| f.unwrap().file_name().into_string().unwrap())
        .collect();
    files.sort();
    found.sort();
    assert_eq!(found, files);
}

#[test]
fn the_list_names_everything() {
    let scratch = Scratch::new("list");
    let output = scratch.run("--list");
    assert_eq!(output.status.code(), Some(0));
    let list = stdout(&output);
    let fixed = ["p1", "cr", "sipg", "wopsip", "vertices", "facet-means", "active-set", "direct"];
    let catalogue = scenes::catalogue();
    let names = catalogue.iter().map(|s| &s.name[..]).chain(fixed);
    for name in names {
        let line = list.lines().find(|l| l.split_whitespace().next() == Some(name));
        let line = line.unwrap_or_else(|| panic!("no {name} in {list}"));
        assert!(line.split_whitespace().count() > 2, "{name} is not explained");
    }
    assert!(!scratch.0.join("out").exists());
}

#[test]
fn output_goes_where_it_is_asked_to() {
    let scratch = Scratch::new("output");
    let small = "--scene radial-1d --scheme p1 --levels 4";

    let output = scratch.run(&format!("{small} --json -"));
    let printed: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(rows(&printed).len(), 1);
    assert!(stderr(&output).contains("radial-1d"), "tables go to standard error");

    let copy = scratch.path("copy.json");
    let output = scratch.run(&format!("{small} --quiet --json {copy}"));
    assert_eq!((stdout(&output), stderr(&output)), (String::new(), String::new()));
    assert_eq!(read_json(Path::new(&copy)), read_json(&scratch.0.join("out/report.json")));

    let output = scratch.run(&format!("{small} --quiet --json -"));
    assert_eq!(stderr(&output), "");
    assert!(serde_json::from_str::<Value>(&stdout(&output)).is_ok());
}

#[test]
fn options_show_in_the_report() {
    let scratch = Scratch::new("parameters");
    let broken = "--scene radial-2d --scheme sipg,wopsip --levels 4 --quiet";

    let report =
        scratch.report(&format!("{broken} --sigma 20 --eta 3 --precision f32 --threads 1"));
    assert_eq!(report["program"]["precision"], "f32");
    assert_eq!(report["program"]["threads"], 1);
    assert_eq!(rows(&report)[0]["parameters"]["sigma"], 20.0);
    assert_eq!(rows(&report)[1]["parameters"]["eta"], 3.0);

    let report = scratch.report(&format!("{broken} --constraint facet-means --repeat 2"));
    assert_eq!(report["program"]["repeat"], 2);
    assert!(rows(&report).iter().all(|row| row["constraint"] == "facet-means"));

    // Names and levels that are repeated are run once.
    let report = scratch.report("--scene radial-1d,radial-1d --scheme p1,p1 --levels 4,4 --quiet");
    assert_eq!(rows(&report).len(), 1);
}

/// Removes what may differ from run to run.
fn without_times(mut report: Value) -> Value {
    report["program"]["threads"] = Value::Null;
    for row in report["rows"].as_array_mut().unwrap() {
        row["seconds"] = Value::Null;
        row["peak_memory_bytes"] = Value::Null;
    }
    report
}

#[test]
fn runs_repeat_whatever_the_threads() {
    let scratch = Scratch::new("threads");
    let report = |threads| {
        let options = format!("--scheme all --levels 8,16 --quiet --threads {threads}");
        without_times(scratch.report(&options))
    };
    let first = report(2);
    assert_eq!(first, report(2));
    for (one, two) in rows(&report(1)).iter().zip(rows(&first)) {
        assert_eq!(one["active"], two["active"]);
        for key in ["l2", "h1", "energy", "max"] {
            let (a, b) = (one["error"][key].as_f64().unwrap(), two["error"][key].as_f64().unwrap());
            assert!((a - b).abs() <= 1e-9 * b, "{key}: {a} and {b}");
        }
    }
}

#[test]
fn every_scene_runs_with_every_scheme() {
    let scratch = Scratch::new("all");
    let report = scratch.report("--scene all --scheme all --levels 4 --quiet");
    let schemes = unilateral::study::SCHEMES.len();
    assert_eq!(rows(&report).len(), scenes::catalogue().len() * schemes);
    for dimension in 1..=3 {
        assert!(rows(&report).iter().any(|row| row["dimension"] == dimension));
    }
    rows(&report).iter().for_each(check_row);
}

#[test]
fn meshes_of_gmsh_are_refined_and_choose_their_scenes() {
    let scratch = Scratch::new("refined");
    let sound = scratch.file("sound.msh", &Square::sound());
    let touching = scratch.file("touching.msh", &Square::in_contact());

    let report = scratch.report(&format!("--scene radial-2d --mesh {sound} --levels 0,1 --quiet"));
    let cells: Vec<&Value> = rows(&report).iter().map(|row| &row["cells"]).collect();
    assert_eq!(cells, [4, 16, 4, 16, 4, 16]);

    // Without a name, and for all, the scenes are those the mesh fits.
    for (mesh, signorini) in [(&sound, false), (&touching, true)] {
        let report = scratch.report(&format!("--mesh {mesh} --levels 0 --scheme p1 --quiet"));
        let names: Vec<&str> = rows(&report).iter().map(|r| r["scene"].as_str().unwrap()).collect();
        assert_eq!(names.contains(&"radial-2d"), !signorini, "{names:?}");
        assert_eq!(names.contains(&"signorini-2d"), signorini, "{names:?}");
    }
}

#[test]
fn a_row_that_does_not_converge_is_told_and_the_others_are_complete() {
    let scratch = Scratch::new("stubborn");
    let output = scratch.run("--scene radial-2d --scheme sipg,p1 --sigma 1 --levels 4,8");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let tables = stdout(&output);
    assert!(tables.contains("not-coercive") && tables.contains("warning, sipg"), "{tables}");
    let report = read_json(&scratch.0.join("out/report.json"));
    rows(&report).iter().for_each(check_row);
    let (bad, good) = rows(&report).split_at(2);
    for row in bad {
        assert_eq!(row["status"], "not-coercive");
        assert!(row["objective"].is_null());
        for (outer, key) in [("error", "l2"), ("order", "l2"), ("certificate", "residual")] {
            assert!(row[outer][key].is_null(), "{outer}.{key}");
        }
        assert_eq!(row["parameters"]["sigma"], 1.0);
        assert!(!row["warnings"].as_array().unwrap().is_empty());
    }
    for row in good {
        assert_eq!(row["status"], "converged");
        assert!(row["error"]["l2"].is_f64());
    }
    assert!(good[1]["order"]["l2"].is_f64());
}

/// As in `compare --list | head -1`: nobody reads on.
#[test]
fn a_closed_pipe_is_no_error() {
    let scratch = Scratch::new("pipe");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = Command::new(program())
        .args(["--list", "--out", &scratch.path("out")])
        .stdout(writer)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
}

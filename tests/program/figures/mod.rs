//! The figures of many rows, held against `tests/data/figures.csv`: what a change moves without meaning to is seen.
//!
//! The file sees changes, not errors: what is right is asserted elsewhere. `UNILATERAL_WRITE_FIGURES=1 cargo test --test
//! program -- --ignored all_figures` writes it anew. On the machine that its first line names every figure is the same to
//! the last bit; on others figures differ as [`columns`] says.

mod columns;
mod file;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use super::rows::check_row;
use super::run::{Scratch, read_json, rows, stderr};
use columns::COLUMNS;
use file::{Figures, machine};

/// A request to `compare`, whose rows stand under its name in the file.
struct Request {
    name: &'static str,
    /// Whether it belongs to the part that every `cargo test` runs.
    is_quick: bool,
    scenes: &'static str,
    schemes: &'static str,
    options: &'static str,
}

/// The schemes on linears, with both placements of bounds where they are offered, but for those of [`LIFTED`].
const LINEAR: &str = "p1,cr,sipg,nipg,iipg,wopsip,sipg:facet-means,nipg:facet-means,iipg:facet-means,wopsip:facet-means";
/// The schemes on quadratics, likewise.
const QUADRATIC: &str = "p2,sipg-p2,nipg-p2,iipg-p2,wopsip-p2,p2:midpoints,sipg-p2:midpoints,nipg-p2:midpoints,\
    iipg-p2:midpoints,wopsip-p2:midpoints";
/// The schemes that lift jumps, and those that share most of their code: a fifth of the scenes tells what changes.
const LIFTED: &str = "ldg,ldg-switch,br2,bmmpr,ldg:facet-means,ldg-switch:facet-means,br2:facet-means,bmmpr:facet-means";
/// The same on quadratics.
const LIFTED_QUADRATIC: &str = "ldg-p2,ldg-switch-p2,br2-p2,bmmpr-p2,ldg-p2:midpoints,ldg-switch-p2:midpoints,\
    br2-p2:midpoints,bmmpr-p2:midpoints";
/// Those with bounds on Bernstein coefficients.
const BERNSTEIN: &str = "p2:bernstein,sipg-p2:bernstein,nipg-p2:bernstein,iipg-p2:bernstein,ldg-p2:bernstein,wopsip-p2:bernstein";
/// Two of every kind, for what does not depend on the scheme.
const FEW: &str = "p1,p2,cr,sipg,wopsip,wopsip:facet-means,nipg";

/// For the forces that other solvers than the active set method report.
const FORCES: &str = "p1,p2,cr,sipg,wopsip:facet-means";

const ON_LINES: &str = "parabola-1d,icelike-1d,oscillating-1d,bilateral-1d,ridge-1d,radial-1d,polynomial-1d,hill-1d,contrast-1d,\
    signorini-reaction-1d,signorini-open-1d,signorini-closed-1d,signorini-grazing-1d";
const OBSTACLES_IN_THE_PLANE: &str = "ridge-2d,radial-2d,radial-quarter-2d,polynomial-2d,hill-2d,ball-2d,disc-2d,\
    biactive-half-2d,biactive-ring-2d,lshape-2d,cone-2d,pyramid-full-2d,degenerate2-2d,degenerate3-2d,degenerate4-2d";
const OTHERS_IN_THE_PLANE: &str = "contrast-2d,contrast-disc-2d,spiral-2d,torsion-2d,pyramid-2d,signorini-harmonic-2d,\
    signorini-2d,signorini-shifted-2d,signorini-irrational-2d,signorini-smooth2-2d,signorini-smooth3-2d,\
    signorini-smooth4-2d,signorini-biactive-2d,signorini-halves-2d,hertz-2d,signorini-two-2d,signorini-layers-2d,\
    signorini-sine-2d";
const OBSTACLES_IN_SPACE: &str = "ridge-3d,radial-3d,polynomial-3d,hill-3d,ball-3d,cone-3d";
const CONTACT_IN_SPACE: &str =
    "signorini-harmonic-3d,signorini-line-3d,signorini-disc2-3d,signorini-disc3-3d,hertz-3d";

/// The scenes of the schemes that lift jumps: an obstacle and a contact problem at least of each dimension, a coefficient
/// that jumps, two obstacles, contact without force, a re-entrant corner.
const OF_LIFTED_ON_LINES: &str = "radial-1d,contrast-1d,signorini-reaction-1d";
const OF_LIFTED_IN_THE_PLANE: &str =
    "radial-2d,lshape-2d,degenerate2-2d,contrast-disc-2d,signorini-2d,torsion-2d";
const OF_LIFTED_IN_SPACE: &str = "radial-3d,signorini-line-3d";

/// The longest first: they run two at a time.
const REQUESTS: &[Request] = &[
    request("linear-plane-obstacles", OBSTACLES_IN_THE_PLANE, LINEAR, "--levels 8,16"),
    request("linear-plane-others", OTHERS_IN_THE_PLANE, LINEAR, "--levels 8,16"),
    request("quadratic-plane-obstacles", OBSTACLES_IN_THE_PLANE, QUADRATIC, "--levels 4,8"),
    request("quadratic-plane-others", OTHERS_IN_THE_PLANE, QUADRATIC, "--levels 4,8"),
    request("linear-space-obstacles", OBSTACLES_IN_SPACE, LINEAR, "--levels 2,4"),
    request("linear-space-contact", CONTACT_IN_SPACE, LINEAR, "--levels 2,4"),
    request("quadratic-space-obstacles", OBSTACLES_IN_SPACE, QUADRATIC, "--levels 1,2"),
    request("quadratic-space-contact", CONTACT_IN_SPACE, QUADRATIC, "--levels 1,2"),
    request("lifted-plane", OF_LIFTED_IN_THE_PLANE, LIFTED, "--levels 8,16"),
    request("lifted-quadratic-plane", OF_LIFTED_IN_THE_PLANE, LIFTED_QUADRATIC, "--levels 4,8"),
    request("lifted-space", OF_LIFTED_IN_SPACE, LIFTED, "--levels 2,4"),
    request("lifted-quadratic-space", OF_LIFTED_IN_SPACE, LIFTED_QUADRATIC, "--levels 1,2"),
    quick("lifted-lines", OF_LIFTED_ON_LINES, LIFTED, "--levels 8,16"),
    quick("lifted-quadratic-lines", OF_LIFTED_ON_LINES, LIFTED_QUADRATIC, "--levels 4,8"),
    quick("linear-lines", ON_LINES, LINEAR, "--levels 8,16"),
    quick("quadratic-lines", ON_LINES, QUADRATIC, "--levels 4,8"),
    quick("bernstein", "radial-1d,radial-2d,lshape-2d,signorini-2d", BERNSTEIN, "--levels 4,8"),
    quick("bernstein-space", "radial-3d,signorini-line-3d", BERNSTEIN, "--levels 2"),
    quick("quick-plane", "radial-2d,hertz-2d,contrast-disc-2d", FEW, "--levels 8"),
    quick("quick-space", "radial-3d,signorini-line-3d", FEW, "--levels 2"),
    quick("single-precision", "radial-2d,signorini-2d", FEW, "--levels 8 --precision f32"),
    quick(
        "weights",
        "polynomial-2d",
        "wopsip@eta=1e3,wopsip@eta=1e10,sipg@sigma=30,br2@lifts=full",
        "--levels 8",
    ),
    quick(
        "iterative-plane",
        "radial-2d,hertz-2d,contrast-disc-2d",
        FEW,
        "--levels 16 --linear iterative",
    ),
    quick("iterative-space", "radial-3d,signorini-line-3d", FEW, "--levels 3 --linear iterative"),
    quick(
        "multigrid",
        "radial-2d,hertz-2d",
        "p1,cr,sipg",
        "--levels 16 --solver monotone-multigrid",
    ),
    quick(
        "interior-point",
        "radial-2d,signorini-2d,hertz-2d",
        FORCES,
        "--levels 8 --solver interior-point",
    ),
    quick("proximal", "radial-2d,signorini-2d,hertz-2d", FORCES, "--levels 8 --solver proximal"),
    quick("adaptive", "lshape-2d,hertz-2d", "p1,p2,sipg,wopsip", "--levels 4 --adaptive steps=3"),
    quick("adaptive-space", "signorini-harmonic-3d", "p1,sipg", "--levels 2 --adaptive steps=2"),
    quick(
        "reference",
        "spiral-2d,signorini-sine-2d",
        "p1,sipg,wopsip",
        "--levels 4,8 --reference 32",
    ),
    quick("mesh-plane", "radial-2d", FEW, "--levels 0,1 --mesh DATA/unstructured_square.msh"),
    quick(
        "mesh-space",
        "signorini-line-3d",
        FEW,
        "--levels 0 --mesh DATA/unstructured_half_cube.msh",
    ),
    quick(
        "mesh-contact",
        "signorini-2d,signorini-harmonic-2d",
        FEW,
        "--levels 0,1 --mesh DATA/unstructured_half_square.msh",
    ),
    quick("mesh-cube", "radial-3d", FEW, "--levels 0 --mesh DATA/unstructured_cube.msh"),
    quick("problem-plate", "EXAMPLES/problems/plate.toml", FEW, "--levels 0,1"),
    quick("problem-membrane", "EXAMPLES/problems/membrane.toml", FEW, "--levels 0,1"),
    quick("problem-gap", "DATA/problems/gap_below_obstacle.toml", FEW, "--levels 4,8"),
    quick("problem-regions", "DATA/problems/region_obstacle.toml", FEW, "--levels 0,1"),
    quick("problem-bounds-alone", "DATA/problems/neu2.toml", FEW, "--levels 8"),
    quick("problem-constant", "DATA/problems/constant_everywhere.toml", FEW, "--levels 8"),
    quick("problem-kelvin", "DATA/problems/kelvin.toml", FEW, "--levels 16"),
    quick("problem-bodies", "DATA/problems/two_bodies.toml", FEW, "--levels 0,1"),
    quick("problem-far", "DATA/problems/far_gap.toml", FEW, "--levels 8"),
    quick("problem-reaction", "DATA/problems/far_reaction.toml", FEW, "--levels 8"),
    quick("problem-bracket", "EXAMPLES/problems/bracket.toml", FEW, "--levels 0,1"),
    quick("friction-lines", "friction-1d,friction-both-1d", LINEAR, "--levels 8,16"),
    quick("friction-plane", "friction-2d", "p1,cr,sipg,nipg,wopsip,p2,sipg-p2", "--levels 8,16"),
    quick("friction-space", "friction-3d", "p1,cr,sipg,wopsip", "--levels 2,4"),
    quick("problem-brake", "EXAMPLES/problems/brake.toml", FEW, "--levels 4,8"),
];

const fn request(
    name: &'static str,
    scenes: &'static str,
    schemes: &'static str,
    options: &'static str,
) -> Request {
    Request { name, is_quick: false, scenes, schemes, options }
}

const fn quick(
    name: &'static str,
    scenes: &'static str,
    schemes: &'static str,
    options: &'static str,
) -> Request {
    Request { is_quick: true, ..request(name, scenes, schemes, options) }
}

impl Request {
    /// The figures of all rows that the program writes, whatever their status.
    fn figures(&self) -> Figures {
        let root = env!("CARGO_MANIFEST_DIR");
        let place = |text: &str| {
            let text = text.replace("DATA", &format!("{root}/tests/data"));
            text.replace("EXAMPLES", &format!("{root}/examples"))
        };
        let problem = match self.scenes.ends_with(".toml") {
            true => place(self.scenes),
            false => format!("--scene {}", self.scenes),
        };
        let scratch = Scratch::new(&format!("figures-{}", self.name));
        let options = place(self.options);
        let fixed = "--quiet --no-fields --threads 1";
        let output = scratch.run(&format!("{problem} --scheme {} {options} {fixed}", self.schemes));
        let file = scratch.0.join("out/report.json");
        assert!(file.exists(), "{}: {}", self.name, stderr(&output));
        let report = read_json(&file);
        rows(&report).iter().for_each(check_row);
        let limit = if options.contains("f32") { 1e-4 } else { 1e-9 };
        Figures::of(self.name, limit, rows(&report))
    }
}

/// The figures of these requests, two at a time, in their order.
fn found(requests: &[&Request]) -> Figures {
    let next = AtomicUsize::new(0);
    let found = Mutex::new(Vec::new());
    let work = || {
        while let Some(request) = requests.get(next.fetch_add(1, Ordering::Relaxed)) {
            let figures = request.figures();
            found.lock().unwrap().push(figures);
        }
    };
    thread::scope(|scope| {
        scope.spawn(work);
        scope.spawn(work);
    });
    let mut all = Figures::default();
    found.into_inner().unwrap().into_iter().for_each(|figures| all.extend(figures));
    all
}

/// Panics with the figures that differ, at most thirty of them.
fn compare(requests: &[&Request]) {
    let (machine_of_file, expected) = Figures::read();
    let names: Vec<&str> = requests.iter().map(|request| request.name).collect();
    let is_same_machine = machine_of_file == machine();
    let differences = found(requests).differences(&expected, &names, is_same_machine);
    let shown: Vec<&str> = differences.iter().take(30).map(String::as_str).collect();
    assert!(
        differences.is_empty(),
        "{} figures are not those of tests/data/figures.csv{}:\n{}",
        differences.len(),
        if is_same_machine { ", which is of this machine" } else { "" },
        shown.join("\n")
    );
}

/// The requests have every scene of the catalogue and every scheme.
#[test]
fn no_scene_and_no_scheme_is_left_out() {
    let scenes: Vec<&str> = REQUESTS.iter().flat_map(|request| request.scenes.split(',')).collect();
    for scene in unilateral::scenes::catalogue() {
        assert!(scenes.contains(&&*scene.name), "{}", scene.name);
    }
    let schemes: Vec<&str> = [LINEAR, QUADRATIC, LIFTED, LIFTED_QUADRATIC]
        .iter()
        .flat_map(|list| list.split(','))
        .collect();
    for &(scheme, _) in unilateral::scheme::SCHEMES {
        assert!(schemes.contains(&scheme), "{scheme}");
    }
}

#[test]
fn quick_figures_are_those_of_the_file() {
    compare(&REQUESTS.iter().filter(|request| request.is_quick).collect::<Vec<_>>());
}

#[test]
#[ignore = "takes minutes"]
fn all_figures_are_those_of_the_file() {
    let all: Vec<&Request> = REQUESTS.iter().collect();
    match std::env::var_os("UNILATERAL_WRITE_FIGURES") {
        Some(_) => found(&all).write(),
        None => compare(&all),
    }
}

/// One digit that is another, one row that is missing and one that is new are seen, each with its row.
#[test]
fn a_figure_that_differs_is_named() {
    let (_, expected) = Figures::read();
    let mut other = expected.clone();
    let energy = COLUMNS.iter().position(|column| column.name == "energy").unwrap();
    let row = other.rows.keys().find(|key| key.contains("radial-1d")).unwrap().clone();
    let figure = &mut other.rows.get_mut(&row).unwrap()[energy];
    let digit = figure.find(|c: char| ('1'..'9').contains(&c)).unwrap();
    let next = char::from(figure.as_bytes()[digit] + 1).to_string();
    figure.replace_range(digit..=digit, &next);
    let all: Vec<&str> = REQUESTS.iter().map(|request| request.name).collect();
    let found = other.differences(&expected, &all, false);
    assert!(
        matches!(&found[..], [one] if one.contains("energy") && one.contains(&row)),
        "{found:?}"
    );
    other = expected.clone();
    other.rows.remove(&row);
    assert!(matches!(&other.differences(&expected, &all, false)[..], [one] if one.contains(&row)));
    assert!(matches!(&expected.differences(&other, &all, false)[..], [one] if one.contains(&row)));
}

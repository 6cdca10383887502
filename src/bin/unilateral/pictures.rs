//! A solution as a picture: the function, the contact set found against the exact free boundary, the
//! jumps across facets and the multiplier, as PNG and SVG.
//!
//! `cargo run --release -- pictures --help` lists the options. Exit codes: 0 if every solve converged,
//! 1 if one did not (its last iterate is drawn, and said to be one), 2 if the request was wrong.

use std::path::PathBuf;

use clap::Args;
use unilateral::nested::{Hierarchy, solve};
use unilateral::paraview::write_pvd;
use unilateral::plot::{Picture, Slice};
use unilateral::scenes::{AnyScene, Scene};
use unilateral::scheme::{AnyScheme, NamedScheme};
use unilateral::study::file_name;

use crate::shared::{Request, print, scene};

/// Draws the solution of a scheme on a scene
#[derive(Args, Debug)]
pub struct Options {
    /// Scene by name
    #[arg(long, default_value = "radial-2d")]
    scene: String,
    /// Scheme as NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]]
    #[arg(long, default_value = "wopsip")]
    scheme: NamedScheme,
    /// Subdivisions of the scene's shortest side; by default 16, in space 8
    #[arg(long, value_name = "N")]
    level: Option<usize>,
    /// In space: the coordinate that the slice fixes, x, y or z
    #[arg(long, value_parser = ["x", "y", "z"], requires = "at")]
    across: Option<String>,
    /// In space: the value of that coordinate
    #[arg(long, value_name = "X", requires = "across", allow_negative_numbers = true)]
    at: Option<f64>,
    /// Also write the fields of these levels as .vtu files and a .pvd file that lists them
    #[arg(long, value_delimiter = ',', value_name = "N[,N...]")]
    series: Vec<usize>,
    /// Where the files go
    #[arg(long, value_name = "DIR", default_value = "target/pictures")]
    out: PathBuf,
}

/// Whether every solve converged.
pub fn run(options: &Options) -> Request<bool> {
    match scene(&options.scene)? {
        AnyScene::One(scene) => draw(options, scene),
        AnyScene::Two(scene) => draw(options, scene),
        AnyScene::Three(scene) => draw(options, scene),
    }
}

fn draw<const D: usize>(options: &Options, mut scene: Scene<D>) -> Request<bool> {
    let scheme = options.scheme.make::<f64, D>();
    if let Some(set) = options.scheme.constraint_set() {
        scene.problem = scene.problem.on(set);
    }
    let scene = &scene;
    let level = options.level.unwrap_or(if D == 3 { 8 } else { 16 });
    let slice = match (&options.across, options.at) {
        (Some(name), Some(at)) => {
            Some(Slice { axis: ["x", "y", "z"].iter().position(|n| n == name).unwrap_or(2), at })
        }
        _ => None,
    };
    let meshes = meshes(scene, level)?;
    let solved = solve(&scene.problem, &meshes, &*scheme).map_err(|e| e.to_string())?;
    let fields = solved
        .fields()
        .ok_or_else(|| format!("level {level}: {}: there is nothing to draw", solved.outcome()))?;
    let converged = solved.converged();
    let label = scheme.label_on(scene.problem.constraint_set());
    let mut title = format!("{}: {label}, level {level}", scene.name);
    if !converged {
        title += &format!(", NOT CONVERGED: {}", solved.outcome());
    }
    let picture = Picture::of(&title, &scene.problem, solved.mesh(), &fields, slice);
    let name = name_of(scene, &*scheme, &format!("-{level}"));
    let written = picture
        .and_then(|picture| picture.write(&options.out, &name))
        .map_err(|e| e.to_string())?;
    for path in written {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(series(options, scene, &*scheme)? && converged)
}

/// Writes the fields of all levels of the series; whether all converged.
fn series<const D: usize>(
    options: &Options,
    scene: &Scene<D>,
    scheme: &dyn AnyScheme<f64, D>,
) -> Request<bool> {
    let mut files = Vec::new();
    let mut converged = true;
    for &level in &options.series {
        let meshes = meshes(scene, level)?;
        let solved = solve(&scene.problem, &meshes, scheme).map_err(|e| e.to_string())?;
        let path = options.out.join(name_of(scene, scheme, &format!("-{level}.vtu")));
        let label = scheme.label_on(scene.problem.constraint_set());
        let written = solved.write_vtu_with(&path, |file| {
            let file = file.text("scene", &scene.name).text("scheme", &label);
            file.number("level", level as f64)
        });
        written.map_err(|e| e.to_string())?;
        converged &= solved.converged();
        files.push((level as f64, path));
    }
    if !files.is_empty() {
        let path = options.out.join(name_of(scene, scheme, ".pvd"));
        write_pvd(&path, &files).map_err(|e| e.to_string())?;
        print(&format!("{}\n", path.display()))?;
    }
    Ok(converged)
}

fn meshes<const D: usize>(scene: &Scene<D>, level: usize) -> Request<Hierarchy<f64, D>> {
    Hierarchy::of_domain(&scene.domain, level).map_err(|e| e.to_string())
}

/// `SCENE-LABEL` with what follows.
fn name_of<const D: usize>(scene: &Scene<D>, scheme: &dyn AnyScheme<f64, D>, end: &str) -> String {
    let label = scheme.label_on(scene.problem.constraint_set());
    file_name(&format!("{}-{label}{end}", scene.name))
}

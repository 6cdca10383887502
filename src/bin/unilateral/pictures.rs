//! A solution as a picture: the function, and the contact set found against the exact free boundary, as SVG.
//!
//! `cargo run --release -- pictures --help` lists the options. Of a solve that did not converge the last iterate is
//! drawn, and said to be one.

use std::cell::RefCell;
use std::path::PathBuf;

use clap::Args;
use unilateral::in_its_dimension;
use unilateral::nested::Adaptivity;
use unilateral::scenes::{AnyScene, Scene};
use unilateral::scheme::NamedScheme;
use unilateral::study::{Row, Study, file_name};

use crate::adaptive::adaptivity;
use crate::asked::{MESHES, OUTPUT, PROBLEM, SCHEMES};
use crate::constants::Constants;
use crate::mesh_file::MeshFile;
use crate::one_run::take_directory;
use crate::shared::{Failure, check_apart, draw_solution, end_at_interrupt, print, scene, warn};

const EXAMPLES: &str = "\
Examples:
  unilateral pictures --scene ball-2d --scheme wopsip:facet-means --level 32
  unilateral pictures plate.toml --adaptive 1e-2 --out plate";

/// Draws the solution of a scheme on a scene, or on a problem of your own
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    /// A problem of your own, as for compare
    #[arg(help_heading = PROBLEM, value_name = "PROBLEM.toml", conflicts_with_all = ["scene", "mesh", "boundary"])]
    problem: Option<PathBuf>,
    #[command(flatten)]
    constants: Constants,
    /// Scene by name
    #[arg(help_heading = PROBLEM, long, value_name = "A", default_value = "radial-2d")]
    scene: String,
    #[command(flatten)]
    mesh: MeshFile,
    /// NAME[:PLACEMENT][@KEY=VALUE[,KEY=VALUE...]]
    #[arg(help_heading = SCHEMES, long, value_name = "A", default_value = "wopsip")]
    scheme: NamedScheme,
    /// On a box: subdivisions of its shortest side, by default 16 or 8;
    /// on a mesh file: refinements, by default none
    #[arg(help_heading = MESHES, verbatim_doc_comment, long, visible_alias = "levels", value_name = "N")]
    level: Option<usize>,
    /// Every mesh of a refinement that follows the error bound, as for
    /// compare, from level N, by default 4
    #[arg(help_heading = MESHES, verbatim_doc_comment, long, value_name = "GOAL|KEY=X", value_parser = adaptivity)]
    adaptive: Option<Adaptivity>,
    /// Where the files go
    #[arg(help_heading = OUTPUT, long, value_name = "DIR", default_value = "target/pictures")]
    out: PathBuf,
}

/// Whether every solve converged.
pub fn run(options: &Options) -> Result<bool, Failure> {
    let warn = |warning: String| warn(&warning);
    let (scenes, paths): (Vec<AnyScene>, Vec<PathBuf>) = match &options.problem {
        Some(path) => {
            let problems = options.constants.problems(path, &warn)?;
            let paths = problems.iter().flat_map(|read| read.paths.clone()).collect();
            (problems.into_iter().map(|read| read.scene).collect(), paths)
        }
        None => {
            options.constants.check_absent()?;
            let scene = scene(&options.scene)?;
            let scene = options.mesh.under(scene, options.mesh.read()?.as_ref(), &warn)?;
            (vec![scene], options.mesh.path.iter().cloned().collect())
        }
    };
    check_apart(&paths, None, [&options.out])?;
    let check = |scene: &AnyScene| in_its_dimension!(scene, |scene| study(options, scene).check());
    scenes.iter().try_for_each(check).map_err(|e| e.to_string())?;
    take_directory(&options.out)?;
    end_at_interrupt("pictures that are finished are there")?;
    let draw = |scene| in_its_dimension!(scene, |scene| draw(options, &scene));
    let drawn = scenes.into_iter().map(draw).collect::<Result<Vec<bool>, _>>()?;
    Ok(drawn.iter().all(|&converged| converged))
}

/// The study of the level of a scene that is drawn.
fn study<'a, const D: usize>(options: &Options, scene: &Scene<D>) -> Study<'a, D> {
    let level = options.level.unwrap_or(match scene.domain.is_mesh() {
        true => 0,
        false if options.adaptive.is_some() => 4,
        false if D == 3 => 8,
        false => 16,
    });
    let study = Study::new(scene.clone()).named_scheme(&options.scheme).levels([level]);
    match options.adaptive {
        Some(adaptivity) => study.adaptive(adaptivity),
        None => study,
    }
}

/// Draws one level.
fn draw<const D: usize>(options: &Options, scene: &Scene<D>) -> Result<bool, Failure> {
    let written = RefCell::new(Vec::new());
    let picture = study(options, scene).each_solution(|label, level, solved| {
        let stem = file_name(&format!("{}-{label}-{level}", scene.name));
        let unit = if options.adaptive.is_some() { "step" } else { "level" };
        let mut title = format!("{}: {label}, {unit} {level}", scene.name);
        if !solved.converged() {
            title += &format!(", NOT CONVERGED: {}", solved.outcome());
        }
        written.borrow_mut().extend(draw_solution(&title, solved, &options.out, &stem)?);
        Ok(())
    });
    let rows = picture.run().map_err(Failure::of_work)?.rows;
    if let (true, Some(row)) = (written.borrow().is_empty(), rows.first()) {
        let (level, message) = (row.level, row.message.as_deref().unwrap_or_default());
        return Err(Failure::Work(format!("level {level}: {message}: there is nothing to draw")));
    }
    for path in written.borrow().iter() {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(rows.iter().all(Row::converged))
}

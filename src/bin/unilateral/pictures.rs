//! Solutions as pictures: the function, and the contact set found against the exact free boundary, as SVG.
//!
//! `cargo run --release -- pictures --help` lists the options. Of a solve that did not converge the last iterate is
//! drawn, and said to be one.

use std::cell::RefCell;
use std::path::PathBuf;

use clap::Args;
use unilateral::in_its_dimension;
use unilateral::scenes::Scene;
use unilateral::scheme::NamedScheme;
use unilateral::study::{Row, Study, file_name};

use crate::asked::{Asked, FoundScenes, OUTPUT};
use crate::one_run::take_directory;
use crate::shared::{Failure, draw_solution, end_at_interrupt, print, schemes, use_threads, warn};

const EXAMPLES: &str = "\
Examples:
  unilateral pictures --scene ball-2d --scheme wopsip:facet-means --levels 32
  unilateral pictures plate.toml --adaptive 1e-2 --out plate";

/// Draws the solutions of schemes on scenes, or on a problem of your own
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Options {
    #[command(flatten)]
    asked: Asked,
    /// Where the files go
    #[arg(help_heading = OUTPUT, long, value_name = "DIR", default_value = "target/pictures")]
    out: PathBuf,
}

/// Whether every solve converged.
pub fn run(options: &Options) -> Result<bool, Failure> {
    let asked = &options.asked;
    asked.check()?;
    if asked.mesh.path.is_some() && asked.scenes.is_empty() {
        return Err("--mesh: name the scenes that run on the mesh by --scene".to_owned().into());
    }
    use_threads(asked.threads)?;
    let schemes = schemes(&asked.schemes, &["wopsip"])?;
    let FoundScenes { scenes, .. } = asked.scenes(&["radial-2d"], &|warning| warn(&warning))?;
    for scene in &scenes {
        in_its_dimension!(scene, |scene| {
            let place = asked.place(&scene.name);
            study(asked, scene, &schemes).check().map_err(|e| format!("{place}: {e}"))
        })?;
    }
    take_directory(&options.out)?;
    end_at_interrupt("pictures that are finished are there")?;
    let draw = |scene| in_its_dimension!(scene, |scene| draw(options, &scene, &schemes));
    let drawn = scenes.into_iter().map(draw).collect::<Result<Vec<bool>, _>>()?;
    Ok(drawn.iter().all(|&converged| converged))
}

/// The study of the solutions of a scene that are drawn.
fn study<'a, const D: usize>(
    asked: &Asked,
    scene: &Scene<D>,
    schemes: &[NamedScheme],
) -> Study<'a, D> {
    let level = match scene.domain.is_mesh() {
        true => 0,
        false if asked.adaptive.is_some() => 4,
        false if D == 3 => 8,
        false => 16,
    };
    let levels = if asked.levels.is_empty() { vec![level] } else { asked.levels.clone() };
    let study = schemes.iter().fold(Study::new(scene.clone()), Study::named_scheme).levels(levels);
    asked.adaptive.into_iter().fold(study, Study::adaptive)
}

/// Draws the solutions of a scene. Returns whether all solves converged.
fn draw<const D: usize>(
    options: &Options,
    scene: &Scene<D>,
    schemes: &[NamedScheme],
) -> Result<bool, Failure> {
    let written = RefCell::new(Vec::new());
    let study = study(&options.asked, scene, schemes).each_solution(|label, level, solved| {
        let stem = file_name(&format!("{}-{label}-{level}", scene.name));
        let unit = if options.asked.adaptive.is_some() { "step" } else { "level" };
        let mut title = format!("{}: {label}, {unit} {level}", scene.name);
        if !solved.converged() {
            title += &format!(", NOT CONVERGED: {}", solved.outcome());
        }
        written.borrow_mut().extend(draw_solution(&title, solved, &options.out, &stem)?);
        Ok(())
    });
    let rows = study.run().map_err(Failure::of_work)?.rows;
    if let (true, Some(row)) = (written.borrow().is_empty(), rows.first()) {
        let (level, message) = (row.level, row.message.as_deref().unwrap_or_default());
        return Err(Failure::Work(format!("level {level}: {message}: there is nothing to draw")));
    }
    for path in written.borrow().iter().filter(|_| !options.asked.quiet) {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(rows.iter().all(Row::converged))
}

//! Errors where no solution is known: four schemes on a membrane between two obstacles, measured against one
//! solution by quadratics on a finer mesh.
//!
//! `cargo run --release --example against_a_reference` writes tables and plots to
//! `target/against_a_reference`.

use unilateral::mesh::gmsh;
use unilateral::prelude::*;

fn main() -> Result<(), Error> {
    let membrane = Problem::new()
        .source(|x| 8.0 * (std::f64::consts::PI * x[0] / 1.5).sin())
        .obstacle_below(|_| -0.25)
        .obstacle_above(|x| 0.2 + 0.1 * x[1])
        .dirichlet_on("rim", 0.0);
    let mesh = gmsh::read::<2>("examples/problems/membrane.msh".as_ref())?.mesh;
    let report = Study::new(Scene::of_problem("membrane", membrane, mesh)?)
        .scheme(ConformingP1)
        .scheme(NonconformingP1)
        .scheme(Sipg::default())
        .scheme_on(Wopsip::default(), FacetMeans)
        .levels([0, 1, 2])
        .reference(ConformingP2, 4)
        .run()?;
    print!("{report}");
    report.write("target/against_a_reference")?;
    Ok(())
}

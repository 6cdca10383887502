//! A mesh of one's own: a bracket whose Gmsh file names its material and groups of boundary facets stands on a
//! curved base, which alone holds it against a load that presses it down and turns it.
//!
//! `cargo run --release --example one_problem` writes a picture of the foot and fields for ParaView to
//! `target/one_problem`.

use unilateral::mesh::gmsh;
use unilateral::plot::Picture;
use unilateral::prelude::*;

fn main() -> Result<(), Error> {
    let bracket = Problem::new()
        .source_in("steel", -1.0)
        .signorini_on("foot", |x: &Point<3>| -1.5 * (x[0] - 0.5).powi(2))
        .neumann_on("head", |x, _| -2.0 + 30.0 * (x[0] - 0.15))
        .neumann_on("sides", |_, _| 0.0);
    let mesh = gmsh::read::<3>("examples/problems/bracket.msh".as_ref())?.mesh;
    let mesh = bracket.bind_boundary(mesh)?;
    // one on the volume of 0.342, two on the head of 0.18
    println!("load: -0.702");

    for refinements in 0..=2 {
        let meshes = Hierarchy::refine(&mesh, refinements)?;
        let u = solve(&bracket, &meshes, &ConformingP1)?;
        let (area, force) = (u.contact_measure().unwrap_or(0.0), u.resultant().unwrap_or(0.0));
        print!("{}: {} unknowns, contact force {force:.9}, ", u.outcome(), u.values().len());
        println!("contact area {area:.3}, violation {:.0e}", u.certificate().largest());
        u.write_vtu(format!("target/one_problem/bracket-{refinements}.vtu"))?;
        if let (0, Some(fields)) = (refinements, u.fields()) {
            let picture = Picture::of("bracket, p1", &bracket, u.mesh(), &fields)?;
            picture.write("target/one_problem".as_ref(), "bracket")?;
        }
    }
    Ok(())
}

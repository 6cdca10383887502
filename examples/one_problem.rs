//! One problem on a mesh of one's own: a membrane over a plate with holes, fixed at the upper edge, is
//! pressed down and comes to rest on a parabolic obstacle and on a stop under its lower edge.
//!
//! `cargo run --release --example one_problem -- MESH.msh [REFINEMENTS]`; the groups `dirichlet`, `neumann`
//! and `contact` of the Gmsh file name the parts of the boundary.

use unilateral::mesh::gmsh;
use unilateral::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().unwrap_or("tests/data/plate.msh".to_owned());
    let refinements = arguments.next().map_or(Ok(2), |n| n.parse())?;

    let mesh: Mesh<f64, 2> = gmsh::read(path.as_ref())?.mesh;
    let meshes = Hierarchy::refine(&mesh, refinements)?;
    let plate = Problem::new()
        .constant_source(-1.0)
        .obstacle_below(|x| -0.1 - 0.15 * (x - Point::from([1.5, 0.3])).norm_squared())
        .signorini(|_| -0.3);

    let u = solve(&plate, &meshes, &ConformingP1)?;
    let (active, outer) = (u.active().unwrap_or(0), u.outer().unwrap_or(0));
    println!("{}: {} unknowns, {active} in contact", u.outcome(), u.values().len());
    println!("{outer} active sets, largest violation {:.1e}", u.certificate().largest());
    if let Some(value) = u.value_at(&Point::from([1.0, 0.5])) {
        println!("value at (1, 0.5): {value:.6}");
    }
    let sipg = solve(&plate, &meshes, &Sipg::default())?;
    if let Some(distance) = u.difference(&sipg)?.l2 {
        println!("L2 distance to SIPG: {distance:.1e}");
    }
    u.write_vtu("target/one_problem/plate.vtu")?;
    Ok(())
}

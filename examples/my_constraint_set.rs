//! A constraint set in one file: an obstacle at two of the three vertices of each triangle, beside
//! the sets of the library on the same scheme. `cargo run --release --example my_constraint_set` prints the tables, and
//! how many unknowns the set binds.

use unilateral::prelude::*;

/// The values at all vertices of a cell but its last one.
struct AllVerticesButOne;

impl ConstraintSet for AllVerticesButOne {
    fn name(&self) -> &str {
        "all-vertices-but-one"
    }
    fn in_domain(&self, node: &Node, dimension: usize) -> Option<BoundBy> {
        let is_bound = matches!(node.entity(), Entity::Vertex(k) if k < dimension);
        is_bound.then_some(BoundBy::Value)
    }
}

fn main() -> Result<(), Error> {
    // a set belongs to an entry of a study ...
    let report = Study::<2>::new(scenes::radial(1.0))
        .scheme(Sipg::default())
        .scheme_on(Sipg::default(), FacetMeans)
        .scheme_on(Sipg::default(), AllVerticesButOne)
        .levels([8, 16, 32])
        .run()?;
    print!("{report}");

    // ... or to a problem
    let scene = scenes::radial::<2>(1.0);
    let mesh = scene.domain.mesh(8)?;
    let problem = scene.problem.on(AllVerticesButOne);
    let discretisation =
        Discretisation::new(&Sipg::default(), &problem, &mesh, Default::default())?;
    let bound = discretisation.bounds()?.iter().filter(|b| b.is_inequality()).count();
    println!("{bound} of {} unknowns are bound", discretisation.unknowns());

    // continuous quadratics have vertices too; Crouzeix-Raviart elements have none
    let problem = Problem::new().obstacle_below(|_| 0.0).on(AllVerticesButOne);
    match Discretisation::new(&NonconformingP1, &problem, &mesh, Default::default()) {
        Ok(_) => unreachable!("no facet mean is a vertex"),
        Err(error) => println!("{error}"),
    }
    Ok(())
}

//! Domains that only their bounds hold: no solution, many solutions, or one.

use unilateral::inequality::{
    ActiveSet, MonotoneMultigrid, Outcome, ProximalPoint, SinglePrecision, in_precision,
};
use unilateral::mesh::BoundaryCondition;
use unilateral::nested::NestedIteration;
use unilateral::prelude::*;
use unilateral::real::Precision;

/// A square that only a contact condition on its lower side holds.
fn square(n: usize) -> Mesh<2> {
    let free = [BoundaryCondition::Neumann; 2];
    let sides = [free, [BoundaryCondition::Contact, BoundaryCondition::Neumann]];
    let domain = BoxDomain::new(Point::zeros(), Point::repeat(1.0), sides);
    Mesh::kuhn_box(&domain, [n, n]).unwrap()
}

fn body(load: f64) -> Problem<2> {
    Problem::new().constant_source(load).signorini(|x| 0.1 * x[0])
}

fn balanced() -> Problem<2> {
    Problem::new().source(|x| x[0] - 0.5).signorini(|x| 0.1 * x[0])
}

fn schemes() -> Vec<(Box<dyn Scheme<2>>, bool)> {
    vec![
        (Box::new(ConformingP1), false),
        (Box::new(ConformingP2), false),
        (Box::new(NonconformingP1), false),
        (Box::new(Sipg::default()), false),
        (Box::new(Nipg::default()), false),
        (Box::new(Wopsip::default()), false),
        (Box::new(Wopsip::default()), true),
    ]
}

#[test]
fn a_load_that_pulls_away_has_no_solution_and_a_balanced_one_many() {
    for n in [3, 7, 12, 16, 27] {
        let mesh = square(n);
        for (scheme, on_facet_means) in schemes() {
            let place =
                |problem: Problem<2>| if on_facet_means { problem.on(FacetMeans) } else { problem };
            let pulled = place(body(1.0));
            let solved = solve(&pulled, &mesh, &*scheme).unwrap();
            assert_eq!(solved.outcome(), Outcome::NoSolution, "{} {n}", scheme.name());
            assert!(solved.certificate().largest().is_infinite());

            let problem = place(balanced());
            let solved = solve(&problem, &mesh, &*scheme).unwrap();
            assert_eq!(solved.outcome(), Outcome::NotUnique, "{} {n}", scheme.name());
            // the values are one of the solutions
            let largest = solved.certificate().largest();
            assert!(largest < 1e-9, "{} {n}: {largest}", scheme.name());

            let pressed = place(body(-1.0));
            let solved = solve(&pressed, &mesh, &*scheme).unwrap();
            assert_eq!(solved.outcome(), Outcome::Converged, "{} {n}", scheme.name());
            let resultant: f64 = solved.multiplier().unwrap().iter().sum();
            assert!((resultant - 1.0).abs() < 1e-10, "{} {n}: {resultant}", scheme.name());
        }
    }
}

#[test]
fn every_solver_says_so() {
    let mesh = square(8);
    let (pulled, level) = (body(1.0), balanced());
    for (problem, outcome) in [(&pulled, Outcome::NoSolution), (&level, Outcome::NotUnique)] {
        let multigrid = MonotoneMultigrid::default();
        let solved =
            NestedIteration::new(problem, &mesh).solver(multigrid).solve(&ConformingP1).unwrap();
        assert_eq!(solved.outcome(), outcome);
        let mut nested = NestedIteration::new(problem, &mesh).solver(ProximalPoint);
        assert_eq!(nested.solve(&ConformingP1).unwrap().outcome(), outcome);
    }
    let fine = square(16);
    for (problem, outcome) in [(&pulled, Outcome::NoSolution), (&level, Outcome::NotUnique)] {
        let single = SinglePrecision::new(ActiveSet::default());
        let mut nested = NestedIteration::new(problem, &fine).solver(single);
        assert_eq!(nested.solve(&Sipg::default()).unwrap().outcome(), outcome);
    }
}

#[test]
fn a_reaction_or_two_obstacles_hold_a_body() {
    let mesh = square(8);
    let reaction = body(1.0).reaction(1.0);
    let obstacles = body(1.0).obstacle_above(|x| 2.0 + x[0]);
    for problem in [reaction, obstacles] {
        for (scheme, _) in schemes() {
            let solved = solve(&problem, &mesh, &*scheme).unwrap();
            assert_eq!(solved.outcome(), Outcome::Converged, "{}", scheme.name());
        }
    }
}

#[test]
fn each_component_is_tested() {
    // two intervals: the first is fixed at one end, nothing but the obstacle holds the second
    let vertices = [0.0, 0.5, 1.0, 2.0, 2.5, 3.0].map(|x| Point::from([x])).to_vec();
    let facet = |vertex, condition| unilateral::mesh::TaggedFacet { vertices: [vertex], condition };
    let boundary = [
        facet(0, BoundaryCondition::Dirichlet),
        facet(2, BoundaryCondition::Neumann),
        facet(3, BoundaryCondition::Neumann),
        facet(5, BoundaryCondition::Neumann),
    ];
    let cells = vec![0, 1, 1, 2, 3, 4, 4, 5];
    let mesh = Mesh::<1>::new(vertices, cells, &boundary).unwrap();
    assert!(!mesh.is_supported() && !mesh.refine().unwrap().0.is_supported());
    let problem = |right: f64| {
        let load = move |x: &Point<1>| if x[0] < 1.5 { 1.0 } else { right };
        Problem::new().source(load).obstacle_below(|_| -1.0)
    };
    let schemes: [&dyn Scheme<1>; 4] =
        [&ConformingP1, &NonconformingP1, &Sipg::default(), &Wopsip::default()];
    for scheme in schemes {
        for (right, outcome) in
            [(1.0, Outcome::NoSolution), (0.0, Outcome::NotUnique), (-1.0, Outcome::Converged)]
        {
            let problem = problem(right);
            let solved = solve(&problem, &mesh, scheme).unwrap();
            assert_eq!(solved.outcome(), outcome, "{} {right}", scheme.name());
        }
    }
}

#[test]
fn entries_of_the_kernel_and_of_data_belong_to_unknowns() {
    use unilateral::algebra::{DirichletEnergy, DirichletTerm};
    use unilateral::inequality::{ActiveSet, InequalitySolver};
    let good = crate::problems::membrane(3, 1.0, |_, _| -1.0);
    let outcome = |inequality| ActiveSet::default().solve(&inequality).outcome;
    assert_eq!(outcome(good.clone()), Outcome::Converged);
    for kernel in [vec![(9, 1.0)], vec![(0, 0.0)], vec![(0, f64::NAN)], vec![]] {
        let mut wrong = good.clone();
        wrong.kernel = vec![kernel];
        assert_eq!(outcome(wrong), Outcome::Malformed);
    }
    let mut beyond = good;
    let terms = vec![DirichletTerm { unknown: 9, load: 1.0, linear: 2.0, constant: 1.0 }];
    beyond.dirichlet_energy = Some(DirichletEnergy { terms });
    assert_eq!(outcome(beyond), Outcome::Malformed);
}

/// Two squares that touch at one vertex are two bodies, also for schemes with an unknown there.
#[test]
fn bodies_that_touch_at_a_vertex_count_for_themselves() {
    let squares = |part_of_first: BoundaryCondition| {
        let vertices = [[0., 0.], [1., 0.], [0., 1.], [1., 1.], [2., 1.], [1., 2.], [2., 2.]];
        let side = |vertices, condition| unilateral::mesh::TaggedFacet { vertices, condition };
        let boundary = [
            side([0, 1], part_of_first),
            side([0, 2], BoundaryCondition::Neumann),
            side([1, 3], BoundaryCondition::Neumann),
            side([2, 3], BoundaryCondition::Neumann),
            side([3, 4], BoundaryCondition::Neumann),
            side([3, 5], BoundaryCondition::Neumann),
            side([4, 6], BoundaryCondition::Neumann),
            side([5, 6], BoundaryCondition::Neumann),
        ];
        let cells = vec![0, 1, 3, 0, 2, 3, 3, 4, 6, 3, 5, 6];
        let mesh = Mesh::<2>::new(vertices.map(Point::from).to_vec(), cells, &boundary);
        mesh.unwrap().refine().unwrap().0
    };
    let of_all = |loads: &[f64]| {
        let pulls = loads.iter().any(|&load| load > 0.0);
        let is_balanced = loads.contains(&0.0);
        match (pulls, is_balanced) {
            (true, _) => Outcome::NoSolution,
            (_, true) => Outcome::NotUnique,
            _ => Outcome::Converged,
        }
    };
    for [first, second] in [[-1.0, -2.0], [-1.0, 0.0], [-3.0, 1.0], [1.0, -3.0], [0.0, -2.0]] {
        let load = move |x: &Point<2>| if x[0] + x[1] < 2.0 { first } else { second };
        let problem = Problem::new().source(load).obstacle_below(|_| 0.0);
        for (part, loads) in [
            (BoundaryCondition::Neumann, vec![first, second]),
            // Dirichlet data hold the first square, whatever its load
            (BoundaryCondition::Dirichlet, vec![second]),
        ] {
            let mesh = squares(part);
            for (scheme, _) in schemes() {
                let solved = solve(&problem, &mesh, &*scheme).unwrap();
                assert_eq!(solved.outcome(), of_all(&loads), "{} {loads:?}", scheme.name());
            }
        }
    }
}

/// A load that is added after the assembly is a part of the resultant.
#[test]
fn an_added_load_counts() {
    use unilateral::assemble::{DataQuadrature, Discretisation};
    use unilateral::inequality::{ActiveSet, InequalitySolver};
    let (mesh, problem) = (square(4), balanced());
    let space = Discretisation::new(&ConformingP1, &problem, &mesh, DataQuadrature::default());
    let mut inequality = space.unwrap().inequality().unwrap();
    let mut outcome_with = |load: f64| {
        inequality.load[0] += load;
        ActiveSet::default().solve(&inequality).outcome
    };
    assert_eq!(outcome_with(0.0), Outcome::NotUnique);
    assert_eq!(outcome_with(-1e-3), Outcome::Converged);
    assert_eq!(outcome_with(2e-3), Outcome::NoSolution);
}

/// Where room is left between the bounds the values are moved as little as possible from those with one value zero: by
/// nothing where these are within the bounds, else until one touches.
#[test]
fn one_of_many_solutions_is_moved_as_little_as_possible() {
    let free =
        BoxDomain::new(Point::zeros(), Point::repeat(1.0), [[BoundaryCondition::Neumann; 2]; 2]);
    let mesh = Mesh::<2>::kuhn_box(&free, [4, 4]).unwrap();
    let range = |below: f64, above: f64| {
        let problem = Problem::new().source(|x| x[0] - 0.5);
        let problem = problem.obstacle_below(move |_| below).obstacle_above(move |_| above);
        let solved = solve(&problem, &mesh, &ConformingP1).unwrap();
        assert_eq!(solved.outcome(), Outcome::NotUnique, "{below} {above}");
        let fold = |f: fn(f64, f64) -> f64| solved.values().iter().copied().reduce(f).unwrap();
        [fold(f64::min), fold(f64::max)]
    };
    let [least, most] = range(-5.0, 5.0);
    assert!(least <= 0.0 && most >= 0.0 && most - least < 0.2, "{least} {most}");
    let height = most - least;
    for (below, above, expected) in
        [(1.0, 9.0, [1.0, 1.0 + height]), (-9.0, -1.0, [-1.0 - height, -1.0])]
    {
        for (found, expected) in range(below, above).into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{below} {above}: {found} {expected}");
        }
    }
}

/// Neither is what rounding to single precision makes of it.
#[test]
fn a_rounded_load_is_not_an_added_one() {
    let problem = Problem::new().source(|x| x[0] * x[0] - 1.0 / 3.0).signorini(|x| 0.1 * x[0]);
    let mesh = square(7);
    for precision in [Precision::Double, Precision::Single] {
        let solver = in_precision(precision, ActiveSet::default());
        let mut nested = NestedIteration::new(&problem, &mesh).shared_solver(solver.into());
        let solved = nested.solve(&ConformingP1).unwrap();
        assert_eq!(solved.outcome(), Outcome::NotUnique, "{precision:?}");
    }
}

/// What a row says of a body without a solution has the resultant, positive upward.
#[test]
fn the_message_has_the_resultant() {
    let message = |load: f64| {
        let domain = BoxDomain::new(
            Point::zeros(),
            Point::repeat(1.0),
            [[BoundaryCondition::Neumann; 2]; 2],
        );
        let problem = Problem::new().constant_source(load);
        let problem = match load > 0.0 {
            true => problem.obstacle_below(|_| 0.0),
            false => problem.obstacle_above(|_| 0.0),
        };
        let study = Study::<2>::new(Scene::new("square", domain, problem));
        let report = study.scheme(ConformingP1).levels([4]).run().unwrap();
        report.rows[0].message.clone().unwrap()
    };
    for (load, resultant) in [(2.0, "2.000000e0"), (-3.0, "-3.000000e0")] {
        let message = message(load);
        assert!(message.ends_with(&format!("its resultant is {resultant}")), "{message}");
    }
}

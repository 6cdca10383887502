//! Tensor coefficients: patch tests, orders, changes of coordinates, bounds, and what is refused.

use unilateral::prelude::*;
use unilateral::problem::Tensor;
use unilateral::real::{Matrix, Point};

const LINEARS: [&str; 9] = ["p1", "cr", "sipg", "nipg", "iipg", "wopsip", "ldg", "br2", "bmmpr"];

fn scheme<const D: usize>(name: &str) -> Box<dyn Scheme<D>> {
    name.parse::<NamedScheme>().unwrap().make()
}

fn cube<const D: usize>(n: usize) -> Mesh<D> {
    Mesh::kuhn_box(&BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)), [n; D]).unwrap()
}

/// A tensor with the eigenvalue `contrast` in a direction oblique to the axes, one across it.
fn oblique<const D: usize>(contrast: f64) -> Matrix<D> {
    let direction = Point::<D>::from_fn(|k, _| 1.0 + k as f64).normalize();
    Matrix::identity() + direction * direction.transpose() * (contrast - 1.0)
}

/// A smooth solution for a constant tensor.
fn smooth<const D: usize>(tensor: Matrix<D>) -> Problem<D> {
    let slopes = Point::<D>::from_fn(|k, _| 1.0 - 0.4 * k as f64);
    let angle = move |x: &Point<D>| slopes.dot(x) * 2.0 + 0.2;
    Problem::new()
        .source(move |x| 4.0 * slopes.dot(&(tensor * slopes)) * angle(x).sin())
        .exact(move |x| angle(x).sin(), move |x| slopes * (2.0 * angle(x).cos()))
        .tensor_in("default", Tensor::Constant(tensor))
}

fn errors<const D: usize>(problem: &Problem<D>, n: usize, name: &str) -> [f64; 3] {
    let mesh = cube::<D>(n);
    let solved = solve(problem, &mesh, &*scheme::<D>(name)).unwrap();
    assert!(solved.converged(), "{name} at {n}");
    let errors = solved.errors().unwrap();
    [errors.energy, errors.h1, errors.l2].map(Option::unwrap)
}

fn has_its_orders<const D: usize>(
    contrast: f64,
    [coarse, fine]: [usize; 2],
    names: &[(&str, f64)],
) {
    for &(name, expected) in names {
        let problem = smooth::<D>(oblique(contrast));
        let [of_coarse, of_fine] = [coarse, fine].map(|n| errors(&problem, n, name));
        let order = (of_coarse[0] / of_fine[0]).log2();
        assert!(order > expected - 0.15, "{name} in {D} for {contrast}: energy {order}");
        let order = (of_coarse[2] / of_fine[2]).log2();
        assert!(order > expected + 0.6, "{name} in {D} for {contrast}: L2 {order}");
    }
}

#[test]
fn schemes_have_their_orders_for_a_contrast_of_directions() {
    for contrast in [10.0, 1000.0] {
        has_its_orders::<2>(contrast, [32, 64], &LINEARS.map(|name| (name, 1.0)));
        has_its_orders::<2>(contrast, [16, 32], &[("p2", 2.0), ("sipg-p2", 2.0)]);
    }
    has_its_orders::<3>(10.0, [6, 12], &[("p1", 1.0), ("cr", 1.0), ("sipg", 1.0)]);
    has_its_orders::<3>(1000.0, [6, 12], &[("p1", 1.0)]);
}

/// Two layers with tensors of their own: with a continuous normal flux the solution is linear in each.
#[test]
fn a_solution_that_is_linear_in_two_layers_is_exact() {
    let mesh = cube::<2>(4);
    let is_right = |c: usize| u16::from(mesh.barycentre(c)[0] > 0.5);
    let of_cells = (0..mesh.n_cells()).map(is_right).collect();
    let names = vec![vec!["left".to_owned()], vec!["right".to_owned()]];
    let mesh = mesh.clone().with_regions(names, of_cells).unwrap();
    let tensors = [[[2.0, 1.0], [1.0, 3.0]], [[500.0, -20.0], [-20.0, 2.0]]];
    let slope = move |x: &Point<2>| if x[0] < 0.5 { 250.0 } else { 1.0 };
    let problem = Problem::<2>::new()
        .tensor_in("left", tensors[0])
        .tensor_in("right", tensors[1])
        .exact(move |x| slope(x) * (x[0] - 0.5), move |x| Point::from([slope(x), 0.0]));
    for name in ["p1", "cr", "sipg", "nipg", "iipg", "ldg", "br2", "bmmpr", "p2", "sipg-p2"] {
        let solved = solve(&problem, &mesh, &*scheme::<2>(name)).unwrap();
        assert!(solved.converged(), "{name}");
        let error = solved.errors().unwrap().max.unwrap();
        assert!(error < 1e-9, "{name}: {error}");
        if name != "p2" && name != "sipg-p2" {
            let bound = solved.bound().unwrap();
            assert!(bound.discrete < 1e-7, "{name}: {}", bound.discrete);
        }
    }
}

/// A tensor that is a multiple of the identity is a coefficient.
#[test]
fn a_multiple_of_the_identity_is_a_coefficient() {
    let problem = || {
        Problem::<2>::new().source(|x: &Point<2>| 10.0 * x[0].sin() - 8.0).obstacle_below(|_| -0.1)
    };
    let (by_tensor, by_coefficient) = (
        problem().tensor_in("default", [[3.0, 0.0], [0.0, 3.0]]),
        problem().coefficient(|_: &Point<2>| 3.0),
    );
    let mesh = cube::<2>(8);
    for name in LINEARS.into_iter().chain(["p2", "sipg-p2", "br2-p2", "wopsip:facet-means"]) {
        let [one, other] = [&by_tensor, &by_coefficient].map(|problem| {
            let solved = solve(problem, &mesh, &*scheme::<2>(name)).unwrap();
            assert!(solved.converged(), "{name}");
            (solved.solution().values.clone(), solved.bound().unwrap().discrete)
        });
        let differences = one.0.iter().zip(&other.0).map(|(a, b)| (a - b).abs());
        let largest = differences.fold(0.0, f64::max);
        assert!(largest < 1e-9, "{name}: {largest}");
        let quotient = one.1 / other.1;
        assert!(
            (quotient - 1.0).abs() < 1e-6,
            "{name}: bounds {one:?} {other:?}",
            one = one.1,
            other = other.1
        );
    }
}

/// With `T = diag(4, 1)` on a square the problem is that of the Laplacian on a square half as wide.
#[test]
fn a_tensor_is_a_change_of_coordinates_for_solution_and_bound() {
    let stretched =
        Mesh::<2>::kuhn_box(&BoxDomain::dirichlet(Point::zeros(), Point::from([0.5, 1.0])), [8, 8])
            .unwrap();
    let square = cube::<2>(8);
    let data = |problem: Problem<2>, width: f64| {
        problem
            .constant_source(-8.0)
            .reaction(2.0)
            .obstacle_below(move |x: &Point<2>| -0.08 + 0.02 * (x[0] * width + x[1]))
            .obstacles_of_degree(1)
    };
    let by_tensor = data(Problem::new().tensor_in("default", [[4.0, 0.0], [0.0, 1.0]]), 1.0);
    let by_mesh = data(Problem::new(), 2.0);
    for name in ["p1", "cr", "p2", "p2:bernstein"] {
        let solve_on = |problem: &Problem<2>, mesh: &Mesh<2>| {
            let solved = solve(problem, mesh, &*scheme::<2>(name)).unwrap();
            assert!(solved.converged(), "{name}");
            let bound = solved.bound().unwrap();
            assert!(bound.is_guaranteed() || name == "p2", "{name}: {:?}", bound.unproven);
            (solved.solution().values.clone(), bound.discrete, bound.total)
        };
        let (one, other) = (solve_on(&by_tensor, &square), solve_on(&by_mesh, &stretched));
        let differences = one.0.iter().zip(&other.0).map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-11, "{name}");
        for (one, other) in [(one.1, other.1), (one.2, other.2)] {
            let quotient = one / (other * 2.0_f64.sqrt());
            assert!((quotient - 1.0).abs() < 1e-9, "{name}: {quotient}");
        }
    }
}

/// Fluxes around vertices know the shape of cells only: in the coordinates of the tensor these are stretched.
#[test]
fn bounds_hold_and_grow_with_the_contrast_of_directions() {
    let along_axis = Matrix::<2>::new(1000.0, 0.0, 0.0, 1.0);
    for name in ["p1", "cr", "sipg", "wopsip", "p2", "sipg-p2"] {
        for (tensor, most) in [(oblique(10.0), 2.0), (along_axis, 21.0), (oblique(1000.0), 21.0)] {
            let problem = smooth::<2>(tensor);
            let mesh = cube::<2>(16);
            let solved = solve(&problem, &mesh, &*scheme::<2>(name)).unwrap();
            let bound = solved.bound().unwrap().discrete;
            let energy = solved.errors().unwrap().energy.unwrap();
            assert!(bound < most * energy, "{name} {tensor}: {bound} {energy}");
            if ["p1", "cr", "p2"].contains(&name) {
                assert!(bound > 0.999 * energy, "{name} {tensor}: {bound} {energy}");
            }
        }
    }
}

/// A tensor that varies: its barycentres keep the order of linears.
#[test]
fn a_tensor_that_is_a_function_keeps_the_order_of_linears() {
    // -div(T grad u) with T = [[1 + x, y / 2], [y / 2, 2]] and u = x^2 + y
    let tensor = |x: &Point<2>| Matrix::<2>::new(1.0 + x[0], 0.5 * x[1], 0.5 * x[1], 2.0);
    let problem = Problem::<2>::new()
        .tensor_in("default", Tensor::function(tensor))
        .source(|x: &Point<2>| -(2.0 + 5.0 * x[0]))
        .exact(|x| x[0] * x[0] + x[1], |x| Point::from([2.0 * x[0], 1.0]));
    for name in ["p1", "sipg", "wopsip", "br2"] {
        let [coarse, fine] = [16, 32].map(|n| errors(&problem, n, name));
        for (k, expected) in [(0, 1.0), (2, 2.0)] {
            let order = (coarse[k] / fine[k]).log2();
            assert!(order > expected - 0.2, "{name}: {order}");
        }
    }
}

/// A jump of tensors is one of coefficients, for solutions and bounds.
#[test]
fn a_jump_of_multiples_of_the_identity_is_a_jump_of_the_coefficient() {
    let mesh = cube::<2>(8);
    let is_right = |c: usize| u16::from(mesh.barycentre(c)[0] > 0.5);
    let of_cells = (0..mesh.n_cells()).map(is_right).collect();
    let names = vec![vec!["left".to_owned()], vec!["right".to_owned()]];
    let mesh = mesh.clone().with_regions(names, of_cells).unwrap();
    let loaded = || Problem::<2>::new().constant_source(1.0);
    let by_tensor = loaded()
        .tensor_in("left", [[1e6, 0.0], [0.0, 1e6]])
        .tensor_in("right", [[1.0, 0.0], [0.0, 1.0]]);
    let by_coefficient = loaded().coefficient_in("left", 1e6).coefficient_in("right", 1.0);
    for name in ["p1", "cr", "sipg", "wopsip", "ldg", "br2", "sipg-p2", "wopsip-p2"] {
        let [one, other] = [&by_tensor, &by_coefficient].map(|problem| {
            let solved = solve(problem, &mesh, &*scheme::<2>(name)).unwrap();
            assert!(solved.converged(), "{name}");
            (solved.energy().unwrap().unwrap(), solved.bound().unwrap().discrete)
        });
        assert!((one.0 / other.0 - 1.0).abs() < 1e-8, "{name}: {one:?} {other:?}");
        assert!((one.1 / other.1 - 1.0).abs() < 1e-4, "{name}: {one:?} {other:?}");
    }
}

#[test]
fn bad_tensors_are_refused() {
    let refuse = |problem: Problem<2>, name: &str| {
        solve(&problem, &cube::<2>(2), &*scheme::<2>(name)).map(|_| ()).unwrap_err().to_string()
    };
    for rows in [[[1.0, 2.0], [2.0, 1.0]], [[1.0, 0.5], [0.0, 1.0]], [[1.0, 0.0], [0.0, f64::NAN]]]
    {
        let message = refuse(Problem::new().tensor_in("default", rows), "p1");
        assert!(message.contains("tensor coefficient is [[1.0"), "{message}");
        assert!(message.contains("cell 0: it must be finite, symmetric and positive"), "{message}");
    }
    let varying = || Tensor::function(|x: &Point<2>| Matrix::identity() * (1.0 + x[0]));
    for name in ["p2", "sipg-p2"] {
        let message = refuse(Problem::new().tensor_in("default", varying()), name);
        assert!(message.contains("linear elements only"), "{message}");
    }
    let twice = refuse(
        Problem::new().tensor_in("default", varying()).tensor_in("default", varying()),
        "p1",
    );
    assert!(twice.contains("tensor coefficient without a name is given twice"), "{twice}");
}

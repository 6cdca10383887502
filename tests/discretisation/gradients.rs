//! Gradients of discrete functions: at points, in cells, and recovered at vertices.

use unilateral::prelude::*;
use unilateral::real::Point;

use crate::runs::small_mesh;

fn scheme<const D: usize>(name: &str) -> Box<dyn Scheme<D>> {
    name.parse::<NamedScheme>().unwrap().make()
}

/// The sum of the squares of the coordinates, whose gradient is linear.
fn squares<const D: usize>(name: &str, n: usize) -> DiscreteFunction<D> {
    let unit = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<D>::kuhn_box(&unit, [n; D]).unwrap();
    let problem =
        Problem::new().constant_source(-2.0 * D as f64).dirichlet(|x: &Point<D>| x.norm_squared());
    solve(&problem, &mesh, &*scheme::<D>(name)).unwrap().function().unwrap()
}

fn is_exact_for_quadratics<const D: usize>() {
    for name in ["p2", "sipg-p2"] {
        let u = squares::<D>(name, 3);
        for x in [0.0, 0.31, 1.0 / 3.0, 0.5, 1.0].map(Point::<D>::repeat) {
            let found = u.gradient_at(&x).unwrap();
            assert!((found - x * 2.0).norm() < 1e-8, "{name} in {D}: {found} at {x}");
        }
        assert_eq!(u.gradient_at(&Point::repeat(3.0)), None);
        let mesh = u.mesh();
        for (cell, found) in u.cell_gradients().iter().enumerate() {
            assert!((found - mesh.barycentre(cell) * 2.0).norm() < 1e-8, "{name} in {D}: {found}");
        }
        // gradients at barycentres determine a linear one, also at corners
        for (x, found) in mesh.vertices().iter().zip(u.recovered_gradient()) {
            assert!((found - x * 2.0).norm() < 1e-6, "{name} in {D}: {found} at {x}");
        }
        // but not on a box of one cell or six, whose barycentres lie in a plane: across it the gradient is the mean
        let few = squares::<D>(name, 1);
        let along =
            few.mesh().vertices().iter().map(|x| x * 2.0 - Point::repeat(x.sum() * 2.0 / D as f64));
        for (found, along) in few.recovered_gradient().iter().zip(along) {
            let expected = along + Point::repeat(1.0);
            assert!((found - expected).norm() < 1e-6, "{name} in {D}: {found} {expected}");
        }
    }
}

#[test]
fn gradients_of_quadratics_are_exact() {
    is_exact_for_quadratics::<1>();
    is_exact_for_quadratics::<2>();
    is_exact_for_quadratics::<3>();
}

/// The mean over the cells around a point on a facet, from each side its own.
#[test]
fn a_gradient_on_a_facet_is_the_mean_of_its_sides() {
    let mesh = Mesh::<1>::kuhn_box(&BoxDomain::centred(1.0), [2]).unwrap();
    let problem = Problem::new().constant_source(-2.0).dirichlet(|_| 1.0);
    let u = solve(&problem, &mesh, &ConformingP1).unwrap().function().unwrap();
    // from one at the left end to zero in the middle to one at the right end
    for (x, slope) in [(-0.5, -1.0), (0.0, 0.0), (0.5, 1.0)] {
        assert!((u.gradient_at(&Point::from([x])).unwrap()[0] - slope).abs() < 1e-14, "{x}");
    }
}

/// The errors in L2 of the gradient and of the recovered one, by the rule of the barycentres and of vertices.
fn errors<const D: usize>(name: &str, mesh: &Mesh<D>) -> [f64; 2] {
    let wave = |x: &Point<D>| (0..D).map(|k| (x[k] + 0.3 * k as f64).sin()).product::<f64>();
    let slope = |x: &Point<D>| {
        Point::<D>::from_fn(|axis, _| {
            let factor = |k: usize| {
                let at = x[k] + 0.3 * k as f64;
                if k == axis { at.cos() } else { at.sin() }
            };
            (0..D).map(factor).product()
        })
    };
    let problem = Problem::new().source(move |x| D as f64 * wave(x)).dirichlet(wave);
    let u = solve(&problem, mesh, &*scheme::<D>(name)).unwrap().function().unwrap();
    let (recovered, gradients) = (u.recovered_gradient(), u.cell_gradients());
    let mut squares = [0.0; 2];
    for cell in 0..mesh.n_cells() {
        let share = mesh.geometry(cell).volume / (D + 1) as f64;
        for &v in mesh.cell(cell) {
            let exact = slope(&mesh.vertices()[v as usize]);
            squares[0] += share * (gradients[cell] - exact).norm_squared();
            squares[1] += share * (recovered[v as usize] - exact).norm_squared();
        }
    }
    squares.map(f64::sqrt)
}

fn order_on<const D: usize>(file: &str, levels: usize, least: f64) {
    let mesh = small_mesh::<D>(file);
    let meshes = Hierarchy::refine(&mesh, levels).unwrap();
    for name in ["p1", "cr", "sipg", "wopsip"] {
        let of = |level: usize| errors::<D>(name, meshes.mesh(level));
        let [before, last] = [of(levels - 1), of(levels)];
        let orders = [0, 1].map(|k| (before[k] / last[k]).log2());
        assert!((orders[0] - 1.0).abs() < 0.1, "{name}: {orders:?}");
        assert!(orders[1] > least && last[1] < last[0], "{name}: {orders:?}, {last:?}");
    }
}

#[test]
fn recovered_gradients_have_a_higher_order_on_unstructured_meshes() {
    order_on::<2>("unstructured_square.msh", 3, 1.7);
    order_on::<3>("unstructured_cube.msh", 2, 1.5);
}

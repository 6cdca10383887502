//! The energy with weak Dirichlet data: that of a function which satisfies the data does not depend on
//! the penalty.

use unilateral::algebra::Inequality;
use unilateral::assemble::DataQuadrature;
use unilateral::prelude::*;

/// `E^2` of unknowns.
fn energy(inequality: &Inequality<f64>, u: &[f64]) -> f64 {
    if let Some(penalised) = &inequality.penalised {
        let value = |i: usize| u[i];
        let multipliers = penalised.jump_multipliers(value);
        let stiffness: f64 = (0..u.len()).map(|i| u[i] * penalised.stiffness(i, value)).sum();
        let jumps = multipliers.iter().zip(&penalised.weights).map(|(p, s)| p * p / s);
        return stiffness + jumps.sum::<f64>();
    }
    let matrix = &inequality.matrix;
    let product: f64 = (0..u.len()).map(|i| u[i] * matrix.row_dot_f64(i, u)).sum();
    let data = inequality.dirichlet_energy.as_ref().expect("weak data");
    let linear: f64 = data.terms.iter().map(|t| t.linear * u[t.unknown as usize]).sum();
    product - linear + data.constant()
}

fn check<const D: usize>(mesh: &Mesh<D>, schemes: &[Box<dyn Scheme<D>>]) {
    let slope: Point<D> = Point::from_fn(|k, _| 1.0 - 0.6 * k as f64);
    let linear = move |x: &Point<D>| 3.0 + x.dot(&slope);
    let problem = Problem::new().dirichlet(linear).coefficient(|_| 2.0);
    let exact = 2.0 * slope.norm_squared();
    for scheme in schemes {
        let discretisation =
            Discretisation::new(&**scheme, &problem, mesh, DataQuadrature::default()).unwrap();
        let inequality = discretisation.inequality().unwrap();
        let node = |i: usize| {
            let vertices = inequality.locations[i].vertices();
            let sum: Point<D> = vertices.iter().map(|&v| mesh.vertices()[v as usize]).sum();
            sum / vertices.len() as f64
        };
        let constants = discretisation.constants();
        let less = |i: usize| constants.get(i).copied().unwrap_or(0.0);
        let u: Vec<f64> = (0..inequality.size()).map(|i| linear(&node(i)) - less(i)).collect();
        let found = energy(&inequality, &u);
        assert!((found - exact).abs() < 1e-8 * exact, "{} {D}D: {found}", scheme.name());
        // another function of the same data has another energy
        let moved: Vec<f64> = (0..u.len()).map(|i| 1.01 * (u[i] + less(i)) - less(i)).collect();
        assert!(energy(&inequality, &moved) > exact * 1.01, "{} {D}D", scheme.name());
    }
}

fn schemes<const D: usize>() -> Vec<Box<dyn Scheme<D>>> {
    vec![
        Box::new(Sipg::default()),
        Box::new(Nipg::default()),
        Box::new(Iipg::default()),
        Box::new(Ldg::default()),
        Box::new(Br2::default()),
        Box::new(Bmmpr::default()),
        Box::new(Wopsip::default()),
    ]
}

#[test]
fn the_energy_with_data_does_not_contain_the_penalty() {
    let mut one = BoxDomain::<1>::dirichlet(Point::zeros(), Point::repeat(1.0));
    one = one.side(0, 1, BoundaryCondition::Neumann);
    check(&Mesh::kuhn_box(&one, [5]).unwrap(), &schemes());
    let mut two = BoxDomain::<2>::dirichlet(Point::zeros(), Point::repeat(1.0));
    two = two.side(0, 1, BoundaryCondition::Neumann);
    check(&Mesh::kuhn_box(&two, [3, 4]).unwrap(), &schemes());
    let mut three = BoxDomain::<3>::dirichlet(Point::zeros(), Point::repeat(1.0));
    three = three.side(2, 0, BoundaryCondition::Neumann);
    check(&Mesh::kuhn_box(&three, [2, 2, 2]).unwrap(), &schemes());
}

//! A smooth solution without contact.

use std::f64::consts::PI;

use super::scene::Scene;
use crate::mesh::BoxDomain;
use crate::problem::Problem;
use crate::real::Point;
use crate::scheme::Regularity;

/// Poisson's equation `-Laplace u = D pi^2 u` in the unit box, solved by the product `u` of `sin(pi x_k)`. It has no
/// constraint, and is not in the [`catalogue`](super::catalogue()).
pub fn sines<const D: usize>() -> Scene<D> {
    let value = |x: &Point<D>| x.iter().map(|x| (PI * x).sin()).product::<f64>();
    let gradient = |x: &Point<D>| {
        Point::from_fn(|k, _| {
            let factor = |(j, x): (usize, &f64)| {
                if j == k { PI * (PI * x).cos() } else { (PI * x).sin() }
            };
            x.iter().enumerate().map(factor).product::<f64>()
        })
    };
    let problem =
        Problem::new().source(move |x| D as f64 * PI * PI * value(x)).exact(value, gradient);
    Scene::new(
        format!("sines-{D}d"),
        BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0)),
        problem,
    )
    .summary("Poisson in the unit box")
    .regularity(Regularity::smooth())
}

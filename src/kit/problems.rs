//! The linear problems on which schemes are tested.

use crate::problem::Problem;
use crate::real::Point;

/// A direction for each number, none of them in a symmetry of the box.
fn direction<const D: usize>(number: usize) -> Point<D> {
    let entries = [0.7, -0.4, 0.5, -0.8, 0.3];
    Point::from_fn(|k, _| entries[(number + 2 * k) % entries.len()])
}

/// A problem with data of every kind and without symmetries. The function given as exact provides
/// boundary data and is not the solution. The load is linear: quadrature rules that are not symmetric
/// in the vertices of a cell integrate it exactly in every numbering.
pub(super) fn rich<const D: usize>() -> Problem<D> {
    let x_along = |x: &Point<D>| direction::<D>(0).dot(x);
    Problem::new()
        .exact(move |x| 1.0 + x_along(x).powi(2), move |x| direction(0) * (2.0 * x_along(x)))
        .coefficient(move |x| 1.0 + 0.5 * x_along(x).sin())
        .reaction(0.7)
        .source(move |x| 1.0 - 2.0 * x_along(x))
}

/// A problem whose solution is a polynomial of this degree, a sum of powers of different linear
/// functions.
pub(super) fn polynomial<const D: usize>(degree: usize) -> Problem<D> {
    let alpha = 2.5;
    let at = |m: usize, x: &Point<D>| direction::<D>(m).dot(x);
    let value = move |x: &Point<D>| (0..=degree).map(|m| at(m, x).powi(m as i32)).sum();
    let gradient = move |x: &Point<D>| {
        let term = |m: usize| direction(m) * (m as f64 * at(m, x).powi(m as i32 - 1));
        (1..=degree).map(term).fold(Point::zeros(), |s, g| s + g)
    };
    let problem = Problem::new().exact(value, gradient).coefficient(move |_| alpha);
    if degree < 2 {
        return problem;
    }
    problem.source(move |x| {
        let term = |m: usize| {
            let factor = (m * (m - 1)) as f64 * direction::<D>(m).norm_squared();
            factor * at(m, x).powi(m as i32 - 2)
        };
        -alpha * (2..=degree).map(term).sum::<f64>()
    })
}

/// A smooth solution that is no polynomial: an exponential, largest at the upper corner.
pub(super) fn smooth<const D: usize>() -> Problem<D> {
    let value = |x: &Point<D>| direction::<D>(0).dot(x).exp();
    Problem::new()
        .exact(value, move |x| direction(0) * value(x))
        .source(move |x| -direction::<D>(0).norm_squared() * value(x))
}

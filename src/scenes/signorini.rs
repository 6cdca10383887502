//! Signorini conditions with homogeneous Dirichlet data: the singularity `r^{3/2}` under a polynomial.

use crate::problem::{Exact, Problem};
use crate::real::Point;
use crate::scenes::{BoxDomain, Regularity, Scene, halfplane};

/// Signorini problem with zero Dirichlet data and zero gap on `(-1, 1) x (0, 1)`; contact changes
/// at the origin, a vertex of every mesh with an even number of cells along the contact side.
///
/// This is the problem class of Zeng, Chen and Wang, *Comput. Math. Appl.* 69 (2015); the solution
/// is derived at `transition_at`.
pub fn signorini_2d() -> Scene<2> {
    transition_at(0.0, "signorini-2d", "Signorini, zero Dirichlet data, contact changes at x = 0")
}

/// The Signorini problem whose contact changes at `(c, 0)`, `-1 < c < 1`.
///
/// With the harmonic `w = Re (x - c + iy)^{3/2}` and `q = (1 - x^2)(1 - y^2)` the solution is
/// `u = q w`, with load `f = -Laplace u = -(w Laplace q + 2 grad q . grad w)`, bounded.
///
/// *Dirichlet sides*: `q = 0`. *Contact side*: there `dq/dy = 0` and `q >= 0`, so `u = q w` and
/// `sigma = -du/dy = -q dw/dy`. For `x > c`: `w = (x - c)^{3/2} > 0` and `dw/dy = 0`, the open
/// part. For `x < c`: `w = 0` and `-dw/dy = (3/2)(c - x)^{1/2} > 0`, contact. So `u >= 0`,
/// `sigma >= 0` and `u sigma = 0`. *Regularity*: `r^{3/2}` in two dimensions lies in `H^s` for
/// `s < 5/2`, the best that a change of contact generically admits.
fn transition_at(c: f64, name: &str, summary: &'static str) -> Scene<2> {
    let harmonic = move |x: &Point<f64, 2>| {
        let (w, [wx, wy]) = halfplane::three_halves(halfplane::point(x[0] - c, x[1]));
        (w, Point::<f64, 2>::new(wx, wy))
    };
    let source = move |x: &Point<f64, 2>| {
        let (w, grad_w) = harmonic(x);
        let (_, grad_q, laplace_q) = bubble(x);
        -(w * laplace_q + 2.0 * grad_q.dot(&grad_w))
    };
    let gradient = move |x: &Point<f64, 2>| {
        let (w, grad_w) = harmonic(x);
        let (q, grad_q, _) = bubble(x);
        grad_w * q + grad_q * w
    };
    let exact = Exact::new(move |x| bubble(x).0 * harmonic(x).0, gradient)
        .with_multiplier(move |x| 1.5 * (1.0 - x[0] * x[0]) * (c - x[0]).max(0.0).sqrt())
        .with_contact(move |x| c - x[0], vec![Point::from([c, 0.0])]);
    Scene {
        name: name.into(),
        summary,
        domain: BoxDomain::above_contact(),
        problem: Problem::new().source(source).signorini(|_| 0.0).solved_by(exact),
        regularity: Regularity { sobolev: 2.5, strictly_complementary: true },
    }
}

/// `(1 - x^2)(1 - y^2)`, its gradient and its Laplacian.
fn bubble(x: &Point<f64, 2>) -> (f64, Point<f64, 2>, f64) {
    let (p, q) = (1.0 - x[0] * x[0], 1.0 - x[1] * x[1]);
    (p * q, Point::<f64, 2>::new(-2.0 * x[0] * q, -2.0 * x[1] * p), -2.0 * (p + q))
}

//! The generic singularity of a Signorini problem, without load.

use super::dual_number::DualNumber;
use super::free_boundary;
use super::scene::{Scene, zero_gap};
use crate::mesh::BoxDomain;
use crate::problem::Exact;
use crate::real::Point;
use crate::scheme::Regularity;

/// Signorini problem without load on `(-1, 1)^(D-1) x (0, 1)`, `D` = 2 or 3, zero gap; contact
/// changes at the origin (2D) or along the line where first and last coordinate vanish (3D).
///
/// Let `x` be the first and `z` the last coordinate, `r`, `theta` polar coordinates of `(x, z)`.
/// The solution is `u = Re (x + iz)^{3/2} = r^{3/2} cos(3 theta/2)`, in 3D the same in every plane
/// of constant middle coordinate.
///
/// *Equation*: `u` is harmonic, `f = 0`. *Contact side* `z = 0`, where
/// `sigma = -du/dz = (3/2) r^{1/2} sin(theta/2)`: for `x >= 0`, `theta = 0`, `u = x^{3/2} >= 0` and
/// `sigma = 0`; for `x < 0`, `theta = pi`, `u = 0` and `sigma = (3/2) |x|^{1/2} > 0`. Value and
/// gradient are continuous up to the tip, where both vanish. *Regularity*: `H^s` for `s < 5/2`.
pub fn signorini_harmonic<const D: usize>() -> Scene<D> {
    const { assert!(D == 2 || D == 3, "a contact boundary needs two or three dimensions") };
    let power = |x: &Point<D>| DualNumber::three_halves(x, 0.0, 1.0);
    let exact = Exact::new(move |x| power(x).value, move |x| power(x).gradient)
        .with_multiplier(|x| 1.5 * (-x[0]).max(0.0).sqrt())
        .with_contact(|x| -x[0], free_boundary::transition_at(0.0));
    let problem = zero_gap().solved_by(exact);
    Scene::new(format!("signorini-harmonic-{D}d"), BoxDomain::above_contact(), problem)
        .summary("Signorini without load, the harmonic function r^(3/2) cos(3 theta/2)")
        .regularity(Regularity::new(2.5))
}

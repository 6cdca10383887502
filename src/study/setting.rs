//! The assumptions of the proofs of orders.

use crate::mesh::{BoundaryCondition, Domain};
use crate::scenes::Scene;
use crate::scheme::Setting;

/// The setting of a scene; of a mesh it is not known whether its domain is convex.
pub(super) fn setting<const D: usize>(scene: &Scene<D>) -> Setting {
    let Scene { problem, domain, .. } = scene;
    let is_convex = !matches!(domain, Domain::LShape { .. } | Domain::Mesh(_));
    let all_dirichlet = ![BoundaryCondition::Neumann, BoundaryCondition::Contact]
        .iter()
        .any(|&p| domain.has_condition(p));
    let has_coefficient = problem.coefficient.is_given() || problem.tensor.is_given();
    Setting {
        dimension: D,
        obstacle: problem.has_obstacle(),
        contact: problem.has_gap(),
        friction: problem.friction.is_given(),
        regularity: scene.regularity,
        coefficient: has_coefficient,
        regular_dual: !has_coefficient && (D == 1 || is_convex && all_dirichlet),
    }
}

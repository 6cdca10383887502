//! Schemes and problems for parts of meshes.

use crate::error_bounds::Incomplete;
use crate::support::schemes::Entry;
use std::sync::Arc;
use unilateral::constraint::{CONSTRAINT_SETS, constraint_set_by_name};
use unilateral::prelude::*;

/// Incomplete interior penalty by a form of its own, on any element: broken ones, and ones that share unknowns.
pub struct OwnScheme<E>(pub E);

impl<const D: usize, E: Element<D> + Copy + 'static> Scheme<D> for OwnScheme<E> {
    fn name(&self) -> &str {
        "own"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(self.0)
    }
    fn dirichlet(&self) -> DirichletBy {
        DirichletBy::FacetForm
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(Incomplete(10.0))
    }
}

/// Every scheme of the catalogue with every constraint set that its element has, an over-penalty that reads
/// the mesh size, lifts of full degree, and schemes of one's own.
pub fn schemes<const D: usize>() -> Vec<Entry<D>> {
    let named = ["wopsip@weight=anisotropic", "ldg@lifts=full", "br2@lifts=full"];
    let named = NamedScheme::list(named).unwrap();
    let mut found: Vec<Entry<D>> = Vec::new();
    for named in NamedScheme::all().into_iter().chain(named) {
        for (name, _) in CONSTRAINT_SETS.iter().filter(|set| set.0 != "vertices") {
            let (scheme, set) = (named.make(), constraint_set_by_name(name).unwrap());
            if scheme.constraint_on(&set).is_some() {
                found.push(Entry { scheme, set });
            }
        }
    }
    let own: [Box<dyn Scheme<D>>; 4] = [
        Box::new(OwnScheme(Broken::<P1>::default())),
        Box::new(OwnScheme(P1)),
        Box::new(OwnScheme(P2)),
        Box::new(OwnScheme(CrouzeixRaviart)),
    ];
    found.extend(own.into_iter().map(|scheme| Entry { scheme, set: Arc::new(Nodes) }));
    found
}

fn wave<const D: usize>(x: &Point<D>) -> f64 {
    (0..D).map(|k| (k + 1) as f64 * x[k]).sum()
}

/// An obstacle from below, one from above, a coefficient that varies, and data of an exact solution.
pub fn obstacle_problem<const D: usize>() -> Problem<D> {
    Problem::new()
        .coefficient(|x: &Point<D>| 1.0 + 0.5 * wave(x).sin())
        .source(|x| -4.0 + wave(x).cos())
        .obstacle_below(|x: &Point<D>| -0.1 - 0.2 * x.norm_squared())
        .obstacle_above(|x: &Point<D>| 3.0 + 0.1 * x[0])
        .exact(
            |x| 1.5 + 0.5 * wave(x).sin(),
            |x| Point::from_fn(|k, _| 0.5 * (k + 1) as f64 * wave(x).cos()),
        )
}

/// A gap on the contact boundary, reaction, Neumann and Dirichlet data; none from which a constant would be taken, as it
/// is not on parts.
pub fn signorini_problem<const D: usize>() -> Problem<D> {
    Problem::new()
        .constant_source(-2.0)
        .reaction(|x: &Point<D>| 1.0 + x[0] * x[0])
        .dirichlet(|x| 0.3 * wave(x).sin())
        .neumann(|x, normal| 0.7 + wave(x).sin() * normal.sum())
        .signorini(|x: &Point<D>| -0.5 - 0.1 * wave(x).sin())
}

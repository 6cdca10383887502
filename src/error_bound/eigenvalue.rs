//! A proven lower bound of the first eigenvalue of a mesh, for domains of any shape.
//!
//! Let `lambda` be the least value of `|grad u|^2 / |u|^2` among functions that vanish on the Dirichlet boundary, and
//! `lambda_h` that among Crouzeix-Raviart functions `w`, with the gradient in each cell, whose means vanish on Dirichlet
//! facets. Then, with the largest diameter `H` of a cell in `n` dimensions,
//!
//! ```text
//! 1 / lambda <= 1 / lambda_h + kappa^2 H^2,   kappa^2 = 1 / pi^2 + 1 / (2 n (n + 1) (n + 2))
//! ```
//!
//! *Proof.* Let `w` have the means of `u` on all facets. Then `grad w` is in each cell the mean of `grad u`, and `f = u - w`
//! has the norm `|grad f|^2 = |grad u|^2 - |grad w|^2`. In a cell `K` with the mean `m` of its points the divergence theorem
//! for `f (x - m)` gives `n int f = -int grad f . (x - m)`, since `(x - m) . n` is constant on each facet; with
//! `|x - m|_K^2 <= |K| n h^2 / (2 (n + 1) (n + 2))` the mean of `f` has at most the norm `h (2 n (n + 1) (n + 2))^-1/2 |grad
//! f|_K`, and `f` less its mean at most `h / pi |grad f|_K`. Hence `|u| <= lambda_h^-1/2 |grad w| + kappa H |grad f|`, and the
//! inequality of Cauchy and Schwarz gives the sentence. □
//!
//! Sources: C. Carstensen, J. Gedicke, Math. Comp. 83 (2014), 2605-2629; C. Carstensen, S. Puttkammer, Numer. Math. 153
//! (2023), for the constant.

use std::f64::consts::PI;

use crate::algebra::Bound;
use crate::assemble::{DataQuadrature, Discretisation};
use crate::error::Error;
use crate::instances::compiled;
use crate::linear::is_positive_definite;
use crate::mesh::{BoundaryCondition, Mesh};
use crate::problem::Problem;
use crate::scheme::NonconformingP1;

/// On larger meshes the factors would take longer than a solve.
const MOST_UNKNOWNS: usize = 200_000;

/// Numbers tried, each half the one before; the first is above the eigenvalue of a box that is held all around.
const MOST_TRIALS: usize = 24;

/// A proven lower bound of the least `|grad u|^2 / |u|^2` among functions on a mesh that vanish on its Dirichlet boundary, at
/// least half of what Crouzeix-Raviart elements on the mesh prove: a number is below their eigenvalue if the matrix of
/// gradients less that number times the matrix of values has a Cholesky factor. None without a Dirichlet boundary, on a
/// part of a mesh, and for more than 200,000 facets.
///
/// # Errors
/// [`Error::NotEnoughMemory`] and those of assembly.
pub fn least_eigenvalue<const D: usize>(mesh: &Mesh<D>) -> Result<Option<f64>, Error> {
    compiled!(const D: fn(&Mesh<D>) -> Result<Option<f64>, Error> = find)(mesh)
}

fn find<const D: usize>(mesh: &Mesh<D>) -> Result<Option<f64>, Error> {
    if !mesh.has_condition(BoundaryCondition::Dirichlet) || mesh.is_part() {
        return Ok(None);
    }
    let problems = [Problem::new(), Problem::new().reaction(-1.0)];
    let on =
        |problem| Discretisation::new(&NonconformingP1, problem, mesh, DataQuadrature::default());
    let [gradients, difference] = [on(&problems[0])?, on(&problems[1])?];
    if gradients.unknowns() > MOST_UNKNOWNS {
        return Ok(None);
    }
    let bounds = gradients.bounds()?;
    let free: Vec<u32> =
        (0..).zip(&bounds).filter(|(_, b)| !matches!(b, Bound::Fixed(_))).map(|(i, _)| i).collect();
    let (gradients, difference) = (gradients.matrix(), difference.matrix());
    let mut shifted = gradients.clone();
    let mut is_below = |number: f64| {
        let entries = gradients.values.iter().zip(&difference.values);
        for (entry, (of_gradients, less)) in shifted.values.iter_mut().zip(entries) {
            *entry = of_gradients - number * (of_gradients - less);
        }
        is_positive_definite(&shifted, true, &free)
    };
    let mut number = 4.0 * D as f64 * (PI / mesh.domain_diameter()).powi(2);
    for _ in 0..MOST_TRIALS {
        match is_below(number) {
            Ok(true) => {
                let n = D as f64;
                let kappa = 1.0 / (PI * PI) + 1.0 / (2.0 * n * (n + 1.0) * (n + 2.0));
                let cells = (0..mesh.n_cells()).map(|cell| mesh.cell_diameter(cell));
                let diameter = cells.fold(0.0, f64::max);
                return Ok(Some(1.0 / (1.0 / number + kappa * diameter * diameter)));
            }
            Ok(false) => number *= 0.5,
            // too large a mesh for its factors
            Err(_) => return Ok(None),
        }
    }
    Ok(None)
}

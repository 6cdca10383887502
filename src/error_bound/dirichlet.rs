//! Fluxes through Dirichlet facets of cells in contact.

use super::contact::NodeForce;
use crate::assemble::space::Space;
use crate::mesh::BoundaryPart;
use crate::real::Real;

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// Exchanges multipliers of broken linears for fluxes through Dirichlet facets.
    ///
    /// Where an obstacle binds the unknowns beside a Dirichlet facet, its multiplier may carry the flux through
    /// the facet: the jump is then zero, and so is the flux of an over-penalty. Neither the flux nor the
    /// multiplier is determined there, only their sum, by the balance of the cell. The flux is moved towards
    /// that of the discrete function as far as the multiplier of the cell keeps its sign and does not grow, which
    /// makes both parts of the bound smaller.
    pub(super) fn exchange_with_dirichlet(
        &self,
        u: &[T],
        residual: &[f64],
        forces: &[NodeForce],
        flux: &mut [f64],
    ) {
        let mut multipliers: Vec<f64> =
            residual.chunks_exact(D + 1).map(|r| -r.iter().sum::<f64>()).collect();
        for force in forces {
            multipliers[force.cell] -= force.value;
        }
        for f in self.mesh.boundary().iter().filter(|f| f.part == BoundaryPart::Dirichlet) {
            let (cell, local) = (f.cell as usize, usize::from(f.local));
            let (flux, left) = (&mut flux[cell * (D + 1) + local], &mut multipliers[cell]);
            let exchange =
                (self.discrete_flux(cell, local, u) - *flux).clamp(left.min(0.0), left.max(0.0));
            *flux += exchange;
            *left -= exchange;
        }
    }

    /// The integral of `alpha grad u_h . n` of linears over a facet of a cell.
    fn discrete_flux(&self, cell: usize, local: usize, u: &[T]) -> f64 {
        let gradient = self.gradient_factor().map_or(1.0, Real::to_f64);
        let (metric, values) = (self.metric(cell), self.local_values(cell, u));
        let product = |j: usize| metric.products[local][j].to_f64() * (values[j] - values[0]);
        // the gradient of a barycentric coordinate is minus the normal, times the measure over `D |K|`
        -(D as f64) * gradient * self.alpha(cell).to_f64() * (0..=D).map(product).sum::<f64>()
    }
}

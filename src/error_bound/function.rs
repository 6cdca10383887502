//! The admissible function of a discrete solution.

use crate::assemble::space::Space;
use crate::mesh::BoundaryPart;
use crate::real::{Real, point_f64};

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// The values of the admissible function at vertices.
    pub(super) fn admissible_values(&self, u: &[T]) -> Vec<f64> {
        let n_vertices = self.mesh.vertices().len();
        let values = self.vertex_values(u);
        let mut sums = vec![(0.0, 0.0); n_vertices];
        let mut bounds = vec![(f64::NEG_INFINITY, f64::INFINITY); n_vertices];
        for (cell, values) in values.chunks_exact(D + 1).enumerate() {
            let alpha = self.alpha(cell).to_f64();
            let region = self.mesh.region(cell);
            let (lower, upper) = (self.data.lower.of(region), self.data.upper.of(region));
            for (&v, value) in self.mesh.cell(cell).iter().zip(values) {
                let (sum, weight) = &mut sums[v as usize];
                *sum += alpha * value;
                *weight += alpha;
                let x = point_f64(&self.mesh.vertices()[v as usize]);
                let (low, high) = &mut bounds[v as usize];
                *low = lower.map_or(*low, |psi| psi.at(&x).max(*low));
                *high = upper.map_or(*high, |psi| psi.at(&x).min(*high));
            }
        }
        for ((cell, local), group) in self.grouped_facets_of(BoundaryPart::Contact) {
            let Some(gap) = self.data.gap.of(group) else { continue };
            for v in self.mesh.facet_vertices(cell, local) {
                let x = point_f64(&self.mesh.vertices()[v as usize]);
                let low = &mut bounds[v as usize].0;
                *low = low.max(gap.at(&x));
            }
        }
        let groups = self.dirichlet_groups();
        let value = |(v, (sum, weight)): (usize, (f64, f64))| match groups[v] {
            Some(group) => self.dirichlet_at(group, &point_f64(&self.mesh.vertices()[v])),
            None => (sum / weight).min(bounds[v].1).max(bounds[v].0),
        };
        sums.into_iter().enumerate().map(value).collect()
    }
}

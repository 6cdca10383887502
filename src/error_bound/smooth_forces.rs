//! Contact forces of broken quadratics, made smooth: those at single nodes alternate, and jumps hardly see it.

use super::contact_forces::NodeForce;
use super::quadratics::{Products, densities, products_on_facet, vertices_of};
use crate::arrays::map_entries;
use crate::assemble::space::{Place, Space};
use crate::real::Real;

/// A smaller share of smooth contact forces is none.
const LEAST_SHARE: f64 = 1e-3;

/// Passes in which shares become smaller before they become zero.
const PASSES: usize = 20;

/// A negative mean below this share of the forces around is rounding.
const ROUNDING: f64 = 1e-13;

/// The contact force around a vertex.
#[derive(Clone, Copy, Default)]
struct VertexForce {
    /// The products of all forces with the hat function.
    sum: f64,
    /// The measure of the facets that share it.
    measure: f64,
    /// Whether these are in contact with all nodes.
    is_closed: bool,
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// Makes contact forces smooth: linear between their means around vertices, and what is then left of
    /// their products with hat functions divided among the contact facets at the vertex by their measures. In the
    /// plane a vertex at the end of contact has its force on that facet alone that is in contact with all nodes.
    /// Where the mean over a facet would become negative, forces around its vertices become less smooth. The
    /// products are those of the forces, facet by facet.
    pub(super) fn smooth_forces(&self, forces: &[NodeForce], contact: &mut [(Place, Products)]) {
        let vertex = |place: Place, k: usize| self.mesh.cell(place.0)[k] as usize;
        let closed = self.closed_facets(forces);
        let around = self.forces_around_vertices(contact, &closed);
        let part = |place: Place, is_closed: bool, k: usize| {
            let around = &around[vertex(place, k)];
            match is_closed == around.is_closed {
                true => self.facet_measure(place) / around.measure,
                false => 0.0,
            }
        };
        let mut left: Vec<f64> = around.iter().map(|force| force.sum).collect();
        let mut smooth = vec![[0.0; 4]; contact.len()];
        for (((place, _), &is_closed), moments) in contact.iter().zip(&closed).zip(&mut smooth) {
            let mut values = [0.0; 4];
            for k in vertices_of::<D>(place.1) {
                let sum = around[vertex(*place, k)].sum;
                values[k] = D as f64 * sum * part(*place, is_closed, k);
            }
            let products = products_on_facet::<D>(&values, place.1);
            *moments = map_entries(products, |row| row.iter().sum());
            vertices_of::<D>(place.1).for_each(|k| left[vertex(*place, k)] -= moments[k]);
        }
        // the share of the smooth products at each vertex: any share keeps the sum of the products
        let mut shares = vec![1.0; left.len()];
        for pass in 0.. {
            let mut is_done = true;
            for (((place, products), &is_closed), smooth) in
                contact.iter_mut().zip(&closed).zip(&smooth)
            {
                let (mut moments, mut divided) = (*smooth, 0.0);
                for k in vertices_of::<D>(place.1) {
                    let (v, part) = (vertex(*place, k), part(*place, is_closed, k));
                    let rough = around[v].sum * part;
                    let smooth = moments[k] + left[v] * part;
                    moments[k] = rough + shares[v] * (smooth - rough);
                    divided += rough;
                }
                let mean: f64 = moments.iter().sum();
                if mean < -ROUNDING * divided {
                    // with this factor of the shares the mean vanishes
                    let factor = if pass < PASSES { divided / (divided - mean) } else { 0.0 };
                    for k in vertices_of::<D>(place.1) {
                        let share = &mut shares[vertex(*place, k)];
                        is_done &= *share == 0.0;
                        *share = if *share * factor > LEAST_SHARE { *share * factor } else { 0.0 };
                    }
                }
                *products = products_on_facet::<D>(&densities::<D>(&moments, place.1), place.1);
            }
            if is_done {
                return;
            }
        }
    }

    /// Whether each facet with forces has all its nodes in contact, of a vertex a node of any cell. In space every
    /// facet counts as one of these: many facets lie around the end of contact, and few are in contact whole.
    fn closed_facets(&self, forces: &[NodeForce]) -> Vec<bool> {
        let mut touches = vec![false; self.mesh.vertices().len()];
        for force in forces.iter().filter(|force| force.node <= D) {
            touches[self.mesh.cell(force.cell)[force.node] as usize] = true;
        }
        let is_closed = |of_facet: &[NodeForce]| {
            let NodeForce { cell, local, .. } = of_facet[0];
            let touches = |node: usize| node <= D && touches[self.mesh.cell(cell)[node] as usize];
            self.bounded_nodes_on(local)
                .all(|(node, _)| touches(node) || of_facet.iter().any(|force| force.node == node))
        };
        let of_facets = forces.chunk_by(|a, b| (a.cell, a.local) == (b.cell, b.local));
        of_facets.map(|of_facet| D == 3 || is_closed(of_facet)).collect()
    }

    /// The force around each vertex, and the facets that share it: those in contact with all nodes, if there are any.
    fn forces_around_vertices(
        &self,
        contact: &[(Place, Products)],
        closed: &[bool],
    ) -> Vec<VertexForce> {
        let mut around = vec![VertexForce::default(); self.mesh.vertices().len()];
        for ((place, products), &is_closed) in contact.iter().zip(closed) {
            for k in vertices_of::<D>(place.1) {
                let force = &mut around[self.mesh.cell(place.0)[k] as usize];
                force.sum += products[k].iter().sum::<f64>();
                if is_closed && !force.is_closed {
                    (force.measure, force.is_closed) = (0.0, true);
                }
                if is_closed == force.is_closed {
                    force.measure += self.facet_measure(*place);
                }
            }
        }
        around
    }
}

//! Contact forces of quadratics, exchanged along facets and between them.
//!
//! On a contact facet `F` the normal flux is the contact force, which must not be negative. A number that is added to
//! the density `c_Fj` at one vertex and taken from the density at another keeps the force of the facet; taken from
//! `c_jj` and added to its counterpart at the other vertex the number keeps the divergence in the cell. A number taken
//! from the density of a contact facet at a vertex may also leave through another facet at that vertex, and through
//! those of further cells around the vertex, until it comes to another contact facet there: divergences at a vertex
//! depend on the sum of its densities. What changes is the mismatch, and the complementarity of the contact force.
//!
//! Without it the effectivity of `sipg-p2` on signorini-harmonic-2d at 32 is 2.28 in place of 1.52, that of `p2` on
//! signorini-line-3d at 8 is 1.75 in place of 1.45.

use super::cells_of_quadratics::CellsOfQuadratics;
use crate::arrays::map_entries;
use crate::assemble::space::Space;
use crate::error_bound::PrimalDualPair;
use crate::error_bound::flux::{Flux, share_of_one_sign};
use crate::error_bound::quadratics::vertices_of;
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbour, Neighbours};
use crate::parallel::vectors::indices;
use crate::quadrature::facet_to_cell;

/// Visits of each pair of vertices of each facet.
const SWEEPS: usize = 4;

/// The largest number of cells between two contact facets that exchange forces.
const LONGEST: usize = 3;

/// A contact facet.
struct ContactFacet {
    /// The cell among those of the exchange, and the number of the facet in it.
    at: HalfFacet,
    /// The mean distances from the gap times barycentric coordinates.
    gaps: [f64; 4],
    /// By how much a force of the other sign counts: the factor of the root of the sum of the squares of its values at
    /// the vertices.
    variation: f64,
    /// Whether the force is nowhere negative.
    has_one_sign: bool,
}

/// Sorts facets by cell and number. Not in the function that calls it, so that this is compiled once.
fn sort(facets: &mut [ContactFacet]) {
    facets.sort_unstable_by_key(|facet| facet.at);
}

/// The facets and cells around a vertex.
#[derive(Clone, Copy)]
struct Around<'f> {
    /// The contact facets, sorted, and the number of that where chains begin.
    facets: &'f [ContactFacet],
    here: usize,
    /// The numbers of the cells of the exchange in the mesh.
    numbers: &'f [u32],
    neighbours: &'f Neighbours,
    vertex: u32,
}

impl<const D: usize> CellsOfQuadratics<'_, D> {
    /// Adds to the density of a facet at a vertex, and keeps the divergence.
    fn add_to_force(&mut self, (k, local): HalfFacet, vertex: usize, change: f64) {
        let flux = &mut self.cells[k].flux;
        flux[Flux::<D>::place(local, vertex)] += change;
        flux[Flux::<D>::place(vertex, vertex)] -= change;
    }

    /// The density of a facet at a vertex.
    fn force(&self, (k, local): HalfFacet, vertex: usize) -> f64 {
        self.cells[k].flux[Flux::<D>::place(local, vertex)]
    }

    /// Moves a contact force towards its mean until the force is nowhere negative. The force stays as it is if the
    /// mismatch would grow by more than the negative multiplier counts for.
    fn make_force_positive(&mut self, facet: &mut ContactFacet) {
        let at = facet.at;
        let mean = vertices_of::<D>(at.1).map(|j| self.force(at, j)).sum::<f64>() / D as f64;
        let mut values = [mean; 4];
        vertices_of::<D>(at.1).for_each(|j| values[j] = self.force(at, j));
        let share = share_of_one_sign(mean, &values[..=D]);
        facet.has_one_sign = mean >= 0.0;
        if share == 1.0 || mean < 0.0 {
            return;
        }
        let squares: f64 = values[..=D].iter().map(|c| (c - mean).powi(2)).sum();
        let of_negative = (1.0 - share) * facet.variation * squares.sqrt();
        let limit = (self.mismatch(at.0).sqrt() + of_negative).powi(2);
        let changes = values.map(|c| (1.0 - share) * (mean - c));
        vertices_of::<D>(at.1).for_each(|j| self.add_to_force(at, j, changes[j]));
        if self.mismatch(at.0) > limit {
            vertices_of::<D>(at.1).for_each(|j| self.add_to_force(at, j, -changes[j]));
            facet.has_one_sign = false;
        }
    }

    /// Exchanges the contact force of a facet between two of its vertices.
    fn exchange_force(&mut self, facet: &ContactFacet, [a, b]: [usize; 2]) {
        let (k, local) = facet.at;
        let terms = [
            (k, local * (D + 1) + a, 1.0),
            (k, local * (D + 1) + b, -1.0),
            (k, a * (D + 2), -1.0),
            (k, b * (D + 2), 1.0),
        ];
        let [slope, curvature] = self.slopes(&terms, facet.gaps[a] - facet.gaps[b]);
        let (most, fewest) = (self.force(facet.at, b), -self.force(facet.at, a));
        let change = (-slope / curvature).min(most.max(0.0)).max(fewest.min(0.0));
        if change.is_finite() {
            self.add_to_force(facet.at, a, change);
            self.add_to_force(facet.at, b, -change);
        }
    }

    /// Exchanges the contact forces of two facets at a vertex, along a chain of cells: numbers with alternating signs,
    /// two for each cell.
    fn exchange_along(&mut self, chain: &[(usize, usize, f64)], [gap, gap_of_last]: [f64; 2]) {
        let of = |(k, number, _): (usize, usize, f64)| self.cells[k].flux[number];
        let ends = [chain[0], chain[chain.len() - 1]];
        let [first, last] = map_entries(ends, |end| of(end).max(0.0));
        let [slope, curvature] = self.slopes(chain, gap_of_last - gap);
        let change = (-slope / curvature).min(first).max(-last);
        if change.is_finite() {
            for &(k, number, sign) in chain {
                self.cells[k].flux[number] += sign * change;
            }
        }
    }
}

impl<const D: usize> Space<'_, D> {
    /// Changes the contact forces of quadratics along facets, as far as that makes the bound smaller.
    pub(in crate::error_bound) fn exchange_forces(
        &self,
        pair: &mut PrimalDualPair<D>,
        neighbours: &Neighbours,
    ) {
        let facets: Vec<(HalfFacet, usize)> =
            self.grouped_facets_of(BoundaryCondition::Contact).collect();
        let mut touches = vec![false; self.mesh.vertices().len()];
        for ((cell, local), _) in &facets {
            self.mesh.facet_vertices(*cell, *local).for_each(|v| touches[v as usize] = true);
        }
        let touches = |cell: usize| self.mesh.cell(cell).iter().any(|&v| touches[v as usize]);
        let numbers = indices(self.mesh.n_cells(), touches);
        let mut of_numbers = self.cells_of_quadratics(&numbers, |_| [0.0; 4], pair);
        let products = self.products_of_fluxes(&numbers);
        let mut cells = CellsOfQuadratics::new(&mut of_numbers, &products, 0);
        let in_contact = |&(facet, group): &(HalfFacet, usize)| {
            let gap = self.data.gap.of(group)?;
            let admissible = self.admissible_in(pair, facet.0);
            let mut gaps = [0.0; 4];
            for (point, weight) in self.facet_rule.iter() {
                let x = self.facet_point(point, facet.0, facet.1);
                let point = facet_to_cell(point, facet.1);
                let distance = (admissible.at(&point, &x).0 - self.at(gap, facet.0, &x)).max(0.0);
                gaps.iter_mut().zip(&point).for_each(|(gap, b)| *gap += weight * distance * b);
            }
            let alpha = self.alpha(facet.0);
            let measure = self.facet_measure(facet);
            let square = (measure * alpha * (D * (D + 1)) as f64).recip();
            let cell = numbers.binary_search(&(facet.0 as u32));
            Some(ContactFacet {
                at: (cell.expect("cells of contact facets are numbered"), facet.1),
                gaps,
                variation: self.constant_of_trace(facet) * square.sqrt(),
                has_one_sign: false,
            })
        };
        let mut facets: Vec<ContactFacet> = facets.iter().filter_map(in_contact).collect();
        sort(&mut facets);
        facets.iter_mut().for_each(|facet| cells.make_force_positive(facet));
        facets.retain(|facet| facet.has_one_sign);
        for _ in 0..SWEEPS {
            for (here, facet) in facets.iter().enumerate() {
                for j in vertices_of::<D>(facet.at.1) {
                    let vertex = self.mesh.cell(numbers[facet.at.0] as usize)[j];
                    let around =
                        Around { facets: &facets, here, numbers: &numbers, neighbours, vertex };
                    let mut chain = [(0, 0, 0.0); 2 * LONGEST];
                    chain[0] = (facet.at.0, facet.at.1 * (D + 1) + j, -1.0);
                    self.follow(&mut cells, &around, &mut chain, (facet.at, 1));
                }
                for a in vertices_of::<D>(facet.at.1) {
                    for b in vertices_of::<D>(facet.at.1).filter(|&b| b > a) {
                        cells.exchange_force(facet, [a, b]);
                    }
                }
            }
        }
        pair.flux.replace_in(&numbers, |k| &of_numbers[k].flux);
    }

    /// Follows a chain of cells around a vertex through all facets there but that by which it came to the last of its
    /// cells, and exchanges the contact force at its end with that at its beginning.
    fn follow(
        &self,
        cells: &mut CellsOfQuadratics<'_, D>,
        around: &Around<'_>,
        chain: &mut [(usize, usize, f64); 2 * LONGEST],
        ((k, entered), length): (HalfFacet, usize),
    ) {
        let Around { facets, here, numbers, neighbours, vertex } = *around;
        let corner = |cell: u32| self.mesh.number_in(cell as usize, vertex);
        let j = corner(numbers[k]);
        for local in (0..D + 1).filter(|&local| local != j && local != entered) {
            chain[2 * length - 1] = (k, local * (D + 1) + j, 1.0);
            match neighbours.across(numbers[k] as usize, local) {
                Neighbour::Boundary(_) | Neighbour::Cut => {
                    let last = facets.binary_search_by_key(&(k, local), |facet| facet.at);
                    if let Some(last) = last.ok().filter(|&last| last > here) {
                        let gaps = map_entries([here, last], |facet| {
                            let facet = &facets[facet];
                            facet.gaps[corner(numbers[facet.at.0])]
                        });
                        cells.exchange_along(&chain[..2 * length], gaps);
                    }
                }
                Neighbour::Cell { cell, local: entered } if length < LONGEST => {
                    let next = numbers.binary_search(&cell);
                    let next = next.expect("all cells at a vertex of a contact facet are numbered");
                    let entered = usize::from(entered);
                    chain[2 * length] = (next, entered * (D + 1) + corner(cell), -1.0);
                    self.follow(cells, around, chain, ((next, entered), length + 1));
                }
                Neighbour::Cell { .. } => {}
            }
        }
    }
}

//! Multipliers exchanged for flux between cells in contact.
//!
//! Where an obstacle binds the unknowns of two neighbouring cells, the multipliers of the two may carry a share of the
//! flux through their facet: the sum of both is determined by the discrete equations, its division is not, and
//! over-penalties have no flux where jumps vanish. A number `e` added to the flux from `K` to `K'`, taken from
//! the multiplier of `K` and given to that of `K'`, keeps the balance of both cells. The square of the bound
//! is a quadratic polynomial in `e`,
//!
//! ```text
//! |alpha^-1/2 (alpha grad v - q)|^2 over K and K' + 2 (|mu|, distance of v from the obstacle) over K and K'
//! ```
//!
//! Facet by facet the least value is taken, among those numbers that keep the signs of both multipliers. Through a
//! Dirichlet facet the flux is free, and `K` is alone. Cells beside those in contact count, too: their multipliers
//! may grow, if the distance costs less than the mismatch. Each facet is visited four times, for quadratics eight times:
//! the mass matrix of fluxes has a condition that does not grow with the number of cells. With two visits the bound of
//! `wopsip-p2` on torsion-2d is a fifth larger, with four that of `p2` under half an obstacle twice as large. Facets
//! within a chunk of cells are visited on one thread, chunks in parallel, then the facets between chunks: the order depends
//! on the number of cells alone.

mod cells_of_quadratics;
mod forces;
mod linears;
mod quadratics;

use crate::algebra::NO_INDEX;
use crate::assemble::space::Space;
use crate::measure::Counts;
use crate::mesh::{BoundaryCondition, HalfFacet, Neighbour, Neighbours};
use crate::parallel::vectors::{
    chunk_length, flags, for_each_chunk, indices, map_chunks, positions,
};

/// Multipliers below this share of the largest one are rounding.
pub(super) const ROUNDING: f64 = 1e-10;

/// A facet of a cell of an exchange: the number of the cell among these, and that of the facet in it.
#[derive(Clone, Copy)]
struct FacetOfCell {
    cell: u32,
    local: u8,
}

impl FacetOfCell {
    fn half(self) -> HalfFacet {
        (self.cell as usize, self.local.into())
    }
}

/// A step of an exchange. Steps are as many as facets: they are small.
#[derive(Clone, Copy)]
enum ExchangeStep {
    /// Between two cells, through their facet.
    Between([FacetOfCell; 2]),
    /// Through a Dirichlet facet of a cell.
    WithDirichlet(FacetOfCell),
    /// Inside a cell, after its facets.
    Inside(u32),
}

impl ExchangeStep {
    /// The step with its cells counted from the cell with the number `first`.
    fn from(self, first: usize) -> Self {
        let counted =
            |FacetOfCell { cell, local }| FacetOfCell { cell: cell - first as u32, local };
        match self {
            Self::Between(at) => Self::Between(at.map(counted)),
            Self::WithDirichlet(facet) => Self::WithDirichlet(counted(facet)),
            Self::Inside(cell) => Self::Inside(cell - first as u32),
        }
    }

    /// The cells of the step, twice the same one where it has one.
    fn cells(self) -> [usize; 2] {
        match self {
            Self::Between(at) => at.map(|facet| facet.cell as usize),
            Self::WithDirichlet(FacetOfCell { cell, .. }) | Self::Inside(cell) => {
                [cell as usize; 2]
            }
        }
    }
}

/// The steps of an exchange, by the chunks of its cells ([`map_chunks`]).
struct ExchangeSteps {
    /// For each chunk the steps all of whose cells belong to the chunk. Cells of these steps are counted from the first
    /// cell of the chunk.
    within: Vec<Vec<ExchangeStep>>,
    /// The steps between cells of two chunks: few where neighbours have near numbers.
    between: Vec<ExchangeStep>,
}

impl ExchangeSteps {
    /// Visits each step `sweeps` times. `visit` receives consecutive cells, the number of the first one, and a step whose
    /// cells are counted from that one.
    fn visit<C: Send>(
        &self,
        sweeps: usize,
        cells: &mut [C],
        visit: impl Fn(&mut [C], usize, ExchangeStep) + Sync,
    ) {
        let length = chunk_length(cells.len(), 1);
        for _ in 0..sweeps {
            for_each_chunk(cells, |range, cells| {
                let steps = &self.within[range.start / length];
                steps.iter().for_each(|&step| visit(cells, range.start, step));
            });
            self.between.iter().for_each(|&step| visit(cells, 0, step));
        }
    }
}

impl<const D: usize> Space<'_, D> {
    /// The cells of an exchange, those with a multiplier and their neighbours, as far as these count, and its steps, cell
    /// by cell; with those inside cells if asked for.
    fn cells_of_exchange(
        &self,
        presses: &(dyn Fn(usize) -> bool + Sync),
        (neighbours, counts): (&Neighbours, Counts<'_>),
        has_inner_steps: bool,
    ) -> (Vec<u32>, ExchangeSteps) {
        let n_cells = self.mesh.n_cells();
        let is_in_exchange = flags(n_cells, |set| {
            map_chunks(n_cells, |range| {
                for cell in range.filter(|&cell| presses(cell)) {
                    set(cell);
                    for local in 0..=D {
                        if let Neighbour::Cell { cell: other, .. } = neighbours.across(cell, local)
                            && counts(other as usize)
                        {
                            set(other as usize);
                        }
                    }
                }
            });
        });
        let numbers = indices(n_cells, |cell| is_in_exchange[cell]);
        let places = positions(n_cells, &numbers);
        let steps_of = |here: usize, add: &mut dyn FnMut(ExchangeStep)| {
            let cell = numbers[here] as usize;
            for local in 0..=D {
                let facet = FacetOfCell { cell: here as u32, local: local as u8 };
                match neighbours.across(cell, local) {
                    Neighbour::Cell { cell: other, local } => {
                        let there = places[other as usize];
                        if other as usize > cell && there != NO_INDEX {
                            let facet_there = FacetOfCell { cell: there, local };
                            add(ExchangeStep::Between([facet, facet_there]));
                        }
                    }
                    Neighbour::Boundary(BoundaryCondition::Dirichlet) => {
                        add(ExchangeStep::WithDirichlet(facet));
                    }
                    Neighbour::Boundary(_) | Neighbour::Cut => {}
                }
            }
            if has_inner_steps {
                add(ExchangeStep::Inside(here as u32));
            }
        };
        let of_chunks = map_chunks(numbers.len(), |range| {
            // about half a facet for each of a cell, and one step inside
            let capacity = range.len() * (D + 3) / 2;
            let (mut within, mut between) = (Vec::with_capacity(capacity), Vec::new());
            for here in range.clone() {
                steps_of(here, &mut |step| match step.cells().iter().all(|k| range.contains(k)) {
                    true => within.push(step.from(range.start)),
                    false => between.push(step),
                });
            }
            (within, between)
        });
        let (within, between): (Vec<_>, Vec<_>) = of_chunks.into_iter().unzip();
        (numbers, ExchangeSteps { within, between: between.concat() })
    }
}

//! A check of bounds with the data of all parts: do they contradict each other anywhere?

use super::agree::agree_on_data;
use super::error::ExchangeError;
use super::exchange::Exchange;
use crate::assemble::Discretisation;
use crate::assemble::space::contradictions::refuse;
use crate::mesh::Part;

/// Refuses bounds that contradict each other by more than rounding of the largest datum of all parts, as
/// [`Discretisation::bounds`] does on a whole mesh; all parts call it.
///
/// A gap is compared with Dirichlet data where the two boundaries meet. With
/// [`Layers`](crate::mesh::Layers) across facets a part need not have the cells of both.
///
/// # Errors
/// [`ExchangeError::Failed`] in all parts, with the message of the lowest part that owns a cell with a contradiction;
/// cells have their numbers in the whole mesh. Those of the exchange.
pub fn check_bounds<const D: usize>(
    part: &Part<D>,
    discretisation: &Discretisation<'_, D>,
    exchange: &dyn Exchange,
) -> Result<(), ExchangeError> {
    let (found, own_size) = agree_on_data(discretisation.contradictions(), &part.cells, exchange)?;
    let size = exchange.largest(&[own_size])?[0];
    let checked = refuse(&found, size, &part.mesh, &|cell| part.owns(cell));
    agree_on_data(checked, &part.cells, exchange)
}

//! A scheme on a part of a mesh.

use std::sync::Arc;
use std::time::Instant;

use super::over_parts::OverParts;
use crate::algebra::{Inequality, any_part};
use crate::assemble::{DataQuadrature, Discretisation};
use crate::distributed::agree::agree_on_data;
use crate::distributed::check_bounds::check_bounds;
use crate::distributed::error::ExchangeError;
use crate::distributed::exchange::Exchange;
use crate::distributed::numbering::Numbering;
use crate::mesh::Part;
use crate::problem::Problem;
use crate::scheme::Scheme;

/// A scheme applied to a problem on a part of a mesh, with the numbers of its unknowns over all parts.
pub(super) struct System<'a, const D: usize> {
    pub discretisation: Discretisation<'a, D>,
    pub inequality: Inequality<f64>,
    pub over_parts: Arc<OverParts>,
    /// Seconds of assembly, and of the numbers.
    pub seconds: [f64; 2],
}

impl<'a, const D: usize> System<'a, D> {
    /// The system; all parts call it.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts with the error of assembly of the lowest part that has one.
    pub fn new(
        scheme: &dyn Scheme<D>,
        problem: &'a Problem<D>,
        part: &'a Part<D>,
        quadrature: DataQuadrature,
        exchange: &Arc<dyn Exchange>,
    ) -> Result<Self, ExchangeError> {
        let clock = Instant::now();
        let assembled = scheme.discretise(problem, &part.mesh, quadrature).and_then(|mut of| {
            let inequality = of.inequality()?;
            of.forget_prepared();
            Ok((of, inequality))
        });
        let (discretisation, mut inequality) = agree_on_data(assembled, &part.cells, &**exchange)?;
        check_bounds(part, &discretisation, &**exchange)?;
        let in_assembly = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let numbering = Numbering::new(part, &discretisation, &**exchange)?;
        let over_parts = Arc::new(OverParts::new(part.number, numbering, exchange.clone()));
        let is_proven =
            discretisation.penalty_below_bound().is_none() && discretisation.is_coercive();
        inequality.is_definite = !any_part(Some(&*over_parts), !is_proven);
        inequality.distribution = Some(over_parts.clone());
        let seconds = [in_assembly, clock.elapsed().as_secs_f64()];
        Ok(Self { discretisation, inequality, over_parts, seconds })
    }
}

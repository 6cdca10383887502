//! A mesh as a whole, or the part of it that one process has.

use std::sync::Arc;

use crate::error::Error;
use crate::mesh::{Domain, Extent, Mesh, Part, Refinement};
use crate::processes::{Exchange, ExchangeError, agree};
use crate::real::Point;

/// A mesh of a hierarchy, or the part of the mesh that one process has, with the exchange between all processes.
#[derive(Debug)]
pub(super) enum Piece<const D: usize> {
    Whole(Mesh<D>),
    Part(Part<D>, Arc<dyn Exchange>),
}

/// The part of a mesh that one process has, and its exchange with the others.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SharedPart<'a, const D: usize> {
    pub part: &'a Part<D>,
    pub exchange: &'a Arc<dyn Exchange>,
}

impl<const D: usize> Piece<D> {
    /// The uniform refinement, on a domain with new vertices on its boundary; all parts call it.
    pub fn refined(&self, domain: &Domain<D>) -> Result<(Self, Refinement), Error> {
        match self {
            Self::Part(part, exchange) => {
                let (fine, by) = agree(domain.refine_part(part, part.layers), &**exchange)?;
                // the mesh size is that of all parts
                let extent = of_all_parts(Extent::of(&fine.mesh), &**exchange)?;
                Ok((Self::Part(fine.with_extent(extent), exchange.clone()), by))
            }
            Self::Whole(mesh) => {
                let (fine, by) = domain.refine(mesh)?;
                Ok((Self::Whole(fine), by))
            }
        }
    }
    /// The mesh; of a part its own.
    pub fn mesh(&self) -> &Mesh<D> {
        match self {
            Self::Whole(mesh) => mesh,
            Self::Part(part, _) => &part.mesh,
        }
    }
}

/// The extent of the cells of all parts; all parts call it.
fn of_all_parts<const D: usize>(
    mut extent: Extent<D>,
    exchange: &dyn Exchange,
) -> Result<Extent<D>, ExchangeError> {
    let Extent { lower, upper, mesh_size } = &mut extent;
    let ends = [(-*lower).as_slice(), upper.as_slice(), &[*mesh_size]].concat();
    let largest = exchange.largest(&ends)?;
    *lower = -Point::from_column_slice(&largest[..D]);
    *upper = Point::from_column_slice(&largest[D..2 * D]);
    *mesh_size = largest[2 * D];
    Ok(extent)
}

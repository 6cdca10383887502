//! The part of one process of nested meshes.

use std::time::Instant;

use crate::distributed::agree::agree;
use crate::distributed::error::ExchangeError;
use crate::distributed::merge::merge_all;
use crate::distributed::process::Process;
use crate::mesh::{Domain, Extent, Layers, Mesh, Part, Refinement};

/// The part of one process of nested meshes: it has a part of the coarsest mesh, and refines it by itself.
///
/// Every process has the coarsest mesh as a whole, no process any finer one. All processes partition it alike,
/// and the children of a cell belong to the part that owns their parent.
#[derive(Debug)]
pub struct PartHierarchy<const D: usize> {
    parts: Vec<PartOfLevel<D>>,
}

#[derive(Debug)]
struct PartOfLevel<const D: usize> {
    part: Part<D>,
    /// The parents of the vertices in the next coarser part; `None` for the coarsest part.
    refinement: Option<Refinement>,
    /// Seconds for this part and all coarser ones.
    seconds: f64,
}

impl<const D: usize> PartHierarchy<D> {
    /// The part with the number `number` of a mesh and of its uniform refinements, as those of a domain if one
    /// is given; all parts call it.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] for fewer cells than parts, and for more cells than can be numbered.
    pub fn new(
        coarsest: &Mesh<D>,
        domain: Option<&Domain<D>>,
        (refinements, layers): (usize, Layers),
        process: &Process,
    ) -> Result<Self, ExchangeError> {
        let (number, exchange) = (process.number, &process.exchange);
        let clock = Instant::now();
        let owners = coarsest.partition(exchange.parts());
        let part = owners.and_then(|owners| coarsest.part(&owners, number, layers));
        let part = agree(part, &**exchange)?;
        let seconds = clock.elapsed().as_secs_f64();
        let mut parts = vec![PartOfLevel { part, refinement: None, seconds }];
        for _ in 0..refinements {
            let clock = Instant::now();
            let coarse = &parts[parts.len() - 1];
            let refined = match domain {
                Some(domain) => domain.refine_part(&coarse.part, layers),
                None => coarse.part.refine(layers),
            };
            let (part, refinement) = agree(refined, &**exchange)?;
            let extent = merge_all(&Extent::of(&part.mesh), &**exchange)?;
            let part = part.with_extent(extent);
            let seconds = coarse.seconds + clock.elapsed().as_secs_f64();
            parts.push(PartOfLevel { part, refinement: Some(refinement), seconds });
        }
        Ok(Self { parts })
    }

    /// Number of meshes.
    pub fn n_meshes(&self) -> usize {
        self.parts.len()
    }
    /// The part of a mesh by its position, zero for the coarsest.
    ///
    /// # Panics
    /// If there is no such mesh.
    pub fn part(&self, position: usize) -> &Part<D> {
        &self.parts[position].part
    }
    /// The parents of the vertices of a part in the next coarser one; `None` for the coarsest part.
    pub(super) fn refinement(&self, position: usize) -> Option<&Refinement> {
        self.parts[position].refinement.as_ref()
    }
    /// Seconds for a part and all coarser ones.
    pub(super) fn seconds(&self, position: usize) -> f64 {
        self.parts[position].seconds
    }
}

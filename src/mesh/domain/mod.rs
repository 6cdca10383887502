//! Domains: built in, or the mesh of a file.

mod boxes;
mod disc;
mod lshape;

pub use boxes::BoxDomain;
#[cfg(feature = "problem-files")]
pub(crate) use boxes::SIDES;

use super::boundary::BoundaryCondition;
use super::error::MeshError;
use super::part::{Layers, Part};
use super::refine::Refinement;
use super::simplicial::Mesh;
use crate::arrays::array_of;

/// A domain. All the boundary of an L-shape and of a disc is Dirichlet.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Domain<const D: usize> {
    /// A box.
    Box(BoxDomain<D>),
    /// The square `(-half, half)^2` without its quadrant `x >= 0`, `y <= 0`; two dimensions only.
    LShape {
        /// Length of the two shortest sides, which meet in the re-entrant corner.
        half: f64,
    },
    /// The disc of this radius around the origin; two dimensions only.
    Disc {
        /// The radius.
        radius: f64,
    },
    /// A mesh, which covers its domain: level `n` is its `n`-th uniform refinement.
    Mesh(Mesh<D>),
}

impl<const D: usize> From<BoxDomain<D>> for Domain<D> {
    fn from(domain: BoxDomain<D>) -> Self {
        Domain::Box(domain)
    }
}

impl<const D: usize> From<Mesh<D>> for Domain<D> {
    fn from(mesh: Mesh<D>) -> Self {
        Domain::Mesh(mesh)
    }
}

impl<const D: usize> Domain<D> {
    /// Whether the domain is a mesh, so that levels count refinements, from 0.
    pub fn is_mesh(&self) -> bool {
        matches!(self, Domain::Mesh(_))
    }
    /// The smallest box that contains the domain; for a box that box, with the conditions on its sides.
    pub fn bounding_box(&self) -> BoxDomain<D> {
        match *self {
            Domain::Mesh(ref mesh) => {
                let [lower, upper] = mesh.own_box();
                BoxDomain::dirichlet(lower, upper)
            }
            Domain::Box(ref domain) => domain.clone(),
            Domain::LShape { half } => BoxDomain::centred(half),
            Domain::Disc { radius } => BoxDomain::centred(radius),
        }
    }
    /// The length that a level subdivides: the shortest side, or the radius of a disc; of a mesh the largest cell
    /// diameter, which each level halves.
    pub fn length(&self) -> f64 {
        match *self {
            Domain::Mesh(ref mesh) => mesh.mesh_size(),
            Domain::Box(ref domain) => (domain.upper - domain.lower).min(),
            Domain::LShape { half } => half,
            Domain::Disc { radius } => radius,
        }
    }
    /// Whether the boundary has a facet with this condition.
    pub fn has_condition(&self, condition: BoundaryCondition) -> bool {
        match self {
            Domain::Box(domain) => domain.sides.iter().flatten().any(|&side| side == condition),
            Domain::Mesh(mesh) => mesh.has_condition(condition),
            _ => condition == BoundaryCondition::Dirichlet,
        }
    }

    /// Number of cells of the mesh of a level.
    pub fn cells(&self, level: usize) -> f64 {
        match self {
            Domain::Box(domain) => {
                let simplices: f64 = (1..=D).map(|k| k as f64).product();
                domain.counts(level).iter().map(|&n| n as f64).product::<f64>() * simplices
            }
            // six triangles around the centre, two in each of three squares
            Domain::LShape { .. } | Domain::Disc { .. } => 6.0 * (level as f64).powi(2),
            Domain::Mesh(mesh) => mesh.n_cells() as f64 * 2_f64.powi(D as i32).powf(level as f64),
        }
    }
    /// Approximate lengths of the cells of a level along each axis.
    pub fn spacings(&self, level: usize) -> [f64; D] {
        match self {
            Domain::Box(domain) => {
                let counts = domain.counts(level);
                array_of(|k| (domain.upper[k] - domain.lower[k]) / counts[k] as f64)
            }
            Domain::Mesh(_) => [self.length() / 2_f64.powf(level as f64); D],
            _ => [self.length() / level as f64; D],
        }
    }
    /// The mesh with `level` subdivisions of [`Domain::length`]. Up to numbering, the mesh of an even
    /// level is [`Domain::refine`] of the mesh of half the level. Of a mesh the refinement with the number `level`.
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` for a level of zero, for a domain without volume and for one that does
    /// not exist in this dimension; `MeshErrorKind::TooLarge` if there would be too many cells.
    pub fn mesh(&self, level: usize) -> Result<Mesh<D>, MeshError> {
        match *self {
            Domain::Mesh(ref mesh) => {
                (0..level).try_fold(mesh.clone(), |mesh, _| Ok(mesh.refine()?.0))
            }
            Domain::Box(ref domain) => Mesh::kuhn_box(domain, domain.counts(level)),
            Domain::LShape { half } => Mesh::l_shape(half, level),
            Domain::Disc { radius } => Mesh::disc(radius, level),
        }
    }
    /// The uniform refinement of a mesh of this domain; new vertices on the boundary lie on the boundary
    /// of the domain.
    ///
    /// # Errors
    /// `MeshErrorKind::TooLarge` if there would be too many cells.
    pub fn refine(&self, mesh: &Mesh<D>) -> Result<(Mesh<D>, Refinement), MeshError> {
        Ok(match self {
            Domain::Disc { .. } => mesh.refine_disc()?,
            _ => mesh.refine()?,
        })
    }
    /// The refinement of a part of a mesh of this domain, as [`Part::refine`]; new vertices on the boundary
    /// lie on the boundary of the domain.
    ///
    /// # Errors
    /// Those of [`Part::refine`].
    pub fn refine_part(
        &self,
        part: &Part<D>,
        layers: Layers,
    ) -> Result<(Part<D>, Refinement), MeshError> {
        part.check_refinement(layers)?;
        Ok(part.peel(self.refine(&part.mesh)?, layers))
    }
}

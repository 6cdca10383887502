//! Built-in domains.

mod boxes;
mod disc;
mod lshape;

use super::{BoundaryPart, Mesh, MeshError, Refinement};
use crate::instances::compiled;
use crate::real::{Point, Real};

/// An axis-parallel box and the part of the boundary each of its sides belongs to.
#[derive(Clone, Debug)]
pub struct BoxDomain<const D: usize> {
    /// Lowest corner.
    pub lower: Point<f64, D>,
    /// Highest corner.
    pub upper: Point<f64, D>,
    /// Part of the sides `x_k = lower_k` and `x_k = upper_k`, for each axis `k`.
    pub sides: [[BoundaryPart; 2]; D],
}

impl<const D: usize> BoxDomain<D> {
    /// The box with Dirichlet data on every side.
    pub fn dirichlet(lower: Point<f64, D>, upper: Point<f64, D>) -> Self {
        Self { lower, upper, sides: [[BoundaryPart::Dirichlet; 2]; D] }
    }
    /// The cube `(-half, half)^D` with Dirichlet data on every side.
    pub fn centred(half: f64) -> Self {
        Self::dirichlet(Point::repeat(-half), Point::repeat(half))
    }
    /// The same box with another part on one side (`end` 0 for the lower, 1 for the upper one).
    #[must_use]
    pub fn side(mut self, axis: usize, end: usize, part: BoundaryPart) -> Self {
        self.sides[axis][end] = part;
        self
    }
    /// The box of Signorini scenes: `(-1,1)^(D-1) x (0,1)`, contact where the last coordinate is
    /// zero, Dirichlet data on the other sides.
    pub fn above_contact() -> Self {
        let mut lower = Point::repeat(-1.0);
        lower[D - 1] = 0.0;
        Self::dirichlet(lower, Point::repeat(1.0)).side(D - 1, 0, BoundaryPart::Contact)
    }
}

/// The domain of a scene. Where it is not a box, all its boundary is Dirichlet.
#[derive(Clone, Debug)]
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
}

impl<const D: usize> From<BoxDomain<D>> for Domain<D> {
    fn from(domain: BoxDomain<D>) -> Self {
        Domain::Box(domain)
    }
}

impl<const D: usize> Domain<D> {
    /// The smallest box around the domain; a box itself with its sides.
    pub fn bounding_box(&self) -> BoxDomain<D> {
        match *self {
            Domain::Box(ref domain) => domain.clone(),
            Domain::LShape { half } => BoxDomain::centred(half),
            Domain::Disc { radius } => BoxDomain::centred(radius),
        }
    }
    /// The length that a level is a subdivision of: the shortest side, or the radius of a disc.
    pub fn length(&self) -> f64 {
        match *self {
            Domain::Box(ref domain) => (domain.upper - domain.lower).min(),
            Domain::LShape { half } => half,
            Domain::Disc { radius } => radius,
        }
    }
    /// How far one can go from a point along any axis without leaving the domain, or less; negative
    /// outside.
    pub fn depth(&self, x: &Point<f64, D>) -> f64 {
        let in_box = |b: &BoxDomain<D>| (x - b.lower).min().min((b.upper - x).min());
        match self {
            Domain::Box(domain) => in_box(domain),
            Domain::LShape { .. } => in_box(&self.bounding_box()).min((-x[0]).max(x[1 % D])),
            Domain::Disc { radius } => radius - x.norm(),
        }
    }
    /// Whether some part of the boundary is of this kind.
    pub fn has_part(&self, part: BoundaryPart) -> bool {
        match self {
            Domain::Box(domain) => domain.sides.iter().flatten().any(|&side| side == part),
            _ => part == BoundaryPart::Dirichlet,
        }
    }

    /// How many cells the mesh of a level has.
    pub fn cells(&self, level: usize) -> f64 {
        match self {
            Domain::Box(domain) => {
                let simplices: f64 = (1..=D).map(|k| k as f64).product();
                domain.counts(level).iter().map(|&n| n as f64).product::<f64>() * simplices
            }
            // six triangles around the centre, two in each of three squares
            Domain::LShape { .. } | Domain::Disc { .. } => 6.0 * (level as f64).powi(2),
        }
    }
    /// Lengths of the cells of a level along each axis, about.
    pub fn spacings(&self, level: usize) -> [f64; D] {
        match self {
            Domain::Box(domain) => {
                let counts = domain.counts(level);
                std::array::from_fn(|k| (domain.upper[k] - domain.lower[k]) / counts[k] as f64)
            }
            _ => [self.length() / level as f64; D],
        }
    }
    /// The mesh with `level` subdivisions of [`Domain::length`]. On every domain the mesh of an
    /// even level is what [`Domain::refine`] makes of the mesh of half of it, up to numbering.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] for a level of zero, for a domain without volume and for one that does
    /// not exist in this dimension; [`MeshError::TooLarge`] if there would be too many cells.
    pub fn mesh<T: Real>(&self, level: usize) -> Result<Mesh<T, D>, MeshError> {
        match *self {
            Domain::Box(ref domain) => Mesh::kuhn_box(domain, domain.counts(level)),
            Domain::LShape { half } => Mesh::l_shape(half, level),
            Domain::Disc { radius } => Mesh::disc(radius, level),
        }
    }
    /// The uniform refinement of a mesh of this domain; its boundary is that of the domain.
    ///
    /// # Errors
    /// [`MeshError::TooLarge`] if there would be too many cells.
    pub fn refine<T: Real>(
        &self,
        mesh: &Mesh<T, D>,
    ) -> Result<(Mesh<T, D>, Refinement), MeshError> {
        compiled!(
            T, D: fn(&Domain<D>, &Mesh<T, D>) -> Result<(Mesh<T, D>, Refinement), MeshError>
                = Domain::refine_mesh
        )(self, mesh)
    }
    fn refine_mesh<T: Real>(
        &self,
        mesh: &Mesh<T, D>,
    ) -> Result<(Mesh<T, D>, Refinement), MeshError> {
        Ok(match self {
            Domain::Disc { .. } => mesh.refine_disc()?,
            _ => mesh.refine()?,
        })
    }
}

//! The disc, as the image of a regular hexagon.

use std::f64::consts::FRAC_PI_3;

use crate::arrays::array_of;
use crate::mesh::boundary::BoundaryCondition;
use crate::mesh::error::MeshError;
use crate::mesh::part::extent::Extent;
use crate::mesh::refine::Refinement;
use crate::mesh::simplicial::Mesh;
use crate::mesh::validate::TaggedFacet;
use crate::mesh::validate::check_size;
use crate::real::Point;

impl<const D: usize> Mesh<D> {
    /// The disc of this radius around the origin: a centre, and rings `k = 1..=n` of `6k` vertices
    /// each at equal angles. All the boundary is Dirichlet; its vertices lie on the circle.
    ///
    /// It is the image of a regular hexagon cut into `6 n^2` equilateral triangles, under the map that
    /// bends each side of the concentric hexagons into an arc. Angles lie between 30 and 90 degrees.
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` for `n = 0`, a radius that is not positive and finite and a dimension
    /// other than two; `MeshErrorKind::TooLarge`.
    pub fn disc(radius: f64, n: usize) -> Result<Self, MeshError> {
        check_shape::<D>("disc", radius, n)?;
        let number = |ring: usize, place: usize| match ring {
            0 => 0,
            k => (1 + 3 * k * (k - 1) + place % (6 * k)) as u32,
        };
        let mut vertices = vec![Point::zeros()];
        let mut cells = Vec::with_capacity(18 * n * n);
        for k in 1..=n {
            vertices.extend((0..6 * k).map(|place| {
                let angle = FRAC_PI_3 * place as f64 / k as f64;
                polar(radius * (k as f64 / n as f64), angle)
            }));
            for (sector, j) in (0..6).flat_map(|sector| (0..k).map(move |j| (sector, j))) {
                let (outer, inner) = (sector * k + j, sector * (k - 1) + j);
                let (next, foot) = (number(k, outer + 1), number(k - 1, inner));
                cells.extend([number(k, outer), next, foot]);
                if j + 1 < k {
                    cells.extend([foot, number(k - 1, inner + 1), next]);
                }
            }
        }
        let boundary: Vec<_> = (0..6 * n)
            .map(|j| TaggedFacet {
                vertices: array_of(|end| number(n, j + end)),
                condition: BoundaryCondition::Dirichlet,
            })
            .collect();
        Self::new(vertices, cells, &boundary)
    }

    /// The uniform refinement of a mesh of a disc, with new vertices in the middle of arcs, as in
    /// [`Mesh::disc`], not of chords.
    pub(crate) fn refine_disc(&self) -> Result<(Self, Refinement), MeshError> {
        let (mut fine, refinement) = self.refine()?;
        let hexagon: Vec<_> = self.vertices.iter().map(to_hexagon).collect();
        for (x, &[a, b]) in fine.vertices.iter_mut().zip(&refinement.parents) {
            if a != b {
                let middle = (hexagon[a as usize] + hexagon[b as usize]) / 2.0;
                *x = to_disc(&middle);
            }
        }
        fine.whole = fine.whole.map(Extent::moved);
        Ok((fine, refinement))
    }
}

/// Refuses a dimension other than two, a length that is not positive and zero subdivisions.
pub(crate) fn check_shape<const D: usize>(
    shape: &'static str,
    length: f64,
    n: usize,
) -> Result<(), MeshError> {
    if D != 2 {
        let allowed = format!("a mesh of the {shape} needs two");
        return Err(MeshError::parameter("dimension", D, allowed));
    }
    if n == 0 {
        return Err(MeshError::parameter("subdivisions", n, "at least one"));
    }
    if !(length > 0.0 && length.is_finite()) {
        return Err(MeshError::parameter("length", length, "positive and finite"));
    }
    let n_cells = n.saturating_mul(n).saturating_mul(6);
    // a bound of the number of cells of both shapes and of the vertices of the square of the L-shape
    check_size(n_cells, n_cells)?;
    Ok(())
}

fn polar<const D: usize>(r: f64, angle: f64) -> Point<D> {
    Point::from_fn(|k, _| r * if k == 0 { angle.cos() } else { angle.sin() })
}

/// The sector of 60 degrees that contains an angle, and the position of the angle in it, from zero to
/// one.
fn sector(angle: f64) -> (f64, f64) {
    let turns = angle / FRAC_PI_3;
    (turns.floor(), turns - turns.floor())
}

/// The inverse of [`to_disc`].
fn to_hexagon<const D: usize>(x: &Point<D>) -> Point<D> {
    let r = x.norm();
    let (k, t) = sector(x[1].atan2(x[0]));
    polar::<D>(r * (1.0 - t), k * FRAC_PI_3) + polar::<D>(r * t, (k + 1.0) * FRAC_PI_3)
}

/// The map from the regular hexagon to the disc: each side of the concentric hexagon through `x`
/// becomes an arc, and lengths along the side become angles.
fn to_disc<const D: usize>(x: &Point<D>) -> Point<D> {
    let (k, _) = sector(x[1].atan2(x[0]));
    // coordinates along the two rays that bound the sector
    let (a, b): (Point<D>, Point<D>) =
        (polar(1.0, k * FRAC_PI_3), polar(1.0, (k + 1.0) * FRAC_PI_3));
    let area = a[0] * b[1] - a[1] * b[0];
    let along_a = (x[0] * b[1] - x[1] * b[0]) / area;
    let along_b = (a[0] * x[1] - a[1] * x[0]) / area;
    let r = along_a + along_b;
    if r <= 0.0 { Point::zeros() } else { polar(r, (k + along_b / r) * FRAC_PI_3) }
}

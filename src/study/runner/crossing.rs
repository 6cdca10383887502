//! Bounds that cross, before the first row.

use super::Study;
use crate::error::Error;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::study::crossing::{Crossing, Points};

impl<const D: usize> Study<'_, D> {
    /// Where lower bounds exceed upper ones on these meshes, at the points of all schemes.
    pub(super) fn find_crossing<'m>(
        &self,
        meshes: impl IntoIterator<Item = &'m Mesh<D>>,
    ) -> Result<Option<Crossing<D>>, Error>
    where
        f64: 'm,
    {
        let Some(points) = self.points_of_bounds()? else { return Ok(None) };
        for mesh in meshes {
            let seen = points.look(&self.scene.problem, mesh)?;
            let found = seen.crossing(seen.size);
            if found.is_some() {
                return Ok(found);
            }
        }
        Ok(None)
    }

    /// The points of all schemes at which bounds are compared; none where no bounds can cross.
    pub(super) fn points_of_bounds(&self) -> Result<Option<Points>, Error> {
        if !self.scene.problem.upper.is_given() {
            return Ok(None);
        }
        let mut points = Points::default();
        let entries = self.entries.iter().map(|of| (&of.scheme, &of.problem));
        let reference = self.reference.iter().map(|of| (&of.scheme, &of.problem));
        for (scheme, problem) in entries.chain(reference) {
            let constraint_set = problem.constraint_set.clone();
            let without_data = Problem { constraint_set, ..Problem::new() };
            points.add(&**scheme, &without_data, self.quadrature)?;
        }
        Ok(Some(points))
    }
}

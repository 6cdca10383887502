//! Which part of a mesh each cell belongs to.

use std::ops::Range;

use crate::mesh::error::MeshError;
use crate::mesh::simplicial::Mesh;
use crate::real::Point;

impl<const D: usize> Mesh<D> {
    /// The number of the part of each cell, for a number of parts with equally many cells, up to one: by
    /// recursive bisection of the barycentres across the longer side of the box around them. It depends on
    /// nothing but the mesh, so that processes that have the same mesh find the same parts.
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` for no parts, and for more parts than cells.
    pub fn partition(&self, parts: usize) -> Result<Vec<u32>, MeshError> {
        let n_cells = self.n_cells();
        if parts == 0 || parts > n_cells {
            let allowed = format!("1 to {n_cells}, the number of cells");
            return Err(MeshError::parameter("number of parts", parts, allowed));
        }
        let barycentres: Vec<Point<D>> = (0..n_cells).map(|cell| self.barycentre(cell)).collect();
        let mut cells: Vec<u32> = (0..n_cells as u32).collect();
        let mut part_of = vec![0; n_cells];
        halve(&barycentres, &mut cells, 0..parts as u32, &mut part_of);
        Ok(part_of)
    }
}

/// Distributes some cells among some parts.
fn halve<const D: usize>(
    barycentres: &[Point<D>],
    cells: &mut [u32],
    parts: Range<u32>,
    part_of: &mut [u32],
) {
    if parts.len() == 1 {
        cells.iter().for_each(|&cell| part_of[cell as usize] = parts.start);
        return;
    }
    let length = |axis: usize| {
        let coordinates = || cells.iter().map(|&cell| barycentres[cell as usize][axis]);
        coordinates().fold(f64::MIN, f64::max) - coordinates().fold(f64::MAX, f64::min)
    };
    let longest =
        (1..D).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best });
    let middle = parts.start + parts.len() as u32 / 2;
    let at = (cells.len() as u64 * u64::from(middle - parts.start) / parts.len() as u64) as usize;
    // cells with equal coordinates are ordered by their numbers
    cells.select_nth_unstable_by(at, |&a, &b| {
        let coordinate = |cell: u32| barycentres[cell as usize][longest];
        coordinate(a).total_cmp(&coordinate(b)).then(a.cmp(&b))
    });
    let (low, high) = cells.split_at_mut(at);
    halve(barycentres, low, parts.start..middle, part_of);
    halve(barycentres, high, middle..parts.end, part_of);
}

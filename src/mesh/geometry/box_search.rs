//! Search for the boxes that may contain a point.

use crate::arrays::array_of;
use crate::mesh::simplicial::Mesh;
use crate::real::{Point, box_around};

/// A place of a grid, whose boxes have two to the first number as their size.
type GridBox<const D: usize> = (i32, [i64; D]);

/// Boxes by place: each is listed for the places that it touches of the grid whose places are as large as it is,
/// which are few, whatever the sizes of the others.
pub(crate) struct BoxSearch<const D: usize> {
    lower: Point<D>,
    places: Vec<(GridBox<D>, usize)>,
    sizes: Vec<i32>,
}

impl<const D: usize> BoxSearch<D> {
    /// Boxes by their lower and upper ends. Places are counted from a point near them.
    pub fn new(lower: Point<D>, boxes: impl Iterator<Item = [Point<D>; 2]>) -> Self {
        let mut found = Self { lower, places: Vec::new(), sizes: Vec::new() };
        for (number, ends) in boxes.enumerate() {
            let size = (ends[1] - ends[0]).max().max(f64::MIN_POSITIVE).log2().ceil() as i32;
            let ends = ends.map(|end| found.place(&end, size));
            for corner in 0..1 << D {
                found.places.push(((size, array_of(|k| ends[corner >> k & 1][k])), number));
            }
        }
        found.places.sort_unstable();
        found.places.dedup();
        found.sizes = found.places.iter().map(|((size, _), _)| *size).collect();
        found.sizes.dedup();
        found
    }

    /// The place of a point in the grid of a size.
    fn place(&self, x: &Point<D>, size: i32) -> [i64; D] {
        array_of(|k| ((x[k] - self.lower[k]) / f64::from(size).exp2()).floor() as i64)
    }

    /// The numbers of boxes near a point: all that contain it, and some others.
    pub fn candidates(&self, x: &Point<D>) -> impl Iterator<Item = usize> {
        self.sizes.iter().flat_map(move |&size| {
            let key = (size, self.place(x, size));
            let start = self.places.partition_point(|(place, _)| *place < key);
            let here = self.places[start..].iter().take_while(move |(place, _)| *place == key);
            here.map(|(_, number)| *number)
        })
    }
}

impl<const D: usize> Mesh<D> {
    /// The cells that contain a point, whose barycentric coordinates are at least minus `rounding` there; all cells are
    /// looked at.
    pub(crate) fn cells_containing(
        &self,
        x: &Point<D>,
        rounding: f64,
    ) -> impl Iterator<Item = usize> {
        let contains = move |&cell: &usize| {
            self.barycentric(cell, x)[..=D].iter().all(|&lambda| lambda >= -rounding)
        };
        (0..self.n_cells()).filter(contains)
    }
    /// The search for the cells near a point, by boxes that are larger than the cells by a share of their sizes.
    pub(crate) fn cell_search(&self, share: f64) -> BoxSearch<D> {
        let around = |cell: usize| {
            let [low, high] = box_around(&self.corners(cell)[..=D]);
            let margin = share * (high - low).max();
            [low.add_scalar(-margin), high.add_scalar(margin)]
        };
        BoxSearch::new(self.own_box()[0], (0..self.n_cells()).map(around))
    }
}

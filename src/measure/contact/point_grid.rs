//! Points sorted into the boxes of a grid.

use crate::real::{Point, box_around};

/// Points in the boxes of a grid, at most about as many boxes as points, for the search of points within a box.
pub(super) struct PointGrid<const D: usize> {
    low: Point<D>,
    /// Number of boxes per unit of length along each axis; zero where all points have one coordinate.
    density: Point<D>,
    counts: [usize; D],
    /// The points of box `k` are those from `starts[k]` to `starts[k + 1]`.
    starts: Vec<usize>,
    /// The points by box, with their numbers.
    points: Vec<(usize, Point<D>)>,
}

impl<const D: usize> PointGrid<D> {
    pub fn new(points: &[Point<D>]) -> Self {
        let [low, high] = box_around(points);
        let longest = (high - low).max();
        let along = (points.len() as f64).powf(1.0 / D as f64);
        let count = |axis: usize| {
            let share = (high[axis] - low[axis]) / longest;
            // the share is not a number if all points coincide
            if share > 0.0 { (along * share).ceil() as usize } else { 1 }
        };
        let counts: [usize; D] = std::array::from_fn(count);
        let density = Point::from_fn(|axis, _| {
            let length = high[axis] - low[axis];
            if length > 0.0 { counts[axis] as f64 / length } else { 0.0 }
        });
        let mut grid = Self { low, density, counts, starts: Vec::new(), points: Vec::new() };
        let box_of = |x: &Point<D>| grid.number(&grid.position(x));
        let mut sorted: Vec<_> = points.iter().copied().enumerate().collect();
        sorted.sort_by_key(|(_, x)| box_of(x));
        let n_boxes: usize = counts.iter().product();
        let starts =
            (0..=n_boxes).map(|k| sorted.partition_point(|(_, x)| box_of(x) < k)).collect();
        (grid.starts, grid.points) = (starts, sorted);
        grid
    }

    /// Calls `visit` with the points within a box and with their numbers.
    pub fn visit_within(
        &self,
        low: &Point<D>,
        high: &Point<D>,
        visit: &mut dyn FnMut(usize, &Point<D>),
    ) {
        let (first, last) = (self.position(low), self.position(high));
        let mut position = first;
        loop {
            let k = self.number(&position);
            for (number, x) in &self.points[self.starts[k]..self.starts[k + 1]] {
                if (0..D).all(|axis| low[axis] <= x[axis] && x[axis] <= high[axis]) {
                    visit(*number, x);
                }
            }
            let Some(axis) = (0..D).find(|&axis| position[axis] < last[axis]) else { return };
            position[axis] += 1;
            position[..axis].copy_from_slice(&first[..axis]);
        }
    }

    /// The position of the box of a point, or of the box next to a point outside the grid.
    fn position(&self, x: &Point<D>) -> [usize; D] {
        // a negative number is cast to zero
        let along = |axis: usize| ((x[axis] - self.low[axis]) * self.density[axis]) as usize;
        std::array::from_fn(|axis| along(axis).min(self.counts[axis] - 1))
    }

    fn number(&self, position: &[usize; D]) -> usize {
        (0..D).rev().fold(0, |number, axis| number * self.counts[axis] + position[axis])
    }
}

//! The constant of Friedrichs' inequality of a mesh.

use crate::algebra::Distribution;
use crate::arrays::{array_of, map_entries};
use crate::mesh::{BoundaryCondition, Mesh};
use crate::real::Point;

/// A normal whose component is smaller than this is orthogonal to the axis.
const PARALLEL: f64 = 1e-9;

/// What the constant of Friedrichs' inequality of a mesh, or of the parts of a mesh together, depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct FriedrichsData<const D: usize> {
    /// The least box around the mesh.
    low: Point<D>,
    high: Point<D>,
    /// For each axis whether all lines in its direction end, and whether all begin, on the Dirichlet boundary.
    is_held: [[bool; 2]; D],
}

impl<const D: usize> FriedrichsData<D> {
    pub fn of(mesh: &Mesh<D>) -> Self {
        let first = mesh.vertices()[0];
        let (mut low, mut high) = (first, first);
        for x in mesh.vertices() {
            let x = *x;
            low = low.zip_map(&x, f64::min);
            high = high.zip_map(&x, f64::max);
        }
        let free = mesh.boundary().iter().filter(|f| f.condition != BoundaryCondition::Dirichlet);
        let normal = |cell: u32, local: u8| mesh.geometry(cell as usize).normal(usize::from(local));
        let normals: Vec<_> = free.map(|f| normal(f.cell, f.local)).collect();
        let is_held = array_of(|axis| {
            map_entries([1.0, -1.0], |sign| normals.iter().all(|n| sign * n[axis] <= PARALLEL))
        });
        Self { low, high, is_held }
    }

    /// That of all parts of a mesh; all parts call it.
    pub fn over_parts(mut self, distribution: &dyn Distribution) -> Self {
        let mut numbers: Vec<f64> =
            self.high.iter().copied().chain((-self.low).iter().copied()).collect();
        numbers.extend(self.is_held.iter().flatten().map(|is_held| f64::from(u8::from(!is_held))));
        distribution.largest(&mut numbers);
        for axis in 0..D {
            (self.high[axis], self.low[axis]) = (numbers[axis], -numbers[D + axis]);
            self.is_held[axis] = map_entries([0, 1], |end| numbers[2 * (D + axis) + end] == 0.0);
        }
        self
    }

    /// A number `C` with `|w| <= C |grad w|` in L2 for every function `w` that vanishes on the Dirichlet
    /// boundary; none but where along some axis every line through the mesh begins, or ends, on that boundary. It takes no
    /// time; elsewhere the first eigenvalue of the mesh is bounded.
    ///
    /// On a segment of length `l` a function that vanishes at both ends, or at one, has `|w| <= l/pi |w'|`, or
    /// `2 l/pi |w'|`. The squares of `1/C` of the axes are added.
    pub fn constant(&self) -> Option<f64> {
        let mut sum = 0.0;
        for axis in 0..D {
            let ends: u8 = self.is_held[axis].iter().map(|&is_held| u8::from(is_held)).sum();
            let length = (self.high[axis] - self.low[axis]) / std::f64::consts::PI;
            sum += match ends {
                0 => 0.0,
                1 => (2.0 * length).powi(-2),
                _ => length.powi(-2),
            };
        }
        (sum > 0.0).then(|| 1.0 / sum.sqrt())
    }
}

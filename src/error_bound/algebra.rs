//! The part of the solver in a bound: a dual norm of what the flux does not balance.

use std::f64::consts::PI;

use crate::mesh::Mesh;
use crate::real::Real;

/// A coarser mesh, each of whose cells is the union of cells of the next finer one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CoarserCells<'a, T, const D: usize> {
    /// The coarser mesh.
    pub mesh: &'a Mesh<T, D>,
    /// For each cell of the finer mesh the cell of the coarser one that contains it.
    pub parents: &'a [u32],
}

/// What is not balanced in a cell: a constant function.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unbalanced {
    /// The integral of the function.
    pub integral: f64,
    /// The volume of the cell.
    pub volume: f64,
    /// The least value of the coefficient.
    pub least_coefficient: f64,
}

impl Unbalanced {
    /// The square of the norm in L2.
    fn square(&self) -> f64 {
        self.integral * self.integral / self.volume
    }
}

/// A bound `N` with `(nu, e) <= N |||e|||` for a function `nu`, constant in cells, and all `e` that vanish on
/// the Dirichlet part, `|e| <= constant |||e|||`. Where the constant is infinite `N` leaves the means on the
/// coarsest mesh out.
///
/// With the means `nu_k` of `nu` in the cells of mesh `k` the function is `nu_0 + sum_k (nu_k - nu_(k-1))`, and
/// `nu_k - nu_(k-1)` has the mean zero in each cell of mesh `k - 1`, where it counts by the inequality of Payne and
/// Weinberger: `(nu_k - nu_(k-1), e)_K <= h_K / pi |nu_k - nu_(k-1)|_K |grad e|_K`. The sum may begin at any mesh;
/// the least of these numbers is taken.
pub(super) fn dual_norm<T: Real, const D: usize>(
    cells: Vec<Unbalanced>,
    coarser: &[CoarserCells<'_, T, D>],
    constant: f64,
) -> f64 {
    let l2_norm = |cells: &[Unbalanced]| cells.iter().map(Unbalanced::square).sum::<f64>().sqrt();
    let (mut cells, mut of_differences) = (cells, 0.0);
    let mut least = constant * l2_norm(&cells);
    for CoarserCells { mesh, parents } in coarser {
        let none = Unbalanced { integral: 0.0, volume: 0.0, least_coefficient: f64::INFINITY };
        let mut means = vec![none; mesh.n_cells()];
        let mut squares = vec![0.0; mesh.n_cells()];
        for (cell, &parent) in cells.iter().zip(*parents) {
            let mean = &mut means[parent as usize];
            mean.integral += cell.integral;
            mean.volume += cell.volume;
            mean.least_coefficient = mean.least_coefficient.min(cell.least_coefficient);
            squares[parent as usize] += cell.square();
        }
        let mut sum = 0.0;
        for (k, (mean, square)) in means.iter().zip(&squares).enumerate() {
            let diameter = mesh.cell_diameter(k).to_f64();
            let difference = (square - mean.square()).max(0.0);
            sum += (diameter / PI).powi(2) * difference / mean.least_coefficient;
        }
        of_differences += sum.sqrt();
        cells = means;
        least = least.min(of_differences + constant * l2_norm(&cells));
    }
    if least.is_finite() { least } else { of_differences }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::BoxDomain;
    use crate::real::Point;

    /// An interval of eight cells with its three coarser meshes.
    fn norm_on_interval(density: [f64; 8]) -> f64 {
        norm(density, [1.0; 8], 1.0 / PI)
    }

    /// The same with these coefficients, and with a constant of Friedrichs' inequality.
    fn norm(density: [f64; 8], coefficients: [f64; 8], constant: f64) -> f64 {
        let interval = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
        let meshes = [4, 2, 1].map(|n| Mesh::<f64, 1>::kuhn_box(&interval, [n]).unwrap());
        let parents = [4, 2, 1].map(|n: u32| (0..2 * n).map(|cell| cell / 2).collect::<Vec<_>>());
        let coarser: Vec<_> = (meshes.iter().zip(&parents))
            .map(|(mesh, parents)| CoarserCells { mesh, parents })
            .collect();
        let cell = |(density, &least_coefficient): (f64, &f64)| Unbalanced {
            integral: density / 8.0,
            volume: 0.125,
            least_coefficient,
        };
        let cells = density.into_iter().zip(&coefficients).map(cell).collect();
        dual_norm(cells, &coarser, constant)
    }

    #[test]
    fn oscillations_count_with_the_size_of_the_cells_in_which_their_mean_vanishes() {
        let of = |density| norm_on_interval(density) * PI;
        assert_eq!(of([1.0; 8]), 1.0);
        assert_eq!(of([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0]), 0.25);
        assert_eq!(of([1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0]), 0.5);
        // with the least coefficient of the cells that a coarser one contains
        for weak in 0..8 {
            let coefficients: [f64; 8] =
                std::array::from_fn(|k| if k == weak { 0.25 } else { 4.0 });
            let found = norm([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0], coefficients, 10.0);
            let expected = 0.25 * (1.0_f64 + 0.75 / 4.0).sqrt() / PI;
            assert!((found / expected - 1.0).abs() < 1e-14, "{weak}: {found} {expected}");
        }
        // no level is better than the norm in L2 itself
        let mixed = of([9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert!(mixed <= 9.0 / 8.0_f64.sqrt(), "{mixed}");
    }
}

//! The energy of a discrete function, by one formula for every scheme.

use std::ops::Range;

use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::assemble::stiffness::zero_local;
use crate::error::Error;
use crate::instances::compiled;
use crate::parallel::cells;
use crate::quadrature::{FullySymmetric, Quadrature, Rule};
use crate::real::Point;

impl<const D: usize> Discretisation<'_, D> {
    /// The energy of a vector of unknowns,
    ///
    /// ```text
    /// 1/2 int alpha grad u . T grad u + 1/2 int c u^2 - int f u - int_N q u + 1/2 int_R k u^2 - int_R k g u
    /// ```
    ///
    /// and `+ int g |u|` on sides with friction, with the gradient in each cell, the Neumann boundary `N` and Robin sides
    /// `R`. No facet form enters, so that a function has the same energy in every scheme; the minimum over the admissible functions is that of the
    /// continuous problem, and a discontinuous function may lie below it. Coefficient, reaction and loads
    /// are integrated by the rules of the assembly. `u` is the vector with the constants of bodies: with `w` the vector
    /// without, `J` the energy of `w` with the data less the constants and `l` their load, it is
    /// `J(w) - l(c) - 1/2 int reaction c^2 - 1/2 int_R k c^2`.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`], [`Error::Parameter`] unless there is one value for each unknown.
    pub fn energy(&self, u: &[f64]) -> Result<f64, Error> {
        self.check_length(u)?;
        self.energy_of(u, &|_| true)
    }

    /// The energy of the cells for which `counts` is true, and of their boundary facets.
    pub(crate) fn energy_of(
        &self,
        u: &[f64],
        counts: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<f64, Error> {
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &[f64],
                &(dyn Fn(usize) -> bool + Sync),
            ) -> Result<f64, Error>
                = |of, u, counts| of.space.energy(u, counts)
        )(self, u, counts)
    }
}

impl<const D: usize> Space<'_, D> {
    fn energy(&self, u: &[f64], counts: &(dyn Fn(usize) -> bool + Sync)) -> Result<f64, Error> {
        let load = self.load_by_cell()?;
        let rule = match self.has_varying_coefficient() {
            // the rule at whose points the stiffness has the coefficient
            true => FullySymmetric.rule(D, 2 * self.basis_degree)?,
            false => Rule::new(D, 2 * self.basis_degree.saturating_sub(1)),
        };
        let table = self.cell_table(rule);
        let n = self.per_cell();
        let one = self.constants();
        // partial sums are added in order, so the result does not depend on threads
        let chunks = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            let mut sum = 0.0;
            for cell in cells.filter(|&cell| counts(cell)) {
                let geometry = self.mesh.geometry(cell);
                let local = self.local_values(cell, u);
                let mut gradients = 0.0;
                for ((point, basis), weight) in
                    table.points.iter().zip(&table.basis).zip(&table.weights)
                {
                    let slope = |k: usize| -> f64 {
                        (0..n).map(|i| local[i] * basis.derivatives[i][k]).sum()
                    };
                    // the gradients of barycentric coordinates sum to zero: without their common value
                    // the slopes a constant adds no rounding
                    let gradient = (1..=D).fold(Point::zeros(), |sum: Point<D>, k| {
                        sum + geometry.gradient(k) * (slope(k) - slope(0))
                    });
                    let gradient = self.isotropic_gradient(cell, &gradient);
                    let alpha = self.alpha_at(cell, &self.cell_point(point, cell));
                    gradients += weight * alpha * gradient.norm_squared();
                }
                let mut reaction = 0.0;
                if let Some(term) = &self.reaction {
                    let mut products = zero_local();
                    term.add(self.mesh, cell, geometry.volume, &mut products);
                    for i in 0..n {
                        for j in 0..n {
                            reaction += local[i] * products[i][j] * local[j];
                        }
                    }
                }
                sum += 0.5 * (geometry.volume * gradients + reaction);
                // without sources the list is empty
                let of_cell = load.iter().skip(cell * n).zip(&local[..n]);
                sum -= of_cell.map(|(b, u)| b * u).sum::<f64>();
                let constant = self.body_constants.of_cell(cell);
                if constant != 0.0 {
                    let load = load.get(cell * n..).unwrap_or_default();
                    sum -= constant * load.iter().zip(&one).map(|(b, one)| b * one).sum::<f64>();
                    sum -= 0.5 * constant * constant * self.reaction_of(cell, &one);
                }
            }
            sum
        });
        Ok(chunks.iter().sum::<f64>() + self.friction_energy(u, counts)?)
    }
}

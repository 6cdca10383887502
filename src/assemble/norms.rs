//! Errors against the exact solution, and values for pictures.

use std::ops::Range;

use super::tables::{BasisAt, CellTable, FacetTable};
use super::{Discretisation, data, parallel};
use crate::element::{MAX_BASIS, Node, ReferenceElement};
use crate::error::Error;
use crate::facet::{FacetForm, Sampling, Trace};
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::problem::Exact;
use crate::quadrature::Rule;
use crate::real::{Real, point_f64};
use crate::scheme::{DirichletBy, Scheme};
use crate::study::Errors;

/// Degree of the rule for error norms: the exact solution is not polynomial, and the rule must not
/// limit what it measures.
const fn error_degree(dimension: usize) -> usize {
    match dimension {
        1 | 2 => 19,
        _ => 9,
    }
}

/// Squares of the norms of the error.
#[derive(Clone, Copy, Debug, Default)]
struct SquaredErrors {
    /// Square of the L2 norm.
    l2: f64,
    /// Square of the broken H1 seminorm.
    h1: f64,
    /// Square of the energy norm.
    energy: f64,
    /// Maximum over nodes.
    max: f64,
}

impl SquaredErrors {
    fn add(&mut self, other: &Self) {
        self.l2 += other.l2;
        self.h1 += other.h1;
        self.energy += other.energy;
        self.max = self.max.max(other.max);
    }
}

impl<T: Real, const D: usize, S: Scheme<T, D>> Discretisation<'_, T, D, S> {
    /// Errors of a vector of unknowns against the exact solution; none where there is no exact
    /// solution.
    ///
    /// The energy norm is the broken seminorm weighted with the coefficient, plus the reaction
    /// term, plus the facet form at jumps without flux: for interior penalty the usual norm
    /// `|.|_1^2 + sum sigma_F ||[.]||^2`, for WOPSIP the square root of the form itself.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn errors(&self, u: &[T]) -> Result<Errors, Error> {
        let Some(exact) = &self.problem.exact else {
            return Ok(Errors::default());
        };
        let cells = CellTable::<f64>::new_in_f64::<T, S::Element, D>(error_degree(D));
        // partial sums are added in order, so the result does not depend on threads
        let parts = parallel::map(self.mesh.n_cells(), &|range: Range<usize>| {
            let mut sum = SquaredErrors::default();
            for cell in range {
                sum.add(&self.cell_error(exact, &cells, cell, u)?);
            }
            Ok::<_, Error>(sum)
        });
        let mut total = SquaredErrors::default();
        for part in parts {
            total.add(&part?);
        }
        if let (Some(neighbours), true) = (&self.neighbours, Self::COUPLES) {
            total.energy += self.facet_error(neighbours, u)?;
        }
        Ok(Errors {
            l2: Some(total.l2.sqrt()),
            h1: Some(total.h1.sqrt()),
            energy: Some(total.energy.sqrt()),
            max: Some(total.max),
        })
    }

    fn cell_error(
        &self,
        exact: &Exact<D>,
        table: &CellTable<f64>,
        cell: usize,
        u: &[T],
    ) -> Result<SquaredErrors, Error> {
        let geometry = self.mesh.geometry(cell);
        let volume = geometry.volume.to_f64();
        let alpha = self.alpha(cell).to_f64();
        let local = self.local_values(cell, u);
        let mut sum = SquaredErrors::default();
        for ((point, basis), &weight) in table.points.iter().zip(&table.basis).zip(&table.weights) {
            let x = point_f64(&self.mesh.point(cell, &point.map(T::lit)[..=D]));
            let value: f64 = (0..Self::N).map(|i| local[i] * basis.values[i]).sum();
            let mut error = -(exact.gradient)(&x);
            for k in 0..=D {
                let slope: f64 = (0..Self::N).map(|i| local[i] * basis.derivatives[i][k]).sum();
                error += point_f64(geometry.gradient(k)) * slope;
            }
            let difference = value - data::finite((exact.value)(&x), "exact solution", &x, cell)?;
            let square = data::finite(error.norm_squared(), "exact gradient", &x, cell)?;
            let reaction = self.problem.reaction.as_ref().map_or(0.0, |c| c.at(&x));
            sum.l2 += weight * volume * difference * difference;
            sum.h1 += weight * volume * square;
            sum.energy += weight * volume * (alpha * square + reaction * difference * difference);
        }
        let mean_rule = Rule::of_degree(D - 1, 5);
        for (i, &value) in local.iter().enumerate().take(Self::N) {
            let node = match S::Element::node(i) {
                Node::FacetMean(k) => mean_rule
                    .iter()
                    .map(|(point, w)| w * (exact.value)(&self.facet_point(point, cell, k)))
                    .sum(),
                node => (exact.value)(&self.node_point(cell, node)),
            };
            sum.max = sum.max.max((value - node).abs());
        }
        Ok(sum)
    }

    /// The facet form at the jumps of the error.
    fn facet_error(&self, neighbours: &Neighbours, u: &[T]) -> Result<f64, Error> {
        let degree = <S::Element as ReferenceElement<T, D>>::DEGREE;
        let sampling = <S::Facet as FacetForm<T, D>>::sampling(degree);
        let table = FacetTable::<T>::new::<S::Element, D>(sampling);
        let rule = Rule::of_degree(D - 1, self.quadrature.facet);
        let boundary_table = FacetTable::<T>::new::<S::Element, D>(match sampling {
            Sampling::Points(_) => Sampling::Points(self.quadrature.facet),
            Sampling::Means => Sampling::Means,
        });
        let value = |basis: &BasisAt<T>, local: &[f64]| -> f64 {
            (0..Self::N).map(|i| local[i] * basis.values[i].to_f64()).sum()
        };
        let mut total = 0.0;
        for cell in 0..self.mesh.n_cells() {
            let mine = self.local_values(cell, u);
            for local in 0..=D {
                let across = neighbours.across(cell, local);
                let jumps: Vec<f64> = match across {
                    Neighbour::Cell { cell: other, .. } if (other as usize) < cell => continue,
                    Neighbour::Cell { cell: other, local: other_local } => {
                        let theirs = self.local_values(other as usize, u);
                        table
                            .on(local)
                            .iter()
                            .zip(table.on(other_local as usize))
                            .map(|(a, b)| value(a, &mine) - value(b, &theirs))
                            .collect()
                    }
                    Neighbour::Boundary(BoundaryPart::Dirichlet)
                        if S::DIRICHLET == DirichletBy::FacetForm =>
                    {
                        let data = self.dirichlet_samples(&rule, sampling, cell, local)?;
                        let samples = boundary_table.on(local).iter().zip(data);
                        samples.map(|(basis, g)| value(basis, &mine) - g).collect()
                    }
                    Neighbour::Boundary(_) => continue,
                };
                let weights = match across {
                    Neighbour::Cell { .. } => &table.weights,
                    Neighbour::Boundary(_) => &boundary_table.weights,
                };
                let Some(view) = self.facet_view(neighbours, cell, local) else {
                    continue;
                };
                let penalty = self.form.penalty(&view);
                for (jump, &weight) in jumps.into_iter().zip(weights) {
                    let trace = Trace { jump: T::lit(jump), flux: T::lit(0.0) };
                    let term = weight * view.measure * self.form.integrand(trace, trace, penalty);
                    total += term.to_f64();
                }
            }
        }
        Ok(total)
    }

    /// The unknowns of a cell in `f64`.
    pub(super) fn local_values(&self, cell: usize, u: &[T]) -> [f64; MAX_BASIS] {
        std::array::from_fn(|i| if i < Self::N { u[self.dofs.of(cell, i)].to_f64() } else { 0.0 })
    }

    /// The discrete function at the vertices of each cell, `D + 1` values for each.
    pub fn vertex_values(&self, u: &[T]) -> Vec<f64> {
        let corners: Vec<BasisAt<f64>> = (0..=D)
            .map(|k| {
                let mut point = [0.0; 4];
                point[k] = 1.0;
                BasisAt::new_in_f64::<T, S::Element, D>(&point)
            })
            .collect();
        let mut out = Vec::with_capacity(self.mesh.n_cells() * (D + 1));
        for cell in 0..self.mesh.n_cells() {
            let local = self.local_values(cell, u);
            out.extend(
                corners
                    .iter()
                    .map(|basis| -> f64 { (0..Self::N).map(|i| local[i] * basis.values[i]).sum() }),
            );
        }
        out
    }
}

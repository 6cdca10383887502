//! Errors against the exact solution.

use std::ops::Range;
use std::sync::Arc;

use super::errors::Errors;
use super::evaluation::Reference;
use crate::assemble::Discretisation;
use crate::assemble::cut_simplices::CutRule;
use crate::assemble::load::FacetMoments;
use crate::assemble::space::tables::{BasisAt, CellTable};
use crate::assemble::space::{Space, Terms, data};
use crate::element::MAX_BASIS;
use crate::error::Error;
use crate::facet::{FacetForm, Trace};
use crate::instances::compiled;
use crate::mesh::{BoundaryPart, Neighbour, Neighbours};
use crate::parallel::cells;
use crate::problem::{Exact, Field};
use crate::quadrature::Rule;
use crate::real::{Point, Real, point_f64};

/// Degree of the rule for error norms: the exact solution is not polynomial, and the rule must not
/// limit what it measures. Cells that the exact free boundary or a jump of the load cuts are divided. For
/// basis functions of degree `b` the degree of the rule is at least `2 b + 2`, that of the square of the
/// largest part of the error.
pub(crate) const fn error_degree(dimension: usize) -> usize {
    match dimension {
        1 | 2 => 19,
        _ => 9,
    }
}

/// Degree of the rule for means over facets.
const MEAN_DEGREE: usize = 5;

/// Squares of the norms of the error.
#[derive(Clone, Copy, Debug, Default)]
struct SquaredErrors {
    /// Square of the L2 norm.
    l2: f64,
    /// Square of the broken H1 seminorm.
    h1: f64,
    /// Square of the energy norm.
    energy: f64,
    /// Square of the broken energy norm.
    broken_energy: f64,
    /// Maximum over nodes.
    max: f64,
}

impl SquaredErrors {
    fn add(&mut self, other: &Self) {
        self.l2 += other.l2;
        self.h1 += other.h1;
        self.broken_energy += other.broken_energy;
        self.max = self.max.max(other.max);
    }
    /// The norms.
    fn roots(&self) -> Errors {
        Errors {
            l2: Some(self.l2.sqrt()),
            h1: Some(self.h1.sqrt()),
            energy: Some(self.energy.sqrt()),
            broken_energy: Some(self.broken_energy.sqrt()),
            max: Some(self.max),
        }
    }
}

impl<T: Real, const D: usize> Discretisation<'_, T, D> {
    /// Errors of a vector of unknowns against the exact solution; none where there is no exact
    /// solution.
    ///
    /// The energy norm of the scheme is the broken seminorm weighted with the coefficient, plus the reaction
    /// term, plus the facet form at jumps without flux and without products of lifts, and at
    /// differences from Dirichlet data that the form imposes: for interior penalty the usual norm
    /// `|.|_1^2 + sum sigma_F ||[.]||^2`, for WOPSIP the square root of the form itself.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    ///
    /// # Panics
    /// If `u` is shorter than the number of unknowns.
    pub fn errors(&self, u: &[T]) -> Result<Errors, Error> {
        match &self.space.problem.exact {
            Some(exact) => self.errors_against(exact, u),
            None => Ok(Errors::default()),
        }
    }

    /// Errors of a vector of unknowns against a function with its gradient, in the norms of
    /// [`Discretisation::errors`]. The energy norm contains the differences from the Dirichlet data of
    /// the problem, not from those of the function.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    ///
    /// # Panics
    /// If `u` is shorter than the number of unknowns.
    pub fn errors_against(&self, exact: &Exact<D>, u: &[T]) -> Result<Errors, Error> {
        compiled!(
            T, D: fn(&Discretisation<'_, T, D>, &Exact<D>, &[T]) -> Result<Errors, Error>
                = |of, exact, u| of.space.errors(exact, of.form().couples().then_some(of.form()), u)
        )(self, exact, u)
    }

    /// Norms of the difference between `u` and a discrete function on the mesh of which this mesh is the
    /// refinement after some `refinements`: L2, H1 and the maximum over the nodes of this space.
    pub(crate) fn difference(
        &self,
        u: &[T],
        (coarse, values, refinements): (&Discretisation<'_, T, D>, &[T], usize),
    ) -> Result<Errors, Error> {
        compiled!(
            T, D: fn(
                &Discretisation<'_, T, D>,
                &[T],
                (&Discretisation<'_, T, D>, &[T], usize),
            ) -> Result<Errors, Error>
                = |of, u, (coarse, values, refinements)| {
                    let space = &coarse.space;
                    let reference = Reference::Coarse { space, values, refinements };
                    let total = of.space.cell_errors(&reference, u)?;
                    Ok(Errors { energy: None, ..total.roots() })
                }
        )(self, u, (coarse, values, refinements))
    }
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// Squares of the errors over all cells.
    fn cell_errors(&self, exact: &Reference<'_, T, D>, u: &[T]) -> Result<SquaredErrors, Error> {
        let degree = match exact {
            Reference::Exact(_) => error_degree(D).max(2 * self.basis_degree + 2),
            // the square of a difference of polynomials
            Reference::Coarse { space, .. } => 2 * self.basis_degree.max(space.basis_degree),
        };
        let cell_rule = Rule::new(D, degree);
        let terms = self.node_terms(&Rule::new(D - 1, MEAN_DEGREE), &cell_rule);
        let table = self.cell_table(cell_rule);
        let kinks: Vec<Option<Field<D>>> =
            (0..self.mesh.regions().len()).map(|region| self.kinks(exact, region)).collect();
        let cut_rule = kinks.iter().any(Option::is_some).then(|| CutRule::new(D, degree));
        // partial sums are added in order, so the result does not depend on threads
        let parts = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            let mut sum = SquaredErrors::default();
            for cell in cells {
                sum.add(&self.cell_error(
                    exact,
                    (&table, &terms),
                    kinks[self.mesh.region(cell)].as_ref().zip(cut_rule.as_ref()),
                    cell,
                    u,
                )?);
            }
            Ok::<_, Error>(sum)
        });
        let mut total = SquaredErrors::default();
        for part in parts {
            total.add(&part?);
        }
        Ok(total)
    }

    /// The function whose zeros are those of the level of the load of a region and, with an obstacle, the exact free
    /// boundary: second derivatives of the exact solution jump there.
    fn kinks(&self, exact: &Reference<'_, T, D>, region: usize) -> Option<Field<D>> {
        let Reference::Exact(exact) = exact else { return None };
        self.kinks_of(exact, region)
    }

    /// The function of an exact solution whose zeros are those of the level of the load of a region and,
    /// with an obstacle, the exact free boundary.
    pub(crate) fn kinks_of(&self, exact: &Exact<D>, region: usize) -> Option<Field<D>> {
        let contact = exact.contact.as_ref().filter(|_| self.problem.has_obstacle());
        let indicator = contact.map(|set| set.indicator.clone());
        let levels = self.data.source.of(region).and_then(|f| f.level()).cloned();
        let product = |a: Field<D>, b: Field<D>| -> Field<D> { Arc::new(move |x| a(x) * b(x)) };
        indicator.into_iter().chain(levels).reduce(product)
    }

    fn cell_error(
        &self,
        exact: &Reference<'_, T, D>,
        (table, terms): (&CellTable<f64>, &[Terms]),
        cut: Option<(&Field<D>, &CutRule)>,
        cell: usize,
        u: &[T],
    ) -> Result<SquaredErrors, Error> {
        let geometry = self.mesh.geometry(cell);
        let volume = geometry.volume.to_f64();
        let local = self.local_values(cell, u);
        let n = self.per_cell();
        let mut sum = SquaredErrors::default();
        // the derivatives of linear functions are those at any point
        let is_linear = self.basis_degree <= 1;
        let shares_of = |basis: &BasisAt<f64>| -> [Point<f64, D>; 4] {
            std::array::from_fn(|k| match k <= D {
                true => {
                    let slope: f64 = (0..n).map(|i| local[i] * basis.derivatives[i][k]).sum();
                    point_f64(geometry.gradient(k)) * slope
                }
                false => Point::zeros(),
            })
        };
        let of_linear = is_linear.then(|| shares_of(&table.basis[0]));
        let mut add = |x: &Point<f64, D>, weight: f64, basis: &BasisAt<f64>| {
            let shares = of_linear.unwrap_or_else(|| shares_of(basis));
            let error =
                shares[..=D].iter().fold(-exact.gradient(cell, x), |sum, share| sum + share);
            let value = data::finite(exact.value(cell, x), "exact solution", x, cell)?;
            let difference = basis.value(&local) - value;
            let square = data::finite(error.norm_squared(), "exact gradient", x, cell)?;
            let reaction = self.in_region(&self.data.reaction, cell, x).unwrap_or(0.0);
            let alpha = self.alpha_at(cell, x);
            sum.l2 += weight * volume * difference * difference;
            sum.h1 += weight * volume * square;
            sum.broken_energy +=
                weight * volume * (alpha * square + reaction * difference * difference);
            Ok::<(), Error>(())
        };
        let mut outcome = Ok(());
        let is_cut = cut.is_some_and(|(level, rule)| {
            rule.visit_if_cut(self.mesh, cell, level, &mut |point, x, weight| {
                if outcome.is_ok() {
                    outcome = add(x, weight, &self.basis_at(point));
                }
            })
        });
        outcome?;
        if !is_cut {
            for ((point, basis), &weight) in
                table.points.iter().zip(&table.basis).zip(&table.weights)
            {
                add(&self.cell_point(point, cell), weight, basis)?;
            }
        }
        for ((node, terms), value) in self.nodes.iter().zip(terms).zip(&local) {
            let exact_value: f64 =
                terms.iter().map(|(p, w)| w * exact.value(cell, &self.cell_point(p, cell))).sum();
            let x = self.node_point(cell, node);
            let exact_value = data::finite(exact_value, "exact solution", &x, cell)?;
            sum.max = sum.max.max((value - exact_value).abs());
        }
        Ok(sum)
    }
}

impl<T: Real, const D: usize> Space<'_, T, D> {
    /// Errors of a vector of unknowns; see `Discretisation::errors`.
    pub fn errors(
        &self,
        exact: &Exact<D>,
        form: Option<&dyn FacetForm<T, D>>,
        u: &[T],
    ) -> Result<Errors, Error> {
        let mut total = self.cell_errors(&Reference::Exact(exact), u)?;
        total.energy = total.broken_energy;
        if let (Some(neighbours), Some(form)) = (&self.neighbours, form) {
            total.energy += self.facet_error(form, neighbours, u)?;
        }
        Ok(total.roots())
    }

    /// The facet form at the jumps of the error.
    fn facet_error(
        &self,
        form: &dyn FacetForm<T, D>,
        neighbours: &Neighbours,
        u: &[T],
    ) -> Result<f64, Error> {
        let degree = form.moments(self.basis_degree);
        let table = self.facet_table(degree);
        let moments = FacetMoments::new(D, degree, &self.facet_rule);
        let value = |basis: &BasisAt<T>, local: &[f64; MAX_BASIS]| -> f64 {
            local.iter().zip(&basis.values).map(|(c, v)| c * v.to_f64()).sum()
        };
        let terms_of = |cell: usize, terms: &mut Vec<f64>| -> Result<(), Error> {
            let mine = self.local_values(cell, u);
            for local in 0..=D {
                let across = neighbours.across(cell, local);
                let jumps: Vec<f64> = match across {
                    Neighbour::Cell { cell: other, .. } if (other as usize) < cell => continue,
                    Neighbour::Cell { cell: other, local: other_local } => {
                        let theirs = self.local_values(other as usize, u);
                        let sides = table.on(local).iter().zip(table.on(other_local as usize));
                        sides.map(|(a, b)| value(a, &mine) - value(b, &theirs)).collect()
                    }
                    Neighbour::Boundary(BoundaryPart::Dirichlet) if !self.pins => {
                        let group = self.mesh.boundary_group(cell, local).unwrap_or(0);
                        let data = self.dirichlet_moments(&moments, (cell, local), group)?;
                        let sides = table.on(local).iter().zip(data);
                        sides.map(|(basis, g)| value(basis, &mine) - g).collect()
                    }
                    Neighbour::Boundary(_) => continue,
                };
                let Some(view) = self.facet_view(neighbours, cell, local) else { continue };
                let penalty = form.penalty(&view);
                for (jump, &degree) in jumps.into_iter().zip(&table.degrees) {
                    let trace = Trace { jump: T::lit(jump), flux: T::lit(0.0) };
                    let penalty = penalty * T::lit(form.moment_weight(degree));
                    let term = view.measure * form.integrand(&view, trace, trace, penalty);
                    terms.push(term.to_f64());
                }
            }
            Ok(())
        };
        let parts = cells::map(self.mesh.n_cells(), &|mut cells: Range<usize>| {
            let mut terms = Vec::new();
            cells.try_for_each(|cell| terms_of(cell, &mut terms)).map(|()| terms)
        });
        // added in the order of facets, for every number of threads
        let mut total = 0.0;
        for part in parts {
            total = part?.into_iter().fold(total, |sum, term| sum + term);
        }
        Ok(total)
    }
}

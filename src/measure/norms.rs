//! Errors against the exact solution.

use std::ops::Range;

use super::admissible::InCells;
use super::cell_errors::Counts;
use super::errors::Errors;
use super::evaluation::Reference;
use super::squared_errors::SquaredErrors;
use crate::assemble::Discretisation;
use crate::assemble::space::Space;
use crate::error::Error;
use crate::facet::{FacetForm, Trace};
use crate::instances::compiled;
use crate::parallel::cells;
use crate::problem::Exact;
use crate::quadrature::OrthonormalPolynomials;

impl<const D: usize> Discretisation<'_, D> {
    /// Errors of a vector of unknowns against the exact solution; none where there is no exact
    /// solution.
    ///
    /// The energy norm of the scheme is the broken seminorm weighted with the coefficient, plus the reaction
    /// term and that of Robin sides, plus the facet form at jumps without flux and without products of lifts, and at
    /// differences from Dirichlet data that the form imposes: for interior penalty the usual norm
    /// `|.|_1^2 + sum sigma_F ||[.]||^2`, for WOPSIP the square root of the form itself.
    ///
    /// # Errors
    /// [`Error::DataNotFinite`], [`Error::Parameter`] unless there is one value for each unknown.
    pub fn errors(&self, u: &[f64]) -> Result<Errors, Error> {
        self.check_length(u)?;
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
    /// Those of [`Discretisation::errors`].
    pub fn errors_against(&self, exact: &Exact<D>, u: &[f64]) -> Result<Errors, Error> {
        Ok(self.squared_errors(exact, u, &|_| true)?.norms())
    }

    /// Squares of the errors of [`Discretisation::errors_against`] over the cells for which `counts` is true and the
    /// facets whose cell of lower number is one of them: over the own cells of a [part](crate::mesh::Part::owns) of a
    /// mesh. Those of all parts merge into that of the whole, up to the rule that a cell is given: where what is not
    /// smooth of the error is less than `1e-8` of the mean over all cells that count, the rule of highest degree is
    /// left out.
    ///
    /// # Errors
    /// Those of [`Discretisation::errors`].
    pub fn squared_errors(
        &self,
        exact: &Exact<D>,
        u: &[f64],
        counts: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<SquaredErrors, Error> {
        self.check_length(u)?;
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &Exact<D>,
                &[f64],
                &(dyn Fn(usize) -> bool + Sync),
            ) -> Result<SquaredErrors, Error>
                = |of, exact, u, counts| of.squares_beside(exact, Some(u), None, counts)
        )(self, exact, u, counts)
    }

    /// Norms of the difference between `u` and a discrete function on the mesh of which this mesh is the
    /// refinement after some `refinements`: L2, H1 and the maximum over the nodes of this space.
    pub(crate) fn difference(
        &self,
        u: &[f64],
        (coarse, values, refinements): (&Discretisation<'_, D>, &[f64], usize),
    ) -> Result<Errors, Error> {
        compiled!(const D: fn(
                &Discretisation<'_, D>,
                &[f64],
                (&Discretisation<'_, D>, &[f64], usize),
            ) -> Result<Errors, Error>
                = |of, u, (coarse, values, refinements)| {
                    let space = &coarse.space;
                    let reference = Reference::Coarse { space, values, refinements };
                    let total = of.space.cell_errors(&reference, Some(u), None, &|_| true)?;
                    Ok(Errors { energy: None, ..total.norms() })
                }
        )(self, u, (coarse, values, refinements))
    }

    /// Squares of the errors of a vector of unknowns, zero without one, and of the error in the energy norm of a
    /// function in cells, by the values of the exact solution at the same points.
    pub(crate) fn squares_beside(
        &self,
        exact: &Exact<D>,
        u: Option<&[f64]>,
        function: Option<InCells<'_, D>>,
        counts: Counts<'_>,
    ) -> Result<SquaredErrors, Error> {
        let space = &self.space;
        let mut total = space.cell_errors(&Reference::Exact(exact), u, function, counts)?;
        if let Some(u) = u.filter(|_| self.form().couples()) {
            total.of_facets = space.facet_error(self.form(), u, counts)?;
        }
        Ok(total)
    }
}

impl<const D: usize> Space<'_, D> {
    /// The facet form at the jumps of the error, on the facets whose first cell counts.
    fn facet_error(
        &self,
        form: &dyn FacetForm<D>,
        u: &[f64],
        counts: Counts<'_>,
    ) -> Result<f64, Error> {
        let degree = form.moments(self.basis_degree);
        let table = self.facet_table(degree);
        let polynomials = OrthonormalPolynomials::new(D - 1, degree);
        let terms_of = |cell: usize, terms: &mut Vec<f64>| -> Result<(), Error> {
            for facet in self.form_facets_of(cell) {
                let jump = self.jump_on(facet, u, (&table, &polynomials))?;
                let view = self.facet_view(facet, None);
                let penalty = form.penalty(&view);
                for (k, &degree) in table.degrees.iter().enumerate() {
                    let trace = Trace { jump: jump(k), flux: 0.0 };
                    let penalty = penalty * form.moment_weight(degree);
                    let term = view.measure * form.integrand(&view, trace, trace, penalty);
                    terms.push(term);
                }
            }
            Ok(())
        };
        let chunks = cells::map(self.mesh.n_cells(), &|cells: Range<usize>| {
            let (mut terms, mut counted) = (Vec::new(), cells.filter(|&cell| counts(cell)));
            counted.try_for_each(|cell| terms_of(cell, &mut terms)).map(|()| terms)
        });
        // added in the order of facets, for every number of threads
        let mut total = 0.0;
        for chunk in chunks {
            total = chunk?.into_iter().fold(total, |sum, term| sum + term);
        }
        Ok(total)
    }
}

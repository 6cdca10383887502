//! Load, bounds and the whole inequality.

use super::Discretisation;
use crate::algebra::{Bound, Inequality, Start};
use crate::assemble::penalised_matrix::{keeps_penalty_apart, penalised_matrix};
use crate::assemble::space::contradictions::{Contradiction, refuse};
use crate::error::Error;
use crate::instances::compiled;

impl<const D: usize> Discretisation<'_, D> {
    /// The inequality: matrix, load, bounds, locations; that of the function less the constants of bodies
    /// ([`Discretisation::constants`]).
    ///
    /// # Errors
    /// [`Error::DataNotFinite`], [`Error::EmptyConstraint`].
    pub fn inequality(&self) -> Result<Inequality<f64>, Error> {
        compiled!(const D: fn(&Discretisation<'_, D>) -> Result<Inequality<f64>, Error>
                = |of| of.assemble()
        )(self)
    }
    fn assemble(&self) -> Result<Inequality<f64>, Error> {
        let is_penalised = self.owns_rows() && keeps_penalty_apart(self.form());
        let free = self.space.free_bodies()?;
        // the load of a penalised matrix has no Dirichlet data
        let metrics = || &self.prepared().0;
        let (load, data) = self.space.load_and_data(self.form(), &metrics, &free, !is_penalised)?;
        let bounds = self.bounds()?;
        let matrix = self.matrix();
        let dirichlet_energy = (!is_penalised && !data.is_empty())
            .then(|| self.space.dirichlet_energy(self.form(), &metrics, &data));
        let penalised = is_penalised.then(|| {
            let (metrics, weights) = self.prepared();
            penalised_matrix(&self.space, self.form(), (metrics, weights), &data)
        });
        // the loops that fill the matrix return no error: a reaction term that is not finite is
        // detected here
        if let Some(reaction) = &self.space.reaction
            && !matrix.values.iter().all(|v| v.is_finite())
        {
            reaction.check(self.mesh())?;
        }
        let mut inequality = Inequality {
            matrix,
            symmetric: self.form.is_symmetric(),
            load,
            bounds,
            locations: self.locations(),
            conforming_linear: self.space.is_conforming_linear(),
            start: Start::Cold,
            penalised,
            dirichlet_energy,
            kernel: Vec::new(),
            kinks: Vec::new(),
            bodies: Vec::new(),
            is_definite: self.is_coercive() && self.penalty_below_bound().is_none(),
            distribution: None,
        };
        self.space.set_kernel(&mut inequality, self.form.couples(), free);
        self.space.add_friction(&mut inequality)?;
        Ok(inequality)
    }
    /// The bounds of all unknowns.
    ///
    /// Obstacles bind the unknowns of the problem's constraint set. The Signorini condition binds those on contact
    /// facets, in the cell that has the facet. The set says whether the value of the datum or its mean binds a node. An
    /// unknown that Dirichlet data fix has no bound.
    ///
    /// # Errors
    /// [`Error::EmptyConstraint`], but on a [part](crate::mesh::Part) of a mesh: see
    /// [`check_bounds`](crate::processes::check_bounds). [`Error::DataNotFinite`].
    pub fn bounds(&self) -> Result<Vec<Bound<f64>>, Error> {
        compiled!(const D: fn(&Discretisation<'_, D>) -> Result<Vec<Bound<f64>>, Error>
                = |of| {
                    let (bounds, found) = of.space.bounds()?;
                    if !found.is_empty() && !of.mesh().is_part() {
                        let size = of.space.size_of_data(&bounds, &found);
                        refuse(&found, size, of.mesh(), &|_| true)
                            .map_err(|error| of.with_constants_in(error))?;
                    }
                    Ok(bounds)
                }
        )(self)
    }
    /// Lower bounds that exceed upper ones, and the size of the data: two bounds contradict each other if they differ by
    /// more than rounding of the largest size in all [parts](crate::mesh::Part) of a mesh.
    pub(crate) fn contradictions(&self) -> Result<(Vec<Contradiction<D>>, f64), Error> {
        let (bounds, found) = self.space.bounds()?;
        let size = self.space.size_of_data(&bounds, &found);
        Ok((found, size))
    }
    /// An error with the values that the caller gave.
    fn with_constants_in(&self, mut error: Error) -> Error {
        if let Error::EmptyConstraint { cell, lower, upper, .. } = &mut error {
            let constant = self.space.body_constants.of_cell(*cell as usize);
            (*lower, *upper) = (*lower + constant, *upper + constant);
        }
        error
    }
    /// The load of the assembled matrix, with weak Dirichlet data, for all unknowns: see
    /// [`Inequality::assembled_load`].
    ///
    /// # Errors
    /// [`Error::DataNotFinite`].
    pub fn load(&self) -> Result<Vec<f64>, Error> {
        compiled!(const D: fn(&Discretisation<'_, D>) -> Result<Vec<f64>, Error>
                = |of| {
                    let (free, metrics) = (of.space.free_bodies()?, || &of.prepared().0);
                    Ok(of.space.load_and_data(of.form(), &metrics, &free, true)?.0)
                }
        )(self)
    }
}

//! Files of a result for ParaView.

use std::path::{Path, PathBuf};

use super::Solved;
use crate::error::{Error, write_error};
use crate::instances::compiled;
use crate::measure::Fields;
use crate::mesh::{HalfFacet, Layers};
use crate::paraview::VtuFile;
use crate::problem::DataOnMesh;
use crate::real::Point;

/// Adds to a file of fields.
type Complete<'c, const D: usize> = &'c dyn for<'f> Fn(VtuFile<'f, D>) -> VtuFile<'f, D>;

impl<const D: usize> Solved<'_, D> {
    /// The value of this solution at a point of a cell of a coarser mesh of the same hierarchy, which is at
    /// this position; the cell of this mesh is found through the cells between.
    fn value_within(&self, position: usize, cell: usize, x: &Point<D>) -> f64 {
        let Some((hierarchy, own)) = self.hierarchy else { return f64::NAN };
        let child = |parent: usize, position: usize| {
            let least = |child: usize| {
                let lambda = hierarchy.mesh(position).barycentric(child, x);
                lambda[..=D].iter().copied().fold(f64::INFINITY, f64::min)
            };
            let children = parent << D..(parent + 1) << D;
            children.max_by(|&a, &b| least(a).total_cmp(&least(b))).unwrap_or(parent)
        };
        let cell = (position + 1..=own).fold(cell, child);
        self.discretisation().value_in(&self.solution.values, cell, x)
    }
    /// Writes a `.vtu` file, and its folder if there is none: see [`Self::write_vtu_with`].
    ///
    /// # Errors
    /// [`Error::Write`], also without an iterate.
    pub fn write_vtu(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        self.write_vtu_with(path, |file| file)
    }
    /// Writes a `.vtu` file to which `complete` adds fields, and its folder if there is none.
    ///
    /// The solution `u` is written in its degree; above two it is interpolated in degree two. Point data:
    /// `obstacle` (the lower one, or the upper one where there is no lower one), `upper_obstacle` where
    /// there are both, `error`, which is `u` less the exact solution where that is known (for rows of a study
    /// with a reference: less the reference). Cell data of obstacle problems: `multiplier` and `contact` of
    /// [`Fields`](crate::measure::Fields); of all for which there is one, `bound`, the share of the cell in the square
    /// of the error bound ([`ErrorBound::cells`](crate::error_bound::ErrorBound::cells)), `flux`, the mean of the flux of
    /// the bound, and on the facets of the boundary `normal_flux`, the mean of its normal component, outward; of all
    /// problems `gradient`, the mean of that of `u`. The flux balances load, multiplier and forces in each cell and on each
    /// facet; the coefficient times the gradient does not. Linear functions on whole meshes have as point data
    /// `recovered_gradient` ([`DiscreteFunction::recovered_gradient`](crate::problem::DiscreteFunction::recovered_gradient)).
    /// The facets of the boundary are further cells, of `dimension` `D - 1`. Those of the contact boundary have
    /// `pressure` and `gap` of these fields and `contact`, which is one on facets in contact as a whole; the integral of `pressure` over them is the
    /// total contact force. Each region and each boundary group is an array called by its name, one in the group and
    /// zero elsewhere.
    ///
    /// # Errors
    /// [`Error::Write`], also without an iterate.
    pub fn write_vtu_with(
        &self,
        path: impl AsRef<Path>,
        complete: impl for<'f> Fn(VtuFile<'f, D>) -> VtuFile<'f, D>,
    ) -> Result<(), Error> {
        self.write_vtu_against(path.as_ref(), None, complete)
    }
    /// As [`Self::write_vtu_with`]; where there is a solution on a finer mesh of the same hierarchy, `error` is
    /// the difference from that.
    pub(crate) fn write_vtu_against(
        &self,
        path: &Path,
        reference: Option<&Solved<'_, D>>,
        complete: impl for<'f> Fn(VtuFile<'f, D>) -> VtuFile<'f, D>,
    ) -> Result<(), Error> {
        compiled!(const D: for<'s, 'x, 'p, 'r, 'y, 'c> fn(
                &'s Solved<'x, D>,
                &'p Path,
                Option<&'r Solved<'y, D>>,
                Complete<'c, D>,
            ) -> Result<(), Error>
                = |solved, path, reference, complete| {
                    solved.write_fields(path, reference, complete, None)
                }
        )(self, path, reference, &complete)
    }
    /// Writes the fields on own cells of all parts as `STEM.N.vtu`, `N` the number of the part, and, the first process,
    /// the list of all parts as `STEM.pvtu`: see [`Self::write_vtu_with`]. All parts call it.
    ///
    /// # Errors
    /// [`Error::Write`] without an iterate and on a whole mesh; [`Error::Processes`] in all parts if one cannot write
    /// its file.
    pub fn write_vtu_of_parts(
        &self,
        directory: &Path,
        stem: &str,
        complete: impl for<'f> Fn(VtuFile<'f, D>) -> VtuFile<'f, D>,
    ) -> Result<(), Error> {
        let list = directory.join(format!("{stem}.pvtu"));
        let Some(over_parts) = self.system.over_parts() else {
            return Err(write_error(&list, "the mesh is not in parts".to_owned()));
        };
        let piece = |number: usize| directory.join(format!("{stem}.{number}.vtu"));
        let pieces: Vec<PathBuf> = (0..over_parts.exchange.parts()).map(piece).collect();
        let number = over_parts.number as usize;
        let list = (number == 0).then_some((&*list, &pieces[..]));
        self.system.agreed(self.write_fields(&pieces[number], None, &complete, list))
    }
    fn write_fields(
        &self,
        path: &Path,
        reference: Option<&Solved<'_, D>>,
        complete: Complete<'_, D>,
        list: Option<(&Path, &[PathBuf])>,
    ) -> Result<(), Error> {
        // all parts exchange multipliers and bounds
        let Some(fields) = self.fields() else {
            return Err(write_error(path, format!("no solution: {}", self.outcome())));
        };
        let gradients = self.gradient_fields();
        let u = fields.values_by_cell(D);
        let in_contact = in_contact(&fields);
        let [u, multiplier, contact] =
            [u, fields.multiplier, fields.contact].map(|values| self.of_own_cells(values));
        let [pressure, gap, in_contact] = [fields.pressure, fields.gap, in_contact]
            .map(|values| self.of_own_facets(&fields.contact_boundary, values));
        let facets = self.own_facets(fields.contact_boundary);
        let own = self
            .part()
            .map(|part| part.mesh.part(&part.owners, part.number, Layers::across_facets(0)));
        let own = own.transpose()?;
        let mesh = own.as_ref().map_or(self.mesh(), |own| &own.mesh);
        let problem = self.discretisation().problem();
        let data = DataOnMesh::new(problem, mesh)?;
        let mut file = VtuFile::new(mesh, &u);
        let bounds = [&data.lower, &data.upper].into_iter().filter(|bound| bound.is_given());
        for (name, bound) in ["obstacle", "upper_obstacle"].into_iter().zip(bounds) {
            file = file.function_in_cells(name, |cell, x| {
                bound.of(mesh.region(cell)).map_or(f64::NAN, |bound| bound.in_cell(mesh, cell, x))
            });
        }
        file = gradients.add_to(file);
        match (reference.filter(|r| r.has_iterate).zip(self.hierarchy), &problem.exact) {
            (Some((reference, (_, own))), _) => {
                file =
                    file.error_from_in_cells(move |cell, x| reference.value_within(own, cell, x));
            }
            (None, Some(exact)) => file = file.error_from_in_cells(|_, x| exact.value.at(x)),
            (None, None) => {}
        }
        if problem.has_obstacle() {
            file = file.on_cells("multiplier", &multiplier);
            file = file.on_cells("contact", &contact);
        }
        if problem.acts_on_boundary() {
            file = file.on_facets("pressure", &facets, &pressure);
            file = file.on_facets("gap", &facets, &gap);
            if !problem.has_obstacle() {
                file = file.on_facets("contact", &facets, &in_contact);
            }
        }
        let file = complete(file);
        file.write(path)?;
        list.map_or(Ok(()), |(list, pieces)| file.write_list(list, pieces))
    }

    /// What own cells have, from values by cell. The file of a part has the own cells in their order.
    pub(super) fn of_own_cells<V: Clone>(&self, values: Vec<V>) -> Vec<V> {
        let Some(part) = self.part().filter(|_| !values.is_empty()) else { return values };
        let by_cell = values.chunks_exact(values.len() / part.owners.len()).enumerate();
        by_cell.filter(|(cell, _)| part.owns(*cell)).flat_map(|(_, own)| own).cloned().collect()
    }
    /// The numbers of the facets of own cells, from numbers by facet.
    pub(super) fn of_own_facets(&self, facets: &[HalfFacet], values: Vec<f64>) -> Vec<f64> {
        let Some(part) = self.part() else { return values };
        let by_facet = facets.iter().zip(values);
        by_facet.filter(|((cell, _), _)| part.owns(*cell)).map(|(_, value)| value).collect()
    }
    /// The facets of own cells, each with the number of its cell among own cells.
    pub(super) fn own_facets(&self, facets: Vec<HalfFacet>) -> Vec<HalfFacet> {
        let Some(part) = self.part() else { return facets };
        let own: Vec<usize> = (0..part.owners.len()).filter(|&cell| part.owns(cell)).collect();
        let number = |(cell, local)| Some((own.binary_search(&cell).ok()?, local));
        facets.into_iter().filter_map(number).collect()
    }
}

/// For each facet of the contact boundary one if it is in contact as a whole, else zero.
fn in_contact(fields: &Fields) -> Vec<f64> {
    // facets in contact are listed in the order of the contact boundary
    let mut touching = fields.discrete_contact.facets.iter().peekable();
    let state = |place| if touching.next_if_eq(&place).is_some() { 1.0 } else { 0.0 };
    fields.contact_boundary.iter().map(state).collect()
}

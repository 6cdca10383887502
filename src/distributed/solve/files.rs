//! Files of a solution over parts for ParaView.

use std::path::{Path, PathBuf};

use super::solved::DistributedSolved;
use crate::distributed::agree::agree;
use crate::distributed::error::ExchangeError;
use crate::error::Error;
use crate::measure::Fields;
use crate::mesh::Layers;
use crate::paraview::{FieldScalar, VtuFile};
use crate::problem::DataOnMesh;

impl<const D: usize> DistributedSolved<'_, D> {
    /// Writes the fields on own cells as `STEM.N.vtu`, `N` the number of the part, and, the first process, the
    /// list of all parts as `STEM.pvtu`; all parts call it. The fields are those of one process
    /// ([`Solved::write_vtu_with`](crate::nested::Solved::write_vtu_with)), without error bound and the contact state
    /// of facets.
    ///
    /// # Errors
    /// [`ExchangeError::Failed`] in all parts if one cannot write its file.
    pub fn write_vtu(
        &self,
        directory: &Path,
        stem: &str,
        scalar: FieldScalar,
    ) -> Result<(), ExchangeError> {
        let parts = self.exchange().parts();
        let piece = |number: usize| directory.join(format!("{stem}.{number}.vtu"));
        let pieces: Vec<PathBuf> = (0..parts).map(piece).collect();
        let list = directory.join(format!("{stem}.pvtu"));
        // all parts exchange multipliers
        let fields = self.discretisation().fields(self.inequality(), self.solution());
        agree(self.write_part(&fields, &pieces, &list, scalar), self.exchange())
    }

    fn write_part(
        &self,
        fields: &Fields,
        pieces: &[PathBuf],
        list: &Path,
        scalar: FieldScalar,
    ) -> Result<(), Error> {
        let (part, problem) = (self.part(), self.discretisation().problem());
        let own = part.mesh.part(&part.owners, part.number, Layers::across_facets(0))?;
        let data = DataOnMesh::new(problem, &own.mesh)?;
        let is_own = |cell: &usize| part.owns(*cell);
        let values = fields.values_by_cell(D);
        let per_cell = values.len() / part.owners.len();
        let u: Vec<f64> = (0..part.owners.len())
            .filter(is_own)
            .flat_map(|cell| &values[cell * per_cell..(cell + 1) * per_cell])
            .copied()
            .collect();
        let on_cells = |values: &[f64]| -> Vec<f64> {
            values.iter().enumerate().filter(|(cell, _)| is_own(cell)).map(|(_, &x)| x).collect()
        };
        let multiplier = on_cells(&fields.multiplier);
        let contact = on_cells(&fields.contact);
        let mut numbers = vec![usize::MAX; part.owners.len()];
        let own_cells = (0..part.owners.len()).filter(is_own);
        own_cells.enumerate().for_each(|(number, cell)| numbers[cell] = number);
        let places = fields.contact_boundary.iter().enumerate();
        let own_places: Vec<(usize, (usize, usize))> =
            places.filter(|(_, (cell, _))| is_own(cell)).map(|(k, &place)| (k, place)).collect();
        let facets: Vec<(usize, usize)> =
            own_places.iter().map(|&(_, (cell, local))| (numbers[cell], local)).collect();
        let on_facets =
            |values: &[f64]| -> Vec<f64> { own_places.iter().map(|&(k, _)| values[k]).collect() };
        let (pressure, gap) = (on_facets(&fields.pressure), on_facets(&fields.gap));
        let mesh = &own.mesh;
        let mut file = VtuFile::new(mesh, &u).scalar(scalar);
        let bounds = [&data.lower, &data.upper].into_iter().filter(|bound| bound.is_given());
        for (name, bound) in ["obstacle", "upper_obstacle"].into_iter().zip(bounds) {
            file = file.function_in_cells(name, |cell, x| {
                bound.of(mesh.region(cell)).map_or(f64::NAN, |bound| bound.at(x))
            });
        }
        if let Some(exact) = &problem.exact {
            file = file.error_from(&*exact.value);
        }
        if problem.has_obstacle() {
            file = file.on_cells("multiplier", &multiplier).on_cells("contact", &contact);
        }
        if problem.has_gap() {
            file = file.on_facets("pressure", &facets, &pressure).on_facets("gap", &facets, &gap);
        }
        file.write(&pieces[part.number as usize])?;
        if part.number == 0 { file.write_list(list, pieces) } else { Ok(()) }
    }
}

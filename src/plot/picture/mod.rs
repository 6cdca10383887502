//! Pictures of a solution: in the plane panels with the function and with the contact set found against the
//! exact free boundary; on the line a curve; in space the solution on the surface and the contact set, seen from outside.
//!
//! A discontinuous function is drawn cell by cell as it is. The bands of a colour are cut exactly
//! along the levels of the function on each cell, of a quadratic one on the pieces between vertices
//! and midpoints, where it is drawn as linear.

mod axes;
mod bands;
mod colour;
mod level_line;
mod line;
mod panel;
mod plane;
mod space;
mod triangle;

use std::path::{Path, PathBuf};

use super::pen::{Align, Pen, ScreenPoint};
use super::style::INK;
use crate::error::Error;
use crate::files::replace_text;
use crate::instances::compiled;
use crate::measure::Fields;
use crate::mesh::{Mesh, edge_vertices};
use crate::problem::Problem;
use panel::Panel;
use plane::Plane;

/// Most lines and areas of an SVG file; with more it would be large and slow to show.
const MOST_SHAPES: usize = 150_000;

/// Widths of panels in one column and in two columns.
const WIDE: f64 = 430.0;
const NARROW: f64 = 276.0;
const MARGIN: f64 = 8.0;
const HEADING: f64 = 28.0;
const GAP: f64 = 10.0;

/// A picture of a solution.
///
/// ```
/// use unilateral::prelude::*;
/// use unilateral::plot::Picture;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let scene = scenes::radial::<2>(1.0);
/// let meshes = Hierarchy::<2>::of_domain(&scene.domain, 8)?;
/// let solved = solve(&scene.problem, &meshes, &Wopsip::default())?;
/// if let Some(fields) = solved.fields() {
///     let picture = Picture::of("wopsip", &scene.problem, solved.mesh(), &fields)?;
///     assert!(picture.to_svg()?.starts_with("<svg"));
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Picture {
    title: String,
    panels: Vec<Panel>,
}

impl Picture {
    /// The picture of a function on a mesh, that of a scheme for this problem.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the fields are not those of the mesh.
    pub fn of<const D: usize>(
        title: &str,
        problem: &Problem<D>,
        mesh: &Mesh<D>,
        fields: &Fields,
    ) -> Result<Self, Error> {
        compiled!(
            const D: fn(&str, &Problem<D>, &Mesh<D>, &Fields) -> Result<Picture, Error>
                = Picture::painted::<D>
        )(title, problem, mesh, fields)
    }
    fn painted<const D: usize>(
        title: &str,
        problem: &Problem<D>,
        mesh: &Mesh<D>,
        fields: &Fields,
    ) -> Result<Self, Error> {
        check_fields(mesh, fields)?;
        let panels = match D {
            1 => vec![line::solution(problem, mesh, fields)],
            2 => Plane::of_cells(problem, mesh, fields).panels(),
            _ => space::panels(problem, mesh, fields),
        };
        Ok(Picture { title: title.to_owned(), panels })
    }

    /// The picture as the text of an SVG file.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it has more shapes than such a file should.
    pub fn to_svg(&self) -> Result<String, Error> {
        let shapes: usize = self.panels.iter().map(|p| p.fills.len() + p.lines.len()).sum();
        if shapes > MOST_SHAPES {
            let allowed = format!(
                "an SVG file of more than {MOST_SHAPES} would be large and slow to show; choose a coarser level"
            );
            return Err(Error::parameter("shapes", shapes, allowed));
        }
        let (panels, width, size) = self.layout();
        let mut pen = Pen::new(size, true);
        let heading = (0.5 * size.0, MARGIN + 0.4 * HEADING);
        pen.text(&self.title, heading, axes::TITLE + 1.0, INK, Align::Centre);
        for (panel, at) in panels {
            panel.draw(&mut pen, at, width);
        }
        Ok(pen.finish())
    }

    /// Writes `NAME.svg` to a directory, which is made if need be.
    ///
    /// # Errors
    /// [`Error::Write`], and those of [`Self::to_svg`].
    pub fn write(&self, directory: &Path, name: &str) -> Result<PathBuf, Error> {
        replace_text(&directory.join(format!("{name}.svg")), &self.to_svg()?)
    }

    /// Panels row by row with their upper left corners, their width, and the size of the picture.
    fn layout(&self) -> (Vec<(&Panel, ScreenPoint)>, f64, (f64, f64)) {
        let (columns, width) = if self.panels.len() == 1 { (1, WIDE) } else { (2, NARROW) };
        let mut placed = Vec::new();
        let mut y = MARGIN + HEADING;
        for row in self.panels.chunks(columns) {
            for (k, panel) in row.iter().enumerate() {
                placed.push((panel, (MARGIN + k as f64 * width, y)));
            }
            y += row.iter().map(|p| p.height(width)).fold(0.0, f64::max) + GAP;
        }
        (placed, width, (2.0 * MARGIN + columns as f64 * width, y))
    }
}

/// Refuses fields that would be read beyond their ends.
fn check_fields<const D: usize>(mesh: &Mesh<D>, fields: &Fields) -> Result<(), Error> {
    let n = mesh.n_cells();
    let found = &fields.discrete_contact;
    let fits = fields.u.len() == n * (D + 1)
        && [0, n * edge_vertices(D).len()].contains(&fields.midpoints.len())
        && found.cells.iter().all(|&cell| cell < n)
        && found.facets.iter().all(|&(cell, local)| cell < n && local <= D);
    match fits {
        true => Ok(()),
        false => {
            let allowed = format!("must be those of a scheme on this mesh of {n} cells");
            Err(Error::parameter("fields", format!("{} values", fields.u.len()), allowed))
        }
    }
}

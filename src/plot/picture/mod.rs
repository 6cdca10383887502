//! Pictures of a solution: in the plane panels with the function and with the contact set found against the
//! exact free boundary; on the line a curve; in space the solution on the surface and the contact set, seen from outside.
//!
//! A discontinuous function is drawn cell by cell as it is. The bands of a colour are cut exactly
//! along the levels of the function on each cell, of a quadratic one on the pieces between vertices
//! and midpoints, where it is drawn as linear.

mod axes;
mod bands;
mod colour;
mod edges;
mod graph;
mod level_line;
mod line;
mod map;
mod panel;
mod plane;
mod space;
mod trace;
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
use graph::Graph;
use line::Line;
use panel::Panel;
use plane::Plane;
use space::Space;

/// Most lines and areas of an SVG file; with more it would be large and slow to show.
const MOST_SHAPES: usize = 150_000;

/// Widths of panels in one column and in two columns.
const WIDE: f64 = 430.0;
const NARROW: f64 = 276.0;
/// A domain this much wider than high gets a row to itself.
const ELONGATED: f64 = 3.0;
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
            1 => vec![Panel::Graph(Line::new(problem, mesh, fields).solution())],
            2 => Plane::of_cells(problem, mesh, fields).panels(),
            _ => Space::new(problem, mesh, fields).panels(),
        };
        Ok(Picture { title: title.to_owned(), panels })
    }

    /// A picture of curves over one quantity: the names of the axes, and each curve's name with its points.
    pub fn of_curves(title: &str, axes: [&str; 2], curves: &[(&str, Vec<[f64; 2]>)]) -> Self {
        let panels = vec![Panel::Graph(Graph::of_curves(axes, curves))];
        Picture { title: title.to_owned(), panels }
    }

    /// The picture as the text of an SVG file.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it has more shapes than such a file should.
    pub fn to_svg(&self) -> Result<String, Error> {
        let shapes: usize = self.panels.iter().map(Panel::shapes).sum();
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
            match panel {
                Panel::Map(map) => map.draw(&mut pen, at, width),
                Panel::Graph(graph) => graph.draw(&mut pen, at, width),
            }
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
        let alone = self.panels.first().is_some_and(|panel| match panel {
            Panel::Map(map) => map.high[0] - map.low[0] > ELONGATED * (map.high[1] - map.low[1]),
            Panel::Graph(_) => true,
        });
        let alone = alone || self.panels.len() == 1;
        let (columns, width) = if alone { (1, WIDE) } else { (2, NARROW) };
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
        && [0, mesh.vertices().len()].contains(&found.density.len())
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

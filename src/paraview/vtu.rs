//! Fields on a mesh as a VTK XML file of an unstructured grid.
//!
//! A function is written in its own degree, one or two, on cells of that degree. Arrays follow the text of
//! the file as raw bytes, compressed by zlib: the smallest encoding of the format, and the one that ParaView
//! writes itself.

use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::iter::repeat_n;
use std::path::{Path, PathBuf};

use super::encode::{Arrays, doubles, integers};
use super::grid::{Grid, values_per_cell};
use super::groups::{array_names, members};
use super::pvd::relative_to;
use crate::arrays::{array_of, map_entries};
use crate::error::Error;
use crate::files::{replace, replace_text};
use crate::input::escaped;
use crate::instances::compiled;
use crate::mesh::{BoundaryFacet, Mesh, edge_vertices};
use crate::real::Point;

/// A function of space that may jump between cells: of the number of a cell and a point in it.
type InCell<'a, const D: usize> = Box<dyn Fn(usize, &Point<D>) -> f64 + 'a>;

/// Data on facets: their name, the facets as cell and number in the cell, and a value for each.
type OnFacets<'a> = (&'a str, &'a [(usize, usize)], &'a [f64]);

/// A function on the cells of a mesh with further fields, to be written as a `.vtu` file.
///
/// ```
/// use unilateral::mesh::{BoxDomain, Mesh};
/// use unilateral::paraview::VtuFile;
/// use unilateral::real::Point;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let square = BoxDomain::dirichlet(Point::from([0.0, 0.0]), Point::from([1.0, 1.0]));
/// let mesh = Mesh::<2>::kuhn_box(&square, [1, 1])?;
/// let u = [0.0, 1.0, 2.0, 0.0, 1.5, 2.0];
/// let path = std::env::temp_dir().join(format!("unilateral-{}.vtu", std::process::id()));
/// VtuFile::new(&mesh, &u).function("distance", &|x| x.norm()).write(&path)?;
/// # let _ = std::fs::remove_file(path);
/// # Ok(())
/// # }
/// ```
#[must_use]
pub struct VtuFile<'a, const D: usize> {
    mesh: &'a Mesh<D>,
    u: &'a [f64],
    functions: Vec<(&'a str, InCell<'a, D>)>,
    exact: Option<InCell<'a, D>>,
    on_cells: Vec<(&'a str, &'a [f64])>,
    on_facets: Vec<OnFacets<'a>>,
    vectors: Vec<(&'a str, Vectors<'a, D>)>,
    numbers: Vec<(String, f64)>,
}

/// Vectors, one for each cell or one for each vertex of the mesh.
#[derive(Clone, Copy)]
enum Vectors<'a, const D: usize> {
    OnCells(&'a [Point<D>]),
    AtVertices(&'a [Point<D>]),
}

impl<const D: usize> fmt::Debug for VtuFile<'_, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("VtuFile")
            .field("cells", &self.mesh.n_cells())
            .field("boundary facets", &self.mesh.boundary().len())
            .finish_non_exhaustive()
    }
}

impl<'a, const D: usize> VtuFile<'a, D> {
    /// A file with a function as the point data `u`. The function has `D + 1` values for each cell, at
    /// its vertices in order, or `(D + 1)(D + 2)/2`, then those at the midpoints of its edges in the order
    /// of [`Layout::edge`](crate::element::Layout::edge): linear cells (types 3, 5, 10) or quadratic ones
    /// (21, 22, 24). Cells share their points if the values of all cells agree at every point up to
    /// rounding; otherwise each cell has its own points, so that jumps are visible.
    pub fn new(mesh: &'a Mesh<D>, u: &'a [f64]) -> Self {
        Self {
            mesh,
            u,
            functions: Vec::new(),
            exact: None,
            on_cells: Vec::new(),
            on_facets: Vec::new(),
            vectors: Vec::new(),
            numbers: Vec::new(),
        }
    }
    /// Adds a function of space as point data.
    pub fn function(self, name: &'a str, f: &'a (dyn Fn(&Point<D>) -> f64 + 'a)) -> Self {
        self.function_in_cells(name, move |_, x| f(x))
    }
    /// Adds a function of cell and point as point data. Points that cells share have the value from one of
    /// them.
    pub fn function_in_cells(
        mut self,
        name: &'a str,
        f: impl Fn(usize, &Point<D>) -> f64 + 'a,
    ) -> Self {
        self.functions.push((name, Box::new(f)));
        self
    }
    /// Adds the difference of `u` from a function of cell and point as the point data `error`.
    pub fn error_from_in_cells(mut self, exact: impl Fn(usize, &Point<D>) -> f64 + 'a) -> Self {
        self.exact = Some(Box::new(exact));
        self
    }
    /// Adds cell data, one value for each cell.
    pub fn on_cells(mut self, name: &'a str, values: &'a [f64]) -> Self {
        self.on_cells.push((name, values));
        self
    }
    /// Adds cell data with one value for each of these facets (cell, number in the cell) of the boundary.
    pub fn on_facets(
        mut self,
        name: &'a str,
        facets: &'a [(usize, usize)],
        values: &'a [f64],
    ) -> Self {
        self.on_facets.push((name, facets, values));
        self
    }
    /// Adds cell data, one vector for each cell.
    pub fn vectors_on_cells(mut self, name: &'a str, vectors: &'a [Point<D>]) -> Self {
        self.vectors.push((name, Vectors::OnCells(vectors)));
        self
    }
    /// Adds point data, one vector for each vertex of the mesh; at midpoints of edges the mean of the ends.
    pub fn vectors_at_vertices(mut self, name: &'a str, vectors: &'a [Point<D>]) -> Self {
        self.vectors.push((name, Vectors::AtVertices(vectors)));
        self
    }
    /// Adds a number to the field data.
    pub fn number(mut self, name: &str, value: f64) -> Self {
        self.numbers.push((name.to_owned(), value));
        self
    }

    /// Writes the file, and its folder if there is none; it takes the place of an earlier one when it is
    /// whole. Numbers have 64 bits. Points have three coordinates, missing ones zero. The facets of the boundary are
    /// linear cells of dimension `D - 1` after those of the mesh. The cell data `dimension` is that of each cell, `D` for the cells
    /// of the mesh and `D - 1` for facets. Cell data of one name on cells and on facets are one array;
    /// where there is no value they are not a number. Each named group of cells or of boundary facets is an array of
    /// small integers, called by its name: one in the group, zero elsewhere. Where a field has the name, `_group`
    /// follows it.
    ///
    /// # Errors
    /// [`Error::Write`] if a field has not the length that the mesh needs, or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        compiled!(
            const D: fn(&VtuFile<'_, D>, &Path) -> Result<(), Error>
                = |file, path| file.write_checked(path)
        )(self, path)
    }
    fn write_checked(&self, path: &Path) -> Result<(), Error> {
        let written = replace(path, |draft| {
            let n = self.check()?;
            let arrays = self.arrays(&Grid::new(self.mesh, self.u, n))?;
            let mut file = BufWriter::new(File::create(draft)?);
            arrays.write(&mut file)?;
            file.flush()
        });
        written.map(drop)
    }

    /// Writes a `.pvtu` file that lists the files of the parts of a mesh, each with the fields of this one. Files
    /// in its own directory are named relative to it.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn write_list(&self, path: &Path, parts: &[PathBuf]) -> Result<(), Error> {
        let typed = |kind: &str, name: &str, components: &str| {
            format!("<PDataArray type=\"{kind}\" Name=\"{}\"{components}/>\n", escaped(name))
        };
        let array = |name: &str| typed("Float64", name, "");
        let vector = |name: &str| typed("Float64", name, " NumberOfComponents=\"3\"");
        let functions = self.functions.iter().map(|(name, _)| *name);
        let of_points = functions.chain(self.exact.as_ref().map(|_| "error")).chain(["u"]);
        let mut of_points: String = of_points.map(array).collect();
        let mut of_cells: String = self.cell_names().into_iter().map(array).collect();
        for (name, vectors) in &self.vectors {
            match vectors {
                Vectors::OnCells(_) => of_cells += &vector(name),
                Vectors::AtVertices(_) => of_points += &vector(name),
            }
        }
        let names = ["dimension".to_owned()].into_iter();
        let names = names.chain(self.groups().into_iter().map(|(name, _)| name));
        of_cells.extend(names.map(|name| typed("UInt8", &name, "")));
        let directory = path.parent().unwrap_or(Path::new(""));
        let source =
            |part: &PathBuf| format!("<Piece Source=\"{}\"/>\n", relative_to(directory, part));
        let sources: String = parts.iter().map(source).collect();
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <PUnstructuredGrid GhostLevel=\"0\">\n<PPointData Scalars=\"u\">\n{of_points}</PPointData>\n\
             <PCellData>\n{of_cells}</PCellData>\n\
             <PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n\
             {sources}</PUnstructuredGrid>\n</VTKFile>\n"
        );
        replace_text(path, &text).map(drop)
    }

    /// The names of cell data, each once.
    fn cell_names(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        let on_facets = self.on_facets.iter().map(|(name, ..)| *name);
        for name in self.on_cells.iter().map(|(name, _)| *name).chain(on_facets) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// The groups of the mesh: the name of the array of each, and its own.
    fn groups(&self) -> Vec<(String, &str)> {
        let vectors = self.vectors.iter().map(|(name, _)| *name);
        let fields = self.cell_names().into_iter().chain(vectors).chain(["dimension"]);
        array_names(self.mesh, fields.map(str::to_owned).collect())
    }

    /// Number of values of each cell. Refuses a field whose length does not fit the mesh, and facets that
    /// are not on its boundary.
    fn check(&self) -> io::Result<usize> {
        let refuse = |why: String| Err(io::Error::new(io::ErrorKind::InvalidInput, why));
        let wrong = |name: &str, length: usize, needed: usize| {
            refuse(format!("field {name} has {length} values, the mesh needs {needed}"))
        };
        let cells = self.mesh.n_cells();
        let [linear, quadratic] = map_entries([1, 2], |degree| values_per_cell(D, degree));
        let n = if self.u.len() == cells * quadratic { quadratic } else { linear };
        if self.u.len() != cells * n {
            return wrong("u", self.u.len(), cells * n);
        }
        if let Some((name, values)) = self.on_cells.iter().find(|(_, v)| v.len() != cells) {
            return wrong(name, values.len(), cells);
        }
        for (name, vectors) in &self.vectors {
            let (length, needed) = match vectors {
                Vectors::OnCells(vectors) => (vectors.len(), cells),
                Vectors::AtVertices(vectors) => (vectors.len(), self.mesh.vertices().len()),
            };
            if length != needed {
                return wrong(name, length, needed);
            }
        }
        for (name, facets, values) in &self.on_facets {
            if values.len() != facets.len() {
                return wrong(name, values.len(), facets.len());
            }
            if let Some((cell, local)) = facets.iter().find(|place| self.position(place).is_none())
            {
                return refuse(format!(
                    "field {name}: facet {local} of cell {cell} is not on the boundary of the mesh"
                ));
            }
        }
        Ok(n)
    }

    /// The position of a facet in the list of the boundary.
    fn position(&self, &(cell, local): &(usize, usize)) -> Option<usize> {
        let place = |f: &BoundaryFacet| (f.cell as usize, usize::from(f.local));
        self.mesh.boundary().binary_search_by_key(&(cell, local), place).ok()
    }

    /// The text of the file and its arrays.
    fn arrays(&self, grid: &Grid<D>) -> io::Result<Arrays> {
        let mut arrays = Arrays::default();
        let to = &mut arrays;
        let (n_points, n_cells) = (grid.points.len(), grid.types.len());
        writeln!(
            to.text,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\" \
             compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>"
        )?;
        self.push_field_data(to)?;
        writeln!(to.text, "<Piece NumberOfPoints=\"{n_points}\" NumberOfCells=\"{n_cells}\">")?;
        writeln!(to.text, "<PointData Scalars=\"u\">")?;
        let u: Vec<f64> = grid.sources.iter().map(|&k| self.u[k]).collect();
        let per_cell = self.u.len() / self.mesh.n_cells();
        for (name, f) in &self.functions {
            let places = grid.sources.iter().map(|k| k / per_cell).zip(&grid.points);
            push_floats(to, name, &mut places.map(|(cell, x)| f(cell, x)))?;
        }
        if let Some(exact) = &self.exact {
            let places = grid.sources.iter().map(|k| k / per_cell).zip(&grid.points);
            let mut error = u.iter().zip(places).map(|(u, (cell, x))| u - exact(cell, x));
            push_floats(to, "error", &mut error)?;
        }
        push_floats(to, "u", &mut u.iter().copied())?;
        for (name, vectors) in &self.vectors {
            let Vectors::AtVertices(vectors) = vectors else { continue };
            let at = |&k: &usize| {
                let corner = |j: usize| vectors[self.mesh.cell(k / per_cell)[j] as usize];
                match (k % per_cell).checked_sub(D + 1) {
                    None => corner(k % per_cell),
                    Some(edge) => edge_vertices(D)[edge].map(corner).iter().sum::<Point<D>>() / 2.0,
                }
            };
            push_vectors(to, name, grid.sources.iter().map(at))?;
        }
        writeln!(to.text, "</PointData>\n<CellData>")?;
        self.push_cell_data(to)?;
        writeln!(to.text, "</CellData>\n<Points>")?;
        push_vectors(to, "Points", grid.points.iter().copied())?;
        writeln!(to.text, "</Points>\n<Cells>")?;
        let corners = integers(&mut grid.connectivity.iter().map(|&k| i64::from(k)));
        to.push("Int64", "connectivity", 1, &corners)?;
        let ends = integers(&mut grid.ends.iter().map(|&k| k as i64));
        to.push("Int64", "offsets", 1, &ends)?;
        to.push("UInt8", "types", 1, &grid.types)?;
        writeln!(to.text, "</Cells>\n</Piece>\n</UnstructuredGrid>")?;
        Ok(arrays)
    }

    fn push_field_data(&self, to: &mut Arrays) -> io::Result<()> {
        writeln!(to.text, "<FieldData>")?;
        for (name, value) in &self.numbers {
            let name = escaped(name);
            writeln!(
                to.text,
                "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfTuples=\"1\" \
                 format=\"ascii\">\n{value}\n</DataArray>"
            )?;
        }
        writeln!(to.text, "</FieldData>")
    }

    fn push_cell_data(&self, to: &mut Arrays) -> io::Result<()> {
        let (cells, facets) = (self.mesh.n_cells(), self.mesh.boundary().len());
        for name in self.cell_names() {
            let mut all = vec![f64::NAN; cells + facets];
            if let Some((_, values)) = self.on_cells.iter().find(|(other, _)| *other == name) {
                all[..cells].copy_from_slice(values);
            }
            if let Some((_, places, values)) = self.on_facets.iter().find(|f| f.0 == name) {
                for (place, value) in places.iter().zip(*values) {
                    let position = self.position(place).expect("facets have been checked");
                    all[cells + position] = *value;
                }
            }
            push_floats(to, name, &mut all.into_iter())?;
        }
        for (name, vectors) in &self.vectors {
            let Vectors::OnCells(vectors) = vectors else { continue };
            let on_facets = repeat_n(Point::repeat(f64::NAN), facets);
            push_vectors(to, name, vectors.iter().copied().chain(on_facets))?;
        }
        let dimensions = [vec![D as u8; cells], vec![D as u8 - 1; facets]].concat();
        to.push("UInt8", "dimension", 1, &dimensions)?;
        for (name, group) in self.groups() {
            to.push("UInt8", &escaped(&name), 1, &members(self.mesh, group))?;
        }
        Ok(())
    }
}

fn push_floats(
    to: &mut Arrays,
    name: &str,
    values: &mut dyn Iterator<Item = f64>,
) -> io::Result<()> {
    to.push("Float64", &escaped(name), 1, &doubles(values))
}

/// Adds an array of vectors with three components, missing ones zero.
fn push_vectors<const D: usize>(
    to: &mut Arrays,
    name: &str,
    vectors: impl Iterator<Item = Point<D>>,
) -> io::Result<()> {
    let mut components =
        vectors.flat_map(|x| -> [f64; 3] { array_of(|k| if k < D { x[k] } else { 0.0 }) });
    to.push("Float64", &escaped(name), 3, &doubles(&mut components))
}

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

use super::encode::Array;
use super::grid::{Grid, values_per_cell};
use super::groups::{array_names, members};
use super::pvd::relative_to;
use crate::arrays::map_entries;
use crate::error::Error;
use crate::files::{replace, replace_text};
use crate::input::escaped;
use crate::instances::compiled;
use crate::mesh::{BoundaryFacet, Mesh, edge_vertices};
use crate::real::Point;

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
/// VtuFile::new(&mesh, &u).function_in_cells("distance", |_, x| x.norm()).write(&path)?;
/// # let _ = std::fs::remove_file(path);
/// # Ok(())
/// # }
/// ```
#[must_use]
pub struct VtuFile<'a, const D: usize> {
    mesh: &'a Mesh<D>,
    u: &'a [f64],
    grid: Grid<D>,
    /// Functions and vectors at points.
    functions: Vec<Array>,
    vectors: Vec<Array>,
    /// Numbers on cells and facets of the boundary, with their names, and vectors.
    on_cells: Vec<(String, Vec<f64>)>,
    vectors_on_cells: Vec<(&'a str, &'a [Point<D>])>,
    numbers: Vec<(String, f64)>,
    /// What is wrong with the first field that does not fit the mesh.
    fault: Option<String>,
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
        let [linear, quadratic] =
            map_entries([1, 2], |degree| mesh.n_cells() * values_per_cell(D, degree));
        let mut file = Self {
            mesh,
            u,
            grid: Grid::default(),
            functions: Vec::new(),
            vectors: Vec::new(),
            on_cells: Vec::new(),
            vectors_on_cells: Vec::new(),
            numbers: Vec::new(),
            fault: None,
        };
        if u.len() == linear || u.len() == quadratic {
            file.grid = Grid::new(mesh, u, u.len() / mesh.n_cells());
        } else {
            file.fits("u", u.len(), linear);
        }
        file
    }
    /// Adds a function of cell and point as point data. Points that cells share have the value from one of
    /// them.
    pub fn function_in_cells(mut self, name: &str, f: impl Fn(usize, &Point<D>) -> f64) -> Self {
        let per_cell = self.u.len() / self.mesh.n_cells();
        let places = self.grid.sources.iter().zip(&self.grid.points);
        self.functions.push(Array::floats(name, places.map(|(k, x)| f(k / per_cell, x))));
        self
    }
    /// Adds the difference of `u` from a function of cell and point as the point data `error`.
    pub fn error_from_in_cells(mut self, exact: impl Fn(usize, &Point<D>) -> f64) -> Self {
        let per_cell = self.u.len() / self.mesh.n_cells();
        let places = self.grid.sources.iter().zip(&self.grid.points);
        let error = places.map(|(&k, x)| self.u[k] - exact(k / per_cell, x));
        self.functions.push(Array::floats("error", error));
        self
    }
    /// Adds cell data, one value for each cell.
    pub fn on_cells(mut self, name: &str, values: &[f64]) -> Self {
        if self.fits(name, values.len(), self.mesh.n_cells()) {
            self.numbers_of(name)[..values.len()].copy_from_slice(values);
        }
        self
    }
    /// Adds cell data with one value for each of these facets (cell, number in the cell) of the boundary.
    pub fn on_facets(mut self, name: &str, facets: &[(usize, usize)], values: &[f64]) -> Self {
        if !self.fits(name, values.len(), facets.len()) {
            return self;
        }
        let place = |f: &BoundaryFacet| (f.cell as usize, usize::from(f.local));
        let (mesh, boundary) = (self.mesh, self.mesh.boundary());
        // also where a part of a mesh has no such facet
        self.numbers_of(name);
        for (facet, value) in facets.iter().zip(values) {
            match boundary.binary_search_by_key(facet, place) {
                Ok(position) => self.numbers_of(name)[mesh.n_cells() + position] = *value,
                Err(_) => {
                    let (cell, local) = facet;
                    let why = format!(
                        "field {name}: facet {local} of cell {cell} is not on the boundary of the mesh"
                    );
                    self.fault.get_or_insert(why);
                }
            }
        }
        self
    }
    /// Adds cell data, one vector for each cell.
    pub fn vectors_on_cells(mut self, name: &'a str, vectors: &'a [Point<D>]) -> Self {
        if self.fits(name, vectors.len(), self.mesh.n_cells()) {
            self.vectors_on_cells.push((name, vectors));
        }
        self
    }
    /// Adds point data, one vector for each vertex of the mesh; at midpoints of edges the mean of the ends.
    pub fn vectors_at_vertices(mut self, name: &str, vectors: &[Point<D>]) -> Self {
        if self.fits(name, vectors.len(), self.mesh.vertices().len()) {
            let per_cell = self.u.len() / self.mesh.n_cells();
            let at = |&k: &usize| {
                let corner = |j: usize| vectors[self.mesh.cell(k / per_cell)[j] as usize];
                match (k % per_cell).checked_sub(D + 1) {
                    None => corner(k % per_cell),
                    Some(edge) => edge_vertices(D)[edge].map(corner).iter().sum::<Point<D>>() / 2.0,
                }
            };
            self.vectors.push(Array::vectors(name, self.grid.sources.iter().map(at)));
        }
        self
    }
    /// Adds a number to the field data.
    pub fn number(mut self, name: &str, value: f64) -> Self {
        self.numbers.push((name.to_owned(), value));
        self
    }

    /// Whether a field has the length that the mesh needs; if not, the first such field is the fault of the file.
    fn fits(&mut self, name: &str, length: usize, needed: usize) -> bool {
        if length != needed {
            let why = || format!("field {name} has {length} values, the mesh needs {needed}");
            self.fault.get_or_insert_with(why);
        }
        length == needed
    }
    /// The cell data of this name on cells, then facets, not a number where there is no value yet.
    fn numbers_of(&mut self, name: &str) -> &mut [f64] {
        let known = self.on_cells.iter().position(|(other, _)| other == name);
        let place = known.unwrap_or_else(|| {
            let length = self.mesh.n_cells() + self.mesh.boundary().len();
            self.on_cells.push((name.to_owned(), vec![f64::NAN; length]));
            self.on_cells.len() - 1
        });
        &mut self.on_cells[place].1
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
    /// [`Error::Write`] if a field has not the length that the mesh needs, a facet is not on its boundary, or the file
    /// cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        compiled!(
            const D: fn(&VtuFile<'_, D>, &Path) -> Result<(), Error>
                = |file, path| file.write_checked(path)
        )(self, path)
    }
    fn write_checked(&self, path: &Path) -> Result<(), Error> {
        let written = replace(path, |draft| {
            if let Some(fault) = &self.fault {
                return Err(io::Error::new(io::ErrorKind::InvalidInput, fault.clone()));
            }
            let mut file = BufWriter::new(File::create(draft)?);
            self.write_arrays(&mut file)?;
            file.flush()
        });
        written.map(drop)
    }

    /// Writes the text, the data after an underscore, and the end of the file.
    ///
    /// The data stand in the reverse order of the text. meshio 5 searches the text for the array at each offset,
    /// and gives the array that it finds another offset: an array that stands before the one that is meant would be
    /// found in its place.
    fn write_arrays(&self, w: &mut impl Write) -> io::Result<()> {
        let grid = &self.grid;
        let u = Array::floats("u", grid.sources.iter().map(|&k| self.u[k]));
        let points = [Array::vectors("Points", grid.points.iter().copied())];
        let corners = grid.connectivity.iter().map(|&k| i64::from(k));
        let cells = [
            Array::integers("connectivity", corners),
            Array::integers("offsets", grid.ends.iter().map(|&k| k as i64)),
            Array::new("UInt8", "types", 1, &grid.types),
        ];
        let point_data = self.functions.iter().chain([&u]).chain(&self.vectors).collect();
        let cell_data = self.cell_data();
        let sections: [(&str, &str, Vec<&Array>); 4] = [
            ("PointData", " Scalars=\"u\"", point_data),
            ("CellData", "", cell_data.iter().collect()),
            ("Points", "", points.iter().collect()),
            ("Cells", "", cells.iter().collect()),
        ];
        let (n_points, n_cells) = (grid.points.len(), grid.types.len());
        write!(
            w,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\" \
             compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n<FieldData>\n"
        )?;
        for (name, value) in &self.numbers {
            let name = escaped(name);
            writeln!(
                w,
                "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfTuples=\"1\" \
                 format=\"ascii\">\n{value}\n</DataArray>"
            )?;
        }
        write!(
            w,
            "</FieldData>\n<Piece NumberOfPoints=\"{n_points}\" NumberOfCells=\"{n_cells}\">\n"
        )?;
        let arrays: Vec<&Array> = sections.iter().flat_map(|section| &section.2).copied().collect();
        let mut offset: usize = arrays.iter().map(|array| array.data.len()).sum();
        for (name, attributes, of_section) in &sections {
            writeln!(w, "<{name}{attributes}>")?;
            for array in of_section {
                offset -= array.data.len();
                let appended = format!(" format=\"appended\" offset=\"{offset}\"");
                w.write_all(array.element("DataArray", &appended).as_bytes())?;
            }
            writeln!(w, "</{name}>")?;
        }
        w.write_all(b"</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_")?;
        arrays.iter().rev().try_for_each(|array| w.write_all(&array.data))?;
        w.write_all(b"\n</AppendedData>\n</VTKFile>\n")
    }

    /// Numbers and vectors on cells and facets, the dimension of each, and the groups of the mesh.
    fn cell_data(&self) -> Vec<Array> {
        let (cells, facets) = (self.mesh.n_cells(), self.mesh.boundary().len());
        let floats =
            |(name, values): &(String, Vec<f64>)| Array::floats(name, values.iter().copied());
        let vectors = |(name, vectors): &(&str, &[Point<D>])| {
            let on_facets = repeat_n(Point::repeat(f64::NAN), facets);
            Array::vectors(name, vectors.iter().copied().chain(on_facets))
        };
        let dimensions = [vec![D as u8; cells], vec![D as u8 - 1; facets]].concat();
        let of_vectors = self.vectors_on_cells.iter().map(|(name, _)| *name);
        let taken = self.on_cells.iter().map(|(name, _)| &name[..]).chain(of_vectors);
        let groups =
            array_names(self.mesh, taken.chain(["dimension"]).map(str::to_owned).collect());
        let groups = groups
            .iter()
            .map(|(name, group)| Array::new("UInt8", name, 1, &members(self.mesh, group)));
        let fields = self.on_cells.iter().map(floats);
        let fields = fields.chain(self.vectors_on_cells.iter().map(vectors));
        fields.chain([Array::new("UInt8", "dimension", 1, &dimensions)]).chain(groups).collect()
    }

    /// Writes a `.pvtu` file that lists the files of the parts of a mesh, each with the fields of this one. Files
    /// in its own directory are named relative to it.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn write_list(&self, path: &Path, parts: &[PathBuf]) -> Result<(), Error> {
        let element = |array: &Array| array.element("PDataArray", "");
        let u = Array::floats("u", std::iter::empty());
        let points = Array::vectors("Points", std::iter::empty::<Point<D>>());
        let point_data = self.functions.iter().chain([&u]).chain(&self.vectors);
        let point_data: String = point_data.map(element).collect();
        let cell_data: String = self.cell_data().iter().map(element).collect();
        let directory = path.parent().unwrap_or(Path::new(""));
        let source =
            |part: &PathBuf| format!("<Piece Source=\"{}\"/>\n", relative_to(directory, part));
        let sources: String = parts.iter().map(source).collect();
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             <PUnstructuredGrid GhostLevel=\"0\">\n<PPointData Scalars=\"u\">\n{point_data}</PPointData>\n\
             <PCellData>\n{cell_data}</PCellData>\n<PPoints>\n{}</PPoints>\n\
             {sources}</PUnstructuredGrid>\n</VTKFile>\n",
            element(&points)
        );
        replace_text(path, &text).map(drop)
    }
}

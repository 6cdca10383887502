//! A discrete function that owns its mesh: what one solve found, as a datum of other problems.

use std::fmt;
use std::ops::Div;
use std::sync::{Arc, OnceLock};

use num_traits::Zero;

use crate::element::{Element, MAX_BASIS};
use crate::mesh::{BoxSearch, Mesh};
use crate::parallel::once;
use crate::parallel::vectors::collect;
use crate::real::Point;

/// A point lies in a cell if its barycentric coordinates are above minus this.
const ROUNDING: f64 = 1e-8;
/// Outside of the mesh the polynomial of a cell continues the function where all barycentric coordinates of the cell are
/// above minus this number: two meshes of a curved domain differ by less.
const BEYOND: f64 = 0.25;

/// A mesh with an element, and the search for the cells that contain a point, once needed.
struct Cells<const D: usize> {
    mesh: Mesh<D>,
    element: Arc<dyn Element<D>>,
    search: OnceLock<BoxSearch<D>>,
}

/// A function of a finite element space, with its mesh. It is a datum of any problem on any mesh; a clone shares all of it.
///
/// On its own mesh and on uniform refinements of it the value at a point of a cell is that of the cell's ancestor, by
/// number: a function with jumps has its own values in each cell. On another mesh, and where a refined cell on the
/// [shape](Mesh::with_shape) of a boundary group leaves its ancestor, the cell is searched for. At a point
/// without a cell, as a Dirichlet datum is read, the value is the mean over the cells that contain the point.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), Error> {
/// let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
/// let mesh = Mesh::<2>::kuhn_box(&square, [8, 8])?;
/// let u = solve(&Problem::new().constant_source(1.0), &mesh, &Sipg::default())?.function();
/// // an implicit step of length 0.1
/// if let Some(u) = u {
///     let step = Problem::new().reaction(10.0).source_in("default", u.times(10.0));
///     let next = solve(&step, &mesh, &Sipg::default())?;
///     assert!(next.value_at(&Point::repeat(0.5)) < u.value_at(&Point::repeat(0.5)));
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct DiscreteFunction<const D: usize> {
    cells: Arc<Cells<D>>,
    /// The unknowns of each cell, in the order of cells.
    values: Arc<[f64]>,
}

impl<const D: usize> DiscreteFunction<D> {
    /// The function with these unknowns of each cell, in the order of cells.
    pub(crate) fn new(mesh: Mesh<D>, element: Arc<dyn Element<D>>, values: Vec<f64>) -> Self {
        let cells = Arc::new(Cells { mesh, element, search: OnceLock::new() });
        Self { cells, values: values.into() }
    }
    /// The mesh.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.cells.mesh
    }
    /// The largest degree of the function in a cell.
    pub fn degree(&self) -> usize {
        self.cells.element.basis_degree()
    }
    /// The function times a number.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        let values = self.values.iter().map(|value| factor * value).collect();
        Self { cells: self.cells.clone(), values }
    }
    /// The value at a point: the mean over the cells that contain it. Beyond the mesh, by less than a quarter of the
    /// height of a cell, that of the polynomial in the cell; farther none.
    pub fn value_at(&self, x: &Point<D>) -> Option<f64> {
        self.mean_at(x, |cell, barycentric| self.value(cell, barycentric))
    }
    /// The gradient at a point: the mean over the cells that contain it, beyond the mesh as [`Self::value_at`].
    pub fn gradient_at(&self, x: &Point<D>) -> Option<Point<D>> {
        self.mean_at(x, |cell, barycentric| self.gradient(cell, barycentric))
    }
    /// The gradient at the barycentre of each cell; up to degree two the mean over the cell.
    pub fn cell_gradients(&self) -> Vec<Point<D>> {
        let barycentre = [1.0 / (D + 1) as f64; 4];
        collect(self.cells.mesh.n_cells(), |cell| self.gradient(cell, &barycentre))
    }
    /// The mean of what the cells have that contain a point.
    fn mean_at<V: Zero + Div<f64, Output = V>>(
        &self,
        x: &Point<D>,
        of_cell: impl Fn(usize, &[f64; 4]) -> V,
    ) -> Option<V> {
        let (mesh, search) = (&self.cells.mesh, self.search());
        let (mut sum, mut count) = (V::zero(), 0.0);
        let mut beyond = (-BEYOND, None);
        for cell in search.candidates(x) {
            let barycentric = mesh.barycentric(cell, x);
            let least = least::<D>(&barycentric);
            if least >= -ROUNDING {
                sum = sum + of_cell(cell, &barycentric);
                count += 1.0;
            } else if least > beyond.0 {
                beyond = (least, Some(of_cell(cell, &barycentric)));
            }
        }
        if count > 0.0 { Some(sum / count) } else { beyond.1 }
    }
    /// The value at a point of a cell of a mesh: from the cell's own side, if the mesh is that of the function or a
    /// uniform refinement of it. Not a number far from the mesh of the function.
    pub(crate) fn value_in(&self, mesh: &Mesh<D>, cell: usize, x: &Point<D>) -> f64 {
        let own = self.ancestor(mesh, cell);
        let barycentric = self.cells.mesh.barycentric(own, x);
        match least::<D>(&barycentric) >= -ROUNDING {
            true => self.value(own, &barycentric),
            false => self.value_at(x).unwrap_or(f64::NAN),
        }
    }
    /// Whether a mesh has as many cells as one that was refined uniformly from the function's mesh, or not at all.
    fn may_be_ancestor_of(&self, mesh: &Mesh<D>) -> bool {
        mesh.n_cells().is_multiple_of(self.cells.mesh.n_cells())
    }
    /// Makes the search for cells before parallel loops over the cells of another mesh ask for it.
    pub(crate) fn prepare_for(&self, mesh: &Mesh<D>) {
        if !self.may_be_ancestor_of(mesh) || mesh.has_shapes() {
            self.search();
        }
    }
    fn search(&self) -> &BoxSearch<D> {
        once(&self.cells.search, || self.cells.mesh.cell_search(BEYOND))
    }
    /// Whether the function is a polynomial in each cell of a mesh: each lies in a cell of the function's mesh, from
    /// which the mesh was refined uniformly, or not at all.
    pub(crate) fn is_polynomial_on(&self, mesh: &Mesh<D>) -> bool {
        self.may_be_ancestor_of(mesh)
            && (0..mesh.n_cells()).all(|cell| {
                let own = self.ancestor(mesh, cell);
                let is_inside =
                    |x: &Point<D>| least::<D>(&self.cells.mesh.barycentric(own, x)) >= -ROUNDING;
                mesh.corners(cell)[..=D].iter().all(is_inside)
            })
    }
    /// The cell of which a cell of a uniform refinement is a descendant; of another mesh some cell.
    fn ancestor(&self, mesh: &Mesh<D>, cell: usize) -> usize {
        cell * self.cells.mesh.n_cells() / mesh.n_cells()
    }
    /// The value at a point of an own cell.
    fn value(&self, cell: usize, barycentric: &[f64; 4]) -> f64 {
        let n = self.values.len() / self.cells.mesh.n_cells();
        let mut basis = [0.0; MAX_BASIS];
        self.cells.element.values(&barycentric[..=D], &mut basis[..n]);
        self.values[cell * n..][..n].iter().zip(&basis).map(|(value, phi)| value * phi).sum()
    }
    /// The gradient at a point of an own cell.
    fn gradient(&self, cell: usize, barycentric: &[f64; 4]) -> Point<D> {
        let n = self.values.len() / self.cells.mesh.n_cells();
        let mut derivatives = [[0.0; 4]; MAX_BASIS];
        self.cells.element.derivatives(&barycentric[..=D], &mut derivatives[..n]);
        let (values, geometry) = (&self.values[cell * n..][..n], self.cells.mesh.geometry(cell));
        // gradients of barycentric coordinates sum to zero: without their common slope a constant adds no rounding
        let slope = |k: usize| -> f64 {
            values.iter().zip(&derivatives).map(|(value, d)| value * (d[k] - d[0])).sum()
        };
        (1..=D).map(|k| geometry.gradient(k) * slope(k)).sum()
    }
}

/// The least of the barycentric coordinates.
fn least<const D: usize>(barycentric: &[f64; 4]) -> f64 {
    barycentric[..=D].iter().copied().fold(f64::INFINITY, f64::min)
}

impl<const D: usize> fmt::Debug for DiscreteFunction<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DiscreteFunction")
            .field("cells", &self.cells.mesh.n_cells())
            .field("element", &self.cells.element)
            .finish_non_exhaustive()
    }
}

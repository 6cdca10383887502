//! Means and jumps over facets in place of the values on either side.

use crate::algebra::{SparseMatrix, galerkin_product};
use crate::mesh::{BoundaryCondition, Facets, Mesh, Neighbours};

/// The change of variables that takes facet means of a broken space apart into their mean and
/// their jump: a sparse matrix `E` with at most two entries in each row.
///
/// The broken space is that of [`Broken(CrouzeixRaviart)`](crate::element::Broken), whose unknowns
/// are the facet means `c` of each cell. On an interior facet `mean = (c_here + c_there) / 2` and
/// `jump = c_here - c_there`; a Dirichlet facet has a jump only and a Neumann or contact facet a
/// mean only, both equal to `c`. Means come first: those of interior facets, then Neumann, then
/// contact ones, each in the order of [`Facets`]. Jumps follow: interior, then Dirichlet.
///
/// In these variables an over-penalty is diagonal, nothing on means and its weight on jumps, and
/// the block of means is the stiffness matrix of Crouzeix-Raviart elements on their free unknowns,
/// whatever the penalty. Both the diagonal and the block diagonal are therefore good
/// preconditioners: S. C. Brenner, L. Owens, L.-Y. Sung, ETNA 30 (2008), 107-127.
#[derive(Clone, Debug)]
pub struct MeanJump {
    /// `E`.
    change: SparseMatrix<f64>,
    /// Number of means.
    means: usize,
}

impl MeanJump {
    /// The change of variables on a mesh. A facet beyond which the cells of another part lie has a mean only.
    pub fn new<const D: usize>(mesh: &Mesh<D>) -> Self {
        let facets = Facets::new(mesh, &Neighbours::new(mesh));
        let numbers = facets.numbers::<D>(mesh.n_cells());
        // interior facets are numbered first, Dirichlet ones next
        let (interior, dirichlet) =
            (facets.interior(), facets.boundary(BoundaryCondition::Dirichlet));
        let means = facets.len() - dirichlet.len();
        let change = SparseMatrix::by_rows(0..numbers.len(), |unknown, columns, values| {
            let facet = numbers[unknown] as usize;
            if interior.contains(&facet) {
                let is_here = facets.here(facet) == (unknown / (D + 1), unknown % (D + 1));
                columns.extend([facet as u32, (means + facet) as u32]);
                values.extend([1.0, if is_here { 0.5 } else { -0.5 }]);
            } else {
                let is_jump = dirichlet.contains(&facet);
                let column = if is_jump { means + facet } else { facet - dirichlet.len() };
                columns.push(column as u32);
                values.push(1.0);
            }
        });
        Self { change, means }
    }

    /// Number of unknowns, the same before and after.
    pub fn size(&self) -> usize {
        self.change.size()
    }
    /// Number of means: they come first, the jumps follow.
    pub fn means(&self) -> usize {
        self.means
    }
    /// `E y`: facet means of each cell from means and jumps.
    ///
    /// # Panics
    /// If `y` is shorter than [`MeanJump::size`].
    pub fn expand(&self, y: &[f64]) -> Vec<f64> {
        (0..self.size()).map(|i| self.change.row_dot(i, y)).collect()
    }
    /// `E^T r`: a load on facet means of each cell as one on means and jumps.
    ///
    /// # Panics
    /// If `r` is shorter than [`MeanJump::size`].
    pub fn gather(&self, r: &[f64]) -> Vec<f64> {
        let transpose = self.change.transpose(self.size());
        (0..self.size()).map(|i| transpose.row_dot(i, r)).collect()
    }
    /// `E^T A E`.
    ///
    /// # Panics
    /// If the matrix has another size than [`MeanJump::size`].
    pub fn transform(&self, matrix: &SparseMatrix<f64>) -> SparseMatrix<f64> {
        assert_eq!(matrix.size(), self.size(), "a matrix of this mesh's broken linears");
        galerkin_product(matrix, &self.change, self.size())
    }
}

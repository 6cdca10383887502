//! Means and jumps over facets in place of the values on either side.

use crate::algebra::SparseMatrix;
use crate::mesh::{BoundaryPart, Facets, Mesh, Neighbours};

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
    /// The entries of each row of `E`: column and weight.
    rows: Vec<Row>,
    /// Number of means.
    means: usize,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    first: (u32, f64),
    second: Option<(u32, f64)>,
}

impl Row {
    const ABSENT: Self = Self { first: (u32::MAX, 0.0), second: None };

    fn entries(self) -> impl Iterator<Item = (u32, f64)> {
        std::iter::once(self.first).chain(self.second)
    }
}

impl MeanJump {
    /// The change of variables on a mesh.
    pub fn new<const D: usize>(mesh: &Mesh<D>) -> Self {
        let facets = Facets::new(mesh, &Neighbours::new(mesh));
        let [dirichlet, neumann, contact] =
            [BoundaryPart::Dirichlet, BoundaryPart::Neumann, BoundaryPart::Contact]
                .map(|part| facets.part(part));
        let interior = facets.interior();
        let means = interior.len() + neumann.len() + contact.len();
        let mut rows = vec![Row::ABSENT; mesh.cells().len()];
        let unknown = |(cell, local): (usize, usize)| cell * (D + 1) + local;
        for (k, facet) in interior.clone().enumerate() {
            let (mean, jump) = ((k as u32, 1.0), (means + k) as u32);
            rows[unknown(facets.here(facet))] = Row { first: mean, second: Some((jump, 0.5)) };
            rows[unknown(facets.there(facet))] = Row { first: mean, second: Some((jump, -0.5)) };
        }
        for (k, facet) in neumann.chain(contact).enumerate() {
            let first = ((interior.len() + k) as u32, 1.0);
            rows[unknown(facets.here(facet))] = Row { first, second: None };
        }
        for (k, facet) in dirichlet.enumerate() {
            let first = ((means + interior.len() + k) as u32, 1.0);
            rows[unknown(facets.here(facet))] = Row { first, second: None };
        }
        Self { rows, means }
    }

    /// Number of unknowns, the same before and after.
    pub fn size(&self) -> usize {
        self.rows.len()
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
        let value =
            |row: &Row| row.entries().fold(0.0, |s, (j, weight)| s + weight * y[j as usize]);
        self.rows.iter().map(value).collect()
    }
    /// `E^T r`: a load on facet means of each cell as one on means and jumps.
    ///
    /// # Panics
    /// If `r` is shorter than [`MeanJump::size`].
    pub fn gather(&self, r: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.size()];
        for (row, &r) in self.rows.iter().zip(r) {
            for (j, weight) in row.entries() {
                out[j as usize] += weight * r;
            }
        }
        out
    }
    /// `E^T A E`.
    ///
    /// # Panics
    /// If the matrix has another size than [`MeanJump::size`].
    pub fn transform(&self, matrix: &SparseMatrix<f64>) -> SparseMatrix<f64> {
        assert_eq!(matrix.size(), self.size(), "a matrix of this mesh's broken linears");
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.size()];
        for (i, left) in self.rows.iter().enumerate() {
            let (columns, values) = matrix.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                for (row, w) in left.entries() {
                    for (column, x) in self.rows[j as usize].entries() {
                        rows[row as usize].push((column, (w * x) * a));
                    }
                }
            }
        }
        let mut out = SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() };
        for mut row in rows {
            row.sort_by_key(|&(column, _)| column);
            for equal in row.chunk_by(|a, b| a.0 == b.0) {
                out.columns.push(equal[0].0);
                out.values.push(equal.iter().fold(0.0, |s, &(_, a)| s + a));
            }
            out.row_starts.push(out.columns.len() as u32);
        }
        out
    }
    /// The block diagonal of a matrix in means and jumps: all of it among means, its diagonal
    /// among jumps.
    pub fn block_diagonal(&self, transformed: &SparseMatrix<f64>) -> SparseMatrix<f64> {
        let mut out = SparseMatrix { row_starts: vec![0], columns: Vec::new(), values: Vec::new() };
        for i in 0..transformed.size() {
            let (columns, values) = transformed.row(i);
            for (&j, &a) in columns.iter().zip(values) {
                let among_means = i < self.means && (j as usize) < self.means;
                if among_means || i == j as usize {
                    out.columns.push(j);
                    out.values.push(a);
                }
            }
            out.row_starts.push(out.columns.len() as u32);
        }
        out
    }
}

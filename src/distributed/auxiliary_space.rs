//! A preconditioner with conforming linear functions as the auxiliary space of another finite element.
//!
//! Source: J. Xu, Computing 56 (1996), 215-235; for discontinuous functions B. Ayuso de Dios,
//! L. Zikatanov, J. Sci. Comput. 40 (2009), 4-36.

use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::algebra::dense::invert_positive_definite;
use crate::algebra::{DofLocation, SparseMatrix};
use crate::linear::precondition::unknowns_per_cell;
use crate::linear::{FactorError, Preconditioner, Prolongation};
use crate::parallel::vectors::{for_each_chunk, for_each_chunk_of_groups, zeros};

/// The preconditioner `D^-1 + P C P^T` of a symmetric matrix `A` on a part of a mesh.
///
/// `D` is the block diagonal part of `A` with one block for the unknowns of each cell. `P` maps the
/// vertex values of a conforming linear function to unknowns: an unknown is the mean of the values
/// at the vertices of its location. `C` is a preconditioner of the matrix of the form on conforming linear functions,
/// not of `A`.
pub(super) struct AuxiliarySpace<'a> {
    blocks: BlockJacobi<'a>,
    /// The unknowns that the part owns; only the blocks of these are complete.
    own: Vec<bool>,
    correction: VertexCorrection<'a>,
}

impl<'a> AuxiliarySpace<'a> {
    /// The preconditioner of a symmetric matrix; `D^-1` corrects the unknowns for which `own` is true. `None` if
    /// [`unknowns_per_cell`] returns `None`, or the size of the matrix is not a multiple of the number of unknowns of a
    /// cell.
    pub fn new(
        matrix: &'a SparseMatrix<f64>,
        locations: &[DofLocation],
        own: Vec<bool>,
        correction: VertexCorrection<'a>,
    ) -> Option<Self> {
        let blocks = BlockJacobi::new(matrix, unknowns_per_cell(locations)?)?;
        Some(Self { blocks, own, correction })
    }
}

impl Preconditioner<f64> for AuxiliarySpace<'_> {
    fn name(&self) -> &'static str {
        "auxiliary-space"
    }

    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let is_fixed = |(&fixed, &own): (&bool, &bool)| fixed || !own;
        let of_blocks: Vec<bool> = fixed.iter().zip(&self.own).map(is_fixed).collect();
        // also after an error: the second call is collective over the parts of a mesh
        self.blocks.set_fixed(&of_blocks).and(self.correction.set_fixed(fixed))
    }

    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        self.blocks.apply(r, z);
        self.correction.add(r, z);
    }
}

/// The correction `P C P^T r` by conforming linear functions that vanish at the vertices in the
/// locations of fixed unknowns; for `P` and `C` see [`AuxiliarySpace`].
pub(super) struct VertexCorrection<'a> {
    /// `C`.
    coarse: Box<dyn Preconditioner<f64> + 'a>,
    /// The vertices with Dirichlet data.
    dirichlet: Cow<'a, [bool]>,
    /// `P`: an unknown is the mean of the values at the vertices of its location.
    prolongation: Prolongation,
    /// Whether a vertex is fixed; see [`VertexCorrection::set_fixed`].
    fixed_vertices: Vec<bool>,
    /// Workspace: `P^T r` and `C P^T r`, zero at fixed vertices.
    residual: Vec<f64>,
    values: Vec<f64>,
}

impl<'a> VertexCorrection<'a> {
    /// The correction with functions that vanish at the vertices for which `dirichlet` is true; `None` if a location is
    /// empty or contains a vertex that is not less than the length of `dirichlet`.
    pub fn new(
        coarse: Box<dyn Preconditioner<f64> + 'a>,
        dirichlet: Cow<'a, [bool]>,
        locations: &[DofLocation],
    ) -> Option<Self> {
        let n = dirichlet.len();
        let prolongation = Prolongation::to_element(locations, n)?;
        let (residual, values) = (zeros(n), zeros(n));
        let fixed_vertices = vec![false; n];
        Some(Self { coarse, dirichlet, prolongation, fixed_vertices, residual, values })
    }

    /// Sets the fixed unknowns, and the fixed vertices: those with Dirichlet data, and those in the
    /// location of a fixed unknown.
    pub fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let (prolongation, dirichlet) = (&self.prolongation, &self.dirichlet);
        for_each_chunk(&mut self.fixed_vertices, |range, out| {
            for (v, out) in range.zip(out) {
                *out = dirichlet[v] || prolongation.children(v).any(|(i, _)| fixed[i]);
            }
        });
        self.coarse.set_fixed(&self.fixed_vertices)
    }

    /// `z = z + P C P^T r`.
    pub fn add(&mut self, r: &[f64], z: &mut [f64]) {
        self.prolongation.restrict(r, &mut self.residual);
        for (r, _) in
            self.residual.iter_mut().zip(&self.fixed_vertices).filter(|(_, fixed)| **fixed)
        {
            *r = 0.0;
        }
        self.coarse.apply(&self.residual, &mut self.values);
        self.prolongation.add_prolongation(&self.values, |_| true, z);
    }
}

/// The inverses of the diagonal blocks of cells on their free unknowns.
struct BlockJacobi<'a> {
    matrix: &'a SparseMatrix<f64>,
    /// Number of unknowns of a cell.
    size: usize,
    /// The inverses by rows, one inverse after the other; zero in rows and columns of fixed unknowns.
    inverses: Vec<f64>,
}

impl<'a> BlockJacobi<'a> {
    fn new(matrix: &'a SparseMatrix<f64>, size: usize) -> Option<Self> {
        let n = matrix.size();
        n.is_multiple_of(size).then(|| Self { matrix, size, inverses: zeros(n * size) })
    }

    /// Inverts all blocks on their free unknowns.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`] if a block is not positive definite.
    fn set_fixed(&mut self, fixed: &[bool]) -> Result<(), FactorError> {
        let Self { matrix, size, ref mut inverses } = *self;
        let is_positive = AtomicBool::new(true);
        for_each_chunk_of_groups(inverses, size * size, |range, chunk| {
            let cells = range.start / (size * size)..;
            for (cell, block) in cells.zip(chunk.chunks_exact_mut(size * size)) {
                let first = cell * size;
                let fixed = &fixed[first..first + size];
                read_block(matrix, first, fixed, block);
                if !invert_positive_definite(block, size, fixed) {
                    is_positive.store(false, Ordering::Relaxed);
                }
            }
        });
        if is_positive.into_inner() { Ok(()) } else { Err(FactorError::NotPositive) }
    }

    /// `z = D^-1 r`.
    fn apply(&self, r: &[f64], z: &mut [f64]) {
        let (size, inverses) = (self.size, &self.inverses);
        for_each_chunk_of_groups(z, size, |range, chunk| {
            for (k, z) in (range.start / size..).zip(chunk.chunks_exact_mut(size)) {
                let r = &r[k * size..(k + 1) * size];
                let block = &inverses[k * size * size..(k + 1) * size * size];
                for (z, row) in z.iter_mut().zip(block.chunks_exact(size)) {
                    *z = row.iter().zip(r).fold(0.0, |s, (&a, &r)| s + a * r);
                }
            }
        });
    }
}

/// Sets `block` to the diagonal block that begins with the unknown `first`, with zeros in rows and columns of fixed
/// unknowns. `fixed` has one entry for each unknown of the block. The columns of a row
/// of the matrix must be ascending.
fn read_block(matrix: &SparseMatrix<f64>, first: usize, fixed: &[bool], block: &mut [f64]) {
    let size = fixed.len();
    block.fill(0.0);
    for (k, row) in block.chunks_exact_mut(size).enumerate().filter(|&(k, _)| !fixed[k]) {
        let (columns, values) = matrix.row(first + k);
        let from = columns.partition_point(|&j| (j as usize) < first);
        for (&j, &a) in columns[from..].iter().zip(&values[from..]) {
            match fixed.get(j as usize - first) {
                Some(true) => {}
                Some(false) => row[j as usize - first] = a,
                None => break,
            }
        }
    }
}

//! The tensor of the diffusion coefficient, as a change of coordinates in each cell.
//!
//! With `T = L L^T` the energy `int alpha grad u . T grad u` is `int alpha |L^T grad u|^2`, and that of a flux,
//! `int q . T^-1 q / alpha`, is `int |L^-1 q|^2 / alpha`: in the coordinates `L^-1 x` the coefficient has no direction.
//! Forms read a cell by the products of its gradients alone, which are made there.

use crate::assemble::space::metric::{edges_of, shape_of};
use crate::error::{Error, InCell};
use crate::mesh::{Mesh, with_zeros};
use crate::problem::{ByGroup, Tensor};
use crate::real::{Matrix, Point};

/// Entries beside the diagonal that differ by less than this share of the tensor are equal.
const SYMMETRY: f64 = 1e-12;

/// The factor `L` of a tensor and its inverse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TensorFactor<const D: usize> {
    root: Matrix<D>,
    inverse: Matrix<D>,
}

impl<const D: usize> TensorFactor<D> {
    /// The factor of a tensor; none if it is not symmetric and positive definite.
    fn new(tensor: Matrix<D>) -> Option<Self> {
        if (tensor - tensor.transpose()).amax() > SYMMETRY * tensor.amax() {
            return None;
        }
        let root = tensor.cholesky()?.l();
        let inverse = root.solve_lower_triangular(&Matrix::identity())?;
        (root.iter().chain(&inverse).all(|entry| entry.is_finite()))
            .then_some(Self { root, inverse })
    }
    /// `L^T` times a gradient.
    pub fn gradient(&self, gradient: &Point<D>) -> Point<D> {
        self.root.tr_mul(gradient)
    }
    /// `L^-1` times a point, an edge or a flux.
    pub fn vector(&self, vector: &Point<D>) -> Point<D> {
        self.inverse * vector
    }
    /// The tensor times a gradient.
    pub fn flux(&self, gradient: &Point<D>) -> Point<D> {
        self.root * self.gradient(gradient)
    }
    /// The mean of the eigenvalues of the tensor.
    pub fn mean_eigenvalue(&self) -> f64 {
        self.root.norm_squared() / D as f64
    }
    /// A lower bound of the least eigenvalue of the tensor.
    pub fn least(&self) -> f64 {
        self.inverse.norm_squared().recip()
    }
}

/// The tensor of a problem on a mesh.
pub(crate) struct TensorCoefficient<const D: usize> {
    data: ByGroup<Tensor<D>>,
    /// By cell, at the barycentre.
    of_cells: Vec<TensorFactor<D>>,
}

impl<const D: usize> TensorCoefficient<D> {
    /// The tensors of a mesh; none without data.
    ///
    /// # Errors
    /// [`Error::CoefficientNotPositive`]; [`Error::UnsupportedForm`] for a function where basis functions have a higher
    /// degree than one.
    pub fn new(
        data: &ByGroup<Tensor<D>>,
        mesh: &Mesh<D>,
        basis_degree: usize,
    ) -> Result<Option<Self>, Error> {
        if !data.is_given() {
            return Ok(None);
        }
        if basis_degree > 1 && !data.every(&Tensor::is_constant) {
            let message = "a tensor coefficient that is a function of space is made for linear elements only: take one of these, or constants by region";
            return Err(Error::UnsupportedForm(message.to_owned()));
        }
        let of_cell = |cell: usize| {
            let x = mesh.barycentre(cell);
            let tensor = data.of(mesh.region(cell)).map_or_else(Matrix::identity, |t| t.at(&x));
            TensorFactor::new(tensor).ok_or_else(|| {
                let rows: Vec<Vec<f64>> =
                    tensor.row_iter().map(|row| row.iter().copied().collect()).collect();
                let datum = ("tensor coefficient", format!("{rows:?}"));
                let rest = "it must be finite, symmetric and positive definite";
                Error::CoefficientNotPositive(InCell::value(datum, &x, cell, rest))
            })
        };
        let of_cells = (0..mesh.n_cells()).map(of_cell).collect::<Result<_, _>>()?;
        Ok(Some(Self { data: data.clone(), of_cells }))
    }
    /// The factor in a cell, at its barycentre.
    #[inline(always)]
    pub fn in_cell(&self, cell: usize) -> &TensorFactor<D> {
        &self.of_cells[cell]
    }
    /// Whether a tensor is a function of space.
    pub fn varies(&self) -> bool {
        !self.data.every(&Tensor::is_constant)
    }
    /// The factor at a point of a cell; it is not a number where the tensor is not positive definite.
    pub fn at(&self, mesh: &Mesh<D>, cell: usize, x: &Point<D>) -> TensorFactor<D> {
        match self.data.of(mesh.region(cell)) {
            Some(tensor) if !tensor.is_constant() => {
                let none = Matrix::repeat(f64::NAN);
                let of_none = TensorFactor { root: none, inverse: none };
                TensorFactor::new(tensor.at(x)).unwrap_or(of_none)
            }
            _ => self.of_cells[cell],
        }
    }
    /// The volume of a cell and the products `int scale grad lambda_i . T grad lambda_j`.
    #[cold]
    #[inline(never)]
    pub fn shape(&self, mesh: &Mesh<D>, cell: usize, scale: f64) -> (f64, [[f64; 4]; 4]) {
        let factor = &self.of_cells[cell];
        let edges = edges_of(mesh, cell)
            .map(|edge| with_zeros(factor.vector(&Point::from_fn(|axis, _| edge[axis]))));
        let determinant = factor.root.diagonal().product();
        let (volume, products) = shape_of::<D>(edges, scale * determinant);
        (volume * determinant, products)
    }
}

//! The matrix of one cell, as a list.

use std::marker::PhantomData;

use crate::assemble::data::ReactionTerm;
use crate::assemble::local::zero_local;
use crate::assemble::metric::CellMetric;
use crate::assemble::space::Space;
use crate::element::{MAX_BASIS, ReferenceElement};
use crate::mesh::Mesh;
use crate::real::Real;

/// The upper triangle of a cell's matrix, by rows; a power of two holds the largest.
type Triangle<T> = [T; 64];
const _: () = assert!(MAX_BASIS * (MAX_BASIS + 1) / 2 <= 64);

/// Pairs of barycentric coordinates of a tetrahedron.
const PAIRS: usize = 6;

/// Matrices of cells, one after the other.
pub(super) trait CellMatrix<T> {
    /// Computes that of a cell.
    fn of_cell(&mut self, cell: usize);
    /// An entry of it.
    fn entry(&self, i: usize, j: usize) -> T;
}

/// What cells contribute, tabulated.
pub(super) struct CellMatrices<'s, 'a, T: Real, const D: usize> {
    space: &'s Space<'a, T, D>,
    /// For each pair `k < l` of barycentric coordinates what their product of gradients adds.
    pairs: [Triangle<T>; PAIRS],
    /// For entry `(i, j)`, at `N i + j`, where it is in the triangle.
    places: [u8; MAX_BASIS * MAX_BASIS],
    reaction: Option<ReactionTerm<'a, T, D>>,
    /// If basis function `i` is `c` times barycentric coordinate `i` but for a constant: `c^2`.
    square: Option<T>,
}

impl<'s, 'a, T: Real, const D: usize> CellMatrices<'s, 'a, T, D> {
    pub fn new<E: ReferenceElement<T, D>>(space: &'s Space<'a, T, D>) -> Self {
        let zero = T::lit(0.0);
        let table = space.stiffness_table();
        let unit = |k, l| CellMetric { products: unit(k, l), volume: zero, measures: [zero; 4] };
        let linear = E::DEGREE == 1 && E::N == D + 1;
        let mut square = linear.then(|| table.entry::<D>(&unit(0, 1), 0, 1));
        let mut pairs = [[zero; 64]; PAIRS];
        let mut places = [0; MAX_BASIS * MAX_BASIS];
        for (pair, (k, l)) in pairs_of::<D>().enumerate() {
            let mut place = 0;
            for i in 0..E::N {
                for j in i..E::N {
                    let entry = table.entry::<D>(&unit(k, l), i, j);
                    pairs[pair][place] = entry;
                    places[i * E::N + j] = place as u8;
                    places[j * E::N + i] = place as u8;
                    place += 1;
                    let alone = if (i, j) == (k, l) { square } else { Some(zero) };
                    if i != j && Some(entry) != alone {
                        square = None;
                    }
                }
            }
        }
        Self { space, pairs, places, reaction: ReactionTerm::new(space), square }
    }

    /// The square by which products of gradients make the whole matrix, if they do.
    pub fn only_gradients(&self) -> Option<T> {
        self.square.filter(|_| self.reaction.is_none())
    }

    /// Writes the matrix of a cell.
    #[inline(always)]
    fn write<E: ReferenceElement<T, D>>(&self, cell: usize, out: &mut Triangle<T>) {
        let shape = Shape::of(self.space.mesh, cell, self.space.alpha(cell));
        let mut products = [T::lit(0.0); PAIRS];
        for (product, (k, l)) in products.iter_mut().zip(pairs_of::<D>()) {
            *product = shape.products[k][l];
        }
        for place in 0..E::N * (E::N + 1) / 2 {
            let mut sum = products[0] * self.pairs[0][place];
            for pair in 1..D * (D + 1) / 2 {
                sum += products[pair] * self.pairs[pair][place];
            }
            out[place] = sum;
        }
        if let Some(reaction) = &self.reaction {
            let mut local = zero_local();
            reaction.add(self.space.mesh, cell, shape.volume, &mut local);
            let mut place = 0;
            for i in 0..E::N {
                for j in i..E::N {
                    out[place] += local[i][j];
                    place += 1;
                }
            }
        }
    }
}

/// The pairs `k < l` of barycentric coordinates.
#[inline(always)]
fn pairs_of<const D: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..D).flat_map(|k| (k + 1..=D).map(move |l| (k, l)))
}

/// What the matrix of a cell needs of its geometry, made without a detour through memory.
struct Shape<T> {
    volume: T,
    /// `int scale grad lambda_i . grad lambda_j` over the cell.
    products: [[T; 4]; 4],
}

impl<T: Real> Shape<T> {
    /// The shape of a cell: with `n_k` the gradients times the determinant of the edges, `d`, the
    /// products are `scale n_i . n_j / (D! |d|)`.
    #[inline(always)]
    fn of<const D: usize>(mesh: &Mesh<T, D>, cell: usize, scale: T) -> Self {
        let zero = T::lit(0.0);
        let corners = mesh.cell(cell);
        let mut edges = [[zero; 3]; 3];
        let origin = &mesh.vertices()[corners[0] as usize];
        for k in 0..D {
            let corner = &mesh.vertices()[corners[k + 1] as usize];
            for axis in 0..D {
                edges[k][axis] = corner[axis] - origin[axis];
            }
        }
        let [a, b, c] = edges;
        let normals = match D {
            1 => [[T::lit(1.0), zero, zero], [zero; 3], [zero; 3]],
            2 => [[b[1], -b[0], zero], [-a[1], a[0], zero], [zero; 3]],
            _ => [cross(b, c), cross(c, a), cross(a, b)],
        };
        let determinant = dot::<T, D>(a, normals[0]);
        let size = if determinant < zero { -determinant } else { determinant };
        let scale = if size == zero { zero } else { scale / (size * T::lit(FACTORIAL[D])) };
        let mut products = [[zero; 4]; 4];
        for i in 1..=D {
            // rows sum to zero
            for j in 1..=D {
                products[i][j] = if i <= j {
                    scale * dot::<T, D>(normals[i - 1], normals[j - 1])
                } else {
                    products[j][i]
                };
            }
        }
        for i in 1..=D {
            let sum = (1..=D).fold(zero, |sum, j| sum - products[i][j]);
            products[i][0] = sum;
            products[0][i] = sum;
            products[0][0] -= sum;
        }
        Self { volume: size / T::lit(FACTORIAL[D]), products }
    }
}

const FACTORIAL: [f64; 4] = [1.0, 1.0, 2.0, 6.0];

#[inline(always)]
fn dot<T: Real, const D: usize>(a: [T; 3], b: [T; 3]) -> T {
    (1..D).fold(a[0] * b[0], |sum, k| sum + a[k] * b[k])
}

#[inline(always)]
fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Matrices that are products of gradients times a square: they stay in registers.
pub(super) struct Gradients<'c, 's, 'a, T: Real, const D: usize> {
    cells: &'c CellMatrices<'s, 'a, T, D>,
    square: T,
    products: [[T; 4]; 4],
}

impl<'c, 's, 'a, T: Real, const D: usize> Gradients<'c, 's, 'a, T, D> {
    pub fn new(cells: &'c CellMatrices<'s, 'a, T, D>, square: T) -> Self {
        Self { cells, square, products: [[T::lit(0.0); 4]; 4] }
    }
}

impl<T: Real, const D: usize> CellMatrix<T> for Gradients<'_, '_, '_, T, D> {
    #[inline(always)]
    fn of_cell(&mut self, cell: usize) {
        let space = self.cells.space;
        self.products = Shape::of(space.mesh, cell, self.square * space.alpha(cell)).products;
    }
    #[inline(always)]
    fn entry(&self, i: usize, j: usize) -> T {
        self.products[i][j]
    }
}

/// Matrices of any kind.
pub(super) struct General<'c, 's, 'a, E, T: Real, const D: usize> {
    cells: &'c CellMatrices<'s, 'a, T, D>,
    triangle: Triangle<T>,
    element: PhantomData<E>,
}

impl<'c, 's, 'a, E, T: Real, const D: usize> General<'c, 's, 'a, E, T, D> {
    pub fn new(cells: &'c CellMatrices<'s, 'a, T, D>) -> Self {
        Self { cells, triangle: [T::lit(0.0); 64], element: PhantomData }
    }
}

impl<E: ReferenceElement<T, D>, T: Real, const D: usize> CellMatrix<T>
    for General<'_, '_, '_, E, T, D>
{
    #[inline(always)]
    fn of_cell(&mut self, cell: usize) {
        self.cells.write::<E>(cell, &mut self.triangle);
    }
    #[inline(always)]
    fn entry(&self, i: usize, j: usize) -> T {
        self.triangle[self.cells.places[i * E::N + j] as usize % 64]
    }
}

/// Products of gradients of which only those of one pair are not zero.
fn unit<T: Real>(k: usize, l: usize) -> [[T; 4]; 4] {
    let mut products = [[T::lit(0.0); 4]; 4];
    products[k][l] = T::lit(1.0);
    products[l][k] = T::lit(1.0);
    products
}

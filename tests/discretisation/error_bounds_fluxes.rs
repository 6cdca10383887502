//! Fluxes of conforming functions: around each vertex the smallest ones, whatever the cells there look like, and the same
//! ones for meshes of many cells.

use nalgebra::{DMatrix, DVector};

use crate::error_bounds::mismatch_of_sides;
use crate::support::meshes::{Random, Raw};
use unilateral::algebra::Contact;
use unilateral::assemble::{DataQuadrature, Discretisation};
use unilateral::error_bound::PrimalDualPair;
use unilateral::inequality::{Outcome, Solution};
use unilateral::mesh::{Neighbour, Neighbours, TaggedFacet};
use unilateral::prelude::*;
use unilateral::quadrature::Rule;

/// The pair of values without contact.
fn pair_of<const D: usize>(
    scheme: &dyn Scheme<D>,
    problem: &Problem<D>,
    mesh: &Mesh<D>,
    values: impl Fn(&Inequality) -> Vec<f64>,
) -> PrimalDualPair<D> {
    let of = Discretisation::new(scheme, problem, mesh, DataQuadrature::default()).unwrap();
    let inequality = of.inequality().unwrap();
    let values = values(&inequality);
    let contact = vec![Contact::Inactive; values.len()];
    let solution = Solution::new(values, contact, Outcome::Converged);
    of.primal_dual_pair(&inequality, &solution).unwrap()
}

type Inequality = unilateral::algebra::Inequality<f64>;

/// The flux of a conforming linear function by its definition: for each vertex the least squares under constraints, with
/// all facets of its patch as unknowns. By cell and facet.
struct Slow<'m, const D: usize> {
    mesh: &'m Mesh<D>,
    neighbours: Neighbours,
    /// By cell the coefficient and the integral of the load times a hat function, which is the same for all vertices.
    coefficients: Vec<f64>,
    loads: Vec<f64>,
    values: Vec<f64>,
}

impl<const D: usize> Slow<'_, D> {
    /// The integral of `alpha grad u . n` over a facet of a cell.
    fn normal(&self, cell: usize, facet: usize) -> f64 {
        let geometry = self.mesh.geometry(cell);
        let gradient: Point<D> = (0..=D)
            .map(|k| *geometry.gradient(k) * self.values[self.mesh.cell(cell)[k] as usize])
            .sum();
        let along = gradient.dot(&geometry.normal(facet));
        self.coefficients[cell] * along * geometry.facet_measure(facet)
    }

    /// The integral of `p_a . p_b / alpha` over a cell, `p_a` the field with the flux one through facet `a` alone.
    fn product(&self, cell: usize, a: usize, b: usize) -> f64 {
        let vertex = |k: usize| self.mesh.vertices()[self.mesh.cell(cell)[k] as usize];
        let volume = self.mesh.geometry(cell).volume;
        let at = |point: &[f64; 4]| {
            let x: Point<D> = (0..=D).map(|k| vertex(k) * point[k]).sum();
            (x - vertex(a)).dot(&(x - vertex(b)))
        };
        let sum: f64 = Rule::new(D, 2).iter().map(|(point, w)| w * at(point)).sum();
        sum / (D as f64).powi(2) / volume / self.coefficients[cell]
    }

    /// Adds the flux of a vertex: unknowns are the facets of its cells that contain it.
    fn add_vertex(&self, vertex: u32, fluxes: &mut [f64]) {
        let own = |cell: usize| self.mesh.cell(cell).iter().position(|v| *v == vertex);
        let cells = (0..self.mesh.n_cells()).filter_map(|cell| own(cell).map(|own| (cell, own)));
        let cells: Vec<_> = cells.collect();
        let facets = |&(cell, own): &(usize, usize)| {
            (0..=D).filter(move |&facet| facet != own).map(move |facet| (cell, facet))
        };
        let unknowns: Vec<(usize, usize)> = cells.iter().flat_map(facets).collect();
        let place = |of: (usize, usize)| unknowns.iter().position(|other| *other == of).unwrap();
        let mut constraints: Vec<(Vec<usize>, f64)> =
            cells.iter().map(|of| (facets(of).map(place).collect(), -self.loads[of.0])).collect();
        for &(cell, facet) in &unknowns {
            let own = -self.normal(cell, facet) / D as f64;
            match self.neighbours.across(cell, facet) {
                Neighbour::Cell { cell: other, local } => {
                    let there = (other as usize, usize::from(local));
                    let sum = own - self.normal(there.0, there.1) / D as f64;
                    constraints.push((vec![place((cell, facet)), place(there)], sum));
                }
                Neighbour::Boundary(BoundaryCondition::Dirichlet) => {}
                _ => constraints.push((vec![place((cell, facet))], own)),
            }
        }
        let (n, m) = (unknowns.len(), constraints.len());
        let (mut matrix, mut side) = (DMatrix::zeros(n + m, n + m), DVector::zeros(n + m));
        for (i, &(cell, a)) in unknowns.iter().enumerate() {
            for (j, &(other, b)) in unknowns.iter().enumerate() {
                if cell == other {
                    matrix[(i, j)] = self.product(cell, a, b);
                }
            }
        }
        for (k, (of, sum)) in constraints.iter().enumerate() {
            for &i in of {
                matrix[(n + k, i)] = 1.0;
                matrix[(i, n + k)] = 1.0;
            }
            side[n + k] = *sum;
        }
        // constraints depend on one another
        let solution = matrix.svd(true, true).solve(&side, 1e-12).unwrap();
        for (k, (cell, facet)) in unknowns.iter().enumerate() {
            fluxes[cell * (D + 1) + facet] += solution[k];
        }
    }

    fn fluxes(&self) -> Vec<f64> {
        let mut fluxes: Vec<f64> = (0..self.mesh.n_cells())
            .flat_map(|cell| (0..=D).map(move |facet| self.normal(cell, facet)))
            .collect();
        for vertex in 0..self.mesh.vertices().len() as u32 {
            self.add_vertex(vertex, &mut fluxes);
        }
        for f in self.mesh.boundary().iter().filter(|f| f.condition != BoundaryCondition::Dirichlet)
        {
            fluxes[f.cell as usize * (D + 1) + usize::from(f.local)] = 0.0;
        }
        fluxes
    }
}

/// The coefficient varies from cell to cell, the load is constant.
fn is_smallest<const D: usize>(mesh: &Mesh<D>) {
    let alpha = |x: &Point<D>| 2.0 + x[0] - 0.5 * x[1];
    let problem = Problem::new().coefficient(alpha).constant_source(3.0);
    let solved = solve(&problem, mesh, &ConformingP1).unwrap();
    let found = solved.primal_dual_pair().unwrap().flux;
    let slow = Slow {
        mesh,
        neighbours: Neighbours::new(mesh),
        coefficients: (0..mesh.n_cells()).map(|cell| alpha(&mesh.barycentre(cell))).collect(),
        loads: (0..mesh.n_cells())
            .map(|cell| 3.0 * mesh.geometry(cell).volume / (D + 1) as f64)
            .collect(),
        values: solved.values().to_vec(),
    };
    let expected = slow.fluxes();
    let largest = expected.iter().fold(0.0, |largest: f64, q| largest.max(q.abs()));
    for (k, expected) in expected.iter().enumerate() {
        let (cell, facet) = (k / (D + 1), k % (D + 1));
        let difference = (found.through(cell, facet) - expected).abs();
        assert!(difference < 1e-9 * largest, "cell {cell}, facet {facet}: {difference:e}");
    }
}

/// A box with sides of different lengths of which one is not Dirichlet, with moved vertices.
fn box_mesh<const D: usize>(n: usize, (axis, end): (usize, usize)) -> Mesh<D> {
    let far = Point::from_fn(|k, _| [1.0, 0.7, 1.9][k]);
    let domain = BoxDomain::dirichlet(Point::zeros(), far);
    let domain = domain.side(axis, end, BoundaryCondition::Neumann);
    Raw::jittered(&domain, n, 0.2, &mut Random(7)).mesh()
}

/// Cells by their vertices, all facets of the boundary Dirichlet.
fn held<const D: usize>(vertices: &[[f64; D]], cells: &[Vec<u32>]) -> Mesh<D> {
    let facet = |cell: &[u32], opposite: usize| -> [u32; D] {
        let mut others = (0..=D).filter(|&k| k != opposite).map(|k| cell[k]);
        let mut facet = std::array::from_fn(|_| others.next().unwrap());
        facet.sort_unstable();
        facet
    };
    let all = cells.iter().flat_map(|cell| (0..=D).map(|k| facet(cell, k)));
    let all: Vec<[u32; D]> = all.collect();
    let outer = all.iter().filter(|facet| all.iter().filter(|other| other == facet).count() == 1);
    let dirichlet =
        |&vertices: &[u32; D]| TaggedFacet { vertices, condition: BoundaryCondition::Dirichlet };
    let boundary: Vec<_> = outer.map(dirichlet).collect();
    let vertices = vertices.iter().map(|x| Point::from(*x)).collect();
    Mesh::new(vertices, cells.concat(), &boundary).unwrap()
}

/// Cells in opposite octants around the origin: those for positive and for negative first coordinate, two on each side
/// of their common facet, with edges of these lengths.
fn octants(lengths: [f64; 3]) -> Mesh<3> {
    let [x, y, z] = lengths;
    let vertices = [
        [0.0; 3],
        [x, 0.0, 0.0],
        [-x, 0.0, 0.0],
        [0.0, y, 0.0],
        [0.0, 0.0, z],
        [0.0, -y, 0.0],
        [0.0, 0.0, -z],
    ];
    held(&vertices, &OCTANTS.map(Vec::from))
}

/// Two cells on each side of a vertex.
const OCTANTS: [[u32; 4]; 4] = [[0, 1, 3, 4], [0, 2, 3, 4], [0, 1, 5, 6], [0, 2, 5, 6]];

#[test]
fn fluxes_of_linears_are_the_smallest_around_each_vertex() {
    for side in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        is_smallest(&box_mesh::<2>(3, side));
    }
    is_smallest(&box_mesh::<3>(3, (1, 0)));
}

/// Cells that have one vertex in common and no facet, alone and in pairs: the cells around this vertex are in two parts.
/// Cells around a vertex with a hole above and below it: they are a ring.
#[test]
fn fluxes_are_the_smallest_where_cells_around_a_vertex_are_no_ball() {
    let above = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let below = above.map(|x| x.map(|x: f64| -0.7 * x));
    let vertices: Vec<[f64; 3]> = [[0.0; 3]].into_iter().chain(above).chain(below).collect();
    is_smallest(&held(&vertices, &[vec![0, 1, 2, 3], vec![0, 4, 5, 6]]));
    let pairs = [
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [-0.7, 0.0, 0.2],
        [0.1, 0.6, 0.0],
        [0.0, 0.1, 1.7],
        [0.0, -0.5, 0.1],
        [0.1, 0.0, -0.9],
    ];
    is_smallest(&held(&pairs, &OCTANTS.map(Vec::from)));
    let fans =
        [[0.0, 0.0], [1.0, 0.0], [0.8, 0.9], [0.0, 1.1], [-1.0, 0.0], [-0.7, -0.8], [0.1, -1.0]];
    is_smallest(&held(&fans, &[vec![0, 1, 2], vec![0, 2, 3], vec![0, 4, 5], vec![0, 5, 6]]));
    // the sides of a cube, each as two cells with the origin
    let corners = [[-1.0, -1.0], [1.0, -1.1], [1.2, 1.0], [-1.0, 0.9]];
    let of_cube = [-1.0, 0.8].into_iter().flat_map(|z| corners.map(|[x, y]| [x, y, z]));
    let vertices: Vec<[f64; 3]> = [[0.0; 3]].into_iter().chain(of_cube).collect();
    let side = |k: u32| {
        let [a, b] = [1 + k, 1 + (k + 1) % 4];
        [vec![0, a, b, b + 4], vec![0, a, a + 4, b + 4]]
    };
    is_smallest(&held(&vertices, &(0..4).flat_map(side).collect::<Vec<_>>()));
}

/// The barycentric coordinates of the foot of the barycentre of a cell on the line, or plane, through the ends of the edges
/// from vertex `own` to the vertices `ends`: without jumps they are the shares of these facets in the flux of a vertex.
fn shares(mesh: &Mesh<3>, cell: usize, own: usize, ends: &[usize]) -> Vec<f64> {
    let vertex = |k: usize| mesh.vertices()[mesh.cell(cell)[k] as usize];
    if let [a, b] = ends {
        let along = vertex(*b) - vertex(*a);
        let t = along.dot(&(mesh.barycentre(cell) - vertex(*a))) / along.norm_squared();
        return vec![1.0 - t, t];
    }
    let geometry = mesh.geometry(cell);
    let across = geometry.gradient(own);
    let foot = |k: &usize| -geometry.gradient(*k).dot(across) / across.norm_squared();
    ends.iter().map(|k| 0.25 * (1.0 + foot(k))).collect()
}

/// By symmetry nothing flows through the facets between two cells, and all other facets have Dirichlet data: the flux of
/// a vertex is known in closed form, also in cells that are stretched by ten million.
#[test]
fn fluxes_in_stretched_cells_have_all_digits() {
    let h = 1e-7;
    for lengths in [[1.0, 0.6, 1.7], [1.0, 2.0, h], [h, 1.0, 2.0], [2.0, h, 1.0]] {
        let mesh = octants(lengths);
        let problem = Problem::new().constant_source(1.0);
        let pair = pair_of(&ConformingP1, &problem, &mesh, |of| vec![0.0; of.size()]);
        let neighbours = Neighbours::new(&mesh);
        for cell in 0..mesh.n_cells() {
            let is_shared =
                |facet: &usize| matches!(neighbours.across(cell, *facet), Neighbour::Cell { .. });
            let load = mesh.geometry(cell).volume / 4.0;
            let mut expected = [0.0; 4];
            for own in 0..4 {
                let ends = (0..4).filter(|k| *k != own && !is_shared(k)).collect::<Vec<_>>();
                let of_vertex = shares(&mesh, cell, own, &ends);
                ends.iter().zip(of_vertex).for_each(|(&k, share)| expected[k] -= load * share);
            }
            for (facet, expected) in expected.into_iter().enumerate() {
                let difference = (pair.flux.through(cell, facet) - expected).abs();
                let what = || format!("{lengths:?}, cell {cell}, facet {facet}: {difference:e}");
                assert!(difference < 1e-12 * load, "{}", what());
            }
        }
    }
}

/// On more cells than are treated at a time: the values of a quadratic on the equation `-u'' = 1` along the first axis
/// are the discrete solution, and its fluxes are single-valued and balance the load.
fn many_cells<const D: usize>(scheme: &dyn Scheme<D>, n: usize) {
    let domain = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<D>::kuhn_box(&domain, [n; D]).unwrap();
    assert!(mesh.n_cells() > 131_072, "{}", mesh.n_cells());
    let u = |x: f64| 0.5 * x * (1.0 - x);
    let problem = Problem::new().constant_source(1.0).dirichlet(move |x| u(x[0]));
    let pair = pair_of(scheme, &problem, &mesh, |of| {
        let middle = |vertices: &[u32]| {
            let first = |v: &u32| mesh.vertices()[*v as usize][0];
            vertices.iter().map(first).sum::<f64>() / vertices.len() as f64
        };
        of.locations.iter().map(|at| u(middle(at.vertices()))).collect()
    });
    let sides = mismatch_of_sides(&mesh, &pair.flux);
    assert!(sides < 1e-9, "{sides:e}");
    for cell in 0..mesh.n_cells() {
        let volume = mesh.geometry(cell).volume;
        let sum: f64 = (0..=D).map(|facet| pair.flux.through(cell, facet)).sum();
        assert!((sum / volume + 1.0).abs() < 1e-4, "cell {cell}: {}", sum / volume);
    }
}

#[test]
fn fluxes_of_many_cells_are_balanced() {
    many_cells(&ConformingP1 as &dyn Scheme<1>, 270_000);
    many_cells(&ConformingP2 as &dyn Scheme<1>, 140_000);
    many_cells(&ConformingP1 as &dyn Scheme<2>, 260);
}

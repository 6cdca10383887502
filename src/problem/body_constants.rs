//! One constant for each connected body, which the assembly takes off the data and adds to the values.
//!
//! With `u = w + c` the problem of `w` has the Dirichlet data, obstacles and gaps less `c` and the source less `c` times
//! the reaction. Where `c` is much larger than the range of these data, as for temperatures in kelvin, the algebra of
//! `u` would lose the digits that tell `u` from `c`, and every scale of it would be that of `c`.

use crate::mesh::{Components, Mesh};

/// The constant of each body of a mesh: cells that are connected through vertices make a body.
///
/// It is the middle of the Dirichlet values of the body, else of its obstacles, else of its gaps, else of source over
/// reaction, at the vertices of its facets and cells, of quotients at barycentres too; zero if its size does not
/// exceed the range of all Dirichlet values, obstacles and gaps of the body, or that of the quotients.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BodyConstants {
    /// By body, in the order of their first cells, which refinement keeps; empty if all are zero.
    values: Vec<f64>,
    /// The body of each cell; empty if all bodies have the same constant.
    body_of: Vec<u32>,
}

impl BodyConstants {
    /// The same constants on a refinement of the mesh.
    pub fn on<const D: usize>(&self, mesh: &Mesh<D>) -> Self {
        match self.body_of.is_empty() {
            true => self.clone(),
            false => Self { values: self.values.clone(), body_of: bodies(mesh).1 },
        }
    }

    /// The constants of bodies by number, with the body of each cell.
    pub(super) fn new(values: Vec<f64>, body_of: Vec<u32>) -> Self {
        Self { values, body_of }.simplified()
    }

    fn simplified(self) -> Self {
        let first = self.values.first().copied().unwrap_or(0.0);
        match self.values.iter().all(|value| *value == first) {
            true if first == 0.0 => Self::default(),
            true => Self { values: vec![first], body_of: Vec::new() },
            false => self,
        }
    }

    /// Whether there is nothing to take off.
    pub fn are_zero(&self) -> bool {
        self.values.is_empty()
    }
    /// Whether two bodies have different constants.
    pub fn differ(&self) -> bool {
        !self.body_of.is_empty()
    }
    /// The constant of the body of a cell.
    #[inline(always)]
    pub fn of_cell(&self, cell: usize) -> f64 {
        match self.body_of.get(cell) {
            Some(&body) => self.values[body as usize],
            None => self.values.first().copied().unwrap_or(0.0),
        }
    }
    /// The constant of all bodies; none if they differ.
    pub fn of_all(&self) -> Option<f64> {
        (!self.differ()).then(|| self.values.first().copied().unwrap_or(0.0))
    }
    /// A unit of rounding in data from which the constants were taken.
    pub fn rounding(&self) -> f64 {
        self.largest() * f64::EPSILON
    }
    /// The largest size of a constant.
    pub fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |most, value| most.max(value.abs()))
    }
}

/// The number of bodies, and the body of each cell.
pub(super) fn bodies<const D: usize>(mesh: &Mesh<D>) -> (usize, Vec<u32>) {
    let mut components = Components::new(mesh.vertices().len());
    for cell in 0..mesh.n_cells() {
        let vertices = mesh.cell(cell);
        vertices[1..].iter().for_each(|&v| components.join(vertices[0] as usize, v as usize));
    }
    let mut number = vec![u32::MAX; mesh.vertices().len()];
    let mut bodies = 0;
    let body_of = (0..mesh.n_cells()).map(|cell| {
        let body = &mut number[components.find(mesh.cell(cell)[0] as usize)];
        if *body == u32::MAX {
            *body = bodies;
            bodies += 1;
        }
        *body
    });
    let body_of = body_of.collect();
    (bodies as usize, body_of)
}

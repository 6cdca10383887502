//! A growing sequence of meshes, each a bisection of the one before.

use std::iter::successors;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use crate::error::Error;
use crate::instances::compiled;
use crate::linear::Prolongation;
use crate::mesh::{BisectedMesh, Mesh};
use crate::real::Real;

/// A mesh has at least so many times the vertices of the next coarser level of multigrid. A cycle then
/// takes at most three times the work of one on the finest level alone, whatever a step refines.
const GROWTH: f64 = 1.5;

/// A descendant with more than this share of the volume of its ancestor is half of it.
const HALF: f64 = 0.375;

/// Meshes of adaptive refinement: a first one, and bisections of it, each of the one before.
///
/// The sequence grows through a shared reference, so that solutions on its meshes may borrow them while
/// further ones are made; a mesh that is there stays as it is.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let scene = scenes::radial::<2>(1.0);
/// let meshes = AdaptiveMeshes::new(scene.domain.mesh::<f64>(4)?);
/// let coarse = meshes.mesh(0);
/// meshes.bisect(&[0, 5])?;
/// assert!(meshes.n_meshes() == 2 && meshes.finest().n_cells() > coarse.n_cells());
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct AdaptiveMeshes<T, const D: usize> {
    coarsest: Step<T, D>,
}

/// A mesh of the sequence.
#[derive(Debug)]
pub(super) struct Step<T, const D: usize> {
    mesh: BisectedMesh<T, D>,
    /// The parents of the vertices that the mesh before does not have.
    parents: Vec<[u32; 2]>,
    /// Seconds for this mesh and all before.
    seconds: f64,
    /// The prolongation from the next coarser level of multigrid, computed on demand.
    prolongation: OnceLock<Arc<Prolongation<T>>>,
    finer: OnceLock<Box<Self>>,
}

impl<T: Real, const D: usize> Step<T, D> {
    fn new(mesh: BisectedMesh<T, D>, parents: Vec<[u32; 2]>, seconds: f64) -> Self {
        let (prolongation, finer) = (OnceLock::new(), OnceLock::new());
        Self { mesh, parents, seconds, prolongation, finer }
    }
    pub fn mesh(&self) -> &Mesh<T, D> {
        self.mesh.mesh()
    }
    fn n_vertices(&self) -> usize {
        self.mesh().vertices().len()
    }
}

impl<T: Real, const D: usize> AdaptiveMeshes<T, D> {
    /// A sequence of one mesh.
    pub fn new(mesh: Mesh<T, D>) -> Self {
        let clock = Instant::now();
        let mesh = BisectedMesh::new(mesh);
        Self { coarsest: Step::new(mesh, Vec::new(), clock.elapsed().as_secs_f64()) }
    }

    fn steps(&self) -> impl Iterator<Item = &Step<T, D>> {
        successors(Some(&self.coarsest), |step| step.finer.get().map(|finer| &**finer))
    }
    fn step(&self, position: usize) -> &Step<T, D> {
        match self.steps().nth(position) {
            Some(step) => step,
            None => panic!("there are {} meshes, none at position {position}", self.n_meshes()),
        }
    }
    /// Number of meshes.
    #[must_use]
    pub fn n_meshes(&self) -> usize {
        self.steps().count()
    }
    /// A mesh by its position, zero for the first one.
    ///
    /// # Panics
    /// If there is no such mesh.
    #[must_use]
    pub fn mesh(&self, position: usize) -> &Mesh<T, D> {
        self.step(position).mesh()
    }
    /// The finest mesh.
    #[must_use]
    pub fn finest(&self) -> &Mesh<T, D> {
        self.mesh(self.n_meshes() - 1)
    }
    /// Seconds in which a mesh and all before were made.
    pub(crate) fn seconds(&self, position: usize) -> f64 {
        self.step(position).seconds
    }

    /// Adds a mesh: the finest one with every marked cell divided, by [`BisectedMesh::bisect`]. In two and
    /// three dimensions both halves are divided again, so that a marked triangle has a vertex in the interior
    /// of each edge.
    ///
    /// # Errors
    /// [`Error::Mesh`] as for [`BisectedMesh::bisect`], [`Error::Parameter`] if another thread adds a mesh
    /// meanwhile.
    pub fn bisect(&self, marked: &[usize]) -> Result<(), Error> {
        compiled!(
            T, D: fn(&AdaptiveMeshes<T, D>, &[usize]) -> Result<(), Error>
                = |meshes, marked| meshes.bisect_finest(marked)
        )(self, marked)
    }
    fn bisect_finest(&self, marked: &[usize]) -> Result<(), Error> {
        self.add(self.bisected(marked)?)
    }
    /// The mesh that [`Self::bisect`] adds.
    pub(super) fn bisected(&self, marked: &[usize]) -> Result<Step<T, D>, Error> {
        let clock = Instant::now();
        let finest = self.step(self.n_meshes() - 1);
        let (mut mesh, bisection) = finest.mesh.bisect(marked)?;
        let mut parents = bisection.parents;
        if D > 1 {
            let halves = halves(finest.mesh(), mesh.mesh(), &bisection.ancestors, marked);
            let n = parents.len();
            let (again, bisection) = mesh.bisect(&halves)?;
            mesh = again;
            parents.extend_from_slice(&bisection.parents[n..]);
        }
        parents.drain(..finest.n_vertices());
        let seconds = finest.seconds + clock.elapsed().as_secs_f64();
        Ok(Step::new(mesh, parents, seconds))
    }
    /// Adds a bisection of the finest mesh.
    pub(super) fn add(&self, step: Step<T, D>) -> Result<(), Error> {
        let finest = self.step(self.n_meshes() - 1);
        finest.finer.set(Box::new(step)).map_err(|_| Error::Parameter {
            parameter: "marked cells",
            value: "of a mesh that was the finest".to_owned(),
            allowed: "one thread adds meshes to a sequence".to_owned(),
        })
    }

    /// Continues values at the vertices of the mesh before a position: new vertices have `middle` of the
    /// values of their parents.
    pub(super) fn continued<V: Copy>(
        &self,
        position: usize,
        coarse: &[V],
        middle: impl Fn(V, V) -> V,
    ) -> Vec<V> {
        let mut fine = coarse.to_vec();
        for &[a, b] in &self.step(position).parents {
            fine.push(middle(fine[a as usize], fine[b as usize]));
        }
        fine
    }

    /// The next coarser level of multigrid: the position of the finest mesh with few enough vertices, and
    /// the prolongation of conforming linear functions from there.
    pub(super) fn coarser_level(&self, position: usize) -> Option<(usize, &Arc<Prolongation<T>>)> {
        let step = self.step(position);
        let few = step.n_vertices() as f64 / GROWTH;
        let is_coarser = |step: &Step<T, D>| step.n_vertices() as f64 <= few;
        let coarser = self.steps().take(position).take_while(|step| is_coarser(step)).count();
        let coarser = coarser.checked_sub(1)?;
        let prolongation = step.prolongation.get_or_init(|| {
            let finer = self.steps().take(position + 1).skip(coarser + 1);
            let parents = finer.flat_map(|step| step.parents.iter().copied());
            Arc::new(Prolongation::bisections(parents, self.step(coarser).n_vertices()))
        });
        Some((coarser, prolongation))
    }
}

/// The cells of a bisected mesh that are half of a marked cell.
fn halves<T: Real, const D: usize>(
    old: &Mesh<T, D>,
    new: &Mesh<T, D>,
    ancestors: &[u32],
    marked: &[usize],
) -> Vec<usize> {
    let mut is_marked = vec![false; old.n_cells()];
    marked.iter().for_each(|&cell| is_marked[cell] = true);
    let volume = |mesh: &Mesh<T, D>, cell: usize| mesh.geometry(cell).volume.to_f64();
    let is_half = |&(cell, &ancestor): &(usize, &u32)| {
        let ancestor = ancestor as usize;
        is_marked[ancestor] && volume(new, cell) > HALF * volume(old, ancestor)
    };
    ancestors.iter().enumerate().filter(is_half).map(|(cell, _)| cell).collect()
}

//! A growing sequence of meshes, each a bisection of the one before.

use std::iter::successors;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use crate::error::Error;
use crate::instances::compiled;
use crate::linear::Prolongation;
use crate::mesh::{BisectedMesh, Mesh};
use crate::parallel::once;

/// A mesh has at least so many times the vertices of the next coarser level of multigrid. A cycle then
/// takes at most three times the work of one on the finest level alone, whatever a step refines.
const GROWTH: f64 = 1.5;

/// Meshes of adaptive refinement: a first one, and bisections of it, each of the one before.
///
/// The sequence grows through a shared reference, so that solutions on its meshes may borrow them while
/// further ones are made; a mesh that is there stays as it is.
///
/// ```
/// use unilateral::prelude::*;
/// # fn main() -> Result<(), unilateral::error::Error> {
/// let scene = scenes::radial::<2>(1.0);
/// let meshes = AdaptiveMeshes::new(scene.domain.mesh(4)?);
/// let coarse = meshes.mesh(0);
/// meshes.bisect(&[0, 5])?;
/// assert!(meshes.n_meshes() == 2 && meshes.finest().n_cells() > coarse.n_cells());
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct AdaptiveMeshes<const D: usize> {
    coarsest: MeshOfSequence<D>,
}

/// A mesh of the sequence.
///
/// Bisection appends vertices, so that neighbours are far apart in its list. The mesh that is solved on has
/// its vertices in the order of cells: smoothers work on neighbours of near numbers.
#[derive(Debug)]
pub(super) struct MeshOfSequence<const D: usize> {
    /// The mesh with its vertices in the order in which they came to be.
    bisected: BisectedMesh<D>,
    pub mesh: Mesh<D>,
    /// The numbers that the vertices of `bisected` have in `mesh`.
    numbers: Vec<u32>,
    /// The parents of the vertices that the mesh before does not have, in the numbers of `bisected`.
    parents: Vec<[u32; 2]>,
    /// Seconds for this mesh and all before.
    seconds: f64,
    /// The prolongation from the next coarser level of multigrid, computed on demand.
    prolongation: OnceLock<Arc<Prolongation>>,
    finer: OnceLock<Box<Self>>,
}

impl<const D: usize> MeshOfSequence<D> {
    fn n_vertices(&self) -> usize {
        self.numbers.len()
    }
}

impl<const D: usize> AdaptiveMeshes<D> {
    /// A sequence of one mesh.
    pub fn new(mesh: Mesh<D>) -> Self {
        let clock = Instant::now();
        let coarsest = MeshOfSequence {
            bisected: BisectedMesh::new(mesh.clone()),
            numbers: (0..mesh.vertices().len() as u32).collect(),
            mesh,
            parents: Vec::new(),
            seconds: clock.elapsed().as_secs_f64(),
            prolongation: OnceLock::new(),
            finer: OnceLock::new(),
        };
        Self { coarsest }
    }

    fn steps(&self) -> impl Iterator<Item = &MeshOfSequence<D>> {
        successors(Some(&self.coarsest), |step| step.finer.get().map(|finer| &**finer))
    }
    fn step(&self, position: usize) -> &MeshOfSequence<D> {
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
    pub fn mesh(&self, position: usize) -> &Mesh<D> {
        &self.step(position).mesh
    }
    /// The finest mesh.
    #[must_use]
    pub fn finest(&self) -> &Mesh<D> {
        self.mesh(self.n_meshes() - 1)
    }
    /// Seconds in which a mesh and all before were made.
    pub(crate) fn seconds(&self, position: usize) -> f64 {
        self.step(position).seconds
    }

    /// Adds a mesh: the finest one with every marked cell divided, by [`BisectedMesh::bisect`]. In two and
    /// three dimensions both halves are divided again, so that a marked triangle has a vertex in the interior
    /// of each edge. All vertices have new numbers, in the order of cells.
    ///
    /// # Errors
    /// [`Error::Mesh`] as for [`BisectedMesh::bisect`], [`Error::Parameter`] if another thread adds a mesh
    /// meanwhile.
    pub fn bisect(&self, marked: &[usize]) -> Result<(), Error> {
        compiled!(const D: fn(&AdaptiveMeshes<D>, &[usize]) -> Result<(), Error>
                = |meshes, marked| meshes.add(meshes.bisected(marked)?)
        )(self, marked)
    }
    /// The mesh that [`Self::bisect`] adds.
    pub(super) fn bisected(&self, marked: &[usize]) -> Result<MeshOfSequence<D>, Error> {
        let clock = Instant::now();
        let finest = self.step(self.n_meshes() - 1);
        let (mut bisected, bisection) = finest.bisected.bisect(marked)?;
        let mut parents = bisection.parents;
        if D > 1 {
            let halves = halves(bisected.mesh(), finest.n_vertices(), &bisection.ancestors, marked);
            let n = parents.len();
            let (again, bisection) = bisected.bisect(&halves)?;
            bisected = again;
            parents.extend_from_slice(&bisection.parents[n..]);
        }
        parents.drain(..finest.n_vertices());
        let (mesh, numbers) = bisected.mesh().in_order_of_cells();
        Ok(MeshOfSequence {
            bisected,
            mesh,
            numbers,
            parents,
            seconds: finest.seconds + clock.elapsed().as_secs_f64(),
            prolongation: OnceLock::new(),
            finer: OnceLock::new(),
        })
    }
    /// Adds a bisection of the finest mesh.
    pub(super) fn add(&self, step: MeshOfSequence<D>) -> Result<(), Error> {
        let finest = self.step(self.n_meshes() - 1);
        let (value, allowed) =
            ("of a mesh that was the finest", "one thread adds meshes to a sequence");
        let added = finest.finer.set(Box::new(step));
        added.map_err(|_| Error::parameter("marked cells", value, allowed))
    }

    /// Continues values at the vertices of the mesh before a position: new vertices have `middle` of the
    /// values of their parents.
    pub(super) fn continued<V: Copy>(
        &self,
        position: usize,
        coarse: &[V],
        middle: impl Fn(V, V) -> V,
    ) -> Vec<V> {
        let (before, step) = (self.step(position - 1), self.step(position));
        let mut values: Vec<V> = before.numbers.iter().map(|&v| coarse[v as usize]).collect();
        for &[a, b] in &step.parents {
            values.push(middle(values[a as usize], values[b as usize]));
        }
        let mut fine = values.clone();
        for (&number, &value) in step.numbers.iter().zip(&values) {
            fine[number as usize] = value;
        }
        fine
    }

    /// The next coarser level of multigrid: the position of the finest mesh with few enough vertices, and
    /// the prolongation of conforming linear functions from there.
    pub(super) fn coarser_level(&self, position: usize) -> Option<(usize, &Arc<Prolongation>)> {
        let step = self.step(position);
        let few = step.n_vertices() as f64 / GROWTH;
        let is_coarser = |step: &MeshOfSequence<D>| step.n_vertices() as f64 <= few;
        let coarser = self.steps().take(position).take_while(|step| is_coarser(step)).count();
        let coarser = coarser.checked_sub(1)?;
        let prolongation = once(&step.prolongation, || {
            let mut parents = Vec::new();
            for finer in coarser + 1..=position {
                parents.extend_from_slice(&self.step(finer).parents);
            }
            let coarse = &self.step(coarser).numbers;
            let by_age = Prolongation::bisections(parents, coarse.len());
            Arc::new(by_age.renumbered(&step.numbers, coarse))
        });
        Some((coarser, prolongation))
    }
}

/// The cells of a bisected mesh that are half of a marked cell: they have all but one of its vertices, which are the first
/// `n_old` ones.
fn halves<const D: usize>(
    new: &Mesh<D>,
    n_old: usize,
    ancestors: &[u32],
    marked: &[usize],
) -> Vec<usize> {
    let mut is_marked = vec![false; ancestors.last().map_or(0, |&last| last as usize + 1)];
    marked.iter().for_each(|&cell| is_marked[cell] = true);
    let is_half = |&(cell, &ancestor): &(usize, &u32)| {
        let old = new.cell(cell).iter().filter(|&&v| (v as usize) < n_old).count();
        is_marked[ancestor as usize] && old == D
    };
    ancestors.iter().enumerate().filter(is_half).map(|(cell, _)| cell).collect()
}

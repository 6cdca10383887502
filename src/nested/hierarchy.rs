//! Nested meshes: uniform refinements of an input mesh or the levels of a built-in domain, or the parts of these that one
//! process has.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::piece::{Piece, SharedPart};
use crate::error::Error;
use crate::instances::compiled;
use crate::linear::Prolongation;
use crate::mesh::{Domain, Layers, Mesh, Part, Refinement};
use crate::parallel::once;
use crate::processes::{Exchange, agree};

/// Fewest cells of the coarsest mesh for each part.
const CELLS_OF_PART: f64 = 16.0;

/// A mesh of a hierarchy.
#[derive(Debug)]
struct NestedMesh<const D: usize> {
    /// Number of refinements of an input mesh, or subdivisions of the shortest side of a domain.
    level: usize,
    piece: Piece<D>,
    /// The refinement of the next coarser mesh that gives this one; `None` for the coarsest mesh.
    refinement: Option<Refinement>,
    /// The prolongation of P1 functions from the next coarser mesh, computed on demand.
    prolongation: OnceLock<Arc<Prolongation<f64>>>,
    /// Seconds for this mesh and all coarser ones.
    seconds: f64,
}

/// Nested meshes, each a uniform refinement of the one before.
///
/// The level of a mesh is its number of refinements if the coarsest mesh is an input mesh, and the
/// number of subdivisions of the shortest side if it is a mesh of a built-in domain.
///
/// Of a mesh that several processes share each has a hierarchy of its parts, by [`Hierarchy::of_parts`].
#[derive(Debug)]
pub struct Hierarchy<const D: usize> {
    meshes: Vec<NestedMesh<D>>,
    /// The exchange with the processes that have the other parts; none on whole meshes.
    exchange: Option<Arc<dyn Exchange>>,
}

impl<const D: usize> Hierarchy<D> {
    /// A mesh and its uniform refinements: levels zero to `refinements`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for more cells than can be numbered.
    pub fn refine(mesh: &Mesh<D>, refinements: usize) -> Result<Self, Error> {
        Coarsest::Mesh(mesh).build(refinements)
    }

    /// The mesh of a built-in domain with `level` subdivisions of its shortest side, and the coarser
    /// meshes of which it is a refinement: level `n` is the refinement of level `n / 2` if `n` is even
    /// and `n / 2` is at least 4.
    ///
    /// # Errors
    /// [`Error::Parameter`] for level zero and for one with more cells than can be numbered or with
    /// cells too small for floating-point numbers, [`Error::Mesh`] if the domain has no mesh.
    pub fn of_domain(domain: &Domain<D>, level: usize) -> Result<Self, Error> {
        Coarsest::Domain(domain).build(level)
    }

    /// The part with the number `number` of a mesh and of its uniform refinements, levels zero to `refinements`; all
    /// parts call it. Every process has the coarsest mesh as a whole, no process any finer one: all processes
    /// partition it alike, and each refines its part by itself. The children of a cell belong to the part that owns
    /// their parent.
    ///
    /// # Errors
    /// [`Error::Processes`] for fewer cells than parts, and for more cells than can be numbered.
    pub fn of_parts(
        coarsest: &Mesh<D>,
        refinements: usize,
        layers: Layers,
        process: (u32, &Arc<dyn Exchange>),
    ) -> Result<Self, Error> {
        let levels: Vec<usize> = (0..=refinements).collect();
        Self::build_parts(&levels, (coarsest, None), layers, process)
    }
    /// The part of a mesh and of its refinements, those of a domain if one is given, which have these levels.
    fn build_parts(
        levels: &[usize],
        (coarsest, domain): (&Mesh<D>, Option<&Domain<D>>),
        layers: Layers,
        (number, exchange): (u32, &Arc<dyn Exchange>),
    ) -> Result<Self, Error> {
        let first = || {
            let owners = coarsest.partition(exchange.parts());
            let part = owners.and_then(|owners| coarsest.part(&owners, number, layers));
            Ok(Piece::Part(agree(part, &**exchange)?))
        };
        Self::build(levels, first, domain, Some(exchange))
    }
    /// The first mesh, or its part, and its refinements, which have these levels.
    fn build(
        levels: &[usize],
        first: impl Fn() -> Result<Piece<D>, Error>,
        domain: Option<&Domain<D>>,
        exchange: Option<&Arc<dyn Exchange>>,
    ) -> Result<Self, Error> {
        let mut meshes: Vec<NestedMesh<D>> = Vec::new();
        for &level in levels {
            let clock = Instant::now();
            let (piece, refinement, before) = match meshes.last() {
                None => (first()?, None, 0.0),
                Some(coarser) => {
                    let (piece, by) = coarser.piece.refined(domain, exchange)?;
                    (piece, Some(by), coarser.seconds)
                }
            };
            let seconds = before + clock.elapsed().as_secs_f64();
            let prolongation = OnceLock::new();
            meshes.push(NestedMesh { level, piece, refinement, prolongation, seconds });
        }
        Ok(Self { meshes, exchange: exchange.cloned() })
    }

    /// Number of meshes.
    #[must_use]
    pub fn n_meshes(&self) -> usize {
        self.meshes.len()
    }
    /// A mesh by its position, zero for the coarsest.
    ///
    /// # Panics
    /// If the hierarchy has no such mesh.
    #[must_use]
    pub fn mesh(&self, position: usize) -> &Mesh<D> {
        self.meshes[position].piece.mesh()
    }
    /// The part of a mesh that this process has, by its position; none if it has the whole.
    ///
    /// # Panics
    /// If the hierarchy has no such mesh.
    #[must_use]
    pub fn part(&self, position: usize) -> Option<&Part<D>> {
        self.shared_part(position).map(|shared| shared.part)
    }
    /// As [`Self::part`], with the exchange.
    pub(super) fn shared_part(&self, position: usize) -> Option<SharedPart<'_, D>> {
        match (&self.meshes[position].piece, &self.exchange) {
            (Piece::Part(part), Some(exchange)) => Some(SharedPart { part, exchange }),
            _ => None,
        }
    }
    /// The finest mesh.
    #[must_use]
    pub fn finest(&self) -> &Mesh<D> {
        self.mesh(self.meshes.len() - 1)
    }
    /// The position of the mesh of a level, if the hierarchy has it.
    #[must_use]
    pub fn position(&self, level: usize) -> Option<usize> {
        self.meshes.iter().position(|m| m.level == level)
    }
    /// Seconds in which a mesh and all coarser ones were made.
    pub(crate) fn seconds(&self, position: usize) -> f64 {
        self.meshes[position].seconds
    }
    /// The parents of the vertices of a mesh in the next coarser one; `None` for the coarsest mesh.
    pub(super) fn refinement(&self, position: usize) -> Option<&Refinement> {
        self.meshes[position].refinement.as_ref()
    }
    /// The prolongation of P1 functions from the next coarser mesh; `None` for the coarsest mesh, and on parts, where
    /// no multigrid of this process uses it.
    pub(super) fn prolongation(&self, position: usize) -> Option<&Arc<Prolongation<f64>>> {
        let refinement = self.refinement(position).filter(|_| self.exchange.is_none())?;
        let n_coarse = self.mesh(position - 1).vertices().len();
        let new = || Arc::new(Prolongation::midpoints(refinement.parents.clone(), n_coarse));
        Some(once(&self.meshes[position].prolongation, new))
    }
}

/// Fewest subdivisions of a level that serves as a coarser one.
const COARSEST: usize = 4;

/// From which the meshes of a hierarchy are refined.
pub(crate) enum Coarsest<'a, const D: usize> {
    /// A built-in domain.
    Domain(&'a Domain<D>),
    /// An input mesh.
    Mesh(&'a Mesh<D>),
}

impl<const D: usize> Coarsest<'_, D> {
    /// The levels of the hierarchy that ends with a level, coarsest first; no level of a domain but the last
    /// is less than `coarsest`.
    fn levels(&self, level: usize, coarsest: usize) -> Vec<usize> {
        let mut levels = vec![level];
        let coarser = |level: usize| match self {
            Self::Mesh(_) => level.checked_sub(1),
            Self::Domain(_) => {
                (level.is_multiple_of(2) && level / 2 >= coarsest).then_some(level / 2)
            }
        };
        while let Some(next) = levels.last().and_then(|&l| coarser(l)) {
            levels.push(next);
        }
        levels.reverse();
        levels
    }

    /// The levels of the hierarchy that ends with a level, coarsest first.
    pub fn levels_to(&self, level: usize) -> Vec<usize> {
        self.levels(level, COARSEST)
    }

    /// The fewest hierarchies that have all of these levels.
    ///
    /// # Errors
    /// Those of [`Coarsest::build`].
    pub fn build_all(&self, levels: &[usize]) -> Result<Vec<Hierarchy<D>>, Error> {
        Self::all_by(levels, |level| self.build(level))
    }

    /// The fewest hierarchies that have all of these levels, each built by a function of its finest level.
    ///
    /// # Errors
    /// Those of the function.
    pub fn all_by(
        levels: &[usize],
        build: impl Fn(usize) -> Result<Hierarchy<D>, Error>,
    ) -> Result<Vec<Hierarchy<D>>, Error> {
        let mut hierarchies: Vec<Hierarchy<D>> = Vec::new();
        for level in descending(levels) {
            if !hierarchies.iter().any(|h| h.position(level).is_some()) {
                hierarchies.push(build(level)?);
            }
        }
        Ok(hierarchies)
    }

    /// The hierarchy that ends with a level.
    ///
    /// # Errors
    /// Those of [`Coarsest::check`] and of refinement.
    pub fn build(&self, level: usize) -> Result<Hierarchy<D>, Error> {
        self.build_from(level, COARSEST)
    }

    /// The hierarchy that ends with a level; no mesh of a domain but the last has a level less than
    /// `coarsest`.
    ///
    /// # Errors
    /// Those of [`Coarsest::check`] and of refinement.
    pub fn build_from(&self, level: usize, coarsest: usize) -> Result<Hierarchy<D>, Error> {
        compiled!(const D: fn(&Coarsest<'_, D>, usize, usize) -> Result<Hierarchy<D>, Error>
                = |of, level, coarsest| of.build_meshes(level, coarsest)
        )(self, level, coarsest)
    }
    fn build_meshes(&self, level: usize, coarsest: usize) -> Result<Hierarchy<D>, Error> {
        self.check(level)?;
        let levels = self.levels(level, coarsest);
        let first = || {
            Ok(Piece::Whole(match self {
                Self::Mesh(mesh) => (*mesh).clone(),
                Self::Domain(domain) => domain.mesh(levels[0])?,
            }))
        };
        Hierarchy::build(&levels, first, self.domain(), None)
    }
    fn domain(&self) -> Option<&Domain<D>> {
        match self {
            Self::Domain(domain) => Some(domain),
            Self::Mesh(_) => None,
        }
    }

    /// The parts of the hierarchy that ends with a level; its coarsest mesh has enough cells for each process. All
    /// processes call it.
    ///
    /// # Errors
    /// Those of [`Coarsest::build`] and of [`Hierarchy::of_parts`].
    pub fn build_parts(
        &self,
        level: usize,
        layers: impl Fn(&Mesh<D>) -> Layers,
        process: (u32, &Arc<dyn Exchange>),
    ) -> Result<Hierarchy<D>, Error> {
        self.check(level)?;
        let mut levels = self.levels_to(level);
        let least = CELLS_OF_PART * process.1.parts() as f64;
        while levels.len() > 1 && self.cells(levels[0]) < least {
            levels.remove(0);
        }
        let first = self.build(levels[0])?;
        let coarsest = first.finest();
        Hierarchy::build_parts(&levels, (coarsest, self.domain()), layers(coarsest), process)
    }

    /// The number of cells of a level.
    pub fn cells(&self, level: usize) -> f64 {
        match self {
            Self::Mesh(mesh) => (mesh.n_cells() as f64) * 2_f64.powi(D as i32).powf(level as f64),
            Self::Domain(domain) => domain.cells(level),
        }
    }

    /// Checks the number and size of the cells of a level before any mesh is built.
    pub fn check(&self, level: usize) -> Result<(), Error> {
        let refuse =
            |parameter, value, allowed| Err(Error::Parameter { parameter, value, allowed });
        if let Self::Domain(domain) = self {
            let domain = domain.bounding_box();
            let sides = domain.upper - domain.lower;
            if let Some(side) = sides.iter().find(|side| !(**side > 0.0 && side.is_finite())) {
                let allowed = "positive and finite, the upper corner less the lower one".to_owned();
                return refuse("side of the domain", side.to_string(), allowed);
            }
        }
        let cells = self.cells(level);
        // 32-bit indices number the unknowns and matrix entries of a discontinuous space
        let limit = f64::from(u32::MAX) / ((D + 1) * (D + 1) * (D + 2)) as f64;
        if cells > limit {
            let kind = match self {
                Self::Domain(_) => "subdivisions of the shortest side",
                Self::Mesh(_) => "refinements of the mesh",
            };
            let allowed = format!(
                "so many {kind} would make {cells:.1e} cells, at most {limit:.1e} are possible"
            );
            return refuse("level", level.to_string(), allowed);
        }
        // the constructor of an input mesh checks its cells
        let Self::Domain(domain) = self else { return Ok(()) };
        if level == 0 {
            let allowed = "a built-in mesh has at least one subdivision of its shortest side; refinements, from 0, are those of a mesh file".to_owned();
            return refuse("level", "0".to_owned(), allowed);
        }
        // squares and volumes of cells, and their reciprocals, must be in the range of floating-point numbers
        let power = D.max(2) as i32;
        let outside = |&h: &f64| !(h.powi(power).is_normal() && h.powi(-power).is_normal());
        match domain.spacings(level).into_iter().find(outside) {
            None => Ok(()),
            Some(h) => refuse(
                "spacing",
                format!("{h:.1e}"),
                "one whose powers up to the dimension are floating-point numbers; choose another scale or level".to_owned(),
            ),
        }
    }
}

/// Levels from the finest to the coarsest; not generic, so that the sorting code is compiled once.
fn descending(levels: &[usize]) -> Vec<usize> {
    let mut levels = levels.to_vec();
    levels.sort_unstable_by(|a, b| b.cmp(a));
    levels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    #[test]
    fn level_zero_of_a_built_in_domain_is_refused_by_its_name() {
        let scene = scenes::radial::<2>(1.0);
        let error = Hierarchy::<2>::of_domain(&scene.domain, 0).unwrap_err();
        assert!(matches!(error, Error::Parameter { parameter: "level", .. }), "{error}");
    }

    #[test]
    fn levels_that_are_refinements_of_each_other_share_a_hierarchy() {
        let scene = scenes::radial::<2>(1.0);
        let coarsest = Coarsest::<2>::Domain(&scene.domain);
        let hierarchies = coarsest.build_all(&[8, 12, 16, 6, 7]).unwrap();
        let levels: Vec<Vec<usize>> =
            hierarchies.iter().map(|h| h.meshes.iter().map(|m| m.level).collect()).collect();
        assert_eq!(levels, [vec![4, 8, 16], vec![6, 12], vec![7]]);
    }
}

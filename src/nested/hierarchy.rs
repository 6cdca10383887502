//! Nested meshes: uniform refinements of an input mesh or the levels of a built-in domain, or the parts of these that
//! one process has.

use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::piece::{Piece, SharedPart};
use crate::error::Error;
use crate::instances::compiled;
use crate::linear::Prolongation;
use crate::mesh::{CELL_LIMIT, Domain, Layers, Mesh, Part, Refinement};
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
    prolongation: OnceLock<Arc<Prolongation>>,
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
}

impl<const D: usize> Hierarchy<D> {
    /// A mesh and its uniform refinements: levels zero to `refinements`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for more cells than can be numbered.
    pub fn refine(mesh: &Mesh<D>, refinements: usize) -> Result<Self, Error> {
        Self::of_domain(&Domain::Mesh(mesh.clone()), refinements)
    }

    /// The mesh of a built-in domain with `level` subdivisions of its shortest side, and the coarser
    /// meshes of which it is a refinement: level `n` is the refinement of level `n / 2` if `n` is even
    /// and `n / 2` is at least 4. Of a domain that is a mesh, the mesh and its refinements up to the level.
    ///
    /// # Errors
    /// [`Error::Parameter`] for level zero of a built-in domain and for one with more cells than can be numbered or with
    /// cells too small for floating-point numbers, [`Error::Mesh`] if the domain has no mesh.
    pub fn of_domain(domain: &Domain<D>, level: usize) -> Result<Self, Error> {
        Self::of_domain_from(domain, level, COARSEST)
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
        let (levels, domain): (Vec<_>, _) = ((0..=refinements).collect(), coarsest.clone().into());
        Self::build_parts(&levels, (coarsest, &domain), layers, process)
    }
    /// The part of a mesh of a domain and of its refinements, which have these levels.
    fn build_parts(
        levels: &[usize],
        (coarsest, domain): (&Mesh<D>, &Domain<D>),
        layers: Layers,
        (number, exchange): (u32, &Arc<dyn Exchange>),
    ) -> Result<Self, Error> {
        let first = || {
            let owners = coarsest.partition(exchange.parts());
            let part = owners.and_then(|owners| coarsest.part(&owners, number, layers));
            Ok(Piece::Part(agree(part, &**exchange)?, exchange.clone()))
        };
        Self::build(levels, first, domain)
    }
    /// The first mesh, or its part, and its refinements, which have these levels.
    fn build(
        levels: &[usize],
        first: impl Fn() -> Result<Piece<D>, Error>,
        domain: &Domain<D>,
    ) -> Result<Self, Error> {
        let mut meshes: Vec<NestedMesh<D>> = Vec::new();
        for &level in levels {
            let clock = Instant::now();
            let (piece, refinement, before) = match meshes.last() {
                None => (first()?, None, 0.0),
                Some(coarser) => {
                    let (piece, by) = coarser.piece.refined(domain)?;
                    (piece, Some(by), coarser.seconds)
                }
            };
            let seconds = before + clock.elapsed().as_secs_f64();
            let prolongation = OnceLock::new();
            meshes.push(NestedMesh { level, piece, refinement, prolongation, seconds });
        }
        Ok(Self { meshes })
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
        self.at(position).piece.mesh()
    }
    fn at(&self, position: usize) -> &NestedMesh<D> {
        match self.meshes.get(position) {
            Some(found) => found,
            None => panic!("there are {} meshes, none at position {position}", self.n_meshes()),
        }
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
        match &self.at(position).piece {
            Piece::Part(part, exchange) => Some(SharedPart { part, exchange }),
            Piece::Whole(_) => None,
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
        self.at(position).seconds
    }
    /// The parents of the vertices of a mesh in the next coarser one; `None` for the coarsest mesh.
    pub(super) fn refinement(&self, position: usize) -> Option<&Refinement> {
        self.at(position).refinement.as_ref()
    }
    /// The prolongation of P1 functions from the next coarser mesh; `None` for the coarsest mesh, and on parts, where
    /// no multigrid of this process uses it.
    pub(super) fn prolongation(&self, position: usize) -> Option<&Arc<Prolongation>> {
        let refinement = self.refinement(position).filter(|_| self.part(position).is_none())?;
        let n_coarse = self.mesh(position - 1).vertices().len();
        let new = || Arc::new(Prolongation::midpoints(&refinement.parents, n_coarse));
        Some(once(&self.at(position).prolongation, new))
    }
}

/// Fewest subdivisions of a level that serves as a coarser one.
const COARSEST: usize = 4;

/// The hierarchies of a domain: of a built-in one, or of the mesh of a file.
impl<const D: usize> Hierarchy<D> {
    /// The levels of the hierarchy that ends with a level, coarsest first; no level of a built-in domain but the last
    /// is less than `coarsest`.
    fn levels_of(domain: &Domain<D>, level: usize, coarsest: usize) -> Vec<usize> {
        let mut levels = vec![level];
        let coarser = |level: usize| match domain {
            Domain::Mesh(_) => level.checked_sub(1),
            _ => (level.is_multiple_of(2) && level / 2 >= coarsest).then_some(level / 2),
        };
        while let Some(next) = levels.last().and_then(|&l| coarser(l)) {
            levels.push(next);
        }
        levels.reverse();
        levels
    }

    /// The fewest hierarchies that have all of these levels, each built by a function of its finest level.
    pub(crate) fn all_by(
        levels: &[usize],
        build: impl Fn(usize) -> Result<Self, Error>,
    ) -> Result<Vec<Self>, Error> {
        let mut hierarchies: Vec<Self> = Vec::new();
        for level in descending(levels) {
            if !hierarchies.iter().any(|h| h.position(level).is_some()) {
                hierarchies.push(build(level)?);
            }
        }
        Ok(hierarchies)
    }

    /// As [`Hierarchy::of_domain`]; no mesh of a built-in domain but the last has a level less than `coarsest`.
    pub(crate) fn of_domain_from(
        domain: &Domain<D>,
        level: usize,
        coarsest: usize,
    ) -> Result<Self, Error> {
        compiled!(const D: fn(&Domain<D>, usize, usize) -> Result<Hierarchy<D>, Error>
            = |domain, level, coarsest| {
                check_level(domain, level, 1)?;
                let levels = Hierarchy::levels_of(domain, level, coarsest);
                let first = || Ok(Piece::Whole(domain.mesh(levels[0])?));
                Hierarchy::build(&levels, first, domain)
            }
        )(domain, level, coarsest)
    }

    /// The parts of the hierarchy that ends with a level; its coarsest mesh has enough cells for each process. All
    /// processes call it.
    pub(crate) fn of_domain_in_parts(
        domain: &Domain<D>,
        level: usize,
        layers: impl Fn(&Mesh<D>) -> Layers,
        process: (u32, &Arc<dyn Exchange>),
    ) -> Result<Self, Error> {
        check_level(domain, level, process.1.parts())?;
        let mut levels = Self::levels_of(domain, level, COARSEST);
        let least = CELLS_OF_PART * process.1.parts() as f64;
        while levels.len() > 1 && domain.cells(levels[0]) < least {
            levels.remove(0);
        }
        let first = Self::of_domain(domain, levels[0])?;
        let coarsest = first.finest();
        Self::build_parts(&levels, (coarsest, domain), layers(coarsest), process)
    }
}

/// Checks the number of cells of each part of a level of a domain, and the size of cells, before any mesh is built.
pub(crate) fn check_level<const D: usize>(
    domain: &Domain<D>,
    level: usize,
    parts: usize,
) -> Result<(), Error> {
    let is_mesh = domain.is_mesh();
    if !is_mesh {
        let domain = domain.bounding_box();
        let sides = domain.upper - domain.lower;
        if let Some(side) = sides.iter().find(|side| !(**side > 0.0 && side.is_finite())) {
            let allowed = "positive and finite, the upper corner less the lower one";
            return Err(Error::parameter("side of the domain", side, allowed));
        }
    }
    let cells = domain.cells(level) / parts as f64;
    let limit = CELL_LIMIT as f64;
    if cells > limit {
        let kind = match is_mesh {
            true => "refinements of the mesh",
            false => "subdivisions of the shortest side",
        };
        let place = if parts > 1 { " in each process" } else { "" };
        let allowed = format!(
            "so many {kind} would make {cells:.1e} cells{place}, at most {limit:.1e} are possible"
        );
        return Err(Error::parameter("level", level, allowed));
    }
    // the constructor of an input mesh checks its cells
    if is_mesh {
        return Ok(());
    }
    if level == 0 {
        let allowed = "a built-in mesh has at least one subdivision of its shortest side; refinements, from 0, are those of a mesh file";
        return Err(Error::parameter("level", 0, allowed));
    }
    // squares and volumes of cells, and their reciprocals, must be in the range of floating-point numbers
    let power = D.max(2) as i32;
    let outside = |&h: &f64| !(h.powi(power).is_normal() && h.powi(-power).is_normal());
    match domain.spacings(level).into_iter().find(outside) {
        None => Ok(()),
        Some(h) => Err(Error::parameter(
            "spacing",
            format!("{h:.1e}"),
            "one whose powers up to the dimension are floating-point numbers; choose another scale or level",
        )),
    }
}

/// Levels from the finest to the coarsest; not generic, so that the sorting code is compiled once.
fn descending(levels: &[usize]) -> Vec<usize> {
    let mut levels = levels.to_vec();
    levels.sort_unstable_by(|a, b| b.cmp(a));
    levels
}

//! Names of regions of cells and of groups of boundary facets.
//!
//! A cell or a boundary facet may be in several named groups. Cells with the same names form a *region*,
//! boundary facets with the same names a *boundary group*; the mesh stores one number for each cell
//! and boundary facet. Refinement keeps both.

use super::Neighbours;
use super::boundary::BoundaryPart;
use super::error::MeshError;
use super::simplicial::Mesh;
use super::validate::unsupported_component;
use crate::real::Real;

/// The names that a set of boundary facets has in common, and its part of the boundary.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BoundaryGroup {
    /// The names.
    pub names: Vec<String>,
    /// The part; none as long as neither a name (`dirichlet`, `neumann`, `contact`) nor a problem
    /// decides.
    pub part: Option<BoundaryPart>,
}

/// The regions and boundary groups of a mesh, by number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::mesh) struct Groups {
    /// The names of each region; a mesh without names has one region without names.
    pub regions: Vec<Vec<String>>,
    /// The boundary groups.
    pub boundary: Vec<BoundaryGroup>,
}

impl Groups {
    /// One region without names, and boundary groups of one name each with these parts.
    pub fn of_boundary(boundary: impl IntoIterator<Item = (String, BoundaryPart)>) -> Self {
        let group = |(name, part)| BoundaryGroup { names: vec![name], part: Some(part) };
        Self { regions: vec![Vec::new()], boundary: boundary.into_iter().map(group).collect() }
    }
}

/// Sets of names, each with a number.
#[derive(Debug)]
pub(in crate::mesh) struct NameSets(Vec<Vec<String>>);

impl NameSets {
    /// One set for each name.
    pub fn new(names: &[String]) -> Self {
        Self(names.iter().map(|name| vec![name.clone()]).collect())
    }
    /// The number of the union of two sets.
    pub fn union(&mut self, a: usize, b: usize) -> usize {
        let mut union = self.0[a].clone();
        union.extend(self.0[b].iter().filter(|name| !self.0[a].contains(name)).cloned());
        let is_union = |set: &Vec<String>| {
            set.len() == union.len() && set.iter().all(|name| union.contains(name))
        };
        self.0.iter().position(is_union).unwrap_or_else(|| {
            self.0.push(union);
            self.0.len() - 1
        })
    }
    /// The names of a set.
    pub fn names(&self, set: usize) -> &[String] {
        &self.0[set]
    }
}

impl<T: Real, const D: usize> Mesh<T, D> {
    /// The names of each region, by number.
    pub fn regions(&self) -> &[Vec<String>] {
        &self.groups.regions
    }
    /// The number of the region of a cell.
    #[inline(always)]
    pub fn region(&self, cell: usize) -> usize {
        self.cell_regions.get(cell).map_or(0, |&region| usize::from(region))
    }
    /// The number of the boundary group of a facet of a cell; none between two cells.
    pub fn boundary_group(&self, cell: usize, local: usize) -> Option<usize> {
        let key = (cell as u32, local as u8);
        let found =
            self.boundary.binary_search_by_key(&key, |facet| (facet.cell, facet.local)).ok()?;
        Some(usize::from(self.boundary[found].group))
    }
    /// The boundary groups, by number.
    pub fn boundary_groups(&self) -> &[BoundaryGroup] {
        &self.groups.boundary
    }

    /// The mesh with these regions: the names of each, and the number of the region of each cell.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] unless there is one number for each cell, less than that of regions.
    pub fn with_regions(
        mut self,
        regions: Vec<Vec<String>>,
        of_cells: Vec<u16>,
    ) -> Result<Self, MeshError> {
        let refuse = |parameter, value: String, allowed: String| {
            Err(MeshError::Parameter { parameter, value, allowed })
        };
        if of_cells.len() != self.n_cells() {
            let allowed = format!("one for each of {} cells", self.n_cells());
            return refuse("numbers of regions of cells", of_cells.len().to_string(), allowed);
        }
        if let Some(region) = of_cells.iter().find(|&&k| usize::from(k) >= regions.len()) {
            let allowed = format!("less than {}, the number of regions", regions.len());
            return refuse("region of a cell", region.to_string(), allowed);
        }
        std::sync::Arc::make_mut(&mut self.groups).regions = regions;
        self.cell_regions = of_cells;
        Ok(self)
    }

    /// The mesh with the part of each boundary group decided by its names; a group that has no name for
    /// which `part_of` knows a part keeps the part that it has.
    ///
    /// # Errors
    /// [`MeshError::GroupInTwoParts`].
    pub fn with_boundary_parts(
        mut self,
        part_of: &dyn Fn(&str) -> Option<BoundaryPart>,
    ) -> Result<Self, MeshError> {
        let groups = std::sync::Arc::make_mut(&mut self.groups);
        for BoundaryGroup { names, part } in &mut groups.boundary {
            let mut known: Option<(&str, BoundaryPart)> = None;
            for (name, found) in names.iter().filter_map(|name| Some((name, part_of(name)?))) {
                match known {
                    Some((first, other)) if other != found => {
                        return Err(MeshError::GroupInTwoParts {
                            groups: [first.to_owned(), name.clone()],
                            parts: [other.name(), found.name()],
                        });
                    }
                    _ => known = Some((name, found)),
                }
            }
            *part = known.map(|(_, part)| part).or(*part);
        }
        for facet in &mut self.boundary {
            if let Some(part) = groups.boundary[usize::from(facet.group)].part {
                facet.part = part;
            }
        }
        let is_dirichlet = |part| part == BoundaryPart::Dirichlet;
        let neighbours = Neighbours::new(&self);
        self.is_supported =
            unsupported_component(&neighbours, &self.boundary, is_dirichlet).is_none();
        Ok(self)
    }

    /// Checks that the part of every boundary group is decided.
    ///
    /// # Errors
    /// [`MeshError::UndecidedGroup`].
    pub fn check_boundary_parts(&self) -> Result<(), MeshError> {
        match self.groups.boundary.iter().find(|group| group.part.is_none()) {
            Some(group) => Err(MeshError::undecided(&group.names)),
            None => Ok(()),
        }
    }
}

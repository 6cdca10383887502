//! The names of the regions and boundary groups of a mesh.

use std::sync::Arc;

use super::boundary::BoundaryCondition;
use super::components::Components;
use super::error::MeshError;
use super::facets::Neighbours;
use super::groups::BoundaryGroup;
use super::simplicial::Mesh;
use super::validate::is_supported;

impl<const D: usize> Mesh<D> {
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

    /// The names of groups that have facets between two cells: these facets were left out, for data are given
    /// on the boundary only.
    pub fn groups_inside(&self) -> &[String] {
        &self.groups.inside
    }

    /// The mesh with these regions: the names of each, and the number of the region of each cell.
    ///
    /// # Errors
    /// `MeshErrorKind::Parameter` unless there is one number for each cell, less than that of regions.
    pub fn with_regions(
        mut self,
        regions: Vec<Vec<String>>,
        of_cells: Vec<u16>,
    ) -> Result<Self, MeshError> {
        if of_cells.len() != self.n_cells() {
            let allowed = format!("one for each of {} cells", self.n_cells());
            let parameter = "numbers of regions of cells";
            return Err(MeshError::parameter(parameter, of_cells.len(), allowed));
        }
        if let Some(region) = of_cells.iter().find(|&&k| usize::from(k) >= regions.len()) {
            let allowed = format!("less than {}, the number of regions", regions.len());
            return Err(MeshError::parameter("region of a cell", region, allowed));
        }
        Arc::make_mut(&mut self.groups).regions = regions;
        self.cell_regions = of_cells;
        Ok(self)
    }

    /// The mesh with the condition of each boundary group decided by its names; a group that has no name for
    /// which `condition_of` knows a condition keeps the condition that it has.
    ///
    /// # Errors
    /// `MeshErrorKind::GroupWithTwoConditions`.
    pub fn with_boundary_conditions(
        mut self,
        condition_of: &dyn Fn(&str) -> Option<BoundaryCondition>,
    ) -> Result<Self, MeshError> {
        let groups = Arc::make_mut(&mut self.groups);
        for BoundaryGroup { names, condition } in &mut groups.boundary {
            let mut known: Option<(&str, BoundaryCondition)> = None;
            let decided =
                |name: &str| condition_of(name).or_else(|| BoundaryCondition::from_name(name));
            for (name, found) in names.iter().filter_map(|name| Some((name, decided(name)?))) {
                match known {
                    Some((first, other)) if other != found => {
                        return Err(MeshError::two_conditions([first, name], [other, found]));
                    }
                    _ => known = Some((name, found)),
                }
            }
            *condition = known.map(|(_, condition)| condition).or(*condition);
        }
        for facet in &mut self.boundary {
            if let Some(condition) = groups.boundary[usize::from(facet.group)].condition {
                facet.condition = condition;
            }
        }
        let mut components = Components::of_cells(&Neighbours::new(&self));
        self.is_supported = is_supported(&mut components, &self.boundary);
        Ok(self)
    }

    /// Checks that the condition of every boundary group is decided.
    ///
    /// # Errors
    /// `MeshErrorKind::UndecidedGroup`.
    pub fn check_boundary_conditions(&self) -> Result<(), MeshError> {
        match self.groups.boundary.iter().find(|group| group.condition.is_none()) {
            Some(group) => Err(MeshError::undecided(&group.names)),
            None => Ok(()),
        }
    }
}

//! The data of a problem on a mesh: found by region and boundary group once, then by number.

use super::Problem;
use super::datum::{BoundaryFlux, Datum, Field};
use crate::error::Error;
use crate::input::{excerpt, excerpts};
use crate::mesh::{BoundaryGroup, BoundaryPart, Mesh, MeshError};
use crate::real::Point;

/// A datum, whether it was given as such or as a function.
#[derive(Clone, Copy)]
pub(crate) enum DatumRef<'a, const D: usize> {
    Datum(&'a Datum<D>),
    Function(&'a Field<D>),
}

impl<'a, const D: usize> DatumRef<'a, D> {
    /// The value at a point.
    #[inline(always)]
    pub fn at(self, x: &Point<D>) -> f64 {
        match self {
            Self::Datum(datum) => datum.at(x),
            Self::Function(function) => function(x),
        }
    }
    /// The value of a constant.
    pub fn constant(self) -> Option<f64> {
        match self {
            Self::Datum(&Datum::Constant(c)) => Some(c),
            _ => None,
        }
    }
    /// The degree of a polynomial, where it is known.
    pub fn degree(self) -> Option<usize> {
        match self {
            Self::Datum(datum) => datum.degree(),
            Self::Function(_) => None,
        }
    }
    /// The function whose zero set divides cells, if there is one.
    pub fn level(self) -> Option<&'a Field<D>> {
        match self {
            Self::Datum(datum) => datum.level(),
            Self::Function(_) => None,
        }
    }
}

/// What is given in each region, or on each boundary group.
#[derive(Clone)]
pub(crate) struct ByGroup<F> {
    /// Where no data have names.
    everywhere: Option<F>,
    /// By number of the group; empty if no data have names.
    by_group: Vec<Option<F>>,
}

impl<F: Copy> ByGroup<F> {
    /// For each group the first datum with one of its names, or the datum without a name.
    fn new<'n>(everywhere: Option<F>, named: &[(&'n str, F)], groups: &[&'n [String]]) -> Self {
        let of = |names: &[String]| {
            let first = named.iter().find(|(name, _)| names.iter().any(|n| n == name));
            first.map(|(_, datum)| *datum).or(everywhere)
        };
        let groups = if named.is_empty() { &[] } else { groups };
        let by_group = groups.iter().map(|names| of(names)).collect();
        Self { everywhere, by_group }
    }
    /// The datum of a group.
    #[inline(always)]
    pub fn of(&self, group: usize) -> Option<F> {
        match self.by_group.is_empty() {
            true => self.everywhere,
            false => self.by_group[group],
        }
    }
    /// The data of all groups; one entry if none have names.
    pub fn all(&self) -> impl Iterator<Item = F> + '_ {
        let everywhere = self.everywhere.filter(|_| self.by_group.is_empty());
        everywhere.into_iter().chain(self.by_group.iter().flatten().copied())
    }
    /// Whether there is a datum anywhere.
    pub fn is_given(&self) -> bool {
        self.any(&|_| true)
    }
    /// Whether some datum has a property.
    pub fn any(&self, has: &dyn Fn(F) -> bool) -> bool {
        self.all().any(has)
    }
    /// Whether all data have a property.
    pub fn every(&self, has: &dyn Fn(F) -> bool) -> bool {
        self.all().all(has)
    }
    /// Whether some data have names.
    pub fn has_names(&self) -> bool {
        !self.by_group.is_empty()
    }
}

/// Data that are functions of space.
pub(crate) type DataByGroup<'a, const D: usize> = ByGroup<DatumRef<'a, D>>;

/// The data of a problem on a mesh.
#[derive(Clone)]
pub(crate) struct DataOnMesh<'a, const D: usize> {
    pub coefficient: DataByGroup<'a, D>,
    pub source: DataByGroup<'a, D>,
    pub reaction: DataByGroup<'a, D>,
    pub lower: DataByGroup<'a, D>,
    pub upper: DataByGroup<'a, D>,
    pub dirichlet: DataByGroup<'a, D>,
    pub gap: DataByGroup<'a, D>,
    pub neumann: ByGroup<&'a BoundaryFlux<D>>,
    /// For each boundary group the rank of its Dirichlet datum: of unknowns on several groups those of
    /// the lowest rank take precedence.
    pub dirichlet_rank: Vec<usize>,
}

impl<'a, const D: usize> DataOnMesh<'a, D> {
    /// The data of a problem on a mesh.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`] for a name that the mesh does not have, [`Error::Mesh`] for a boundary
    /// group of undecided part, [`Error::UnboundBoundary`] for one of another part than that of its data.
    pub fn new(problem: &'a Problem<D>, mesh: &'a Mesh<D>) -> Result<Self, Error> {
        mesh.check_boundary_parts()?;
        Self::of_groups(problem, mesh.regions(), mesh.boundary_groups(), mesh.groups_inside())
    }

    /// The data of a problem in regions and boundary groups.
    fn of_groups(
        problem: &'a Problem<D>,
        regions: &[Vec<String>],
        boundary: &[BoundaryGroup],
        inside: &[String],
    ) -> Result<Self, Error> {
        let named = &problem.named;
        let regions: Vec<&[String]> = regions.iter().map(|names| &names[..]).collect();
        let groups: Vec<&[String]> = boundary.iter().map(|group| &group.names[..]).collect();
        for (name, is_boundary) in named.names() {
            let all = if is_boundary { &groups } else { &regions };
            if !all.iter().any(|names| names.iter().any(|n| n == name)) {
                let is_inside = is_boundary && inside.iter().any(|n| n == name);
                return Err(unknown_group(name, (is_boundary, is_inside), all));
            }
        }
        for group in boundary {
            let given = group.names.iter().find_map(|n| Some((n, named.part_of(n)?)));
            match (given, group.part) {
                (Some((name, given)), Some(part)) if given != part => {
                    let (group, given, part) = (excerpt(name), given.name(), part.name());
                    return Err(Error::UnboundBoundary { group, given, part });
                }
                (None, Some(BoundaryPart::Contact))
                    if problem.gap.is_none() && problem.has_gap() =>
                {
                    return Err(MeshError::undecided(&group.names).into());
                }
                _ => {}
            }
        }
        let datum = |f: &'a Option<Datum<D>>| f.as_ref().map(DatumRef::Datum);
        let exact = problem.exact.as_ref().map(|exact| DatumRef::Function(&exact.value));
        let list = |data: &'a [(String, Datum<D>)]| -> Vec<(&'a str, DatumRef<'a, D>)> {
            data.iter().map(|(name, datum)| (&name[..], DatumRef::Datum(datum))).collect()
        };
        let in_regions = |everywhere, data| ByGroup::new(everywhere, &list(data), &regions);
        let on_groups = |everywhere, data| ByGroup::new(everywhere, &list(data), &groups);
        let fluxes: Vec<_> = named.neumann.iter().map(|(name, flux)| (&name[..], flux)).collect();
        let rank = |names: &[String]| {
            let given = named.dirichlet.iter().position(|(name, _)| names.contains(name));
            given.unwrap_or(named.dirichlet.len())
        };
        Ok(Self {
            coefficient: in_regions(datum(&problem.coefficient), &named.coefficient),
            source: in_regions(datum(&problem.source), &named.source),
            reaction: in_regions(datum(&problem.reaction), &named.reaction),
            lower: in_regions(datum(&problem.lower), &named.lower),
            upper: in_regions(datum(&problem.upper), &named.upper),
            dirichlet: on_groups(datum(&problem.dirichlet).or(exact), &named.dirichlet),
            gap: on_groups(datum(&problem.gap), &named.gap),
            neumann: ByGroup::new(problem.neumann.as_ref(), &fluxes, &groups),
            dirichlet_rank: groups.iter().map(|names| rank(names)).collect(),
        })
    }
}

/// The error for a name that no region or boundary group has.
fn unknown_group(
    name: &str,
    (is_boundary, is_inside): (bool, bool),
    groups: &[&[String]],
) -> Error {
    Error::UnknownGroup {
        kind: if is_boundary { "boundary group" } else { "region" },
        name: excerpt(name),
        known: match &excerpts(groups.iter().copied().flatten())[..] {
            known if is_inside => {
                format!("it lies inside the domain, between two cells; the boundary has {known}")
            }
            "" => "it has none with a name".to_owned(),
            known => format!("it has {known}"),
        },
    }
}

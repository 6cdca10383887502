//! Names and values of a problem file, held against the mesh.

use crate::input::excerpt;
use crate::mesh::{BoundaryCondition, Mesh, describe_point};
use crate::problem::{BoundaryFlux, Exact, unknown_name};
use crate::problem_file::error::{ProblemFileError, ProblemFileErrorKind};
use crate::problem_file::table::Source;
use crate::quadrature::{Rule, facet_to_cell};
use crate::real::Point;

/// The values that a datum may have, and what they are.
pub(super) type Allowed = (fn(f64) -> bool, &'static str);

pub(super) const FINITE: Allowed = (f64::is_finite, "finite");
pub(super) const NOT_NEGATIVE: Allowed = (|x| x.is_finite() && x >= 0.0, "finite and not negative");
pub(super) const POSITIVE: Allowed = (|x| x.is_finite() && x > 0.0, "finite and positive");

/// The degree of the rule at whose points expressions are evaluated: that of loads of linears.
const SAMPLED_DEGREE: usize = 5;

/// The step of difference quotients of an exact solution, in units of the diameter of a cell.
const DIFFERENCE: f64 = 1e-5;

/// A gradient may differ from difference quotients by this share of its size.
const AGREEMENT: f64 = 1e-2;

/// The group of cells in no group with data.
pub(super) const DEFAULT: &str = "default";

/// The table of data of the boundary.
pub(super) const BOUNDARY: &str = "boundary";

/// The table of the exact solution, whose entries are those of no group.
pub(super) const EXACT: &str = "exact";

/// A datum with its place, for checks.
pub(super) struct Entry<const D: usize> {
    pub table: &'static str,
    /// Region or boundary group; `default` for cells in no other of the table.
    pub group: String,
    /// What follows table and group in the name of the datum.
    pub key: &'static str,
    /// Whether it must have a value at vertices: data of rules on cells and facets may be singular there.
    pub at_vertices: bool,
    pub offset: usize,
    pub allowed: Allowed,
    pub value: BoundaryFlux<D>,
}

/// The data of a file, to be held against a mesh.
pub(super) struct Checks<'s, 't, const D: usize> {
    pub source: &'s Source<'t>,
    pub entries: &'s [Entry<D>],
    /// The boundary groups that the file names, with their conditions.
    pub conditions: &'s [(String, BoundaryCondition)],
    /// The exact solution, and where the file has its gradient.
    pub exact: Option<(&'s Exact<D>, usize)>,
}

type Done = Result<(), ProblemFileError>;

impl<const D: usize> Checks<'_, '_, D> {
    /// Holds names and values against a mesh.
    pub fn run(&self, mesh: &Mesh<D>) -> Done {
        for entry in self.entries.iter().filter(|e| e.group != DEFAULT && e.table != EXACT) {
            if let Some(message) = unknown_name(mesh, &entry.group, entry.table == BOUNDARY) {
                let kind = ProblemFileErrorKind::Group;
                return Err(self.source.error(entry.offset, kind, message));
            }
        }
        for group in mesh.boundary_groups() {
            if !self.conditions.iter().any(|(known, _)| group.names.contains(known)) {
                let name = excerpt(group.names.first().expect("a boundary group has a name"));
                let message = format!(
                    "the boundary group `{name}` of the mesh is missing: add a table [boundary.{name}] with its kind, dirichlet, neumann, robin, friction or contact, or [boundary.default] for groups without one, if its kind is that of the name"
                );
                return Err(self.source.error(0, ProblemFileErrorKind::Group, message));
            }
        }
        self.entries.iter().try_for_each(|entry| self.check_values(entry, mesh))?;
        self.exact.map_or(Ok(()), |(exact, offset)| self.check_gradient(exact, offset, mesh))
    }

    /// Holds the gradient of the exact solution against one-sided difference quotients of its value at the
    /// barycentres of cells, so that a kink there is no fault.
    fn check_gradient(&self, exact: &Exact<D>, offset: usize, mesh: &Mesh<D>) -> Done {
        for (cell, k) in (0..mesh.n_cells()).flat_map(|c| (0..D).map(move |k| (c, k))) {
            let x = mesh.barycentre(cell);
            let step = DIFFERENCE * mesh.cell_diameter(cell);
            let (value, gradient) = (exact.value.at(&x), (exact.gradient)(&x));
            // what rounding does to a quotient
            let rounding = 8.0 * f64::EPSILON * value.abs() / step;
            let tolerance = AGREEMENT * gradient.norm() + rounding;
            let quotient = |step: f64| {
                let mut beside = x;
                beside[k] += step;
                (exact.value.at(&beside) - value) / step
            };
            let (one, other) = (quotient(-step), quotient(step));
            if gradient[k] < one.min(other) - tolerance || gradient[k] > one.max(other) + tolerance
            {
                let message = format!(
                    "component {} of exact.gradient is {} at {}, but difference quotients of exact.value are {}",
                    k + 1,
                    gradient[k],
                    describe_point(&x),
                    0.5 * (one + other)
                );
                return Err(self.source.error(offset, ProblemFileErrorKind::Value, message));
            }
        }
        Ok(())
    }

    /// Evaluates a datum where it is given: in cells, or on facets of the boundary, at the middle, at the points of a
    /// rule, and at vertices.
    fn check_values(&self, entry: &Entry<D>, mesh: &Mesh<D>) -> Done {
        let check = |x: &Point<D>, normal: &Point<D>| {
            let value = entry.value.at(x, normal);
            let (holds, allowed) = entry.allowed;
            if holds(value) {
                return Ok(());
            }
            let message = format!(
                "{}.{}{} is {value} at {}: it must be {allowed}",
                entry.table,
                entry.group,
                entry.key,
                describe_point(x),
            );
            Err(self.source.error(entry.offset, ProblemFileErrorKind::Value, message))
        };
        if matches!(entry.value, BoundaryFlux::Constant(_)) {
            return check(&Point::zeros(), &Point::zeros());
        }
        let is_meant = |names: &[String]| match &entry.group[..] {
            DEFAULT => {
                let of_table = self.entries.iter().filter(|other| other.table == entry.table);
                !of_table.into_iter().any(|other| names.contains(&other.group))
            }
            _ if entry.table == EXACT => true,
            group => names.iter().any(|name| name == group),
        };
        let check_in = |cell: usize, local: Option<usize>, rule: &[[f64; 4]]| {
            let normal = local.map_or_else(Point::zeros, |k| mesh.geometry(cell).normal(k));
            for point in rule {
                let point = local.map_or(*point, |k| facet_to_cell(point, k));
                check(&mesh.point(cell, &point[..=D]), &normal)?;
            }
            let vertices = mesh.cell(cell).iter().enumerate();
            let vertices = vertices.filter(|(k, _)| entry.at_vertices && Some(*k) != local);
            vertices.map(|(_, &v)| v).try_for_each(|v| check(&mesh.vertices()[v as usize], &normal))
        };
        let points = |dimension| {
            let middle = Rule::new(dimension, 1).points;
            [middle, Rule::new(dimension, SAMPLED_DEGREE).points].concat()
        };
        if entry.table == BOUNDARY {
            let (points, groups) = (points(D - 1), mesh.boundary_groups());
            let facets = mesh.boundary().iter();
            let mut facets = facets.filter(|f| is_meant(&groups[usize::from(f.group)].names));
            return facets
                .try_for_each(|f| check_in(f.cell as usize, Some(usize::from(f.local)), &points));
        }
        let points = points(D);
        let mut cells = (0..mesh.n_cells()).filter(|&c| is_meant(&mesh.regions()[mesh.region(c)]));
        cells.try_for_each(|cell| check_in(cell, None, &points))
    }
}

//! Names and values of a problem file, held against the mesh.

use crate::input::{excerpt, excerpts};
use crate::mesh::BoundaryCondition;
use crate::mesh::{Mesh, describe_point};
use crate::problem::{BoundaryFlux, Problem};
use crate::problem_file::error::{ProblemFileError, ProblemFileErrorKind};
use crate::problem_file::table::{Formula, Source};
use crate::quadrature::{Rule, facet_to_cell};
use crate::real::Point;

/// The values that a datum may have.
#[derive(Clone, Copy)]
pub(super) enum Allowed {
    Finite,
    NotNegative,
    Positive,
    /// Of the least pivot of a tensor.
    Definite,
}

/// The degree of the rule at whose points expressions are evaluated: that of loads of linears.
const SAMPLED_DEGREE: usize = 5;

/// The step of difference quotients of an exact solution, in units of the diameter of a cell.
const DIFFERENCE: f64 = 1e-5;

/// A gradient may differ from difference quotients by this share of its size.
const AGREEMENT: f64 = 1e-2;

impl Allowed {
    fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::NotNegative => value >= 0.0,
                Self::Positive | Self::Definite => value > 0.0,
            }
    }
    fn describe(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::NotNegative => "finite and not negative",
            Self::Positive => "finite and positive",
            Self::Definite => "positive for the tensor to be positive definite",
        }
    }
}

/// A datum with its place, for checks.
pub(super) struct Entry<const D: usize> {
    /// The name of the datum: `source of region steel`, say.
    pub datum: String,
    /// Region or boundary group; none for cells in no other.
    pub group: Option<String>,
    pub is_boundary: bool,
    /// Of the other groups with such a datum.
    pub others: Vec<String>,
    /// Whether it must have a value at vertices: data of rules on cells and facets may be singular there.
    pub at_vertices: bool,
    pub offset: usize,
    pub allowed: Allowed,
    pub value: BoundaryFlux<D>,
}

impl<const D: usize> Entry<D> {
    /// The exact solution, or a component of its gradient.
    pub fn of_exact(name: &str, formula: &Formula, offset: usize) -> Self {
        Self {
            datum: format!("exact.{name}"),
            group: None,
            is_boundary: false,
            others: Vec::new(),
            at_vertices: true,
            offset,
            allowed: Allowed::Finite,
            value: formula.flux(),
        }
    }
}

/// The data of a file, to be held against a mesh.
pub(super) struct Checks<'s, 't, const D: usize> {
    pub source: &'s Source<'t>,
    pub problem: &'s Problem<D>,
    pub entries: &'s [Entry<D>],
    /// The boundary groups that the file names, with their conditions.
    pub conditions: &'s [(String, BoundaryCondition)],
    /// Where the file has the gradient of the exact solution.
    pub gradient_offset: usize,
}

type Done = Result<(), ProblemFileError>;

impl<const D: usize> Checks<'_, '_, D> {
    /// Holds names and values against a mesh.
    pub fn run(&self, mesh: &Mesh<D>) -> Done {
        let groups: Vec<&[String]> = mesh.boundary_groups().iter().map(|g| &g.names[..]).collect();
        let regions: Vec<&[String]> = mesh.regions().iter().map(|names| &names[..]).collect();
        for entry in self.entries {
            let (kind, known) = match entry.is_boundary {
                true => ("boundary group", &groups),
                false => ("region", &regions),
            };
            let Some(name) = &entry.group else { continue };
            if !known.iter().any(|names| names.contains(name)) {
                let known = excerpts(known.iter().copied().flatten());
                let known = if known.is_empty() { "none".to_owned() } else { known };
                let is_inside = entry.is_boundary && mesh.groups_inside().contains(name);
                let name = excerpt(name);
                let message = match is_inside {
                    true => format!(
                        "`{name}` lies inside the domain, between two cells: data are given on the boundary only, where the mesh has {known}"
                    ),
                    false => format!("the mesh has no {kind} `{name}`; it has {known}"),
                };
                let kind = ProblemFileErrorKind::UnknownGroup;
                return Err(self.source.error(entry.offset, kind, message));
            }
        }
        for names in groups {
            if !names.iter().any(|name| self.conditions.iter().any(|(known, _)| known == name)) {
                let name = excerpt(names.first().expect("a boundary group has a name"));
                let message = format!(
                    "the boundary group `{name}` of the mesh is missing: add a table [boundary.{name}] with its kind, dirichlet, neumann, robin, friction or contact, or [boundary.default] for groups without one, if its kind is that of the name"
                );
                return Err(self.source.error(0, ProblemFileErrorKind::MissingBoundary, message));
            }
        }
        self.entries.iter().try_for_each(|entry| self.check_values(entry, mesh))?;
        self.check_gradient(mesh)
    }

    /// Holds the gradient of the exact solution against one-sided difference quotients of its value at the
    /// barycentres of cells, so that a kink there is no fault.
    fn check_gradient(&self, mesh: &Mesh<D>) -> Done {
        let Some(exact) = &self.problem.exact else { return Ok(()) };
        for cell in 0..mesh.n_cells() {
            let x = mesh.barycentre(cell);
            let step = DIFFERENCE * mesh.cell_diameter(cell);
            let (value, gradient) = (exact.value.at(&x), (exact.gradient)(&x));
            // what rounding does to a quotient
            let rounding = 8.0 * f64::EPSILON * value.abs() / step;
            let tolerance = AGREEMENT * gradient.norm() + rounding;
            for k in 0..D {
                let quotient = |step: f64| {
                    let mut beside = x;
                    beside[k] += step;
                    (exact.value.at(&beside) - value) / step
                };
                let (one, other) = (quotient(-step), quotient(step));
                let (least, most) = (one.min(other) - tolerance, one.max(other) + tolerance);
                if gradient[k] < least || gradient[k] > most {
                    let message = format!(
                        "component {} of exact.gradient is {} at {}, but difference quotients of exact.value are {}",
                        k + 1,
                        gradient[k],
                        describe_point(&x),
                        0.5 * (one + other)
                    );
                    let kind = ProblemFileErrorKind::Gradient;
                    return Err(self.source.error(self.gradient_offset, kind, message));
                }
            }
        }
        Ok(())
    }

    fn check_values(&self, entry: &Entry<D>, mesh: &Mesh<D>) -> Done {
        let check = |x: &Point<D>, normal: &Point<D>| {
            let value = entry.value.at(x, normal);
            if entry.allowed.holds(value) {
                return Ok(());
            }
            let message = format!(
                "{} is {value} at {}: it must be {}",
                entry.datum,
                describe_point(x),
                entry.allowed.describe()
            );
            Err(self.source.error(entry.offset, ProblemFileErrorKind::Value, message))
        };
        let is_meant = |names: &[String]| match &entry.group {
            Some(name) => names.contains(name),
            None => !names.iter().any(|name| entry.others.contains(name)),
        };
        if matches!(entry.value, BoundaryFlux::Constant(_)) {
            return check(&Point::zeros(), &Point::zeros());
        }
        let vertex = |v: u32| mesh.vertices()[v as usize];
        let [on_facet, in_cell] = [D - 1, D].map(|dimension| Rule::new(dimension, SAMPLED_DEGREE));
        if entry.is_boundary {
            for facet in mesh.boundary() {
                let group = &mesh.boundary_groups()[usize::from(facet.group)];
                if !is_meant(&group.names) {
                    continue;
                }
                let (cell, local) = (facet.cell as usize, facet.local as usize);
                let normal = mesh.geometry(cell).normal(local);
                check(&mesh.facet_barycentre(cell, local), &normal)?;
                for (point, _) in on_facet.iter() {
                    check(&mesh.point(cell, &facet_to_cell(point, local)[..=D]), &normal)?;
                }
                if entry.at_vertices {
                    mesh.facet_vertices(cell, local)
                        .try_for_each(|v| check(&vertex(v), &normal))?;
                }
            }
            return Ok(());
        }
        let none = Point::zeros();
        for cell in 0..mesh.n_cells() {
            if is_meant(&mesh.regions()[mesh.region(cell)]) {
                check(&mesh.barycentre(cell), &none)?;
                for (point, _) in in_cell.iter() {
                    check(&mesh.point(cell, &point[..=D]), &none)?;
                }
                if entry.at_vertices {
                    mesh.cell(cell).iter().try_for_each(|&v| check(&vertex(v), &none))?;
                }
            }
        }
        Ok(())
    }
}

//! The data of a problem file, checked on its mesh.

use toml::de::DeTable;

use super::error::{ProblemFileError, ProblemFileFault};
use super::own_problem::{Geometry, OwnProblem};
use super::table::{Formula, Place, Source, Value};
use crate::error::Error;
use crate::input::excerpt;
use crate::mesh::{BoundaryPart, BoxDomain, Mesh, SIDES, describe_point};
use crate::problem::{Datum, Problem};
use crate::real::Point;

const KEYS: [&str; 9] =
    ["name", "mesh", "box", "coefficient", "source", "reaction", "obstacle", "boundary", "exact"];
/// The coordinates, then the components of the normal.
const VARIABLES: [[&str; 3]; 2] = [["x", "y", "z"], ["nx", "ny", "nz"]];
/// The group of cells in no group with data.
const DEFAULT: &str = "default";
/// The data that may be given with a level, where they jump.
const PIECEWISE: [&str; 2] = ["source", "reaction"];

/// The values that a datum may have.
#[derive(Clone, Copy)]
enum Allowed {
    Finite,
    NotNegative,
    Positive,
}

impl Allowed {
    fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::NotNegative => value >= 0.0,
                Self::Positive => value > 0.0,
            }
    }
    fn describe(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::NotNegative => "finite and not negative",
            Self::Positive => "finite and positive",
        }
    }
}

/// A datum with its place, for checks.
struct Entry<const D: usize> {
    /// What it is: `source of region steel`, say.
    datum: String,
    /// Region or boundary group; none for cells in no other.
    group: Option<String>,
    is_boundary: bool,
    /// Of the other groups with such a datum.
    others: Vec<String>,
    /// Whether it is evaluated at vertices.
    at_vertices: bool,
    offset: usize,
    allowed: Allowed,
    value: Flux<D>,
}

/// A function of point and normal.
type Flux<const D: usize> =
    std::sync::Arc<dyn Fn(&Point<f64, D>, &Point<f64, D>) -> f64 + Send + Sync>;

/// A number or expression as a function of the point and of the normal.
fn flux<const D: usize>(formula: &Formula) -> Flux<D> {
    match formula.clone() {
        Formula::Number(c) => std::sync::Arc::new(move |_, _| c),
        Formula::Expression(expression) => std::sync::Arc::new(move |x, n| {
            let mut variables = [0.0; 6];
            variables[..D].copy_from_slice(x.as_slice());
            variables[D..2 * D].copy_from_slice(n.as_slice());
            expression.value(&variables[..2 * D])
        }),
    }
}

/// A number or expression as a datum.
fn datum<const D: usize>(formula: &Formula) -> Datum<D> {
    match formula.clone() {
        Formula::Number(c) => Datum::Constant(c),
        Formula::Expression(expression) => {
            Datum::Function(std::sync::Arc::new(move |x: &Point<f64, D>| {
                expression.value(x.as_slice())
            }))
        }
    }
}

/// A number or expression as a datum that may jump where the level vanishes.
fn piecewise<const D: usize>(formula: &Formula, level: Option<&Formula>) -> Datum<D> {
    let value = datum::<D>(formula);
    match level.map(datum::<D>) {
        None => value,
        Some(level) => Datum::piecewise(move |x| value.at(x), move |x| level.at(x)),
    }
}

/// The data that have been read, and what is to be checked.
struct Builder<'s, 't, const D: usize> {
    source: &'s Source<'t>,
    problem: Problem<D>,
    entries: Vec<Entry<D>>,
    parts: Vec<(String, BoundaryPart)>,
    /// Whether the file has the exact solution.
    has_exact: bool,
}

type Done<V = ()> = Result<V, ProblemFileError>;

impl<'t, const D: usize> Builder<'_, 't, D> {
    /// Reads a table of data by region; `set` puts one into the problem.
    fn by_region(
        &mut self,
        (name, value): (&str, &Value<'t>),
        (allowed, at_vertices): (Allowed, bool),
        set: fn(Problem<D>, Option<&str>, Datum<D>) -> Problem<D>,
    ) -> Done {
        let table = self.source.table(name, value)?;
        let groups: Vec<String> = table.keys().map(|key| key.get_ref().to_string()).collect();
        for (key, value) in table.iter() {
            let group = key.get_ref().to_string();
            let variables = &VARIABLES[0][..D];
            let parts = value.get_ref().as_table().filter(|_| PIECEWISE.contains(&name));
            let (formula, level) = match parts {
                None => (self.source.formula(&group, value, variables)?, None),
                Some(parts) => {
                    self.source.allow(parts, &["value", "level"])?;
                    let part = |key: &'static str, purpose: &'static str| {
                        let missing = ProblemFileFault::Missing { key, purpose };
                        let found = parts.get(key);
                        let found =
                            found.ok_or_else(|| self.source.error(value.span().start, missing))?;
                        self.source.formula(key, found, variables)
                    };
                    let level = part("level", "an expression that vanishes where the datum jumps")?;
                    (part("value", "the datum")?, Some(level))
                }
            };
            let region = (group != DEFAULT).then_some(&group[..]);
            let given = piecewise(&formula, level.as_ref());
            self.problem = set(std::mem::take(&mut self.problem), region, given);
            self.entries.push(Entry {
                datum: format!("{name}.{group}"),
                group: region.map(str::to_owned),
                is_boundary: false,
                others: groups.clone(),
                at_vertices,
                offset: if region.is_some() { key.span().start } else { value.span().start },
                allowed,
                value: flux(&formula),
            });
        }
        Ok(())
    }

    fn obstacles(&mut self, value: &Value<'t>) -> Done {
        let table = self.source.table("obstacle", value)?;
        self.source.allow(table, &["lower", "upper"])?;
        let how = (Allowed::Finite, true);
        if let Some(value) = table.get("lower") {
            self.by_region(("obstacle.lower", value), how, |p, region, psi| match region {
                Some(region) => p.obstacle_below_in(region, psi),
                None => p.obstacle_below(move |x| psi.at(x)),
            })?;
        }
        if let Some(value) = table.get("upper") {
            self.by_region(("obstacle.upper", value), how, |p, region, psi| match region {
                Some(region) => p.obstacle_above_in(region, psi),
                None => p.obstacle_above(move |x| psi.at(x)),
            })?;
        }
        Ok(())
    }

    fn boundary(&mut self, value: &Value<'t>) -> Done {
        let boundary = self.source.table("boundary", value)?;
        for (key, value) in boundary.iter() {
            let group = key.get_ref().to_string();
            let table = self.source.table(&group, value)?;
            let kinds = "\"dirichlet\", \"neumann\" or \"contact\"";
            let Some(kind) = table.get("kind") else {
                let missing = ProblemFileFault::Missing { key: "kind", purpose: kinds };
                return Err(self.source.error(key.span().start, missing));
            };
            let part = BoundaryPart::from_name(self.source.string("kind", kind)?)
                .ok_or_else(|| self.source.wrong_type("kind", kind, kinds))?;
            let name = match part {
                BoundaryPart::Dirichlet => "value",
                BoundaryPart::Neumann => "flux",
                BoundaryPart::Contact => "gap",
            };
            self.source.allow(table, &["kind", name])?;
            let is_flux = part == BoundaryPart::Neumann;
            let variables = match is_flux {
                true => [&VARIABLES[0][..D], &VARIABLES[1][..D]].concat(),
                false => VARIABLES[0][..D].to_vec(),
            };
            let formula = match table.get(name) {
                Some(value) => self.source.formula(name, value, &variables)?,
                None if self.has_exact && part != BoundaryPart::Contact => {
                    let purpose = "the exact solution does not stand for data that are left out";
                    let missing = ProblemFileFault::Missing { key: name, purpose };
                    return Err(self.source.error(key.span().start, missing));
                }
                None => Formula::Number(0.0),
            };
            let problem = std::mem::take(&mut self.problem);
            let function = flux::<D>(&formula);
            self.problem = match part {
                BoundaryPart::Dirichlet => problem.dirichlet_on(&group, datum(&formula)),
                BoundaryPart::Contact => problem.signorini_on(&group, datum(&formula)),
                BoundaryPart::Neumann => {
                    let function = function.clone();
                    problem.neumann_on(&group, move |x, n| function(x, n))
                }
            };
            self.entries.push(Entry {
                datum: format!("boundary.{group}.{name}"),
                group: Some(group.clone()),
                is_boundary: true,
                others: Vec::new(),
                at_vertices: !is_flux,
                offset: key.span().start,
                allowed: Allowed::Finite,
                value: function,
            });
            self.parts.push((group, part));
        }
        Ok(())
    }

    fn exact(&mut self, value: &Value<'t>) -> Done {
        let source = self.source;
        let table = source.table("exact", value)?;
        source.allow(table, &["value", "gradient"])?;
        let needed = |key, purpose| {
            let missing = ProblemFileFault::Missing { key, purpose };
            table.get(key).ok_or_else(|| source.error(value.span().start, missing))
        };
        let (solution, gradient) = (
            needed("value", "the exact solution")?,
            needed("gradient", "a list with an expression for each coordinate")?,
        );
        let solution = datum::<D>(&source.formula("value", solution, &VARIABLES[0][..D])?);
        let expected = "a list with an expression for each coordinate";
        let components = gradient.get_ref().as_array().filter(|list| list.len() == D);
        let components =
            components.ok_or_else(|| source.wrong_type("gradient", gradient, expected))?;
        let component =
            |value| Ok(datum::<D>(&source.formula("gradient", value, &VARIABLES[0][..D])?));
        let components = components.iter().map(component).collect::<Done<Vec<_>>>()?;
        self.problem = std::mem::take(&mut self.problem)
            .exact(move |x| solution.at(x), move |x| Point::from_fn(|k, _| components[k].at(x)));
        Ok(())
    }

    /// Holds names and values against a mesh.
    fn check(&self, mesh: &Mesh<f64, D>) -> Done {
        let groups: Vec<&[String]> = mesh.boundary_groups().iter().map(|g| &g.names[..]).collect();
        let regions: Vec<&[String]> = mesh.regions().iter().map(|names| &names[..]).collect();
        for entry in &self.entries {
            let (kind, known) = match entry.is_boundary {
                true => ("boundary group", &groups),
                false => ("region", &regions),
            };
            let Some(name) = &entry.group else { continue };
            if !known.iter().any(|names| names.contains(name)) {
                let mut known: Vec<String> = known.iter().copied().flatten().map(excerpt).collect();
                known.sort_unstable();
                known.dedup();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                let fault = ProblemFileFault::UnknownGroup { kind, name: excerpt(name), known };
                return Err(self.source.error(entry.offset, fault));
            }
        }
        for names in groups {
            if !names.iter().any(|name| self.parts.iter().any(|(known, _)| known == name)) {
                let name = names.first().map(excerpt).unwrap_or_default();
                return Err(self.source.error(0, ProblemFileFault::MissingBoundary { name }));
            }
        }
        self.entries.iter().try_for_each(|entry| self.check_values(entry, mesh))
    }

    fn check_values(&self, entry: &Entry<D>, mesh: &Mesh<f64, D>) -> Done {
        let check = |x: &Point<f64, D>, normal: &Point<f64, D>| {
            let value = (entry.value)(x, normal);
            if entry.allowed.holds(value) {
                return Ok(());
            }
            let fault = ProblemFileFault::Value {
                datum: entry.datum.clone(),
                value,
                at: describe_point(x),
                allowed: entry.allowed.describe(),
            };
            Err(self.source.error(entry.offset, fault))
        };
        let is_meant = |names: &[String]| match &entry.group {
            Some(name) => names.contains(name),
            None => !names.iter().any(|name| entry.others.contains(name)),
        };
        let vertex = |v: u32| mesh.vertices()[v as usize];
        if entry.is_boundary {
            for facet in mesh.boundary() {
                let group = &mesh.boundary_groups()[usize::from(facet.group)];
                if !is_meant(&group.names) {
                    continue;
                }
                let (cell, local) = (facet.cell as usize, facet.local as usize);
                let normal = mesh.geometry(cell).normal(local);
                check(&mesh.facet_barycentre(cell, local), &normal)?;
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
                if entry.at_vertices {
                    mesh.cell(cell).iter().try_for_each(|&v| check(&vertex(v), &none))?;
                }
            }
        }
        Ok(())
    }
}

/// The problem of a file, in its dimension.
pub(super) fn problem<'t, const D: usize>(
    source: &Source<'t>,
    root: &DeTable<'t>,
    place: &Place,
) -> Done<OwnProblem<D>> {
    source.allow(root, &KEYS)?;
    let name = match root.get("name") {
        Some(name) => source.string("name", name)?.to_owned(),
        None => source.path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let mut builder = Builder {
        source,
        problem: Problem::<D>::new(),
        entries: Vec::new(),
        parts: Vec::new(),
        has_exact: root.contains_key("exact"),
    };
    for (key, value) in root.iter() {
        match &**key.get_ref() {
            "coefficient" => {
                let how = (Allowed::Positive, false);
                builder.by_region(
                    ("coefficient", value),
                    how,
                    |p, region, alpha| match region {
                        Some(region) => p.coefficient_in(region, alpha),
                        None => p.coefficient(move |x| alpha.at(x)),
                    },
                )?;
            }
            "source" => {
                let how = (Allowed::Finite, false);
                builder.by_region(("source", value), how, |mut p, region, f| match region {
                    Some(region) => p.source_in(region, f),
                    None => {
                        p.source = Some(f);
                        p
                    }
                })?;
            }
            "reaction" => {
                let how = (Allowed::NotNegative, false);
                builder.by_region(("reaction", value), how, |p, region, c| match region {
                    Some(region) => p.reaction_in(region, c),
                    None => p.reaction(c),
                })?;
            }
            "obstacle" => builder.obstacles(value)?,
            "boundary" => builder.boundary(value)?,
            "exact" => builder.exact(value)?,
            _ => {}
        }
    }
    let geometry = match place {
        Place::File { path, bytes, .. } => {
            Geometry::File { path: path.clone(), bytes: bytes.clone() }
        }
        Place::Box { corners } => {
            let [lower, upper] =
                [0, 1].map(|k| Point::<f64, D>::from_fn(|axis, _| corners[k][axis]));
            let mut domain = BoxDomain::dirichlet(lower, upper);
            for (name, part) in &builder.parts {
                if let Some(side) = SIDES[..2 * D].iter().position(|side| side == name) {
                    domain = domain.side(side / 2, side % 2, *part);
                }
            }
            Geometry::Box(domain)
        }
    };
    let own = OwnProblem { name, problem: builder.problem.clone(), geometry };
    let failed = |error: Error| match (error, place) {
        (Error::Gmsh(source), Place::File { path, .. }) => {
            ProblemFileError::Mesh { path: path.clone(), source: Box::new(source) }
        }
        (error, _) => {
            ProblemFileError::Problem { path: source.path.into(), source: Box::new(error) }
        }
    };
    let mesh = own.sample_mesh().map_err(failed)?;
    builder.check(&mesh)?;
    own.problem.bind_boundary(mesh).map_err(|error| failed(error.into()))?;
    Ok(own)
}

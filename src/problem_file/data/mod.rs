//! The data of a problem file, checked on its mesh.

mod boundary;
mod check;
mod tensor;
mod values;

use toml::de::DeTable;

use super::contents::ProblemFile;
use super::error::{ProblemFileError, ProblemFileErrorKind};
use super::expression::VARIABLES;
use super::formula::Formula;
use super::table::{Place, Source, Value};
use crate::error::Error;
use crate::input::{beginning, fingerprint};
use crate::mesh::{BoundaryCondition, BoxDomain, Domain, Mesh, MeshError, SIDES};
use crate::problem::{Datum, Given, Problem, Tensor};
use crate::real::{Matrix, Point};
use crate::scenes::{AnyScene, Scene};
use check::{Allowed, Checks, DEFAULT, EXACT, Entry, FINITE, NOT_NEGATIVE, POSITIVE};

const KEYS: [&str; 11] = [
    "name",
    "mesh",
    "box",
    "constants",
    "coefficient",
    "source",
    "reaction",
    "obstacle",
    "boundary",
    "exact",
    "values",
];
/// The data that may be given with a level, where they jump.
const PIECEWISE: [&str; 3] = ["coefficient", "source", "reaction"];

/// What a file gives on a boundary group.
#[derive(Clone)]
enum BoundaryDatum {
    Dirichlet(Formula),
    Flux(Formula),
    Robin { coefficient: Formula, value: Formula },
    Friction(Formula),
    Gap(Formula),
}

/// The table of a boundary group.
#[derive(Clone)]
struct OnGroup {
    condition: BoundaryCondition,
    given: BoundaryDatum,
    offset: usize,
    shape: Option<Shape>,
}

/// A formula that is zero on a boundary group, and where the file has it.
type Shape = (Formula, usize);

/// The data that have been read, and what is to be checked.
struct Builder<'s, 't, const D: usize> {
    source: &'s Source<'t>,
    problem: Problem<D>,
    entries: Vec<Entry<D>>,
    conditions: Vec<(String, BoundaryCondition)>,
    /// The data on boundary groups without a table of their own.
    on_other_groups: Option<OnGroup>,
    /// The shapes of boundary groups.
    shapes: Vec<(String, Shape)>,
    /// The gaps on boundary groups.
    gaps: Vec<(String, Formula)>,
    /// Whether the file has the exact solution.
    has_exact: bool,
    /// Where the file has its gradient.
    gradient_offset: usize,
}

type Done<V = ()> = Result<V, ProblemFileError>;

impl<'t, const D: usize> Builder<'_, 't, D> {
    /// Reads a table of data by region; `of` is where the problem has them.
    fn by_region(
        &mut self,
        (name, value): (&'static str, &Value<'t>),
        (allowed, at_vertices): (Allowed, bool),
        of: fn(&mut Problem<D>) -> &mut Given<Datum<D>>,
    ) -> Done {
        let (source, variables) = (self.source, &VARIABLES[0][..D]);
        let table = source.table(name, value)?;
        // of a number and a tensor the one that a cell takes excludes the other: each is given as both
        let is_tensor = |value: &Value<'t>| name == "coefficient" && value.get_ref().is_array();
        let has_tensor = table.values().any(is_tensor);
        for (key, value) in table.iter() {
            let group = &key.get_ref().to_string();
            let offset = if group == DEFAULT { value.span().start } else { key.span().start };
            let entry = |key, offset, allowed, formula: &Formula| {
                let (group, value) = (group.clone(), formula.flux());
                Entry { table: name, group, key, at_vertices, offset, allowed, value }
            };
            if is_tensor(value) {
                let (tensor, value) = tensor::read(source, group, value)?;
                self.problem.tensor.give(group, tensor);
                self.problem.coefficient.give(group, Datum::Constant(1.0));
                let entry =
                    entry(": the least eigenvalue", offset, POSITIVE, &Formula::Number(1.0));
                self.entries.push(Entry { value, ..entry });
                continue;
            }
            let with_level = value.get_ref().as_table().filter(|_| PIECEWISE.contains(&name));
            let (formula, datum) = match with_level {
                None => {
                    let formula = source.formula(group, value, variables)?;
                    let datum = formula.datum();
                    (formula, datum)
                }
                Some(table) => {
                    source.allow(table, &["value", "level"])?;
                    let read = |key: &str, purpose: &str| {
                        let found = table.get(key);
                        let found = found
                            .ok_or_else(|| source.missing(value.span().start, key, purpose))?;
                        Ok((source.formula(key, found, variables)?, found.span().start))
                    };
                    let purpose = "an expression that vanishes where the datum jumps";
                    let ((level, offset), (formula, _)) =
                        (read("level", purpose)?, read("value", "the datum")?);
                    let entry = entry(".level", offset, FINITE, &level);
                    self.entries.push(Entry { at_vertices: true, ..entry });
                    let (of, level) = (formula.datum::<D>(), level.datum::<D>());
                    (formula, Datum::piecewise(move |x| of.at(x), move |x| level.at(x)))
                }
            };
            if has_tensor {
                self.problem.tensor.give(group, Tensor::Constant(Matrix::identity()));
            }
            of(&mut self.problem).give(group, datum);
            self.entries.push(entry("", offset, allowed, &formula));
        }
        Ok(())
    }

    fn obstacles(&mut self, value: &Value<'t>) -> Done {
        let table = self.source.table("obstacle", value)?;
        self.source.allow(table, &["lower", "upper"])?;
        if let Some(value) = table.get("lower") {
            self.by_region(("obstacle.lower", value), (FINITE, true), |p| &mut p.lower)?;
        }
        if let Some(value) = table.get("upper") {
            self.by_region(("obstacle.upper", value), (FINITE, true), |p| &mut p.upper)?;
        }
        Ok(())
    }

    fn exact(&mut self, value: &Value<'t>) -> Done {
        let source = self.source;
        let table = source.table("exact", value)?;
        source.allow(table, &["value", "gradient"])?;
        let needed = |key, purpose| {
            table.get(key).ok_or_else(|| source.missing(value.span().start, key, purpose))
        };
        let expected = "a list with an expression for each coordinate";
        let (solution, gradient) =
            (needed("value", "the exact solution")?, needed("gradient", expected)?);
        let components = gradient.get_ref().as_array().filter(|list| list.len() == D);
        let components =
            components.ok_or_else(|| source.wrong_type("gradient", gradient, expected))?;
        self.gradient_offset = gradient.span().start;
        let mut read = |group: &str, value: &Value<'t>, at_vertices| {
            let formula = source.formula(group, value, &VARIABLES[0][..D])?;
            let (group, offset, value) = (group.to_owned(), value.span().start, formula.flux());
            let (table, key, allowed) = (EXACT, "", FINITE);
            self.entries.push(Entry { table, group, key, at_vertices, offset, allowed, value });
            Ok(formula.datum::<D>())
        };
        let solution = read("value", solution, true)?;
        let components = components.iter().map(|value| read("gradient", value, false));
        let components = components.collect::<Done<Vec<_>>>()?;
        self.problem = std::mem::take(&mut self.problem)
            .exact(move |x| solution.at(x), move |x| Point::from_fn(|k, _| components[k].at(x)));
        Ok(())
    }
}

/// Characters of the name of a problem, at most.
const LONGEST_NAME: usize = 80;

/// The problem of a file, in its dimension.
pub(super) fn problem<'t, const D: usize>(
    source: &Source<'t>,
    root: &DeTable<'t>,
    place: &Place,
    suffix: &str,
) -> Done<ProblemFile>
where
    AnyScene: From<Scene<D>>,
{
    source.allow(root, &KEYS)?;
    let name = match root.get("name") {
        Some(name) => source.string("name", name)?.into(),
        None => source.path.file_stem().unwrap_or_default().to_string_lossy(),
    };
    // it stands in tables, plots and names of files
    let name = beginning(name.as_bytes(), LONGEST_NAME);
    let mut builder = Builder {
        source,
        problem: Problem::<D> {
            constants: source.constants.iter().cloned().collect(),
            ..Problem::new()
        },
        entries: Vec::new(),
        conditions: Vec::new(),
        on_other_groups: None,
        shapes: Vec::new(),
        gaps: Vec::new(),
        has_exact: root.contains_key("exact"),
        gradient_offset: 0,
    };
    let mut wanted = Vec::new();
    let mut fingerprints = vec![("problem", fingerprint(source.text.as_bytes()))];
    let mut paths = vec![source.path.to_owned()];
    let mut warnings = Vec::new();
    // before the data, which may be those of another dimension
    let mut domain: Domain<D> = match place {
        Place::File { path, file, offset } => {
            let read = file.mesh::<D>().map_err(|e| source.mesh_error(*offset, path, e))?;
            fingerprints.push(("mesh", file.fingerprint()));
            paths.push(path.clone());
            warnings.extend(read.warnings.iter().map(|w| format!("{}: {w}", path.display())));
            read.mesh.into()
        }
        Place::Box { corners } => {
            let [lower, upper] = [0, 1].map(|k| Point::<D>::from_fn(|axis, _| corners[k][axis]));
            BoxDomain::dirichlet(lower, upper).into()
        }
    };
    for (key, value) in root.iter() {
        match &**key.get_ref() {
            "coefficient" => {
                let how = (POSITIVE, false);
                builder.by_region(("coefficient", value), how, |p| &mut p.coefficient)?;
            }
            "source" => builder.by_region(("source", value), (FINITE, false), |p| &mut p.source)?,
            "reaction" => {
                let how = (NOT_NEGATIVE, false);
                builder.by_region(("reaction", value), how, |p| &mut p.reaction)?;
            }
            "obstacle" => builder.obstacles(value)?,
            "boundary" => builder.boundary(value)?,
            "exact" => builder.exact(value)?,
            "values" => wanted = values::values(source, value)?,
            _ => {}
        }
    }
    let groups: Vec<Vec<String>> = match &domain {
        Domain::Mesh(mesh) => mesh.boundary_groups().iter().map(|g| g.names.clone()).collect(),
        _ => SIDES[..2 * D].iter().map(|&side| vec![side.to_owned()]).collect(),
    };
    builder.complete(&groups);
    if let Domain::Box(domain) = &mut domain {
        for (name, condition) in &builder.conditions {
            if let Some(side) = SIDES[..2 * D].iter().position(|side| side == name) {
                domain.sides[side / 2][side % 2] = *condition;
            }
        }
    }
    let failed =
        |error: Error| ProblemFileError::of_file(source.path, ProblemFileErrorKind::Problem, error);
    let mesh = sample_mesh(&domain).map_err(|error| failed(error.into()))?;
    let mesh = builder.put_shapes(&domain, mesh)?;
    builder.put_gaps(&mesh)?;
    let Builder { mut problem, entries, conditions, gradient_offset, .. } = builder;
    let exact = problem.exact.as_ref().map(|exact| (exact, gradient_offset));
    Checks { source, entries: &entries, conditions: &conditions, exact }.run(&mesh)?;
    let mesh = problem.bind_boundary(mesh).map_err(|error| failed(error.into()))?;
    values::check(source, (&wanted, &problem), &mesh)?;
    problem.values = wanted.into_iter().map(|(name, value, _)| (name, value)).collect();
    let domain = if domain.is_mesh() { mesh.into() } else { domain };
    let scene = Scene::new(name + suffix, domain, problem).into();
    Ok(ProblemFile { scene, fingerprints, paths, warnings })
}

/// A mesh to hold the data against, of a box one with few cells, whatever its sides.
fn sample_mesh<const D: usize>(domain: &Domain<D>) -> Result<Mesh<D>, MeshError> {
    match domain {
        Domain::Box(domain) => Mesh::kuhn_box(domain, domain.counts(4).map(|n| n.min(64))),
        other => other.mesh(0),
    }
}

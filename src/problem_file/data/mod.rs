//! The data of a problem file, checked on its mesh.

mod check;
mod tensor;
mod values;

use toml::de::DeTable;

use super::contents::ProblemFile;
use super::error::{ProblemFileError, ProblemFileErrorKind};
use super::expression::VARIABLES;
use super::table::{Formula, Place, Source, Value};
use crate::arrays::array_of;
use crate::error::Error;
use crate::input::{beginning, fingerprint};
use crate::mesh::{BoundaryCondition, BoundaryFacet, BoxDomain, Domain, Mesh, MeshError, SIDES};
use crate::problem::{Datum, Given, Problem, Robin, Tensor};
use crate::real::{Matrix, Point};
use crate::scenes::{AnyScene, Scene};
use check::{Allowed, Checks, Entry};

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
/// The group of cells in no group with data.
const DEFAULT: &str = "default";
/// The data that may be given with a level, where they jump.
const PIECEWISE: [&str; 3] = ["coefficient", "source", "reaction"];

/// A number or expression as a datum that may jump where the level vanishes.
fn piecewise<const D: usize>(formula: &Formula, level: Option<&Formula>) -> Datum<D> {
    let value = formula.datum::<D>();
    match level.map(Formula::datum::<D>) {
        None => value,
        Some(level) => Datum::piecewise(move |x| value.at(x), move |x| level.at(x)),
    }
}

/// The data that have been read, and what is to be checked.
struct Builder<'s, 't, const D: usize> {
    source: &'s Source<'t>,
    problem: Problem<D>,
    entries: Vec<Entry<D>>,
    conditions: Vec<(String, BoundaryCondition)>,
    /// The data on boundary groups without a table of their own.
    on_other_groups: Option<OnGroup>,
    /// The shapes of boundary groups, and where the file has them.
    shapes: Vec<(String, Shape)>,
    /// The gaps of the problem, in their order.
    gaps: Vec<Formula>,
    /// Whether the file has the exact solution.
    has_exact: bool,
    /// Where the file has its gradient.
    gradient_offset: usize,
}

/// The data of a file on a boundary group.
struct OnGroup {
    condition: BoundaryCondition,
    formula: Formula,
    /// The coefficient of a Robin side.
    coefficient: Option<Formula>,
    /// Whether the formula is a threshold of friction.
    has_friction: bool,
    /// Its name in the file.
    datum: String,
    offset: usize,
    shape: Option<Shape>,
}

/// A formula that is zero on a boundary group, and where the file has it.
type Shape = (Formula, usize);

type Done<V = ()> = Result<V, ProblemFileError>;

impl<'t, const D: usize> Builder<'_, 't, D> {
    /// Reads a table of data by region; `of` is where the problem has them.
    fn by_region(
        &mut self,
        (name, value): (&str, &Value<'t>),
        (allowed, at_vertices): (Allowed, bool),
        of: fn(&mut Problem<D>) -> &mut Given<Datum<D>>,
    ) -> Done {
        let table = self.source.table(name, value)?;
        let groups: Vec<String> = table.keys().map(|key| key.get_ref().to_string()).collect();
        // of a number and a tensor the one that a cell takes excludes the other: each is given as both
        let is_tensor = |value: &Value<'t>| name == "coefficient" && value.get_ref().is_array();
        let has_tensor = table.values().any(is_tensor);
        for (key, value) in table.iter() {
            let group = key.get_ref().to_string();
            let region = (group != DEFAULT).then_some(&group[..]);
            if is_tensor(value) {
                let offset = if region.is_some() { key.span().start } else { value.span().start };
                let (tensor, entry) =
                    tensor::read(self.source, ((&group, region), offset, value), &groups)?;
                self.problem.tensor.give(region, tensor);
                self.problem.coefficient.give(region, Datum::Constant(1.0));
                self.entries.push(entry);
                continue;
            }
            let variables = &VARIABLES[0][..D];
            let with_level = value.get_ref().as_table().filter(|_| PIECEWISE.contains(&name));
            let (formula, level) = match with_level {
                None => (self.source.formula(&group, value, variables)?, None),
                Some(table) => {
                    self.source.allow(table, &["value", "level"])?;
                    let entry = |key: &str, purpose: &str| {
                        let missing = || self.source.missing(value.span().start, key, purpose);
                        let found = table.get(key).ok_or_else(missing)?;
                        Ok((self.source.formula(key, found, variables)?, found.span().start))
                    };
                    let level =
                        entry("level", "an expression that vanishes where the datum jumps")?;
                    (entry("value", "the datum")?.0, Some(level))
                }
            };
            if has_tensor {
                self.problem.tensor.give(region, Tensor::Constant(Matrix::identity()));
            }
            let given = piecewise(&formula, level.as_ref().map(|(level, _)| level));
            of(&mut self.problem).give(region, given);
            let entry = |what: &str, offset, (allowed, at_vertices), formula: &Formula| Entry {
                datum: format!("{name}.{group}{what}"),
                group: region.map(str::to_owned),
                is_boundary: false,
                others: groups.clone(),
                at_vertices,
                offset,
                allowed,
                value: formula.flux(),
            };
            if let Some((level, offset)) = &level {
                self.entries.push(entry(".level", *offset, (Allowed::Finite, true), level));
            }
            let offset = if region.is_some() { key.span().start } else { value.span().start };
            self.entries.push(entry("", offset, (allowed, at_vertices), &formula));
        }
        Ok(())
    }

    fn obstacles(&mut self, value: &Value<'t>) -> Done {
        let table = self.source.table("obstacle", value)?;
        self.source.allow(table, &["lower", "upper"])?;
        let how = (Allowed::Finite, true);
        if let Some(value) = table.get("lower") {
            self.by_region(("obstacle.lower", value), how, |p| &mut p.lower)?;
        }
        if let Some(value) = table.get("upper") {
            self.by_region(("obstacle.upper", value), how, |p| &mut p.upper)?;
        }
        Ok(())
    }

    fn boundary(&mut self, value: &Value<'t>) -> Done {
        let boundary = self.source.table("boundary", value)?;
        for (key, value) in boundary.iter() {
            let group = key.get_ref().to_string();
            let given = self.on_group(&group, key.span().start, value)?;
            match group == DEFAULT {
                true => self.on_other_groups = Some(given),
                false => self.put_on(&group, &given),
            }
        }
        Ok(())
    }

    /// Reads the table of a boundary group.
    fn on_group(&self, group: &str, offset: usize, value: &Value<'t>) -> Done<OnGroup> {
        let table = self.source.table(group, value)?;
        let kinds = "\"dirichlet\", \"neumann\", \"robin\", \"friction\" or \"contact\"";
        let Some(kind) = table.get("kind") else {
            return Err(self.source.missing(offset, "kind", kinds));
        };
        let kind_name = self.source.string("kind", kind)?;
        let (is_robin, has_friction) = (kind_name == "robin", kind_name == "friction");
        let condition = match is_robin || has_friction {
            true => BoundaryCondition::Neumann,
            false => BoundaryCondition::from_name(kind_name)
                .ok_or_else(|| self.source.wrong_type("kind", kind, kinds))?,
        };
        if BoundaryCondition::from_name(group).is_some_and(|named| named != condition) {
            let expected =
                "what the name of the group says: dirichlet, neumann and contact fix their kind";
            return Err(self.source.wrong_type("kind", kind, expected));
        }
        let (name, takes_normal) = match condition {
            BoundaryCondition::Dirichlet => ("value", false),
            BoundaryCondition::Neumann if is_robin => ("value", false),
            BoundaryCondition::Neumann if has_friction => ("threshold", false),
            BoundaryCondition::Neumann => ("flux", true),
            BoundaryCondition::Contact => ("gap", true),
        };
        let of_robin: &[&str] = if is_robin { &["coefficient"] } else { &[] };
        self.source.allow(table, &[&["kind", name, "shape"], of_robin].concat())?;
        let variables = match takes_normal {
            true => [&VARIABLES[0][..D], &VARIABLES[1][..D]].concat(),
            false => VARIABLES[0][..D].to_vec(),
        };
        let formula = match table.get(name) {
            Some(value) => self.source.formula(name, value, &variables)?,
            None if has_friction => {
                let purpose = "the largest flux of friction, not negative";
                return Err(self.source.missing(offset, name, purpose));
            }
            None if self.has_exact && condition != BoundaryCondition::Contact => {
                let purpose = "the exact solution does not stand for data that are left out";
                return Err(self.source.missing(offset, name, purpose));
            }
            None => Formula::Number(0.0),
        };
        let coefficient = match (is_robin, table.get("coefficient")) {
            (false, _) => None,
            (true, Some(value)) => Some(self.source.formula("coefficient", value, &variables)?),
            (true, None) => {
                let purpose = "`k` of alpha du/dn + k (u - value) = 0, not negative";
                return Err(self.source.missing(offset, "coefficient", purpose));
            }
        };
        let shape = table.get("shape").map(|value| {
            Ok((self.source.formula("shape", value, &VARIABLES[0][..D])?, value.span().start))
        });
        let (datum, shape) = (format!("boundary.{group}.{name}"), shape.transpose()?);
        Ok(OnGroup { condition, formula, coefficient, has_friction, datum, offset, shape })
    }

    /// Puts what is given on a boundary group into the problem.
    fn put_on(&mut self, group: &str, given: &OnGroup) {
        let OnGroup { condition, formula, coefficient, datum, offset, shape, .. } = given;
        self.shapes.extend(shape.clone().map(|shape| (group.to_owned(), shape)));
        let (problem, name) = (&mut self.problem, Some(group));
        match condition {
            BoundaryCondition::Dirichlet => problem.dirichlet.give(name, formula.datum()),
            BoundaryCondition::Neumann => match coefficient {
                Some(k) => problem.robin.give(name, Robin::new(k.datum(), formula.datum())),
                None if given.has_friction => problem.friction.give(name, formula.datum()),
                None => problem.neumann.give(name, formula.flux()),
            },
            BoundaryCondition::Contact => {
                self.gaps.push(formula.clone());
                problem.gap.give(name, formula.datum());
            }
        }
        let entry = |datum: &str, allowed, formula: &Formula| Entry {
            datum: datum.to_owned(),
            group: Some(group.to_owned()),
            is_boundary: true,
            others: Vec::new(),
            at_vertices: *condition != BoundaryCondition::Neumann,
            offset: *offset,
            allowed,
            value: formula.flux(),
        };
        let allowed = if given.has_friction { Allowed::NotNegative } else { Allowed::Finite };
        self.entries.push(entry(datum, allowed, formula));
        if let Some(coefficient) = coefficient {
            let of_group = datum.rsplit_once('.').map_or("boundary", |(of_group, _)| of_group);
            let datum = format!("{of_group}.coefficient");
            self.entries.push(entry(&datum, Allowed::NotNegative, coefficient));
        }
        self.conditions.push((group.to_owned(), *condition));
    }

    /// Puts what is given by default on the boundary groups without a table of their own, by a name that no group with a
    /// table has; where there is none, by one that also has facets of such groups, which come first. A group whose name
    /// fixes another kind is left without data.
    fn complete(&mut self, groups: &[Vec<String>]) {
        let Some(given) = self.on_other_groups.take() else { return };
        let named = self.conditions.clone();
        let has_table = |names: &Vec<String>| named.iter().any(|(group, _)| names.contains(group));
        let (with_table, without): (Vec<_>, Vec<_>) = groups.iter().partition(|g| has_table(g));
        for names in without {
            let fits = |name: &&String| {
                BoundaryCondition::from_name(name).is_none_or(|own| own == given.condition)
            };
            let is_own = |name: &&String| !with_table.iter().any(|group| group.contains(name));
            let own = names.iter().filter(fits).find(is_own);
            if let Some(name) = own.or_else(|| names.iter().find(fits))
                && self.conditions.iter().all(|(known, _)| known != name)
            {
                self.put_on(name, &given);
            }
        }
    }

    /// Gives the mesh the shapes of its boundary groups.
    fn put_shapes(&self, domain: &Domain<D>, mut mesh: Mesh<D>) -> Done<Mesh<D>> {
        for (group, (formula, offset)) in &self.shapes {
            let kind = ProblemFileErrorKind::Shape;
            if !domain.is_mesh() {
                let message = format!(
                    "boundary.{group}.shape: the sides of a box are flat; a curved boundary needs a mesh"
                );
                return Err(self.source.error(*offset, kind, message));
            }
            // names that the mesh does not have are found with those of other data
            if mesh.boundary_groups().iter().any(|g| g.names.contains(group)) {
                let shape = formula.datum::<D>();
                let shaped = mesh.with_shape(group, move |x| shape.at(x));
                mesh = shaped.map_err(|e| self.source.error(*offset, kind, e.to_string()))?;
            }
        }
        Ok(mesh)
    }

    /// Gives gaps that depend on the normal those of the shapes or of the facets of their groups.
    fn put_normals(&mut self, mesh: &Mesh<D>) -> Done {
        for ((group, datum), formula) in self.problem.gap.named.iter_mut().zip(&self.gaps) {
            let groups = mesh.boundary_groups();
            let is_meant = |f: &&BoundaryFacet| groups[usize::from(f.group)].names.contains(group);
            let facets = mesh.boundary().iter().filter(is_meant).map(|f| {
                let (cell, local) = (f.cell as usize, usize::from(f.local));
                let vertices: Vec<u32> = mesh.facet_vertices(cell, local).collect();
                let corners = array_of(|k| mesh.vertices()[vertices[k] as usize]);
                (corners, mesh.geometry(cell).normal(local))
            });
            let (facets, length) = (facets.collect(), mesh.mesh_size());
            *datum = match self.shapes.iter().find(|(name, _)| name == group) {
                Some((_, (shape, offset))) => {
                    formula.datum_along(shape, length, facets).ok_or_else(|| {
                        let message = format!(
                            "boundary.{group}.shape: facets of the group lie on both sides of it, where a gap has two normals; give each side a group of its own"
                        );
                        self.source.error(*offset, ProblemFileErrorKind::Shape, message)
                    })?
                }
                None => formula.datum_on(facets),
            };
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
        let (solution, gradient) = (
            needed("value", "the exact solution")?,
            needed("gradient", "a list with an expression for each coordinate")?,
        );
        let offset = solution.span().start;
        let solution = source.formula("value", solution, &VARIABLES[0][..D])?;
        self.entries.push(Entry::of_exact("value", &solution, offset));
        let solution = solution.datum::<D>();
        let expected = "a list with an expression for each coordinate";
        let components = gradient.get_ref().as_array().filter(|list| list.len() == D);
        let components =
            components.ok_or_else(|| source.wrong_type("gradient", gradient, expected))?;
        self.gradient_offset = gradient.span().start;
        let mut component = |value: &Value<'t>| {
            let formula = source.formula("gradient", value, &VARIABLES[0][..D])?;
            let entry = Entry::of_exact("gradient", &formula, value.span().start);
            self.entries.push(Entry { at_vertices: false, ..entry });
            Ok(formula.datum::<D>())
        };
        let components = components.iter().map(&mut component).collect::<Done<Vec<_>>>()?;
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
                let how = (Allowed::Positive, false);
                builder.by_region(("coefficient", value), how, |p| &mut p.coefficient)?;
            }
            "source" => {
                let how = (Allowed::Finite, false);
                builder.by_region(("source", value), how, |p| &mut p.source)?;
            }
            "reaction" => {
                let how = (Allowed::NotNegative, false);
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
    builder.put_normals(&mesh)?;
    let Builder { mut problem, entries, conditions, gradient_offset, .. } = builder;
    Checks {
        source,
        problem: &problem,
        entries: &entries,
        conditions: &conditions,
        gradient_offset,
    }
    .run(&mesh)?;
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

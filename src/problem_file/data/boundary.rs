//! The data of a problem file on boundary groups.

use super::check::{BOUNDARY, DEFAULT, Entry, FINITE, NOT_NEGATIVE};
use super::{BoundaryDatum, Builder, Done, OnGroup};
use crate::mesh::{BoundaryCondition, Domain, HalfFacet, Mesh};
use crate::problem::Robin;
use crate::problem_file::error::ProblemFileErrorKind;
use crate::problem_file::expression::VARIABLES;
use crate::problem_file::formula::Formula;
use crate::problem_file::table::Value;

/// The kinds of boundary groups.
const KINDS: &str = "\"dirichlet\", \"neumann\", \"robin\", \"friction\" or \"contact\"";

impl<'t, const D: usize> Builder<'_, 't, D> {
    /// Reads the tables of boundary groups.
    pub fn boundary(&mut self, value: &Value<'t>) -> Done {
        for (key, value) in self.source.table(BOUNDARY, value)?.iter() {
            let group = key.get_ref().to_string();
            let given = self.on_group(&group, key.span().start, value)?;
            match group == DEFAULT {
                true => self.on_other_groups = Some(given),
                false => self.put_on(&group, given),
            }
        }
        Ok(())
    }

    fn on_group(&self, group: &str, offset: usize, value: &Value<'t>) -> Done<OnGroup> {
        use BoundaryCondition::{Contact, Dirichlet, Neumann};
        let table = self.source.table(group, value)?;
        let kind = table.get("kind").ok_or_else(|| self.source.missing(offset, "kind", KINDS))?;
        let kind_name = self.source.string("kind", kind)?;
        let (condition, key, more): (_, _, &[&str]) = match kind_name {
            "dirichlet" => (Dirichlet, "value", &[]),
            "neumann" => (Neumann, "flux", &[]),
            "robin" => (Neumann, "value", &["coefficient"]),
            "friction" => (Neumann, "threshold", &[]),
            "contact" => (Contact, "gap", &[]),
            _ => return Err(self.source.wrong_type("kind", kind, KINDS)),
        };
        if BoundaryCondition::from_name(group).is_some_and(|named| named != condition) {
            let expected =
                "what the name of the group says: dirichlet, neumann and contact fix their kind";
            return Err(self.source.wrong_type("kind", kind, expected));
        }
        self.source.allow(table, &[&["kind", key, "shape"], more].concat())?;
        let coordinates = &VARIABLES[0][..D];
        let with_normal = [coordinates, &VARIABLES[1][..D]].concat();
        let variables = if ["flux", "gap"].contains(&key) { &with_normal } else { coordinates };
        let read = |key: &str, needed: Option<&str>| match (table.get(key), needed) {
            (Some(value), _) => self.source.formula(key, value, variables),
            (None, Some(purpose)) => Err(self.source.missing(offset, key, purpose)),
            (None, None) => Ok(Formula::Number(0.0)),
        };
        let needed = match kind_name {
            "friction" => Some("the largest flux of friction, not negative"),
            "contact" => None,
            _ => self
                .has_exact
                .then_some("the exact solution does not stand for data that are left out"),
        };
        let formula = read(key, needed)?;
        let given = match kind_name {
            "dirichlet" => BoundaryDatum::Dirichlet(formula),
            "neumann" => BoundaryDatum::Flux(formula),
            "robin" => {
                let purpose = "`k` of alpha du/dn + k (u - value) = 0, not negative";
                BoundaryDatum::Robin {
                    coefficient: read("coefficient", Some(purpose))?,
                    value: formula,
                }
            }
            "friction" => BoundaryDatum::Friction(formula),
            _ => BoundaryDatum::Gap(formula),
        };
        let shape = table.get("shape").map(|value| {
            Ok((self.source.formula("shape", value, coordinates)?, value.span().start))
        });
        Ok(OnGroup { condition, given, offset, shape: shape.transpose()? })
    }

    /// Puts what is given on a boundary group into the problem.
    fn put_on(&mut self, group: &str, OnGroup { condition, given, offset, shape }: OnGroup) {
        self.shapes.extend(shape.map(|shape| (group.to_owned(), shape)));
        self.conditions.push((group.to_owned(), condition));
        let mut enter = |key, allowed, formula: &Formula| {
            let group = group.to_owned();
            let at_vertices = condition != BoundaryCondition::Neumann;
            let value = formula.flux();
            let table = BOUNDARY;
            self.entries.push(Entry { table, group, key, at_vertices, offset, allowed, value });
        };
        let problem = &mut self.problem;
        match given {
            BoundaryDatum::Dirichlet(value) => {
                enter(".value", FINITE, &value);
                problem.dirichlet.give(group, value.datum());
            }
            BoundaryDatum::Flux(flux) => {
                enter(".flux", FINITE, &flux);
                problem.neumann.give(group, flux.flux());
            }
            BoundaryDatum::Robin { coefficient, value } => {
                enter(".value", FINITE, &value);
                enter(".coefficient", NOT_NEGATIVE, &coefficient);
                problem.robin.give(group, Robin::new(coefficient.datum(), value.datum()));
            }
            BoundaryDatum::Friction(threshold) => {
                enter(".threshold", NOT_NEGATIVE, &threshold);
                problem.friction.give(group, threshold.datum());
            }
            BoundaryDatum::Gap(gap) => {
                enter(".gap", FINITE, &gap);
                self.gaps.push((group.to_owned(), gap));
            }
        }
    }

    /// Puts what is given by default on the boundary groups without a table of their own, by a name that no group with a
    /// table has; where there is none, by one that also has facets of such groups, which come first. A group whose name
    /// fixes another kind is left without data.
    pub fn complete(&mut self, groups: &[Vec<String>]) {
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
                self.put_on(name, given.clone());
            }
        }
    }

    /// Gives the mesh the shapes of its boundary groups.
    pub fn put_shapes(&self, domain: &Domain<D>, mut mesh: Mesh<D>) -> Done<Mesh<D>> {
        for (group, (formula, offset)) in &self.shapes {
            let kind = ProblemFileErrorKind::Mesh;
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

    /// Gives the problem its gaps, which may depend on the normal of the shapes or of the facets of their groups.
    pub fn put_gaps(&mut self, mesh: &Mesh<D>) -> Done {
        for (group, formula) in &self.gaps {
            let groups = mesh.boundary_groups();
            let facets = mesh.boundary().iter();
            let facets = facets.filter(|f| groups[usize::from(f.group)].names.contains(group));
            let facets: Vec<HalfFacet> =
                facets.map(|f| (f.cell as usize, usize::from(f.local))).collect();
            let shape = self.shapes.iter().find(|(name, _)| name == group);
            let shape = shape.map(|(_, shape)| shape);
            let datum = formula.datum_on(mesh, facets, shape.map(|(shape, _)| shape));
            let datum = datum.ok_or_else(|| {
                let message = format!(
                    "boundary.{group}.shape: facets of the group lie on both sides of it, where a gap has two normals; give each side a group of its own"
                );
                let offset = shape.map_or(0, |(_, offset)| *offset);
                self.source.error(offset, ProblemFileErrorKind::Mesh, message)
            })?;
            self.problem.gap.give(group, datum);
        }
        Ok(())
    }
}

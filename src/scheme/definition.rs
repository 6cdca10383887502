//! What a scheme is, and what follows from it.

use std::sync::Arc;

use super::{ExpectedOrders, SchemeOptions, Setting};
use crate::algebra::Inequality;
use crate::assemble::{DataQuadrature, Discretisation};
use crate::constraint::{ConstraintSet, Nodes, in_basis_of};
use crate::element::{Element, Layout, Node};
use crate::error::Error;
use crate::facet::{DirichletBy, FacetForm, NoFacets, PenaltyParameters};
use crate::instances::compiled;
use crate::mesh::{Layers, Mesh};
use crate::problem::{BodyConstants, Problem};

/// A discretisation of the bilinear form and of Dirichlet data: a name, an element, a form on facets and
/// a way to impose Dirichlet data.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a scheme on {D}-simplices",
    note = "a scheme is an element, a facet form and a way to impose Dirichlet data: implement `Scheme<{D}>`, see examples/my_scheme.rs"
)]
pub trait Scheme<const D: usize>: Send + Sync {
    /// The name users type and reports state. Two schemes of a study must differ in it or in their
    /// [choices](Self::choices): a scheme with parameters puts them into one of the two.
    fn name(&self) -> &str;
    /// The finite element.
    fn element(&self) -> Arc<dyn Element<D>>;
    /// The form on facets of a mesh, its parameters resolved; by default there is none.
    fn form(&self, mesh: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        let _ = mesh;
        Box::new(NoFacets)
    }
    /// How Dirichlet data are imposed: by default by the facet form if the element is broken, else by
    /// pinning unknowns.
    fn dirichlet(&self) -> DirichletBy {
        match self.element().layout().is_broken() {
            true => DirichletBy::FacetForm,
            false => DirichletBy::Pinning,
        }
    }
    /// Whether the exact solution satisfies the discrete equations, so that polynomials of the
    /// element's degree are reproduced; [`crate::kit`] holds a scheme to it either way.
    fn is_consistent(&self) -> bool {
        true
    }
    /// What distinguishes the scheme from the default one of its name, for its label in reports; nothing
    /// by default.
    fn choices(&self) -> SchemeOptions {
        SchemeOptions::default()
    }
    /// Orders that theory proves in this setting, with bounds at all nodes; none by default.
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        let _ = setting;
        ExpectedOrders::default()
    }
}

impl<const D: usize> dyn Scheme<D> + '_ {
    /// Largest degree of which its element contains all polynomials.
    pub fn degree(&self) -> usize {
        self.element().degree()
    }
    /// The numbers of unknowns at each vertex, edge, facet and cell.
    pub fn layout(&self) -> Layout {
        self.element().layout()
    }
    /// The nodes of its element, in the basis that a constraint set needs.
    fn nodes_for(&self, set: &dyn ConstraintSet) -> Vec<Node> {
        in_basis_of(set, self.element()).nodes()
    }
    /// The scheme applied to a problem on a mesh.
    ///
    /// # Errors
    /// Those of [`Discretisation::new`].
    pub fn discretise<'a>(
        &self,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Discretisation<'a, D>, Error> {
        Discretisation::new(self, problem, mesh, quadrature)
    }
    /// Whether its unknowns are those of conforming P1, so that it starts from a coarser level and
    /// not from P1 on the same level.
    pub fn is_conforming_linear(&self, mesh: &Mesh<D>) -> bool {
        let layout = self.layout();
        layout.vertex == 1
            && layout.edge + layout.facet + layout.cell == 0
            && !self.form(mesh).couples()
    }
    /// The name that reports state of a constraint set on its element; none if the set binds no
    /// unknown of it.
    pub fn constraint_on(&self, set: &dyn ConstraintSet) -> Option<String> {
        let nodes = self.nodes_for(set);
        let binds = nodes.iter().any(|node| set.in_domain(node, D).is_some());
        binds.then(|| set.name_on(&nodes).to_owned())
    }
    /// The label in tables, legends, files and rows: name, constraint set and choices without what is
    /// default, as [`NamedScheme`](super::NamedScheme) reads it.
    pub fn label_on(&self, set: &dyn ConstraintSet) -> String {
        let (placement, own) = (self.constraint_on(set), self.constraint_on(&Nodes));
        let mut label = self.name().to_owned();
        if let Some(placement) = placement.filter(|placement| Some(placement) != own.as_ref()) {
            label += &format!(":{placement}");
        }
        let choices = self.choices().to_string();
        if choices.is_empty() { label } else { format!("{label}@{choices}") }
    }
    /// Orders that theory proves in this setting with this constraint set: those with bounds at all
    /// nodes, if the set binds the same, or if it [keeps](ConstraintSet::keeps_orders) them.
    pub fn expected_orders_on(&self, set: &dyn ConstraintSet, setting: &Setting) -> ExpectedOrders {
        let bound_by = |set: &dyn ConstraintSet| -> Vec<_> {
            let nodes = self.nodes_for(set);
            nodes.iter().map(|n| (set.in_domain(n, D), set.on_contact(n, D))).collect()
        };
        let own = self.nodes_for(&Nodes);
        if set.keeps_orders(setting)
            || own == self.nodes_for(set) && bound_by(set) == bound_by(&Nodes)
        {
            self.expected_orders(setting)
        } else {
            ExpectedOrders::default()
        }
    }
    /// How many layers of other cells a [part](crate::mesh::Part) of a mesh must have, so that the rows of the
    /// unknowns of its own cells, their load, bounds and residual are those on the whole mesh, bit for bit.
    ///
    /// *Broken elements.* A form on facets couples a cell with its neighbours: one layer across facets.
    /// Products of lifts couple it with the neighbours of these as well: two. *Elements that share
    /// unknowns.* A row belongs to the cells around a vertex: one layer across vertices, and a second one if
    /// a form on facets couples these cells with others. Unknowns on facets are numbered after
    /// the kind of facet, and a row lists its columns, whose products are added up, by number: no
    /// facet of a cell that a row sees may be cut. This takes a second layer for elements that have
    /// unknowns at vertices as well, and one more in one dimension, where the facets of a cell
    /// have no vertex in common.
    pub fn layers(&self, mesh: &Mesh<D>) -> Layers {
        let (layout, form) = (self.layout(), self.form(mesh));
        let (couples, on_facets) = (form.couples(), layout.facet > 0);
        match layout.is_broken() {
            true if form.is_lifted() => Layers::across_facets(2),
            true => Layers::across_facets(usize::from(couples)),
            false if D == 1 => {
                Layers::across_vertices(1 + usize::from(couples) + usize::from(on_facets))
            }
            false if couples || on_facets && layout.vertex > 0 => Layers::across_vertices(2),
            false => Layers::across_vertices(1),
        }
    }
    /// Penalty factors in force on a mesh.
    pub fn parameters(&self, mesh: &Mesh<D>) -> PenaltyParameters {
        self.form(mesh).theory().parameters
    }
    /// The algebraic inequality alone, for other solvers and exporters.
    ///
    /// # Errors
    /// Those of assembly.
    pub fn inequality(
        &self,
        problem: &Problem<D>,
        mesh: &Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Inequality<f64>, Error> {
        self.discretise(problem, mesh, quadrature)?.inequality()
    }
}

impl<'a, const D: usize> Discretisation<'a, D> {
    /// Joins scheme, problem and mesh, in the basis that the problem's constraint set needs; builds
    /// facets only if the scheme needs them.
    ///
    /// # Errors
    /// [`Error::CoefficientNotPositive`], [`Error::NothingToBound`], [`Error::UnsupportedForm`], [`Error::Quadrature`],
    /// [`Error::DataNotFinite`], those of names that the mesh does not have or a problem gives twice, and
    /// [`Error::Parameter`] for a penalty factor that makes no penalty, and for a matrix with too many entries.
    pub fn new(
        scheme: &dyn Scheme<D>,
        problem: &'a Problem<D>,
        mesh: &'a Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        compiled!(const D: for<'p> fn(
                &dyn Scheme<D>,
                &'p Problem<D>,
                &'p Mesh<D>,
                DataQuadrature,
            ) -> Result<Discretisation<'p, D>, Error>
                = |scheme, problem, mesh, quadrature| {
                    let constants = Arc::new(BodyConstants::of(problem, mesh)?);
                    Discretisation::with_constants(scheme, (problem, constants), mesh, quadrature)
                }
        )(scheme, problem, mesh, quadrature)
    }
    /// As [`Discretisation::new`], with known constants of bodies.
    pub(crate) fn with_constants(
        scheme: &dyn Scheme<D>,
        data: (&'a Problem<D>, Arc<BodyConstants>),
        mesh: &'a Mesh<D>,
        quadrature: DataQuadrature,
    ) -> Result<Self, Error> {
        let values = (scheme.element(), scheme.form(mesh), scheme.dirichlet());
        Discretisation::of(values, data, mesh, quadrature)
    }
}

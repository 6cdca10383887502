//! The discrete space on a mesh: all that does not depend on the facet form.
//!
//! Nothing here is generic in scheme or element, so that all is compiled once for each dimension.
//!
//! | file | content |
//! |---|---|
//! | `mod` | the space: rules, unknowns, nodes, points of cells and facets |
//! | `tables` | basis functions and their derivatives at the points of a rule, moments on facets |
//! | `metric` | the geometry of cells as forms need it |
//! | `dofs` | the numbers of the unknowns of a cell |
//! | `form_facets` | the facets that carry the facet form, and their cells |
//! | `checks` | data that must be finite, coefficients that must be positive |
//! | `coefficient` | a coefficient that varies in cells, and the products that it weighs |
//! | `diffusion` | the coefficient in a cell, on a facet and in a flux |
//! | `coefficient/tensor` | its tensor, as a change of coordinates |
//! | `reaction_term` | the reaction term of the matrix |
//! | `friction` | the kinks of unknowns on the boundary with friction |
//! | `bounds`, `contradictions` | the bounds of the unknowns; lower bounds above upper ones |
//! | `obstacle_coefficients` | the Bernstein coefficients of obstacles and gaps, beside jumps too |
//! | `active_obstacles` | where obstacles give the bound that is active |
//! | `locations`, `node_vertices` | the locations of unknowns, by the vertices that stand for a node |

pub(crate) mod active_obstacles;
mod bounds;
pub(crate) mod checks;
pub(crate) mod coefficient;
pub(crate) mod contradictions;
mod diffusion;
pub(crate) mod dofs;
pub(crate) mod form_facets;
mod friction;
mod locations;
pub(crate) mod metric;
mod node_vertices;
pub(crate) mod obstacle_coefficients;
pub(crate) mod reaction_term;
pub(crate) mod tables;

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use super::DataQuadrature;
use super::stiffness::StiffnessTable;
use crate::constraint::{BoundBy, in_basis_of, offered};
use crate::element::{Element, Entity, MAX_BASIS, Node};
use crate::error::Error;
use crate::mesh::{BoundaryCondition, BoundaryFacet, HalfFacet, Mesh, Neighbours};
use crate::parallel::cells;
use crate::problem::{BodyConstants, DataOnMesh, Datum, DiscreteFunction, Problem};
use crate::quadrature::{Quadrature, QuadratureError, Rule, facet_to_cell, vertex_point};
use crate::real::Point;
pub(crate) use coefficient::INWARD;
use coefficient::VaryingCoefficient;
use coefficient::tensor::TensorCoefficient;
use dofs::Dofs;
use metric::CellMetric;
use node_vertices::NodeVertices;
use reaction_term::ReactionTerm;
use tables::{BasisAt, CellTable, FacetTable};

/// A functional as barycentric points with weights.
pub(crate) type Terms = Vec<([f64; 4], f64)>;

/// A finite element space with the problem posed on it.
pub(crate) struct Space<'a, const D: usize> {
    pub problem: &'a Problem<D>,
    pub mesh: &'a Mesh<D>,
    /// What was taken off the data.
    pub body_constants: Arc<BodyConstants>,
    /// The data of the problem less the constants of bodies, by region and boundary group.
    pub data: DataOnMesh<D>,
    /// The rule for data on cells.
    pub cell_rule: Rule,
    /// Its degree.
    pub cell_degree: usize,
    /// The rule for data on facets.
    pub facet_rule: Rule,
    pub reaction: Option<ReactionTerm<D>>,
    pub neighbours: Option<Neighbours>,
    pub dofs: Dofs<'a>,
    /// The coefficient at the barycentre of each cell.
    coefficients: Option<Vec<f64>>,
    /// The tensor of the coefficient.
    tensor: Option<TensorCoefficient<D>>,
    /// The coefficient in the cells in which it varies, for elements of degree two and more.
    varying: Option<VaryingCoefficient>,
    /// The functional whose value each unknown of a cell is.
    pub nodes: Vec<Node>,
    /// The vertices that stand for each of a cell's nodes.
    node_vertices: Vec<NodeVertices>,
    /// Largest degree of which the element contains all polynomials.
    pub degree: usize,
    /// Largest degree of a basis function.
    pub basis_degree: usize,
    /// Whether cells share no unknowns.
    pub broken: bool,
    /// Whether Dirichlet data are pinned; else the facet form imposes them.
    pub pins: bool,
    /// By what obstacles bind each of a cell's unknowns, if they do.
    in_domain: Vec<Option<BoundBy>>,
    /// By what a Signorini condition binds each of a cell's unknowns, if it does and the node lies on
    /// a contact facet.
    on_contact: Vec<Option<BoundBy>>,
    element: Arc<dyn Element<D>>,
    /// Integrals of the load by cell, once computed.
    pub load_by_cell: OnceLock<Vec<f64>>,
}

impl<'a, const D: usize> Space<'a, D> {
    /// The space of an element, in the basis that the problem's constraint set needs; facets are built
    /// only if asked for or numbered.
    pub fn new(
        own: Arc<dyn Element<D>>,
        (problem, body_constants): (&'a Problem<D>, Arc<BodyConstants>),
        mesh: &'a Mesh<D>,
        quadrature: DataQuadrature,
        with_facets: bool,
        pins: bool,
    ) -> Result<Self, Error> {
        let set = problem.constraint_set();
        let element = in_basis_of(set, own.clone());
        let (degree, basis_degree) = (element.degree(), element.basis_degree());
        let (layout, nodes) = (element.layout(), element.nodes());
        let data = DataOnMesh::new(problem, mesh)?.less(&body_constants, mesh);
        let neighbours = (with_facets || layout.facet > 0).then(|| Neighbours::new(mesh));
        let dofs = Dofs::new(layout, mesh, neighbours.as_ref());
        let sum = degree + basis_degree;
        let cell_degree = quadrature.cell.unwrap_or(sum + 3).max(sum.saturating_sub(1));
        // products of discrete functions with the basis are integrated exactly
        let discrete = data.source.all().flat_map(|f| f.discrete());
        let cell_degree = discrete.map(|f| f.degree() + basis_degree).fold(cell_degree, usize::max);
        let cell_rule = rule(quadrature.family, D, cell_degree)?;
        let facet_rule = rule(quadrature.family, D - 1, quadrature.facet)?;
        let reaction = match data.reaction.is_given() || data.robin.is_given() {
            false => None,
            true => {
                let products = 2 * basis_degree;
                let is_constant = data.reaction.all().all(|datum| datum.constant().is_some());
                let degree = if is_constant { products } else { products.max(cell_degree) };
                let rule = rule(quadrature.reaction, D, degree)?;
                let rules = (rule, facet_rule.clone());
                let term = ReactionTerm::new((&data, mesh), rules, degree, element.clone());
                term.check_sides(mesh)?;
                Some(term)
            }
        };
        let coefficients = checks::coefficients(&data.coefficient, mesh)?;
        let varying = match &coefficients {
            Some(constants) if basis_degree > 1 => {
                VaryingCoefficient::new(&data.coefficient, mesh, constants, &*element)?
            }
            _ => None,
        };
        let tensor = TensorCoefficient::new(&data.tensor, mesh, basis_degree)?;
        if tensor.is_some() && varying.is_some() {
            let message = "a tensor coefficient beside a coefficient that varies within cells is made for linear elements only: take one of these, or constants by region";
            return Err(Error::UnsupportedForm(message.to_owned()));
        }
        let space = Self {
            problem,
            mesh,
            body_constants,
            data,
            cell_rule,
            cell_degree,
            facet_rule,
            reaction,
            neighbours,
            dofs,
            coefficients,
            tensor,
            varying,
            in_domain: nodes.iter().map(|node| set.in_domain(node, D)).collect(),
            on_contact: nodes.iter().map(|node| set.on_contact(node, D)).collect(),
            node_vertices: nodes.iter().map(|node| NodeVertices::new(&node.centre(D))).collect(),
            nodes,
            degree,
            basis_degree,
            broken: layout.is_broken(),
            pins,
            element,
            load_by_cell: OnceLock::new(),
        };
        space.check_constraint_set(&own)?;
        Ok(space)
    }

    /// Refuses an inequality that would bind nothing at all, and names the sets that the element of the
    /// scheme offers.
    fn check_constraint_set(&self, own: &Arc<dyn Element<D>>) -> Result<(), Error> {
        let refuse = |condition, contact| {
            let constraint = self.problem.constraint_set().name_on(&self.nodes);
            let allowed = match &offered(own, contact)[..] {
                [] => "another element: this one has no nodes on facets".to_owned(),
                names => names.join(" or "),
            };
            Err(Error::NothingToBound(format!(
                "bounds on {constraint} cannot impose {condition}: the element has no such values; choose {allowed}"
            )))
        };
        if self.problem.is_constrained() && self.bounded_nodes().next().is_none() {
            return refuse("an inequality", self.problem.has_gap());
        }
        let mut facets = 0..=D;
        let has_nodes = facets.clone().all(|local| self.nodes_on(local).next().is_some());
        let binds = facets.any(|local| self.bounded_nodes_on(local).next().is_some());
        if self.problem.has_gap() && !(has_nodes && binds) {
            return refuse("a Signorini condition", true);
        }
        Ok(())
    }

    /// The neighbours, in a space that was made with facets.
    pub fn coupled_neighbours(&self) -> &Neighbours {
        self.neighbours.as_ref().expect("facets are built for every form that couples cells")
    }
    /// Unknowns of a cell.
    pub fn per_cell(&self) -> usize {
        self.nodes.len()
    }
    /// The basis at a point of the cell.
    pub fn basis_at(&self, point: &[f64; 4]) -> BasisAt {
        BasisAt::new(&*self.element, point)
    }
    /// The factor `c` if the gradient of each basis function `i` is `c` times that of barycentric
    /// coordinate `i`, so that products of gradients make the whole stiffness.
    pub fn gradient_factor(&self) -> Option<f64> {
        let derivatives = self.basis_at(&[1.0 / (D + 1) as f64; 4]).derivatives;
        let factor = derivatives[0][0];
        let is_one = |i: usize, k: usize| derivatives[i][k] == if i == k { factor } else { 0.0 };
        let all = self.basis_degree == 1
            && self.per_cell() == D + 1
            && (0..=D).all(|i| (0..=D).all(|k| is_one(i, k)));
        all.then_some(factor)
    }
    /// The stiffness of the reference element.
    pub fn stiffness_table(&self) -> StiffnessTable {
        let degree = 2 * self.basis_degree.saturating_sub(1);
        StiffnessTable::new(D, &self.cell_table(Rule::new(D, degree)), self.gradient_factor())
    }
    /// Whether the unknowns of a cell are Bernstein coefficients.
    pub fn has_coefficients(&self) -> bool {
        self.nodes.iter().all(Node::is_coefficient)
    }
    /// Whether unknown `i` is the value at vertex `i` of a conforming linear function.
    pub fn is_conforming_linear(&self) -> bool {
        !self.broken && self.nodes.iter().cloned().eq((0..=D).map(Node::vertex))
    }
    /// Moments of the basis on facets, up to a degree.
    pub fn facet_table(&self, degree: usize) -> FacetTable {
        FacetTable::new(&*self.element, degree)
    }
    /// The basis at the points of a cell rule.
    pub fn cell_table(&self, rule: Rule) -> CellTable {
        CellTable::new(rule, &*self.element)
    }
    /// The size of a function with the load: the largest quotient of load and coefficient, at barycentres of cells,
    /// times the square of the diameter of the mesh.
    pub fn size_of_load(&self) -> f64 {
        let of_cell = |cell: usize| {
            let at_barycentre = |f: &Datum<D>| self.at(f, cell, &self.mesh.barycentre(cell));
            let source = self.data.source.of(self.mesh.region(cell));
            let load = source.map_or(0.0, |f| f.constant().unwrap_or_else(|| at_barycentre(f)));
            load.abs() / self.mean_coefficient(cell)
        };
        let of_chunk = |cells: Range<usize>| cells.map(of_cell).fold(0.0, f64::max);
        let largest = cells::map(self.mesh.n_cells(), &of_chunk).into_iter().fold(0.0, f64::max);
        largest * self.mesh.domain_diameter().powi(2)
    }

    /// The unknowns of a cell.
    pub fn local_values(&self, cell: usize, u: &[f64]) -> [f64; MAX_BASIS] {
        let mut local = [0.0; MAX_BASIS];
        for (i, value) in local.iter_mut().enumerate().take(self.per_cell()) {
            *value = u[self.dofs.of(cell, i)];
        }
        local
    }
    /// The boundary facets with a condition, by cell and number in the cell.
    pub fn facets_of(&self, condition: BoundaryCondition) -> impl Iterator<Item = HalfFacet> {
        self.grouped_facets_of(condition).map(|(facet, _)| facet)
    }
    /// The boundary facets with a condition, with the numbers of their groups.
    pub fn grouped_facets_of(
        &self,
        condition: BoundaryCondition,
    ) -> impl Iterator<Item = (HalfFacet, usize)> {
        let is_one = move |f: &&BoundaryFacet| f.condition == condition;
        let facet = |f: &BoundaryFacet| ((f.cell as usize, f.local as usize), usize::from(f.group));
        self.mesh.boundary().iter().filter(is_one).map(facet)
    }
    /// The number of the group of a boundary facet.
    pub fn group_of(&self, (cell, local): HalfFacet) -> usize {
        self.mesh.boundary_group(cell, local).expect("a boundary facet has a group")
    }
    /// Whether a Neumann facet has a flux that does not depend on the solution: no Robin side, no friction.
    pub fn is_loaded_alone(&self, facet: HalfFacet) -> bool {
        let group = || self.group_of(facet);
        (!self.data.robin.is_given() || self.data.robin.of(group()).is_none())
            && (!self.data.friction.is_given() || self.data.friction.of(group()).is_none())
    }
    /// For each vertex on the Dirichlet boundary the boundary group whose datum is given there, and the cell of a facet
    /// of this group.
    pub fn dirichlet_groups(&self) -> Vec<Option<(usize, usize)>> {
        let mut given: Vec<Option<(usize, usize)>> = vec![None; self.mesh.vertices().len()];
        let rank = |group: usize| self.data.dirichlet_rank[group];
        for ((cell, local), group) in self.grouped_facets_of(BoundaryCondition::Dirichlet) {
            for v in self.mesh.facet_vertices(cell, local) {
                let old = &mut given[v as usize];
                *old = old.filter(|(old, _)| rank(*old) <= rank(group)).or(Some((group, cell)));
            }
        }
        given
    }
    /// The value of a datum at a point of a cell.
    #[inline(always)]
    pub fn at(&self, datum: &Datum<D>, cell: usize, x: &Point<D>) -> f64 {
        datum.in_cell(self.mesh, cell, x)
    }
    /// The Dirichlet value at a point of a boundary group, on a facet of a cell; of a discrete function the mean over the
    /// cells that contain the point.
    pub fn dirichlet_at(&self, group: usize, cell: usize, x: &Point<D>) -> f64 {
        self.data.dirichlet.of(group).map_or(0.0, |u| u.of_body(cell, x))
    }
    #[inline(always)]
    pub fn metric(&self, cell: usize) -> CellMetric<D> {
        let mut metric = CellMetric::of(self.mesh, cell);
        // volume and measures stay those of the mesh
        if let Some(tensor) = &self.tensor {
            metric.products = tensor.shape(self.mesh, cell, 1.0).1;
        }
        metric
    }
    pub fn facet_measure(&self, (cell, local): HalfFacet) -> f64 {
        self.mesh.geometry(cell).facet_measure(local)
    }
    /// A point of a facet in space.
    pub fn facet_point(&self, point: &[f64; 4], cell: usize, local: usize) -> Point<D> {
        let inserted = facet_to_cell(point, local);
        self.mesh.point(cell, &inserted[..=D])
    }
    /// A point of a cell in space.
    pub fn cell_point(&self, point: &[f64; 4], cell: usize) -> Point<D> {
        self.mesh.point(cell, &point[..=D])
    }
    /// The basis functions whose nodes lie on facet `local`.
    pub fn nodes_on(&self, local: usize) -> impl Iterator<Item = usize> {
        (0..self.per_cell()).filter(move |&i| !self.nodes[i].entity().contains(D, local))
    }
    /// The basis functions whose unknowns an obstacle binds, and by what.
    pub fn bounded_nodes(&self) -> impl Iterator<Item = (usize, BoundBy)> {
        self.in_domain.iter().enumerate().filter_map(|(i, by)| Some((i, (*by)?)))
    }
    /// The basis functions whose unknowns a Signorini condition on facet `local` binds, and by what.
    pub fn bounded_nodes_on(&self, local: usize) -> impl Iterator<Item = (usize, BoundBy)> {
        self.nodes_on(local).filter_map(|i| Some((i, self.on_contact[i]?)))
    }
    /// The point that stands for a node.
    pub fn node_point(&self, cell: usize, node: &Node) -> Point<D> {
        match node.entity() {
            Entity::Facet(k) if node.is_facet_mean() => self.mesh.facet_barycentre(cell, k),
            _ => self.cell_point(&node.centre(D), cell),
        }
    }
    /// The functional of each node, with this rule for means.
    pub fn node_terms(&self, facet_rule: &Rule) -> Vec<Terms> {
        self.nodes.iter().map(|node| node.terms(facet_rule)).collect()
    }
    /// A discrete function, with a mesh of its own.
    pub fn function(&self, u: &[f64]) -> DiscreteFunction<D> {
        let n = self.per_cell();
        let unknowns = (0..self.mesh.n_cells() * n).map(|k| self.dofs.of(k / n, k % n));
        let constants = self.constants_of_unknowns();
        let value = |i: usize| constants.get(i).map_or(u[i], |constant| u[i] + constant);
        let values = unknowns.map(value).collect();
        DiscreteFunction::new(self.mesh.clone(), self.element.clone(), values)
    }
    /// A discrete function at the vertices of each cell, `D + 1` values for each.
    pub fn vertex_values(&self, u: &[f64]) -> Vec<f64> {
        let corners: Vec<BasisAt> = (0..=D).map(|k| self.basis_at(&vertex_point(k))).collect();
        let mut out = Vec::with_capacity(self.mesh.n_cells() * (D + 1));
        for cell in 0..self.mesh.n_cells() {
            let local = self.local_values(cell, u);
            let constant = self.body_constants.of_cell(cell);
            out.extend(corners.iter().map(|basis| basis.value(&local) + constant));
        }
        out
    }
    /// By unknown what was taken off: the constant of its body as a function of the space; empty if it is zero for all.
    pub fn constants_of_unknowns(&self) -> Vec<f64> {
        if self.body_constants.are_zero() {
            return Vec::new();
        }
        let one = self.constants();
        let mut constants = vec![0.0; self.dofs.size()];
        for cell in 0..self.mesh.n_cells() {
            let constant = self.body_constants.of_cell(cell);
            let unknowns = one.iter().enumerate();
            unknowns.for_each(|(i, one)| constants[self.dofs.of(cell, i)] = constant * one);
        }
        constants
    }
}

/// A rule of a family, tested, for it may be a user's.
fn rule(family: &dyn Quadrature, dimension: usize, degree: usize) -> Result<Rule, QuadratureError> {
    let Rule { points, weights } = family.rule(dimension, degree)?;
    Rule::from_points(dimension, points, weights)
}

//! An element and a constraint set in one file: continuous linears and a bubble in each cell, held to the laws
//! of elements and schemes, then beside P1 on an equation and on an obstacle problem, there with bounds at all
//! nodes and with bounds at vertices. `cargo run --release --example my_element` writes tables and plots to
//! `target/my_element`.
//!
//! D. N. Arnold, F. Brezzi, M. Fortin, Calcolo 21 (1984), 337-344, where it is one half of an element
//! for the Stokes problem.

use unilateral::element::Layout;
use unilateral::kit::check_scheme;
use unilateral::mesh::BoxDomain;
use unilateral::prelude::*;

/// Values at the vertices and at the barycentre: `b = (D + 1)^(D + 1) l_0 ... l_D` is one there and
/// zero on the boundary of the cell, `l_i - b / (D + 1)` is one at vertex `i` and zero at the other
/// nodes.
#[derive(Clone, Copy)]
struct P1WithBubble;

impl<const D: usize> ReferenceElement<D> for P1WithBubble {
    const N: usize = D + 2;
    /// Not all quadratics are in the span: orders are those of linears.
    const DEGREE: usize = 1;
    /// The bubble is a product of `D + 1` linears: integrals of the basis need rules for it.
    const BASIS_DEGREE: usize = D + 1;
    const LAYOUT: Layout = Layout { vertex: 1, edge: 0, facet: 0, cell: 1 };

    fn values(lambda: &[f64], out: &mut [f64]) {
        let n = (D + 1) as f64;
        let bubble = lambda.iter().fold(1.0, |product, &l| product * n * l);
        for i in 0..=D {
            out[i] = lambda[i] - bubble / n;
        }
        out[D + 1] = bubble;
    }
    fn derivatives(lambda: &[f64], out: &mut [[f64; 4]]) {
        let n = (D + 1) as f64;
        let mut bubble = [0.0; 4];
        for k in 0..=D {
            bubble[k] = (0..=D).filter(|&l| l != k).fold(n, |product, l| product * n * lambda[l]);
        }
        for i in 0..=D {
            out[i] = bubble.map(|slope| -slope / n);
            out[i][i] += 1.0;
        }
        out[D + 1] = bubble;
    }
    fn node(i: usize) -> Node {
        if i <= D {
            return Node::vertex(i);
        }
        let mut barycentre = [0.0; 4];
        barycentre[..=D].fill(1.0 / (D + 1) as f64);
        Node::value(Entity::Cell, barycentre)
    }
}

/// The conforming scheme, without terms on facets and with bounds at all nodes.
struct WithBubble;

impl<const D: usize> Scheme<D> for WithBubble {
    type Element = P1WithBubble;
    type Facet = NoFacets;
    const DIRICHLET: DirichletBy = DirichletBy::Pinning;
    fn name(&self) -> &str {
        "p1-bubble"
    }
    fn facet(&self, _: &Mesh<D>) -> NoFacets {
        NoFacets
    }
    /// Those of linears on an equation; under an inequality the values at nodes are a set for which
    /// nothing is claimed here.
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        match setting.is_linear() {
            true => ExpectedOrders::none().with_l2(2.0).with_h1(1.0),
            false => ExpectedOrders::none(),
        }
    }
}

/// Bounds at the vertices of each cell, none at the barycentre.
struct OnlyVertices;

impl ConstraintSet for OnlyVertices {
    fn name(&self) -> &str {
        "only-vertices"
    }
    fn in_domain(&self, node: &Node, _: usize) -> Option<BoundBy> {
        matches!(node.entity(), Entity::Vertex(_)).then_some(BoundBy::Value)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    print!("{}", check_scheme::<2, _>(&WithBubble)?);
    print!("{}", check_scheme::<3, _>(&WithBubble)?);

    let value = |x: &Point<2>| (2.0 * x[0] - x[1]).sin();
    let problem = Problem::new()
        .exact(value, |x| Point::from([2.0, -1.0]) * (2.0 * x[0] - x[1]).cos())
        .source(move |x| 5.0 * value(x));
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let equation = scenes::Scene::new("sine", square, problem).regularity(Regularity::smooth());
    let study = |scene| {
        Study::<2>::new(scene).scheme(ConformingP1).scheme(WithBubble).levels([4, 8, 16, 32])
    };
    let report = study(equation).run()?;
    print!("{report}");
    report.assert_orders(0.1)?;
    let report = study(scenes::radial(1.0)).scheme_on(WithBubble, OnlyVertices).run()?;
    print!("{report}");
    report.write("target/my_element")?;
    Ok(())
}

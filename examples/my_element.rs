//! An element and a constraint set in one file: continuous linears and a bubble in each cell, held to the laws
//! of elements and schemes, then beside P1 on an equation and on an obstacle problem, there with bounds at all
//! nodes and with bounds at vertices. `cargo run --release --example my_element` writes tables and plots to
//! `target/my_element`.
//!
//! D. N. Arnold, F. Brezzi, M. Fortin, Calcolo 21 (1984), 337-344, where it is one half of an element
//! for the Stokes problem.

use std::sync::Arc;

use unilateral::element::Layout;
use unilateral::kit::check_scheme;
use unilateral::mesh::BoxDomain;
use unilateral::prelude::*;

/// Values at the vertices and at the barycentre: `b = (D + 1)^(D + 1) l_0 ... l_D` is one there and
/// zero on the boundary of the cell, `l_i - b / (D + 1)` is one at vertex `i` and zero at the other
/// nodes.
#[derive(Debug)]
struct P1WithBubble;

impl<const D: usize> Element<D> for P1WithBubble {
    /// Not all quadratics are in the span: orders are those of linears.
    fn degree(&self) -> usize {
        1
    }
    /// The bubble is a product of `D + 1` linears: integrals of the basis need rules for it.
    fn basis_degree(&self) -> usize {
        D + 1
    }
    fn layout(&self) -> Layout {
        Layout { vertex: 1, edge: 0, facet: 0, cell: 1 }
    }
    fn node(&self, i: usize) -> Node {
        if i <= D { Node::vertex(i) } else { Node::barycentre(D) }
    }
    fn values(&self, lambda: &[f64], out: &mut [f64]) {
        let n = (D + 1) as f64;
        out[D + 1] = lambda.iter().fold(1.0, |product, l| product * n * l);
        for i in 0..=D {
            out[i] = lambda[i] - out[D + 1] / n;
        }
    }
    fn derivatives(&self, lambda: &[f64], out: &mut [[f64; 4]]) {
        let n = (D + 1) as f64;
        for k in 0..=D {
            let others = (0..=D).filter(|&l| l != k);
            out[D + 1][k] = others.fold(n, |product, l| product * n * lambda[l]);
        }
        for i in 0..=D {
            out[i] = out[D + 1].map(|slope| -slope / n);
            out[i][i] += 1.0;
        }
    }
}

/// The conforming scheme, without terms on facets and with bounds at all nodes.
struct WithBubble;

impl<const D: usize> Scheme<D> for WithBubble {
    fn name(&self) -> &str {
        "p1-bubble"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(P1WithBubble)
    }
    /// Those of linears on an equation; under an inequality the values at nodes are a set for which
    /// nothing is claimed here.
    fn expected_orders(&self, setting: &Setting) -> ExpectedOrders {
        match setting.is_linear() && setting.regular_dual {
            true => ExpectedOrders { l2: Some(2.0), h1: Some(1.0) },
            false => ExpectedOrders::default(),
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
    print!("{}", check_scheme::<2>(&WithBubble)?);
    print!("{}", check_scheme::<3>(&WithBubble)?);

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

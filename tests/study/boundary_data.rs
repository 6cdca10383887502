//! What problem files give on the boundary: by default, and by the normal.

use super::problem_files::problem;
use crate::support::scratch::Scratch;
use std::path::{Path, PathBuf};
use unilateral::mesh::{BoundaryCondition, Domain};
use unilateral::prelude::*;

fn mesh_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/problems").join(name)
}

const DEFAULT: &str = "[boundary.default]\nkind = \"neumann\"\nflux = \"x\"\n";

#[test]
fn groups_without_a_table_have_what_is_given_by_default() {
    let folder = Scratch::new("boundary-default");
    let left = "[boundary.left]\nkind = \"dirichlet\"\n";
    let own = problem(&folder, &format!("box = [[0, 0], [1, 1]]\n{DEFAULT}{left}")).unwrap();
    let Domain::Box(domain) = &own.domain else { panic!("a box") };
    let (fixed, free) = (BoundaryCondition::Dirichlet, BoundaryCondition::Neumann);
    assert_eq!(domain.sides, [[fixed, free], [free, free]]);
    let mesh = mesh_file("holes.msh");
    let outer = "[boundary.outer]\nkind = \"dirichlet\"\n";
    let of_mesh = format!("mesh = {:?}\n{outer}", mesh.display().to_string());
    let own = problem(&folder, &format!("{of_mesh}{DEFAULT}")).unwrap();
    let mesh = own.domain.mesh(0).unwrap();
    let groups = mesh.boundary_groups().iter();
    let mut parts: Vec<_> = groups.map(|g| (g.names.join(" "), g.condition)).collect();
    parts.sort_by(|a, b| a.0.cmp(&b.0));
    assert_eq!(parts, [("bore".to_owned(), Some(free)), ("outer".to_owned(), Some(fixed))]);

    let refused = |text: &str| problem(&folder, text).unwrap_err().to_string();
    assert!(refused(&of_mesh).contains("boundary group `bore` of the mesh is missing"));
    let wrong = refused(&format!("{of_mesh}{}", DEFAULT.replace("flux", "gap")));
    assert!(wrong.contains("unknown key `gap`") && wrong.contains("plane.toml:6:"), "{wrong}");
}

/// The group `rim` has the facets of `foot` and others: what is given by default is given on all of it, after the table.
#[test]
fn a_default_reaches_groups_that_share_facets() {
    let folder = Scratch::new("boundary-shared");
    let mesh = mesh_file("rim.msh").display().to_string();
    let foot = "[boundary.foot]\nkind = \"contact\"\n";
    let of_kind = |kind: &str| {
        let given = format!("[boundary.default]\nkind = \"{kind}\"\n");
        let own = problem(&folder, &format!("mesh = {mesh:?}\n{foot}{given}"));
        own.map(|own| own.domain.mesh(0).unwrap()).map_err(|error| error.to_string())
    };
    let mesh = of_kind("contact").unwrap();
    assert!(mesh.boundary().iter().all(|facet| facet.condition == BoundaryCondition::Contact));
    let message = of_kind("dirichlet").map(|_| ()).unwrap_err();
    assert!(message.contains("share facets"), "{message}");
}

/// The points of a mesh far from the origin are off its facets by rounding.
#[test]
fn gaps_may_use_normals_far_from_the_origin() {
    let folder = Scratch::new("gap-far-away");
    let mesh = mesh_file("disc_far.msh").display().to_string();
    let contact = "[boundary.rim]\nkind = \"contact\"\ngap = \"-0.1 + 0.05 * nx\"\n";
    let text = format!("mesh = {mesh:?}\n{contact}[source]\ndefault = -8\n");
    let own = problem(&folder, &text).unwrap();
    let mesh = own.domain.mesh(0).unwrap();
    assert!(solve(&own.problem, &mesh, &ConformingP1).unwrap().converged());
}

/// A gap on a straight side has one normal, which stands for a number.
#[test]
fn gaps_may_use_the_normal_of_a_side() {
    let folder = Scratch::new("gap-of-a-side");
    let solution = |gap: &str| {
        let contact = format!("[boundary.bottom]\nkind = \"contact\"\ngap = {gap}\n");
        let rest = DEFAULT.replace("neumann", "dirichlet").replace("flux", "value");
        let source = "[source]\ndefault = -10\n";
        let rest = rest.replace("\"x\"", "0");
        let own = problem(&folder, &format!("box = [[0, 0], [1, 1]]\n{contact}{rest}{source}"));
        let own = own.unwrap();
        let mesh = own.domain.mesh(8).unwrap();
        let solved = solve(&own.problem, &mesh, &ConformingP1).unwrap();
        assert!(solved.converged() && solved.active() > Some(0));
        solved.values().to_vec()
    };
    assert_eq!(solution("\"0.05 * ny * (1 + nx)\""), solution("-0.05"));
    assert_ne!(solution("\"0.06 * ny\""), solution("-0.05"));
}

/// On a boundary of many normals each facet has its own, in all refinements of the mesh.
#[test]
fn gaps_may_use_the_normals_of_a_curved_boundary() {
    let folder = Scratch::new("gap-of-a-bore");
    let mesh = mesh_file("holes.msh");
    let text = format!(
        "mesh = {:?}\n[boundary.outer]\nkind = \"dirichlet\"\n[boundary.bore]\nkind = \"contact\"\n\
         gap = \"-1 + x - 0.1 * nx + 0.3 * y * ny\"\n[source]\ndefault = -1\n",
        mesh.display().to_string()
    );
    let own = problem(&folder, &text).unwrap();
    let mut mesh = own.domain.mesh(0).unwrap();
    let mut normals = Vec::new();
    for level in 0..2 {
        let solved = solve(&own.problem, &mesh, &ConformingP1).unwrap();
        assert!(solved.converged());
        let fields = solved.fields().unwrap();
        for (&(cell, local), distance) in fields.contact_boundary.iter().zip(&fields.gap) {
            let (x, n) = (mesh.facet_barycentre(cell, local), mesh.geometry(cell).normal(local));
            // along a facet solution and gap are linear
            let gap = -1.0 + x[0] - 0.1 * n[0] + 0.3 * x[1] * n[1];
            let expected = solved.value_at(&x).unwrap() - gap;
            assert!((distance - expected).abs() < 1e-9, "level {level}: {x} {distance} {expected}");
            normals.push(n);
        }
        // at a vertex where two facets meet the larger one of their gaps holds
        let mut largest = vec![f64::NEG_INFINITY; mesh.vertices().len()];
        for &(cell, local) in &fields.contact_boundary {
            let n = mesh.geometry(cell).normal(local);
            for v in mesh.facet_vertices(cell, local) {
                let x = mesh.vertices()[v as usize];
                let gap = -1.0 + x[0] - 0.1 * n[0] + 0.3 * x[1] * n[1];
                largest[v as usize] = largest[v as usize].max(gap);
            }
        }
        for (bound, gap) in solved.inequality().bounds.iter().zip(largest) {
            let found = bound.lower().filter(|_| bound.is_inequality());
            assert!(
                (found.unwrap_or(f64::NEG_INFINITY) - gap).abs() < 1e-9
                    || found.is_none() && gap.is_infinite(),
                "{found:?} {gap}"
            );
        }
        mesh = mesh.refine().unwrap().0;
    }
    assert!(normals.iter().any(|n| (n - normals[0]).norm() > 1.0));
}

/// On a group with a shape a gap takes the normals of the shape, outward, in all refinements of the mesh.
#[test]
fn gaps_use_the_normals_of_a_shape() {
    let folder = Scratch::new("normals-of-a-shape");
    let plate = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/problems/plate.msh");
    std::fs::copy(plate, folder.0.join("plate.msh")).unwrap();
    let rest = "[boundary.default]\nkind = \"neumann\"\n[source]\ndefault = -1\n";
    let of_shape = |shape: &str| {
        problem(
            &folder,
            &format!(
                "mesh = \"plate.msh\"\n{rest}[boundary.bore]\nkind = \"contact\"\n\
                gap = \"-1 + 0.1 * nx - 0.2 * ny\"\nshape = \"{shape}\"\n"
            ),
        )
    };
    for shape in ["(x + 1)^2 + y^2 - 0.16", "0.4 - ((x + 1)^2 + y^2)^(1/2)"] {
        let scene = of_shape(shape).unwrap();
        let gap = &scene.problem.gap.named[0].1;
        let mut mesh = scene.domain.mesh(0).unwrap();
        for _ in 0..3 {
            for facet in
                mesh.boundary().iter().filter(|f| f.condition == BoundaryCondition::Contact)
            {
                for v in mesh.facet_vertices(facet.cell as usize, facet.local as usize) {
                    let x = mesh.vertices()[v as usize];
                    let inward = Point::from([x[0] + 1.0, x[1]]);
                    assert!((inward.norm() - 0.4).abs() < 1e-7, "{x}");
                    let n = -inward.normalize();
                    assert!((gap.at(&x) - (-1.0 + 0.1 * n[0] - 0.2 * n[1])).abs() < 1e-8);
                }
            }
            let solved = solve(&scene.problem, &mesh, &Sipg::default()).unwrap();
            assert!(solved.converged() && solved.active() > Some(0));
            mesh = mesh.refine().unwrap().0;
        }
    }
    // positive on the right of the bore, in the plate, negative on the left of it
    let error = of_shape("((x + 1)^2 + y^2 - 0.16) * (x + 1)").unwrap_err().to_string();
    let said = "boundary.bore.shape: facets of the group lie on both sides of it";
    assert!(error.contains("plane.toml:") && error.contains(said), "{error}");
}

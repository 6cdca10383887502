//! Criteria of the stability study, case by case.

use serde::Serialize;

/// A criterion: every run of the study has at least one row for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Criterion {
    /// Name of the criterion.
    pub name: &'static str,
    /// Name of its case.
    pub case: &'static str,
    /// The condition, in a sentence.
    pub sentence: &'static str,
}

const fn of(case: &'static str, name: &'static str, sentence: &'static str) -> Criterion {
    Criterion { name, case, sentence }
}

/// All criteria, in the order of reports.
pub const CRITERIA: &[Criterion] = &[
    of(
        "round-off",
        "halving-above-barrier",
        "Poisson, over-penalty 1/h^3 in values at vertices: each halving of h multiplies the error by 0.3 at most as long as h is at least 4 (epsilon eta)^(1/6), epsilon half the distance from one to the next number.",
    ),
    of(
        "round-off",
        "halving-to-floor",
        "Poisson: errors fall like h^2, by 0.3 or better at each halving, down to h = epsilon^(1/4). Conforming elements do so; an over-penalty does not where it is added to the stiffness, and does where the two are kept apart, as they are here.",
    ),
    of(
        "round-off",
        "limit-of-large-factors",
        "With bounds on facet means or with none, the relative distance in L2 to the Crouzeix-Raviart solution is at most eta^(-1/2) for eta to 1e6: the limit is reached before rounding matters. For larger factors rounding is known to prevail.",
    ),
    of(
        "penalty-factor",
        "definite-for-every-factor",
        "The over-penalised matrix has a Cholesky factor for every eta > 0, from 1e-4 to 1e10: 1 if it has.",
    ),
    of(
        "penalty-factor",
        "error-of-large-factors",
        "The broken H1 error is at most 1.05 times that of Crouzeix-Raviart elements for eta from 1 to 1e10. Factors below one penalise too little and are known to fail.",
    ),
    of(
        "penalty-factor",
        "jumps-of-large-factors",
        "From eta = 1 on the jump part of the error falls like eta^(-1/2): times eta^(1/2) it stays within a factor of 1.5 of its value at eta = 100. Below one jumps are too large to fall like that.",
    ),
    of(
        "penalty-factor",
        "multiplier-of-large-factors",
        "The L1 error of the multiplier is at most 1.5 times that of Crouzeix-Raviart elements for eta from 10 to 1e14, in f32 to 1e11: contact forces keep their digits where the weight leaves none in differences of values. With one jumps still count, and in f32 matrices may be singular from 1e12 on: both are known to fail.",
    ),
    of(
        "penalty-factor",
        "equilibrium",
        "Contact forces and the fluxes through facets with Dirichlet data balance the load, less the reaction: what is left is at most 1e-6 of the integral of the absolute load in f64, and 1e-3 in f32, where matrices are known to fail from 1e12 on.",
    ),
    of(
        "penalty-factor",
        "condition-over-factors",
        "The condition number, preconditioned by the diagonal in means and jumps, is at most twice that at eta = 1 for all larger eta. Without preconditioning it grows like eta, and below one it is known to grow like 1/eta.",
    ),
    of(
        "penalty-factor",
        "condition-over-meshes",
        "The preconditioned condition number grows like h^-2 (order at most 2.1). Without preconditioning it grows like h^-4.",
    ),
    of(
        "stretched-cells",
        "error-on-stretched-cells",
        "Poisson on an N by N a mesh, aspect ratios a to 256: the energy error over that of Crouzeix-Raviart elements is at most 1.5 times its value at a = 1. The weight 1/h_F^3 is known to fail.",
    ),
    of(
        "stretched-cells",
        "definite-on-stretched-cells",
        "The matrix of a symmetric scheme is positive definite for every aspect ratio: 1 if it is. A penalty 10/h_F is known to fail from the ratio five on.",
    ),
    of(
        "graded-meshes",
        "error-on-graded-meshes",
        "Signorini on meshes graded to the end of contact, shortest over longest side of cells to 1e-6 and 1e-12: a finite solution, with a broken H1 error at most twice that of Crouzeix-Raviart elements on the same mesh.",
    ),
    of(
        "contrast",
        "error-over-contrast",
        "Coefficients 1e-8 to 1e8, aligned with the mesh: the relative energy error is at most 1.5 times that at contrast one. A penalty that ignores the coefficient is known to fail.",
    ),
    of(
        "contrast",
        "iterations-over-contrast",
        "The number of active sets tried is bounded over the same contrasts: at most 25.",
    ),
    of(
        "contrast",
        "interface-across-flux",
        "An obstacle problem with flux across an aligned interface only: the energy error without penalties (broken H1) is at most 1.15 times that of conforming P1.",
    ),
    of(
        "contrast",
        "interface-inside-cells",
        "An interface that no mesh resolves: the error is that of resolving data, about order one half in H1, and no scheme is judged by it.",
    ),
    of(
        "coercivity",
        "inertia",
        "Interior penalty sigma/h_F on the unit square, threshold sigma = 3: no negative eigenvalue (counted by the pivots of a factorisation). Below the threshold there are some, whatever the size of the error.",
    ),
    of(
        "coercivity",
        "refused-or-warned",
        "A penalty below its proven bound is not accepted silently: 1 if the library refuses to solve or warns, which it does not from the bound on.",
    ),
    of(
        "coercivity",
        "error-of-interior-penalty",
        "With interior penalty sigma/h_F from the proven bound on, the broken H1 error is at most 1.25 times that of Crouzeix-Raviart elements. Between the threshold and the bound the matrix is definite by little, and the error is known to be larger.",
    ),
    of(
        "curved-obstacle",
        "no-silent-failure",
        "No solver returns an iterate as converged that does not satisfy the complementarity conditions to 1e-9: the number of such returns is zero, with the active set method, whatever follows it, and with the interior point method.",
    ),
    of(
        "curved-obstacle",
        "certificate",
        "The complementarity conditions hold to 1e-9 in relative, dimensionless terms.",
    ),
    of(
        "curved-obstacle",
        "contact-set",
        "The contact set, of vertices where some unknown touches, differs from the exact one by at most a strip of width 2h along the free boundary. The share of single unknowns in contact well inside the exact set is reported beside it: it need not tend to one, and is no measure of contact.",
    ),
    of(
        "curved-obstacle",
        "multiplier-order",
        "The multiplier, gathered over the patches of vertices, converges in L1 with order at least 0.9, fitted over levels 16, 32 and 64, where it is bounded.",
    ),
    of(
        "curved-obstacle",
        "iterations",
        "Started from conforming elements, the active set method and what follows where it stagnates solve at most 25 linear systems.",
    ),
    of(
        "biactive",
        "orders-on-biactive-sets",
        "Gap and multiplier that vanish together do not change orders: fitted over all levels, L2 at least 1.8 and H1 at least 0.9 where the solution is smooth enough.",
    ),
    of(
        "biactive",
        "active-sets-tried",
        "From a cold start the active set method and what follows where it stagnates solve at most 40 linear systems.",
    ),
    of(
        "biactive",
        "interior-point-steps",
        "The interior point method solves at most 40 linear systems.",
    ),
    of(
        "biactive",
        "free-boundary",
        "Where gap and multiplier vanish together the contact set is no datum of the problem; its distance from the exact one is meaningful for the strictly complementary part only, and is then at most 2h.",
    ),
    of(
        "scaling",
        "size-of-domain",
        "On a domain L times as large, L from 1e-6 to 1e6, the solution is the same at corresponding points to 1e-10. A factor eta without dimension is known to fail.",
    ),
    of(
        "scaling",
        "size-of-coefficient",
        "With coefficient and load c times as large, c from 1e-8 to 1e8, the solution is the same to 1e-10. A penalty that ignores the coefficient is known to fail.",
    ),
    of(
        "contact-ends",
        "order-with-ends-off-mesh",
        "Signorini with the end of contact at a vertex and off all vertices: the H1 order, fitted over levels of 16 and more, is within 0.05 of one or better.",
    ),
    of("contact-ends", "end-of-contact", "The end of contact is found to 2h."),
    of(
        "contact-ends",
        "values-on-contact-set",
        "The largest value of the solution on the exact contact set is at most (2h)^(3/2), which is what the exact solution has 2h from the end.",
    ),
    of(
        "contact-ends",
        "junction-inside-facet",
        "A mesh on which the exact contact condition fails inside a contact facet, because contact and Dirichlet boundary do not meet at a vertex, is refused or its errors withheld with a warning: 1 if so.",
    ),
    of(
        "orders",
        "orders-of-over-penalty",
        "WOPSIP on nine problems: order at least 1.9 in L2, 0.97 in H1 and 0.9 in jumps, fitted over the levels given.",
    ),
    of(
        "orders",
        "jumps-of-interior-penalty",
        "Jumps of interior penalty schemes fall with order 1.5 (at least 1.4).",
    ),
    of(
        "orders",
        "duality-of-nipg",
        "NIPG is not consistent with the dual problem: its L2 order is reported, not judged.",
    ),
    of(
        "orders",
        "strings",
        "Free boundaries of strings fall between vertices, so that errors oscillate with h: the order fitted over six levels is at least 0.9 in H1.",
    ),
    of(
        "orders",
        "boxes-in-space",
        "In space with eta = 1 the over-penalty is pre-asymptotic until h is about a quarter of the root of eta; with eta times the squared diameter it is not: the error over that of conforming elements is reported.",
    ),
    of(
        "slivers",
        "error-on-slivers",
        "Poisson in the cube with a layer of tetrahedra of relative height t from 1 to 1e-6: the energy error over that of Crouzeix-Raviart elements on the same mesh is at most 1.5 times its value at t = 1. The weight 1/h_F^3 is shown beside.",
    ),
    of(
        "slivers",
        "definite-on-slivers",
        "The matrix of a symmetric scheme is positive definite on the same meshes: 1 if it is.",
    ),
    of(
        "slivers",
        "obstacle-on-slivers",
        "An obstacle problem on the same meshes is solved with the complementarity conditions to 1e-9. No sliver keeps the matrix an M-matrix.",
    ),
    of(
        "slivers",
        "given-meshes",
        "The same on meshes of tetrahedra that the caller gives: the matrix is positive definite, 1 if it is.",
    ),
];

/// Names of the cases.
pub const STABILITY_CASES: [&str; 12] = [
    "round-off",
    "penalty-factor",
    "stretched-cells",
    "graded-meshes",
    "contrast",
    "coercivity",
    "curved-obstacle",
    "biactive",
    "scaling",
    "contact-ends",
    "orders",
    "slivers",
];

/// The criterion of this name.
pub(crate) fn criterion(name: &str) -> Option<&'static Criterion> {
    CRITERIA.iter().find(|c| c.name == name)
}

#[cfg(test)]
mod tests {
    use super::{CRITERIA, STABILITY_CASES};

    #[test]
    fn names_are_unique_and_every_case_has_criteria() {
        for (k, c) in CRITERIA.iter().enumerate() {
            assert!(CRITERIA[..k].iter().all(|other| other.name != c.name), "{}", c.name);
            assert!(STABILITY_CASES.contains(&c.case), "{}", c.case);
        }
        for case in STABILITY_CASES {
            assert!(CRITERIA.iter().any(|c| c.case == case), "{case}");
        }
    }
}

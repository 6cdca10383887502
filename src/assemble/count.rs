//! Counters of work, in unit tests only. They show that the assembly computes no term that a scheme or a scene does
//! not have. In any other build these functions are empty.

macro_rules! counters {
    ($($(#[$doc:meta])* $name:ident)*) => {
        #[cfg(test)]
        mod cells {
            thread_local! {
                $(#[expect(non_upper_case_globals, reason = "named like the function that counts")]
                pub(super) static $name: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };)*
            }
        }
        $($(#[$doc])*
        #[inline(always)]
        pub(crate) fn $name(times: usize) {
            #[cfg(test)]
            cells::$name.with(|c| c.set(c.get() + times));
            #[cfg(not(test))]
            let _ = times;
        })*
        /// The counts on this thread since the last call, by name.
        #[cfg(test)]
        pub(crate) fn take() -> std::collections::BTreeMap<&'static str, usize> {
            std::collections::BTreeMap::from([$((stringify!($name), cells::$name.with(|c| c.take())),)*])
        }
    };
}

counters! {
    /// Facet topology built.
    facet_topologies
    /// Facets at which a form was evaluated.
    facets
    /// Normal derivatives of basis functions.
    normal_derivatives
    /// Points or cells at which the load was evaluated.
    source
    /// Points or cells at which the reaction was evaluated.
    reaction
    /// Cells at which the coefficient was evaluated.
    coefficient
    /// Points at which Neumann data were evaluated.
    neumann
    /// Points at which Dirichlet data were evaluated.
    dirichlet
    /// Nodes at which a bound was evaluated.
    bounds
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::take;
    use crate::assemble::{DataQuadrature, Discretisation};
    use crate::constraint::FacetMeans;
    use crate::mesh::{BoundaryCondition, BoxDomain, Mesh};
    use crate::problem::Problem;
    use crate::real::Point;
    use crate::scheme::{ConformingP1, NonconformingP1, Scheme, Sipg, Wopsip};

    /// The counts of the assembly of an inequality, on one thread.
    fn counted<S: Scheme<2>>(scheme: &S, problem: &Problem<2>) -> BTreeMap<&'static str, usize> {
        let sides = [
            [BoundaryCondition::Dirichlet, BoundaryCondition::Neumann],
            [BoundaryCondition::Contact, BoundaryCondition::Dirichlet],
        ];
        let domain = BoxDomain { lower: Point::zeros(), upper: Point::repeat(1.0), sides };
        let mesh = Mesh::kuhn_box(&domain, [4, 4]).unwrap();
        // a thread of its own, which is its own pool: counters belong to threads
        let work = || {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
            pool.build().unwrap().install(|| {
                let space = Discretisation::new(scheme, problem, &mesh, DataQuadrature::default());
                space.and_then(|space| space.inequality()).unwrap();
                take().into_iter().filter(|&(_, times)| times > 0).collect()
            })
        };
        std::thread::scope(|scope| scope.spawn(work).join().unwrap())
    }

    /// The 4 x 4 box has 32 cells, 40 interior facets, 8 Dirichlet, 4 Neumann and 4 contact ones.
    #[test]
    fn what_a_scheme_or_a_scene_does_not_have_is_not_computed() {
        let bare = Problem::new();
        // conforming P1 with nothing: no facets, no loop over data
        assert_eq!(counted(&ConformingP1, &bare), BTreeMap::new());
        // Crouzeix-Raviart numbers facets, but evaluates no form on them
        assert_eq!(counted(&NonconformingP1, &bare), BTreeMap::from([("facet_topologies", 1)]));
        // each interior facet is seen from its two sides
        let facets = [("facet_topologies", 1), ("facets", 2 * 40 + 8)];
        // WOPSIP computes no normal derivative, in either basis
        assert_eq!(counted(&Wopsip::default(), &bare), BTreeMap::from(facets));
        assert_eq!(
            counted(&Wopsip::default(), &bare.clone().on(FacetMeans)),
            BTreeMap::from(facets)
        );
        // SIPG does, for three functions on each side, of the mean over an edge
        let derivatives = 3 * (2 * 2 * 40 + 8);
        let with_flux = [facets[0], facets[1], ("normal_derivatives", derivatives)];
        assert_eq!(counted(&Sipg::default(), &bare), BTreeMap::from(with_flux));
    }

    #[test]
    fn each_datum_is_computed_where_it_is_and_only_there() {
        let p1 = |problem: Problem<2>| counted(&ConformingP1, &problem);
        let nodes = 25;
        assert_eq!(p1(Problem::new().constant_source(1.0)), BTreeMap::from([("source", 1)]));
        assert_eq!(p1(Problem::new().source(|_| 1.0)), BTreeMap::from([("source", 9 * 32)]));
        assert_eq!(p1(Problem::new().coefficient(|_| 2.0)), BTreeMap::from([("coefficient", 32)]));
        assert_eq!(p1(Problem::new().reaction(1.0)), BTreeMap::from([("reaction", 3 * 32)]));
        assert_eq!(p1(Problem::new().neumann(|_, _| 1.0)), BTreeMap::from([("neumann", 8 * 4)]));
        // Dirichlet data of conforming P1: once at each of the nine vertices of two sides
        assert_eq!(p1(Problem::new().dirichlet(|_| 1.0)), BTreeMap::from([("dirichlet", 9)]));
        assert_eq!(p1(Problem::new().obstacle_below(|_| 0.0)), BTreeMap::from([("bounds", nodes)]));
        assert_eq!(p1(Problem::new().signorini(|_| 0.0)), BTreeMap::from([("bounds", 2 * 4)]));
    }
}

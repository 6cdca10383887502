//! Counts of work done, in unit tests only: that what a scheme or a scene does not have is not
//! computed is shown by counting. In any other build these functions are empty.

macro_rules! counters {
    ($($(#[$doc:meta])* $name:ident)*) => {
        #[cfg(test)]
        thread_local! {
            $(#[allow(non_upper_case_globals, reason = "named like the function that counts")]
            static $name: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };)*
        }
        $($(#[$doc])*
        #[inline(always)]
        pub(crate) fn $name(times: usize) {
            #[cfg(test)]
            $name.with(|c| c.set(c.get() + times));
            #[cfg(not(test))]
            let _ = times;
        })*
        /// What was counted on this thread since the last call, by name.
        #[cfg(test)]
        pub(crate) fn take() -> std::collections::BTreeMap<&'static str, usize> {
            std::collections::BTreeMap::from([$((stringify!($name), $name.with(|c| c.take())),)*])
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

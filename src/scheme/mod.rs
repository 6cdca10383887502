//! Schemes: an element, a facet form and a way to impose Dirichlet data. Nothing else: where an
//! inequality binds is for the [constraint set](crate::constraint).

mod broken;
mod conforming;
mod crouzeix_raviart;
mod definition;
mod energy_order;
mod interior_penalty_methods;
mod ldg;
mod lifting_methods;
mod named_scheme;
mod options;
mod wopsip;

pub use broken::{BrokenScheme, OnElement, WithBrokenElement};
pub use conforming::{ConformingP1, ConformingP2};
pub use crouzeix_raviart::NonconformingP1;
pub use definition::Scheme;
pub use interior_penalty_methods::{Iipg, InteriorPenaltyMethod, Nipg, Sipg};
pub use ldg::Ldg;
pub use lifting_methods::{Bmmpr, Br2, LiftingMethod};
pub use named_scheme::{NamedScheme, SchemeNameError};
pub use options::SchemeOptions;
pub use wopsip::Wopsip;

#[doc(no_inline)]
pub use crate::facet::{DirichletBy, Eta};
pub use crate::theory::{ExpectedOrders, Regularity, Setting};

use crate::element::P2;
use crate::instances::compiled;
use energy_order::{broken_energy_order, energy_order, with_duality};

/// Makes of two lists the names with their summaries, the keys of each, and the function that finds a
/// scheme. A [`BrokenScheme`] has a second name, on quadratics, with a note to its summary.
macro_rules! schemes_by_name {
    (
        $($name:literal, $summary:literal => $scheme:expr;)*
        broken:
        $($broken:literal [$($key:literal),*], $on_linears:literal, $note:literal => $method:expr;)*
    ) => {
        /// Names of the schemes, with one line each.
        pub const SCHEMES: &[(&str, &str)] = &[
            $(($name, $summary),)*
            $(($broken, $on_linears),)*
            $((concat!($broken, "-p2"), concat!($broken, " on broken quadratics", $note)),)*
        ];

        /// The keys that the scheme of this name takes, of those that [`SchemeOptions`] has as fields;
        /// none for an unknown name.
        pub fn keys_of_scheme(name: &str) -> &'static [&'static str] {
            match name.strip_suffix("-p2").unwrap_or(name) {
                $($broken => &[$($key),*],)*
                _ => &[],
            }
        }

        fn made<const D: usize>(
            name: &str,
            options: &SchemeOptions,
        ) -> Option<Box<dyn Scheme<D>>> {
            match name {
                $($name => return Some(Box::new($scheme)),)*
                _ => {}
            }
            match (name.strip_suffix("-p2"), name) {
                $(
                    (None, $broken) => Some(Box::new($method.with_options(options))),
                    (Some($broken), _) => Some(Box::new($method.with_options(options).on(P2))),
                )*
                _ => None,
            }
        }
    };
}

// A scheme gets its name by one entry here: name, keys, summary, note on quadratics, the default scheme.
schemes_by_name! {
    "p1", "conforming linear elements" => ConformingP1;
    "p2", "conforming quadratic elements" => ConformingP2;
    "cr", "Crouzeix-Raviart elements, bounds on facet means" => NonconformingP1;
    broken:
    "sipg" ["factor", "sigma"], "symmetric interior penalty on broken linears", ""
        => Sipg::default();
    "nipg" ["factor", "sigma"], "non-symmetric interior penalty on broken linears", ""
        => Nipg::default();
    "iipg" ["factor", "sigma"], "incomplete interior penalty on broken linears", ""
        => Iipg::default();
    "ldg" ["sigma", "lifts"],
        "local discontinuous Galerkin on broken linears, mean fluxes, lifts of degree k-1", ""
        => Ldg::default();
    "ldg-switch" ["sigma", "lifts"],
        "local discontinuous Galerkin on broken linears, one-sided fluxes, lifts of degree k-1", ""
        => Ldg { switch: true, ..Ldg::default() };
    "br2" ["factor", "lifts"],
        "second method of Bassi and Rebay on broken linears, lifts of degree k-1", ""
        => Br2::default();
    "bmmpr" ["factor", "lifts"],
        "method of Brezzi, Manzini, Marini, Pietra and Russo on broken linears, lifts of degree k-1", ""
        => Bmmpr::default();
    "wopsip" ["factor", "eta", "weight"],
        "weakly over-penalised symmetric interior penalty on broken linears",
        ", moments of degree one: has digits in f64 to level 64 by default, to 8 with eta=1e8"
        => Wopsip::default();
}

/// The scheme of this name.
pub fn scheme_by_name<const D: usize>(
    name: &str,
    options: &SchemeOptions,
) -> Option<Box<dyn Scheme<D>>> {
    compiled!(const D: fn(&str, &SchemeOptions) -> Option<Box<dyn Scheme<D>>>
            = made
    )(name, options)
}

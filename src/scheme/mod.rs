//! Schemes: an element, a facet form and a way to impose Dirichlet data. Nothing else: where an
//! inequality binds is for the [constraint set](crate::constraint).

mod conforming;
mod crouzeix_raviart;
mod definition;
mod energy_order;
mod interior_penalty;
mod ldg;
mod lifting;
mod named_scheme;
mod options;
mod wopsip;

pub use conforming::{ConformingP1, ConformingP2};
pub use crouzeix_raviart::NonconformingP1;
pub use definition::Scheme;
pub use interior_penalty::{Iipg, InteriorPenaltyMethod, Nipg, Sipg};
pub use ldg::{Ldg, LocalFluxes};
pub use lifting::{Bmmpr, Br2};
pub use named_scheme::{NamedScheme, SchemeNameError};
pub use options::SchemeOptions;
pub use wopsip::{Eta, Wopsip};

#[doc(no_inline)]
pub use crate::facet::DirichletBy;
pub use crate::theory::{ExpectedOrders, Regularity, Setting};

use crate::element::P2;
use crate::instances::compiled;
use energy_order::{broken_energy_order, energy_order, with_duality};

/// The name of a scheme on an element of this degree: the name itself for linears, with `-p2` for
/// quadratics, and so on up to the largest degree that an element can have.
macro_rules! name_of_degree {
    ($name:literal, $degree:expr) => {
        match $degree {
            2 => concat!($name, "-p2"),
            3 => concat!($name, "-p3"),
            4 => concat!($name, "-p4"),
            5 => concat!($name, "-p5"),
            6 => concat!($name, "-p6"),
            7 => concat!($name, "-p7"),
            8 => concat!($name, "-p8"),
            9 => concat!($name, "-p9"),
            _ => $name,
        }
    };
}
use name_of_degree;

/// Makes of one list the names with their summaries, the keys of each, and the function that finds a
/// scheme.
macro_rules! schemes_by_name {
    ($options:ident: $($name:literal [$($key:literal),*], $summary:literal => $scheme:expr;)*) => {
        /// Names of the schemes, with one line each.
        pub const SCHEMES: &[(&str, &str)] = &[$(($name, $summary)),*];

        /// The keys that the scheme of this name takes, of those that [`SchemeOptions`] has as fields;
        /// none for an unknown name.
        pub fn keys_of_scheme(name: &str) -> &'static [&'static str] {
            match name {
                $($name => &[$($key),*],)*
                _ => &[],
            }
        }

        fn made<const D: usize>(
            name: &str,
            $options: &SchemeOptions,
        ) -> Option<Box<dyn Scheme<D>>> {
            match name {
                $($name => Some(Box::new($scheme)),)*
                _ => None,
            }
        }
    };
}

// A scheme gets its name by one entry here: name, keys, summary, constructor from the options.
schemes_by_name! { options:
    "p1" [], "conforming linear elements" => ConformingP1;
    "p2" [], "conforming quadratic elements" => ConformingP2;
    "cr" [], "Crouzeix-Raviart elements, bounds on facet means" => NonconformingP1;
    "sipg" ["factor", "sigma"], "symmetric interior penalty on broken linears"
        => Sipg::with_options(options);
    "nipg" ["factor", "sigma"], "non-symmetric interior penalty on broken linears"
        => Nipg::with_options(options);
    "iipg" ["factor", "sigma"], "incomplete interior penalty on broken linears"
        => Iipg::with_options(options);
    "ldg" ["sigma", "lifts"],
        "local discontinuous Galerkin on broken linears, mean fluxes, lifts of degree k-1"
        => Ldg::with_options(options, false);
    "ldg-switch" ["sigma", "lifts"],
        "local discontinuous Galerkin on broken linears, one-sided fluxes, lifts of degree k-1"
        => Ldg::with_options(options, true);
    "br2" ["factor", "lifts"],
        "second method of Bassi and Rebay on broken linears, lifts of degree k-1"
        => Br2::with_options(options);
    "bmmpr" ["factor", "lifts"],
        "method of Brezzi, Manzini, Marini, Pietra and Russo on broken linears, lifts of degree k-1"
        => Bmmpr::with_options(options);
    "wopsip" ["factor", "eta", "weight"],
        "weakly over-penalised symmetric interior penalty on broken linears"
        => Wopsip::with_options(options);
    "sipg-p2" ["factor", "sigma"], "sipg on broken quadratics"
        => Sipg::with_options(options).on(P2);
    "nipg-p2" ["factor", "sigma"], "nipg on broken quadratics"
        => Nipg::with_options(options).on(P2);
    "iipg-p2" ["factor", "sigma"], "iipg on broken quadratics"
        => Iipg::with_options(options).on(P2);
    "ldg-p2" ["sigma", "lifts"], "ldg on broken quadratics"
        => Ldg::with_options(options, false).on(P2);
    "ldg-switch-p2" ["sigma", "lifts"], "ldg-switch on broken quadratics"
        => Ldg::with_options(options, true).on(P2);
    "br2-p2" ["factor", "lifts"], "br2 on broken quadratics"
        => Br2::with_options(options).on(P2);
    "bmmpr-p2" ["factor", "lifts"], "bmmpr on broken quadratics"
        => Bmmpr::with_options(options).on(P2);
    "wopsip-p2" ["factor", "eta", "weight"], "wopsip on broken quadratics, moments of degree one: has digits in f64 to level 64 by default, to 8 with eta=1e8"
        => Wopsip::with_options(options).on(P2);
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

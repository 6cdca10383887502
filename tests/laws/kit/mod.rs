//! Every scheme passes the kit, in every dimension; broken ones are caught by the law
//! that is meant for them.

mod broken_schemes;
mod elements;
mod laws;
mod quadratics;

use unilateral::kit::{Law, check_law, check_scheme_on};
use unilateral::prelude::*;

/// A test for each line: a name, how the scheme is made, and the constraint set if not the nodes.
macro_rules! schemes {
    (@set) => { Nodes };
    (@set $set:expr) => { $set };
    ($($name:ident: $scheme:expr $(, $set:expr)?;)*) => {
        $(
            #[test]
            fn $name() {
                fn on<const D: usize>(scheme: &dyn Scheme<D>) {
                    let report = check_scheme_on(scheme, schemes!(@set $($set)?));
                    let report = report.unwrap_or_else(|e| panic!("{e}"));
                    assert_eq!(report.dimension, D);
                    println!("{report}");
                }
                on::<1>(&$scheme);
                on::<2>(&$scheme);
                on::<3>(&$scheme);
            }
        )*
    };
}

schemes! {
    conforming: ConformingP1;
    crouzeix_raviart: NonconformingP1;
    sipg: Sipg::default();
    sipg_by_diameter: Sipg { penalty: PenaltyRule::Diameter(10.0) };
    sipg_on_means: Sipg::default(), FacetMeans;
    nipg: Nipg::default();
    iipg: Iipg::default();
    ldg: Ldg::default();
    ldg_one_sided: Ldg { switch: true, ..Ldg::default() };
    br2: Br2::default();
    bmmpr: Bmmpr::default();
    ldg_full: Ldg { lifts: Lifts::Full, ..Ldg::default() };
    br2_full: Br2 { lifts: Lifts::Full, ..Br2::default() };
    bmmpr_full: Bmmpr { lifts: Lifts::Full, ..Bmmpr::default() };
    bmmpr_on_means: Bmmpr::default(), FacetMeans;
    wopsip: Wopsip::default();
    wopsip_anisotropic: Wopsip { weight: WeightRule::Anisotropic, ..Wopsip::default() };
    wopsip_on_means: Wopsip::default(), FacetMeans;
    conforming_quadratics: ConformingP2;
    sipg_on_quadratics: Sipg::default().on(P2);
    nipg_on_quadratics: Nipg::default().on(P2);
    iipg_on_quadratics: Iipg::default().on(P2);
    ldg_on_quadratics: Ldg::default().on(P2);
    ldg_one_sided_on_quadratics: Ldg { switch: true, ..Ldg::default() }.on(P2);
    br2_on_quadratics: Br2::default().on(P2);
    bmmpr_on_quadratics: Bmmpr::default().on(P2);
    bmmpr_full_on_quadratics: Bmmpr { lifts: Lifts::Full, ..Bmmpr::default() }.on(P2);
}

/// The weight of order `h^-5` makes a condition of order `h^-6`: the law that solutions do not depend
/// on numbering beyond rounding allows less than that. All other laws hold.
#[test]
fn wopsip_on_quadratics() {
    fn on<const D: usize>() {
        let scheme = Wopsip::default().on(P2);
        for law in [Law::Symmetry, Law::Coercivity, Law::Consistency, Law::Orders] {
            let report = check_law::<D>(law, &scheme).unwrap_or_else(|e| panic!("{e}"));
            let declared = report.to_string().contains("not consistent");
            assert_eq!(declared, law == Law::Consistency, "{report}");
        }
    }
    on::<1>();
    on::<2>();
    on::<3>();
}

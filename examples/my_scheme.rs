//! A scheme in one file: the incomplete interior penalty method, held to the laws of every scheme,
//! then beside two schemes of the library. `cargo run --release --example my_scheme` writes tables and plots to
//! `target/my_scheme`.
//!
//! C. Dawson, S. Sun, M. F. Wheeler, Comput. Methods Appl. Mech. Engrg. 193 (2004), 2565-2580.

use std::sync::Arc;

use unilateral::kit::check_scheme;
use unilateral::prelude::*;

/// `sigma alpha_F / h_F [u][v] - {alpha d_n u}[v]`: no symmetrising term. The penalty that is provably enough for a
/// symmetric form is [`proven_bound`].
struct Incomplete(f64);

impl<const D: usize> FacetForm<D> for Incomplete {
    fn is_symmetric(&self) -> bool {
        false
    }
    fn penalty(&self, facet: &FacetView<D>) -> f64 {
        self.0 * facet.coefficient() / facet.diameter()
    }
    fn integrand(&self, _: &FacetView<D>, v: Trace, u: Trace, penalty: f64) -> f64 {
        penalty * u.jump * v.jump - u.flux * v.jump
    }
}

/// A name, an element and a facet form, which imposes Dirichlet data too.
struct MyIipg(f64);

impl<const D: usize> Scheme<D> for MyIipg {
    fn name(&self) -> &str {
        "my-iipg"
    }
    fn element(&self) -> Arc<dyn Element<D>> {
        Arc::new(Broken(P1))
    }
    fn form(&self, _: &Mesh<D>) -> Box<dyn FacetForm<D>> {
        Box::new(Incomplete(self.0))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    print!("{}", check_scheme::<2>(&MyIipg(10.0))?);
    let report = Study::<2>::new(scenes::radial(1.0))
        .scheme(ConformingP1)
        .scheme(Sipg::default())
        .scheme(MyIipg(10.0))
        .levels([8, 16, 32])
        .run()?;
    print!("{report}");
    report.write("target/my_scheme")?;
    Ok(())
}

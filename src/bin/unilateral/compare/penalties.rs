//! Penalty factors: which schemes take them.

use unilateral::facet::PenaltyParameters;
use unilateral::mesh::BoxDomain;
use unilateral::mesh::Mesh;
use unilateral::real::Point;
use unilateral::scheme::{SchemeOptions, scheme_by_name};

use super::options::Options;
use crate::shared::Request;

/// What the options say of schemes.
pub fn scheme_options(options: &Options) -> SchemeOptions {
    SchemeOptions { sigma: options.sigma, eta: options.eta }
}

/// Refuses a penalty factor that none of the schemes chosen takes. A scheme takes a factor if its
/// parameters on a small mesh contain it.
pub fn check_penalties(options: &Options, chosen: &[String], names: &[&str]) -> Request<()> {
    let square = BoxDomain::dirichlet(Point::zeros(), Point::repeat(1.0));
    let mesh = Mesh::<f64, 2>::kuhn_box(&square, [1, 1]).map_err(|e| e.to_string())?;
    let scheme_options = scheme_options(options);
    let in_force = |name: &str| {
        let scheme = scheme_by_name::<f64, 2>(name, &scheme_options);
        scheme.map_or_else(PenaltyParameters::default, |scheme| scheme.parameters(&mesh))
    };
    type Factor = fn(&PenaltyParameters) -> Option<f64>;
    let factors: [(&str, Option<f64>, Factor); 2] =
        [("sigma", options.sigma, |p| p.sigma), ("eta", options.eta, |p| p.eta)];
    for (parameter, given, factor) in factors {
        let takes = |name: &&str| factor(&in_force(name)) == given;
        let takers: Vec<&str> = names.iter().copied().filter(takes).collect();
        match given {
            Some(x) if !chosen.iter().any(|name| takers.contains(&&name[..])) => {
                return Err(format!(
                    "--{parameter} {x:?}: none of the schemes chosen takes it; there are: {}",
                    takers.join(", ")
                ));
            }
            _ => {}
        }
    }
    Ok(())
}

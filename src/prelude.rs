//! What a program that compares schemes needs, in one line.

pub use crate::element::{Broken, CrouzeixRaviart, P1, P2, ReferenceElement};
pub use crate::error::Error;
pub use crate::facet::{FacetForm, FacetView, NoFacets, PenaltyRule, Trace, WeightRule};
pub use crate::mesh::{BoundaryPart, Mesh};
pub use crate::nested::AnyScheme;
pub use crate::problem::Problem;
pub use crate::real::{Point, Real};
pub use crate::scenes;
pub use crate::scheme::{
    Bmmpr, Br2, CellMeans, ConformingP1, ConformingP2, DirichletBy, Eta, FacetMeans, Iipg, Ldg,
    Midpoints, Nipg, NonconformingP1, Scheme, Sipg, Wopsip,
};
pub use crate::study::{Report, Study};

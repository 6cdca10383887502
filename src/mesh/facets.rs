//! Facets.
/// stub
pub struct Facets;
/// stub
pub struct Neighbour;
/// stub
pub struct Neighbours;

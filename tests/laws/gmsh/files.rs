//! The meshes of the folder of test data.

/// The unit square, version 4 of the format.
pub const SQUARE: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/square.msh"));
/// The unit square, version 2 of the format.
pub const SQUARE_V2: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/square_v2.msh"));
/// An interval of three cells.
pub const INTERVAL: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/interval.msh"));
/// A tetrahedron.
pub const TETRAHEDRON: &str =
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/tetrahedron.msh"));

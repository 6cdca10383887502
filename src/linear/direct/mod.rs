//! Sparse factors, orders of elimination, and static condensation of over-penalties.

pub(crate) mod elimination;
pub(crate) mod factors;
pub(crate) mod kernels;
pub(crate) mod nested_dissection;
pub(crate) mod static_condensation;

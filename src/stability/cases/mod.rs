//! The cases of the stability study, one file each.

pub(crate) mod anisotropy;
pub(crate) mod biactive;
pub(crate) mod coercivity;
pub(crate) mod condition;
pub(crate) mod contact_ends;
pub(crate) mod contrast;
pub(crate) mod curved_obstacle;
pub(crate) mod grading;
pub(crate) mod orders;
pub(crate) mod over_penalty;
pub(crate) mod round_off;
pub(crate) mod scaling;
pub(crate) mod slivers;

//! What the table of a case is made of.

pub(crate) use super::at::At;
pub(crate) use super::case::{Asked, Case, Column, Criterion, Effort, Plan, Sweep};
pub(crate) use super::place::{ENERGY, H1, JUMPS, L2, Norm, Place, schemes, with_eta};
pub(crate) use super::row::ExpectedRange;
pub(crate) use crate::error::Error;
pub(crate) use crate::scenes::{self, Scene, sines};

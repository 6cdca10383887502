//! Errors between parts.

use crate::error::Error;
use crate::inequality::Outcome;
use crate::readable_debug::debug_by_display;

/// Why parts of a mesh did not tell one another what they need. `Debug` prints the message.
///
/// An error that [`agree`](super::agree) has made one of all parts is [`ExchangeError::Failed`] in all of them. After
/// another one parts may be at different places; none of them exchanges anything any more.
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// The lowest part that failed, and its error.
    #[error("part {part}: {message}")]
    Failed {
        /// The part.
        part: u32,
        /// The message of its error.
        message: String,
        /// The outcome that an error of the data stands for; none for other errors.
        outcome: Option<Outcome>,
    },
    /// The process or thread of a part has ended.
    #[error("part {part} has ended without this exchange: look for its error")]
    Ended {
        /// The part.
        part: u32,
    },
    /// A part sent another number of numbers than it has to.
    #[error(
        "part {part} sent {found} numbers in place of {expected}: all parts call the same functions in the same order"
    )]
    Length {
        /// The part.
        part: u32,
        /// How many numbers it sent.
        found: usize,
        /// How many are expected.
        expected: usize,
    },
    /// There is not one list for each part.
    #[error("{lists} lists are sent to {parts} parts: there must be one for each")]
    Lists {
        /// Number of lists.
        lists: usize,
        /// Number of parts.
        parts: usize,
    },
    /// A part is asked for the unknowns of a cell that it does not own.
    #[error(
        "part {owner} has no cell {cell} of the whole mesh, which it owns for part {part}: take all parts of one mesh with the same owners of its cells, and refine all as often"
    )]
    NotOwned {
        /// The part that asks.
        part: u32,
        /// The part that is asked.
        owner: u32,
        /// The number of the cell in the whole mesh.
        cell: u64,
    },
    /// The owner of a cell does not know who numbers its unknowns.
    #[error(
        "part {owner} has no number for an unknown of its cell {cell} of the whole mesh: take parts with as many layers as the scheme asks for"
    )]
    NotNumbered {
        /// The part that owns the cell.
        owner: u32,
        /// The number of the cell in the whole mesh.
        cell: u64,
    },
    /// What carries the lists failed.
    #[error("the exchange between parts failed: {why}")]
    Transport {
        /// The cause.
        why: String,
    },
}

debug_by_display!(ExchangeError);

impl From<ExchangeError> for Error {
    fn from(error: ExchangeError) -> Self {
        Self::Processes(Box::new(error))
    }
}

impl ExchangeError {
    /// The outcome that an error stands for: of [`Error::Processes`] that of the part that failed.
    pub(crate) fn outcome_of(error: &Error) -> Option<Outcome> {
        let Error::Processes(why) = error else { return Outcome::of_error(error) };
        match why.downcast_ref::<Self>() {
            Some(Self::Failed { outcome, .. }) => *outcome,
            _ => None,
        }
    }
}

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
    #[error("{0}")]
    Ended(String),
    /// A part sent another number of numbers than it has to.
    #[error("{0}")]
    Length(String),
    /// There is not one list for each part.
    #[error("{0}")]
    Lists(String),
    /// A part is asked for the unknowns of a cell that it does not own.
    #[error("{0}")]
    NotOwned(String),
    /// The owner of a cell does not know who numbers its unknowns.
    #[error("{0}")]
    NotNumbered(String),
    /// What carries the lists failed.
    #[error("the exchange between parts failed: {0}")]
    Transport(String),
}

debug_by_display!(ExchangeError);

impl From<ExchangeError> for Error {
    fn from(error: ExchangeError) -> Self {
        Self::Processes(Box::new(error))
    }
}

impl ExchangeError {
    /// So many lists, not one for each of these parts.
    pub(crate) fn lists(lists: usize, parts: usize) -> Self {
        Self::Lists(format!("{lists} lists are sent to {parts} parts: there must be one for each"))
    }
    /// The outcome that an error stands for: of [`Error::Processes`] that of the part that failed.
    pub(crate) fn outcome_of(error: &Error) -> Option<Outcome> {
        let Error::Processes(why) = error else { return Outcome::of_error(error) };
        match why.downcast_ref::<Self>() {
            Some(Self::Failed { outcome, .. }) => *outcome,
            _ => None,
        }
    }
}

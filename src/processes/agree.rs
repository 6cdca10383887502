//! An error of one part becomes an error of all.

use std::fmt::Display;

use super::error::ExchangeError;
use super::exchange::Exchange;
use crate::error::Error;
use crate::inequality::Outcome;

/// The result of this part if no part failed, else in every part the same error: that of the lowest part that
/// failed, with its message. All parts call it, after a step that may fail in one of them and before the next
/// exchange, for which a part that has left would let the others wait.
///
/// ```
/// use unilateral::processes::{agree, in_process};
///
/// let results = in_process(3, |part, exchange| {
///     let own = if part == 1 { Err("no memory") } else { Ok(part) };
///     agree(own, exchange)
/// });
/// assert!(results.iter().all(|result| result.as_ref().unwrap_err().to_string() == "part 1: no memory"));
/// ```
///
/// # Errors
/// [`ExchangeError::Failed`], and those of the exchange.
pub fn agree<T, E: Display>(
    result: Result<T, E>,
    exchange: &dyn Exchange,
) -> Result<T, ExchangeError> {
    agree_on(result, |_| None, exchange)
}

/// As [`agree`], with the outcome that the error of the data stands for, and cells by their numbers in the whole mesh.
pub(crate) fn agree_on_data<T>(
    result: Result<T, Error>,
    cells: &[u64],
    exchange: &dyn Exchange,
) -> Result<T, ExchangeError> {
    agree_on(result.map_err(|error| error.in_whole_mesh(cells)), Outcome::of_error, exchange)
}

fn agree_on<T, E: Display>(
    result: Result<T, E>,
    outcome_of: impl Fn(&E) -> Option<Outcome>,
    exchange: &dyn Exchange,
) -> Result<T, ExchangeError> {
    let own = result.as_ref().err().map(|error| (error.to_string(), outcome_of(error)));
    let words = own.as_ref().map_or(Vec::new(), |(text, outcome)| words_of(text, *outcome));
    let received = exchange.exchange(vec![words; exchange.parts()])?;
    let failed = (0..).zip(&received).find(|(_, words)| !words.is_empty());
    match (failed, result) {
        (Some((part, words)), _) => {
            let (message, outcome) = text_of(words);
            Err(ExchangeError::Failed { part, message, outcome })
        }
        (None, Ok(value)) => Ok(value),
        (None, Err(own)) => {
            Err(ExchangeError::Transport(format!("this error did not reach the parts: {own}")))
        }
    }
}

/// The outcomes that errors of data stand for; numbers of outcomes are one more than places here.
const OUTCOMES: [Outcome; 4] =
    [Outcome::NotCoercive, Outcome::NotFinite, Outcome::Infeasible, Outcome::OutOfRange];

/// The number of an outcome, the length of a text and its bytes.
fn words_of(text: &str, outcome: Option<Outcome>) -> Vec<u64> {
    let bytes = text.as_bytes();
    let word =
        |bytes: &[u8]| (0..).zip(bytes).fold(0, |word, (k, &b)| word | u64::from(b) << (8 * k));
    let number = OUTCOMES.iter().position(|&known| Some(known) == outcome).map_or(0, |k| k + 1);
    [number as u64, bytes.len() as u64].into_iter().chain(bytes.chunks(8).map(word)).collect()
}

/// The text of these words, and the outcome.
fn text_of(words: &[u64]) -> (String, Option<Outcome>) {
    let [number, length, words @ ..] = words else { return (String::new(), None) };
    let mut bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    bytes.truncate(usize::try_from(*length).unwrap_or(usize::MAX));
    let outcome = usize::try_from(*number).ok().and_then(|k| OUTCOMES.get(k.checked_sub(1)?));
    (String::from_utf8_lossy(&bytes).into_owned(), outcome.copied())
}

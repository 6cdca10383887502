//! An error of one part becomes an error of all.

use std::fmt::Display;

use super::error::ExchangeError;
use super::exchange::Exchange;

/// The result of this part if no part failed, else in every part the same error: that of the lowest part that
/// failed, with its message. All parts call it, after a step that may fail in one of them and before the next
/// exchange, for which a part that has left would let the others wait.
///
/// ```
/// use unilateral::distributed::{agree, in_process};
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
    let own = result.as_ref().err().map(ToString::to_string);
    let words = own.as_deref().map_or(Vec::new(), words_of);
    let received = exchange.exchange(vec![words; exchange.parts()])?;
    let failed = (0..).zip(&received).find(|(_, words)| !words.is_empty());
    match (failed, result) {
        (Some((part, words)), _) => Err(ExchangeError::Failed { part, message: text_of(words) }),
        (None, Ok(value)) => Ok(value),
        (None, Err(own)) => Err(ExchangeError::Transport {
            why: format!("this error did not reach the parts: {own}"),
        }),
    }
}

/// The length of a text and its bytes.
fn words_of(text: &str) -> Vec<u64> {
    let bytes = text.as_bytes();
    let word =
        |bytes: &[u8]| (0..).zip(bytes).fold(0, |word, (k, &b)| word | u64::from(b) << (8 * k));
    std::iter::once(bytes.len() as u64).chain(bytes.chunks(8).map(word)).collect()
}

/// The text of these words.
fn text_of(words: &[u64]) -> String {
    let [length, words @ ..] = words else { return String::new() };
    let mut bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    bytes.truncate(usize::try_from(*length).unwrap_or(usize::MAX));
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_any_length_are_words() {
        let long = "λ₁ ≥ 0 in cell 18446744073709551615".repeat(9);
        for text in ["", "a", "of eight", "of nine b", &long] {
            assert!(!words_of(text).is_empty());
            assert_eq!(text_of(&words_of(text)), text);
        }
        // what no part sends
        assert_eq!(text_of(&[]), "");
        assert_eq!(text_of(&[u64::MAX, 0x61]), "a\0\0\0\0\0\0\0");
    }
}

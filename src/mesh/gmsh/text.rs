//! Words and numbers of text.

use super::error::GmshError;
use super::source::Source;
use crate::input::excerpt;

impl<'a> Source<'a> {
    /// Skips blanks and ends of lines.
    pub(super) fn skip_blank_lines(&mut self) {
        while let Some(byte) = self.peek() {
            if !byte.is_ascii_whitespace() {
                break;
            }
            self.line += usize::from(byte == b'\n');
            self.at += 1;
        }
    }
    pub(super) fn skip_blanks(&mut self) {
        while self.peek().is_some_and(|byte| byte != b'\n' && byte.is_ascii_whitespace()) {
            self.at += 1;
        }
    }
    /// The next word of the line; empty at the end of the line.
    pub(super) fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        self.last = self.at;
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }
    /// The rest of the line, without its end; the next byte to read is the first of the next line.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at += length.map_or(rest.len(), |n| n + 1);
        self.line += usize::from(length.is_some());
        &rest[..length.unwrap_or(rest.len())]
    }
    pub(super) fn number_word(&mut self, expected: &'static str) -> Result<&'a [u8], GmshError> {
        let word = self.word();
        if !word.is_empty() {
            return Ok(word);
        }
        Err(match self.peek() {
            None => self.truncated(),
            Some(_) => self.unexpected(expected, "the end of the line"),
        })
    }
    pub(super) fn not_a_number(&self, expected: &'static str, word: &[u8]) -> GmshError {
        GmshError::NotANumber {
            position: self.position(),
            section: self.section_name(),
            expected,
            word: excerpt(word),
        }
    }
    /// A number without sign, written as text also in binary files.
    pub(super) fn text_count(&mut self, expected: &'static str) -> Result<u64, GmshError> {
        let word = self.number_word(expected)?;
        parse_digits(word).ok_or_else(|| self.not_a_number(expected, word))
    }
    /// An integer, written as text also in binary files.
    pub(super) fn text_integer(&mut self, expected: &'static str) -> Result<i64, GmshError> {
        let word = self.number_word(expected)?;
        let (negative, digits) = match word {
            [b'-', digits @ ..] => (true, digits),
            digits => (false, digits),
        };
        parse_digits(digits)
            .and_then(|value| i64::try_from(value).ok())
            .map(|value| if negative { -value } else { value })
            .ok_or_else(|| self.not_a_number(expected, word))
    }
    pub(super) fn text_real(&mut self, expected: &'static str) -> Result<f64, GmshError> {
        let word = self.number_word(expected)?;
        let number = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        number.ok_or_else(|| self.not_a_number(expected, word))
    }
    /// An error if the line of text has more words.
    pub(super) fn end_line(&mut self) -> Result<(), GmshError> {
        match self.word() {
            [] => Ok(()),
            word => Err(self.unexpected("the end of the line", format!("`{}`", excerpt(word)))),
        }
    }
}

fn parse_digits(word: &[u8]) -> Option<u64> {
    if word.is_empty() {
        return None;
    }
    word.iter().try_fold(0u64, |value, &byte| {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return None;
        }
        value.checked_mul(10)?.checked_add(u64::from(digit))
    })
}

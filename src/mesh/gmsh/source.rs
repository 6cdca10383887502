//! Words and numbers of a file, text or binary.
//!
//! Text is read record by record, one per line, so that a missing number is reported on its own line. What is read
//! is known by its offset in bytes; lines are counted when an error is made.

use std::fmt::Display;
use std::str::FromStr;

use super::error::{GmshError, GmshErrorKind, place};
use crate::input::excerpt;

/// The bytes of a file, and how far they are read.
pub(super) struct Source<'a> {
    bytes: &'a [u8],
    /// The next byte to read.
    at: usize,
    /// The first byte of the word or number read last.
    last: usize,
    /// Whether the numbers of the sections are bytes, the lowest first.
    pub is_binary: bool,
    /// Whether the version is 4.1, not 2.2: tags have eight bytes, not four.
    pub is_four: bool,
    /// The section that is being read.
    pub section: String,
}

impl<'a> Source<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        // Editors put a byte order mark in front of text.
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Source { bytes, at, last: at, is_binary: false, is_four: false, section: String::new() }
    }
    /// The offset of the next byte to read.
    pub fn offset(&self) -> usize {
        self.at
    }
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }
    pub fn is_at_end(&self) -> bool {
        self.at == self.bytes.len()
    }

    // Errors.

    /// An error at the word or number read last.
    pub fn error(&self, kind: GmshErrorKind, message: &str) -> GmshError {
        let place = place(self.last, self.bytes, self.is_binary);
        GmshError::new(kind, format!("{place}: {message}"))
    }
    /// An error about something else than what is expected.
    pub fn unexpected(&self, expected: &str, found: impl Display) -> GmshError {
        let message = format!(
            "section {}: expected {expected}, found {found}; correct the file or save the mesh again",
            excerpt(&self.section)
        );
        self.error(GmshErrorKind::Damaged, &message)
    }
    /// An error about another word than what is expected, or about the end of the file.
    pub fn unexpected_word(&self, expected: &str, word: &[u8]) -> GmshError {
        match word {
            [] if self.is_at_end() => self.unexpected(expected, "the end of the file"),
            [] => self.unexpected(expected, "the end of the line"),
            word => self.unexpected(expected, format_args!("`{}`", excerpt(word))),
        }
    }

    // Words.

    /// Skips blanks and ends of lines.
    pub fn skip_blank_lines(&mut self) {
        self.at += self.rest().iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        self.last = self.at;
    }
    /// The next word of the line; empty at the end of the line.
    pub fn word(&mut self) -> &'a [u8] {
        let is_blank = |byte: &&u8| **byte != b'\n' && byte.is_ascii_whitespace();
        self.at += self.rest().iter().take_while(is_blank).count();
        self.last = self.at;
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }
    /// The rest of the line, without its end; the next byte to read is the first of the next line.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at += length.map_or(rest.len(), |n| n + 1);
        &rest[..length.unwrap_or(rest.len())]
    }
    /// Ends a line of text; the numbers of a binary file begin after it.
    pub fn end_line(&mut self) -> Result<(), GmshError> {
        let word = self.word();
        if !word.is_empty() {
            return Err(self.unexpected_word("the end of the line", word));
        }
        if self.is_binary {
            self.rest_of_line();
        }
        Ok(())
    }
    /// Moves to the line of the next record of text, after the end of that of the last one.
    pub fn record(&mut self, what: &str) -> Result<(), GmshError> {
        if self.is_binary {
            return Ok(());
        }
        self.end_line()?;
        self.skip_blank_lines();
        match self.rest().first() {
            None | Some(b'$') => {
                let word = self.word();
                Err(self.unexpected_word(what, word))
            }
            Some(_) => Ok(()),
        }
    }

    // Numbers.

    /// A number that is text also in binary files.
    #[inline]
    pub fn text<V: FromStr>(&mut self, expected: &str) -> Result<V, GmshError> {
        let word = self.word();
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| self.unexpected_word(expected, word))
    }
    /// Reads a count on a line of its own. Counts are text in binary files too.
    pub fn line_of_count(&mut self, expected: &str) -> Result<u64, GmshError> {
        self.skip_blank_lines();
        let count = self.text(expected)?;
        self.end_line()?;
        Ok(count)
    }
    /// A number in the encoding of the file, by the function that makes it of bytes.
    #[inline(always)]
    fn number<V: FromStr, const N: usize>(
        &mut self,
        expected: &str,
        of_bytes: fn([u8; N]) -> V,
    ) -> Result<V, GmshError> {
        if self.is_binary { self.array(expected).map(of_bytes) } else { self.text(expected) }
    }
    fn array<const N: usize>(&mut self, expected: &str) -> Result<[u8; N], GmshError> {
        self.last = self.at;
        self.skip(1, N, expected)?;
        Ok(*self.bytes[self.last..].first_chunk().expect("so many bytes were skipped"))
    }
    /// An unsigned number of eight bytes.
    #[inline]
    pub fn count(&mut self, expected: &str) -> Result<u64, GmshError> {
        self.number(expected, u64::from_le_bytes)
    }
    /// An integer of four bytes.
    #[inline]
    pub fn integer(&mut self, expected: &str) -> Result<i64, GmshError> {
        self.number(expected, |bytes| i32::from_le_bytes(bytes).into())
    }
    /// The tag of a node or element.
    #[inline]
    pub fn tag(&mut self, expected: &str) -> Result<u64, GmshError> {
        if self.is_four {
            return self.count(expected);
        }
        let value = self.integer(expected)?;
        u64::try_from(value).map_err(|_| self.unexpected(expected, format_args!("`{value}`")))
    }
    /// The coordinates of a node, which must be finite.
    pub fn point(&mut self, node: u64) -> Result<[f64; 3], GmshError> {
        let mut point = [0.0; 3];
        for (x, name) in point.iter_mut().zip(["coordinate x", "coordinate y", "coordinate z"]) {
            *x = self.number(name, f64::from_le_bytes)?;
            if !x.is_finite() {
                let message = format!(
                    "{name} of node {node} is {x}; coordinates must be finite, correct the geometry and mesh again"
                );
                return Err(self.error(GmshErrorKind::Node, &message));
            }
        }
        Ok(point)
    }
    /// Skips `count` numbers, each of `size` bytes in a binary file.
    pub fn skip(&mut self, count: u64, size: usize, expected: &str) -> Result<(), GmshError> {
        if !self.is_binary {
            return (0..count).try_for_each(|_| self.text::<f64>(expected).map(|_| ()));
        }
        let length = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
        let Some(length) = length.filter(|&length| length <= self.rest().len()) else {
            self.last = self.bytes.len();
            return Err(self.unexpected(expected, "the end of the file"));
        };
        self.at += length;
        Ok(())
    }
    /// Skips `count` tags of nodes.
    pub fn skip_tags(&mut self, count: usize) -> Result<(), GmshError> {
        self.skip(count as u64, if self.is_four { 8 } else { 4 }, "the tag of a node")
    }

    // Sections.

    fn section_end(&self) -> String {
        format!("$End{}", self.section.trim_start_matches('$'))
    }
    /// Reads the end of a section after its last record.
    pub fn end_section(&mut self) -> Result<(), GmshError> {
        self.skip_blank_lines();
        let end = self.section_end();
        match self.word() {
            word if word == end.as_bytes() => Ok(()),
            word => Err(self.unexpected_word(&format!("`{}`", excerpt(&end)), word)),
        }
    }
    /// Skips a section, up to the end of its last line.
    pub fn skip_section(&mut self) -> Result<(), GmshError> {
        let end = self.section_end();
        loop {
            let found = self.rest().windows(end.len()).position(|bytes| bytes == end.as_bytes());
            let Some(length) = found else {
                self.last = self.bytes.len();
                return Err(self.unexpected(&excerpt(&end), "the end of the file"));
            };
            self.at += length + end.len();
            // $EndNode is a prefix of $EndNodeData.
            if self.rest().first().is_none_or(u8::is_ascii_whitespace) {
                return Ok(());
            }
        }
    }
    /// Reads the byte order mark of a binary file.
    pub fn read_byte_order(&mut self) -> Result<(), GmshError> {
        self.is_binary = true;
        self.rest_of_line();
        let mark =
            "the integer 1 as byte order mark, lowest byte first (was the file copied as text?)";
        match self.array(mark)? {
            [1, 0, 0, 0] => Ok(()),
            found => Err(self.unexpected(mark, format_args!("bytes {found:?}"))),
        }
    }
}

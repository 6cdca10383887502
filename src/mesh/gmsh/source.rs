//! Numbers of a file, text or binary.
//!
//! Text is read record by record, one per line, so that a missing number is reported on its own line.

use super::error::GmshError;
use super::position::FilePosition;
use crate::input::excerpt;

/// The encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The bytes of a file, and how far they are read.
pub(super) struct Source<'a> {
    pub(super) bytes: &'a [u8],
    /// The next byte to read.
    pub(super) at: usize,
    /// The line it is on, counted from one.
    pub(super) line: usize,
    /// The first byte of the word or number read last.
    pub(super) last: usize,
    /// The encoding of the numbers of the sections.
    pub(super) encoding: Encoding,
    /// The section that is being read.
    pub(super) section: String,
}

impl<'a> Source<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        // Editors put a byte order mark in front of text.
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Source { bytes, at, line: 1, last: at, encoding: Encoding::Text, section: String::new() }
    }
    pub(super) fn is_binary(&self) -> bool {
        self.encoding != Encoding::Text
    }
    /// The present position as a number, of which [`Source::position_of`] makes a position.
    pub(super) fn mark(&self) -> usize {
        if self.is_binary() { self.at } else { self.line }
    }
    /// The position with this number: a line of a text file, a byte of a binary one.
    pub(super) fn position_of(&self, mark: usize) -> FilePosition {
        if self.is_binary() { FilePosition::Byte(mark) } else { FilePosition::Line(mark) }
    }
    /// The position of the word or number read last.
    pub(super) fn position(&self) -> FilePosition {
        self.position_of(if self.is_binary() { self.last } else { self.line })
    }
    /// Number of bytes not yet read.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }
    pub(super) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    /// The name of the section that is being read, for messages.
    pub(super) fn section_name(&self) -> String {
        excerpt(&self.section)
    }

    // Errors at the present position.

    pub(super) fn truncated(&self) -> GmshError {
        let position =
            self.position_of(if self.is_binary() { self.bytes.len() } else { self.line });
        GmshError::Truncated { position, section: self.section_name() }
    }
    pub(super) fn unexpected(
        &self,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> GmshError {
        GmshError::Unexpected {
            position: self.position(),
            section: self.section_name(),
            expected: expected.into(),
            found: found.into(),
        }
    }
    pub(super) fn miscounted(
        &self,
        what: &'static str,
        announced: u64,
        found: impl Into<String>,
    ) -> GmshError {
        let (position, section) = (self.position(), self.section_name());
        GmshError::Count { position, section, what, announced, found: found.into() }
    }

    /// An unsigned number of eight bytes: a count, or a tag of a node or element in MSH 4.1.
    #[inline]
    pub(super) fn count(&mut self, expected: &'static str) -> Result<u64, GmshError> {
        match self.encoding {
            Encoding::Text => self.text_count(expected),
            Encoding::LittleEndian => Ok(u64::from_le_bytes(self.bytes()?)),
            Encoding::BigEndian => Ok(u64::from_be_bytes(self.bytes()?)),
        }
    }
    /// An integer of four bytes.
    #[inline]
    pub(super) fn integer(&mut self, expected: &'static str) -> Result<i64, GmshError> {
        if self.is_binary() { self.binary_integer() } else { self.text_integer(expected) }
    }
    /// An integer of four bytes that has no sign: a tag of a node or element in MSH 2.2.
    #[inline]
    pub(super) fn unsigned(&mut self, expected: &'static str) -> Result<u64, GmshError> {
        if !self.is_binary() {
            return self.text_count(expected);
        }
        let value = self.binary_integer()?;
        u64::try_from(value).map_err(|_| self.unexpected(expected, value.to_string()))
    }
    /// A real number of eight bytes.
    #[inline]
    pub(super) fn real(&mut self, expected: &'static str) -> Result<f64, GmshError> {
        match self.encoding {
            Encoding::Text => self.text_real(expected),
            Encoding::LittleEndian => Ok(f64::from_le_bytes(self.bytes()?)),
            Encoding::BigEndian => Ok(f64::from_be_bytes(self.bytes()?)),
        }
    }
    /// Skips `count` numbers, each of `size` bytes in a binary file.
    pub(super) fn skip(
        &mut self,
        count: u64,
        size: usize,
        expected: &'static str,
    ) -> Result<(), GmshError> {
        if self.is_binary() {
            return self.skip_bytes(count, size);
        }
        for _ in 0..count {
            self.number_word(expected)?;
        }
        Ok(())
    }
    /// Moves to the first number of a section; binary numbers begin after the line of its name.
    pub(super) fn begin_numbers(&mut self) {
        if !self.is_binary() {
            self.skip_blank_lines();
        }
    }
    /// Moves to the line of the next record of text; `found` of `announced` records are read.
    pub(super) fn begin_record(
        &mut self,
        what: &'static str,
        announced: u64,
        found: u64,
    ) -> Result<(), GmshError> {
        if self.is_binary() {
            return Ok(());
        }
        self.skip_blank_lines();
        match self.peek() {
            None => Err(self.truncated()),
            Some(b'$') => Err(self.miscounted(what, announced, found.to_string())),
            Some(_) => Ok(()),
        }
    }
    /// An error if the line of a record has more words.
    pub(super) fn end_record(&mut self) -> Result<(), GmshError> {
        if self.is_binary() { Ok(()) } else { self.end_line() }
    }
    /// An error if `announced` records of `size` bytes exceed the rest of a binary file, tested before
    /// memory is reserved: a wrong count where the section has an end, a truncated file otherwise.
    pub(super) fn check_room(
        &self,
        what: &'static str,
        announced: u64,
        size: usize,
    ) -> Result<(), GmshError> {
        if !self.is_binary() || announced <= (self.remaining() / size.max(1)) as u64 {
            return Ok(());
        }
        let rest = &self.bytes[self.at..];
        match find(rest, self.section_end().as_bytes()) {
            Some(length) => {
                Err(self.miscounted(what, announced, format!("at most {}", length / size.max(1))))
            }
            None => Err(self.truncated()),
        }
    }
    /// Number of records to reserve memory for, at most as many as the rest of the file holds.
    pub(super) fn capacity(&self, announced: u64, text_bytes: usize) -> usize {
        let most = self.remaining() / text_bytes.max(1);
        usize::try_from(announced).map_or(most, |announced| announced.min(most))
    }

    // Sections.

    fn section_end(&self) -> String {
        format!("$End{}", self.section.trim_start_matches('$'))
    }
    /// Reads the end of a section after the announced records.
    pub(super) fn end_section(
        &mut self,
        what: &'static str,
        announced: u64,
    ) -> Result<(), GmshError> {
        self.skip_blank_lines();
        let end = self.section_end();
        let start = self.mark();
        let word = self.word();
        if word == end.as_bytes() {
            return self.end_line();
        }
        let position = self.position_of(start);
        if word.is_empty() {
            return Err(self.truncated());
        }
        if word[0] != b'$' {
            let section = self.section_name();
            return Err(GmshError::Count {
                position,
                section,
                what,
                announced,
                found: "more".into(),
            });
        }
        let found = format!("`{}`", excerpt(word));
        Err(GmshError::Unexpected {
            position,
            section: self.section_name(),
            expected: format!("`{}`", excerpt(&end)),
            found,
        })
    }
    /// Skips a section, up to the end of its last line.
    pub(super) fn skip_section(&mut self) -> Result<(), GmshError> {
        let end = self.section_end();
        loop {
            let Some(length) = find(&self.bytes[self.at..], end.as_bytes()) else {
                self.line += self.bytes[self.at..].iter().filter(|&&byte| byte == b'\n').count();
                self.at = self.bytes.len();
                return Err(self.truncated());
            };
            let skipped = &self.bytes[self.at..self.at + length];
            self.line += skipped.iter().filter(|&&byte| byte == b'\n').count();
            self.at += length + end.len();
            // $EndNode is a prefix of $EndNodeData.
            if self.peek().is_none_or(|byte| byte.is_ascii_whitespace()) {
                return Ok(());
            }
        }
    }
}

/// The index of the first occurrence of a pattern.
fn find(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    let first = *pattern.first()?;
    let mut from = 0;
    while let Some(step) = bytes[from..].iter().position(|&byte| byte == first) {
        from += step;
        if bytes[from..].starts_with(pattern) {
            return Some(from);
        }
        from += 1;
    }
    None
}

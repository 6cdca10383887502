//! Reading numbers off the bytes of a file, whether they are text or binary.
//!
//! Text is read record by record, a record being a line: a number that is missing is then reported
//! on its own line, not wherever the numbers that follow cease to make sense.

use super::error::GmshError;
use super::position::FilePosition;
use super::text::excerpt;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The bytes of a file and the position up to which they are read.
pub(super) struct Source<'a> {
    pub(super) bytes: &'a [u8],
    /// The next byte to read.
    pub(super) at: usize,
    /// The line it is on, counted from one.
    pub(super) line: usize,
    /// Where the word or number read last begins.
    pub(super) last: usize,
    /// How the numbers of the sections are written.
    pub(super) encoding: Encoding,
    /// The section that is being read, for messages.
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
    /// The position as a number: what [`Source::place_of`] understands.
    pub(super) fn position(&self) -> usize {
        if self.is_binary() { self.at } else { self.line }
    }
    /// A position in the way of this file.
    pub(super) fn place_of(&self, position: usize) -> FilePosition {
        if self.is_binary() { FilePosition::Byte(position) } else { FilePosition::Line(position) }
    }
    /// Where the word or number read last stands.
    pub(super) fn place(&self) -> FilePosition {
        self.place_of(if self.is_binary() { self.last } else { self.line })
    }
    /// Number of bytes not yet read.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }
    pub(super) fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    // Errors at the present position.

    pub(super) fn truncated(&self) -> GmshError {
        let place = self.place_of(if self.is_binary() { self.bytes.len() } else { self.line });
        GmshError::Truncated { place, section: self.section.clone() }
    }
    pub(super) fn unexpected(
        &self,
        expected: impl Into<String>,
        found: impl Into<String>,
    ) -> GmshError {
        GmshError::Unexpected {
            place: self.place(),
            section: self.section.clone(),
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
        let (place, section) = (self.place(), self.section.clone());
        GmshError::Count { place, section, what, announced, found: found.into() }
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
    /// Steps over `count` numbers that nobody needs, each of `size` bytes in a binary file.
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
    /// Goes to the first number of a section; binary numbers begin right behind the line of its name.
    pub(super) fn begin_numbers(&mut self) {
        if !self.is_binary() {
            self.skip_blank_lines();
        }
    }
    /// Goes to the line of the next record of text; `found` of `announced` are read already.
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
    /// Insists that the line of a record has no more words.
    pub(super) fn end_record(&mut self) -> Result<(), GmshError> {
        if self.is_binary() { Ok(()) } else { self.end_line() }
    }
    /// Insists that `announced` records of `size` bytes fit into what is left of a binary file, so
    /// that a damaged count is told from a file cut short, and neither takes memory.
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
    /// How many records to make room for: no more than the file can hold.
    pub(super) fn capacity(&self, announced: u64, text_bytes: usize) -> usize {
        let most = self.remaining() / text_bytes.max(1);
        usize::try_from(announced).map_or(most, |announced| announced.min(most))
    }

    // Sections.

    fn section_end(&self) -> String {
        format!("$End{}", self.section.trim_start_matches('$'))
    }
    /// The end of a section of which all records that were announced have been read.
    pub(super) fn end_section(
        &mut self,
        what: &'static str,
        announced: u64,
    ) -> Result<(), GmshError> {
        self.skip_blank_lines();
        let end = self.section_end();
        let start = self.position();
        let word = self.word();
        if word == end.as_bytes() {
            return self.end_line();
        }
        let place = self.place_of(start);
        if word.is_empty() {
            return Err(self.truncated());
        }
        if word[0] != b'$' {
            let section = self.section.clone();
            return Err(GmshError::Count { place, section, what, announced, found: "more".into() });
        }
        let found = format!("`{}`", excerpt(word));
        Err(GmshError::Unexpected {
            place,
            section: self.section.clone(),
            expected: format!("`{end}`"),
            found,
        })
    }
    /// Steps over a section, to the end of its last line.
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
            // $EndNode is the beginning of $EndNodeData.
            if self.peek().is_none_or(|byte| byte.is_ascii_whitespace()) {
                return Ok(());
            }
        }
    }
}

/// Where a pattern first occurs.
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

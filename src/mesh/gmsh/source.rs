//! Reading numbers and words off the bytes of a file, text or binary.
//!
//! Text is read record by record, a record being a line: a number that is missing is then reported
//! on its own line, not wherever the numbers that follow cease to make sense.

use super::error::GmshError;
use super::place::Place;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The bytes of a file and the position up to which they are read.
pub(super) struct Source<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    /// Where the word or number read last begins.
    last: usize,
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
    pub(super) fn place_of(&self, position: usize) -> Place {
        if self.is_binary() { Place::Byte(position) } else { Place::Line(position) }
    }
    /// Where the word or number read last stands.
    pub(super) fn place(&self) -> Place {
        self.place_of(if self.is_binary() { self.last } else { self.line })
    }
    /// Number of bytes not yet read.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.at
    }
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    // Errors at the present position.

    pub(super) fn truncated(&self) -> GmshError {
        let place = self.place_of(if self.is_binary() { self.bytes.len() } else { self.line });
        GmshError::Truncated { place, section: self.section.clone() }
    }
    pub(super) fn unexpected(&self, expected: impl Into<String>, found: impl Into<String>) -> GmshError {
        GmshError::Unexpected {
            place: self.place(),
            section: self.section.clone(),
            expected: expected.into(),
            found: found.into(),
        }
    }
    pub(super) fn miscounted(&self, what: &'static str, announced: u64, found: impl Into<String>) -> GmshError {
        let (place, section) = (self.place(), self.section.clone());
        GmshError::Count { place, section, what, announced, found: found.into() }
    }

    // Text.

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
    fn skip_blanks(&mut self) {
        while self.peek().is_some_and(|byte| byte != b'\n' && byte.is_ascii_whitespace()) {
            self.at += 1;
        }
    }
    /// The next word of the line; empty at its end.
    pub(super) fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        self.last = self.at;
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }
    /// What is left of the line, without its end; the position moves to the next line.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at += length.map_or(rest.len(), |n| n + 1);
        self.line += usize::from(length.is_some());
        &rest[..length.unwrap_or(rest.len())]
    }
    fn number_word(&mut self, expected: &'static str) -> Result<&'a [u8], GmshError> {
        let word = self.word();
        if !word.is_empty() {
            return Ok(word);
        }
        Err(match self.peek() {
            None => self.truncated(),
            Some(_) => self.unexpected(expected, "the end of the line"),
        })
    }
    fn not_a_number(&self, expected: &'static str, word: &[u8]) -> GmshError {
        GmshError::NotANumber {
            place: self.place(),
            section: self.section.clone(),
            expected,
            word: excerpt(word),
        }
    }
    /// A number without sign, written as text whatever the file.
    pub(super) fn text_count(&mut self, expected: &'static str) -> Result<u64, GmshError> {
        let word = self.number_word(expected)?;
        parse_digits(word).ok_or_else(|| self.not_a_number(expected, word))
    }
    /// An integer, written as text whatever the file.
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
    fn text_real(&mut self, expected: &'static str) -> Result<f64, GmshError> {
        let word = self.number_word(expected)?;
        let number = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        number.ok_or_else(|| self.not_a_number(expected, word))
    }

    // Binary.

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], GmshError> {
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(chunk) => {
                self.last = self.at;
                self.at += N;
                Ok(*chunk)
            }
            None => Err(self.truncated()),
        }
    }
    /// Steps over binary numbers.
    fn skip_bytes(&mut self, count: u64, size: usize) -> Result<(), GmshError> {
        match usize::try_from(count).ok().and_then(|count| count.checked_mul(size)) {
            Some(length) if length <= self.remaining() => {
                self.at += length;
                Ok(())
            }
            _ => Err(self.truncated()),
        }
    }
    /// The byte order, from the integer one at the present position.
    pub(super) fn byte_order(&mut self) -> Result<Encoding, GmshError> {
        let place = Place::Byte(self.at);
        match self.bytes::<4>()? {
            [1, 0, 0, 0] => Ok(Encoding::LittleEndian),
            [0, 0, 0, 1] => Ok(Encoding::BigEndian),
            found => Err(GmshError::ByteOrder { place, found }),
        }
    }
    fn binary_integer(&mut self) -> Result<i64, GmshError> {
        let bytes = self.bytes()?;
        let big = self.encoding == Encoding::BigEndian;
        Ok(i64::from(if big { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) }))
    }

    // Either.

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
    pub(super) fn skip(&mut self, count: u64, size: usize, expected: &'static str) -> Result<(), GmshError> {
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
    pub(super) fn begin_record(&mut self, what: &'static str, announced: u64, found: u64) -> Result<(), GmshError> {
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
    /// Insists that a line of text, in whatever file, has no more words.
    pub(super) fn end_line(&mut self) -> Result<(), GmshError> {
        match self.word() {
            [] => Ok(()),
            word => Err(self.unexpected("the end of the line", format!("`{}`", excerpt(word)))),
        }
    }
    /// Insists that `announced` records of `size` bytes fit into what is left of a binary file, so
    /// that a damaged count is told from a file cut short, and neither takes memory.
    pub(super) fn check_room(&self, what: &'static str, announced: u64, size: usize) -> Result<(), GmshError> {
        if !self.is_binary() || announced <= (self.remaining() / size.max(1)) as u64 {
            return Ok(());
        }
        let rest = &self.bytes[self.at..];
        match find(rest, self.section_end().as_bytes()) {
            Some(length) => Err(self.miscounted(what, announced, format!("at most {}", length / size.max(1)))),
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
    pub(super) fn end_section(&mut self, what: &'static str, announced: u64) -> Result<(), GmshError> {
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
        Err(GmshError::Unexpected { place, section: self.section.clone(), expected: format!("`{end}`"), found })
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

/// A word of the file, fit for a message.
pub(super) fn excerpt(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(word);
    let mut shown: String =
        text.chars().take(LONGEST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    shown
}

//! Words and numbers of a file, text or binary.
//!
//! Text is read record by record, one per line, so that a missing number is reported on its own line. What is read
//! is known by its offset in bytes; lines are counted when an error is made.

use super::error::{FilePosition, GmshError, GmshErrorKind};
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
    bytes: &'a [u8],
    /// The next byte to read.
    at: usize,
    /// The first byte of the word or number read last.
    last: usize,
    /// The encoding of the numbers of the sections.
    pub(super) encoding: Encoding,
    /// The section that is being read, or `after` and the one before.
    pub(super) section: String,
}

impl<'a> Source<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        // Editors put a byte order mark in front of text.
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Source { bytes, at, last: at, encoding: Encoding::Text, section: String::new() }
    }
    pub(super) fn is_binary(&self) -> bool {
        self.encoding != Encoding::Text
    }
    /// The offset of the next byte to read.
    pub(super) fn offset(&self) -> usize {
        self.at
    }
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }
    pub(super) fn is_at_end(&self) -> bool {
        self.at == self.bytes.len()
    }

    // Errors.

    /// An error at the word or number read last.
    pub(super) fn error(&self, kind: GmshErrorKind, message: impl Into<String>) -> GmshError {
        self.error_at(self.last, kind, message)
    }
    pub(super) fn error_at(
        &self,
        offset: usize,
        kind: GmshErrorKind,
        message: impl Into<String>,
    ) -> GmshError {
        let position = FilePosition::of(offset, self.bytes, self.is_binary());
        GmshError::new(kind, message).at(position)
    }
    /// Which section is being read, for messages.
    fn in_section(&self) -> String {
        match self.section.strip_prefix("after ") {
            Some(section) => format!("after section {}", excerpt(section)),
            None => format!("in section {}", excerpt(&self.section)),
        }
    }
    pub(super) fn truncated(&self) -> GmshError {
        let message =
            format!("the file ends {}; it is incomplete, save or copy it again", self.in_section());
        self.error_at(self.bytes.len(), GmshErrorKind::Truncated, message)
    }
    /// An error about something else than what is expected.
    fn differs(&self, kind: GmshErrorKind, expected: &str, found: &str) -> GmshError {
        let section = self.in_section();
        let message = format!(
            "expected {expected} {section}, found {found}; correct the line or save the mesh again"
        );
        self.error(kind, message)
    }
    pub(super) fn unexpected(&self, expected: &str, found: impl std::fmt::Display) -> GmshError {
        self.differs(GmshErrorKind::Unexpected, expected, &found.to_string())
    }
    pub(super) fn unexpected_word(&self, expected: &str, word: &[u8]) -> GmshError {
        self.unexpected(expected, format!("`{}`", excerpt(word)))
    }
    pub(super) fn not_a_number(&self, expected: &str, word: &[u8]) -> GmshError {
        self.differs(GmshErrorKind::NotANumber, expected, &format!("`{}`", excerpt(word)))
    }
    pub(super) fn miscounted(
        &self,
        what: &str,
        announced: u64,
        found: impl std::fmt::Display,
    ) -> GmshError {
        let message = format!(
            "{announced} {what} are announced {}, {found} found; the file is damaged, save or copy it again",
            self.in_section()
        );
        self.error(GmshErrorKind::Count, message)
    }

    // Words.

    /// Skips blanks and ends of lines.
    pub(super) fn skip_blank_lines(&mut self) {
        let blank = self.rest().iter().take_while(|byte| byte.is_ascii_whitespace());
        self.at += blank.count();
        self.last = self.at;
    }
    /// The next word of the line; empty at the end of the line.
    pub(super) fn word(&mut self) -> &'a [u8] {
        while self.peek().is_some_and(|byte| byte != b'\n' && byte.is_ascii_whitespace()) {
            self.at += 1;
        }
        self.last = self.at;
        let rest = self.rest();
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }
    /// The rest of the line, without its end; the next byte to read is the first of the next line.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at += length.map_or(rest.len(), |n| n + 1);
        &rest[..length.unwrap_or(rest.len())]
    }
    /// An error if the line of text has more words.
    pub(super) fn end_line(&mut self) -> Result<(), GmshError> {
        match self.word() {
            [] => Ok(()),
            word => Err(self.unexpected_word("the end of the line", word)),
        }
    }

    // Numbers.

    /// A number that is text also in binary files.
    #[inline]
    pub(super) fn text<V>(
        &mut self,
        expected: &str,
        parse: impl Fn(&[u8]) -> Option<V>,
    ) -> Result<V, GmshError> {
        match self.word() {
            [] if self.is_at_end() => Err(self.truncated()),
            [] => Err(self.unexpected(expected, "the end of the line")),
            word => parse(word).ok_or_else(|| self.not_a_number(expected, word)),
        }
    }
    /// A number in the encoding of the file: the functions make it of a word, and of bytes in little and big endian.
    #[inline(always)]
    fn number<V, const N: usize>(
        &mut self,
        expected: &str,
        parse: impl Fn(&[u8]) -> Option<V>,
        [little, big]: [fn([u8; N]) -> V; 2],
    ) -> Result<V, GmshError> {
        match self.encoding {
            Encoding::Text => self.text(expected, parse),
            Encoding::LittleEndian => self.bytes().map(little),
            Encoding::BigEndian => self.bytes().map(big),
        }
    }
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], GmshError> {
        let chunk = *self.rest().first_chunk::<N>().ok_or_else(|| self.truncated())?;
        self.last = self.at;
        self.at += N;
        Ok(chunk)
    }
    /// An unsigned number of eight bytes: a count, or a tag of a node or element in MSH 4.1.
    #[inline]
    pub(super) fn count(&mut self, expected: &str) -> Result<u64, GmshError> {
        self.number(expected, unsigned, [u64::from_le_bytes, u64::from_be_bytes])
    }
    /// An integer of four bytes.
    #[inline]
    pub(super) fn integer(&mut self, expected: &str) -> Result<i64, GmshError> {
        let of_bytes: [fn([u8; 4]) -> i64; 2] =
            [|b| i32::from_le_bytes(b).into(), |b| i32::from_be_bytes(b).into()];
        self.number(expected, integer, of_bytes)
    }
    /// An integer of four bytes that has no sign: a tag of a node or element in MSH 2.2.
    #[inline]
    pub(super) fn unsigned(&mut self, expected: &str) -> Result<u64, GmshError> {
        let value = self.integer(expected)?;
        u64::try_from(value).map_err(|_| self.unexpected(expected, value))
    }
    /// A real number of eight bytes.
    #[inline]
    pub(super) fn real(&mut self, expected: &str) -> Result<f64, GmshError> {
        let parse = |word: &[u8]| std::str::from_utf8(word).ok()?.parse().ok();
        self.number(expected, parse, [f64::from_le_bytes, f64::from_be_bytes])
    }
    /// The coordinates of a node.
    pub(super) fn point(&mut self) -> Result<[f64; 3], GmshError> {
        Ok([self.real("coordinate x")?, self.real("coordinate y")?, self.real("coordinate z")?])
    }
    /// Skips `count` numbers, each of `size` bytes in a binary file.
    pub(super) fn skip(
        &mut self,
        count: u64,
        size: usize,
        expected: &str,
    ) -> Result<(), GmshError> {
        if !self.is_binary() {
            return (0..count).try_for_each(|_| self.text(expected, |_| Some(())));
        }
        let length = usize::try_from(count).ok().and_then(|count| count.checked_mul(size));
        let length = length.filter(|&length| length <= self.rest().len());
        self.at += length.ok_or_else(|| self.truncated())?;
        Ok(())
    }

    // Records.

    /// Moves to the line of the next record of text; `found` of `announced` records are read.
    pub(super) fn begin_record(
        &mut self,
        what: &str,
        announced: u64,
        found: u64,
    ) -> Result<(), GmshError> {
        if self.is_binary() {
            return Ok(());
        }
        self.skip_blank_lines();
        match self.peek() {
            None => Err(self.truncated()),
            Some(b'$') => Err(self.miscounted(what, announced, found)),
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
        what: &str,
        announced: u64,
        size: usize,
    ) -> Result<(), GmshError> {
        if !self.is_binary() || announced <= (self.rest().len() / size) as u64 {
            return Ok(());
        }
        Err(match find(self.rest(), self.section_end().as_bytes()) {
            Some(length) => {
                self.miscounted(what, announced, format_args!("at most {}", length / size))
            }
            None => self.truncated(),
        })
    }
    /// Number of records to reserve memory for, at most as many as the rest of the file holds.
    pub(super) fn capacity(&self, announced: u64, text_bytes: usize) -> usize {
        let most = self.rest().len() / text_bytes;
        usize::try_from(announced).map_or(most, |announced| announced.min(most))
    }

    // Sections.

    fn section_end(&self) -> String {
        format!("$End{}", self.section.trim_start_matches('$'))
    }
    /// Reads the end of a section after the announced records.
    pub(super) fn end_section(&mut self, what: &str, announced: u64) -> Result<(), GmshError> {
        self.skip_blank_lines();
        let end = self.section_end();
        match self.word() {
            word if word == end.as_bytes() => self.end_line(),
            [] => Err(self.truncated()),
            word @ [b'$', ..] => Err(self.unexpected_word(&format!("`{}`", excerpt(&end)), word)),
            _ => Err(self.miscounted(what, announced, "more")),
        }
    }
    /// Skips a section, up to the end of its last line.
    pub(super) fn skip_section(&mut self) -> Result<(), GmshError> {
        let end = self.section_end();
        loop {
            let length = find(self.rest(), end.as_bytes()).ok_or_else(|| self.truncated())?;
            self.at += length + end.len();
            // $EndNode is a prefix of $EndNodeData.
            if self.peek().is_none_or(|byte| byte.is_ascii_whitespace()) {
                return Ok(());
            }
        }
    }
    /// Reads the byte order mark of a binary file.
    pub(super) fn read_byte_order(&mut self) -> Result<(), GmshError> {
        self.encoding = match self.bytes()? {
            [1, 0, 0, 0] => Encoding::LittleEndian,
            [0, 0, 0, 1] => Encoding::BigEndian,
            found => {
                let message = format!(
                    "the byte order mark of a binary file must be the integer 1, found bytes {found:?}; the file is damaged (was it copied as text?), save or copy it again"
                );
                let position = FilePosition::Byte(self.last);
                return Err(GmshError::new(GmshErrorKind::ByteOrder, message).at(position));
            }
        };
        Ok(())
    }
}

/// A number without sign, of its digits.
pub(super) fn unsigned(word: &[u8]) -> Option<u64> {
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

/// An integer, of its sign and digits.
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    let digits = word.strip_prefix(b"-");
    let value = i64::try_from(unsigned(digits.unwrap_or(word))?).ok()?;
    Some(if digits.is_some() { -value } else { value })
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

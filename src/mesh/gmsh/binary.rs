//! Numbers of a binary file.

use super::error::GmshError;
use super::position::FilePosition;
use super::source::{Encoding, Source};

impl Source<'_> {
    pub(super) fn bytes<const N: usize>(&mut self) -> Result<[u8; N], GmshError> {
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(chunk) => {
                self.last = self.at;
                self.at += N;
                Ok(*chunk)
            }
            None => Err(self.truncated()),
        }
    }
    /// Skips binary numbers.
    pub(super) fn skip_bytes(&mut self, count: u64, size: usize) -> Result<(), GmshError> {
        match usize::try_from(count).ok().and_then(|count| count.checked_mul(size)) {
            Some(length) if length <= self.remaining() => {
                self.at += length;
                Ok(())
            }
            _ => Err(self.truncated()),
        }
    }
    /// The byte order, from the bytes of the integer one.
    pub(super) fn byte_order(&mut self) -> Result<Encoding, GmshError> {
        let position = FilePosition::Byte(self.at);
        match self.bytes::<4>()? {
            [1, 0, 0, 0] => Ok(Encoding::LittleEndian),
            [0, 0, 0, 1] => Ok(Encoding::BigEndian),
            found => Err(GmshError::ByteOrder { position, found }),
        }
    }
    pub(super) fn binary_integer(&mut self) -> Result<i64, GmshError> {
        let bytes = self.bytes()?;
        let big = self.encoding == Encoding::BigEndian;
        Ok(i64::from(if big { i32::from_be_bytes(bytes) } else { i32::from_le_bytes(bytes) }))
    }
}

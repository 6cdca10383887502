//! Several arrays in one file: an archive in the format ZIP without compression.

/// Appends numbers of 16 bits.
fn push_16(bytes: &mut Vec<u8>, numbers: &[u16]) {
    for number in numbers {
        bytes.extend(number.to_le_bytes());
    }
}

/// Appends numbers of 32 bits.
fn push_32(bytes: &mut Vec<u8>, numbers: &[u32]) {
    for number in numbers {
        bytes.extend(number.to_le_bytes());
    }
}

/// The archive of files with these names. None if it would have more than 4 GiB, for which the format needs
/// its extension.
pub(super) fn archive(files: &[(&str, Vec<u8>)]) -> Option<Vec<u8>> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, data) in files {
        let (length, start) = (u32::try_from(data.len()).ok()?, u32::try_from(bytes.len()).ok()?);
        let mut checksum = flate2::Crc::new();
        checksum.update(data);
        let mut entry = Vec::new();
        // version, flags, method (stored); time and date: 1 January 1980
        push_16(&mut entry, &[20, 0, 0, 0, 0x21]);
        push_32(&mut entry, &[checksum.sum(), length, length]);
        push_16(&mut entry, &[name.len() as u16, 0]);
        bytes.extend(*b"PK\x03\x04");
        bytes.extend(&entry);
        bytes.extend(name.bytes());
        bytes.extend(data);
        directory.extend(*b"PK\x01\x02\x14\x00");
        directory.extend(&entry);
        // comment, disk, attributes
        directory.extend([0; 10]);
        directory.extend(start.to_le_bytes());
        directory.extend(name.bytes());
    }
    let (start, length) = (u32::try_from(bytes.len()).ok()?, directory.len() as u32);
    bytes.extend(directory);
    bytes.extend(*b"PK\x05\x06\x00\x00\x00\x00");
    let n = files.len() as u16;
    push_16(&mut bytes, &[n, n]);
    push_32(&mut bytes, &[length, start]);
    bytes.extend([0; 2]);
    Some(bytes)
}

//! Several arrays in one file: an archive in the format ZIP without compression.

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
        entry.extend([20, 0, 0, 0, 0x21].map(u16::to_le_bytes).as_flattened());
        entry.extend([checksum.sum(), length, length].map(u32::to_le_bytes).as_flattened());
        entry.extend([name.len() as u16, 0].map(u16::to_le_bytes).as_flattened());
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
    bytes.extend([n, n].map(u16::to_le_bytes).as_flattened());
    bytes.extend([length, start].map(u32::to_le_bytes).as_flattened());
    bytes.extend([0; 2]);
    Some(bytes)
}

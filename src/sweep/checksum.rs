//! Checksums of Parquet files. The SHA-256 of all other bytes is stored before the footer, where readers ignore it,
//! because the `parquet` crate can't write checksums.

use sha2::{Digest as _, Sha256};
use std::io::{self, Read, Seek, SeekFrom, Write};

/// The number of bytes of a checksum.
const LENGTH: u64 = 32;

/// Adds the checksum to a complete file.
pub(super) fn add(mut file: impl Read + Write + Seek) -> io::Result<()> {
    let footer = footer(&mut file)?;
    let mut hash = Sha256::new();
    file.rewind()?;
    io::copy(&mut file, &mut hash)?;
    let mut end = hash.finalize().to_vec();
    // The checksum takes the place of the footer, and the footer follows it: readers find it from the end of the file.
    file.seek(SeekFrom::Start(footer))?;
    file.read_to_end(&mut end)?;
    file.seek(SeekFrom::Start(footer))?;
    file.write_all(&end)
}

/// Whether a Parquet file has a valid checksum.
pub(super) fn is_right(mut file: impl Read + Seek) -> io::Result<bool> {
    let Some(data) = footer(&mut file)?.checked_sub(LENGTH) else {
        return Ok(false);
    };
    let mut hash = Sha256::new();
    file.rewind()?;
    io::copy(&mut file.by_ref().take(data), &mut hash)?;
    let mut checksum = [0; LENGTH as usize];
    file.read_exact(&mut checksum)?;
    io::copy(&mut file, &mut hash)?;
    Ok(hash.finalize()[..] == checksum)
}

/// The beginning of the footer of a Parquet file. The file ends with its length (four bytes) and four letters.
fn footer(file: &mut (impl Read + Seek)) -> io::Result<u64> {
    let end = file.seek(SeekFrom::End(-8))?;
    let mut length = [0; 4];
    file.read_exact(&mut length)?;
    let start = end.checked_sub(u32::from_le_bytes(length).into());
    start.ok_or_else(|| io::ErrorKind::InvalidData.into())
}

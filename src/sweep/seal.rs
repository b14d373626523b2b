//! Seals of parts: what tells that a file is this part of this sweep, and that no bit of it has changed since.
//!
//! A seal is an entry of the file's metadata: the SHA-256, in hexadecimal digits, of the sweep's spec, the number of the
//! part, and the bytes of the file in which the seal itself is blank.

use super::spec::Spec;
use parquet::file::metadata::{KeyValue, ParquetMetaData};
use sha2::{Digest as _, Sha256};

/// The entry of the metadata.
pub(super) const SEAL_ENTRY: &str = "toprise.seal";

/// As long as a seal, and not to be found in a file otherwise.
const BLANK: &str = "(a blank seal) (a blank seal) (a blank seal) (a blank seal) (a b";

/// The entry of a file that is not sealed yet.
pub(super) fn blank() -> KeyValue {
    KeyValue::new(SEAL_ENTRY.to_owned(), BLANK.to_owned())
}

/// Seals the bytes of a part that has a [`blank`] entry.
pub(super) fn seal(bytes: &mut [u8], spec: &Spec, part: u64) {
    if let Some(at) = place_of(bytes, BLANK) {
        let seal = digest(bytes, spec, part);
        bytes[at..at + BLANK.len()].copy_from_slice(seal.as_bytes());
    }
}

/// Whether bytes with this metadata are those of a part of a sweep, unchanged.
pub(super) fn is_sealed(
    mut bytes: Vec<u8>,
    metadata: &ParquetMetaData,
    spec: &Spec,
    part: u64,
) -> bool {
    let entries = metadata.file_metadata().key_value_metadata();
    let found = entries
        .into_iter()
        .flatten()
        .find(|entry| entry.key == SEAL_ENTRY);
    let Some(seal) = found.and_then(|entry| entry.value.as_deref()) else {
        return false;
    };
    let place = place_of(&bytes, seal).filter(|_| seal.len() == BLANK.len());
    let Some(at) = place else {
        return false;
    };
    bytes[at..at + BLANK.len()].copy_from_slice(BLANK.as_bytes());
    digest(&bytes, spec, part) == seal
}

fn digest(bytes: &[u8], spec: &Spec, part: u64) -> String {
    let mut hash = Sha256::new();
    hash.update(spec.to_json().to_string());
    hash.update(part.to_le_bytes());
    hash.update(bytes);
    hash.finalize()
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// Where a text stands last: the metadata are at the end.
fn place_of(bytes: &[u8], text: &str) -> Option<usize> {
    let mut windows = bytes.windows(text.len());
    windows.rposition(|window| window == text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blank_seal_is_as_long_as_a_seal() {
        assert_eq!(BLANK.len(), 2 * Sha256::output_size());
    }
}

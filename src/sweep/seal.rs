//! Seals of parts: what tells that a file is this part of this sweep, and that no bit of it has changed since.
//!
//! A seal is an entry of the file's metadata: the SHA-256, in hexadecimal digits, of the sweep's spec, the number of the
//! part, and the bytes of the file in which the seal itself is blank.

use crate::run::scenario::hex;
use parquet::file::metadata::KeyValue;
use sha2::{Digest as _, Sha256};

/// The entry of the metadata.
pub(super) const SEAL_ENTRY: &str = "toprise.seal";

/// As long as a seal, and not to be found in a file otherwise.
const BLANK: &str = "(a blank seal) (a blank seal) (a blank seal) (a blank seal) (a b";

/// The entry of a file that is not sealed yet.
pub(super) fn blank() -> KeyValue {
    KeyValue::new(SEAL_ENTRY.to_owned(), BLANK.to_owned())
}

/// Seals the bytes of a part that has a [`blank`] entry, given the spec of its sweep as JSON.
pub(super) fn seal(bytes: &mut [u8], sweep: &str, part: u64) {
    if let Some(at) = place_of(bytes, BLANK) {
        let seal = digest(bytes, sweep, part);
        bytes[at..at + BLANK.len()].copy_from_slice(seal.as_bytes());
    }
}

/// Whether bytes with this seal are those of a part of a sweep, unchanged.
pub(super) fn is_sealed(mut bytes: Vec<u8>, seal: &str, sweep: &str, part: u64) -> bool {
    if seal.len() != BLANK.len() {
        return false;
    }
    let Some(at) = place_of(&bytes, seal) else {
        return false;
    };
    bytes[at..at + BLANK.len()].copy_from_slice(BLANK.as_bytes());
    digest(&bytes, sweep, part) == seal
}

fn digest(bytes: &[u8], sweep: &str, part: u64) -> String {
    let mut hash = Sha256::new();
    hash.update(sweep);
    hash.update(part.to_le_bytes());
    hash.update(bytes);
    hex(&hash.finalize())
}

/// Where a text stands last: the metadata are at the end.
fn place_of(bytes: &[u8], text: &str) -> Option<usize> {
    let mut windows = bytes.windows(text.len());
    windows.rposition(|window| window == text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::super::axis::Axis;
    use super::super::spec::{Base, Design, Spec};
    use super::*;
    use std::path::Path;

    #[test]
    fn a_seal_is_of_one_part_of_one_sweep_and_of_all_its_bytes() {
        let base = Base::open("paper", Path::new(""), &[]).unwrap();
        let of = |values| {
            let axis = Axis::parse("friction.k", values).unwrap();
            let spec = Spec::new(vec![base.clone()], Design::Grid(vec![axis]), None);
            spec.unwrap().to_json().to_string()
        };
        let (spec, other) = (of("0.1,0.2"), of("0.1,0.3"));
        let mut bytes = format!("before {BLANK} after").into_bytes();
        seal(&mut bytes, &spec, 1);
        let text = String::from_utf8(bytes.clone()).unwrap();
        let seal = &text[7..7 + BLANK.len()];
        assert!(is_sealed(bytes.clone(), seal, &spec, 1));
        assert!(!is_sealed(bytes.clone(), seal, &spec, 0));
        assert!(!is_sealed(bytes.clone(), seal, &other, 1));
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert!(!is_sealed(damaged, seal, &spec, 1), "{place}");
        }
        for foreign in ["", "before", &"0".repeat(BLANK.len())] {
            assert!(!is_sealed(bytes.clone(), foreign, &spec, 1), "{foreign}");
        }
    }

    #[test]
    fn a_blank_seal_is_as_long_as_a_seal() {
        assert_eq!(BLANK.len(), 2 * Sha256::output_size());
    }
}

//! `NaN` and `Infinity`, which JSON doesn't have but Python and others write.

use std::collections::VecDeque;

/// What JSON doesn't have.
const LITERALS: [(&[u8], f64); 3] = [
    (b"NaN", f64::NAN),
    (b"-Infinity", f64::NEG_INFINITY),
    (b"Infinity", f64::INFINITY),
];
/// What is put in its place.
const NULL: &[u8] = b"null";

/// What the nulls of a rewritten message stand for, in the order of the message: a number, or nothing for a null that
/// was there before.
#[derive(Debug, Default)]
pub(super) struct Literals(VecDeque<Option<f64>>);

impl Literals {
    /// The number that the next null stands for, if it does.
    pub(super) fn next(&mut self) -> Option<f64> {
        self.0.pop_front().flatten()
    }

    /// The message with nulls in place of what JSON doesn't have, and what they stand for; none if there is no such
    /// thing in it.
    pub(super) fn replace(data: &[u8]) -> Option<(Vec<u8>, Self)> {
        let mut replaced = Vec::with_capacity(data.len());
        let mut nulls = VecDeque::new();
        let mut rest = data;
        let (mut in_text, mut is_escaped) = (false, false);
        while let Some((byte, behind)) = rest.split_first() {
            let starts = |literal: &[u8]| !in_text && rest.starts_with(literal);
            let found = LITERALS.iter().find(|(literal, _)| starts(literal));
            if let Some((literal, number)) = found {
                replaced.extend_from_slice(NULL);
                nulls.push_back(Some(*number));
                rest = &rest[literal.len()..];
                continue;
            }
            if starts(NULL) {
                nulls.push_back(None);
            }
            in_text ^= *byte == b'"' && !is_escaped;
            is_escaped = in_text && *byte == b'\\' && !is_escaped;
            replaced.push(*byte);
            rest = behind;
        }
        let is_found = nulls.iter().any(Option::is_some);
        is_found.then_some((replaced, Self(nulls)))
    }
}

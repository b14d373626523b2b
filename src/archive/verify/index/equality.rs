//! The comparison of an index with the data.

use crate::archive::verify::difference::Difference;

/// Compares a part of the index with the data, and describes both where they differ.
pub(super) fn check_equal<T: PartialEq>(
    place: &str,
    found: &T,
    expected: &T,
    describe: impl Fn(&T) -> String,
) -> Result<(), Difference> {
    if found == expected {
        Ok(())
    } else {
        let texts = [found, expected].map(|value| Some(describe(value)));
        Err(Difference::new(place, "", texts))
    }
}

/// Texts with commas between them.
pub(super) fn list(texts: impl Iterator<Item = String>) -> String {
    let texts: Vec<String> = texts.collect();
    if texts.is_empty() {
        "none".to_owned()
    } else {
        texts.join(", ")
    }
}

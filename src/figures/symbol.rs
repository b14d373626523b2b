//! Symbols of keys in figures.

use crate::run::scenario::Key;

/// The symbol of a key, as markup. Initial values have the index 0.
pub(super) fn markup((key, symbol): (&Key, &str)) -> String {
    let (letter, index) = symbol.split_once('_').unwrap_or((symbol, ""));
    let index = if key.path.starts_with("initial.") {
        "0"
    } else {
        index
    };
    if index.is_empty() {
        format!("*{letter}*")
    } else {
        format!("*{letter}*_{{{index}}}")
    }
}

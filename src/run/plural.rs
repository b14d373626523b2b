//! Nouns after numbers.

/// A noun in the form that follows a number: "1 entry", "2 entries".
pub(crate) fn plural(number: u64, noun: &str) -> String {
    match (number, noun.strip_suffix('y')) {
        (1, _) => noun.to_owned(),
        (_, Some(stem)) => format!("{stem}ies"),
        (_, None) => format!("{noun}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_one_is_singular() {
        for (number, noun, expected) in [
            (0, "byte", "bytes"),
            (1, "byte", "byte"),
            (2, "byte", "bytes"),
            (1, "entry", "entry"),
            (3, "entry", "entries"),
        ] {
            assert_eq!(plural(number, noun), expected, "{number}");
        }
    }
}

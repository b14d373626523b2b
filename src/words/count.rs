//! Counts and their nouns in sentences.

/// A count with commas between thousands: "65,260".
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count with its noun: "1 entry", "2,000 entries".
pub fn counted(number: u64, noun: &str) -> String {
    format!("{} {}", grouped(number), plural(number, noun))
}

/// A noun in the form that follows a number: "1 entry", "2 entries".
pub fn plural(number: u64, noun: &str) -> String {
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
    fn groups_thousands() {
        for (number, expected) in [
            (0, "0"),
            (999, "999"),
            (1000, "1,000"),
            (65_260, "65,260"),
            (123_456, "123,456"),
            (u64::MAX, "18,446,744,073,709,551,615"),
        ] {
            assert_eq!(grouped(number), expected);
        }
        assert_eq!(counted(2000, "entry"), "2,000 entries");
    }

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

//! Numbers of JSON texts, compared beyond the precision of `f64`.

/// A number of a JSON text.
#[derive(Debug)]
pub(super) struct JsonNumber {
    /// The number as it is written.
    decimal: Decimal,
    /// The double-precision number of which it is a spelling, if it is one with a fraction or an exponent.
    double: Option<f64>,
}

/// A decimal number, in its only form.
#[derive(Debug, PartialEq, Eq)]
struct Decimal {
    is_negative: bool,
    /// The significant digits, without zeros at the beginning and the end; empty for 0. A text whose exponent is too large
    /// for any computer stays as it is.
    digits: String,
    /// The power of ten of the last digit.
    exponent: i64,
}

impl JsonNumber {
    /// The number that a text spells. `value` is the `f64` next to it, unless it is an integer that fits.
    pub(super) fn new(text: &str, value: Option<f64>) -> Self {
        let decimal = Decimal::new(text);
        let is_real = text.contains(['.', 'e', 'E']);
        Self {
            double: value.filter(|value| is_real && decimal.is_spelling_of(*value)),
            decimal,
        }
    }
}

/// Numbers are equal if they are the same as written. Software also writes a double-precision number with as many digits as
/// it likes, each time rounded correctly: 0.1 and 0.10000000000000001 are spellings of one such number.
impl PartialEq for JsonNumber {
    fn eq(&self, other: &Self) -> bool {
        let is_same_double = match (self.double, other.double) {
            // By its bits, so that −0 differs from 0.
            (Some(one), Some(other)) => one.to_bits() == other.to_bits(),
            _ => false,
        };
        is_same_double || self.decimal == other.decimal
    }
}

impl Decimal {
    fn new(text: &str) -> Self {
        let (is_negative, size) = match text.strip_prefix('-') {
            Some(size) => (true, size),
            None => (false, text),
        };
        let (mantissa, power) = size.split_once(['e', 'E']).unwrap_or((size, "0"));
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let all = [whole, fraction].concat();
        let significant = all.trim_start_matches('0');
        let digits = significant.trim_end_matches('0');
        let zeros = (significant.len() - digits.len()) as i64 - fraction.len() as i64;
        if digits.is_empty() {
            return Self {
                is_negative,
                digits: String::new(),
                exponent: 0,
            };
        }
        let exponent = power
            .parse()
            .ok()
            .and_then(|power: i64| power.checked_add(zeros));
        Self {
            is_negative,
            digits: exponent.map_or(size, |_| digits).to_owned(),
            exponent: exponent.unwrap_or(0),
        }
    }

    /// Whether this is the number rounded to as many digits.
    fn is_spelling_of(&self, number: f64) -> bool {
        let decimals = self.digits.len().saturating_sub(1);
        *self == Self::new(&format!("{number:.decimals$e}"))
    }
}

/// The numbers of a JSON text, in their order.
pub(super) fn number_texts(json: &[u8]) -> Vec<&str> {
    let mut texts = Vec::new();
    let mut at = 0;
    while let Some(byte) = json.get(at) {
        let length = match byte {
            b'"' => text_length(&json[at..]),
            b'-' | b'0'..=b'9' => {
                let rest = &json[at..];
                let length = rest
                    .iter()
                    .take_while(|byte| {
                        matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E')
                    })
                    .count();
                texts.extend(std::str::from_utf8(&rest[..length]));
                length
            }
            _ => 1,
        };
        at += length;
    }
    texts
}

/// Length of the quoted text with which a JSON text begins, bytes.
fn text_length(json: &[u8]) -> usize {
    let mut is_escaped = false;
    for (at, byte) in json.iter().enumerate().skip(1) {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' => is_escaped = true,
            b'"' => return at + 1,
            _ => {}
        }
    }
    json.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> JsonNumber {
        let is_integer = text.parse::<i64>().is_ok() || text.parse::<u64>().is_ok();
        let value = text.parse().unwrap();
        JsonNumber::new(text, (!is_integer).then_some(value))
    }

    #[test]
    fn compares_numbers_as_written() {
        for (a, b, expected) in [
            ("1", "1.0", true),
            ("1", "1e0", true),
            ("-120", "-1.2E+2", true),
            ("0.00012", "12e-5", true),
            ("0", "0e7", true),
            ("0", "-0", false),
            ("-0.0", "-0", true),
            ("1", "-1", false),
            // Spellings of one double-precision number.
            ("0.1", "0.10000000000000001", true),
            ("1e23", "9.9999999999999992e+22", true),
            ("1.8446744073709551616e19", "18446744073709551616", true),
            // The same double-precision number, but not spellings of it.
            ("0.1", "0.10000000000000002", false),
            ("1.0000000000000000001", "1.0", false),
            ("1.0000000000000000001", "1", false),
            ("1.0000000000000000001", "1.0000000000000000002", false),
            ("9007199254740993", "9007199254740992.0", false),
            ("9007199254740993.0", "9007199254740992.0", false),
            // Integers are exact, also beyond 64 bits.
            ("18446744073709551616", "18446744073709551617", false),
            ("18446744073709551616", "18446744073709552000", false),
            ("-9223372036854775809", "-9223372036854775810", false),
            ("1e30", "1000000000000000000000000000000", true),
            // Below the smallest and beyond the range of exponents.
            ("1e-400", "0.0", false),
            ("1e-400", "2e-400", false),
            ("1e-99999999999999999999", "1e-99999999999999999998", false),
            ("1e-99999999999999999999", "1e-99999999999999999999", true),
        ] {
            assert_eq!(number(a) == number(b), expected, "{a} {b}");
            assert_eq!(number(b) == number(a), expected, "{b} {a}");
        }
    }

    #[test]
    fn finds_numbers_outside_of_texts() {
        let json = br#"{"a1": [-2.5e+3, "7 \" 8", 0,9], "b": {"c\\": 1}, "d": true}"#;
        assert_eq!(number_texts(json), ["-2.5e+3", "0", "9", "1"]);
    }
}

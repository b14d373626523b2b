//! Numbers of JSON messages with more digits than a value holds.

/// Any decimal of so many digits is told apart from its neighbours by a double, or written so by a program that had one.
const HELD: usize = 17;

/// The numbers in a JSON message of which the nearest double, or an integer of 64 bits, doesn't have all digits.
pub(super) fn lost(message: &[u8]) -> Vec<&[u8]> {
    let is_part = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
    let mut runs = message.split(|byte| !is_part(byte));
    // Nearly all messages are done with here.
    if runs.all(|run| run.len() <= HELD) {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(byte) = message.get(at) {
        at += match byte {
            b'"' => text_length(&message[at..]),
            b'-' | b'0'..=b'9' => {
                let length = number_length(&message[at..]);
                let number = &message[at..at + length];
                if !is_held(number) {
                    found.push(number);
                }
                length
            }
            _ => 1,
        };
    }
    found
}

/// The length of the text that begins here, with its quotes.
fn text_length(message: &[u8]) -> usize {
    let mut is_escaped = false;
    let inner = message[1..].iter().position(|byte| {
        let is_end = *byte == b'"' && !is_escaped;
        is_escaped = *byte == b'\\' && !is_escaped;
        is_end
    });
    inner.map_or(message.len(), |inner| inner + 2)
}

/// The length of the number that begins here.
fn number_length(message: &[u8]) -> usize {
    let is_part = |byte: &u8| matches!(byte, b'0'..=b'9' | b'.' | b'+' | b'-' | b'e' | b'E');
    let end = message.iter().position(|byte| !is_part(byte));
    end.unwrap_or(message.len())
}

/// Whether the value of a number has all its digits.
fn is_held(number: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(number) else {
        return true;
    };
    let is_of_64_bits =
        |integer: i128| i64::try_from(integer).is_ok() || u64::try_from(integer).is_ok();
    if text.parse().is_ok_and(is_of_64_bits) {
        return true;
    }
    let digits = significant(text);
    if digits.len() <= HELD {
        return true;
    }
    let Ok(double) = text.parse::<f64>() else {
        return true;
    };
    // A double has no more digits than these.
    const MOST: usize = 767;
    digits.len() <= MOST && significant(&format!("{:.*e}", digits.len() - 1, double)) == digits
}

/// The digits of a number without zeros at the start and the end.
fn significant(number: &str) -> String {
    let mantissa = number.split(['e', 'E']).next().unwrap_or_default();
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    digits.trim_matches('0').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_beyond_a_value_are_found() {
        let lost_in = |text: &'static str| -> Vec<&str> {
            let lost = lost(text.as_bytes()).into_iter();
            lost.map(|number| std::str::from_utf8(number).unwrap())
                .collect()
        };
        // 2^64 and what a double has in all its digits are held, and so are integers of 64 bits.
        for held in [
            "18446744073709551616",
            "-9223372036854775807",
            "18446744073709551615",
            "0.1000000000000000055511151231257827",
            "1.00000000000000000000000000000",
            r#"{"a\"18446744073709551617":"18446744073709551617"}"#,
        ] {
            assert_eq!(lost_in(held), [""; 0], "{held}");
        }
        let text = r#"{"a":[18446744073709551617,-0.1000000000000000000000001e3],"b":1}"#;
        assert_eq!(
            lost_in(text),
            ["18446744073709551617", "-0.1000000000000000000000001e3"]
        );
    }
}

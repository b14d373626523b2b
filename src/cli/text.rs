//! Messages and JSON for a terminal, without control characters of untrusted text.

use crate::words::{is_control, sanitized_lines, shortened};

/// A sanitised message. Continuation lines are indented so that they can't be mistaken for another message; lines are
/// truncated.
pub(super) fn message(text: &str) -> String {
    let text = sanitized_lines(text.trim_end());
    let lines: Vec<_> = text.split('\n').map(shortened).collect();
    lines.join("\n  ")
}

/// JSON with control characters escaped.
pub(super) fn sanitized_json(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for character in json.chars() {
        // In JSON an escape keeps the character; a terminal sees letters only.
        if character != '\n' && is_control(character) {
            text.push_str(&format!("\\u{:04x}", u32::from(character)));
        } else {
            text.push(character);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::words::MAX_LINE;

    const HOSTILE: &str = "a\x1b[2Jb\u{9b}31mc\x7f\u{202e}\nerror: forged\r";

    #[test]
    fn strips_escape_sequences() {
        assert_eq!(message(HOSTILE), "a�[2Jb�31mc��\n  error: forged");
        assert_eq!(message(&"x".repeat(3000)).chars().count(), MAX_LINE + 1);
        let json = serde_json::to_string_pretty(&[HOSTILE]).unwrap();
        let shown = sanitized_json(&json);
        assert!(!shown.replace('\n', "").contains(is_control), "{shown}");
        assert_eq!(
            serde_json::from_str::<[String; 1]>(&shown).unwrap(),
            [HOSTILE]
        );
    }
}

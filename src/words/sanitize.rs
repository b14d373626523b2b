//! Untrusted text made harmless: no control characters, and no lines that look like others.

use std::borrow::Cow;

/// The longest line, in characters. Wrapping very long words is slow.
pub const MAX_LINE: usize = 2000;

/// Whether a character is a control or bidirectional formatting character.
pub fn is_control(character: char) -> bool {
    // Line separators and marks of direction can make one text look like another.
    let reorders = matches!(character, '\u{061c}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character.is_control() || reorders
}

/// A single line of limited length, with � for control characters.
pub fn sanitized(text: &str) -> Cow<'_, str> {
    let text = shortened(text);
    if text.contains(is_control) {
        return Cow::Owned(text.replace(is_control, "\u{fffd}"));
    }
    text
}

/// Truncates a line to [`MAX_LINE`] characters.
pub fn shortened(line: &str) -> Cow<'_, str> {
    shortened_to(line, MAX_LINE)
}

/// Truncates a line to a length in characters.
pub fn shortened_to(line: &str, length: usize) -> Cow<'_, str> {
    match line.char_indices().nth(length) {
        Some((end, _)) => Cow::Owned(format!("{}…", &line[..end])),
        None => Cow::Borrowed(line),
    }
}

/// Several lines, with � for other control characters.
pub fn sanitized_lines(text: &str) -> String {
    text.replace(|c| is_control(c) && c != '\n' && c != '\t', "\u{fffd}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_escape_sequences() {
        let hostile = "a\x1b[2Jb\u{9b}31mc\x7f\u{202e}\nerror: forged\r";
        assert_eq!(sanitized(hostile), "a�[2Jb�31mc���error: forged�");
        assert_eq!(sanitized("θ̇ = 1 rad/s"), "θ̇ = 1 rad/s");
        assert_eq!(sanitized(&"x".repeat(3000)).chars().count(), MAX_LINE + 1);
    }
}

//! Sanitises untrusted text: no control characters, and no fake message lines.

use std::borrow::Cow;

/// The longest line of a message, in characters.
const MAX_LENGTH: usize = 2000;

/// Whether a character is a control or bidirectional formatting character.
fn is_control(character: char) -> bool {
    // Line separators and marks of direction can make one text look like another.
    let reorders = matches!(character, '\u{061c}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character.is_control() || reorders
}

/// A sanitised single line, with � for control characters and limited length (wrapping very long words is slow).
pub(super) fn sanitized(text: &str) -> Cow<'_, str> {
    let text = shortened(text);
    if text.contains(is_control) {
        return Cow::Owned(text.replace(is_control, "\u{fffd}"));
    }
    text
}

/// Truncates a line to [`MAX_LENGTH`] characters.
fn shortened(line: &str) -> Cow<'_, str> {
    match line.char_indices().nth(MAX_LENGTH) {
        Some((end, _)) => Cow::Owned(format!("{}…", &line[..end])),
        None => Cow::Borrowed(line),
    }
}

/// A sanitised single line for Markdown, without characters that would be markup. Between letters, `_` is none.
pub(super) fn markdown_text(text: &str) -> String {
    let line = sanitized(text);
    let mut escaped = String::with_capacity(line.len());
    let mut characters = line.chars().peekable();
    let mut last = ' ';
    while let Some(character) = characters.next() {
        let is_in_word =
            last.is_alphanumeric() && characters.peek().is_some_and(|next| next.is_alphanumeric());
        let is_markup = match character {
            '\\' | '`' | '*' | '[' | ']' | '<' | '>' | '|' | '~' => true,
            '_' => !is_in_word,
            _ => false,
        };
        if is_markup {
            escaped.push('\\');
        }
        escaped.push(character);
        last = character;
    }
    escaped
}

/// Sanitised multi-line text.
pub(super) fn sanitized_lines(text: &str) -> String {
    text.replace(|c| is_control(c) && c != '\n' && c != '\t', "\u{fffd}")
}

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

    const HOSTILE: &str = "a\x1b[2Jb\u{9b}31mc\x7f\u{202e}\nerror: forged\r";

    #[test]
    fn markdown_text_has_no_markup() {
        for (text, expected) in [
            ("/camera/__raw__ *b*", r"/camera/\_\_raw\_\_ \*b\*"),
            (
                "initial.psi_dot ~ [x](y) <b> a|b",
                r"initial.psi_dot \~ \[x\](y) \<b\> a\|b",
            ),
            (r"`a\`", r"\`a\\\`"),
        ] {
            assert_eq!(markdown_text(text), expected);
        }
    }

    #[test]
    fn strips_escape_sequences() {
        assert_eq!(sanitized(HOSTILE), "a�[2Jb�31mc���error: forged�");
        assert_eq!(sanitized("θ̇ = 1 rad/s"), "θ̇ = 1 rad/s");
        assert_eq!(message(HOSTILE), "a�[2Jb�31mc��\n  error: forged");
        assert_eq!(sanitized(&"x".repeat(3000)).chars().count(), MAX_LENGTH + 1);
        assert_eq!(message(&"x".repeat(3000)).chars().count(), MAX_LENGTH + 1);
        let json = serde_json::to_string_pretty(&[HOSTILE]).unwrap();
        let shown = sanitized_json(&json);
        assert!(!shown.replace('\n', "").contains(is_control), "{shown}");
        assert_eq!(
            serde_json::from_str::<[String; 1]>(&shown).unwrap(),
            [HOSTILE]
        );
    }
}

//! Text out of files and arguments, made fit to be shown: it can neither steer a terminal nor pass for a line of ours.

use std::borrow::Cow;

/// The longest line of a message, in characters.
const LONGEST: usize = 2000;

/// Whether a character would steer a terminal, or reorder the text around it, instead of being shown.
fn is_steering(character: char) -> bool {
    let reorders = matches!(character, '\u{061c}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character.is_control() || reorders
}

/// A text as one line, with � for everything that would steer a terminal, and no longer than anyone reads: breaking
/// endless words into lines would take endless time.
pub(super) fn harmless(text: &str) -> Cow<'_, str> {
    let end = text.char_indices().nth(LONGEST).map(|(end, _)| end);
    match end {
        Some(end) => Cow::Owned(text[..end].replace(is_steering, "\u{fffd}") + "…"),
        None if text.contains(is_steering) => Cow::Owned(text.replace(is_steering, "\u{fffd}")),
        None => Cow::Borrowed(text),
    }
}

/// A text of several lines that keeps them as they are, but for what would steer a terminal.
pub(super) fn harmless_lines(text: &str) -> String {
    text.replace(|c| is_steering(c) && c != '\n' && c != '\t', "\u{fffd}")
}

/// A message: its lines but the first are indented, so that none of them passes for another message, and none is
/// longer than anyone reads.
pub(super) fn message(text: &str) -> String {
    let text = harmless_lines(text.trim_end());
    let line = |line: &str| match line.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    };
    let lines: Vec<String> = text.split('\n').map(line).collect();
    lines.join("\n  ")
}

/// JSON that shows no character that would steer a terminal: they are written as escapes.
pub(super) fn harmless_json(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for character in json.chars() {
        if character != '\n' && is_steering(character) {
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
    fn nothing_steers_the_terminal() {
        assert_eq!(harmless(HOSTILE), "a�[2Jb�31mc���error: forged�");
        assert_eq!(harmless("θ̇ = 1 rad/s"), "θ̇ = 1 rad/s");
        assert_eq!(message(HOSTILE), "a�[2Jb�31mc��\n  error: forged");
        assert_eq!(harmless(&"x".repeat(3000)).chars().count(), LONGEST + 1);
        assert_eq!(message(&"x".repeat(3000)).chars().count(), LONGEST + 1);
        let json = serde_json::to_string_pretty(&[HOSTILE]).unwrap();
        let shown = harmless_json(&json);
        assert!(!shown.replace('\n', "").contains(is_steering), "{shown}");
        assert_eq!(
            serde_json::from_str::<[String; 1]>(&shown).unwrap(),
            [HOSTILE]
        );
    }
}

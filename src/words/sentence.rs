//! Sentences.

use super::number;
use super::piece::{Argument, ArgumentStyle, Piece};
use schemars::JsonSchema;
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};

/// A sentence, or a part of one: a list of pieces.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(transparent)]
pub struct Sentence {
    pieces: Vec<Piece>,
}

impl Sentence {
    /// A template with a piece, or a part of a sentence, for each `{}`. Use the macro `sentence!`, which compares the
    /// numbers of both when it is compiled.
    pub fn from_template<const N: usize>(template: &'static str, parts: [Self; N]) -> Self {
        let mut sentence = Self::default();
        let mut texts = template.split("{}");
        sentence.push_text(texts.next().unwrap_or_default());
        for (part, text) in parts.into_iter().zip(texts) {
            sentence += part;
            sentence.push_text(text);
        }
        sentence
    }

    fn push_text(&mut self, text: &'static str) {
        if !text.is_empty() {
            self.pieces.push(Piece::Text(Cow::Borrowed(text)));
        }
    }

    /// Whether it has no text.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// Renders the sentence; arguments are written as the interface does.
    pub fn text(&self, arguments: ArgumentStyle) -> String {
        self.pieces
            .iter()
            .map(|piece| piece.text(arguments))
            .collect()
    }

    /// The sentence for programs, as text with plain numbers.
    #[must_use]
    pub fn with_plain_numbers(&self, arguments: ArgumentStyle) -> Self {
        number::plain(&self.text(arguments)).into()
    }

    /// Joins parts with a separator.
    pub fn join(parts: impl IntoIterator<Item = Self>, separator: &'static str) -> Self {
        let mut joined = Self::default();
        for (at, part) in parts.into_iter().enumerate() {
            if at > 0 {
                joined.push_text(separator);
            }
            joined += part;
        }
        joined
    }

    /// The sentence with a capital first letter.
    pub fn capitalized(mut self) -> Self {
        if let Some(Piece::Text(text)) = self.pieces.first_mut() {
            *text = Cow::Owned(capitalized(text));
        }
        self
    }
}

/// Renders the sentence for readers of no particular interface.
impl Display for Sentence {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Argument::plain))
    }
}

impl std::ops::AddAssign for Sentence {
    fn add_assign(&mut self, other: Self) {
        self.pieces.extend(other.pieces);
    }
}

impl<P: Into<Piece>> From<P> for Sentence {
    fn from(piece: P) -> Self {
        let piece = piece.into();
        let is_empty = matches!(&piece, Piece::Text(text) if text.is_empty());
        Self {
            pieces: if is_empty { Vec::new() } else { vec![piece] },
        }
    }
}

/// Two values of a quantity, see [`Piece::range`]: "0.5000 to 0.0200 rad".
pub fn span(values: [f64; 2], digits: usize, unit: &'static str) -> Sentence {
    let [first, last] = Piece::range(values, digits, unit);
    sentence!("{} to {}", first, last)
}

/// Joins a list: "a", "a and b", "a, b and c".
pub fn and(parts: Vec<Sentence>) -> Sentence {
    let last = parts.len().saturating_sub(1);
    let mut list = Sentence::default();
    for (at, part) in parts.into_iter().enumerate() {
        list.push_text(match at {
            0 => "",
            _ if at == last => " and ",
            _ => ", ",
        });
        list += part;
    }
    list
}

/// A text with a capital first letter.
pub fn capitalized(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_uppercase().chain(characters).collect(),
        None => String::new(),
    }
}

/// The number of `{}` in a template.
pub const fn placeholders(template: &str) -> usize {
    let bytes = template.as_bytes();
    let mut count = 0;
    let mut at = 1;
    while at < bytes.len() {
        if bytes[at - 1] == b'{' && bytes[at] == b'}' {
            count += 1;
        }
        at += 1;
    }
    count
}

/// A sentence with a piece, or a part of a sentence, for each `{}` of its template:
/// `sentence!("The top falls at {}.", Piece::time(time))`.
macro_rules! sentence {
    ($template:literal $(, $part:expr)* $(,)?) => {{
        const PARTS: &[&str] = &[$(stringify!($part)),*];
        const { assert!($crate::words::placeholders($template) == PARTS.len()) };
        $crate::words::Sentence::from_template($template, [$($crate::words::Sentence::from($part)),*])
    }};
}
pub(crate) use sentence;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_hold_pieces_and_parts() {
        let part = sentence!("at {}", Piece::time(1.5));
        let sentence = sentence!(
            "It {} {}, see {}.",
            "falls",
            part,
            Piece::argument_with("until", "2")
        );
        assert_eq!(sentence.to_string(), "It falls at 1.5000 s, see until = 2.");
        assert_eq!(
            serde_json::to_value(&sentence).unwrap(),
            serde_json::json!([
                { "text": "It " },
                { "text": "falls" },
                { "text": " " },
                { "text": "at " },
                { "time": { "text": "1.5000", "value": 1.5, "unit": "s", "has_unit": true } },
                { "text": ", see " },
                { "argument": { "name": "until", "values": ["2"] } },
                { "text": "." },
            ])
        );
    }

    #[test]
    fn lists_have_an_and() {
        for (parts, expected) in [
            (vec![], ""),
            (vec!["a"], "a"),
            (vec!["a", "b"], "a and b"),
            (vec!["a", "b", "c"], "a, b and c"),
        ] {
            let parts = parts.into_iter().map(Sentence::from).collect();
            assert_eq!(and(parts).to_string(), expected);
        }
    }

    #[test]
    fn counts_placeholders() {
        assert_eq!(placeholders(""), 0);
        assert_eq!(placeholders("{}"), 1);
        assert_eq!(placeholders("a {} b {}{} c"), 3);
    }
}

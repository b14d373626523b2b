//! Sentences as values.
//!
//! A [`Sentence`] is a list of typed [`Piece`]s: text, numbers with their units, times, keys of the scenario, fields,
//! counts, and arguments of the interface. The library makes each sentence once, in one place. An interface renders the
//! pieces: the terminal and documents as text, the page with degrees next to radians and its own names for keys, Python
//! with its own names for arguments. So no interface edits English, and no decision reads a text.
//!
//! A report for people is a tree of [`Section`]s, which have paragraphs and [`Table`]s of sentences.

mod count;
mod markdown;
pub mod number;
mod piece;
mod sanitize;
mod section;
mod sentence;

pub use self::count::{counted, grouped, plural};
pub use self::markdown::{markdown_line, sections as markdown};
pub use self::piece::{Argument, ArgumentStyle, Count, Estimate, Number, Piece};
pub use self::sanitize::{
    MAX_LINE, is_control, sanitized, sanitized_lines, shortened, shortened_to,
};
pub use self::section::{Column, Part, Section, Table, Tone};
pub(crate) use self::sentence::sentence;
pub use self::sentence::{Sentence, and, capitalized, placeholders, span};

//! A human-readable report: sections with tables and sentences, as text for a terminal or as Markdown.

use super::table::Table;
use super::text::{markdown_text, sanitized, sanitized_lines};
use anstyle::{AnsiColor, Effects, Style};

const FAINT: Style = Style::new().effects(Effects::DIMMED);

/// Maximum text width.
const MAX_WIDTH: usize = 100;

/// Colour of a heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Tone {
    /// Neutral.
    #[default]
    Neutral,
    /// Success.
    Good,
    /// A warning.
    Weak,
    /// An error or a difference.
    Bad,
}

impl Tone {
    fn style(self) -> Style {
        let color = match self {
            Self::Neutral => AnsiColor::Cyan,
            Self::Good => AnsiColor::Green,
            Self::Weak => AnsiColor::Yellow,
            Self::Bad => AnsiColor::Red,
        };
        color.on_default().effects(Effects::BOLD)
    }
}

/// A part of a report.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Section {
    /// Heading; empty for none.
    pub(super) title: String,
    /// Tone of the heading.
    pub(super) tone: Tone,
    /// Note next to the heading.
    pub(super) note: String,
    /// Content below the heading.
    pub(super) parts: Vec<Part>,
}

/// A part of a section.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Part {
    /// A table.
    Table(Table),
    /// A sentence or a short statement; its later lines are indented, so that statements can be told apart.
    Line(String),
    /// Several sentences of prose, with one indent.
    Paragraph(String),
    /// Verbatim text.
    Code(String),
}

impl From<Table> for Section {
    /// A table without a heading.
    fn from(table: Table) -> Self {
        let mut section = Self::default();
        section.table(table);
        section
    }
}

impl Section {
    pub(super) fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// A heading with a colour.
    pub(super) fn with_tone(tone: Tone, title: impl Into<String>) -> Self {
        Self {
            tone,
            ..Self::new(title)
        }
    }

    /// Paragraphs under a heading.
    pub(super) fn from_lines(
        title: impl Into<String>,
        lines: impl Iterator<Item = String>,
    ) -> Self {
        let mut section = Self::new(title);
        section.parts.extend(lines.map(Part::Line));
        section
    }

    /// With a heading and a note next to it.
    pub(super) fn titled(self, title: impl Into<String>, note: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            note: note.into(),
            ..self
        }
    }

    pub(super) fn line(&mut self, line: impl Into<String>) {
        self.parts.push(Part::Line(line.into()));
    }

    /// Adds a table if it has rows.
    pub(super) fn table(&mut self, table: Table) {
        if !table.rows.is_empty() {
            self.parts.push(Part::Table(table));
        }
    }

    fn text(&self, columns: Option<usize>) -> String {
        let style = self.tone.style();
        let mut text = String::new();
        if !self.title.is_empty() {
            text = format!("{style}{}{style:#}", sanitized(&self.title));
            if !self.note.is_empty() {
                text += &format!("  {FAINT}{}{FAINT:#}", sanitized(&self.note));
            }
            text.push('\n');
        }
        let mut follows_table = false;
        for part in &self.parts {
            let is_table = matches!(part, Part::Table(_));
            // Without a line between them, two tables would look like one.
            if is_table && follows_table {
                text.push('\n');
            }
            follows_table = is_table;
            match part {
                Part::Table(table) => text += &table.text(columns),
                Part::Line(line) => text += &wrapped(line, width(columns), "  ", "    "),
                Part::Paragraph(prose) => text += &wrapped(prose, width(columns), "  ", "  "),
                Part::Code(code) => text += &sanitized_lines(code),
            }
        }
        text
    }

    fn markdown(&self) -> String {
        let mut text = String::new();
        if !self.title.is_empty() {
            text = format!("## {}\n\n", markdown_text(&self.title));
        }
        if !self.note.is_empty() {
            text += &format!("{}\n\n", markdown_text(&self.note));
        }
        for part in &self.parts {
            text += &match part {
                Part::Table(table) => table.markdown() + "\n",
                Part::Line(line) | Part::Paragraph(line) => format!("{}\n\n", markdown_text(line)),
                Part::Code(code) => format!("```\n{}\n```\n\n", sanitized_lines(code.trim_end())),
            };
        }
        text
    }
}

/// Renders sections as styled text for a terminal of this width.
pub(super) fn text(sections: &[Section], columns: Option<usize>) -> String {
    sections
        .iter()
        .map(|section| section.text(columns))
        // A section may have a table without rows only.
        .filter(|block| !block.trim().is_empty())
        .collect::<Vec<_>>()
        .join("\n")
}

/// Renders sections as Markdown.
pub(super) fn markdown(sections: &[Section]) -> String {
    sections.iter().map(Section::markdown).collect()
}

/// The text width.
fn width(columns: Option<usize>) -> usize {
    // Long lines are hard to read, however wide the terminal is.
    columns.map_or(MAX_WIDTH, |columns| columns.min(MAX_WIDTH))
}

/// Wraps text at word boundaries.
fn wrapped(sentence: &str, width: usize, first: &str, next: &str) -> String {
    let options = textwrap::Options::new(width)
        .initial_indent(first)
        .subsequent_indent(next)
        // By default, numbers such as 1e-9 and the names of files are broken at their hyphens.
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(&sanitized(sentence), options) + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_sentences_are_broken_between_words() {
        assert_eq!(wrapped("one two three", 7, "", ""), "one two\nthree\n");
        assert_eq!(
            wrapped("one two three", 9, "  ", "    "),
            "  one two\n    three\n"
        );
    }

    #[test]
    fn paragraphs_have_one_indent() {
        let text = "word ".repeat(40);
        for (part, indents) in [
            (Part::Line(text.clone()), ["  ", "    ", "    "]),
            (Part::Paragraph(text), ["  ", "  ", "  "]),
        ] {
            let section = Section {
                parts: vec![part],
                ..Section::default()
            };
            let text = section.text(Some(80));
            for (line, indent) in text.lines().zip(indents) {
                let word = line.strip_prefix(indent).unwrap();
                assert!(word.starts_with("word"), "{line:?}");
            }
        }
    }

    #[test]
    fn text_out_of_files_is_harmless_everywhere() {
        let hostile = "a\x1b[2J\nerror: forged";
        let mut section = Section::new(hostile);
        hostile.clone_into(&mut section.note);
        section.line(hostile);
        section.table(Table::from_texts(vec![vec![hostile.to_owned()]]));
        section.parts.push(Part::Code("a\x1b[2J".to_owned()));
        let sections = [section];
        let plain = anstream::adapter::strip_str(&text(&sections, Some(80))).to_string();
        for text in [plain, markdown(&sections)] {
            let is_odd = |c: char| c.is_control() && c != '\n';
            assert!(!text.contains(is_odd), "{text:?}");
            assert!(!text.contains("\nerror"), "{text}");
            // Markdown has a backslash before the bracket.
            let shown = text.replace('\\', "");
            assert_eq!(shown.matches("a�[2J").count(), 5, "{text}");
        }
    }
}

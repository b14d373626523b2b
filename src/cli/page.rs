//! A human-readable report: sections with tables and sentences, as text for a terminal or as Markdown.

use super::table::Table;
use super::text::{sanitized, sanitized_lines};
use anstyle::{AnsiColor, Effects, Style};

const HEADING: Style = AnsiColor::Cyan.on_default().effects(Effects::BOLD);
const GOOD: Style = AnsiColor::Green.on_default().effects(Effects::BOLD);
const WEAK: Style = AnsiColor::Yellow.on_default().effects(Effects::BOLD);
const BAD: Style = AnsiColor::Red.on_default().effects(Effects::BOLD);
const FAINT: Style = Style::new().effects(Effects::DIMMED);

/// Maximum text width.
const MAX_WIDTH: usize = 100;

/// Check mark.
pub(super) const TICK: char = '✓';
/// Cross mark.
pub(super) const CROSS: char = '✗';

/// A human-readable report.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Page {
    /// The subject, above the title.
    pub(super) subjects: Table,
    /// The title; empty for none.
    pub(super) title: String,
    /// Tone of the title.
    pub(super) tone: Tone,
    /// The findings in a few sentences.
    pub(super) summary: Vec<String>,
    /// The rest.
    pub(super) sections: Vec<Section>,
}

/// Colour of a heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Tone {
    /// Neither good nor bad.
    #[default]
    Neutral,
    /// As it should be.
    Good,
    /// A warning.
    Weak,
    /// Wrong.
    Bad,
}

impl Tone {
    fn style(self) -> Style {
        match self {
            Self::Neutral => HEADING,
            Self::Good => GOOD,
            Self::Weak => WEAK,
            Self::Bad => BAD,
        }
    }
}

/// A part of a report.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Section {
    /// Its heading; empty for none.
    pub(super) title: String,
    /// Tone of the heading.
    pub(super) tone: Tone,
    /// Note next to the heading.
    pub(super) note: String,
    /// Its content.
    pub(super) parts: Vec<Part>,
}

/// A part of a section.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Part {
    /// A table.
    Table(Table),
    /// A paragraph.
    Line(String),
    /// Verbatim text.
    Code(String),
}

impl Section {
    pub(super) fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
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
            if is_table && follows_table {
                text.push('\n');
            }
            follows_table = is_table;
            match part {
                Part::Table(table) => text += &with_coloured_marks(&table.text(columns)),
                Part::Line(line) => text += &wrapped(line, width(columns), "  ", "    "),
                Part::Code(code) => text += &sanitized_lines(code),
            }
        }
        text
    }

    fn markdown(&self) -> String {
        let mut text = String::new();
        if !self.title.is_empty() {
            text = format!("## {}\n\n", sanitized(&self.title));
        }
        if !self.note.is_empty() {
            text += &format!("{}\n\n", sanitized(&self.note));
        }
        for part in &self.parts {
            text += &match part {
                Part::Table(table) => table.markdown() + "\n",
                Part::Line(line) => format!("{}\n\n", sanitized(line)),
                Part::Code(code) => format!("```\n{}\n```\n\n", sanitized_lines(code.trim_end())),
            };
        }
        text
    }
}

impl Page {
    /// A page with a single section.
    pub(super) fn of(section: Section) -> Self {
        Self {
            sections: vec![section],
            ..Self::default()
        }
    }

    /// Renders as styled text for a terminal of this width.
    pub(super) fn text(&self, columns: Option<usize>) -> String {
        let mut blocks = vec![self.subjects.text(columns)];
        let style = self.tone.style();
        let mut head = String::new();
        if !self.title.is_empty() {
            head = format!("{style}{}{style:#}\n", sanitized(&self.title));
        }
        if !self.summary.is_empty() {
            head += &wrapped(&self.summary.join(" "), width(columns), "", "");
        }
        blocks.push(head);
        blocks.extend(self.sections.iter().map(|section| section.text(columns)));
        blocks.retain(|block| !block.trim().is_empty());
        blocks.join("\n")
    }

    /// Renders as Markdown.
    pub(super) fn markdown(&self) -> String {
        let mut blocks = Vec::new();
        if !self.title.is_empty() {
            blocks.push(format!("# {}\n\n", sanitized(&self.title)));
        }
        if !self.summary.is_empty() {
            blocks.push(format!("{}\n\n", sanitized(&self.summary.join(" "))));
        }
        if !self.subjects.rows.is_empty() {
            blocks.push(self.subjects.markdown() + "\n");
        }
        blocks.extend(self.sections.iter().map(Section::markdown));
        blocks.concat()
    }
}

/// The text width.
fn width(columns: Option<usize>) -> usize {
    columns.map_or(MAX_WIDTH, |columns| columns.min(MAX_WIDTH))
}

/// Wraps text at word boundaries.
fn wrapped(sentence: &str, width: usize, first: &str, next: &str) -> String {
    let options = textwrap::Options::new(width)
        .initial_indent(first)
        .subsequent_indent(next)
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(&sanitized(sentence), options) + "\n"
}

/// Colours check and cross marks.
fn with_coloured_marks(text: &str) -> String {
    [(TICK, GOOD), (CROSS, BAD)]
        .into_iter()
        .fold(text.to_owned(), |text, (sign, style)| {
            text.replace(sign, &format!("{style}{sign}{style:#}"))
        })
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
    fn text_out_of_files_is_harmless_everywhere() {
        let hostile = "a\x1b[2J\nerror: forged";
        let mut section = Section::new(hostile);
        hostile.clone_into(&mut section.note);
        section.line(hostile);
        section.table(Table::of_texts(vec![vec![hostile.to_owned()]]));
        section.parts.push(Part::Code("a\x1b[2J".to_owned()));
        let page = Page {
            subjects: Table::of_texts(vec![vec![hostile.to_owned()]]),
            title: hostile.to_owned(),
            summary: vec![hostile.to_owned()],
            sections: vec![section],
            ..Page::default()
        };
        let plain = anstream::adapter::strip_str(&page.text(Some(80))).to_string();
        for text in [plain, page.markdown()] {
            let is_odd = |c: char| c.is_control() && c != '\n';
            assert!(!text.contains(is_odd), "{text:?}");
            assert!(!text.contains("\nerror"), "{text}");
            assert_eq!(text.matches("a�[2J").count(), 8, "{text}");
        }
    }
}

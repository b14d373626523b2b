//! A report as sections with tables and sentences, and that as text for a terminal or as Markdown.

use super::format;
use anstyle::{AnsiColor, Effects, Style};
use std::fmt::Write as _;
use unicode_width::UnicodeWidthStr as _;

/// Nothing is wider.
const WIDTH: usize = 100;

const HEADING: Style = AnsiColor::Cyan.on_default().effects(Effects::BOLD);
const FAINT: Style = Style::new().effects(Effects::DIMMED);

/// A report for people.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Page {
    /// The verdict in a word or two.
    pub(super) title: String,
    /// What the title is coloured with.
    pub(super) tone: Tone,
    /// The runs.
    pub(super) runs: Table,
    /// Sentences.
    pub(super) summary: Vec<String>,
    pub(super) sections: Vec<Section>,
}

/// Whether something is good news.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Tone {
    #[default]
    Same,
    Different,
}

/// A part of a report.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Section {
    pub(super) title: &'static str,
    /// What there is to know beside the title.
    pub(super) note: String,
    pub(super) parts: Vec<Part>,
}

/// A part of a section.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Part {
    Table(Table),
    Line(String),
}

/// Cells in rows; all but the first columns are aligned to the right.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Table {
    /// Names of the columns; none for a table without.
    pub(super) header: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    /// So many columns are aligned to the left.
    pub(super) left: usize,
}

impl Section {
    pub(super) fn new(title: &'static str, note: String) -> Self {
        Self {
            title,
            note,
            parts: Vec::new(),
        }
    }

    pub(super) fn line(&mut self, line: String) {
        self.parts.push(Part::Line(line));
    }

    /// Adds a table if it has rows.
    pub(super) fn table(&mut self, table: Table) {
        if !table.rows.is_empty() {
            self.parts.push(Part::Table(table));
        }
    }
}

impl Page {
    /// For a terminal, with colours that are to be taken out where they are not wanted.
    pub(super) fn text(&self) -> String {
        let colour = match self.tone {
            Tone::Same => AnsiColor::Green,
            Tone::Different => AnsiColor::Yellow,
        };
        let title = colour.on_default().effects(Effects::BOLD);
        let mut text = self.runs.text();
        if !text.is_empty() {
            text.push('\n');
        }
        let _ = writeln!(text, "{title}{}{title:#}", self.title);
        if !self.summary.is_empty() {
            for line in wrapped(&self.summary.join(" "), WIDTH) {
                let _ = writeln!(text, "{line}");
            }
        }
        for section in &self.sections {
            let _ = write!(text, "\n{HEADING}{}{HEADING:#}", section.title);
            if !section.note.is_empty() {
                let _ = write!(text, "  {FAINT}{}{FAINT:#}", section.note);
            }
            text.push('\n');
            for part in &section.parts {
                match part {
                    Part::Table(table) => text.push_str(&table.text()),
                    Part::Line(line) => {
                        for (at, line) in wrapped(line, WIDTH - 4).iter().enumerate() {
                            let indent = if at == 0 { "  " } else { "    " };
                            let _ = writeln!(text, "{indent}{line}");
                        }
                    }
                }
            }
        }
        text
    }

    /// For documents.
    pub(super) fn markdown(&self) -> String {
        let mut text = format!("# {}\n\n{}\n", self.title, self.summary.join(" "));
        if !self.runs.rows.is_empty() {
            let _ = write!(text, "\n{}", self.runs.markdown());
        }
        for section in &self.sections {
            let _ = writeln!(text, "\n## {}\n", section.title);
            if !section.note.is_empty() {
                let _ = writeln!(text, "{}\n", section.note);
            }
            for part in &section.parts {
                let _ = match part {
                    Part::Table(table) => writeln!(text, "{}", table.markdown()),
                    Part::Line(line) => writeln!(text, "{line}\n"),
                };
            }
        }
        text
    }
}

impl Table {
    fn text(&self) -> String {
        let rows: Vec<_> = std::iter::once(&self.header)
            .chain(&self.rows)
            .cloned()
            .collect();
        let lines = format::aligned(&rows, |column| column >= self.left);
        let mut text = String::new();
        for (at, line) in lines
            .iter()
            .enumerate()
            .filter(|(_, line)| !line.is_empty())
        {
            let _ = match at {
                0 => writeln!(text, "{FAINT}{line}{FAINT:#}"),
                _ => writeln!(text, "{line}"),
            };
        }
        text
    }

    fn markdown(&self) -> String {
        let columns = self
            .rows
            .iter()
            .map(Vec::len)
            .max()
            .unwrap_or(0)
            .max(self.header.len());
        let row = |cells: &[String]| {
            let cell = |at: usize| {
                cells.get(at).map_or(String::new(), |cell| {
                    format::harmless(cell).replace('|', "\\|")
                })
            };
            let cells: Vec<String> = (0..columns).map(cell).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = |at: usize| if at < self.left { ":--" } else { "--:" }.to_owned();
        let mut text = row(&self.header);
        text += &row(&(0..columns).map(rule).collect::<Vec<_>>());
        for cells in &self.rows {
            text += &row(cells);
        }
        text
    }
}

/// A text broken between words into lines that are not wider.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in format::harmless(text).split(' ') {
        let Some(line) = lines.last_mut() else {
            continue;
        };
        if line.is_empty() {
            line.push_str(word);
        } else if line.width() + 1 + word.width() <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combining_marks_take_no_room() {
        let table = Table {
            header: vec!["a".to_owned(), "b".to_owned()],
            rows: vec![
                vec!["φ̇".to_owned(), "1".to_owned()],
                vec!["xx".to_owned(), "22".to_owned()],
            ],
            left: 1,
        };
        let text = anstream::adapter::strip_str(&table.text()).to_string();
        assert_eq!(text, "  a    b\n  φ̇    1\n  xx  22\n");
        assert_eq!(
            table.markdown(),
            "| a | b |\n| :-- | --: |\n| φ̇ | 1 |\n| xx | 22 |\n"
        );
    }

    #[test]
    fn long_texts_are_broken_between_words() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("", 7), [""]);
    }
}

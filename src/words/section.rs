//! A report for people: sections with sentences and tables.

use super::piece::ArgumentStyle;
use super::sentence::Sentence;
use schemars::JsonSchema;
use serde::Serialize;

/// Significance of a heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Tone {
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

/// A part of a report.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Section {
    /// Heading; empty for none.
    pub title: Sentence,
    /// Tone of the heading.
    pub tone: Tone,
    /// Note next to the heading.
    pub note: Sentence,
    /// Content below the heading.
    pub parts: Vec<Part>,
}

/// A part of a section.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// A table.
    Table(Table),
    /// A sentence or a short statement; its later lines are indented, so that statements can be told apart.
    Line(Sentence),
    /// Several sentences of prose, with one indent.
    Paragraph(Sentence),
    /// Verbatim text.
    Code(String),
}

/// A table. The first `left` columns contain text and may be wrapped; the others contain right-aligned numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Table {
    /// Names of the columns; empty for a table without.
    pub header: Vec<Sentence>,
    /// The cells.
    pub rows: Vec<Vec<Sentence>>,
    /// Number of columns that hold text.
    pub left: usize,
}

/// A column of a table: its name, and its cell in the row of an item.
pub type Column<T, C = String> = (&'static str, fn(&T) -> C);

impl From<Table> for Section {
    /// A table without a heading.
    fn from(table: Table) -> Self {
        let mut section = Self::default();
        section.table(table);
        section
    }
}

impl Section {
    /// An empty section with a heading.
    pub fn new(title: impl Into<Sentence>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// An empty section with a heading of this tone.
    pub fn with_tone(tone: Tone, title: impl Into<Sentence>) -> Self {
        Self {
            tone,
            ..Self::new(title)
        }
    }

    /// Lines under a heading.
    pub fn from_lines<S: Into<Sentence>>(
        title: impl Into<Sentence>,
        lines: impl IntoIterator<Item = S>,
    ) -> Self {
        let mut section = Self::new(title);
        for line in lines {
            section.line(line);
        }
        section
    }

    /// The section with a heading and a note next to it.
    #[must_use]
    pub fn titled(self, title: impl Into<Sentence>, note: impl Into<Sentence>) -> Self {
        Self {
            title: title.into(),
            note: note.into(),
            ..self
        }
    }

    /// The section for programs, as text with plain numbers.
    #[must_use]
    pub fn with_plain_numbers(&self, arguments: ArgumentStyle) -> Self {
        let plain = |sentence: &Sentence| sentence.with_plain_numbers(arguments);
        let mut section = Self {
            title: plain(&self.title),
            note: plain(&self.note),
            tone: self.tone,
            parts: Vec::new(),
        };
        for part in &self.parts {
            section.parts.push(match part {
                Part::Table(table) => Part::Table(Table {
                    header: table.header.iter().map(plain).collect(),
                    rows: table
                        .rows
                        .iter()
                        .map(|row| row.iter().map(plain).collect())
                        .collect(),
                    left: table.left,
                }),
                Part::Line(line) => Part::Line(plain(line)),
                Part::Paragraph(prose) => Part::Paragraph(plain(prose)),
                Part::Code(code) => Part::Code(code.clone()),
            });
        }
        section
    }

    /// Adds a line.
    pub fn line(&mut self, line: impl Into<Sentence>) {
        self.parts.push(Part::Line(line.into()));
    }

    /// Adds a table if it has rows.
    pub fn table(&mut self, table: Table) {
        if !table.rows.is_empty() {
            self.parts.push(Part::Table(table));
        }
    }
}

impl Table {
    /// A row for each item; the first `left` columns hold text.
    pub fn new<T, C: Into<Sentence>>(
        items: impl IntoIterator<Item = T>,
        left: usize,
        columns: &[Column<T, C>],
    ) -> Self {
        let mut rows = Vec::new();
        for item in items {
            rows.push(columns.iter().map(|(_, cell)| cell(&item).into()).collect());
        }
        Self {
            header: columns.iter().map(|(name, _)| (*name).into()).collect(),
            rows,
            left,
        }
    }

    /// A table of text without a header.
    pub fn from_texts<C: Into<Sentence>>(rows: impl IntoIterator<Item = Vec<C>>) -> Self {
        Self {
            header: Vec::new(),
            rows: rows
                .into_iter()
                .map(|row| row.into_iter().map(Into::into).collect())
                .collect(),
            left: usize::MAX,
        }
    }

    /// A list of facts, each with a label.
    pub fn from_facts<'a, C: Into<Sentence>>(
        facts: impl IntoIterator<Item = (&'a str, C)>,
    ) -> Self {
        Self::from_texts(
            facts
                .into_iter()
                .map(|(label, fact)| vec![Sentence::from(label), fact.into()]),
        )
    }

    /// Number of columns of the widest row.
    pub fn columns(&self) -> usize {
        let widest = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        widest.max(self.header.len())
    }

    /// Whether a column has a name.
    pub fn has_header(&self) -> bool {
        self.header.iter().any(|name| !name.is_empty())
    }
}

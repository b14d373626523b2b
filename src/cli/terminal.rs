//! Reports as text for a terminal.

use crate::words::{Argument, Part, Section, Sentence, Table, Tone, sanitized, sanitized_lines};
use anstyle::{AnsiColor, Effects, Style};
use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, Table as Layout, TableComponent, presets,
};
use std::borrow::Cow;

const FAINT: Style = Style::new().effects(Effects::DIMMED);

/// Maximum text width.
const MAX_WIDTH: usize = 100;

/// Marks the end of the header; can't occur in sanitised cells.
const RULE: char = '\u{1}';

/// An argument as options of the command line.
pub(super) fn option(argument: &Argument) -> String {
    let name = argument.name;
    let mut options = Vec::new();
    for value in &argument.values {
        // Column names need quotes, fields don't.
        options.push(match value.split_once('=') {
            Some((field, column)) => format!("--{name} {field}={}", quoted(column)),
            None => format!("--{name} {}", quoted(value)),
        });
    }
    match options[..] {
        [] => format!("--{name}"),
        _ => options.join(" "),
    }
}

fn is_plain(character: char) -> bool {
    character.is_alphanumeric() || "_.,:/+-".contains(character)
}

/// A word, in quotes if a shell may read it otherwise. Names of columns come from files: in the quotes, nothing is expanded.
fn quoted(word: &str) -> Cow<'_, str> {
    if word.chars().all(is_plain) {
        return Cow::Borrowed(word);
    }
    let mut quoted = String::from('"');
    for character in word.chars() {
        if matches!(character, '"' | '\\' | '$' | '`') {
            quoted.push('\\');
        }
        quoted.push(character);
    }
    quoted.push('"');
    Cow::Owned(quoted)
}

/// Renders sections as styled text for a terminal of this width.
pub(super) fn render(sections: &[Section], columns: Option<usize>) -> String {
    sections
        .iter()
        .map(|section| render_section(section, columns))
        // A section may have a table without rows only.
        .filter(|block| !block.trim().is_empty())
        .collect::<Vec<_>>()
        .join("\n")
}

fn heading_style(tone: Tone) -> Style {
    let color = match tone {
        Tone::Neutral => AnsiColor::Cyan,
        Tone::Good => AnsiColor::Green,
        Tone::Weak => AnsiColor::Yellow,
        Tone::Bad => AnsiColor::Red,
    };
    color.on_default().effects(Effects::BOLD)
}

fn render_section(section: &Section, columns: Option<usize>) -> String {
    let style = heading_style(section.tone);
    let mut text = String::new();
    if !section.title.is_empty() {
        text = format!("{style}{}{style:#}", line(&section.title));
        if !section.note.is_empty() {
            text += &format!("  {FAINT}{}{FAINT:#}", line(&section.note));
        }
        text.push('\n');
    }
    let mut follows_table = false;
    for part in &section.parts {
        let is_table = matches!(part, Part::Table(_));
        // Without a line between them, two tables would look like one.
        if is_table && follows_table {
            text.push('\n');
        }
        follows_table = is_table;
        match part {
            Part::Table(table) => text += &render_table(table, columns),
            Part::Line(sentence) => text += &wrapped(sentence, width(columns), ["  ", "    "]),
            Part::Paragraph(prose) => text += &wrapped(prose, width(columns), ["  ", "  "]),
            Part::Code(code) => text += &sanitized_lines(code),
        }
    }
    text
}

/// A sentence as one sanitised line.
fn line(sentence: &Sentence) -> String {
    sanitized(&sentence.text(option)).into_owned()
}

/// The text width.
fn width(columns: Option<usize>) -> usize {
    // Long lines are hard to read, however wide the terminal is.
    columns.map_or(MAX_WIDTH, |columns| columns.min(MAX_WIDTH))
}

/// Wraps a sentence at word boundaries, with indents of the first line and of the others.
fn wrapped(sentence: &Sentence, width: usize, [first, next]: [&str; 2]) -> String {
    let options = textwrap::Options::new(width)
        .initial_indent(first)
        .subsequent_indent(next)
        // By default, numbers such as 1e-9 and the names of files are broken at their hyphens.
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(&line(sentence), options) + "\n"
}

/// Renders a table with a dimmed header. Wraps text columns if the table is wider than the terminal.
fn render_table(table: &Table, columns: Option<usize>) -> String {
    let mut layout = Layout::new();
    layout.load_preset(presets::NOTHING);
    if let Some(columns) = columns {
        layout
            .set_content_arrangement(ContentArrangement::Dynamic)
            .set_width(u16::try_from(columns).unwrap_or(u16::MAX));
    }
    let width = table.columns();
    if table.has_header() {
        layout
            .set_style(TableComponent::HeaderLines, RULE)
            .set_header(cells(&table.header, width));
    }
    layout.add_rows(table.rows.iter().map(|row| cells(row, width)));
    for (at, column) in layout.column_iter_mut().enumerate() {
        // Padding on the right would end each line with spaces.
        column.set_padding((2, 0));
        if at >= table.left {
            column.set_cell_alignment(CellAlignment::Right);
            // A number broken into two lines could be read as two.
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    let mut text = String::new();
    let mut is_header = table.has_header();
    for line in layout.to_string().lines().map(str::trim_end) {
        if line.contains(RULE) {
            is_header = false;
        } else if is_header {
            text.push_str(&format!("{FAINT}{line}{FAINT:#}\n"));
        } else {
            text.push_str(&format!("{line}\n"));
        }
    }
    text
}

/// The sanitised cells of a row; empty ones at the end, if it has fewer.
fn cells(row: &[Sentence], columns: usize) -> Vec<String> {
    (0..columns)
        .map(|at| row.get(at).map_or_else(String::new, line))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::markdown;

    #[test]
    fn long_sentences_are_broken_between_words() {
        let sentence = Sentence::from("one two three");
        assert_eq!(wrapped(&sentence, 7, ["", ""]), "one two\nthree\n");
        assert_eq!(
            wrapped(&sentence, 9, ["  ", "    "]),
            "  one two\n    three\n"
        );
    }

    #[test]
    fn paragraphs_have_one_indent() {
        let text = "word ".repeat(40);
        for (part, indents) in [
            (Part::Line(text.clone().into()), ["  ", "    ", "    "]),
            (Part::Paragraph(text.into()), ["  ", "  ", "  "]),
        ] {
            let section = Section {
                parts: vec![part],
                ..Section::default()
            };
            let text = render_section(&section, Some(80));
            for (line, indent) in text.lines().zip(indents) {
                let word = line.strip_prefix(indent).unwrap();
                assert!(word.starts_with("word"), "{line:?}");
            }
        }
    }

    #[test]
    fn arguments_are_options() {
        for (values, expected) in [
            (&[][..], "--signal"),
            (&["theta=tilt"], "--signal theta=tilt"),
            (&["theta=$(a)`\"\\"], r#"--signal theta="\$(a)\`\"\\""#),
            (&["theta=2 (deg)"], "--signal theta=\"2 (deg)\""),
            (&["t [s]"], "--signal \"t [s]\""),
            (
                &["theta=tilt", "phi=azimuth"],
                "--signal theta=tilt --signal phi=azimuth",
            ),
        ] {
            let argument = Argument {
                name: "signal",
                values: values.iter().map(|value| (*value).to_owned()).collect(),
            };
            assert_eq!(option(&argument), expected);
        }
    }

    #[test]
    fn text_out_of_files_is_harmless_everywhere() {
        let hostile = "a\x1b[2J\nerror: forged";
        let mut section = Section::new(hostile);
        section.note = hostile.into();
        section.line(hostile);
        section.table(Table::from_texts(vec![vec![hostile]]));
        section.parts.push(Part::Code("a\x1b[2J".to_owned()));
        let sections = [section];
        let plain = anstream::adapter::strip_str(&render(&sections, Some(80))).to_string();
        for text in [plain, markdown(&sections, option)] {
            let is_odd = |c: char| c.is_control() && c != '\n';
            assert!(!text.contains(is_odd), "{text:?}");
            assert!(!text.contains("\nerror"), "{text}");
            // Markdown has a backslash before the bracket.
            let shown = text.replace('\\', "");
            assert_eq!(shown.matches("a�[2J").count(), 5, "{text}");
        }
    }

    fn plain(table: &Table, columns: Option<usize>) -> String {
        anstream::adapter::strip_str(&render_table(table, columns)).to_string()
    }

    #[test]
    fn aligns_columns_with_combining_marks() {
        let table = Table {
            header: vec!["a".into(), "b".into()],
            rows: vec![vec!["φ̇".into(), "1".into()], vec!["xx".into(), "22".into()]],
            left: 1,
        };
        assert_eq!(plain(&table, None), "  a    b\n  φ̇    1\n  xx  22\n");
    }

    #[test]
    fn wraps_text_but_not_numbers() {
        let table = Table {
            header: Vec::new(),
            rows: vec![vec!["one two three".into(), "12345678".into()]],
            left: 1,
        };
        let narrow = plain(&table, Some(20));
        assert_eq!(narrow, "  one two   12345678\n  three\n");
        // In a pipe or a file, each row is one line.
        assert_eq!(plain(&table, None), "  one two three  12345678\n");
    }

    #[test]
    fn sanitizes_cells() {
        let table = Table::from_texts(vec![vec!["a\n\x1b[2Jb"]]);
        assert_eq!(plain(&table, None), "  a��[2Jb\n");
    }
}

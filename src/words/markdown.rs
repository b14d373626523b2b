//! Reports as Markdown.

use super::piece::ArgumentStyle;
use super::sanitize::{sanitized, sanitized_lines};
use super::section::{Part, Section, Table};
use super::sentence::Sentence;

/// Renders sections as Markdown; arguments are written as the interface does.
pub fn sections(sections: &[Section], arguments: ArgumentStyle) -> String {
    let writer = Writer { arguments };
    sections
        .iter()
        .map(|section| writer.section(section))
        .collect()
}

struct Writer {
    arguments: ArgumentStyle,
}

impl Writer {
    fn section(&self, section: &Section) -> String {
        let mut text = String::new();
        if !section.title.is_empty() {
            text = format!("## {}\n\n", self.sentence(&section.title));
        }
        if !section.note.is_empty() {
            text += &format!("{}\n\n", self.sentence(&section.note));
        }
        for part in &section.parts {
            text += &match part {
                Part::Table(table) => self.table(table) + "\n",
                Part::Line(line) | Part::Paragraph(line) => format!("{}\n\n", self.sentence(line)),
                Part::Code(code) => format!("```\n{}\n```\n\n", sanitized_lines(code.trim_end())),
            };
        }
        text
    }

    fn table(&self, table: &Table) -> String {
        let columns = table.columns();
        let rule: Vec<&str> = (0..columns)
            .map(|at| if at < table.left { ":--" } else { "--:" })
            .collect();
        let mut text = self.row(&table.header, columns);
        text += &format!("| {} |\n", rule.join(" | "));
        for cells in &table.rows {
            text += &self.row(cells, columns);
        }
        text
    }

    fn row(&self, row: &[Sentence], columns: usize) -> String {
        let cells: Vec<String> = (0..columns)
            .map(|at| {
                row.get(at)
                    .map_or_else(String::new, |cell| self.sentence(cell))
            })
            .collect();
        format!("| {} |\n", cells.join(" | "))
    }

    fn sentence(&self, sentence: &Sentence) -> String {
        markdown_line(&sentence.text(self.arguments))
    }
}

/// A sanitised single line without characters that would be markup. Between letters, `_` is not markup.
pub fn markdown_line(text: &str) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::Argument;

    #[test]
    fn lines_have_no_markup() {
        for (text, expected) in [
            ("/camera/__raw__ *b*", r"/camera/\_\_raw\_\_ \*b\*"),
            (
                "initial.psi_dot ~ [x](y) <b> a|b",
                r"initial.psi_dot \~ \[x\](y) \<b\> a\|b",
            ),
            (r"`a\`", r"\`a\\\`"),
        ] {
            assert_eq!(markdown_line(text), expected);
        }
    }

    #[test]
    fn tables_have_a_rule_below_their_header() {
        let table = Table {
            header: vec!["a".into(), "b".into()],
            rows: vec![vec!["φ̇".into(), "1".into()], vec!["xx".into(), "22".into()]],
            left: 1,
        };
        assert_eq!(
            sections(&[table.into()], Argument::plain),
            "| a | b |\n| :-- | --: |\n| φ̇ | 1 |\n| xx | 22 |\n\n"
        );
    }
}

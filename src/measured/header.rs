//! The header of a text table: the line that names the columns, and the first row below it.

use super::cell::{Cell, is_missing};
use super::column::clocks;
use super::delimiter::{Delimiter, is_blank, is_comment, without_runs};
use super::unit::{bare_unit, is_unit};
use csv::StringRecord;

/// A header.
#[derive(Debug, PartialEq)]
pub(super) struct TableHeader {
    /// Names of the columns, with their units; empty if no line names them.
    pub names: Vec<String>,
    /// Index of the first record that can be a row.
    pub first_row: usize,
    /// Whether the first column has the names of rows, for which the line has no name.
    pub has_row_names: bool,
}

/// Finds the header: the last line that names the column of times before the first row with a time. All below it are
/// rows, also those with cells that are no numbers. If no line names the times, the header is the last line of text
/// before the first row of numbers.
pub(super) fn find(
    text: &str,
    delimiter: Delimiter,
    time: Option<&str>,
) -> csv::Result<TableHeader> {
    let mut search = HeaderSearch {
        delimiter,
        time,
        named: None,
        titles: Titles::default(),
        before_numbers: None,
        has_rows: false,
    };
    for (index, record) in delimiter.records(text).enumerate() {
        let record = record?;
        if is_blank(&record) {
            continue;
        }
        if is_comment(&record) {
            search.read_comment(index, &record);
        } else {
            search.read_line(index, record);
        }
        if search.has_rows {
            break;
        }
    }
    Ok(search.header())
}

/// The state of a search.
struct HeaderSearch<'a> {
    delimiter: Delimiter,
    /// Name of the column of times, if it is given.
    time: Option<&'a str>,
    /// The last line that names the column of times.
    named: Option<Named>,
    titles: Titles,
    /// The titles before the first line that has any number.
    before_numbers: Option<Titles>,
    /// Whether the first row was read: one with a time, or one of numbers only if no line names the times.
    has_rows: bool,
}

/// A line that names the column of times.
struct Named {
    header: TableHeader,
    /// Index of the column of times.
    clock: usize,
    is_comment: bool,
    /// Whether the rows must have as many cells: sentences can begin with a name of times.
    must_fit: bool,
    /// Whether no other line was read below it: that may have the units.
    is_last: bool,
}

/// The last two lines that have no numbers.
#[derive(Clone, Default)]
struct Titles {
    lines: [StringRecord; 2],
    /// Index of the record after the last one.
    end: usize,
}

impl HeaderSearch<'_> {
    /// A comment is a header only where no other line is one: `# t,theta` as NumPy writes it.
    fn read_comment(&mut self, index: usize, record: &StringRecord) {
        let has_header = self.named.as_ref().is_some_and(|named| !named.is_comment);
        if !has_header {
            self.name_columns(index, &self.uncommented(record), true);
        }
    }

    fn read_line(&mut self, index: usize, record: StringRecord) {
        if let Some(named) = &mut self.named {
            if std::mem::take(&mut named.is_last) && named.add_units(index, &record) {
                return;
            }
            if self.delimiter == Delimiter::Blanks && named.lacks_row_names(&record) {
                named.header.names.insert(0, "1".to_owned());
                named.header.has_row_names = true;
                self.has_rows = true;
                return;
            }
            let cell = record.get(named.clock).unwrap_or_default();
            if Cell::parse(cell).is_number() {
                // A sentence that begins with a name of times has another number of words.
                let is_sentence = named.must_fit && !named.fits(&record);
                if !is_sentence {
                    self.has_rows = true;
                    return;
                }
                self.named = None;
            }
        }
        let names = match self.delimiter {
            Delimiter::Blanks => between_commas(&record),
            Delimiter::Tab | Delimiter::Semicolon | Delimiter::Comma => None,
        };
        if self.name_columns(index, names.as_ref().unwrap_or(&record), false) {
            return;
        }
        if self.named.as_ref().is_some_and(|named| !named.is_comment) {
            return;
        }
        let (mut numbers, mut texts) = (0, 0);
        for cell in &record {
            match Cell::parse(cell) {
                Cell::Number(..) | Cell::Unclear(..) | Cell::Grouped => numbers += 1,
                Cell::Text => texts += 1,
                Cell::Missing => {}
            }
        }
        if numbers > 0 {
            if self.named.is_some() {
                return;
            }
            self.before_numbers
                .get_or_insert_with(|| self.titles.clone());
            self.has_rows = texts == 0 && record.len() > 1;
        } else if texts > 0 && record.len() > 1 {
            // A single cell is a title, and names no column. A line of names below a comment is the header.
            self.named = None;
            self.titles.add(index, record);
        }
    }

    /// Whether a line is a header that names the column of times.
    fn name_columns(&mut self, index: usize, record: &StringRecord, is_comment: bool) -> bool {
        let names = names(record);
        let Some(clock) = clocks(&names, self.time).first().copied() else {
            return false;
        };
        // In a table without header, a number is no name, and `--time 1` means the first column.
        let has_text = record.iter().any(|cell| Cell::parse(cell) == Cell::Text);
        let is_number = Cell::parse(record.get(clock).unwrap_or_default()).is_number();
        // A column may be called `seconds`, but a line of units only belongs to the one before it.
        let is_all_units = record
            .iter()
            .all(|cell| cell.is_empty() || is_unit(bare_unit(cell)));
        if record.len() < 2 || is_number || !has_text || is_all_units {
            return false;
        }
        self.named = Some(Named {
            header: TableHeader {
                names,
                first_row: index + 1,
                has_row_names: false,
            },
            clock,
            is_comment,
            must_fit: is_comment || self.delimiter == Delimiter::Blanks,
            is_last: true,
        });
        true
    }

    /// The cells of a comment. NumPy separates names by what its user writes, whatever separates the numbers.
    fn uncommented(&self, record: &StringRecord) -> StringRecord {
        let mut cells = record.iter();
        let first = cells.next().unwrap_or_default();
        let first = first.trim_start_matches(['#', '%']).trim();
        if record.len() == 1 {
            let words: StringRecord = first.split_whitespace().collect();
            return without_runs(&words);
        }
        let all: StringRecord = std::iter::once(first).chain(cells).collect();
        match self.delimiter {
            // The sign may be a cell of its own.
            Delimiter::Blanks => between_commas(&all).unwrap_or_else(|| without_runs(&all)),
            Delimiter::Tab | Delimiter::Semicolon | Delimiter::Comma => all,
        }
    }

    fn header(self) -> TableHeader {
        match (self.named, self.before_numbers) {
            (Some(named), _) => named.header,
            (None, Some(_)) if self.has_rows => self.titles.header(),
            (None, Some(titles)) => titles.header(),
            (None, None) => Titles::default().header(),
        }
    }
}

impl Named {
    /// Whether a row has as many cells. Those at its end may be empty.
    fn fits(&self, row: &StringRecord) -> bool {
        let names = self.header.names.len();
        names <= row.len() && row.iter().skip(names).all(str::is_empty)
    }

    /// Whether the first row has a name, for which the header has no column: R and pandas write tables so.
    fn lacks_row_names(&self, row: &StringRecord) -> bool {
        let first = row.get(0).unwrap_or_default();
        let is_name = ["0", "1"].contains(&first) || Cell::parse(first) == Cell::Text;
        let time = row.get(self.clock + 1).unwrap_or_default();
        row.len() == self.header.names.len() + 1 && is_name && Cell::parse(time).is_number()
    }

    /// Adds the units of a line below the header, if it is one of units.
    fn add_units(&mut self, index: usize, record: &StringRecord) -> bool {
        let of_times = record.get(self.clock).unwrap_or_default();
        let is_clock_unit = is_missing(of_times) || is_unit(bare_unit(of_times));
        if !is_clock_unit || !is_unit_line(record) {
            return false;
        }
        add_units(&mut self.header.names, record);
        self.header.first_row = index + 1;
        true
    }
}

impl Titles {
    fn add(&mut self, index: usize, record: StringRecord) {
        let [_, last] = std::mem::take(&mut self.lines);
        self.lines = [last, record];
        self.end = index + 1;
    }

    fn header(&self) -> TableHeader {
        let [before, last] = &self.lines;
        let names = if before.len() == last.len() && is_unit_line(last) {
            let mut names = names(before);
            add_units(&mut names, last);
            names
        } else {
            names(last)
        };
        TableHeader {
            names,
            first_row: self.end,
            has_row_names: false,
        }
    }
}

/// Whether the first cell can be the name of a row: a whole number or a text.
pub(super) fn is_row_name(row: &StringRecord) -> bool {
    let first = row.get(0).unwrap_or_default();
    first.parse::<u64>().is_ok() || Cell::parse(first) == Cell::Text
}

/// The names in a line of a table between spaces, if they are between commas.
fn between_commas(record: &StringRecord) -> Option<StringRecord> {
    let text = record.iter().collect::<Vec<_>>().join(" ");
    text.contains(',')
        .then(|| text.split(',').map(str::trim).collect())
}

/// The names in a line; numbers from 1 where a cell is empty.
fn names(record: &StringRecord) -> Vec<String> {
    let mut names = Vec::new();
    for (at, cell) in record.iter().enumerate() {
        if cell.is_empty() {
            names.push((at + 1).to_string());
        } else {
            names.push(with_run_first(cell));
        }
    }
    names
}

/// A name as Vernier writes it: `Run #1: Time (s)` for PASCO's `Time (s) Run #1`, so that the unit is at the end.
fn with_run_first(cell: &str) -> String {
    match cell.rsplit_once(" Run #") {
        Some((name, run)) if run.parse::<u32>().is_ok() => format!("Run #{run}: {name}"),
        Some(_) | None => cell.to_owned(),
    }
}

/// Whether a line has units and no numbers.
fn is_unit_line(record: &StringRecord) -> bool {
    record.iter().any(|cell| is_unit(bare_unit(cell)))
        && !record.iter().any(|cell| Cell::parse(cell).is_number())
}

fn add_units(names: &mut [String], units: &StringRecord) {
    for (name, unit) in names.iter_mut().zip(units) {
        if !is_missing(unit) {
            *name = format!("{name} ({})", bare_unit(unit));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::too_many_lines, reason = "a table of cases")]
    fn finds_headers() {
        for (name, text, time, names, first_row) in [
            ("plain", "t,theta\n0,1", None, &["t", "theta"][..], 1),
            (
                "a text in all rows",
                "t,theta,x\n0,1,ok\n1,2,ok",
                None,
                &["t", "theta", "x"],
                1,
            ),
            (
                "an error in the first row",
                "t,theta\n0,#REF!\n1,2",
                None,
                &["t", "theta"],
                1,
            ),
            (
                "no time in the first row",
                "t,theta\nabc,1\n1,2",
                None,
                &["t", "theta"],
                1,
            ),
            (
                "no number in the first row",
                "t,theta\nabc,def\n1,2",
                None,
                &["t", "theta"],
                1,
            ),
            (
                "no row with a time",
                "t,theta\nabc,def",
                None,
                &["t", "theta"],
                1,
            ),
            (
                "titles",
                "Time,12:00\nDate,2026\nt,theta\n0,1",
                None,
                &["t", "theta"],
                3,
            ),
            (
                "numbers before",
                "3\n501\nt,theta\n0,1",
                None,
                &["t", "theta"],
                3,
            ),
            (
                "units",
                "Time,Tilt,x\ns,deg,kg\n0,1,2",
                None,
                &["Time (s)", "Tilt (deg)", "x (kg)"],
                2,
            ),
            (
                "units in brackets",
                "t,θ\n(s),[°]\n0,1",
                None,
                &["t (s)", "θ (°)"],
                2,
            ),
            (
                "names of units",
                "Time,θ\nseconds,\n0,1",
                None,
                &["Time (seconds)", "θ"],
                2,
            ),
            (
                "unknown times, names of units",
                "Elapsed,Tilt\nseconds,deg\n0,1",
                None,
                &["Elapsed (seconds)", "Tilt (deg)"],
                2,
            ),
            (
                "times called by their unit",
                "seconds,theta\n0,1",
                None,
                &["seconds", "theta"],
                1,
            ),
            ("NumPy", "# t,theta\n0,1", None, &["t", "theta"], 1),
            ("NumPy, spaces", "# t theta\n0,1", None, &["t", "theta"], 1),
            (
                "comments",
                "# t,theta\nt,phi\n# t,psi\n0,1",
                None,
                &["t", "phi"],
                3 - 1,
            ),
            (
                "given time",
                "t,frame,x\n0,1,ok",
                Some("Frame"),
                &["t", "frame", "x"],
                1,
            ),
            ("no clock", "a,theta\n0,1", None, &["a", "theta"], 1),
            (
                "no clock, units",
                "a,theta\ns,deg\n0,1",
                None,
                &["a (s)", "theta (deg)"],
                2,
            ),
            (
                "no clock, a text in all rows",
                "a,theta\n0,ok\n1,ok\nend,end",
                None,
                &["a", "theta"],
                1,
            ),
            (
                "no clock, an error in the first row",
                "a,b\n0,#REF!\n1,2",
                None,
                &["a", "b"],
                1,
            ),
            ("no header", "0,1\n1,2", Some("1"), &[], 0),
            (
                "no header, a number like the name",
                "1,0,ok\n2,1,ok",
                Some("1"),
                &[],
                0,
            ),
            (
                "an index without a name",
                ",theta\n0,1",
                Some("1"),
                &["1", "theta"],
                1,
            ),
            (
                "numbers as names",
                "t,3,2\n0,1,2",
                None,
                &["t", "3", "2"],
                1,
            ),
            (
                "PASCO",
                "Time (s) Run #1,Angle (rad) Run #1\n0,1",
                None,
                &["Run #1: Time (s)", "Run #1: Angle (rad)"],
                1,
            ),
            ("nothing", "", None, &[], 0),
            (
                "a comment above names of no times",
                "# Time, place: Monday\nMoment,theta\n0,1",
                None,
                &["Moment", "theta"],
                2,
            ),
            (
                "a comment above missing values",
                "# t,theta\nnan,nan\n0,1",
                None,
                &["t", "theta"],
                1,
            ),
            (
                "a comment with more cells than the rows",
                "# Time, place, theta\n0,1",
                None,
                &[],
                0,
            ),
            (
                "a comment above empty cells",
                "# t,theta,x\n0,1,\n1,2,",
                None,
                &["t", "theta", "x"],
                1,
            ),
            (
                "units in a comment with spaces",
                "# t (s) theta (deg)\n0,1",
                None,
                &["t (s)", "theta (deg)"],
                1,
            ),
            (
                "a data set",
                "Latest: Time (s),Latest: Angle (rad)\n0,1",
                None,
                &["Latest: Time (s)", "Latest: Angle (rad)"],
                1,
            ),
        ] {
            let header = find(text, Delimiter::Comma, time).unwrap();
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            assert_eq!(
                (header.names, header.first_row),
                (names, first_row),
                "{name}"
            );
        }
    }

    #[test]
    fn finds_headers_between_spaces() {
        for (name, text, names) in [
            ("plain", "t theta\n0 1", &["t", "theta"][..]),
            ("NumPy", "# t  theta\n0 1", &["t", "theta"]),
            ("NumPy, commas", "# t,tilt (deg)\n0 1", &["t", "tilt (deg)"]),
            ("commas", "t,tilt (deg)\n0 1", &["t", "tilt (deg)"]),
            ("gnuplot", "#t theta\n0 1", &["t", "theta"]),
            ("R", "\"t\" \"theta\"\n\"1\" 0 1", &["1", "t", "theta"]),
            ("pandas", "  t theta\n0 5 1", &["1", "t", "theta"]),
            ("units", "t (s) tilt (deg)\n0 1", &["t (s)", "tilt (deg)"]),
            (
                "units below",
                "Time Tilt\n (s) (deg)\n0 1",
                &["Time (s)", "Tilt (deg)"],
            ),
            ("quotes", "\"t\" \"tilt (deg)\"\n0 1", &["t", "tilt (deg)"]),
            (
                "a sentence",
                "Time of day: noon\nt theta\n0 1",
                &["t", "theta"],
            ),
            ("a sentence only", "# Time of day: noon\n0 1", &[]),
        ] {
            let header = find(text, Delimiter::Blanks, None).unwrap();
            assert_eq!(header.names, names, "{name}");
        }
    }
}

//! Cells of text tables.

use std::borrow::Cow;

/// Texts that stand for a missing value, in lower case.
const MISSING: &[&str] = &["", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--"];

/// Separators of thousands that are no decimal marks: spaces, also without a break and narrow, and apostrophes.
const SEPARATORS: [char; 6] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '’'];

/// A decimal mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    Point,
    Comma,
}

/// The content of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// No value.
    Missing,
    /// A number, and its decimal mark if it has one.
    Number(f64, Option<Mark>),
    /// A number such as `5,000` whose mark may be decimal or separate thousands. The value is that with a decimal mark.
    Unclear(f64, Mark),
    /// A number with separators of thousands, such as `1,234.5`.
    Grouped,
    /// Anything else.
    Text,
}

impl Cell {
    /// Reads a cell without knowledge of its table.
    pub(super) fn parse(cell: &str) -> Self {
        if is_missing(cell) {
            return Self::Missing;
        }
        // U+2212, as typesetters and this program write it.
        let text = if cell.contains('−') {
            Cow::Owned(cell.replace('−', "-"))
        } else {
            Cow::Borrowed(cell)
        };
        if text.contains(SEPARATORS) {
            let Some(ungrouped) = without_separators(&text) else {
                return Self::Text;
            };
            // These can't be decimal marks, so a mark beside them is one.
            return match Self::parse(&ungrouped) {
                Self::Unclear(number, mark) => Self::Number(number, Some(mark)),
                other => other,
            };
        }
        let mut marks = text.chars().filter_map(Mark::from_char);
        let (mark, has_more) = (marks.next(), marks.next().is_some());
        if has_more {
            return if is_grouped(&text) {
                Self::Grouped
            } else {
                Self::Text
            };
        }
        let number = match mark {
            Some(Mark::Comma) => text.replace(',', ".").parse::<f64>(),
            Some(Mark::Point) | None => text.parse(),
        };
        match (number, mark) {
            (Ok(number), Some(mark)) if number.is_finite() && can_be_thousands(&text) => {
                Self::Unclear(number, mark)
            }
            (Ok(number), mark) if number.is_finite() => Self::Number(number, mark),
            (Ok(_) | Err(_), _) => Self::Text,
        }
    }

    /// Whether the cell has a number, whatever its marks mean.
    pub(super) fn is_number(self) -> bool {
        match self {
            Self::Number(..) | Self::Unclear(..) | Self::Grouped => true,
            Self::Missing | Self::Text => false,
        }
    }
}

impl Mark {
    fn from_char(letter: char) -> Option<Self> {
        match letter {
            '.' => Some(Self::Point),
            ',' => Some(Self::Comma),
            _ => None,
        }
    }
}

/// What the numbers of a column, or of a table, say of the decimal mark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "independent facts")]
pub(super) struct Marks {
    /// Whether a number proves a decimal point.
    pub has_point: bool,
    /// Whether a number proves a decimal comma.
    pub has_comma: bool,
    /// Whether a point may separate thousands.
    has_unclear_point: bool,
    /// Whether a comma may.
    has_unclear_comma: bool,
    /// Whether a number has no mark.
    has_whole: bool,
}

impl Marks {
    pub(super) fn add(&mut self, cell: Cell) {
        match cell {
            Cell::Number(_, Some(Mark::Point)) => self.has_point = true,
            Cell::Number(_, Some(Mark::Comma)) => self.has_comma = true,
            Cell::Unclear(_, Mark::Point) => self.has_unclear_point = true,
            Cell::Unclear(_, Mark::Comma) => self.has_unclear_comma = true,
            Cell::Number(_, None) => self.has_whole = true,
            Cell::Missing | Cell::Grouped | Cell::Text => {}
        }
    }

    /// Whether a number proves a decimal mark.
    pub(super) fn are_proved(self) -> bool {
        self.has_point || self.has_comma
    }

    /// The mark that all numbers have, before three digits: a logger writes three decimals, whereas not all numbers have
    /// thousands to be separated.
    pub(super) fn uniform(self) -> Option<Mark> {
        if self.has_whole || self.are_proved() {
            return None;
        }
        match (self.has_unclear_point, self.has_unclear_comma) {
            (true, false) => Some(Mark::Point),
            (false, true) => Some(Mark::Comma),
            (true, true) | (false, false) => None,
        }
    }

    /// The marks that either proves.
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            has_point: self.has_point || other.has_point,
            has_comma: self.has_comma || other.has_comma,
            ..self
        }
    }

    /// The mark that is proved, if it is one.
    pub(super) fn single(self) -> Option<Mark> {
        match (self.has_point, self.has_comma) {
            (true, false) => Some(Mark::Point),
            (false, true) => Some(Mark::Comma),
            (true, true) | (false, false) => None,
        }
    }
}

/// Whether a cell stands for a missing value.
pub(super) fn is_missing(cell: &str) -> bool {
    MISSING.contains(&&*cell.to_lowercase())
}

/// Whether a cell is an error of a spreadsheet, such as `#DIV/0!` or `#NAME?`.
pub(super) fn is_spreadsheet_error(cell: &str) -> bool {
    cell.starts_with('#') && cell.ends_with(['!', '?']) && !cell.contains(' ')
}

/// Whether the only mark of a number can separate thousands: `5,000` and `12.345`, but neither `0,500` nor `5,00`.
fn can_be_thousands(number: &str) -> bool {
    let digits = number.trim_start_matches(['-', '+']);
    let Some((whole, fraction)) = digits.split_once(['.', ',']) else {
        return false;
    };
    !whole.starts_with('0') && is_first_group(whole) && is_group(fraction)
}

/// Whether a text with several marks is a number with separators of thousands: `1,234.5`, `1.000.000`.
fn is_grouped(text: &str) -> bool {
    let digits = text.trim_start_matches(['-', '+']);
    let mut groups: Vec<&str> = digits.split(['.', ',']).collect();
    let last = groups.pop().unwrap_or_default();
    let Some((first, middle)) = groups.split_first() else {
        return false;
    };
    is_first_group(first) && middle.iter().all(|group| is_group(group)) && is_digits(last)
}

/// A number such as `1 234,5` or `1'234'567` without its separators of thousands; `None` if they don't separate these.
fn without_separators(number: &str) -> Option<String> {
    let (whole, fraction) = match number.find(['.', ',']) {
        Some(mark) => number.split_at(mark),
        None => (number, ""),
    };
    let separator = whole.chars().find(|letter| SEPARATORS.contains(letter))?;
    let digits = whole.trim_start_matches(['-', '+']);
    let (first, groups) = digits.split_once(separator)?;
    let is_grouped = is_first_group(first)
        && !first.starts_with('0')
        && groups.split(separator).all(is_group)
        && !fraction.contains(SEPARATORS);
    is_grouped.then(|| whole.replace(separator, "") + fraction)
}

fn is_first_group(text: &str) -> bool {
    text.len() <= 3 && is_digits(text)
}

fn is_group(text: &str) -> bool {
    text.len() == 3 && is_digits(text)
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_numbers_in_all_spellings() {
        let [point, comma] = [Some(Mark::Point), Some(Mark::Comma)];
        for (text, expected) in [
            ("12", Cell::Number(12.0, None)),
            ("-0.5", Cell::Number(-0.5, point)),
            ("−0.5", Cell::Number(-0.5, point)),
            ("−0,5", Cell::Number(-0.5, comma)),
            ("1e−3", Cell::Number(1e-3, None)),
            ("1.250E+00", Cell::Number(1.25, point)),
            ("0,500", Cell::Number(0.5, comma)),
            ("1000,125", Cell::Number(1000.125, comma)),
            ("5.000", Cell::Unclear(5.0, Mark::Point)),
            ("-12,345", Cell::Unclear(-12.345, Mark::Comma)),
            ("1 234", Cell::Number(1234.0, None)),
            ("-1'234'567", Cell::Number(-1_234_567.0, None)),
            ("1’234.5", Cell::Number(1234.5, point)),
            ("1\u{a0}234,500", Cell::Number(1234.5, comma)),
            ("12\u{202f}345", Cell::Number(12_345.0, None)),
            ("1 234e3", Cell::Text),
            ("1 23", Cell::Text),
            ("0 123", Cell::Text),
            ("1 234'567", Cell::Text),
            ("12:00 123", Cell::Text),
            ("1 234,5 6", Cell::Text),
            ("1,234.5", Cell::Grouped),
            ("1.000.000", Cell::Grouped),
            ("26.11.2026", Cell::Text),
            ("1,2,3,4", Cell::Text),
            ("#N/A", Cell::Missing),
            ("-", Cell::Missing),
            ("−", Cell::Text),
            ("inf", Cell::Text),
            ("1e999", Cell::Text),
            ("0x1F", Cell::Text),
            ("0.5 rad", Cell::Text),
            (".", Cell::Text),
        ] {
            assert_eq!(Cell::parse(text), expected, "{text}");
        }
    }
}

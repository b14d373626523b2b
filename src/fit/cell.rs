//! Cells of text tables.

/// Texts that stand for a missing value, in lower case.
const MISSING: &[&str] = &["", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--"];

/// The number in a cell; `None` if it is missing or no number.
pub(super) fn parse_number(cell: &str, has_decimal_comma: bool) -> Option<f64> {
    let number = if has_decimal_comma {
        cell.replace(',', ".").parse::<f64>()
    } else {
        cell.parse()
    };
    number.ok().filter(|number| number.is_finite())
}

/// Whether a cell stands for a missing value.
pub(super) fn is_missing(cell: &str) -> bool {
    MISSING.contains(&&*cell.to_lowercase())
}

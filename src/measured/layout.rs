//! How tables are laid out, as far as it is declared.

use std::str::FromStr;
use thiserror::Error;

/// How tables are laid out, as far as it is declared.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// The column of times; by default that which is named so.
    pub time: Option<String>,
    /// What separates the cells; by default what makes rows of the first lines.
    pub delimiter: Option<Delimiter>,
    /// The decimal mark; by default a point, and a comma, too, where no commas separate the cells.
    pub decimal: Option<Decimal>,
}

impl Layout {
    /// A layout with this column of times.
    pub fn with_time(time: &str) -> Self {
        Self {
            time: Some(time.to_owned()),
            ..Self::default()
        }
    }
}

/// What separates the cells of a text table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// A tab.
    Tab,
    /// A semicolon.
    Semicolon,
    /// A comma.
    Comma,
}

impl Delimiter {
    /// Commas may be decimal marks, so they are tried last.
    pub(super) const ALL: [Self; 3] = [Self::Tab, Self::Semicolon, Self::Comma];

    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Tab => b'\t',
            Self::Semicolon => b';',
            Self::Comma => b',',
        }
    }
}

/// A decimal mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decimal {
    /// A point.
    Point,
    /// A comma.
    Comma,
}

impl Decimal {
    pub(super) fn mark(self) -> char {
        match self {
            Self::Point => '.',
            Self::Comma => ',',
        }
    }
}

/// Error of a word for a [`Delimiter`] or a [`Decimal`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("must be {0}")]
pub struct LayoutError(&'static str);

impl FromStr for Delimiter {
    type Err = LayoutError;

    fn from_str(text: &str) -> Result<Self, LayoutError> {
        match text {
            "," | "comma" => Ok(Self::Comma),
            ";" | "semicolon" => Ok(Self::Semicolon),
            "\t" | "\\t" | "tab" => Ok(Self::Tab),
            _ => Err(LayoutError("comma, semicolon or tab")),
        }
    }
}

impl FromStr for Decimal {
    type Err = LayoutError;

    fn from_str(text: &str) -> Result<Self, LayoutError> {
        match text {
            "." | "point" => Ok(Self::Point),
            "," | "comma" => Ok(Self::Comma),
            _ => Err(LayoutError("point or comma")),
        }
    }
}

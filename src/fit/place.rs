//! Places of measured values in their files, for errors.

use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

/// A line of a text file, or a row of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// Line or row, from 1.
    pub line: u64,
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.path.display(), self.line)
    }
}

/// The value of a signal: its place and column, or its field where there are no lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValuePlace {
    /// The line; `None` for recordings and arrays.
    pub place: Option<Place>,
    /// Name of the column, or topic and path.
    pub column: String,
    /// The field.
    pub field: String,
}

impl Display for ValuePlace {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: column {}", self.column),
            None => f.write_str(&self.field),
        }
    }
}

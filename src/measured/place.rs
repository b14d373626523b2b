//! Places in measured data, for errors.

use std::fmt::{self, Display, Formatter};
use std::path::PathBuf;

/// A place in measured data, as far as it is known: a file, a line of it, and a column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The file; `None` for arrays.
    pub path: Option<PathBuf>,
    /// Line of a text file or row of a table, from 1.
    pub line: Option<u64>,
    /// Name of the column, or topic and path.
    pub column: Option<String>,
}

/// Writes `a.csv:12: column theta`.
impl Display for Place {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        if let Some(path) = &self.path {
            write!(f, "{}", path.display())?;
            separator = ": ";
        }
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
            separator = ": ";
        }
        match &self.column {
            Some(column) => write!(f, "{separator}column {column}"),
            None => Ok(()),
        }
    }
}

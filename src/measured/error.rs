//! Errors of measured data: where something is wrong, what, and what can be done about it.

use crate::words::{Sentence, sentence};
use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::io;
use std::path::{Path, PathBuf};

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

/// Error of reading measured data.
#[derive(Debug)]
pub struct DataError {
    /// Where something is wrong; boxed, because results with this error are returned everywhere.
    pub place: Box<Place>,
    /// What is wrong there.
    pub problem: Sentence,
    /// What can be done about it; empty if the problem says it.
    pub remedy: Sentence,
    /// The error from which it follows.
    source: Option<Box<dyn Error + Send + Sync>>,
}

impl DataError {
    pub(super) fn new(problem: impl Into<Sentence>) -> Self {
        Self {
            place: Box::default(),
            problem: problem.into(),
            remedy: Sentence::default(),
            source: None,
        }
    }

    /// The error that follows from another one.
    pub(super) fn because(source: impl Error + Send + Sync + 'static) -> Self {
        let problem = source.to_string();
        Self {
            source: Some(Box::new(source)),
            ..Self::new(problem)
        }
    }

    /// The error of a file that the system can't read.
    pub(super) fn unreadable(path: &Path, reason: io::Error) -> Self {
        let path = path.display().to_string();
        Self {
            problem: sentence!("cannot read {}: {}", path, reason.to_string()),
            ..Self::because(reason)
        }
    }

    pub(super) fn in_file(mut self, path: &Path) -> Self {
        self.place.path = Some(path.to_owned());
        self
    }

    pub(super) fn in_line(mut self, line: u64) -> Self {
        self.place.line = Some(line);
        self
    }

    pub(super) fn in_column(mut self, column: &str) -> Self {
        self.place.column = Some(column.to_owned());
        self
    }

    pub(super) fn with_remedy(self, remedy: Sentence) -> Self {
        Self { remedy, ..self }
    }

    /// What is wrong where, and what can be done about it.
    pub fn sentence(&self) -> Sentence {
        let place = if *self.place == Place::default() {
            Sentence::default()
        } else {
            sentence!("{}: ", self.place.to_string())
        };
        let remedy = if self.remedy.is_empty() {
            Sentence::default()
        } else {
            sentence!("; {}", self.remedy.clone())
        };
        sentence!("{}{}{}", place, self.problem.clone(), remedy)
    }

    /// The error of the system, if it can't read a file.
    pub fn io(&self) -> Option<&io::Error> {
        self.source.as_ref()?.downcast_ref()
    }
}

/// Renders the sentence for readers of no particular interface.
impl Display for DataError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.sentence().fmt(f)
    }
}

impl Error for DataError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match &self.source {
            Some(source) => Some(&**source),
            None => None,
        }
    }
}

//! Unreadable or skipped parts of a file.

use std::fmt;

/// A span of time, ns; open if its end is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// From this time on.
    pub from_ns: u64,
    /// To this time.
    pub to_ns: Option<u64>,
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = |ns: u64| ns as f64 / 1e9;
        match self.to_ns {
            Some(to) => write!(f, "from {} s to {} s", seconds(self.from_ns), seconds(to)),
            None => write!(f, "from {} s on", seconds(self.from_ns)),
        }
    }
}

/// A part of a file that can't be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loss {
    /// Its start in the file, bytes.
    pub offset: u64,
    /// Length, bytes.
    pub length: u64,
    /// Time span of the lost messages; `None` if no messages are lost.
    pub span: Option<Span>,
    /// Whether it was skipped although it may be intact.
    pub is_unread: bool,
    /// The reason why it can't be read, or was left unread.
    pub reason: String,
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} bytes at {}", self.length, self.offset)?;
        if let Some(span) = self.span {
            write!(f, ", {span}")?;
        }
        if self.is_unread {
            f.write_str(", skipped")?;
        }
        write!(f, ": {}", self.reason)
    }
}

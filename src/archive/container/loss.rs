//! Unreadable or skipped parts of a file.

use crate::run::time::seconds;
use crate::words::{counted, grouped};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// A part of a file that can't be read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[schemars(rename = "LossReport")]
pub struct Loss {
    /// Start in the file, bytes.
    pub offset: u64,
    /// Length, bytes.
    pub length: u64,
    /// Start of the time span with lost messages, ns; absent if none are lost.
    pub from_ns: Option<u64>,
    /// End of that span, ns; absent if unknown.
    pub to_ns: Option<u64>,
    /// Whether it was skipped although it may be intact.
    #[serde(skip)]
    pub is_unread: bool,
    /// Whether it can be read, but its checksum is wrong: it, or the checksum, is damaged somewhere.
    #[serde(skip)]
    pub is_suspect: bool,
    /// The reason why it can't be read.
    pub reason: String,
}

/// Maximum number of losses that are listed; further ones are counted.
const MAX_LISTED: usize = 1000;

/// Maximum number of losses that are described. `info` and `verify` list more as JSON.
const MAX_SENTENCES: usize = 10;

/// The parts of a file that can't be read.
///
/// Lists the first 1000 and counts all, because a damaged file can have millions.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Losses {
    list: Vec<Loss>,
    count: u64,
}

impl Losses {
    /// The first losses in sentences, and the number of the others.
    pub fn sentences(&self) -> Vec<String> {
        let mut sentences: Vec<String> = self
            .list
            .iter()
            .take(MAX_SENTENCES)
            .map(Loss::sentence)
            .collect();
        let others = self.count - sentences.len() as u64;
        if others > 0 {
            sentences.push(format!(
                "missing {} more parts of the file",
                grouped(others)
            ));
        }
        sentences
    }

    /// The first losses.
    pub fn list(&self) -> &[Loss] {
        &self.list
    }

    /// Number of losses.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Number of losses that are not listed; `None` if all are.
    pub fn unlisted(&self) -> Option<u64> {
        Some(self.count - self.list.len() as u64).filter(|count| *count > 0)
    }

    /// Whether everything can be read.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Adds a loss.
    pub(crate) fn push(&mut self, loss: Loss) {
        self.count += 1;
        if self.list.len() < MAX_LISTED {
            self.list.push(loss);
        }
    }

    /// Adds bytes that can't be read. Bytes that follow the last loss and have the same reason extend it.
    pub(crate) fn push_adjacent(&mut self, loss: Loss) {
        match self.list.last_mut() {
            Some(last)
                if self.count <= MAX_LISTED as u64
                    && last.offset + last.length == loss.offset
                    && last.reason == loss.reason =>
            {
                last.length += loss.length;
                last.from_ns = last.from_ns.min(loss.from_ns);
                last.to_ns = last.to_ns.max(loss.to_ns);
            }
            _ => self.push(loss),
        }
    }

    /// Adds losses.
    pub(crate) fn extend(&mut self, losses: &Self) {
        // Each part is counted, whether it is listed or not.
        let room = MAX_LISTED - self.list.len();
        self.list.extend(losses.list.iter().take(room).cloned());
        self.count += losses.count;
    }

    /// The listed losses, to be changed.
    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Loss> {
        self.list.iter_mut()
    }
}

impl Loss {
    fn sentence(&self) -> String {
        if self.is_suspect {
            self.to_string()
        } else {
            format!("missing {self}")
        }
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = counted(self.length, "byte");
        let offset = grouped(self.offset);
        if self.is_suspect {
            let reason = &self.reason;
            return write!(f, "{reason}: {bytes} at {offset} may be damaged");
        }
        write!(f, "{bytes} at {offset}")?;
        match (self.from_ns.map(seconds), self.to_ns.map(seconds)) {
            (Some(from), Some(to)) => write!(f, ", from {from} s to {to} s")?,
            (Some(from), None) => write!(f, ", from {from} s on")?,
            (None, _) => {}
        }
        if self.is_unread {
            f.write_str(", skipped")?;
        }
        write!(f, ": {}", self.reason)
    }
}

/// A line with its label for each of the first losses, and one with the number of the others. `unlisted` is the number of
/// those that are not in the list.
pub(crate) fn loss_lines(losses: &[Loss], unlisted: Option<u64>) -> Vec<(&'static str, String)> {
    let mut lines: Vec<_> = losses
        .iter()
        .take(MAX_SENTENCES)
        .map(|loss| (label(loss), loss.to_string()))
        .collect();
    let more = (losses.len() - lines.len()) as u64 + unlisted.unwrap_or(0);
    if more > 0 {
        lines.push(("lost", format!("and {} more", grouped(more))));
    }
    lines
}

fn label(loss: &Loss) -> &'static str {
    if loss.is_suspect { "damage" } else { "lost" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_ten_losses_and_the_number_of_others() {
        let losses = vec![Loss::default(); 12];
        for (listed, unlisted, last) in [
            (10, None, None),
            (11, None, Some("and 1 more")),
            (12, Some(2000), Some("and 2,002 more")),
        ] {
            let lines = loss_lines(&losses[..listed], unlisted);
            assert_eq!(lines.get(10).map(|(_, line)| line.as_str()), last);
            assert!(lines.len() <= 11);
        }
    }
}

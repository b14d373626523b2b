//! The MCAP file of a run, and its comparison with existing ones.

use crate::archive::publish::Draft;
use crate::cli::report::WrittenFile;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader};
use std::path::{Path, PathBuf};

/// The MCAP file of a run.
pub(in crate::cli) enum McapFile {
    New(WrittenFile),
    /// An earlier run recorded the same; the new file is discarded.
    Identical(WrittenFile),
    /// The run is incomplete, and a complete recording keeps the name.
    Partial(WrittenFile),
}

impl McapFile {
    pub(super) fn into_file(self) -> WrittenFile {
        match self {
            Self::New(file) | Self::Identical(file) | Self::Partial(file) => file,
        }
    }
}

/// The existing recording with the bytes of this draft.
pub(super) fn find_identical(draft: &Draft, earlier: &[PathBuf]) -> Option<WrittenFile> {
    for path in earlier {
        // A file that can't be read is no reason not to write another.
        if are_equal(path, draft.working_name()).unwrap_or(false) {
            return Some(WrittenFile::new(path, path.metadata().ok()?.len()));
        }
    }
    None
}

/// Whether two files have the same bytes.
fn are_equal(one: &Path, other: &Path) -> io::Result<bool> {
    let files = [File::open(one)?, File::open(other)?];
    // Lengths first: recordings that differ mostly differ there.
    if files[0].metadata()?.len() != files[1].metadata()?.len() {
        return Ok(false);
    }
    let [mut one, mut other] = files.map(BufReader::new);
    loop {
        let (a, b) = (one.fill_buf()?, other.fill_buf()?);
        let length = a.len().min(b.len());
        if length == 0 || a[..length] != b[..length] {
            return Ok(a.is_empty() && b.is_empty());
        }
        one.consume(length);
        other.consume(length);
    }
}

//! Comparison of the files to which paths lead.

use super::directory_of;
use crate::archive::sink::SinkError;
use std::path::{self, Component, Path, PathBuf};

/// Checks that an output is not also an input, under any name or link.
///
/// # Errors
/// [`SinkError::IsInUse`] if `output` is one of `inputs`.
pub fn check_not_an_input<'a>(
    output: &Path,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), SinkError> {
    if inputs.into_iter().any(|input| is_same_file(output, input)) {
        return Err(SinkError::IsInUse {
            path: output.to_owned(),
        });
    }
    Ok(())
}

/// Whether two paths refer to the same (existing or future) file.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    place(one) == place(other) || identity(one).is_some_and(|one| identity(other) == Some(one))
}

/// The canonical path of an existing or new file. The last component is not resolved if it is a link.
fn place(path: &Path) -> PathBuf {
    let directory = resolved(directory_of(path));
    path.file_name()
        .map_or_else(|| path.to_owned(), |name| directory.join(name))
}

/// The canonical path of an existing or new directory.
fn resolved(directory: &Path) -> PathBuf {
    let absolute = path::absolute(directory).unwrap_or_else(|_| directory.to_owned());
    let mut resolved = PathBuf::new();
    for part in absolute.components() {
        match part {
            // What is before it is canonical already, so its parent is that of the target of a link.
            Component::ParentDir => {
                resolved.pop();
            }
            part => resolved.push(part),
        }
        resolved = resolved.canonicalize().unwrap_or(resolved);
    }
    resolved
}

/// Identity of a file: its device and its number there.
#[cfg(unix)]
fn identity(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt as _;
    let metadata = path.metadata().ok()?;
    Some((metadata.dev(), metadata.ino()))
}

/// Identity of a file, which its hard links share.
#[cfg(not(unix))]
fn identity(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok()
}

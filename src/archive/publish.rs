//! Atomic file output.
//!
//! A [`Draft`] is written under a temporary name in the target directory and renamed when it is complete and synced.
//! Temporary names are always new, so no existing file is opened for writing.
//!
//! Drafts are hidden files, which are deleted if not published, together with the directories created for them. The
//! draft of a run gets the name `NAME.partial` once it holds the scenario, and stays if the run doesn't reach its end.

mod drafts;
mod place;

pub use drafts::{Drafts, HiddenDirectory};
pub use place::{check_not_an_input, is_same_file};

use crate::archive::sink::SinkError;
use drafts::{ListedDraft, MadeDirectories};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile, PersistError, TempPath};

/// Treatment of an existing file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Keep it and fail.
    Keep,
    /// Replace it atomically. A symbolic link is replaced itself; its target is unchanged.
    Replace,
}

impl Existing {
    /// `Replace` if `force`, otherwise `Keep`.
    pub fn forced(force: bool) -> Self {
        if force { Self::Replace } else { Self::Keep }
    }
}

/// A file being written, to be renamed when complete.
#[derive(Debug)]
pub struct Draft {
    file: NamedTempFile,
    /// The entry in the list of hidden drafts; `None` once the draft has a visible name.
    listed: Option<ListedDraft>,
    path: PathBuf,
    existing: Existing,
    /// The visible name, under which it is kept if it is not published.
    partial: Option<PathBuf>,
    /// Directories created for it; dropped after the file.
    directories: MadeDirectories,
}

impl Draft {
    /// Creates a draft that is deleted if not published.
    ///
    /// # Errors
    /// [`SinkError::Exists`] if the name is taken, [`SinkError::Io`] if the file can't be created.
    pub fn new(path: &Path, existing: Existing) -> Result<Self, SinkError> {
        Self::new_in(&Drafts::default(), path, existing)
    }

    /// Like [`Draft::new`], and listed among the drafts of a program.
    ///
    /// # Errors
    /// As [`Draft::new`].
    pub fn new_in(drafts: &Drafts, path: &Path, existing: Existing) -> Result<Self, SinkError> {
        Self::create(drafts, directory_of(path), path, existing)
    }

    /// Like [`Draft::new`], but places the draft in another directory, so that removing that directory removes
    /// leftovers of a killed process.
    ///
    /// # Errors
    /// As [`Draft::new`]; [`Draft::publish`] fails if the directory is on another file system.
    pub fn within(directory: &Path, path: &Path, existing: Existing) -> Result<Self, SinkError> {
        Self::create(&Drafts::default(), directory, path, existing)
    }

    fn create(
        drafts: &Drafts,
        directory: &Path,
        path: &Path,
        existing: Existing,
    ) -> Result<Self, SinkError> {
        check_target(path, existing)?;
        let parent = directory_of(path);
        // Listed before they are made, so that a signal in between leaves no empty directory.
        let directories = drafts
            .make_directory(parent)
            .map_err(|error| io_error("create directory", parent, error))?;
        let (file, listed) = drafts
            .create(|| create_hidden(directory, path), NamedTempFile::path)
            .map_err(|error| io_error("create", path, error))?;
        Ok(Self {
            file,
            listed: Some(listed),
            path: path.to_owned(),
            existing,
            partial: None,
            directories,
        })
    }

    /// Gives the draft of a run its visible name, `NAME.partial`, under which a killed process leaves it.
    ///
    /// An existing `NAME.partial` is not touched: with [`Existing::Replace`] the name is `NAME.RANDOM.partial`, with the
    /// random letters of the hidden draft; otherwise this is an error.
    ///
    /// # Errors
    /// [`SinkError::Exists`] if the name is taken, [`SinkError::Name`] if `NAME` is that of such a draft,
    /// [`SinkError::Io`] if the file can't be renamed.
    pub fn make_partial(mut self) -> Result<Self, SinkError> {
        if self.path.extension().is_some_and(|kind| kind == "partial") {
            let reason = "has the extension .partial, which is reserved for incomplete runs";
            return Err(name_error(&self.path, reason));
        }
        let (file, partial) = rename_to_partial(self.file, &self.path, self.existing)?;
        let name = TempPath::try_from_path(&partial)
            .map_err(|error| io_error("create", &partial, error))?;
        self.file = NamedTempFile::from_parts(file, name);
        // Another run may have published its file meanwhile.
        check_existing(&self.path, self.existing)?;
        self.listed = None;
        self.partial = Some(partial);
        Ok(self)
    }

    /// The name that the file will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The name used in messages until then.
    pub fn working_name(&self) -> &Path {
        self.partial.as_deref().unwrap_or(&self.path)
    }

    /// Keeps the draft of a run even if it is not published.
    pub fn keep(&mut self) {
        self.file.disable_cleanup(self.partial.is_some());
    }

    /// A handle of the file, for other writers.
    ///
    /// # Errors
    /// [`SinkError::Io`] if the system has no more handles.
    pub fn file(&self) -> Result<File, SinkError> {
        let file = self.file.as_file().try_clone();
        file.map_err(|error| io_error("write", self.working_name(), error))
    }

    /// Removes what has been written.
    pub fn discard(mut self) {
        self.file.disable_cleanup(false);
    }

    /// Syncs and renames the complete file. Returns its size in bytes.
    ///
    /// # Errors
    /// [`SinkError::Exists`] if the name was taken meanwhile, [`SinkError::Io`] otherwise. The file of a run
    /// then keeps its partial name.
    pub fn publish(self) -> Result<u64, SinkError> {
        let bytes = sync(self.file.as_file())
            .map_err(|error| io_error("write", self.working_name(), error))?;
        // The content is on the disk before the name is: a crash leaves the old file or the new one, never half of it.
        let named = match self.existing {
            Existing::Replace => self.file.persist(&self.path),
            Existing::Keep => rename_to_unused(self.file, &self.path),
        };
        drop(self.listed);
        if let Err(refused) = named {
            if refused.error.kind() != io::ErrorKind::AlreadyExists {
                return Err(io_error("name", &self.path, refused.error));
            }
            let advice = match &self.partial {
                Some(partial) => format!(
                    "the file was created during the run; the new recording is complete and saved as {}",
                    partial.display()
                ),
                None => "it was just created by another process".to_owned(),
            };
            return Err(exists(&self.path, advice));
        }
        self.directories.keep();
        sync_directory(&self.path);
        Ok(bytes)
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Errors of the temporary file itself would show its hidden name.
        self.file.as_file_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_file_mut().flush()
    }
}

/// Publishes a file with these contents.
///
/// # Errors
/// [`SinkError::Exists`] if the name is taken, [`SinkError::Io`] if the file can't be written.
pub fn write(path: &Path, existing: Existing, contents: &[u8]) -> Result<(), SinkError> {
    write_in(&Drafts::default(), path, existing, contents)
}

/// Like [`write()`], with a draft that is listed among those of a program.
///
/// # Errors
/// As [`write()`].
pub fn write_in(
    drafts: &Drafts,
    path: &Path,
    existing: Existing,
    contents: &[u8],
) -> Result<(), SinkError> {
    let mut draft = Draft::new_in(drafts, path, existing)?;
    let written = draft.write_all(contents);
    written.map_err(|error| io_error("write", path, error))?;
    draft.publish().map(|_| ())
}

/// Rejects invalid file paths, e.g. with a trailing separator.
///
/// # Errors
/// [`SinkError::Name`].
pub fn check_name(path: &Path) -> Result<(), SinkError> {
    if path.as_os_str() == "-" {
        let reason = "is not a file name: nothing but reports is written to standard output";
        return Err(name_error(path, reason));
    }
    let whole = path.as_os_str().as_encoded_bytes();
    let name = path.file_name();
    if name.is_some_and(|name| whole.ends_with(name.as_encoded_bytes())) {
        return Ok(());
    }
    Err(name_error(path, "is not a file name"))
}

/// Checks that the target can be written, before anything else is done.
///
/// # Errors
/// [`SinkError::Exists`] if the name is taken, [`SinkError::Name`] if the path has none.
pub fn check_target(path: &Path, existing: Existing) -> Result<(), SinkError> {
    check_name(path)?;
    // Don't replace a directory, device or pipe.
    if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
        return Err(exists(path, "it is not a regular file"));
    }
    check_existing(path, existing)
}

/// Checks that no file is in the way.
fn check_existing(path: &Path, existing: Existing) -> Result<(), SinkError> {
    if existing == Existing::Keep && path.symlink_metadata().is_ok() {
        let advice = "choose another name, or overwrite it with --force";
        return Err(exists(path, advice));
    }
    Ok(())
}

/// Advice on a `NAME.partial` that is in the way.
fn advice_on_partial(partial: &Path) -> String {
    let stem = partial.file_stem().map(Path::new);
    if stem
        .and_then(Path::extension)
        .is_some_and(|kind| kind == "mcap")
    {
        format!(
            "it belongs to a running or interrupted run; to repeat an interrupted run: `toprise run {} -o OUT`; \
             move it away, or choose another name",
            partial.display()
        )
    } else {
        "it belongs to a running or interrupted run; move it or choose another name".to_owned()
    }
}

/// Number of random letters and digits in the name of a hidden draft.
const RANDOM: usize = 6;
/// Suffix of a hidden draft's name.
const SUFFIX: &str = ".tmp";

/// Prefix of a hidden draft's name: that of its file, as far as the file system has room for both.
fn prefix(path: &Path) -> String {
    /// Most file systems allow 255 bytes; the rest of a draft's name takes 12.
    const MAX_LENGTH: usize = 240;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    format!(".{}.", &name[..name.floor_char_boundary(MAX_LENGTH)])
}

/// The random letters in the name of a hidden draft.
fn random_part(hidden: &Path) -> String {
    let name = hidden.file_stem().unwrap_or_default().to_string_lossy();
    name.rsplit('.').next().unwrap_or_default().to_owned()
}

/// Whether a file name is that of a hidden draft of `path`.
pub fn is_draft_of(name: &str, path: &Path) -> bool {
    name.strip_prefix(&prefix(path))
        .and_then(|rest| rest.strip_suffix(SUFFIX))
        .is_some_and(|random| {
            random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
        })
}

/// Creates a hidden file, named after `path`.
fn create_hidden(directory: &Path, path: &Path) -> io::Result<NamedTempFile> {
    let prefix = prefix(path);
    let mut builder = Builder::new();
    builder.prefix(&prefix).rand_bytes(RANDOM).suffix(SUFFIX);
    let mut options = File::options();
    options.read(true).write(true).create_new(true);
    // Files of `tempfile_in` could be read by their owner alone, even after they are published.
    builder.make_in(directory, |name| options.open(name))
}

/// Renames the hidden draft of a run to an unused partial name. Also returns the name.
fn rename_to_partial(
    hidden: NamedTempFile,
    path: &Path,
    existing: Existing,
) -> Result<(File, PathBuf), SinkError> {
    let partial = partial_name(path);
    let random = random_part(hidden.path());
    let refused = match rename_to_unused(hidden, &partial) {
        Ok(file) => return Ok((file, partial)),
        Err(refused) => refused,
    };
    match (refused.error.kind(), existing) {
        (io::ErrorKind::AlreadyExists, Existing::Keep) => {
            Err(exists(&partial, advice_on_partial(&partial)))
        }
        (io::ErrorKind::AlreadyExists, Existing::Replace) => {
            let partial = with_suffix(path, &format!(".{random}.partial"));
            match rename_to_unused(refused.file, &partial) {
                Ok(file) => Ok((file, partial)),
                Err(refused) => Err(io_error("create", &partial, refused.error)),
            }
        }
        _ => Err(io_error("create", &partial, refused.error)),
    }
}

/// Renames a file to an unused name.
fn rename_to_unused(file: NamedTempFile, name: &Path) -> Result<File, PersistError> {
    file.persist_noclobber(name).or_else(|refused| {
        let is_taken = refused.error.kind() == io::ErrorKind::AlreadyExists;
        // Without hard links, check and rename are not atomic.
        if is_taken || name.symlink_metadata().is_ok() {
            return Err(refused);
        }
        refused.file.persist(name)
    })
}

/// The name of a run's file while it is not complete.
pub fn partial_name(path: &Path) -> PathBuf {
    with_suffix(path, ".partial")
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().map_or_else(OsString::new, OsString::from);
    name.push(suffix);
    path.with_file_name(name)
}

fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Syncs a file. Returns its size in bytes.
fn sync(file: &File) -> io::Result<u64> {
    file.sync_all()?;
    Ok(file.metadata()?.len())
}

/// Syncs the directory, where supported.
fn sync_directory(path: &Path) {
    // Only then a crash can't undo the renaming. Some systems can't open directories.
    if let Ok(directory) = File::open(directory_of(path)) {
        let _ = directory.sync_all();
    }
}

fn exists(path: &Path, advice: impl Into<String>) -> SinkError {
    SinkError::Exists {
        path: path.to_owned(),
        advice: advice.into(),
    }
}

fn name_error(path: &Path, reason: &'static str) -> SinkError {
    SinkError::Name {
        path: path.to_owned(),
        reason,
    }
}

fn io_error(action: &'static str, path: &Path, reason: io::Error) -> SinkError {
    SinkError::Io {
        action,
        path: path.to_owned(),
        reason,
    }
}

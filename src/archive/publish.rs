//! Atomic file output.
//!
//! A [`Draft`] is written under a temporary name in the target directory and renamed when it is complete and synced.
//! Temporary names are always new, so no existing file is opened for writing.
//!
//! The draft of a run is called `NAME.partial` and stays if the run doesn't reach its end. Other drafts are hidden
//! files. They are deleted if not published, together with the directories created for them.

use crate::archive::sink::SinkError;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Seek as _, Write};
use std::path::{self, Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};
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

/// Hidden drafts, for removal on exit.
static HIDDEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Directories created for drafts.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Removes all hidden drafts and the directories created for them, and blocks new ones; called before the process
/// exits.
pub fn abandon_drafts() {
    let drafts = HIDDEN.lock().unwrap_or_else(PoisonError::into_inner);
    for draft in drafts.iter() {
        let _ = fs::remove_file(draft);
    }
    let directories = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    remove_empty(&directories);
    std::mem::forget((drafts, directories));
}

/// Guard of an entry in the list of hidden drafts.
#[derive(Debug)]
struct Hidden(PathBuf);

impl Drop for Hidden {
    fn drop(&mut self) {
        let mut drafts = HIDDEN.lock().unwrap_or_else(PoisonError::into_inner);
        drafts.remove(&self.0);
    }
}

/// A file being written, to be renamed when complete.
#[derive(Debug)]
pub struct Draft {
    file: NamedTempFile,
    /// `None` for the draft of a run (`NAME.partial`).
    hidden: Option<Hidden>,
    path: PathBuf,
    existing: Existing,
    /// The name kept if it is not published; `None` if it is deleted.
    partial: Option<PathBuf>,
    /// Length of the current preface.
    preface: usize,
    /// Replacement of the preface, in one write.
    first: Vec<u8>,
    /// Directories created for it; dropped after the file.
    directories: MadeDirectories,
}

/// Directories created for a file, outermost first. Empty ones are removed on drop.
#[derive(Debug)]
struct MadeDirectories(Vec<PathBuf>);

impl MadeDirectories {
    /// Creates a directory and missing parents.
    fn make(directory: &Path) -> io::Result<Self> {
        let missing = directory.ancestors();
        let missing = missing.take_while(|path| !path.as_os_str().is_empty() && !path.exists());
        let mut missing: Vec<PathBuf> = missing.map(Path::to_owned).collect();
        missing.reverse();
        // Registered before creation, so that they can be removed on a signal.
        let mut all = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        all.extend(missing.iter().cloned());
        let made = Self(missing);
        fs::create_dir_all(directory).map(|()| made)
    }

    /// Keeps them.
    fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for MadeDirectories {
    fn drop(&mut self) {
        remove_empty(&self.0);
    }
}

/// Removes empty directories, the innermost first.
fn remove_empty(directories: &[PathBuf]) {
    for directory in directories.iter().rev() {
        let _ = fs::remove_dir(directory);
    }
}

impl Draft {
    /// Creates a draft that is deleted if not published.
    ///
    /// # Errors
    /// [`SinkError::Exists`] if the name is taken, [`SinkError::Io`] if the file can't be created.
    pub fn new(path: &Path, existing: Existing) -> Result<Self, SinkError> {
        Self::within(directory_of(path), path, existing)
    }

    /// Like [`Draft::new`], but places the draft in another directory, so that removing that directory removes
    /// leftovers of a killed process.
    ///
    /// # Errors
    /// As [`Draft::new`]; [`Draft::publish`] fails if the directory is on another file system.
    pub fn within(directory: &Path, path: &Path, existing: Existing) -> Result<Self, SinkError> {
        let directories = prepare(path, existing)?;
        let (file, hidden) = hidden(directory, path)?;
        Ok(Self {
            file,
            hidden: Some(hidden),
            path: path.to_owned(),
            existing,
            partial: None,
            preface: 0,
            first: Vec::new(),
            directories,
        })
    }

    /// Creates the draft of a run, `NAME.partial`. It is kept on failure after [`Draft::keep`]. It starts with
    /// `preface`, which is replaced by the first write.
    ///
    /// An existing `NAME.partial` is not touched: with [`Existing::Replace`] the next free name of
    /// `NAME.2.partial`, `NAME.3.partial`, … is used; otherwise creation fails.
    ///
    /// # Errors
    /// [`SinkError::Exists`] if the name is taken, [`SinkError::Name`] if it is that of a draft, [`SinkError::Io`] if the
    /// file can't be created.
    pub fn of_run(path: &Path, existing: Existing, preface: &[u8]) -> Result<Self, SinkError> {
        if path.extension().is_some_and(|kind| kind == "partial") {
            let reason = "has the extension .partial, which is reserved for incomplete runs";
            return Err(name_error(path, reason));
        }
        let mut draft = Self::new(path, existing)?;
        let written = draft.file.write_all(preface);
        written.map_err(|error| io_error("write", path, error))?;
        let (file, partial) = name_partial(draft.file, path, existing)?;
        let draft = Self {
            file,
            hidden: None,
            partial: Some(partial),
            preface: preface.len(),
            ..draft
        };
        // Another run may have published its file meanwhile.
        refuse_existing(path, existing)?;
        Ok(draft)
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
    pub fn publish(mut self) -> Result<u64, SinkError> {
        let flushed = self.flush();
        flushed.map_err(|error| io_error("write", self.working_name(), error))?;
        let Self {
            file,
            hidden,
            path,
            existing,
            partial,
            directories,
            ..
        } = self;
        let working_name = partial.as_deref().unwrap_or(&path);
        let length = || {
            file.as_file().sync_all()?;
            Ok(file.as_file().metadata()?.len())
        };
        let bytes = length().map_err(|error| io_error("write", working_name, error))?;
        let named = match existing {
            Existing::Replace => file.persist(&path),
            Existing::Keep => name_anew(file, &path),
        };
        drop(hidden);
        if let Err(refused) = named {
            return Err(match (refused.error.kind(), &partial) {
                (io::ErrorKind::AlreadyExists, Some(partial)) => exists(
                    &path,
                    format!(
                        "the file was created during the run; the new recording is complete and saved as {}",
                        partial.display()
                    ),
                ),
                (io::ErrorKind::AlreadyExists, None) => {
                    exists(&path, "it was just created by another process")
                }
                _ => io_error("name", &path, refused.error),
            });
        }
        directories.keep();
        sync_directory(&path);
        Ok(bytes)
    }

    fn replace_preface(&mut self) -> io::Result<()> {
        let file = self.file.as_file_mut();
        file.rewind()?;
        file.write_all(&self.first)?;
        file.set_len(self.first.len() as u64)?;
        self.preface = 0;
        self.first = Vec::new();
        Ok(())
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.preface == 0 {
            // Errors of the temporary file itself would show its hidden name.
            return self.file.as_file_mut().write(bytes);
        }
        self.first.extend_from_slice(bytes);
        if self.first.len() > self.preface {
            self.replace_preface()?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        if !self.first.is_empty() {
            self.replace_preface()?;
        }
        self.file.as_file_mut().flush()
    }
}

/// Publishes a file with these contents.
///
/// # Errors
/// [`SinkError::Exists`] if the name is taken, [`SinkError::Io`] if the file can't be written.
pub fn write(path: &Path, existing: Existing, contents: &[u8]) -> Result<(), SinkError> {
    let mut draft = Draft::new(path, existing)?;
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

/// Checks that the target can be written, and creates its directory.
fn prepare(path: &Path, existing: Existing) -> Result<MadeDirectories, SinkError> {
    check_name(path)?;
    // Don't replace a directory, device or pipe.
    if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
        return Err(exists(path, "it is not a regular file"));
    }
    refuse_existing(path, existing)?;
    let directory = directory_of(path);
    let made = MadeDirectories::make(directory);
    made.map_err(|error| io_error("create directory", directory, error))
}

fn refuse_existing(path: &Path, existing: Existing) -> Result<(), SinkError> {
    if existing == Existing::Keep && path.symlink_metadata().is_ok() {
        let advice = "choose another name, or overwrite it with --force";
        return Err(exists(path, advice));
    }
    Ok(())
}

/// Number of random letters and digits in the name of a hidden draft.
const RANDOM: usize = 6;
/// Suffix of a hidden draft's name.
const SUFFIX: &str = ".tmp";

/// Prefix of a hidden draft's name: that of its file, as far as the file system has room for both.
fn prefix(path: &Path) -> String {
    /// Most file systems allow 255 bytes; the rest of a draft's name takes 12.
    const LONGEST: usize = 240;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    format!(".{}.", &name[..name.floor_char_boundary(LONGEST)])
}

/// Whether a file name is that of a hidden draft of `path`.
pub fn is_draft_of(name: &str, path: &Path) -> bool {
    let random = name.strip_prefix(&prefix(path));
    let random = random.and_then(|rest| rest.strip_suffix(SUFFIX));
    random.is_some_and(|random| {
        random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
    })
}

/// A new hidden file, named after `path`.
fn hidden(directory: &Path, path: &Path) -> Result<(NamedTempFile, Hidden), SinkError> {
    let prefix = prefix(path);
    let mut builder = Builder::new();
    builder.prefix(&prefix).rand_bytes(RANDOM).suffix(SUFFIX);
    let mut options = File::options();
    options.read(true).write(true).create_new(true);
    // Files of `tempfile_in` could be read by their owner alone, even after they are published.
    let mut drafts = HIDDEN.lock().unwrap_or_else(PoisonError::into_inner);
    let file = builder.make_in(directory, |name| options.open(name));
    let file = file.map_err(|error| io_error("create", path, error))?;
    drafts.insert(file.path().to_owned());
    let hidden = Hidden(file.path().to_owned());
    Ok((file, hidden))
}

/// Names a file `NAME.partial`, or the next free name if allowed.
fn name_partial(
    mut file: NamedTempFile,
    path: &Path,
    existing: Existing,
) -> Result<(NamedTempFile, PathBuf), SinkError> {
    let mut name = partial_name(path);
    let mut number = 1;
    loop {
        let refused = match name_anew(file, &name) {
            Ok(file) => {
                let named = TempPath::try_from_path(&name);
                let named = named.map_err(|error| io_error("create", &name, error))?;
                return Ok((NamedTempFile::from_parts(file, named), name));
            }
            Err(refused) => refused,
        };
        if refused.error.kind() != io::ErrorKind::AlreadyExists {
            return Err(io_error("create", &name, refused.error));
        }
        if existing == Existing::Keep {
            let advice = if path.extension().is_some_and(|kind| kind == "mcap") {
                format!(
                    "it belongs to a running or interrupted run; to repeat an interrupted run: `toprise run {} -o OUT`; \
                     move it away, or choose another name",
                    name.display()
                )
            } else {
                "it belongs to a running or interrupted run; move it or choose another name"
                    .to_owned()
            };
            return Err(exists(&name, advice));
        }
        file = refused.file;
        number += 1;
        name = with_suffix(path, &format!(".{number}.partial"));
    }
}

/// Renames a file to an unused name.
fn name_anew(file: NamedTempFile, name: &Path) -> Result<File, PersistError> {
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

/// Syncs the directory, where supported.
fn sync_directory(path: &Path) {
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

/// Rejects an output that is also an input, under any name or link.
///
/// # Errors
/// [`SinkError::IsInUse`] if `output` is one of `inputs`.
pub fn refuse_inputs<'a>(
    output: &Path,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), SinkError> {
    let is_read = inputs.into_iter().any(|input| is_same_file(output, input));
    if is_read {
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

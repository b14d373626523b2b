//! Files that appear whole or not at all.
//!
//! A file is written as `NAME.partial` beside its place and takes its name only when it is complete
//! and on the disk. A partial file of an interrupted run stays and is never written over.

use crate::archive::sink::SinkError;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// What may happen to a file that already has the name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It stays; publishing is refused.
    Keep,
    /// It is replaced, in one moment.
    Replace,
}

impl Existing {
    /// Replaced if that is forced.
    #[must_use]
    pub fn forced(force: bool) -> Self {
        if force { Self::Replace } else { Self::Keep }
    }
}

/// A file on its way to its name.
#[derive(Clone, Debug)]
pub struct Place {
    path: PathBuf,
    /// Its name until then.
    partial: PathBuf,
    existing: Existing,
}

impl Place {
    /// Reserves `path`: makes its directory and creates the partial file.
    ///
    /// # Errors
    /// [`SinkError::Exists`] if the file, or a partial one, is there; [`SinkError::Io`] otherwise.
    pub fn reserve(path: &Path, existing: Existing) -> Result<(Self, File), SinkError> {
        Self::reserve_as(path, partial_name(path), existing)
    }

    /// The same for a file that is made from another: until it is complete it is called `NAME.new`, because
    /// the other may be the `NAME.partial` that an interrupted run has left.
    ///
    /// # Errors
    /// As for [`Place::reserve`].
    pub fn reserve_derived(path: &Path, existing: Existing) -> Result<(Self, File), SinkError> {
        Self::reserve_as(path, with_suffix(path, ".new"), existing)
    }

    fn reserve_as(
        path: &Path,
        partial: PathBuf,
        existing: Existing,
    ) -> Result<(Self, File), SinkError> {
        // A directory, a device, a pipe: a rename would put a file in its place.
        if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
            return Err(SinkError::Exists {
                path: path.to_owned(),
                advice: "it is not a file; name one",
            });
        }
        if existing == Existing::Keep && path.symlink_metadata().is_ok() {
            return Err(SinkError::Exists {
                path: path.to_owned(),
                advice: "choose another name, or replace it with --force",
            });
        }
        if let Some(directory) = path.parent() {
            fs::create_dir_all(directory)
                .map_err(|e| io_error("create directory", directory, e))?;
        }
        let mut options = OpenOptions::new();
        options.write(true);
        match existing {
            Existing::Keep => options.create_new(true),
            Existing::Replace => options.create(true).truncate(true),
        };
        let file = options.open(&partial).map_err(|error| {
            if error.kind() == io::ErrorKind::AlreadyExists {
                SinkError::Exists {
                    path: partial.clone(),
                    advice: "something is writing it or was interrupted; move it away, or replace it with --force",
                }
            } else {
                io_error("create", &partial, error)
            }
        })?;
        let place = Self {
            path: path.to_owned(),
            partial,
            existing,
        };
        Ok((place, file))
    }

    /// The name that the file will have.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The name that it has until then.
    #[must_use]
    pub fn partial(&self) -> PathBuf {
        self.partial.clone()
    }

    /// Gives the complete file its name, after it has reached the disk.
    ///
    /// # Errors
    /// [`SinkError::Exists`] if the name was taken meanwhile, [`SinkError::Io`] otherwise. The
    /// partial file is still there then.
    pub fn publish(&self, file: &File) -> Result<(), SinkError> {
        let partial = self.partial();
        file.sync_all()
            .map_err(|e| io_error("write", &partial, e))?;
        match self.existing {
            Existing::Replace => {
                fs::rename(&partial, &self.path).map_err(|e| io_error("replace", &self.path, e))?;
            }
            Existing::Keep => self.link(&partial)?,
        }
        self.sync_directory();
        Ok(())
    }

    /// Withdraws: removes the partial file, which holds nothing worth keeping.
    pub fn withdraw(&self) {
        // If it can't be removed it is found by the next run, which names it.
        let _ = fs::remove_file(self.partial());
    }

    /// A rename that never replaces: a second name, then the first one removed.
    fn link(&self, partial: &Path) -> Result<(), SinkError> {
        match fs::hard_link(partial, &self.path) {
            Ok(()) => fs::remove_file(partial).map_err(|e| io_error("remove", partial, e)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(SinkError::Exists {
                path: self.path.clone(),
                advice: "it appeared during the run; the new recording is beside it, as .partial",
            }),
            // File systems without hard links: the check and the rename are two moments there.
            Err(_) if self.path.symlink_metadata().is_err() => {
                fs::rename(partial, &self.path).map_err(|e| io_error("name", &self.path, e))
            }
            Err(error) => Err(io_error("name", &self.path, error)),
        }
    }

    /// Makes the new name itself durable, where the system lets a directory be synced.
    fn sync_directory(&self) {
        let directory = match self.path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        if let Ok(directory) = File::open(directory) {
            let _ = directory.sync_all();
        }
    }
}

/// The name of a file that is not complete.
#[must_use]
pub fn partial_name(path: &Path) -> PathBuf {
    with_suffix(path, ".partial")
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().map_or_else(OsString::new, OsString::from);
    name.push(suffix);
    path.with_file_name(name)
}

fn io_error(action: &'static str, path: &Path, reason: io::Error) -> SinkError {
    SinkError::Io {
        action,
        path: path.to_owned(),
        reason,
    }
}

/// Whether two paths lead to one file, or would.
#[must_use]
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    let whole = |path: &Path| path.canonicalize().ok();
    one == other || whole(one).is_some_and(|one| whole(other) == Some(one))
}

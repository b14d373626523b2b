//! The files and directories that a program would leave behind if it were ended while it writes.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tempfile::Builder;

/// The hidden drafts of a program and the directories made for them. A program that handles signals keeps one and
/// removes what is in it before it exits.
#[derive(Clone, Debug, Default)]
pub struct Drafts(Arc<Mutex<Leftovers>>);

/// Files and directories to be removed.
#[derive(Debug, Default)]
pub(super) struct Leftovers {
    files: BTreeSet<PathBuf>,
    directories: Vec<PathBuf>,
    /// Directories that are removed with all that is in them.
    trees: BTreeSet<PathBuf>,
}

impl Drafts {
    /// Removes all hidden drafts and the empty directories made for them. Whoever wants to create another draft waits
    /// from now on: the process is about to exit.
    pub fn abandon(&self) {
        let leftovers = self.lock();
        for file in &leftovers.files {
            // It may just have been published, or removed by the thread that wrote it.
            let _ = fs::remove_file(file);
        }
        for tree in &leftovers.trees {
            let _ = fs::remove_dir_all(tree);
        }
        remove_empty(&leftovers.directories);
        // The lock is never released: no thread makes another draft while the process exits.
        std::mem::forget(leftovers);
    }

    /// Access to the lists. A panic of another thread leaves them usable.
    pub(super) fn lock(&self) -> MutexGuard<'_, Leftovers> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Creates a hidden file. It is listed before anyone can see it.
    pub(super) fn create<F>(
        &self,
        create: impl FnOnce() -> io::Result<F>,
        path_of: impl Fn(&F) -> &Path,
    ) -> io::Result<(F, ListedDraft)> {
        let mut leftovers = self.lock();
        let file = create()?;
        let path = path_of(&file).to_owned();
        leftovers.files.insert(path.clone());
        let drafts = self.clone();
        Ok((file, ListedDraft { drafts, path }))
    }

    /// Creates a hidden directory in another, which is removed with all that is in it unless it gets a name.
    ///
    /// # Errors
    /// The system error.
    pub fn hidden_directory(&self, parent: &Path) -> io::Result<HiddenDirectory> {
        let mut leftovers = self.lock();
        let path = Builder::new()
            .prefix(".toprise-")
            .tempdir_in(parent)?
            .keep();
        leftovers.trees.insert(path.clone());
        let drafts = self.clone();
        Ok(HiddenDirectory { drafts, path })
    }

    /// Creates a directory and its missing parents.
    pub(super) fn make_directory(&self, directory: &Path) -> io::Result<MadeDirectories> {
        let mut missing = Vec::new();
        for path in directory.ancestors() {
            if path.as_os_str().is_empty() || path.exists() {
                break;
            }
            missing.insert(0, path.to_owned());
        }
        let mut leftovers = self.lock();
        leftovers.directories.extend(missing.iter().cloned());
        let made = MadeDirectories(missing);
        fs::create_dir_all(directory)?;
        Ok(made)
    }
}

/// A hidden directory, removed on drop.
#[derive(Debug)]
pub struct HiddenDirectory {
    drafts: Drafts,
    path: PathBuf,
}

impl HiddenDirectory {
    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it a name in the same parent.
    ///
    /// # Errors
    /// The system error, also if the name is that of a file or of a directory that is not empty.
    pub fn publish(self, path: &Path) -> io::Result<()> {
        fs::rename(&self.path, path)
    }
}

impl Drop for HiddenDirectory {
    fn drop(&mut self) {
        // After it was published there is nothing left.
        let _ = fs::remove_dir_all(&self.path);
        self.drafts.lock().trees.remove(&self.path);
    }
}

/// A hidden draft in the list, until it is dropped.
#[derive(Debug)]
pub(super) struct ListedDraft {
    drafts: Drafts,
    path: PathBuf,
}

impl Drop for ListedDraft {
    fn drop(&mut self) {
        self.drafts.lock().files.remove(&self.path);
    }
}

/// Directories created for a file, outermost first. Empty ones are removed on drop.
#[derive(Debug)]
pub(super) struct MadeDirectories(Vec<PathBuf>);

impl MadeDirectories {
    /// Keeps them.
    pub(super) fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for MadeDirectories {
    fn drop(&mut self) {
        remove_empty(&self.0);
    }
}

/// Removes empty directories, the innermost first. The others have come to hold other files.
fn remove_empty(directories: &[PathBuf]) {
    for directory in directories.iter().rev() {
        let _ = fs::remove_dir(directory);
    }
}

//! Archives as directories and as ZIP files.

use super::parts::{ArchiveFile, SUMS};
use crate::archive::publish::{Draft, Drafts, Existing};
use anyhow::{Context as _, Error, bail};
use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read as _, Write as _};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Where an archive is written.
pub(super) enum Destination {
    Directory(PathBuf),
    Zip(PathBuf),
}

impl Destination {
    /// The directory or, by its name, ZIP file; there must be neither.
    pub(super) fn new(path: &Path) -> Result<Self, Error> {
        if path.symlink_metadata().is_ok() {
            bail!("{} exists: choose another name", path.display());
        }
        let is_zip = path.extension().is_some_and(|extension| extension == "zip");
        Ok(if is_zip {
            Self::Zip(path.to_owned())
        } else {
            Self::Directory(path.to_owned())
        })
    }

    pub(super) fn write(&self, files: &[ArchiveFile], drafts: &Drafts) -> Result<(), Error> {
        match self {
            Self::Directory(path) => write_directory(path, files, drafts),
            Self::Zip(path) => write_zip(path, files, drafts),
        }
    }
}

/// Names appear when all files are written, the sums last: without them, an archive is none.
fn write_directory(path: &Path, files: &[ArchiveFile], drafts: &Drafts) -> Result<(), Error> {
    let mut written = Vec::new();
    for file in files {
        let target = path.join(&file.name);
        let mut draft = Draft::new_in(drafts, &target, Existing::Keep)?;
        copy(file, &mut draft).with_context(|| cannot_write(&target))?;
        written.push(draft);
    }
    for draft in written {
        draft.publish()?;
    }
    Ok(())
}

/// The bytes follow from the files alone: no compression, no times.
fn write_zip(path: &Path, files: &[ArchiveFile], drafts: &Drafts) -> Result<(), Error> {
    let draft = Draft::new_in(drafts, path, Existing::Keep)?;
    let mut zip = ZipWriter::new(BufWriter::new(draft.file()?));
    let write = |zip: &mut ZipWriter<_>| -> Result<(), Error> {
        for file in files {
            zip.start_file(&file.name, options(file.bytes))?;
            copy(file, zip)?;
        }
        Ok(())
    };
    write(&mut zip).with_context(|| cannot_write(path))?;
    let finished = zip.finish().with_context(|| cannot_write(path));
    finished?.flush().with_context(|| cannot_write(path))?;
    draft.publish()?;
    Ok(())
}

fn options(bytes: u64) -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .large_file(bytes > u64::from(u32::MAX))
}

fn copy(file: &ArchiveFile, target: &mut impl io::Write) -> io::Result<()> {
    io::copy(&mut *file.content.open()?, target)?;
    Ok(())
}

fn cannot_write(path: &Path) -> String {
    format!("cannot write {}", path.display())
}

/// An archive that is read.
pub(super) struct Unpacked {
    pub(super) folder: PathBuf,
    /// Deleted with this.
    _temporary: Option<TempDir>,
}

/// Whether a path is that of a directory or a ZIP file.
pub(in crate::cli::commands) fn is_archive(path: &Path) -> bool {
    const MAGIC: &[u8; 4] = b"PK\x03\x04";
    let mut start = [0; MAGIC.len()];
    // Streams can be read only once.
    let mut read = || File::open(path)?.read_exact(&mut start);
    path.is_dir() || path.is_file() && read().is_ok() && start == *MAGIC
}

impl Unpacked {
    /// Opens an archive; a ZIP file is unpacked into a temporary directory.
    pub(super) fn open(path: &Path) -> Result<Self, Error> {
        let (folder, temporary) = if path.is_dir() {
            (path.to_owned(), None)
        } else {
            let temporary = TempDir::new().context("cannot unpack it")?;
            unpack(path, temporary.path())?;
            (root_in(temporary.path())?, Some(temporary))
        };
        if !folder.join(SUMS).is_file() {
            bail!("no archive of toprise: it has no file {SUMS}");
        }
        Ok(Self {
            folder,
            _temporary: temporary,
        })
    }

    /// Paths of all files, relative and with `/`, sorted. Links are files here: they are not followed.
    pub(super) fn names(&self) -> io::Result<Vec<String>> {
        let (mut names, mut folders) = (Vec::new(), vec![String::new()]);
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(self.folder.join(&folder))? {
                let entry = entry?;
                let name = format!("{folder}{}", entry.file_name().to_string_lossy());
                if entry.file_type()?.is_dir() {
                    folders.push(name + "/");
                } else {
                    names.push(name);
                }
            }
        }
        names.sort();
        Ok(names)
    }

    /// The file of a name.
    pub(super) fn at(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }
}

/// How many times its size a ZIP file may unpack to. Recordings are compressed already.
const MAX_RATIO: u64 = 100;

fn unpack(path: &Path, folder: &Path) -> Result<(), Error> {
    let file = File::open(path)?;
    let mut left = file.metadata()?.len().saturating_mul(MAX_RATIO);
    let mut zip = ZipArchive::new(BufReader::new(file))?;
    for index in 0..zip.len() {
        let mut entry = zip.by_index(index)?;
        let Some(name) = entry.enclosed_name().filter(|_| !entry.is_symlink()) else {
            bail!("{:?} is no name of a file in an archive", entry.name());
        };
        let target = folder.join(name);
        if entry.is_dir() {
            fs::create_dir_all(&target)?;
            continue;
        }
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent)?;
        }
        let unpacked = io::copy(
            &mut (&mut entry).take(left + 1),
            &mut File::create_new(&target)?,
        )?;
        left = left.checked_sub(unpacked).with_context(|| {
            format!("it unpacks to more than {MAX_RATIO} times its size: unpack it yourself")
        })?;
    }
    Ok(())
}

/// The folder with the files: packing a directory by hand adds its name.
fn root_in(folder: &Path) -> io::Result<PathBuf> {
    let entries: Vec<_> = fs::read_dir(folder)?.collect::<Result<_, _>>()?;
    match entries.as_slice() {
        [one] if one.file_type()?.is_dir() => Ok(one.path()),
        _ => Ok(folder.to_owned()),
    }
}

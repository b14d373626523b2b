//! Archives as directories and as ZIP files.

use super::parts::{ArchiveFile, RECORDINGS, SUMS};
use crate::archive::publish::HiddenDirectory;
use crate::archive::publish::{Draft, Drafts, Existing};
use anyhow::{Context as _, Error, bail};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufReader, BufWriter, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
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
        let is_zip = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("zip"));
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

/// The directory gets its name when all files are written.
fn write_directory(path: &Path, files: &[ArchiveFile], drafts: &Drafts) -> Result<(), Error> {
    let problem = || cannot_write(path);
    let parent = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let hidden = drafts.hidden_directory(parent).with_context(problem)?;
    for file in files {
        let target = hidden.path().join(&file.name);
        if let Some(folder) = target.parent() {
            fs::create_dir_all(folder).with_context(problem)?;
        }
        let mut written = File::create_new(&target).with_context(problem)?;
        copy(file, &mut written).with_context(problem)?;
        written.sync_all().with_context(problem)?;
    }
    // A hidden directory is its owner's alone.
    #[cfg(unix)]
    share(hidden.path()).with_context(problem)?;
    hidden.publish(path).with_context(problem)
}

/// Gives a directory the rights of those that programs usually make.
#[cfg(unix)]
fn share(hidden: &Path) -> io::Result<()> {
    // Made under the user's mask, as all others.
    let usual = fs::metadata(hidden.join(RECORDINGS))?.permissions();
    fs::set_permissions(hidden, usual)
}

/// The bytes follow from the files alone: no compression, no times.
fn write_zip(path: &Path, files: &[ArchiveFile], drafts: &Drafts) -> Result<(), Error> {
    let draft = Draft::new_in(drafts, path, Existing::Keep)?;
    let mut zip = ZipWriter::new(BufWriter::new(draft.file()?));
    add_all(files, &mut zip).with_context(|| cannot_write(path))?;
    let finished = zip.finish().with_context(|| cannot_write(path));
    finished?.flush().with_context(|| cannot_write(path))?;
    draft.publish()?;
    Ok(())
}

fn add_all(
    files: &[ArchiveFile],
    zip: &mut ZipWriter<impl io::Write + io::Seek>,
) -> Result<(), Error> {
    for file in files {
        zip.start_file(&file.name, options(file.bytes))?;
        copy(file, zip)?;
    }
    Ok(())
}

fn options(bytes: u64) -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .large_file(bytes > u64::from(u32::MAX))
}

/// Copies a file. Its sum was computed before: what has changed since is an error.
fn copy(file: &ArchiveFile, target: &mut impl io::Write) -> Result<(), Error> {
    let mut hashed = Hashed {
        target,
        hasher: Sha256::new(),
    };
    io::copy(&mut *file.content.open()?, &mut hashed)?;
    if format!("{:x}", hashed.hasher.finalize()) != file.sha256 {
        bail!("{} has changed while it was read", file.name);
    }
    Ok(())
}

/// A writer that computes the sum of what it writes.
struct Hashed<'a, W> {
    target: &'a mut W,
    hasher: Sha256,
}

impl<W: io::Write> io::Write for Hashed<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.target.write(bytes)?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.target.flush()
    }
}

fn cannot_write(path: &Path) -> String {
    format!("cannot write {}", path.display())
}

/// An archive that is read.
pub(super) struct Unpacked {
    pub(super) folder: PathBuf,
    /// Deleted with this.
    _unpacked: Option<HiddenDirectory>,
}

/// Whether a path is that of a directory or a ZIP file.
pub(in crate::cli::commands) fn is_archive(path: &Path) -> bool {
    // Streams can be read only once.
    path.is_dir() || path.is_file() && begins_as_zip(path).unwrap_or(false)
}

fn begins_as_zip(path: &Path) -> io::Result<bool> {
    const MAGIC: &[u8; 4] = b"PK\x03\x04";
    let mut start = [0; MAGIC.len()];
    File::open(path)?.read_exact(&mut start)?;
    Ok(start == *MAGIC)
}

impl Unpacked {
    /// Opens an archive; a ZIP file is unpacked into a temporary directory.
    pub(super) fn open(path: &Path, drafts: &Drafts) -> Result<Self, Error> {
        let (folder, unpacked) = if path.is_dir() {
            (path.to_owned(), None)
        } else {
            let hidden = drafts.hidden_directory(&std::env::temp_dir());
            let hidden = hidden.context("it can't be unpacked into the temporary directory")?;
            unpack(path, hidden.path())?;
            (root_in(hidden.path())?, Some(hidden))
        };
        if !folder.join(SUMS).is_file() {
            bail!("no archive of toprise: it has no file {SUMS}");
        }
        Ok(Self {
            folder,
            _unpacked: unpacked,
        })
    }

    /// Paths of all files, relative and with `/`, and whether each is a regular file: links are not followed, and pipes
    /// and devices never end.
    pub(super) fn names(&self) -> io::Result<BTreeMap<String, bool>> {
        let (mut names, mut folders) = (BTreeMap::new(), vec![String::new()]);
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(self.folder.join(&folder))? {
                let entry = entry?;
                let name = format!("{folder}{}", entry.file_name().to_string_lossy());
                let kind = entry.file_type()?;
                if kind.is_dir() {
                    folders.push(name + "/");
                } else {
                    names.insert(name, kind.is_file());
                }
            }
        }
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
    let mut zip = ZipArchive::new(BufReader::new(&file))?;
    if entry_count(&file)?.is_some_and(|count| usize::from(count) != zip.len()) {
        bail!("it has two files of one name");
    }
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

/// Number of entries of a ZIP file, by the record at its end (APPNOTE 6.3.10, 4.3.16); `None` if there are more than the
/// record can count. Readers keep one of several entries of a name, and differ in which.
fn entry_count(mut file: &File) -> io::Result<Option<u16>> {
    const SIGNATURE: &[u8] = b"PK\x05\x06";
    /// The record with the longest comment.
    const MAX_LENGTH: u64 = 22 + 0xffff;
    let start = file.metadata()?.len().saturating_sub(MAX_LENGTH);
    file.seek(SeekFrom::Start(start))?;
    let mut end = Vec::new();
    file.read_to_end(&mut end)?;
    let at = end.windows(4).rposition(|bytes| bytes == SIGNATURE);
    let count = at.and_then(|at| end.get(at + 10..at + 12));
    let count = count.map(|bytes| u16::from_le_bytes([bytes[0], bytes[1]]));
    Ok(count.filter(|count| *count != u16::MAX))
}

/// The folder with the files: packing a directory by hand adds its name, and some programs add folders of their own.
fn root_in(folder: &Path) -> io::Result<PathBuf> {
    if folder.join(SUMS).is_file() {
        return Ok(folder.to_owned());
    }
    for entry in fs::read_dir(folder)? {
        let inside = entry?.path();
        if inside.join(SUMS).is_file() {
            return Ok(inside);
        }
    }
    Ok(folder.to_owned())
}

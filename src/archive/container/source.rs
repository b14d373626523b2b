//! Random-access bytes shared between threads: a file, or a file's content in memory.
//!
//! The file is not memory-mapped: truncating a mapped file would kill the process, and reading is equally fast.

use crate::archive::error::RecordingError;
use mcap::MAGIC;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

/// Opens a file for reading. Pipes and devices are rejected, because opening a pipe could block.
///
/// # Errors
/// The system error, or an error if the path is not a regular file.
pub fn open_file(path: &Path) -> io::Result<File> {
    let metadata = path.metadata()?;
    if !metadata.is_file() && !metadata.is_dir() {
        let reason =
            "it is a pipe or a device, not a file (runs can be read from standard input, as -)";
        return Err(io::Error::other(reason));
    }
    File::open(path)
}

/// Whether a path names a stream that is open already: standard input as `-`, or a descriptor of a shell's `<(…)`. Named
/// pipes don't: opening them could block.
pub(crate) fn is_stream(path: &Path) -> bool {
    let mut open = ["/dev/stdin", "/dev/fd", "/proc/self/fd"].iter();
    let is_special = || {
        path.metadata()
            .is_ok_and(|at| !at.is_file() && !at.is_dir())
    };
    path.as_os_str() == "-" || open.any(|folder| path.starts_with(folder)) && is_special()
}

/// Keeps a stream in a temporary file without a name.
fn spool(path: &Path) -> io::Result<File> {
    let mut stream: Box<dyn Read> = if path.as_os_str() == "-" {
        Box::new(io::stdin().lock())
    } else {
        Box::new(File::open(path)?)
    };
    let copied = tempfile::tempfile().and_then(|mut file| {
        io::copy(&mut stream, &mut file)?;
        Ok(file)
    });
    copied.map_err(|error| {
        let folder = std::env::temp_dir();
        let problem = "the stream can't be kept in a temporary file in";
        io::Error::other(format!("{problem} {}: {error}", folder.display()))
    })
}

/// An open file, or its content.
#[derive(Debug)]
pub(crate) struct Source {
    content: Content,
    length: u64,
}

#[derive(Debug)]
enum Content {
    File(File),
    Memory(Arc<[u8]>),
}

impl Source {
    pub(crate) fn open(path: &Path) -> Result<Self, RecordingError> {
        let file = if is_stream(path) {
            spool(path)?
        } else {
            open_file(path)?
        };
        let metadata = file.metadata()?;
        let length = metadata.len();
        if metadata.is_dir() {
            return Err(RecordingError::Directory);
        }
        Self::new(Content::File(file), length)
    }

    /// The content of a file.
    pub(crate) fn from_bytes(bytes: Vec<u8>) -> Result<Self, RecordingError> {
        let length = bytes.len() as u64;
        Self::new(Content::Memory(bytes.into()), length)
    }

    fn new(content: Content, length: u64) -> Result<Self, RecordingError> {
        if length == 0 {
            return Err(RecordingError::Empty);
        }
        Ok(Self { content, length })
    }

    /// The CRC-32 of the bytes between two positions.
    pub(crate) fn checksum(&self, from: u64, to: u64) -> io::Result<u32> {
        let mut hasher = crc32fast::Hasher::new();
        let mut bytes = Vec::new();
        let mut at = from;
        while at < to {
            self.read(at, (1 << 20).min(to - at), &mut bytes)?;
            if bytes.is_empty() {
                break;
            }
            hasher.update(&bytes);
            at += bytes.len() as u64;
        }
        Ok(hasher.finalize())
    }

    /// Whether the magic bytes of MCAP are at an offset.
    pub(crate) fn has_magic_at(&self, offset: u64) -> io::Result<bool> {
        let mut bytes = Vec::new();
        self.read(offset, MAGIC.len() as u64, &mut bytes)?;
        Ok(bytes == MAGIC)
    }

    /// The same file for another thread.
    pub(crate) fn try_clone(&self) -> io::Result<Self> {
        let content = match &self.content {
            Content::File(file) => Content::File(file.try_clone()?),
            Content::Memory(bytes) => Content::Memory(Arc::clone(bytes)),
        };
        Ok(Self { content, ..*self })
    }

    /// Length of the file when it was opened, bytes.
    pub(crate) fn length(&self) -> u64 {
        self.length
    }

    /// Reads `length` bytes at `offset` into `buffer`, replacing what is there; fewer at the end of the
    /// file.
    pub(crate) fn read(&self, offset: u64, length: u64, buffer: &mut Vec<u8>) -> io::Result<()> {
        let length = length.min(self.length.saturating_sub(offset));
        let length = usize::try_from(length).map_err(io::Error::other)?;
        buffer.clear();
        buffer.resize(length, 0);
        let mut filled = 0;
        while filled < length {
            match self
                .content
                .read_at(&mut buffer[filled..], offset + filled as u64)
            {
                Ok(0) => break,
                Ok(count) => filled += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        buffer.truncate(filled);
        Ok(())
    }
}

impl Content {
    fn read_at(&self, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
        match self {
            Self::File(file) => read_at(file, buffer, offset),
            Self::Memory(bytes) => {
                let start = usize::try_from(offset).unwrap_or(usize::MAX);
                let mut rest = bytes.get(start..).unwrap_or_default();
                rest.read(buffer)
            }
        }
    }
}

#[cfg(unix)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, offset)
}

#[cfg(windows)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, buffer, offset)
}

/// Platforms without files (WebAssembly).
#[cfg(not(any(unix, windows)))]
fn read_at(_: &File, _: &mut [u8], _: u64) -> io::Result<usize> {
    Err(io::ErrorKind::Unsupported.into())
}

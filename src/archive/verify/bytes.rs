//! Byte comparison of a file with a new run.

use crate::archive::container::source::Source;
use crate::archive::pipeline::Pipeline;
use crate::archive::recording::Recording;
use crate::archive::sink::{Sink, record};
use crate::archive::supplements::Supplements;
use crate::archive::writer::Header;
use crate::telemetry::RunMessages;
use std::io::{self, BufWriter, Write};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Whether a file is byte-identical to a new run; `None` if it can't be read. The run stops at the first byte that
/// differs.
pub(super) fn are_equal(
    recording: &Recording,
    mut run: RunMessages,
    header: &Header,
    progress: &dyn Fn(u64),
) -> Option<bool> {
    let position = Arc::new(AtomicU64::new(0));
    let comparer = Comparer {
        source: recording.source.try_clone().ok()?,
        position: Arc::clone(&position),
        bytes: Vec::new(),
    };
    // Compares in large pieces: each one is a read of the file.
    let file = BufWriter::with_capacity(64 * 1024, comparer);
    let mut sink = Pipeline::start(file, recording.path().to_owned(), header).ok()?;
    let mut reported = 0;
    let sinks: &mut [&mut dyn Sink] = &mut [&mut sink];
    let recorded = record(&mut run, sinks, |_, _| {
        let equal = position.load(Ordering::Relaxed);
        progress(equal - std::mem::replace(&mut reported, equal));
        Ok(ControlFlow::Continue(()))
    });
    let ended = sink
        .end(&recorded.ok()?.outcome.end, &Supplements::default())
        .ok()?;
    // The last bytes are compared when the buffer is emptied.
    ended.target.into_inner().ok()?;
    let equal = position.load(Ordering::Relaxed);
    progress(equal - reported);
    // A file that goes on after the run has the same bytes up to there.
    Some(equal == recording.size())
}

/// Writer that fails at the first byte that differs from a file.
#[derive(Debug)]
struct Comparer {
    source: Source,
    /// Number of equal bytes.
    position: Arc<AtomicU64>,
    bytes: Vec<u8>,
}

impl Write for Comparer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let at = self.position.load(Ordering::Relaxed);
        self.source.read(at, bytes.len() as u64, &mut self.bytes)?;
        if self.bytes != bytes {
            return Err(io::Error::other("the bytes differ"));
        }
        self.position
            .store(at + bytes.len() as u64, Ordering::Relaxed);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

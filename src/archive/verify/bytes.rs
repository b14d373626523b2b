//! Byte comparison of a file with a new run.

use crate::archive::container::source::Source;
use crate::archive::pipeline::Pipeline;
use crate::archive::recording::Recording;
use crate::archive::sink::{Sink, record_to_end};
use crate::archive::writer::{Form, Opening};
use crate::run::scenario::Scenario;
use crate::run::simulation::Simulation;
use crate::telemetry::Telemetry;
use std::io::{self, BufWriter, Write};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Whether a file is byte-identical to a new run; `None` if it can't be run or read. The run stops at the
/// first byte that differs.
pub(super) fn are_equal(
    recording: &Recording,
    scenario: &Scenario,
    mut telemetry: Telemetry,
    form: Form,
    progress: &dyn Fn(u64),
) -> Option<bool> {
    let mut simulation = Simulation::new(scenario).ok()?;
    let position = Arc::new(AtomicU64::new(0));
    let comparer = Comparer {
        source: recording.source.try_clone().ok()?,
        position: Arc::clone(&position),
        bytes: Vec::new(),
    };
    let file = BufWriter::with_capacity(64 * 1024, comparer);
    let opening = Opening::new(scenario, &telemetry, form);
    let mut sink = Pipeline::start(file, recording.path().to_owned(), opening).ok()?;
    let mut reported = 0;
    let mut report = || {
        let at = position.load(Ordering::Relaxed);
        progress(at - std::mem::replace(&mut reported, at));
    };
    let sinks: &mut [&mut dyn Sink] = &mut [&mut sink];
    let ended = record_to_end(&mut simulation, &mut telemetry, sinks, |_, _| {
        report();
        Ok(ControlFlow::Continue(()))
    });
    let (end, _) = ended.ok()?;
    let (file, _) = sink.end(&end).ok()?;
    let comparer = file.into_inner().ok()?;
    report();
    Some(comparer.position.load(Ordering::Relaxed) == recording.size())
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

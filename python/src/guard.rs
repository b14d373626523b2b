//! Runs long computations without the GIL. Ctrl-C stops them; a panic becomes an exception.

use crate::errors::InternalError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::{PyErr, PyResult, Python};
use std::any::Any;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Interval between checks for Python signals; short enough that Ctrl-C feels immediate.
const BETWEEN_SIGNALS: Duration = Duration::from_millis(50);

/// Time allowed for a computation to end after a signal. After that, its thread is abandoned.
const PATIENCE: Duration = Duration::from_millis(200);

/// The same for a computation that writes files.
const PATIENCE_WITH_WRITERS: Duration = Duration::from_secs(2);

/// Stack size of the computing thread, bytes; that of a main thread.
const STACK: usize = 8 << 20;

/// Cancellation flag of a computation.
#[derive(Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Whether cancellation was requested.
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Unwinds the computing thread if cancellation was requested.
    pub fn unwind_if_requested(&self) {
        if self.is_requested() {
            resume_unwind(Box::new("interrupted"));
        }
    }

    fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs a long computation on its own thread, so that Python can handle signals and run other threads.
///
/// # Errors
/// The exception raised by a signal handler, or `InternalError` if the computation panicked.
pub fn compute<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(Interrupt) -> T + Send + 'static,
) -> PyResult<T> {
    wait_for(py, PATIENCE, |_| Ok(()), work)
}

/// Like [`compute`], for computations that write files. Calls a callback periodically; an error of the callback
/// ends the computation.
pub fn compute_watched<T: Send + 'static>(
    py: Python<'_>,
    look: impl Fn(Python<'_>) -> PyResult<()>,
    work: impl FnOnce(Interrupt) -> T + Send + 'static,
) -> PyResult<T> {
    wait_for(py, PATIENCE_WITH_WRITERS, look, work)
}

fn wait_for<T: Send + 'static>(
    py: Python<'_>,
    patience: Duration,
    look: impl Fn(Python<'_>) -> PyResult<()>,
    work: impl FnOnce(Interrupt) -> T + Send + 'static,
) -> PyResult<T> {
    let interrupt = Interrupt::default();
    let flag = interrupt.clone();
    let (sender, mut receiver) = channel();
    // Signal handlers of Python run only on the main thread, which therefore waits.
    let worker = thread::Builder::new()
        .stack_size(STACK)
        .spawn(move || {
            // The receiver is gone after an interrupt.
            let _ = sender.send(work(flag));
        })
        .map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let mut raised: Option<(PyErr, Instant)> = None;
    loop {
        let waiting = &mut receiver;
        let received = py.detach(move || waiting.recv_timeout(BETWEEN_SIGNALS));
        match (received, raised.take()) {
            (Ok(result), None) => return Ok(result),
            (Err(RecvTimeoutError::Disconnected), None) => {
                let panic = py.detach(|| worker.join()).err();
                return Err(failure(panic.as_deref()));
            }
            (Err(RecvTimeoutError::Timeout), None) => {
                if let Err(error) = py.check_signals().and_then(|()| look(py)) {
                    interrupt.request();
                    raised = Some((error, Instant::now()));
                }
            }
            (Err(RecvTimeoutError::Timeout), Some((error, at))) if at.elapsed() < patience => {
                raised = Some((error, at));
            }
            (_, Some((error, _))) => return Err(error),
        }
    }
}

/// Message of a panic.
fn failure(panic: Option<&(dyn Any + Send)>) -> PyErr {
    let text = panic
        .and_then(|payload| {
            // `panic!` has a string with arguments, and a literal without.
            payload
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| payload.downcast_ref::<&str>().copied())
        })
        .unwrap_or("it panicked");
    InternalError::new_err(format!("toprise has failed; please report it: {text}"))
}

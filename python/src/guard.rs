//! Long computations, as Python wants them: other threads go on, Ctrl-C ends them, and a panic is an exception.

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

/// Interval at which Python is asked for signals: a person who presses Ctrl-C doesn't notice the wait.
const BETWEEN_SIGNALS: Duration = Duration::from_millis(50);

/// Time in which a computation has to end after a signal. One that has not asked by then whether to go on is left behind.
const PATIENCE: Duration = Duration::from_millis(200);

/// Time in which a computation that writes files has to end in order.
const PATIENCE_WITH_WRITERS: Duration = Duration::from_secs(2);

/// The stack that main threads have, bytes: the computation must not see a smaller one.
const STACK: usize = 8 << 20;

/// Whether the caller no longer wants a computation.
#[derive(Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Whether to end.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Ends the computation by unwinding its thread, if an end was asked for.
    pub fn end_if_asked(&self) {
        if self.is_asked() {
            resume_unwind(Box::new("interrupted"));
        }
    }

    fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Computes something that may take long, on a thread of its own, while Python handles signals and runs other threads.
///
/// # Errors
/// What a signal's handler has raised, or that the computation has panicked.
pub fn compute<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(Interrupt) -> T + Send + 'static,
) -> PyResult<T> {
    wait_for(py, PATIENCE, |_| Ok(()), work)
}

/// As [`compute`], for what writes files, with a look at the work now and then; an error of it ends the work too.
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
    let given = interrupt.clone();
    let (sender, mut receiver) = channel();
    let worker = thread::Builder::new().stack_size(STACK).spawn(move || {
        // The receiver is gone after an interrupt.
        let _ = sender.send(work(given));
    });
    let worker = worker.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
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
                    interrupt.ask();
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
    let text = panic.and_then(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        text.or_else(|| panic.downcast_ref::<&str>().copied())
    });
    let text = text.unwrap_or("it panicked");
    InternalError::new_err(format!("toprise has failed; please report it: {text}"))
}

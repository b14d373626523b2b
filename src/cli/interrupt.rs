//! Ctrl-C and termination signals.

use crate::archive::publish::abandon_drafts;
use anyhow::{Context as _, Error};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// Exit code on immediate termination: 128 + SIGINT, as in shells.
const IMMEDIATE_EXIT_CODE: i32 = 130;

/// Set by commands that shut down gracefully.
static GRACEFUL: OnceLock<Interrupt> = OnceLock::new();

/// Cancellation flag, set by Ctrl-C.
#[derive(Clone, Debug, Default)]
pub(super) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Handles Ctrl-C and SIGTERM: the first requests a graceful shutdown, the second exits immediately.
    pub(super) fn watch() -> Result<Self, Error> {
        let interrupt = GRACEFUL.get_or_init(Self::default).clone();
        // It may be watched for already.
        match ctrlc::set_handler(on_signal) {
            Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(interrupt),
            Err(error) => Err(error).context("cannot watch for Ctrl-C"),
        }
    }

    /// Whether the user has asked for an end.
    pub(super) fn is_requested(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// Installs the signal handler. By default a signal exits immediately and removes draft files; commands can opt into a
/// graceful shutdown. Ignored signals (`nohup`) stay ignored.
pub(super) fn handle() {
    let _ = ctrlc::try_set_handler(on_signal);
}

fn on_signal() {
    let first = |interrupt: &Interrupt| !interrupt.0.swap(true, Ordering::SeqCst);
    if !GRACEFUL.get().is_some_and(first) {
        abandon_drafts();
        std::process::exit(IMMEDIATE_EXIT_CODE);
    }
}

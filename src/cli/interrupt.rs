//! Ctrl-C and termination signals.

use crate::archive::publish::Drafts;
use anyhow::{Context as _, Error};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};

/// Exit code on immediate termination: 128 + SIGINT, as in shells.
const IMMEDIATE_EXIT_CODE: i32 = 130;

// A signal reaches the whole process, so these belong to the program; libraries get a function to ask.

/// Set by commands that shut down gracefully.
static IS_GRACEFUL: AtomicBool = AtomicBool::new(false);
/// Set by the first signal of a graceful shutdown.
static IS_REQUESTED: AtomicBool = AtomicBool::new(false);

/// Handles signals for the program as long as it runs, and removes its drafts when one ends it.
pub(super) struct SignalGuard {
    drafts: Drafts,
}

impl SignalGuard {
    /// Installs the signal handler. By default a signal exits immediately and removes draft files; commands can opt into
    /// a graceful shutdown. If a signal is ignored (`nohup`), none is handled here.
    pub(super) fn install() -> Self {
        let drafts = Drafts::default();
        let abandoned = drafts.clone();
        // If another handler is installed, that one decides.
        let _ = ctrlc::try_set_handler(move || on_signal(&abandoned));
        Self { drafts }
    }

    /// The drafts that are removed.
    pub(super) fn drafts(&self) -> &Drafts {
        &self.drafts
    }
}

/// From now on the first Ctrl-C, SIGTERM or SIGHUP requests a graceful shutdown, also where these signals were ignored;
/// the second exits immediately.
pub(super) fn watch(drafts: &Drafts) -> Result<(), Error> {
    IS_GRACEFUL.store(true, SeqCst);
    let abandoned = drafts.clone();
    // The handler may already be installed.
    match ctrlc::set_handler(move || on_signal(&abandoned)) {
        Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(()),
        Err(error) => Err(error).context("cannot watch for Ctrl-C"),
    }
}

/// Whether the user has requested termination.
pub(super) fn is_requested() -> bool {
    IS_REQUESTED.load(SeqCst)
}

/// Continues unless an interrupt was requested.
pub(super) fn flow() -> ControlFlow<()> {
    if is_requested() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

fn on_signal(drafts: &Drafts) {
    if !IS_GRACEFUL.load(SeqCst) || IS_REQUESTED.swap(true, SeqCst) {
        // No destructors run from here on.
        drafts.abandon();
        std::process::exit(IMMEDIATE_EXIT_CODE);
    }
}

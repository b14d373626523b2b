//! Ctrl-C, and what else asks the program to end.

use crate::archive::publish::abandon_drafts;
use anyhow::{Context as _, Error};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// The exit code of a command that ends at once: 128 and the number of SIGINT, as shells have it.
const AT_ONCE: i32 = 130;

/// Set where the command wants to end in order.
static ORDERLY: OnceLock<Interrupt> = OnceLock::new();

/// A flag that is set when the user asks for an end.
#[derive(Clone, Debug, Default)]
pub(super) struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Watches for Ctrl-C and the like: the first asks for an orderly end, the second ends the program at once.
    pub(super) fn watch() -> Result<Self, Error> {
        let interrupt = ORDERLY.get_or_init(Self::default).clone();
        // It may be watched for already.
        match ctrlc::set_handler(on_signal) {
            Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(interrupt),
            Err(error) => Err(error).context("cannot watch for Ctrl-C"),
        }
    }

    /// Whether the user has asked for an end.
    pub(super) fn is_asked(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// From now on, Ctrl-C and the like end the program at once, without drafts of files being left, unless the command
/// wants to end in order. Where some of them are ignored, as below `nohup`, all stays as it is.
pub(super) fn handle() {
    let _ = ctrlc::try_set_handler(on_signal);
}

fn on_signal() {
    let first = |interrupt: &Interrupt| !interrupt.0.swap(true, Ordering::SeqCst);
    if !ORDERLY.get().is_some_and(first) {
        abandon_drafts();
        std::process::exit(AT_ONCE);
    }
}

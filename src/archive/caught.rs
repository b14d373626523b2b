//! Panics that become errors.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use thiserror::Error;

thread_local! {
    static IS_CATCHING: Cell<bool> = const { Cell::new(false) };
}

/// Whether a panic of this thread becomes an error now, so that a program's panic hook needn't print it.
pub fn is_catching() -> bool {
    IS_CATCHING.get()
}

/// Message of a panic.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("panic: {0}")]
pub(crate) struct Panic(String);

/// The result of a task, or the message of its panic.
pub(crate) fn catch<T>(task: impl FnOnce() -> T) -> Result<T, Panic> {
    let before = IS_CATCHING.replace(true);
    // Nothing that a panic may leave half changed is used again: the callers drop the task with all that it has
    // borrowed.
    let caught = catch_unwind(AssertUnwindSafe(task));
    // Not to false: calls may be nested.
    IS_CATCHING.set(before);
    caught.map_err(|panic| Panic(message(panic.as_ref()).to_owned()))
}

/// The text of a panic's payload.
fn message(panic: &(dyn Any + Send)) -> &str {
    if let Some(text) = panic.downcast_ref::<&str>() {
        return text;
    }
    panic
        .downcast_ref::<String>()
        .map_or("no message", String::as_str)
}

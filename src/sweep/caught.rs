//! Panics that become errors.

use std::any::Any;
use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    static IS_CATCHING: Cell<bool> = const { Cell::new(false) };
}

static QUIET: Once = Once::new();

/// The result of a task, or the message of its panic, which isn't printed. Panics of other threads are.
pub(super) fn catch<T>(task: impl FnOnce() -> T) -> Result<T, String> {
    QUIET.call_once(|| {
        let print = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_CATCHING.get() {
                print(info);
            }
        }));
    });
    let before = IS_CATCHING.replace(true);
    let caught = catch_unwind(AssertUnwindSafe(task));
    IS_CATCHING.set(before);
    caught.map_err(|panic| message(panic.as_ref()).to_owned())
}

/// Message of a panic.
fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    let string = || panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(string).unwrap_or("no message")
}

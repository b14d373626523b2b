//! Reading damaged Parquet files.

use std::panic::{self, AssertUnwindSafe};

/// Result of `read`. The `parquet` and `arrow-ipc` crates panic on some damaged files, where they should return an error:
/// that is an error here, and their message, which is about their code, is not printed.
pub(super) fn guarded<T>(read: impl FnOnce() -> T) -> Result<T, &'static str> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let result = panic::catch_unwind(AssertUnwindSafe(read));
    panic::set_hook(hook);
    result.map_err(|_| "the file is damaged")
}

//! Any bytes as a recording.

#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

#[allow(dead_code)] // each target takes one of the steps
mod steps;

/// One directory per process, in memory where that is possible: every input is written, read and written
/// again.
static SCRATCH: LazyLock<PathBuf> = LazyLock::new(|| {
    let memory = Path::new("/dev/shm");
    let base = match memory.is_dir() {
        true => memory.to_owned(),
        false => std::env::temp_dir(),
    };
    let directory = base.join(format!("toprise-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&directory).expect("a directory for temporary files");
    directory
});

fuzz_target!(|data: &[u8]| steps::recording(data, &SCRATCH));

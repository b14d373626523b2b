//! Every input that fuzzing starts from, or has found a fault with, through the same steps.

use std::fs;
use std::path::{Path, PathBuf};

#[path = "../../fuzz/fuzz_targets/steps.rs"]
pub mod steps;

/// The files of a target, which must be some.
fn inputs(target: &str) -> Vec<PathBuf> {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let mut files = Vec::new();
    for kind in ["corpus", "regressions"] {
        // Git keeps no empty directories: a target without findings has none.
        let Ok(entries) = fs::read_dir(fuzz.join(kind).join(target)) else {
            continue;
        };
        files.extend(entries.map(|entry| entry.unwrap().path()));
    }
    files.sort();
    assert!(!files.is_empty(), "no inputs for {target}");
    files
}

/// Tests keep quiet unless they fail: then the last input that is named is the one.
fn each(target: &str, step: impl Fn(&[u8])) {
    for file in inputs(target) {
        println!("{}", file.display());
        step(&fs::read(&file).unwrap());
    }
}

#[test]
fn corpus_recordings_do_not_panic() {
    let scratch = tempfile::tempdir().unwrap();
    each("recording", |data| steps::recording(data, scratch.path()));
    assert_eq!(fs::read_dir(scratch.path()).unwrap().count(), 1);
}

#[test]
fn corpus_scenarios_do_not_panic() {
    each("scenario", steps::scenario);
}

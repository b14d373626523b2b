//! Whole recordings with bits flipped, and pieces of recordings put together.

use crate::bench::{Random, Trial};
use crate::material::{forms, recorded, scenario};
use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use toprise::analysis::diff::{Options as DiffOptions, compare};
use toprise::analysis::explain::explain;
use toprise::archive::input::Input;
use toprise::archive::recording::{Overview, Recording};
use toprise::archive::verify::{Verdict, verify};
use toprise::archive::writer::Form;
use toprise::run::scenario::Scenario;

thread_local! {
    /// A place for files of this thread.
    static ROOM: RefCell<Option<TempDir>> = const { RefCell::new(None) };
}

/// A name for a file of this thread.
fn path(name: &str) -> PathBuf {
    ROOM.with_borrow_mut(|room| {
        let room = room.get_or_insert_with(|| tempfile::tempdir().unwrap());
        room.path().join(name)
    })
}

/// Flips a bit, or several in a byte, of a whole recording: `verify` must notice, and one in 50 is read in every way.
pub fn flips() -> Result<Trial, String> {
    let tiny = scenario("paper", &[("stop.duration", "0.002")]);
    let small = scenario("full-coulomb", &[("stop.duration", "0.03")]);
    let mut wholes: Vec<Vec<u8>> = forms().map(|form| recorded(&tiny, &[], form)).collect();
    wholes.extend(forms().map(|form| recorded(&small, &[], form)));
    wholes.push(recorded(&tiny, &["/events"], Form::default()));
    Ok(Box::new(move |random| {
        let mut bytes = random.one_of(&wholes).clone();
        let at = random.below(bytes.len());
        let mask = match random.below(4) {
            0 => 1 + random.below(255) as u8,
            _ => 1 << random.below(8),
        };
        bytes[at] ^= mask;
        let path = path("flipped.mcap");
        fs::write(&path, &bytes).unwrap();
        if is_verified(&path) {
            let length = bytes.len();
            return Err(format!(
                "byte {at} of {length} xor {mask:#x} is not noticed"
            ));
        }
        if random.below(50) == 0 {
            endures(&path)?;
        }
        Ok(())
    }))
}

/// Whether `verify` finds nothing wrong with a file.
fn is_verified(path: &Path) -> bool {
    let recording = Recording::open(path);
    recording.is_ok_and(|recording| {
        verify(&recording, &|_| {}).is_ok_and(|report| report.verdict == Verdict::Verified)
    })
}

/// Reads everything of a file in every way. Its scenario, if it is there, is that of one of the whole recordings.
fn endures(file: &Path) -> Result<(), String> {
    let _ = Overview::read(file);
    let Ok(recording) = Recording::open(file) else {
        return Ok(());
    };
    let _ = explain(&recording);
    let _ = compare(&recording, &recording, &DiffOptions::default());
    let values = Input::open(file).and_then(|input| input.values()).ok();
    let again = values.map(Scenario::new).transpose();
    again
        .map(|_| ())
        .map_err(|error| format!("the scenario: {error}"))
}

/// Puts pieces of two recordings together, cuts some out, repeats or swaps some: `verify` must notice.
pub fn splices() -> Result<Trial, String> {
    let keys = [
        ("paper", ("friction.k", "0.03")),
        ("paper", ("friction.k", "0.02")),
        ("paper", ("sampling.period", "0.002")),
        ("full-coulomb", ("initial.psi_dot", "150")),
        ("frictionless", ("initial.theta", "0.4")),
    ];
    let mut wholes = Vec::new();
    for (preset, key) in keys {
        for duration in ["0.02", "0.3"] {
            let scenario = scenario(preset, &[key, ("stop.duration", duration)]);
            for form in forms() {
                let bytes = recorded(&scenario, &[], form);
                let cuts = cuts(&bytes);
                wholes.push(Spliceable { bytes, cuts });
            }
        }
    }
    Ok(Box::new(move |random| {
        let (one, other) = (random.one_of(&wholes), random.one_of(&wholes));
        let bytes = spliced(random, one, other);
        if bytes == one.bytes || bytes == other.bytes {
            return Ok(());
        }
        let path = path("spliced.mcap");
        fs::write(&path, &bytes).unwrap();
        if is_verified(&path) {
            return Err("a splice is not noticed".to_owned());
        }
        endures(&path)
    }))
}

/// A recording with the places between its records.
struct Spliceable {
    bytes: Vec<u8>,
    cuts: Vec<usize>,
}

/// Where the top-level records begin.
fn cuts(bytes: &[u8]) -> Vec<usize> {
    let mut cuts = vec![0];
    let mut at = 8;
    while let Some(length) = bytes.get(at + 1..at + 9) {
        cuts.push(at);
        let length = u64::from_le_bytes(length.try_into().unwrap());
        at += 9 + usize::try_from(length).unwrap();
    }
    cuts.push(bytes.len());
    cuts
}

fn spliced(random: &mut Random, one: &Spliceable, other: &Spliceable) -> Vec<u8> {
    // Between records most of the time: a cut within one is found by its length alone.
    let mut cut = |of: &Spliceable| match random.below(8) {
        0 => random.below(of.bytes.len()),
        _ => *random.one_of(&of.cuts),
    };
    let (a, b) = (&one.bytes, &other.bytes);
    let (mut from, mut to) = (cut(one), cut(one));
    if from > to {
        (from, to) = (to, from);
    }
    let (mut start, mut end) = (cut(other), cut(other));
    if start > end {
        (start, end) = (end, start);
    }
    match random.below(5) {
        // The beginning of one and the end of the other.
        0 => [&a[..from], &b[start..]].concat(),
        // A piece of the other in the place of one's own.
        1 => [&a[..from], &b[start..end], &a[to..]].concat(),
        // A piece is missing.
        2 => [&a[..from], &a[to..]].concat(),
        // A piece is repeated.
        3 => [&a[..to], &a[from..]].concat(),
        // All of one before the other.
        _ => [a, &b[start..]].concat(),
    }
}

//! `regress_*`: the bits of the presets' runs, the same on every machine and in every build.
//!
//! A change here is a change of physics or numerics: it needs a reason in the changelog, and new
//! reference recordings.

use std::fs;
use std::path::Path;
use toprise::analysis::verify::{Options, Verdict, verify};
use toprise::archive::recording::Recording;
use toprise::run::scenario::{PRESETS, Preset};
use toprise::run::simulation::{Outcome, Simulation};
use toprise::telemetry::digest::ContentDigest;
use toprise::telemetry::{Telemetry, TelemetryError};

/// Preset, messages, steps, content digest at its own sample period with all topics.
#[rustfmt::skip]
const GOLDEN: &[(&str, u64, u64, &str)] = &[
    ("paper", 198977, 10642, "ff4a1f2e2b70df2128aee818b72ac4adacf5bfffe6d042eb5341ab1f90048396"),
    ("paper-precession-term-only", 578479, 188008, "bafaf14a9ccd77da305f04c6110fcf791bd1bc6649466816bf88eccd1a168ac2"),
    ("paper-spin-term-only", 245110, 4609, "df005620ce0e51752d31993c7215aacd5db9008ca834d5383306917c65bcc2b1"),
    ("full-coulomb", 198378, 10125, "8651e0c180f55cb63c5a083401746ab22fee45dc5be172c41eebe7c01e56e99e"),
    ("frictionless", 161372, 6456, "a5a04e1700102fb098cae570ba82b386b03465d8fafed059e787bfecc337ebda"),
    ("nutation-free", 198413, 4771, "25748047f5071fc767a0ede8c54315d439b1434ec5250e9aad8c26d74b8b5604"),
    ("tilt-torque-only", 217112, 12759, "4ea467ecd7fd5975b0e825c39fa4d70070a89d5051241d374a7d637edd1fb1b8"),
    ("spin-torque-only", 770843, 16556, "7ee86649ba97ec7a9d1aba09ca4f7aa2c2da2df6630aa143f7d52c25bd945465"),
    ("rise-by-loss-of-spin", 218490, 6423, "8a0856b9d104ace65236f019b005afdc90ed5649f81e22c3cff71fb23131a801"),
    ("viscous", 597437, 32975, "3f2d809c1b61bf3ca6558448f1b4ee026eebcaa7ce7789b6ee321b9e20e8da29"),
    ("stribeck", 177608, 9251, "12cbc889cf976022c4628ce6e68be5a29d712bd0418ad77bcd9276ac47ccf17d"),
    ("contensou", 219842, 11234, "99dc7d46e5e8d764e7643b18c34ab0e79cae9e43c0e6bd5a92bfe7860dfdac9c"),
    ("lifecycle", 624365, 14266, "0a081af1c3f8fdda8e59c4e30c09c13f04e5d808a1c40eeeaa2a9f545dd153dc"),
];

/// The presets of which there are reference recordings.
const RECORDED: [&str; 5] = [
    "paper",
    "paper-precession-term-only",
    "paper-spin-term-only",
    "full-coulomb",
    "frictionless",
];

fn digest_of(preset: &Preset) -> (u64, Outcome, String) {
    let scenario = preset.scenario().unwrap();
    let mut simulation = Simulation::new(&scenario).unwrap();
    let mut telemetry = Telemetry::default();
    let mut digest = ContentDigest::default();
    let mut messages = 0;
    for record in simulation.by_ref() {
        let counted = telemetry.messages(&record.unwrap(), |message| {
            digest.update(message);
            messages += 1;
            Ok::<(), TelemetryError>(())
        });
        counted.unwrap();
    }
    (messages, simulation.outcome(), digest.finish())
}

#[test]
fn regress_content_digests() {
    let mut found = String::new();
    for preset in PRESETS {
        let (messages, outcome, digest) = digest_of(preset);
        let steps = outcome.statistics.accepted;
        found.push_str(&format!(
            "    (\"{}\", {messages}, {steps}, \"{digest}\"),\n",
            preset.name
        ));
    }
    let expected: String = GOLDEN
        .iter()
        .map(|(name, messages, steps, digest)| {
            format!("    (\"{name}\", {messages}, {steps}, \"{digest}\"),\n")
        })
        .collect();
    assert!(
        found == expected,
        "the runs have changed; they are now\n{found}"
    );
}

#[test]
fn regress_the_reference_recordings_are_verified() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings/reference");
    let readme = fs::read_to_string(directory.join("../README.md")).unwrap();
    for name in RECORDED {
        let path = directory.join(name).with_extension("mcap");
        let recording = Recording::open(&path).unwrap();
        let report = verify(&recording, Options::default(), &|_| {});
        assert_eq!(report.verdict(), Verdict::Passed, "{report:#?}");
        let digest = &recording.end().unwrap()["content_digest"];
        assert!(
            readme.contains(digest),
            "recordings/README.md lacks the digest of {name}"
        );
    }
    assert_eq!(fs::read_dir(&directory).unwrap().count(), RECORDED.len());
}

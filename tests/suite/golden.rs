//! `regress_*`: the bits of the presets' runs, the same on every machine and in every build.
//!
//! A change here is a change of physics or numerics: it needs a reason in the changelog, and new
//! reference recordings.

use crate::support::verified;
use std::fs;
use std::path::Path;
use toprise::archive::recording::Recording;
use toprise::archive::verify::Verdict;
use toprise::run::scenario::{PRESETS, Preset};
use toprise::run::simulation::{RunEnd, Simulation};
use toprise::telemetry::digest::ContentDigest;
use toprise::telemetry::{Telemetry, TelemetryError};

/// Preset, messages, steps, content digest at its own sample period with all topics.
#[rustfmt::skip]
const GOLDEN: &[(&str, u64, u64, &str)] = &[
    ("paper", 198977, 10642, "747fc0b564a397b47e023b41376fd1e53159a02ae41d7b9cb5291785c81fcd1a"),
    ("paper-precession-term-only", 578479, 188008, "dd6a7fd8a0dbc9c334052ac6891a292b8575b9bd7101a11defb150fc1e4efc75"),
    ("paper-spin-term-only", 245109, 4609, "9993efa82836594973e71df9d13410706f7e47b14d22a43117c67d1697e9def8"),
    ("full-coulomb", 198378, 10125, "aa5811b7f2f1e2b3c7b32d73bcfdd6a05f22c20734fd495cfa2f87eb2dfdacaf"),
    ("frictionless", 161372, 6456, "d6aad3658a47e487eb4024611ab70229a8d0236cb5729f6e16e6513d8feb0e9b"),
    ("nutation-free", 198413, 4771, "223a1b027932175b3aa432f74501cdf80b6acceebc0bc2e81f284a4a21d55f74"),
    ("tilt-torque-only", 217112, 12759, "a77de348e53b6b2a395a828b4e574328ec6dce179eefa5c50af8e2ec2e1ef7c1"),
    ("spin-torque-only", 770842, 16556, "bc706fc6cecf0bdf4b214b74cb2a0d4dcfd758d45c23c6a187a02e11c858f5c4"),
    ("rise-by-loss-of-spin", 218490, 6423, "8bbdcda2a8f2b21b4054ad5b670714c0683787c7717c7852c882494b066e01b6"),
    ("viscous", 597437, 32975, "f7b1272afa3c5123851cfa2c2200b24092c5439a6a161671a7ded138e9f7aff1"),
    ("stribeck", 177608, 9251, "b08a93e156696bc7d021fc95f3a398d5a0e5239b5bd7d3d4f016471042a2cbf5"),
    ("contensou", 219842, 11234, "67ed3a6b22953fd1ef24c5d8f18632c958b120a8e89795e47481d6755ae396e7"),
    ("lifecycle", 624364, 14266, "870ba87698c656f655f02405110fe06f9e1a4434c3977cb5f09ce79f70e6dae4"),
    ("free-paper", 101741, 9896, "48553dcdc53d6dda90068b1924be9f88debfa842ee9b8bf05c6c54293684e4f9"),
    ("free-rolls", 254406, 22035, "7dc7e2ed2e753910b5846147f22b8c9b251ad796057cd9f1b034267f773a4ad8"),
    ("free-viscous", 220614, 14207, "b1c8e81847ec7acd25dea3f8fe1795fc39ec6052393d70488e9f7e6a07a1c9a5"),
    ("drop", 20239, 1508, "e049ca03928fa99ae450d7a1973e68c6c5565fe6d23081d114b9cbb50e5b7092"),
    ("tippe-top", 118662, 3894, "32c26f277c19deb9ec30441be7bf8578642885d1d7a29c792629c1e8d165c2d2"),
    ("tippe-top-hangs", 49391, 3033, "e8cbbbbaa5f9f25c4e28966504ca748f6cec94deed756de7cf2e9f1365a3355d"),
];

/// The presets of which there are reference recordings.
const RECORDED: [&str; 5] = [
    "paper",
    "paper-precession-term-only",
    "paper-spin-term-only",
    "full-coulomb",
    "frictionless",
];

fn digest_of(preset: &Preset) -> (u64, RunEnd, String) {
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
    (messages, simulation.end(), digest.finish())
}

#[test]
fn regress_content_digests() {
    let mut found = String::new();
    for preset in PRESETS.iter() {
        let (messages, end, digest) = digest_of(preset);
        let steps = end.statistics.accepted;
        found.push_str(&format!(
            "    (\"{}\", {messages}, {steps}, \"{digest}\"),\n",
            preset.name
        ));
    }
    let expected = GOLDEN.iter().map(|(name, messages, steps, digest)| {
        format!("    (\"{name}\", {messages}, {steps}, \"{digest}\"),\n")
    });
    assert!(
        found == expected.collect::<Vec<_>>().concat(),
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
        let report = verified(&path);
        assert_eq!(report.verdict, Verdict::Verified, "{report:#?}");
        let digest = &recording.end().unwrap()["content_digest"];
        assert!(
            readme.contains(digest),
            "recordings/README.md lacks the digest of {name}"
        );
    }
    assert_eq!(fs::read_dir(&directory).unwrap().count(), RECORDED.len());
}

//! `regress_*`: the bits of the presets' runs, the same on every machine and in every build.
//!
//! A change here is a change of physics or numerics: it needs a reason in the changelog, and new
//! reference recordings.

use std::fs;
use std::path::Path;
use toprise::analysis::verify::{Options, Verdict, verify};
use toprise::archive::recording::Recording;
use toprise::run::scenario::{PRESETS, Preset};
use toprise::run::simulation::{RunEnd, Simulation};
use toprise::telemetry::digest::ContentDigest;
use toprise::telemetry::{Telemetry, TelemetryError};

/// Preset, messages, steps, content digest at its own sample period with all topics.
#[rustfmt::skip]
const GOLDEN: &[(&str, u64, u64, &str)] = &[
    ("paper", 198977, 10642, "48c0a0e4ccca0abb11634023936bebb4668e7e652320fb56dac9e06aef663310"),
    ("paper-precession-term-only", 578479, 188008, "c5f1f572a3e2744e4273f760aa08e1a34bfc4a10f5be4cc20f9ad1e1d8d2d71d"),
    ("paper-spin-term-only", 245109, 4609, "9993efa82836594973e71df9d13410706f7e47b14d22a43117c67d1697e9def8"),
    ("full-coulomb", 198378, 10125, "d969a74c70f16df87aa732ba4076b42b23d1a4c15976ee3460139b001d9e6ed6"),
    ("frictionless", 161372, 6456, "d6aad3658a47e487eb4024611ab70229a8d0236cb5729f6e16e6513d8feb0e9b"),
    ("nutation-free", 198413, 4771, "5aa6ec668904d99a6ffaf7b98ebdfff6638e23c2b9e19ced0263deb9758ec531"),
    ("tilt-torque-only", 217112, 12759, "2410f31a90455634046f1973485d822f67bfdec393f15b90cc6cd93fe1b7ebd2"),
    ("spin-torque-only", 770842, 16556, "bc706fc6cecf0bdf4b214b74cb2a0d4dcfd758d45c23c6a187a02e11c858f5c4"),
    ("rise-by-loss-of-spin", 218490, 6423, "df5f86d2583e88cd8909d282a5ea7e1982b9cce811e880513541a6ae30229533"),
    ("viscous", 597437, 32975, "e1bbea8310a26722e5e3cb6169b7886c01616eca9c75bb7c9e45430eb14ccb6d"),
    ("stribeck", 177608, 9251, "65c0281beded40eea059c18a59ffd49bcf3016c3624359ea5aded20fa991a73d"),
    ("contensou", 219842, 11234, "5d2689e13b51267077d2cba611e2af2258dc1f38bf29bb1add878dfd052feeb7"),
    ("lifecycle", 624364, 14266, "8ff580691e4e2f7c9034b4d84d6f04c613fc3d703efd94d90884f8fc6eb15c53"),
    ("free-paper", 101741, 9896, "3e6ee7df76a761053090ed1313f84d5529345eb70f7b28560c054e8352326136"),
    ("free-rolls", 254406, 22035, "551e746271d2ba16178c621c1504e88b25f8241be40483b6ac8eb551e0b188ca"),
    ("free-viscous", 220614, 14207, "3e90b42a931147e28e1fad0e5853536e1926115c37eeeaf6c258cf2547edd16c"),
    ("drop", 20242, 1508, "f74543ac6483eed6fc9087d0a3617d31df3f3b7bf87bf01ee9ebeb39d48c0ffd"),
    ("tippe-top", 118661, 3894, "9da2de27c06b6fa5ca58581da42cc51f056fd614e18ce79728362e64937c7915"),
    ("tippe-top-hangs", 49391, 3033, "e056e57aa9f9a8e33be6c0b2c52cb588310c562c98be5398742142490d38ae9d"),
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
    for preset in PRESETS {
        let (messages, end, digest) = digest_of(preset);
        let steps = end.statistics.accepted;
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

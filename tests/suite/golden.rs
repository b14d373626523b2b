//! `regress_*`: the bits of the presets' runs, the same on every machine and in every build.
//!
//! A change here is a change of physics or numerics: it needs a reason in the changelog.

use crate::formula::{GOLDEN_FORMULAS, with_parameters};
use toprise::run::scenario::{PRESETS, Scenario};
use toprise::run::simulation::{RunEnd, Simulation};
use toprise::telemetry::digest::ContentDigest;
use toprise::telemetry::{Telemetry, TelemetryError};

/// Preset, messages, steps, content digest at its own sample period with all topics.
#[rustfmt::skip]
const GOLDEN: &[(&str, u64, u64, &str)] = &[
    ("paper", 198977, 10642, "f4322b4f6de89a0c81dbb906e8ac572e8a2783bb6fed733ae588d7a5ad7cb86e"),
    ("paper-precession-term-only", 578479, 188008, "131af93c19da830b5e1b6e945614d36ab1772b6fbe9404c0f316630089893bb9"),
    ("paper-spin-term-only", 245109, 4609, "0bd724f2d7b0e782cb696ab2e588bf1c8c8adbba16ed0bf3a74f908847c7ed92"),
    ("full-coulomb", 198378, 10125, "f5ff7ce2655c7f0cf4456242348e26fd57e9a1b237f412e7bcd2ddc59f8963d7"),
    ("frictionless", 161372, 6456, "2431d70864d2d59fb7b50ac7d605ecf36ba763da77308e028fa6f941be01754d"),
    ("nutation-free", 198413, 4771, "cfc17b80b61c87af286ed1b4a176a4a3b5a74c22832459922a16945d6011df75"),
    ("tilt-torque-only", 217112, 12759, "e2ca54695f864e0c8657d05e1d36bf663cf2800252ea213750878a6dee4149ef"),
    ("spin-torque-only", 770842, 16556, "4202b18d5bc9da93db1fd2fba65b51caeec1ad020a9b99629e8243e4a363e085"),
    ("rise-by-loss-of-spin", 218490, 6423, "ba0dc6ddf665e8d0fdf713409908f848325e2cf57d2bfea340fe0881bfb2977b"),
    ("viscous", 597437, 32975, "35ee972b5d763ac60a1904982b5745b91b8088e64e78e24eaa88372945940f74"),
    ("stribeck", 177608, 9251, "17dd1e654da988008257b1828800ed5fbb79de77d19e1bf39395e6b10bc81183"),
    ("contensou", 219842, 11234, "7564dc753c26b7cda2544fc5d19b2339029a11ccc870acb0d6b3b28173fdc40f"),
    ("lifecycle", 624364, 14266, "69a3b0a655eec641b7dbeb054d339abc87dc6285b06e34120b5d28ac46dd18d1"),
    ("free-paper", 101741, 9896, "35fbd80afbae89e795b10617fe9b4544c42416f09353a7a2ff4547980b2ce40c"),
    ("free-rolls", 254406, 22035, "fd6e29812c9660f642865f4b9c93540d01ed9d98157c14ce977ee00351d3860f"),
    ("free-viscous", 220614, 14207, "af8ddb091f7311dcff15720f2d92a8a7ea286e9f17dad26e69a1ff8b566437dc"),
    ("drop", 20239, 1508, "dd3117f9aaf29091e7f4feed2c29e5b9bc3441a894296d725b17a5fb325ce77e"),
    ("tippe-top", 118662, 3894, "75af1bad4e6b7fc690b9238192a6b10c4a9bc8218c25b9c995297e810d313a76"),
    ("tippe-top-hangs", 49391, 3033, "4c647ed876bb769284c27aa32c7b1e859f7f68c3e095629d61511ca5e71b5e79"),
];

/// Content digests of half a second of the paper's top under the formulas of the tests, on a fixed and on a free peg.
const FORMULAS: [[&str; 2]; 5] = [
    [
        "48ce13222cf843300df23a950f86765622d22ef082a1d9bcf35e6019e46960c5",
        "3a74ee98ad5e8e916259539cd9eeb70bb128c607642fc4f612d5d50f8422c888",
    ],
    [
        "6e5ff63b4fcb039f3020dc88c04541f211f74b0f9ef13c256a5e0d8dc3d9d667",
        "8581cd706ab9a38f3736e7b4cf4effe9f87daa2284c612655721c6736a4a9158",
    ],
    [
        "cda28ede2c01a41225f16e6fbf440fa6c698bc553f1f0e202da511592f2bc6b5",
        "d34b3927d1a62186511a5febac985689483cef463547650ec394a7615aa3c9ce",
    ],
    [
        "2fbdf96c92948f901313048bb356e0e5734bd7e3d182cf78e798efc4f02bc50e",
        "e4579727f46cde29c9ee3230b1da1b9fc6283a73e0415ca2c0653d0615d4da4d",
    ],
    [
        "4729f4af58497fb4e0a086ada243e494024d45dfafa0916af58c6be414cbadec",
        "bfd5344a7db200e9a05660ba0177968aa45d3b31858bde5bc6e65f2590fddb26",
    ],
];

fn digest_of(scenario: &Scenario) -> (u64, RunEnd, String) {
    let mut simulation = Simulation::new(scenario).unwrap();
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
        let (messages, end, digest) = digest_of(&preset.scenario().unwrap());
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
fn regress_content_digests_of_formulas() {
    let found = GOLDEN_FORMULAS.map(|formula| {
        ["paper", "free-paper"].map(|preset| digest_of(&with_parameters(preset, formula)).2)
    });
    assert!(
        found == FORMULAS,
        "the runs have changed; they are now\n{found:#?}"
    );
}

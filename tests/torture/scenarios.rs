//! Random tops and tasks: what is simulated is recorded, and verifies.

use crate::bench::{Random, Trial};
use crate::material::failure;
use tempfile::tempdir;
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::Existing;
use toprise::archive::recording::Recording;
use toprise::archive::sink::record_all;
use toprise::archive::verify::verify;
use toprise::archive::writer::Form;
use toprise::run::scenario::{PRESETS, Preset, Scenario};
use toprise::telemetry::{RunMessages, Topics};

/// Records a random scenario and verifies the recording: it must not fail.
pub fn scenarios() -> Result<Trial, String> {
    Ok(Box::new(|random| {
        let Some((scenario, keys)) = random_scenario(random) else {
            return Ok(()); // No rigid body, or out of range: refused with an error.
        };
        let directory = tempdir().unwrap();
        let path = directory.path().join("x.mcap");
        let Ok(mut run) = RunMessages::new(&scenario, &Topics::All) else {
            return Ok(());
        };
        let (telemetry, form) = (run.telemetry(), Form::default());
        let mut sink = McapSink::create(&path, Existing::Keep, &scenario, telemetry, form)
            .map_err(|error| error.to_string())?;
        // A motion that can't be computed to its end is recorded as failed.
        let recorded = record_all(&mut run, &mut [&mut sink]).map_err(|error| error.to_string())?;
        sink.finish(&recorded.outcome.end)
            .map_err(|error| error.to_string())?;
        let recording = Recording::open(&path).map_err(|error| error.to_string())?;
        let report = verify(&recording, &|_| {}).map_err(|error| error.to_string())?;
        match failure(&report) {
            None => Ok(()),
            Some(failure) => Err(format!("{keys:?}: {failure}")),
        }
    }))
}

/// A preset with some keys far from what they are, and the keys; none if that is no scenario.
fn random_scenario(random: &mut Random) -> Option<(Scenario, Vec<(String, String)>)> {
    const KEYS: [(&str, f64, f64); 19] = [
        ("gravity", 0.1, 100.0),
        ("top.mass", 1e-3, 10.0),
        ("top.transverse_moment", 1e-6, 1.0),
        ("top.axial_moment", 1e-7, 1.0),
        ("top.center_distance", 1e-3, 0.3),
        ("top.peg_radius", 1e-4, 0.05),
        ("initial.theta", 1e-3, 1.5),
        ("initial.phi_dot", 1e-2, 100.0),
        ("initial.theta_dot", 1e-3, 10.0),
        ("initial.psi_dot", 1.0, 1e4),
        ("friction.k", 1e-4, 1.0),
        ("air.transverse", 1e-9, 1e-2),
        ("air.axial", 1e-9, 1e-2),
        ("air.disc", 1e-9, 1e-2),
        ("rolling.arm", 1e-6, 1e-3),
        // What follows is refused where the peg is fixed.
        ("support.restitution", 1e-3, 1.0),
        ("initial.height", 1e-6, 0.1),
        ("initial.peg_x_dot", 1e-3, 1.0),
        ("initial.peg_z_dot", 1e-3, 1.0),
    ];
    let preset = &*random.one_of(&PRESETS).name;
    let mut values = Preset::find(preset).ok()?.values().ok()?;
    let mut keys = vec![(preset.to_owned(), String::new())];
    let mut set = |key: &str, value: String| {
        keys.push((key.to_owned(), value.clone()));
        values.set(key, &value).is_ok()
    };
    for _ in 0..=random.below(4) {
        let (key, low, high) = *random.one_of(&KEYS);
        if !set(key, format!("{:?}", random.about(low, high))) {
            return None;
        }
    }
    if random.below(2) == 0 {
        set(
            "formulation",
            (*random.one_of(&["euler", "body"])).to_owned(),
        );
    }
    let duration = random.about(0.01, 0.5);
    set("stop.duration", format!("{duration:?}"));
    set(
        "sampling.period",
        format!("{:?}", (duration / 50.0 * 1e6).ceil() / 1e6),
    );
    Some((Scenario::new(values).ok()?, keys))
}

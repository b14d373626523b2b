//! Metadata of a run, needed before its messages.

pub(super) mod magnitude;

use self::magnitude::Magnitudes;
use super::measurement::Measurement;
use super::output::message::store;
use crate::physics::kinematics::Tilt;
use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::telemetry::Topic;
use crate::telemetry::arrows::Scales;
use crate::telemetry::proportions::Proportions;
use rerun::StoreId;
use rerun::external::re_log_types::{ApplicationId, StoreKind};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The top, and the sizes that arrows are drawn to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// The top, whose mechanics give its proportions.
    pub top: Top,
    /// Quantity per metre of each arrow.
    pub scales: Scales,
    /// Angular speed at the start, rad/s.
    pub spin: f64,
    /// Whether the peg is free to travel, and to leave the table.
    pub is_free: bool,
    /// Time for which the path of the symmetry axis stays bright: about a turn of the precession, s.
    pub trail_time: f64,
}

/// Playback of a recording in a viewer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Playback {
    /// From the start, for a recording that is complete.
    FromStart,
    /// At the newest sample, for a paced run.
    Following,
}

/// The names of the store that a viewer keeps a recording in, where the viewer has chosen them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct StoreNames {
    /// The application, which has one layout.
    pub application: Option<String>,
    /// The recording.
    pub recording: Option<String>,
}

impl StoreNames {
    /// The store, given names for what the viewer has not chosen.
    pub(super) fn store(&self, name: &str, recording_id: &str) -> StoreId {
        let recording_id = self.recording.as_deref().unwrap_or(recording_id);
        match &self.application {
            Some(application) => {
                let application = ApplicationId::new_or_unknown(application.as_str());
                StoreId::new(StoreKind::Recording, application, recording_id)
            }
            None => store(name, recording_id),
        }
    }
}

/// Names, geometry and topics of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Names that replace those that follow from the name and the scenario.
    pub names: StoreNames,
    /// Identifier: a viewer merges recordings that have the same.
    pub recording_id: String,
    /// The name of the run.
    pub name: String,
    /// The name that a viewer shows.
    pub shown_name: String,
    /// The scenario with its changes, the support and the law of friction: the title of the scene.
    pub title: String,
    /// Description of the run, in Markdown.
    pub description: String,
    /// The top, and the sizes that arrows are drawn to.
    pub geometry: Geometry,
    /// Typical magnitudes of the run's quantities.
    pub magnitudes: Magnitudes,
    /// Topics that will be written; the layout leaves out the plots of others.
    pub topics: Vec<Topic>,
    /// The playback in a viewer.
    pub playback: Playback,
    /// The data of a fit, of which the run is the result.
    pub measurement: Option<Arc<Measurement>>,
}

impl Identity {
    /// The identity of a run or a recording that is called `name`.
    ///
    /// The identifier depends on the name: two runs of one scenario are two recordings to a viewer, as they are two
    /// files.
    pub fn new(name: &str, scenario: &Scenario, topics: Vec<Topic>, playback: Playback) -> Self {
        let model = &scenario.model;
        let is_free = model.support.is_free();
        let peg = if is_free { "free" } else { "fixed" };
        let law = scenario.word("friction.law");
        let tilt = Tilt::from_rates(scenario.angles.theta, scenario.rates);
        Self {
            names: StoreNames::default(),
            recording_id: format!("{name}-{:.16}", scenario.digest()),
            name: name.to_owned(),
            shown_name: shown_name(name, scenario),
            title: format!("{} · {peg} peg · friction: {law}", scenario.title()),
            description: format!(
                "# {}\n\n{}\n\n```toml\n{}```\n",
                scenario.title(),
                scenario.valid_description().unwrap_or_default(),
                scenario.to_toml()
            ),
            geometry: Geometry {
                top: model.top,
                scales: Scales::new(scenario),
                spin: tilt.omega_lean.norm(),
                is_free,
                trail_time: trail_time(&model.top, &tilt, scenario.rates.phi),
            },
            magnitudes: Magnitudes::new(scenario),
            topics,
            playback,
            measurement: None,
        }
    }

    /// The identity of the best fit of measured values. Its parameters are in the report, and the title has none.
    pub fn for_fit(
        name: &str,
        scenario: &Scenario,
        topics: Vec<Topic>,
        measurement: Measurement,
    ) -> Self {
        let law = scenario.word("friction.law");
        Self {
            title: format!("{}, best fit · friction: {law}", scenario.name()),
            measurement: Some(Arc::new(measurement)),
            ..Self::new(name, scenario, topics, Playback::FromStart)
        }
    }

    /// The store that a viewer keeps the recording in.
    pub(super) fn store(&self) -> StoreId {
        self.names.store(&self.name, &self.recording_id)
    }

    /// Whether messages of this topic will be written.
    pub(super) fn has(&self, topic: Topic) -> bool {
        self.topics.contains(&topic)
    }
}

/// The name of a recording in a viewer: for a file that is named after the keys that were changed, these keys.
fn shown_name(name: &str, scenario: &Scenario) -> String {
    if name.starts_with(&format!("{}_", scenario.name())) {
        scenario.title()
    } else {
        name.to_owned()
    }
}

/// Least and greatest time for which the path of the symmetry axis stays bright, s.
const TRAIL_TIMES: [f64; 2] = [0.4, 5.0];

/// The period of the precession at the start, as far as it makes a useful length of the path of the symmetry axis, s.
fn trail_time(top: &Top, tilt: &Tilt, phi_dot: f64) -> f64 {
    let [shortest, longest] = TRAIL_TIMES;
    // The axis of a tippe top goes around ever faster as it inverts, up to the rate of the spin.
    if Proportions::new(top).is_ball {
        return shortest;
    }
    let spin = top.axial_moment * tilt.omega_lean.dot(&tilt.axis()).abs();
    // The slow rate of regular precession of a fast top, M g l/L_n.
    let slow = top.gravity_moment().abs() / spin;
    let rate = slow.max(phi_dot.abs());
    // `max` and `min` also replace the NaN of a top without spin and weight.
    (TAU / rate).max(shortest).min(longest)
}

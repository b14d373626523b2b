//! What a recording of one run says about itself.

use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::telemetry::Topic;

/// Dimensions of the top and scales of the arrows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// The top.
    pub top: Top,
    /// A typical friction force (k times the normal force) in N; 0 without friction.
    pub force_scale: f64,
    /// A typical torque of friction, in N m; 0 without friction.
    pub torque_scale: f64,
    /// A typical slip speed, as at the start, in m/s.
    pub slip_scale: f64,
}

/// What a viewer does when it has opened a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Playback {
    /// Wait at the start, for a recording that is there as a whole.
    PausedAtStart,
    /// Follow the newest sample, for a paced run.
    Following,
}

/// What a recording says about itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Recordings with the same identifier are one recording to a viewer.
    pub recording_id: String,
    /// The name that a viewer shows.
    pub name: String,
    /// About the run, in Markdown.
    pub description: String,
    /// The top.
    pub geometry: Geometry,
    /// The topics that will be written; the layout leaves out the plots of others.
    pub topics: Vec<String>,
    /// What a viewer does at first.
    pub playback: Playback,
    /// Whether it is not shown together with other recordings.
    pub is_alone: bool,
}

impl Identity {
    /// The identity of a run or a recording that is called `name`.
    ///
    /// Two runs of one scenario are two recordings to a viewer, as they are two files.
    #[must_use]
    pub fn of(name: &str, scenario: &Scenario, topics: Vec<String>, playback: Playback) -> Self {
        let model = &scenario.model;
        Self {
            recording_id: format!("{name}-{:.16}", scenario.digest()),
            name: name.to_owned(),
            description: format!(
                "# {}\n\n{}\n\n```toml\n{}```\n",
                scenario.name(),
                scenario.description(),
                scenario.to_toml()
            ),
            geometry: Geometry {
                top: model.top,
                force_scale: scenario.force_scale(),
                torque_scale: scenario.torque_scale(),
                slip_scale: scenario.slip_speed_at_start(),
            },
            topics,
            playback,
            is_alone: true,
        }
    }

    /// Whether messages of this topic will be written.
    pub(super) fn has(&self, topic: Topic) -> bool {
        self.topics.iter().any(|known| known == topic.name())
    }
}

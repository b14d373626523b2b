//! The report of a run.

use crate::analysis::explain::ENERGY_ZERO;
use crate::analysis::losses::Losses;
use crate::cli::report::WrittenFile;
use crate::physics::dynamics::Model;
use crate::physics::friction::Friction;
use crate::physics::top::Top;
use crate::run::outcome::Outcome;
use crate::run::scenario::{Scenario, Value, Values};
use crate::run::simulation::{EventCount, EventKind};
use crate::run::time::seconds;
use crate::words::number::{fixed, rounded, significant};
use crate::words::{Section, Table, Tone, counted, grouped};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Duration;

/// Wall-to-simulated time ratios above this are not shown (the simulated time is almost zero).
const MAX_RATIO: f64 = 1e4;

/// The recordings of a run.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub(super) struct Recorded {
    /// The MCAP file.
    pub(super) mcap: WrittenFile,
    /// Whether the file is new; otherwise an identical file already existed.
    pub(super) is_new: bool,
    /// The Rerun recording; absent if there is none.
    pub(super) rrd: Option<WrittenFile>,
    /// Whether writing it failed.
    #[serde(skip)]
    pub(super) is_rrd_lost: bool,
    /// Whether a viewer went away before it had everything.
    #[serde(skip)]
    pub(super) is_viewer_lost: bool,
    /// SHA-256 of the recording's content.
    pub(super) content_digest: String,
}

/// Outcome of a run, and its recordings.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct RunReport {
    /// The name of the scenario.
    scenario: String,
    /// Keys that differ from the preset of the same name, or from the scenario file, with their values; empty for a
    /// removed key.
    changes: BTreeMap<&'static str, String>,
    /// SHA-256 of the scenario.
    scenario_digest: String,
    /// Outcome of the run.
    pub(super) outcome: Outcome,
    /// Angle of precession at the end, rad.
    phi: f64,
    /// Angle of spin at the end, rad.
    psi: f64,
    /// Number of samples.
    samples: u64,
    /// Time from one sample to the next, s.
    sample_period: f64,
    /// Number of events of each kind, in the order of their first times.
    events: Vec<EventCount>,
    /// Number of rejected integrator steps.
    steps_rejected: u64,
    /// Evaluations of the equations of motion.
    evaluations: u64,
    /// Wall time, s.
    wall_time: f64,
    #[serde(flatten)]
    pub(super) recorded: Recorded,
}

impl RunReport {
    pub(super) fn new(
        scenario: &Scenario,
        base: &Values,
        outcome: Outcome,
        recorded: Recorded,
        wall: Duration,
    ) -> Self {
        let end = &outcome.end;
        let mut changes = BTreeMap::new();
        for (key, value) in scenario.changes(base) {
            let text = value.map_or_else(String::new, Value::to_set_notation);
            changes.insert(key.path, text);
        }
        Self {
            scenario: scenario.name().to_owned(),
            changes,
            scenario_digest: scenario.digest(),
            phi: end.motion.angles.phi,
            psi: end.motion.angles.psi,
            samples: end.samples,
            sample_period: seconds(scenario.sample_period_ns),
            events: outcome.tally.counts().to_vec(),
            steps_rejected: end.statistics.rejected,
            evaluations: end.statistics.evaluations,
            wall_time: wall.as_secs_f64(),
            outcome,
            recorded,
        }
    }

    /// The human-readable summary of a run, with a note on files not written.
    pub(super) fn page(
        &self,
        name: &str,
        model: &Model,
        not_written: Option<&str>,
    ) -> Vec<Section> {
        let mut facts = vec![("state", self.angles()), ("rates", self.rates())];
        facts.extend(under("energy", self.energy_balance(&model.friction)));
        facts.extend(under("events", self.event_lines(&model.top)));
        facts.extend([("logged", self.logged()), ("took", self.took())]);
        let recorded = &self.recorded;
        let mut lines = vec![recorded.mcap.line()];
        lines.extend(recorded.rrd.as_ref().map(WrittenFile::line));
        lines.extend(not_written.map(str::to_owned));
        let label = if recorded.is_new { "wrote" } else { "existing" };
        facts.extend(under(label, lines));
        if !recorded.is_new {
            let path = &recorded.mcap.path;
            facts.push(("", format!("{path} already exists with identical content")));
        }
        facts.push(("content", format!("sha-256 {}", recorded.content_digest)));
        if let Some(rrd) = &recorded.rrd {
            let install = "(install the viewer: pip install rerun-sdk==0.36.3)";
            facts.push(("view", format!("rerun {}", rrd.path)));
            facts.push(("", install.to_owned()));
        }
        let tone = if self.outcome.end.stop.is_complete() {
            Tone::Good
        } else {
            Tone::Weak
        };
        let title = format!("{name}: {}", self.outcome.sentence());
        vec![
            Section::with_tone(tone, title),
            Section::from(Table::from_facts(facts)),
        ]
    }

    fn angles(&self) -> String {
        let theta = fixed(self.outcome.end.motion.angles.theta, 4);
        // At the vertical the azimuth of the axis is undefined, and jumps by half a turn.
        if self.outcome.tally.count_of(EventKind::UprightPassage) > 0 {
            return format!("θ = {theta} rad");
        }
        format!(
            "θ = {theta} rad after {} turns of precession",
            fixed(self.outcome.turns, 2)
        )
    }

    fn rates(&self) -> String {
        let rates = &self.outcome.end.motion.tilt.rates;
        format!(
            "φ̇ = {} rad/s, θ̇ = {} rad/s, ψ̇ = {} rad/s",
            fixed(rates.phi, 4),
            fixed(rates.theta, 5),
            fixed(rates.psi, 3)
        )
    }

    fn energy_balance(&self, friction: &Friction) -> Vec<String> {
        let end = &self.outcome.end;
        // Small tops have energies of which six decimals show nothing.
        let is_small = end.energy_at_start.abs() < 1e-3;
        let [before, after, change, work] = [
            end.energy_at_start,
            end.energy,
            end.energy - end.energy_at_start,
            end.motion.integrals.friction_work,
        ]
        .map(|energy| {
            if is_small {
                significant(energy, 4)
            } else {
                fixed(energy, 6)
            }
        });
        let causes = Losses::new(friction).list(end.impacts > 0);
        vec![
            format!("{before} J → {after} J ({ENERGY_ZERO})"),
            format!("change {change} J, work of {causes} {work} J"),
        ]
    }

    /// One line for each kind of event except nutation extremes; repeated events are counted, and their ends omitted.
    fn event_lines(&self, top: &Top) -> Vec<String> {
        let mut lines = Vec::new();
        for event in &self.events {
            // Events at the start describe the scenario.
            if event.first_time <= 0.0 || event.name.is_nutation_extreme() {
                continue;
            }
            match (event.count, event.name.plural(top)) {
                (1, _) => {
                    lines.push(format!(
                        "{} at {:.4} s",
                        event.name.words(1),
                        event.first_time
                    ));
                }
                (several, Some(plural)) => lines.push(format!(
                    "{} {plural} between {:.4} s and {:.4} s",
                    grouped(several),
                    event.first_time,
                    event.last_time
                )),
                (_, None) => {}
            }
        }
        lines
    }

    fn logged(&self) -> String {
        format!(
            "{} at {} Hz, {}, {}",
            counted(self.samples, "sample"),
            rounded(1.0 / self.sample_period, 6),
            counted(self.outcome.end.nutations, "nutation cycle"),
            self.logged_events()
        )
    }

    /// Number of events, and how many of them no line lists.
    fn logged_events(&self) -> String {
        let (mut all, mut extremes) = (0, 0);
        for event in &self.events {
            all += event.count;
            if event.name.is_nutation_extreme() {
                extremes += event.count;
            }
        }
        let events = counted(all, "event");
        match extremes {
            0 => events,
            _ => format!("{events} ({} extremes of θ)", grouped(extremes)),
        }
    }

    fn took(&self) -> String {
        let ratio = self.wall_time / self.outcome.end.time;
        let share = if ratio < MAX_RATIO {
            format!(" ({ratio:.3} × simulated time)")
        } else {
            String::new()
        };
        let steps = counted(self.outcome.end.statistics.accepted, "integration step");
        format!("{:.2} s{share}; {steps}", self.wall_time)
    }
}

/// Lines, the first with a label.
fn under(label: &'static str, lines: Vec<String>) -> impl Iterator<Item = (&'static str, String)> {
    let labels = std::iter::once(label).chain(std::iter::repeat(""));
    labels.zip(lines)
}

#[cfg(test)]
mod tests {
    use crate::run::simulation::{EventKind, StopReason};

    /// Programs read the names that recordings have.
    #[test]
    fn serializes_names_of_recordings() {
        for kind in [
            EventKind::Start,
            EventKind::NutationMaximum,
            EventKind::WeakTop,
        ] {
            assert_eq!(serde_json::to_value(kind).unwrap(), kind.name());
        }
        for stop in [
            StopReason::Risen,
            StopReason::SlipStopped,
            StopReason::Failed,
        ] {
            assert_eq!(serde_json::to_value(stop).unwrap(), stop.name());
        }
    }
}

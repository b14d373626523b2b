//! What a run says at its end.

use super::super::format;
use super::{Duration, EventCounts, Written};
use crate::run::scenario::Scenario;
use crate::run::simulation::Outcome;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;

/// The facts of a finished run.
pub(super) struct Summary<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) outcome: &'a Outcome,
    pub(super) counts: &'a EventCounts,
    pub(super) written: &'a Written,
    pub(super) same_as: Option<&'a Path>,
    pub(super) wall: Duration,
}

impl Summary<'_> {
    /// For people.
    pub(super) fn text(&self) -> String {
        let mut text = format!(
            "{}: {} at t = {} s\n\n",
            self.scenario.name(),
            self.outcome.stop.sentence(),
            format::number(self.outcome.time, 6)
        );
        let mut line = |label: &str, value: &str| {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "  {label:<8} {value}");
        };
        line("state", &self.state());
        line("rates", &self.rates());
        line("energy", &self.energy());
        line("events", &self.events());
        line("logged", &self.logged());
        line("took", &self.took());
        let archive = &self.written.archive;
        line("wrote", &file_line(&archive.path, archive.bytes));
        if let Some((path, bytes)) = &self.written.rrd {
            line("", &file_line(path, *bytes));
        }
        line("content", &format!("sha-256 {}", archive.digest));
        if let Some(path) = self.same_as {
            line("", &format!("identical to {}", path.display()));
        }
        if let Some((path, _)) = &self.written.rrd {
            line("open it", &format!("rerun {}", path.display()));
            line("", "(the viewer: pip install rerun-sdk==0.36.3)");
        }
        text
    }

    /// For programs.
    pub(super) fn json(&self) -> Value {
        let outcome = self.outcome;
        let angles = &outcome.motion.angles;
        let rates = &outcome.motion.tilt.rates;
        let archive = &self.written.archive;
        let counts = self.counts.0.iter();
        json!({
            "scenario": self.scenario.name(),
            "scenario_digest": self.scenario.digest(),
            "stop_reason": outcome.stop.name(),
            "stop_time": outcome.time,
            "state": {
                "phi": angles.phi, "theta": angles.theta, "psi": angles.psi,
                "phi_dot": rates.phi, "theta_dot": rates.theta, "psi_dot": rates.psi,
            },
            "energy_at_start": outcome.energy_at_start,
            "energy": outcome.energy,
            "friction_work": outcome.motion.integrals.friction_work,
            "slip_path": outcome.motion.integrals.slip_path,
            "samples": outcome.samples,
            "nutations": outcome.nutations,
            "events": counts.map(|(kind, count, first)| json!({
                "name": kind.name(), "count": count, "first_time": first,
            })).collect::<Vec<_>>(),
            "steps_accepted": outcome.statistics.accepted,
            "steps_rejected": outcome.statistics.rejected,
            "evaluations": outcome.statistics.evaluations,
            "wall_time": self.wall.as_secs_f64(),
            "mcap": { "path": archive.path.display().to_string(), "bytes": archive.bytes },
            "rrd": self.written.rrd.as_ref().map(|(path, bytes)| json!({
                "path": path.display().to_string(), "bytes": bytes,
            })),
            "content_digest": archive.digest,
            "identical_to": self.same_as.map(|path| path.display().to_string()),
        })
    }

    fn state(&self) -> String {
        let angles = &self.outcome.motion.angles;
        let turns = angles.phi / std::f64::consts::TAU;
        format!(
            "θ = {} rad after {} turns of precession",
            format::number(angles.theta, 4),
            format::number(turns, 2)
        )
    }

    fn rates(&self) -> String {
        let rates = &self.outcome.motion.tilt.rates;
        format!(
            "φ̇ = {}, θ̇ = {}, ψ̇ = {} rad/s",
            format::number(rates.phi, 4),
            format::number(rates.theta, 5),
            format::number(rates.psi, 3)
        )
    }

    fn energy(&self) -> String {
        let Outcome {
            energy,
            energy_at_start,
            ..
        } = *self.outcome;
        let change = energy - energy_at_start;
        format!(
            "{} J → {} J ({} J, friction did {} J)",
            format::number(energy_at_start, 6),
            format::number(energy, 6),
            format::number(change, 6),
            format::number(self.outcome.motion.integrals.friction_work, 6)
        )
    }

    /// Each kind with its number, or its time if it happened once.
    fn events(&self) -> String {
        let counts = self.counts.0.iter().filter(|(.., first)| *first > 0.0);
        let part = |(kind, count, first): &(crate::run::simulation::EventKind, u64, f64)| {
            let name = kind.name().replace('_', " ");
            match count {
                1 => format!("{name} at {first:.4} s"),
                _ => format!("{} × {name} from {first:.4} s", format::count(*count)),
            }
        };
        let parts: Vec<_> = counts.map(part).collect();
        if parts.is_empty() {
            "none".to_owned()
        } else {
            parts.join("\n           ")
        }
    }

    fn logged(&self) -> String {
        let rate = 1e9 / self.scenario.sample_period_ns as f64;
        format!(
            "{} samples at {rate} Hz, {} nutation cycles, {} events",
            format::count(self.outcome.samples),
            format::count(self.outcome.nutations),
            format::count(self.outcome.events)
        )
    }

    fn took(&self) -> String {
        let wall = self.wall.as_secs_f64();
        format!(
            "{wall:.2} s, {:.3} of the simulated time; {} integration steps",
            wall / self.outcome.time.max(f64::MIN_POSITIVE),
            format::count(self.outcome.statistics.accepted)
        )
    }
}

fn file_line(path: &Path, bytes: u64) -> String {
    format!("{}  {}", path.display(), format::bytes(bytes))
}

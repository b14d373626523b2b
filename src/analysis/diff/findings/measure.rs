//! Numbers of other runs for the quantities of findings, whose levels and times stay as they are.

use super::events::{count_hops, count_loops, final_roll, first_roll, first_time};
use super::inversion_time;
use super::quantity::Quantity;
use crate::analysis::diff::topic::derived::axial_spin;
use crate::analysis::history::{Cycle, RunHistory};
use crate::analysis::subject::Subject;
use crate::run::scenario::Scenario;
use crate::run::simulation::EventKind;
use crate::run::time::nanoseconds;
use crate::telemetry::fields::{ENERGY, STATE, energy};
use crate::telemetry::{Message, Topics};

/// Simulates a scenario, and returns its number of each quantity; `None` if it has none.
pub(in crate::analysis::diff) fn measure(
    scenario: &Scenario,
    quantities: &[Quantity],
) -> Vec<Option<f64>> {
    let mut history = RunHistory::new(Some(scenario));
    let mut sampled = vec![None; quantities.len()];
    let ended = Subject::Scenario(scenario).read(&Topics::All, &mut |message, _| {
        history.take(message);
        for (number, quantity) in sampled.iter_mut().zip(quantities) {
            *number = number.or_else(|| quantity.of_sample(message));
        }
        true
    });
    history.finish(ended.end, ended.missing);
    let mut numbers = Vec::new();
    for (quantity, sampled) in quantities.iter().zip(sampled) {
        numbers.push(quantity.of_run(&history, sampled));
    }
    numbers
}

impl Quantity {
    /// The number that a message has, if the quantity is one of samples at this time.
    fn of_sample(self, message: &Message<'_>) -> Option<f64> {
        let (topic, at, number): (_, _, fn(&Message<'_>) -> f64) = match self {
            Self::AxialSpin { at } => (STATE, at, axial_spin),
            Self::EnergyLost { until } => (ENERGY, until, |message| energy::TOTAL.of(message)),
            _ => return None,
        };
        let is_it = message.topic() == topic && message.time_ns == nanoseconds(at);
        is_it.then(|| number(message))
    }

    /// The number of a run; `sampled` is that of its samples.
    fn of_run(self, run: &RunHistory, sampled: Option<f64>) -> Option<f64> {
        let mean = |time: f64, quantity: fn(&Cycle) -> f64| run.curve(quantity).at(time);
        match self {
            Self::End { ends: [a, b] } => {
                let is_one = a == b && a.is_some_and(|end| Some(end.reason) == run.stop_reason());
                run.stop_time().filter(|_| is_one)
            }
            Self::MeanCrossing { level, .. } => {
                run.curve(|cycle| cycle.means[0]).first_reaches(level)
            }
            Self::FirstReach { .. } => run.rise_time(),
            Self::Inversion => inversion_time(run),
            Self::FirstLoop => first_time(run, EventKind::LoopingBegins),
            Self::FirstEvent { event } => first_time(run, event),
            Self::FirstRoll => first_roll(run),
            Self::Loops { until } => Some(count_loops(run, until) as f64),
            Self::Hops { until } => Some(count_hops(run, until)? as f64),
            Self::FinalRollTheta => Some(final_roll(run)?.theta),
            Self::MeanTheta { at } => mean(at, |cycle| cycle.means[0]),
            Self::MeanPrecession { at } => mean(at, |cycle| cycle.means[2]),
            Self::MeanSpin { at } => mean(at, |cycle| cycle.means[3]),
            Self::Amplitude { at } => mean(at, Cycle::amplitude),
            Self::AxialSpin { .. } => sampled,
            Self::EnergyLost { .. } => Some(run.energies?.first - sampled?),
            Self::PhaseLead { at } => run.phase().at(at),
            // These compare two runs.
            Self::AxisDistance { .. }
            | Self::InclinationDistance { .. }
            | Self::TorqueDifference { .. } => None,
        }
    }
}

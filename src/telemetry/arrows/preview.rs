//! Lengths of the arrows of a run, from a simulation with few samples.

use nalgebra::Vector3;

use super::snapshot::{Snapshot, SnapshotReader};
use crate::run::scenario::Scenario;
use crate::telemetry::stream::{RunError, RunMessages};
use crate::telemetry::topic::Topics;

/// Time between two samples, ns: several per nutation of a toy top.
const PERIOD_NS: u64 = 5_000_000;

/// Maximum number of samples and of integrator steps. All presets need fewer; what comes later in a longer run doesn't
/// change the scales. The steps take less than half a second.
const MAX_SAMPLES: usize = 20_000;
const MAX_STEPS: u32 = 400_000;

/// Share of the samples that may be greater than the usual magnitude: an arrow that is cut off for so short a time is
/// better than one that is hardly visible all the time. The friction force of a top that soon rolls is an example.
const RARE: f64 = 0.01;

/// Maximum ratio between the greatest magnitude and the usual one. Without it, a quantity that is almost always zero would
/// be cut off whenever it is not.
const MAX_RATIO: f64 = 10.0;

/// Magnitudes of vectors in a run, or in the first part of a long one. All are 0 if the simulation fails.
pub(super) struct Preview {
    /// Greatest slip speed, m/s. Slip that ends soon is still the slip that is to be seen.
    pub(super) slip: f64,
    /// Usual friction force, N.
    pub(super) force: f64,
    /// Usual torque of gravity, or of the normal force about the centre of mass, N m.
    pub(super) gravity_torque: f64,
    /// Usual torque of friction, N m.
    pub(super) friction_torque: f64,
    /// Greatest horizontal part of the angular momentum, N m s.
    pub(super) horizontal_momentum: f64,
}

impl Preview {
    /// Simulates a scenario.
    pub(super) fn new(scenario: &Scenario) -> Self {
        let snapshots = simulate(scenario);
        let sorted = |vector: fn(&Snapshot) -> Vector3<f64>| {
            let mut magnitudes: Vec<f64> = snapshots.iter().map(|s| vector(s).norm()).collect();
            magnitudes.sort_by(f64::total_cmp);
            magnitudes
        };
        Self {
            slip: greatest(&sorted(|s| s.slip)),
            force: usual(&sorted(|s| s.friction)),
            gravity_torque: usual(&sorted(|s| s.weight_torque)),
            friction_torque: usual(&sorted(|s| s.friction_torque)),
            horizontal_momentum: greatest(&sorted(Snapshot::horizontal_momentum)),
        }
    }
}

/// The vectors of a run with few samples.
fn simulate(scenario: &Scenario) -> Vec<Snapshot> {
    let mut sparse = scenario.clone();
    sparse.sample_period_ns = sparse.sample_period_ns.max(PERIOD_NS);
    let model = &scenario.model;
    let mut reader = SnapshotReader::new(model.top, model.support.is_free(), |_| true);
    let mut snapshots = Vec::new();
    let Ok(run) = RunMessages::new(&sparse, &Topics::All) else {
        return snapshots;
    };
    let mut steps = 0;
    let mut run = run.continue_while(move || {
        steps += 1;
        steps <= MAX_STEPS
    });
    // An error ends the run itself at the same place, and is reported there.
    while snapshots.len() < MAX_SAMPLES {
        let record = run.next(|message| {
            snapshots.extend(reader.take(message).copied());
            Ok::<_, RunError>(())
        });
        if !matches!(record, Some(Ok(_))) {
            break;
        }
    }
    snapshots
}

/// The last of all magnitudes in ascending order; 0 without samples.
fn greatest(magnitudes: &[f64]) -> f64 {
    magnitudes.last().copied().unwrap_or_default()
}

/// The magnitude that only rare samples exceed, given all in ascending order; 0 without samples.
fn usual(magnitudes: &[f64]) -> f64 {
    let Some(greatest) = magnitudes.last() else {
        return 0.0;
    };
    let rare = (RARE * magnitudes.len() as f64) as usize;
    magnitudes[magnitudes.len() - 1 - rare].max(greatest / MAX_RATIO)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_maximum_ignores_rare_peaks() {
        let mut magnitudes = vec![1.0; 199];
        magnitudes.push(7.0);
        assert_eq!(usual(&magnitudes), 1.0);
        *magnitudes.last_mut().unwrap() = 70.0;
        assert_eq!(usual(&magnitudes), 7.0);
        assert_eq!(usual(&[2.0, 3.0]), 3.0);
        assert_eq!(usual(&[]), 0.0);
    }
}

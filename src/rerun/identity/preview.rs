//! Lengths of the arrows of a run, from a simulation with few samples.

use nalgebra::Vector3;

use crate::run::scenario::Scenario;
use crate::run::simulation::{Record, Simulation};
use crate::telemetry::fields::{VectorField, contact, torque};

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

/// Vectors that arrows show.
const VECTORS: [VectorField; 4] = [
    contact::SLIP_WORLD,
    contact::FRICTION_FORCE,
    torque::GRAVITY_BODY,
    torque::FRICTION_BODY,
];

/// Magnitudes of vectors in a run, or in the first part of a long one. All are 0 if the simulation fails.
pub(super) struct Preview {
    /// Greatest slip speed, m/s. Slip that ends soon is still the slip that is to be seen.
    pub(super) slip: f64,
    /// Usual friction force, N.
    pub(super) force: f64,
    /// Usual torque of gravity, N m.
    pub(super) gravity_torque: f64,
    /// Usual torque of friction, N m.
    pub(super) friction_torque: f64,
}

impl Preview {
    /// Simulates a scenario.
    pub(super) fn new(scenario: &Scenario) -> Self {
        let [slip, force, gravity_torque, friction_torque] = simulate(scenario);
        Self {
            slip: slip.last().copied().unwrap_or_default(),
            force: usual(&force),
            gravity_torque: usual(&gravity_torque),
            friction_torque: usual(&friction_torque),
        }
    }
}

/// The magnitudes of each of the [`VECTORS`] in ascending order.
fn simulate(scenario: &Scenario) -> [Vec<f64>; 4] {
    let mut sparse = scenario.clone();
    sparse.sample_period_ns = sparse.sample_period_ns.max(PERIOD_NS);
    let mut magnitudes: [Vec<f64>; 4] = Default::default();
    let Ok(simulation) = Simulation::new(&sparse) else {
        return magnitudes;
    };
    let mut steps = 0;
    let simulation = simulation.continue_while(move || {
        steps += 1;
        steps <= MAX_STEPS
    });
    // An error ends the run itself at the same place, and is reported there.
    let samples = simulation
        .map_while(Result::ok)
        .filter_map(|record| match record {
            Record::Sample(sample) => Some(sample),
            Record::Event(_) | Record::Nutation(_) | Record::Impact(_) => None,
        });
    for sample in samples.take(MAX_SAMPLES) {
        for (magnitudes, vector) in magnitudes.iter_mut().zip(VECTORS) {
            let vector = Vector3::from(vector.components().map(|part| part.of_sample(&sample)));
            magnitudes.push(vector.norm());
        }
    }
    for magnitudes in &mut magnitudes {
        magnitudes.sort_by(f64::total_cmp);
    }
    magnitudes
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

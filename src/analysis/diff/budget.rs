//! Energy and the work of friction, at the ends of both runs and at the end of the time that both have.
//!
//! A run ends at an event, which lies behind its last sample by up to a sampling period. What is lost on that way
//! follows from the power of friction, so that the numbers don't depend on how finely a run was sampled.

use crate::analysis::course::curve::lagrange;
use crate::telemetry::Message;
use crate::telemetry::fields::{ENERGY, NumberField, energy};
use schemars::JsonSchema;
use serde::Serialize;

/// Energy and the work of friction up to a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Budget {
    /// The time, s.
    pub time: f64,
    /// Mechanical energy lost since the start, J.
    pub energy_lost: f64,
    /// Work of friction since the start, J.
    pub friction_work: f64,
    /// Work of friction since the start about the line of nodes (on the nutation), the perpendicular n × e_N (on the
    /// precession) and the symmetry axis (on the spin), J; recordings before telemetry version 2 don't have it.
    pub friction_work_node: Option<[f64; 3]>,
}

/// Energy (J), work of friction (J) and its power (W) at a time (s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sample {
    time: f64,
    energy: f64,
    work: f64,
    power: f64,
    /// Work of friction about each axis of the node frame, J; NaN where it wasn't recorded.
    work_node: [f64; 3],
}

/// The energies of a run so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Energies {
    first: Option<f64>,
    /// The last samples, at most four.
    last: Vec<Sample>,
}

impl Energies {
    /// Takes in a message, if it is about energy.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        if message.topic() == ENERGY {
            self.add(message.time_ns, message.numbers);
        }
    }

    /// Takes in the numbers of an energy message.
    pub(super) fn add(&mut self, time_ns: u64, numbers: &[f64]) {
        let of = |field: NumberField| numbers.get(field.index()).copied().unwrap_or(f64::NAN);
        let sample = Sample {
            time: time_ns as f64 / 1e9,
            energy: of(energy::TOTAL),
            work: of(energy::FRICTION_WORK),
            power: of(energy::FRICTION_POWER),
            work_node: energy::FRICTION_WORK_NODE.components().map(of),
        };
        if [sample.energy, sample.work, sample.power]
            .iter()
            .any(|value| !value.is_finite())
        {
            return;
        }
        self.first.get_or_insert(sample.energy - sample.work);
        if self.last.len() == 4 {
            self.last.remove(0);
        }
        self.last.push(sample);
    }

    /// What was lost up to a time (s), which is that of the last sample or less than two periods behind it.
    pub(super) fn up_to(&self, time: f64) -> Option<Budget> {
        let (first, last) = (self.first?, self.last.last()?);
        let ahead = time - last.time;
        let period = match self.last.as_slice() {
            [.., before, last] => last.time - before.time,
            _ => 0.0,
        };
        if !(0.0..2.0 * period).contains(&ahead) && ahead != 0.0 {
            return None;
        }
        let work = self.work_on_the_way(ahead);
        Some(Budget {
            time,
            energy_lost: first - last.energy - work,
            friction_work: last.work + work,
            friction_work_node: self
                .work_node(ahead)
                .filter(|work| work.iter().all(|w| w.is_finite())),
        })
    }

    /// The time of the last sample, s.
    pub(super) fn end(&self) -> Option<f64> {
        Some(self.last.last()?.time)
    }

    /// The work about each axis, J, by the polynomial through the last samples: its error is that of a cubic, a part
    /// (ω h)⁴ of what one nutation adds.
    fn work_node(&self, ahead: f64) -> Option<[f64; 3]> {
        let last = self.last.last()?;
        let times: Vec<f64> = self
            .last
            .iter()
            .map(|sample| sample.time - last.time)
            .collect();
        let weights: Vec<f64> = lagrange(&times, ahead).collect();
        Some([0, 1, 2].map(|axis| {
            let samples = weights.iter().zip(&self.last);
            samples.map(|(w, sample)| w * sample.work_node[axis]).sum()
        }))
    }

    /// The work from the last sample on, J: the integral of the polynomial through the powers of the last samples, by
    /// Gauss's rule of two points, which is exact for cubics.
    fn work_on_the_way(&self, ahead: f64) -> f64 {
        let origin = self.last.last().map_or(0.0, |last| last.time);
        let times: Vec<f64> = self
            .last
            .iter()
            .map(|sample| sample.time - origin)
            .collect();
        let power = |at: f64| -> f64 {
            let weights = lagrange(&times, at);
            weights
                .zip(&self.last)
                .map(|(w, sample)| w * sample.power)
                .sum()
        };
        let offset = ahead / (2.0 * 3.0_f64.sqrt());
        0.5 * ahead * (power(0.5 * ahead - offset) + power(0.5 * ahead + offset))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_what_is_lost_behind_the_last_sample_is_counted() {
        // The power is a cubic: −(1 + t + t² + t³).
        let work = |t: f64| -(t + t * t / 2.0 + t * t * t / 3.0 + t * t * t * t / 4.0);
        let mut energies = Energies::default();
        for i in 0..5_u32 {
            let t = 0.1 * f64::from(i);
            let mut numbers = vec![0.0; ENERGY.info().numbers.len()];
            numbers[energy::TOTAL.index()] = 7.0 + work(t);
            numbers[energy::FRICTION_WORK.index()] = work(t);
            numbers[energy::FRICTION_POWER.index()] = -(1.0 + t + t * t + t * t * t);
            energies.add(u64::from(i) * 100_000_000, &numbers);
        }
        let found = energies.up_to(0.47).unwrap();
        assert!(
            (found.friction_work - work(0.47)).abs() < 1e-14,
            "{found:?}"
        );
        assert!((found.energy_lost + work(0.47)).abs() < 1e-14, "{found:?}");
        assert_eq!(energies.up_to(0.7), None);
    }
}

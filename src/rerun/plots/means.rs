//! Means of the terms of the accelerations over each nutation.
//!
//! Within a nutation the terms swing by many times what friction contributes; their means don't.

use crate::telemetry::Message;
use crate::telemetry::fields::{
    ACCELERATION, NUTATION, NumberField, STATE, acceleration, nutation, state,
};

use super::curves::Derived;

/// The frictional term and the acceleration of each angle.
const TERMS: [(Derived, NumberField, NumberField); 3] = [
    (
        Derived::ThetaTerms,
        acceleration::THETA_DDOT_FRICTIONAL,
        state::THETA_DDOT,
    ),
    (
        Derived::PhiTerms,
        acceleration::PHI_DDOT_FRICTIONAL,
        state::PHI_DDOT,
    ),
    (
        Derived::PsiTerms,
        acceleration::PSI_DDOT_FRICTIONAL,
        state::PSI_DDOT,
    ),
];

/// Number of integrals: two for each angle.
const COUNT: usize = 2 * TERMS.len();

/// The means over a nutation.
pub(in crate::rerun) struct Means {
    /// Its end, ns.
    pub(in crate::rerun) time_ns: u64,
    /// Friction, the other terms and their sum of each angle, rad/s².
    pub(in crate::rerun) terms: [(Derived, [f64; 3]); 3],
}

/// Integrates the terms by the trapezoidal rule.
#[derive(Default)]
pub(in crate::rerun) struct MeanReader {
    /// Time (s) of the sample that is being read, and its values.
    time: f64,
    values: [f64; COUNT],
    /// The sample before, with the integrals up to it.
    before: Option<(f64, [f64; COUNT])>,
    integrals: [f64; COUNT],
    /// End (s) of the last nutation, with the integrals up to it.
    boundary: Option<(f64, [f64; COUNT])>,
    /// A nutation whose end is after the last sample: its start and end, s.
    pending: Option<(f64, f64)>,
}

impl MeanReader {
    /// Takes a message. Returns the means of a nutation that ended before this sample, if the nutation before it was
    /// recorded, too.
    pub(in crate::rerun) fn take(&mut self, message: &Message<'_>) -> Option<Means> {
        let time = 1e-9 * message.time_ns as f64;
        match message.topic() {
            STATE => {
                for (place, (_, _, sum)) in TERMS.iter().enumerate() {
                    self.values[2 * place + 1] = sum.of(message);
                }
                self.time = time;
                None
            }
            ACCELERATION if time == self.time => {
                for (place, (_, friction, _)) in TERMS.iter().enumerate() {
                    self.values[2 * place] = friction.of(message);
                }
                self.add_sample()
            }
            NUTATION => {
                let end = nutation::START.of(message) + nutation::PERIOD.of(message);
                self.pending = Some((nutation::START.of(message), end));
                None
            }
            _ => None,
        }
    }

    fn add_sample(&mut self) -> Option<Means> {
        let (time, values) = (self.time, self.values);
        let (last, from) = self.before.replace((time, values))?;
        let step = time - last;
        let means = self.pending.take().and_then(|(start, end)| {
            let part = (end - last) / step;
            let mut integrals = self.integrals;
            for (place, integral) in integrals.iter_mut().enumerate() {
                // The integral of the line between the two samples.
                let at_end = from[place] + part * (values[place] - from[place]);
                *integral += part * step * 0.5 * (from[place] + at_end);
            }
            self.end_nutation(start, end, integrals)
        });
        for (place, integral) in self.integrals.iter_mut().enumerate() {
            *integral += step * 0.5 * (from[place] + values[place]);
        }
        means
    }

    /// The means of a nutation, given the integrals up to its end.
    fn end_nutation(&mut self, start: f64, end: f64, integrals: [f64; COUNT]) -> Option<Means> {
        let (boundary, before) = self.boundary.replace((end, integrals))?;
        // A nanosecond is the resolution of times in recordings.
        if (start - boundary).abs() > 1e-9 {
            return None;
        }
        let mean = |place: usize| (integrals[place] - before[place]) / (end - start);
        let terms = [0, 1, 2].map(|angle| {
            let [friction, sum] = [mean(2 * angle), mean(2 * angle + 1)];
            (TERMS[angle].0, [friction, sum - friction, sum])
        });
        Some(Means {
            time_ns: (1e9 * end).round() as u64,
            terms,
        })
    }
}

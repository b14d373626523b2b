//! Samples at given times.

use super::{RecordStream, Runner, SimulationError};
use crate::physics::dynamics::Formulation;
use crate::run::simulation::queue::TimedMotion;
use crate::run::simulation::record::RunEnd;
use crate::run::simulation::sample::Sample;
use crate::run::simulation::tally::Tally;
use crate::run::time::nanoseconds;

impl<F: Formulation<N>, const N: usize> Runner<F, N> {
    /// Runs until the last of these times (s, ascending), or to the end of the run. Passes the samples to `take`.
    pub(in crate::run::simulation) fn take_samples(
        mut self,
        times: &[f64],
        take: &mut dyn FnMut(usize, &Sample),
        carry_on: &mut dyn FnMut() -> bool,
    ) -> Result<RunEnd, SimulationError> {
        let mut next = 0;
        loop {
            // Events aren't wanted, but must not pile up.
            self.queue.count_all(&mut Tally::default());
            let reached = self.reached();
            while let Some(time) = times.get(next).filter(|time| **time <= reached) {
                let (sample, motion) = self.sample_at(*time, next as u32, nanoseconds(*time));
                take(next, &sample);
                self.last = TimedMotion {
                    time: *time,
                    motion,
                };
                next += 1;
            }
            let is_done = next == times.len() || self.stopped.is_some();
            if is_done || !self.advance(carry_on)? {
                return Ok(RecordStream::end(&self));
            }
        }
    }

    /// The time up to which the motion is known, s: the end of the last step, or an earlier end of the phase or the run.
    fn reached(&self) -> f64 {
        match (&self.early_end, &self.dense) {
            (Some(end), _) => end.time,
            (None, Some(dense)) => dense.t0 + dense.h,
            (None, None) => self.integrator.t(),
        }
    }
}

//! Work done between records: real-time pacing, flushing, progress, cancellation.

use crate::archive::sink::{Sink, SinkError};
use crate::cli::interrupt;
use crate::cli::progress::Progress;
use crate::run::simulation::Record;
use crate::run::time::seconds;
use std::ops::ControlFlow;
use std::thread;
use std::time::{Duration, Instant};

/// Flush interval of a paced run.
const FLUSH_EVERY: Duration = Duration::from_millis(50);
/// Longest sleep; keeps Ctrl-C responsive.
const MAX_SLEEP: Duration = Duration::from_millis(20);
/// Samples between updates of the progress line in an unpaced run.
const PROGRESS_EVERY: u32 = 1000;

/// Paces a run and handles flushing, progress and cancellation.
pub(super) struct Pace {
    speed: Option<f64>,
    began: Instant,
    flushed: Instant,
    progress: Progress,
}

impl Pace {
    /// Starts the clock. `speed` is simulated time per real time; `None` for as fast as possible.
    pub(super) fn start(speed: Option<f64>) -> Self {
        let now = Instant::now();
        Self {
            speed,
            began: now,
            flushed: now,
            progress: Progress::for_state(),
        }
    }

    /// To be called after each record.
    pub(super) fn after(
        &mut self,
        record: &Record,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<ControlFlow<()>, SinkError> {
        if let Record::Sample(sample) = record {
            // A paced run shows each sample; otherwise drawing would take longer than simulating.
            if self.speed.is_some() || sample.index % PROGRESS_EVERY == 0 {
                self.progress.set_text(format!(
                    "simulated {:.2} s, θ = {:.3} rad",
                    seconds(sample.time_ns),
                    sample.angles.theta
                ));
            }
            self.wait_for(sample.time_ns, sinks)?;
        }
        Ok(interrupt::flow())
    }

    /// Removes the line that shows the progress.
    pub(super) fn finish(&self) {
        self.progress.finish();
    }

    /// In a paced run, flushes if due and sleeps until the time of the sample.
    fn wait_for(&mut self, time_ns: u64, sinks: &mut [&mut dyn Sink]) -> Result<(), SinkError> {
        let Some(speed) = self.speed else {
            return Ok(());
        };
        let due = due(time_ns, speed);
        loop {
            if self.flushed.elapsed() >= FLUSH_EVERY {
                for sink in &mut *sinks {
                    sink.flush()?;
                }
                self.flushed = Instant::now();
            }
            let early = due.saturating_sub(self.began.elapsed());
            if early.is_zero() || interrupt::is_requested() {
                return Ok(());
            }
            // By the clock, not by the sum of sleeps, so that delays don't add up.
            thread::sleep(early.min(MAX_SLEEP));
        }
    }
}

/// Wall time from the start at which simulated time `time_ns` is due. Saturates for very low speeds.
fn due(time_ns: u64, speed: f64) -> Duration {
    let seconds = seconds(time_ns) / speed;
    Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_speed_gives_a_time() {
        assert_eq!(due(3_000_000_000, 2.0), Duration::from_millis(1500));
        assert_eq!(due(1_000_000, 1e-30), Duration::MAX);
        assert_eq!(due(1, f64::MIN_POSITIVE), Duration::MAX);
        assert_eq!(due(u64::MAX, 1e300), Duration::ZERO);
    }
}

//! Reruns a scenario and yields its encoded messages.

use crate::archive::format::{CONTENT_DIGEST, Entries, end_entries};
use crate::archive::writer::{Form, Opening, RunEncoder};
use crate::run::scenario::Scenario;
use crate::run::simulation::{RunEnd, Simulation, SimulationError, StopReason};
use crate::telemetry::digest::ContentDigest;
use crate::telemetry::{Telemetry, TelemetryError};

/// An expected message.
pub(super) struct Expected {
    /// Index of its channel.
    pub(super) channel: usize,
    pub(super) sequence: u32,
    pub(super) time_ns: u64,
    pub(super) data: Vec<u8>,
    /// Numbers and texts of a message of the table.
    pub(super) values: Option<(Vec<f64>, Vec<String>)>,
}

/// A run that is simulated again.
pub(super) struct Rerun {
    pub(super) opening: Opening,
    simulation: Simulation,
    telemetry: Telemetry,
    encoder: RunEncoder,
    digest: ContentDigest,
    has_failed: bool,
}

impl Rerun {
    /// # Errors
    /// The reason why the scenario can't be simulated.
    pub(super) fn start(
        scenario: &Scenario,
        telemetry: Telemetry,
        form: Form,
    ) -> Result<Self, SimulationError> {
        let opening = || Opening::new(scenario, &telemetry, form);
        let recorded = opening();
        let ids: Vec<u16> = (0..recorded.channels.len() as u16).collect();
        Ok(Self {
            encoder: RunEncoder::new(recorded, &ids),
            opening: opening(),
            simulation: Simulation::new(scenario)?,
            telemetry,
            digest: ContentDigest::default(),
            has_failed: false,
        })
    }

    /// Simulates one record and passes its messages to `take`; returns its time in ns, or `None` at the end.
    pub(super) fn next(&mut self, mut take: impl FnMut(Expected)) -> Option<u64> {
        if self.has_failed {
            return None;
        }
        let Ok(record) = self.simulation.next()? else {
            self.has_failed = true;
            return None;
        };
        let (encoder, digest) = (&mut self.encoder, &mut self.digest);
        let logged = self.telemetry.messages(&record, |message| {
            encoder.batch.clear();
            encoder.encode(message);
            digest.update(message);
            // The views follow the message.
            let mut values = Some((message.numbers.to_vec(), message.texts.to_vec()));
            for (header, data) in encoder.batch.messages() {
                take(Expected {
                    channel: usize::from(header.channel_id),
                    sequence: header.sequence,
                    time_ns: header.log_time,
                    data: data.to_vec(),
                    values: values.take(),
                });
            }
            Ok::<(), TelemetryError>(())
        });
        // A recording error ended the original run, too.
        self.has_failed = logged.is_err();
        logged.is_ok().then(|| record.time_ns())
    }

    /// The opening and the entries of the end record, once the run has ended.
    pub(super) fn end(self) -> (Opening, Entries) {
        let mut end = self.simulation.end();
        if self.has_failed {
            end = RunEnd {
                stop: StopReason::Failed,
                ..end
            };
        }
        let mut entries = end_entries(&end);
        entries.insert(CONTENT_DIGEST.to_owned(), self.digest.finish());
        (self.opening, entries)
    }
}

//! Recordings that end early, simulated again to their end.

use crate::analysis::verify::{Group, Options, Verdict, verify};
use crate::archive::publish::{Draft, Existing, refuse_inputs};
use crate::archive::recording::Recording;
use crate::archive::recover::RecoverError;
use crate::archive::sink::{RecordError, Sink, record};
use crate::archive::writer::{Archived, Form, McapSink};
use crate::run::simulation::Simulation;
use crate::telemetry::encoding::Encoding;
use crate::telemetry::{Telemetry, Topics};
use std::ops::ControlFlow;
use std::path::Path;

/// Simulates the scenario of `recording` again and writes the whole run to `path`, if what can be read of
/// the recording is what the simulation gives. If its channels are lost, all topics and views are written, as JSON.
///
/// `progress` is told how many more bytes have been compared, in the end twice the file's.
///
/// # Errors
/// [`RecoverError`].
pub fn complete(
    recording: &Recording,
    path: &Path,
    existing: Existing,
    progress: &dyn Fn(u64),
) -> Result<Archived, RecoverError> {
    refuse_inputs(path, [recording.path()])?;
    let scenario = recording.scenario()?;
    let report = verify(recording, Options { reproduce: true }, progress);
    let different = report
        .checks
        .iter()
        .find(|check| check.group == Group::Reproduction && check.verdict == Verdict::Failed);
    if let Some(check) = different {
        return Err(RecoverError::Different(check.finding.clone()));
    }
    let mut telemetry = Telemetry::with_topics(&match recording.topics() {
        none if none.is_empty() => Topics::All,
        topics => Topics::Only(topics),
    });
    // Without its channels nothing tells how the run was recorded.
    let form = match recording.channels() {
        [] => Form::default(),
        channels => Form {
            encoding: recording.encoding().unwrap_or(Encoding::Json),
            views: channels.iter().any(|channel| channel.is_view()),
        },
    };
    let mut sink = McapSink::create_in(Draft::new(path, existing)?, &scenario, &telemetry, form)?;
    let mut simulation = Simulation::new(&scenario).map_err(RecordError::from)?;
    let mut sinks: [&mut dyn Sink; 1] = [&mut sink];
    let carry_on = |_: &_, _: &mut [&mut dyn Sink]| Ok(ControlFlow::Continue(()));
    let outcome = record(&mut simulation, &mut telemetry, &mut sinks, carry_on)?;
    Ok(sink.finish(&outcome)?)
}

//! Recordings that end early, simulated again to their end.

use crate::analysis::verify::{Group, Options, Verdict, verify};
use crate::archive::format::recorded_form;
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
/// the recording is what the simulation gives. Topics, views and encoding are those of the recording.
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
    recording.refuse_newer()?;
    let scenario = recording.scenario()?;
    let report = verify(recording, Options { reproduce: true }, progress);
    let different = report
        .checks
        .iter()
        .find(|check| check.group == Group::Reproduction && check.verdict == Verdict::Failed);
    if let Some(check) = different {
        return Err(RecoverError::Different(check.finding.clone()));
    }
    let (form, topics) = form(recording);
    let mut telemetry = Telemetry::with_topics(&topics);
    let mut sink = McapSink::create_in(Draft::new(path, existing)?, &scenario, &telemetry, form)?;
    let mut simulation = Simulation::new(&scenario).map_err(RecordError::from)?;
    let mut sinks: [&mut dyn Sink; 1] = [&mut sink];
    let carry_on = |_: &_, _: &mut [&mut dyn Sink]| Ok(ControlFlow::Continue(()));
    let outcome = record(&mut simulation, &mut telemetry, &mut sinks, carry_on)?;
    Ok(sink.finish(&outcome)?)
}

/// How a run was recorded, as `toprise.run` says, or else its channels. If both are lost, as by default.
fn form(recording: &Recording) -> (Form, Topics) {
    if let Some((encoding, views, topics)) = recording.run().and_then(recorded_form) {
        return (Form { encoding, views }, topics);
    }
    match recording.channels() {
        [] => (Form::default(), Topics::All),
        channels => {
            let form = Form {
                encoding: recording.encoding().unwrap_or(Encoding::Json),
                views: channels.iter().any(|channel| channel.is_view()),
            };
            (form, Topics::Only(recording.topics()))
        }
    }
}

/// Whether it is known how a run was recorded.
#[must_use]
pub fn is_form_known(recording: &Recording) -> bool {
    !recording.channels().is_empty() || recording.run().and_then(recorded_form).is_some()
}

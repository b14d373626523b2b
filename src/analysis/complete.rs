//! Recordings that end early, simulated again to their end.

use crate::analysis::verify::{Group, Options, Verdict, verify};
use crate::archive::publish::{Draft, Existing, refuse_inputs};
use crate::archive::recording::Recording;
use crate::archive::recover::RecoverError;
use crate::archive::sink::{RecordError, Sink, record};
use crate::archive::writer::{Archived, Form, McapSink};
use crate::run::simulation::Simulation;
use crate::telemetry::{Telemetry, Topics};
use std::ops::ControlFlow;
use std::path::Path;

/// Simulates the scenario of `recording` again and writes the whole run to `path`, if what can be read of
/// the recording is what the simulation gives. Topics, views and encoding are those of the recording, or, if nothing tells
/// them any more, all, as JSON.
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
    let (form, topics) = match recording.form() {
        Some((encoding, views, topics)) => (Form { encoding, views }, topics),
        None => (Form::default(), Topics::All),
    };
    let mut telemetry = Telemetry::with_topics(&topics);
    let mut sink = McapSink::create_in(Draft::new(path, existing)?, &scenario, &telemetry, form)?;
    let mut simulation = Simulation::new(&scenario).map_err(RecordError::from)?;
    let mut sinks: [&mut dyn Sink; 1] = [&mut sink];
    let carry_on = |_: &_, _: &mut [&mut dyn Sink]| Ok(ControlFlow::Continue(()));
    let end = record(&mut simulation, &mut telemetry, &mut sinks, carry_on)?;
    Ok(sink.finish(&end)?)
}

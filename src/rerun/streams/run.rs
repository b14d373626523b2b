//! The recording of one run: its description, its plots, its events and its scene.

use crate::run::time::seconds;
use rerun::TextDocument;

use super::events::{Events, Regimes};
use super::properties;
use super::stream::{Stream, StreamContent};
use super::why::{Why, has_why};
use crate::archive::sink::{Sink, SinkError};
use crate::rerun::blueprint;
use crate::rerun::blueprint::run::has_regimes;
use crate::rerun::entity::{ABOUT, LEGEND};
use crate::rerun::identity::{Identity, Playback};
use crate::rerun::measurement::plots::Measured;
use crate::rerun::output::{Destination, Destinations, Output};
use crate::rerun::plots::Plots;
use crate::rerun::plots::means::MeanReader;
use crate::rerun::role::Role;
use crate::rerun::scene::{Scene, legend};
use crate::rerun::style::legible;
use crate::run::outcome::Outcome;
use crate::telemetry::Message;
use crate::telemetry::arrows::snapshot::SnapshotReader;
use crate::telemetry::fields::{EVENTS, POSE, Plot};

/// A sink that makes a Rerun recording of a run.
pub type RerunSink = Stream<Entities>;

/// The entities of one run, fed with its messages.
pub struct Entities {
    plots: Plots,
    measured: Option<Measured>,
    events: Option<Events>,
    regimes: Option<Regimes>,
    why: Option<Why>,
    scene: Option<Scene>,
    snapshots: SnapshotReader,
    means: MeanReader,
    identity: Identity,
    /// Whether the description begins with the reason for the motion.
    has_story: bool,
}

impl Stream<Entities> {
    /// Opens the destinations and sends static content: layout, names, the scene's bodies.
    pub fn new(identity: &Identity, destinations: Destinations) -> Self {
        Self::open(
            identity.store(),
            &identity.shown_name,
            destinations,
            |output| {
                // The file is opened when the run is complete.
                for (to, playback) in [
                    (Destination::Viewer, identity.playback),
                    (Destination::File, Playback::FromStart),
                ] {
                    output.send_layout(to, blueprint::run::messages(identity, playback));
                }
                Entities::new(identity, &Role::Alone, output)
            },
        )
    }

    /// Sets the outcome of the run, as properties of the recording: `outcome:rise_time` and so on.
    pub fn set_outcome(&mut self, outcome: &Outcome) {
        let values = properties::from_outcome(outcome);
        self.output.send_static(properties::entity(), &values);
    }
}

impl Stream<Entities> {
    /// Sets the reason for the motion, a paragraph of Markdown. It is shown first when the run has ended.
    pub fn set_story(&mut self, paragraph: &str) {
        let about = about(&self.content.identity, &legible(paragraph));
        // Replaces the text that was sent at the start: static data have one value.
        self.output.send_static(Role::Alone.entity(ABOUT), &about);
        self.content.has_story = true;
    }
}

/// The description of a run after a paragraph.
fn about(identity: &Identity, paragraph: &str) -> TextDocument {
    let text = format!("{paragraph}\n\n{}", identity.description);
    TextDocument::from_markdown(text.trim_start())
}

impl Sink for Stream<Entities> {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.end_ns = message.time_ns;
        self.content.write(message, &mut self.output);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.output.show();
        Ok(())
    }
}

impl Entities {
    /// Sends static data: description, names and colours, bodies of the scene.
    pub(super) fn new(identity: &Identity, role: &Role, output: &mut Output) -> Self {
        let has_scene = identity.has(POSE);
        output.send_static(role.entity(ABOUT), &about(identity, ""));
        if has_scene && role.is_alone() {
            let legend = TextDocument::from_markdown(legend(identity));
            output.send_static(role.entity(LEGEND), &legend);
        }
        let top = identity.geometry.top;
        let measurement = identity.measurement.as_ref();
        Self {
            measured: measurement.map(|measurement| Measured::new(measurement, output)),
            plots: plots(identity, role, output),
            snapshots: SnapshotReader::new(top, identity.geometry.is_free, |topic| {
                identity.has(topic)
            }),
            means: MeanReader::default(),
            events: identity.has(EVENTS).then(|| Events::new(top, role, output)),
            regimes: (role.is_alone() && has_regimes(identity)).then(|| Regimes::new(output)),
            why: (role.is_alone() && has_why(identity)).then(|| Why::new(identity, output)),
            scene: has_scene.then(|| Scene::new(identity, role, output)),
            identity: identity.clone(),
            has_story: false,
        }
    }

    /// The numbers of the run.
    pub(super) fn plots(&self) -> &Plots {
        &self.plots
    }

    /// Adds the content of a message of the run.
    pub(super) fn write(&mut self, message: &Message<'_>, output: &mut Output) {
        self.plots.write(message, Some, output);
        if let Some(measured) = &mut self.measured {
            measured.write(message, output);
        }
        if let Some(events) = &mut self.events
            && events.write(message, output)
        {
            self.plots.mark_event(message, output);
        }
        if let Some(scene) = &mut self.scene {
            scene.write(message, output);
        }
        if let Some(snapshot) = self.snapshots.take(message) {
            if let Some(scene) = &mut self.scene {
                scene.write_snapshot(snapshot, output);
            }
            if let Some(why) = &mut self.why {
                why.write(snapshot, output);
            }
            self.plots.write_snapshot(snapshot, output);
        }
        if let Some(regimes) = &mut self.regimes {
            regimes.write(message, output);
        }
        if let Some(means) = self.means.take(message) {
            self.plots.write_means(&means, output);
        }
    }

    /// Marks the end of the run at this time, ns, in a recording that goes on.
    pub(super) fn end(&mut self, time_ns: u64, output: &mut Output) {
        if let Some(scene) = &mut self.scene {
            scene.end(time_ns, output);
        }
    }

    /// Adds content derived from all events.
    pub(super) fn summarize_events(&mut self, output: &mut Output) {
        if let Some(events) = &mut self.events {
            events.summarize(output);
        }
    }
}

/// The plots that the layout shows, and those of measured fields.
fn plots(identity: &Identity, role: &Role, output: &mut Output) -> Plots {
    let signals = identity.measurement.iter().flat_map(|m| &m.signals);
    let measured: Vec<_> = signals.map(|signal| signal.field.plot()).collect();
    let is_free = identity.geometry.is_free;
    let wanted = |plot: Plot| {
        identity.has(plot.topic())
            && (blueprint::charts::shows(plot, role, is_free) || measured.contains(&plot))
    };
    let plots = Plots::new(wanted, role, output);
    if role.is_alone() {
        plots.with_derived(identity, role, output)
    } else {
        plots
    }
}

impl StreamContent for Entities {
    fn finish(&mut self, end_ns: u64, output: &mut Output) {
        self.summarize_events(output);
        output.complete();
        let ended = blueprint::run::EndedRun {
            duration: seconds(end_ns),
            plots: &self.plots,
            has_story: self.has_story,
        };
        let layout = blueprint::run::messages_at_end(&self.identity, &ended);
        // A viewer that follows a paced run has shown it already.
        let to = match self.identity.playback {
            Playback::FromStart => Destination::Both,
            Playback::Following => Destination::File,
        };
        output.send_layout(to, layout);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rerun::error::ViewerError;
    use crate::rerun::output::viewer::Live;
    use crate::run::scenario::Preset;
    use crate::telemetry::{Topic, channels};
    use std::fs::File;

    fn identity(topics: Vec<Topic>) -> Identity {
        let scenario = Preset::find("free-paper").unwrap().scenario().unwrap();
        Identity::new("test", &scenario, topics, Playback::FromStart)
    }

    fn all_topics() -> Vec<Topic> {
        Topic::all().collect()
    }

    /// Writes `count` rows of ones per channel.
    fn fill(sink: &mut RerunSink, count: u64) -> Result<(), SinkError> {
        for time_ns in (0..count).map(|index| index * 1_000_000) {
            for (index, channel) in channels().iter().enumerate() {
                sink.write(&Message {
                    channel: index,
                    sequence: 0,
                    time_ns,
                    numbers: &vec![1.0; channel.numbers.len()],
                    texts: &vec![String::new(); channel.texts.len()],
                })?;
            }
        }
        Ok(())
    }

    #[test]
    fn missing_viewer_is_a_warning() {
        // Port 9 (discard) of this machine: no server listens there.
        let destinations = Destinations {
            file: None,
            live: Some(Live::Connect("127.0.0.1:9".to_owned())),
        };
        let mut sink = RerunSink::new(&identity(all_topics()), destinations);
        assert!(!sink.is_live());
        assert!(matches!(
            sink.take_warnings()[..],
            [ViewerError::Absent { .. }]
        ));
        fill(&mut sink, 10).unwrap();
        sink.flush().unwrap();
        assert!(sink.finish().unwrap().is_empty());
    }

    #[test]
    fn invalid_address_is_a_warning() {
        let live = Some(Live::Connect("http://".to_owned()));
        let destinations = Destinations { file: None, live };
        let mut sink = RerunSink::new(&identity(all_topics()), destinations);
        assert!(matches!(
            sink.take_warnings()[..],
            [ViewerError::Address { .. }]
        ));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn finish_reports_a_full_disk() {
        let file = File::options().write(true).open("/dev/full").unwrap();
        let destinations = Destinations {
            file: Some(file),
            live: None,
        };
        let mut sink = RerunSink::new(&identity(all_topics()), destinations);
        fill(&mut sink, 5000).unwrap();
        sink.flush().unwrap();
        let error = sink.finish().unwrap_err().to_string();
        assert!(error.contains("No space left"), "{error}");
    }

    #[test]
    fn accepts_any_topics() {
        for topic in all_topics() {
            let chosen = identity(vec![topic]);
            let mut sink = RerunSink::new(&chosen, Destinations::default());
            fill(&mut sink, 3).unwrap();
            sink.finish().unwrap();
        }
    }
}

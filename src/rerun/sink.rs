//! The sinks: a recording of one run, and one of two runs that are compared.

use rerun::external::re_log_types::LogMsg;
use rerun::{EntityPath, RecordingInfo, StoreId};

use super::blueprint;
use super::comparison::Comparison;
use super::entities::Entities;
use super::error::RerunError;
use super::identity::{Identity, Playback};
use super::look::Look;
use super::outlet::{Destinations, Outlet, To};
use super::pair::PairIdentity;
use super::properties;
use super::track::{Collect, Content, Flush};
use crate::archive::sink::{Sink, SinkError};
use crate::run::outcome::Outcome;
use crate::telemetry::Message;
use crate::telemetry::side::Side;

/// A sink that makes a Rerun recording of a run.
pub type RerunSink = Stream<Entities>;

/// A sink that makes one Rerun recording of two runs and their differences.
pub type PairSink = Stream<Comparison>;

/// A Rerun recording that is being written: its entities, and where they go.
///
/// Writing never fails, so that other sinks of the run go on. [`Self::take_warnings`] returns what happened to the
/// viewer, [`Self::finish`] what happened to the file.
pub struct Stream<E> {
    entities: E,
    outlet: Outlet,
    /// Time of the latest message, ns.
    end_ns: u64,
}

impl Stream<Entities> {
    /// Opens the destinations and sends what doesn't change: layout, names, the scene's bodies.
    #[must_use]
    pub fn new(identity: &Identity, destinations: Destinations) -> Self {
        // The file is opened when the run is complete.
        let complete = Identity {
            playback: Playback::FromStart,
            ..identity.clone()
        };
        let layouts = [identity, &complete].map(blueprint::run::messages);
        let mut outlet = open(identity.store(), &identity.name, destinations, layouts);
        let entities = Entities::new(identity, &Look::Alone, &mut outlet);
        Self {
            entities,
            outlet,
            end_ns: 0,
        }
    }

    /// Sets the outcome of the run, as properties of the recording: `outcome:rise_time` and so on.
    pub fn set_outcome(&mut self, outcome: &Outcome) {
        let values = properties::of_outcome(outcome);
        self.outlet.send_static(properties::entity(), &values);
    }
}

impl Sink for Stream<Entities> {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.end_ns = message.time_ns;
        self.entities.write(message, &mut self.outlet);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.entities.flush(&mut self.outlet, Flush::Viewer);
        Ok(())
    }
}

impl Stream<Comparison> {
    /// Opens the destinations and sends what doesn't change: layout, names, the scene's bodies.
    #[must_use]
    pub fn new(identity: &PairIdentity, destinations: Destinations) -> Self {
        let layouts = [identity; 2].map(|identity| blueprint::pair::messages(identity, None));
        let mut outlet = open(identity.store(), &identity.name, destinations, layouts);
        let entities = Comparison::new(identity, &mut outlet);
        Self {
            entities,
            outlet,
            end_ns: 0,
        }
    }

    /// Adds a message of one run. Each run's messages come in the order of time; the runs take turns as they like.
    pub fn write(&mut self, side: Side, message: &Message<'_>) {
        self.end_ns = self.end_ns.max(message.time_ns);
        self.entities.write(side, message, &mut self.outlet);
    }

    /// Adds the differences B − A of the numbers of a message, at the time of A; its texts don't matter.
    ///
    /// Channels that are neither sampled nor `/top/nutation` are passed over.
    pub fn difference(&mut self, message: &Message<'_>) {
        self.entities.write_difference(message, &mut self.outlet);
    }

    /// Replaces the summary of the comparison, which is Markdown.
    pub fn summarize(&mut self, markdown: &str) {
        self.entities.summarize(markdown, &mut self.outlet);
    }
}

impl<E: Content> Stream<E> {
    /// Whether a viewer is being fed, as far as is known.
    #[must_use]
    pub fn is_live(&self) -> bool {
        self.outlet.is_live()
    }

    /// Failures of the viewer since the last call, in sentences. A viewer that isn't there is a warning too.
    #[must_use]
    pub fn take_warnings(&mut self) -> Vec<String> {
        self.outlet.take_warnings()
    }

    /// Sends all that is left and completes the file with its footer.
    ///
    /// Gives back the warnings that were not taken yet. A viewer that doesn't read is left alone after a few seconds.
    ///
    /// # Errors
    /// The first [`RerunError`]; the file then holds what was written before.
    pub fn finish(mut self) -> Result<Vec<String>, RerunError> {
        self.entities.flush(&mut self.outlet, Flush::All);
        let duration = self.end_ns as f64 * 1e-9;
        self.entities.change_layout(duration, &mut self.outlet);
        self.outlet.finish()
    }
}

/// Opens the destinations of a recording, and sends its layouts, for the viewer and for the file, and its name.
fn open(
    store: StoreId,
    name: &str,
    destinations: Destinations,
    layouts: [Vec<Result<LogMsg, RerunError>>; 2],
) -> Outlet {
    let mut outlet = Outlet::open(store, destinations);
    for (to, layout) in [To::Viewer, To::File].into_iter().zip(layouts) {
        for message in layout {
            outlet.send_to(to, message);
        }
    }
    let name = RecordingInfo::update_fields().with_name(name);
    outlet.send_static(EntityPath::properties(), &name);
    outlet
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rerun::viewer::Live;
    use crate::run::scenario::Preset;
    use crate::telemetry::{Topic, channels};
    use std::fs::File;

    fn identity(topics: Vec<Topic>) -> Identity {
        let scenario = Preset::find("free-paper").unwrap().scenario().unwrap();
        Identity::of("test", &scenario, topics, Playback::FromStart)
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
    fn a_viewer_that_is_not_there_is_a_warning() {
        // Port 9 (discard) of this machine: no server listens there.
        let destinations = Destinations {
            file: None,
            live: Some(Live::Connect("127.0.0.1:9".to_owned())),
        };
        let mut sink = RerunSink::new(&identity(all_topics()), destinations);
        assert!(!sink.is_live());
        assert!(sink.take_warnings()[0].contains("no Rerun viewer at"));
        fill(&mut sink, 10).unwrap();
        sink.flush().unwrap();
        assert_eq!(sink.finish().unwrap(), [""; 0]);
    }

    #[test]
    fn an_address_that_is_none_is_a_warning() {
        let live = Some(Live::Connect("http://".to_owned()));
        let destinations = Destinations { file: None, live };
        let mut sink = RerunSink::new(&identity(all_topics()), destinations);
        assert!(sink.take_warnings()[0].contains("no address of a Rerun viewer"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_told_at_the_end() {
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
    fn any_choice_of_topics_is_fine() {
        for topic in all_topics() {
            let chosen = identity(vec![topic]);
            let mut sink = RerunSink::new(&chosen, Destinations::default());
            fill(&mut sink, 3).unwrap();
            sink.finish().unwrap();
        }
    }
}

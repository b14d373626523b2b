//! The Rerun sink: every number of every channel, the scene of the rising top, and a layout.
//!
//! Numbers that are read together are one entity, `{topic}/{plot}`, with several instances and
//! static names and colours; that is several times smaller and faster than an entity per number.
//! Rows are collected into chunks of 4096 per entity. The identifiers of chunks and rows are
//! numbers in order, so that a run gives the same chunks each time.
//!
//! In a paced run, [`Sink::flush`] sends the rows of the last moments to the viewer; the file gets
//! them in full chunks all the same, so pacing doesn't change it.
//!
//! [`PairSink`] puts two runs into one recording, which are compared.

mod arrow;
mod blueprint;
mod destination;
mod entities;
mod look;
mod pair;
mod scene;
#[cfg(feature = "web-viewer")]
mod serve;
mod shape;
mod style;
mod track;
mod viewer;

use std::fs::File;

use rerun::external::re_log_encoding::rrd::EncodeError;
use rerun::external::re_log_types::{LogMsg, StoreKind};
use rerun::external::re_sdk_types::SerializationError;
use rerun::log::ChunkError;
use rerun::{EntityPath, RecordingInfo, StoreId};

pub use self::destination::Destinations;
use self::destination::Outlet;
use self::entities::Entities;
use self::look::Look;
pub use self::pair::{PairIdentity, PairSink};
#[cfg(feature = "web-viewer")]
pub use self::serve::WebViewer;
pub use self::viewer::{Live, MISSING_VIEWER};
use crate::archive::sink::{Sink, SinkError};
use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::telemetry::proportions::Proportions;
use crate::telemetry::{Message, Topic};

/// The application that all recordings belong to.
const APPLICATION: &str = "toprise";

/// Why a recording could not be written.
#[derive(Debug, thiserror::Error)]
pub enum RerunError {
    /// The file or a thread failed.
    #[error("cannot write the Rerun recording: {0}")]
    Io(#[from] std::io::Error),
    /// The encoder failed, most often because of the file.
    #[error("cannot write the Rerun recording: {0}")]
    Encode(#[from] EncodeError),
    /// Rows did not form a chunk.
    #[error("cannot form a chunk of the Rerun recording: {0}")]
    Chunk(#[from] ChunkError),
    /// Values could not be serialized.
    #[error("cannot serialize for the Rerun recording: {0}")]
    Serialization(#[from] SerializationError),
    /// The encoder's thread ended without a word.
    #[error("the thread that writes the Rerun recording has ended early")]
    Worker,
}

impl From<RerunError> for SinkError {
    fn from(error: RerunError) -> Self {
        Self::Viewer(Box::new(error))
    }
}

/// Dimensions of the top and scales of the arrows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// The top.
    pub top: Top,
    /// A typical friction force (k times the normal force) in N; 0 without friction.
    pub force_scale: f64,
    /// A typical torque of friction, in N m; 0 without friction.
    pub torque_scale: f64,
    /// A typical slip speed, as at the start, in m/s.
    pub slip_scale: f64,
}

/// What a viewer does when it has opened a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Playback {
    /// Wait at the start, for a recording that is there as a whole.
    PausedAtStart,
    /// Follow the newest sample, for a paced run.
    Following,
}

/// What a recording says about itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Recordings with the same identifier are one recording to a viewer.
    pub recording_id: String,
    /// The name that a viewer shows.
    pub name: String,
    /// About the run, in Markdown.
    pub description: String,
    /// The top.
    pub geometry: Geometry,
    /// The topics that will be written; the layout leaves out the plots of others.
    pub topics: Vec<Topic>,
    /// What a viewer does at first.
    pub playback: Playback,
    /// Whether it is not shown together with other recordings.
    pub is_alone: bool,
}

impl Identity {
    /// The identity of a run or a recording that is called `name`.
    ///
    /// Two runs of one scenario are two recordings to a viewer, as they are two files.
    #[must_use]
    pub fn of(name: &str, scenario: &Scenario, topics: Vec<Topic>, playback: Playback) -> Self {
        let model = &scenario.model;
        Self {
            recording_id: format!("{name}-{:.16}", scenario.digest()),
            name: name.to_owned(),
            description: format!(
                "# {}\n\n{}\n\n```toml\n{}```\n",
                scenario.name(),
                scenario.description(),
                scenario.to_toml()
            ),
            geometry: Geometry {
                top: model.top,
                force_scale: scenario.force_scale(),
                torque_scale: scenario.torque_scale(),
                slip_scale: scenario.slip_speed_at_start(),
            },
            topics,
            playback,
            is_alone: true,
        }
    }

    fn has_topic(&self, topic: &str) -> bool {
        self.topics.iter().any(|known| known.name() == topic)
    }

    /// Whether there will be data in one of these entities.
    fn has_some(&self, entities: &[&str]) -> bool {
        let known = |entity: &&str| {
            entity
                .rsplit_once('/')
                .is_some_and(|(topic, _)| self.has_topic(topic))
        };
        entities.iter().any(known)
    }
}

/// Writes messages into a Rerun recording.
pub struct RerunSink {
    outlet: Outlet,
    run: Entities,
}

impl RerunSink {
    /// Opens the destinations and sends what doesn't change: layout, names, the scene's bodies.
    ///
    /// A viewer that isn't there is no error but a warning: see [`Self::take_warnings`].
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn new(identity: &Identity, destinations: Destinations) -> Result<Self, RerunError> {
        let proportions = Proportions::new(&identity.geometry.top);
        let layout = blueprint::messages(identity, &proportions)?;
        let (id, name) = (&identity.recording_id, &identity.name);
        let mut outlet = open(id, name, destinations, &layout)?;
        let run = Entities::new(identity, &Look::Alone, &mut outlet)?;
        Ok(Self { outlet, run })
    }

    /// Whether a viewer is being fed, as far as is known.
    #[must_use]
    pub fn is_live(&self) -> bool {
        self.outlet.is_live()
    }

    /// What went wrong with the viewer since the last call, for people to read.
    #[must_use]
    pub fn take_warnings(&mut self) -> Vec<String> {
        self.outlet.take_warnings()
    }

    /// Sends all that is left and completes the file with its footer.
    ///
    /// Gives back the file, written but not synced, and the warnings that were not taken yet. A
    /// viewer that doesn't read is left after a few seconds.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self) -> Result<(Option<File>, Vec<String>), RerunError> {
        self.run.complete(&mut self.outlet)?;
        self.outlet.finish()
    }
}

impl Sink for RerunSink {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        Ok(self.run.write(message, &mut self.outlet)?)
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        Ok(self.run.show(&mut self.outlet)?)
    }
}

/// Opens the destinations of a recording, and sends its layout and its name.
fn open(
    recording_id: &str,
    name: &str,
    destinations: Destinations,
    layout: &[LogMsg],
) -> Result<Outlet, RerunError> {
    let store = StoreId::new(StoreKind::Recording, APPLICATION, recording_id);
    let mut outlet = Outlet::open(store, destinations)?;
    for message in layout {
        outlet.send(message)?;
    }
    let name = RecordingInfo::update_fields().with_name(name);
    outlet.send_static(EntityPath::properties(), &name)?;
    Ok(outlet)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::Preset;
    use crate::telemetry::channels;

    fn identity(topics: Vec<Topic>) -> Identity {
        Identity {
            recording_id: "test".to_owned(),
            name: "test".to_owned(),
            description: "# Test".to_owned(),
            geometry: Geometry {
                top: Preset::find("paper").unwrap().scenario().unwrap().model.top,
                force_scale: 0.0324,
                torque_scale: 0.0324 * 0.007,
                slip_scale: 0.57,
            },
            topics,
            playback: Playback::PausedAtStart,
            is_alone: true,
        }
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
        // Port 9 (discard) of this machine: nobody listens there.
        let destinations = Destinations {
            file: None,
            live: Some(Live::Connect("127.0.0.1:9".to_owned())),
        };
        let mut sink = RerunSink::new(&identity(all_topics()), destinations).unwrap();
        assert!(!sink.is_live());
        assert!(sink.take_warnings()[0].contains("no Rerun viewer at"));
        fill(&mut sink, 10).unwrap();
        sink.flush().unwrap();
        assert_eq!(sink.finish().unwrap().1, [""; 0]);
    }

    #[test]
    fn an_address_that_is_none_is_a_warning() {
        let live = Some(Live::Connect("http://".to_owned()));
        let destinations = Destinations { file: None, live };
        let mut sink = RerunSink::new(&identity(all_topics()), destinations).unwrap();
        assert!(sink.take_warnings()[0].contains("no address of a Rerun viewer"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error() {
        let file = File::options().write(true).open("/dev/full").unwrap();
        let destinations = Destinations {
            file: Some(file),
            live: None,
        };
        // Where the error surfaces depends on when the encoder's thread meets it.
        let outcome = RerunSink::new(&identity(all_topics()), destinations)
            .map_err(SinkError::from)
            .and_then(|mut sink| {
                fill(&mut sink, 5000)?;
                Ok(sink.finish()?)
            });
        assert!(outcome.is_err());
    }

    #[test]
    fn any_choice_of_topics_is_fine() {
        for topic in all_topics() {
            let chosen = identity(vec![topic]);
            let mut sink = RerunSink::new(&chosen, Destinations::default()).unwrap();
            fill(&mut sink, 3).unwrap();
            sink.finish().unwrap();
        }
    }
}

//! Inputs of analysis: recordings, or scenarios to simulate.

use crate::archive::container::source::is_stream;
use crate::archive::format::end_entries;
use crate::archive::recording::{Condition, Recording, Selection};
pub use crate::archive::replay::ReadEnd;
use crate::archive::replay::replay;
use crate::run::scenario::Scenario;
use crate::telemetry::{Message, RunError, RunMessages, Topic, Topics};

/// A run to be analysed.
#[derive(Clone, Copy, Debug)]
pub enum Subject<'a> {
    /// A recording, or any other MCAP file.
    Recording(&'a Recording),
    /// A scenario, which is simulated when it is read.
    Scenario(&'a Scenario),
}

impl<'a> From<&'a Recording> for Subject<'a> {
    fn from(recording: &'a Recording) -> Self {
        Self::Recording(recording)
    }
}

impl<'a> From<&'a Scenario> for Subject<'a> {
    fn from(scenario: &'a Scenario) -> Self {
        Self::Scenario(scenario)
    }
}

impl Subject<'_> {
    /// Calls `take` with the messages of some topics in time order, and the number of bytes read since the last call,
    /// as long as `take` returns true.
    pub fn read(self, topics: &Topics, take: &mut dyn FnMut(&Message<'_>, u64) -> bool) -> ReadEnd {
        match self {
            Self::Scenario(scenario) => simulate(scenario, topics, take),
            Self::Recording(recording) => {
                let topics = match topics {
                    Topics::All => Topics::All,
                    Topics::Only(topics) => {
                        Topics::Only(topics.iter().map(ToString::to_string).collect())
                    }
                };
                let selection = Selection {
                    topics,
                    ..Selection::default()
                };
                replay(recording, selection, take)
            }
        }
    }

    /// Whether the run is that of a top with a free peg.
    pub fn has_free_peg(self) -> bool {
        self.scenario()
            .is_some_and(|scenario| scenario.model.support.is_free())
    }

    /// The scenario, if there is one that this version can read.
    pub fn scenario(self) -> Option<Scenario> {
        match self {
            Self::Scenario(scenario) => Some(scenario.clone()),
            Self::Recording(recording) => recording.scenario().ok(),
        }
    }

    /// The name of the scenario, or of the file.
    pub fn name(self) -> String {
        match self {
            Self::Scenario(scenario) => scenario.name().to_owned(),
            // A stream has a descriptor for a name.
            Self::Recording(recording) if is_stream(recording.path()) => {
                let scenario = recording.scenario();
                scenario.map_or_else(|_| "stream".to_owned(), |s| s.name().to_owned())
            }
            Self::Recording(recording) => {
                let stem = recording.path().file_stem().unwrap_or_default();
                stem.to_string_lossy().into_owned()
            }
        }
    }

    /// The topics of the table for which the run has channels.
    pub fn topics(self) -> Vec<Topic> {
        match self {
            // A fixed peg has no channels for its motion.
            Self::Scenario(scenario) => Topic::all_with(scenario.model.support).collect(),
            Self::Recording(recording) => recording.topics(),
        }
    }

    /// Whether the run has a channel with this topic.
    pub fn has_topic(self, topic: Topic) -> bool {
        self.topics().contains(&topic)
    }

    /// Whether toprise made the run. Foreign files are compared by bytes.
    pub fn is_ours(self) -> bool {
        match self {
            Self::Scenario(_) => true,
            Self::Recording(recording) => recording.is_ours(),
        }
    }

    /// Whether parts of the run are known to be missing.
    pub(crate) fn is_cut(self) -> bool {
        self.condition()
            .is_some_and(|condition| !matches!(condition, Condition::Whole | Condition::Foreign))
    }

    /// The kind of file; none for a scenario.
    fn condition(self) -> Option<Condition> {
        match self {
            Self::Scenario(_) => None,
            Self::Recording(recording) => Some(recording.condition()),
        }
    }
}

fn simulate(
    scenario: &Scenario,
    topics: &Topics,
    take: &mut dyn FnMut(&Message<'_>, u64) -> bool,
) -> ReadEnd {
    let mut run = match RunMessages::new(scenario, topics) {
        Ok(run) => run,
        Err(error) => {
            return ReadEnd {
                losses: vec![format!("missing the motion: {error}")],
                ..ReadEnd::default()
            };
        }
    };
    let mut losses = Vec::new();
    let mut wants_more = true;
    while wants_more
        && let Some(record) = run.next(|message| {
            // A record may have several messages, and all that is left of it are passed here.
            wants_more = wants_more && take(message, 0);
            Ok::<_, RunError>(())
        })
    {
        if let Err(error) = record {
            losses.push(format!("missing the rest of the motion: {error}"));
        }
    }
    ReadEnd {
        // The same entries as in a recording, so that no reader has to tell the two apart.
        end: Some(end_entries(&run.end())),
        losses,
        ..ReadEnd::default()
    }
}

//! Two runs that are compared, in one recording: the entities of each, below `/a` and `/b`, and their
//! difference, below `/diff`, with the logarithms of its magnitude below `/diff_log10`.

use std::fs::File;

use rerun::TextDocument;

use super::blueprint::pair as blueprint;
use super::destination::Outlet;
use super::entities::{Entities, Plots};
use super::look::Look;
use super::scene::{self, POSE};
use super::{Destinations, Geometry, Identity, Playback, RerunError, open};
use crate::physics::math;
use crate::telemetry::proportions::Proportions;
use crate::telemetry::side::Side;
use crate::telemetry::{Leaf, Message, channels};

/// What a recording of two runs says about itself.
#[derive(Debug, Clone, PartialEq)]
pub struct PairIdentity {
    /// Recordings with the same identifier are one recording to a viewer.
    pub recording_id: String,
    /// The name that a viewer shows.
    pub name: String,
    /// The first run.
    pub a: Identity,
    /// The second run, from which the first is subtracted.
    pub b: Identity,
    /// What a viewer does at first.
    pub playback: Playback,
}

impl PairIdentity {
    /// One of the runs.
    pub(super) fn run(&self, side: Side) -> &Identity {
        match side {
            Side::A => &self.a,
            Side::B => &self.b,
        }
    }

    /// What a run is called: its letter, if its name doesn't tell it from the other.
    pub(super) fn name_of(&self, side: Side) -> &str {
        match side {
            _ if self.a.name != self.b.name => &self.run(side).name,
            Side::A => "A",
            Side::B => "B",
        }
    }

    /// How the entities of a run look.
    pub(super) fn look(&self, side: Side) -> Look {
        Look::Compared(side, self.name_of(side).to_owned())
    }

    /// Whether there will be differences of an entity: both runs have it, row by row.
    pub(super) fn has_difference_of(&self, entity: &str) -> bool {
        let topic = entity.rsplit_once('/').map_or(entity, |(topic, _)| topic);
        let channel = channels().iter().find(|channel| channel.topic == topic);
        channel.is_some_and(|channel| channel.is_sampled || topic == "/top/nutation")
            && self.a.has_topic(topic)
            && self.b.has_topic(topic)
    }

    /// Whether there will be logarithms of these differences: the layout shows them, and the entity is one
    /// number. A row of several could not leave out those that are zero.
    pub(super) fn has_magnitude_of(&self, entity: &str) -> bool {
        let in_plot = |topic: &str, leaf: &Leaf| format!("{topic}/{}", leaf.plot) == entity;
        let numbers = channels().iter().flat_map(|channel| {
            let leaves = channel.numbers.iter();
            leaves.filter(move |leaf| in_plot(channel.topic, leaf))
        });
        self.has_difference_of(entity) && blueprint::compares(entity) && numbers.count() == 1
    }

    /// The larger of the tops that are drawn.
    fn stage(&self) -> Option<&Geometry> {
        let drawn = [&self.a, &self.b].into_iter();
        let drawn = drawn.filter(|run| run.has_topic(POSE));
        drawn
            .map(|run| &run.geometry)
            .max_by(|one, other| height(one).total_cmp(&height(other)))
    }

    /// The proportions of that top.
    pub(super) fn stage_proportions(&self) -> Option<Proportions> {
        self.stage().map(|geometry| Proportions::new(&geometry.top))
    }

    /// A run with the scales of the stronger friction and the faster slip, so that arrows of both can be
    /// compared.
    fn with_common_scales(&self, side: Side) -> Identity {
        let run = self.run(side);
        let (a, b) = (&self.a.geometry, &self.b.geometry);
        Identity {
            geometry: Geometry {
                top: run.geometry.top,
                force_scale: a.force_scale.max(b.force_scale),
                torque_scale: a.torque_scale.max(b.torque_scale),
                slip_scale: a.slip_scale.max(b.slip_scale),
            },
            ..run.clone()
        }
    }

    /// Which run is which, in Markdown.
    fn key(&self) -> String {
        format!(
            "**A** is `{}`: blue, the solid top. **B** is `{}`: orange, the translucent top. \
             Differences are B − A.\n\n",
            self.a.name, self.b.name
        )
    }
}

/// The height of a drawn top in m.
fn height(geometry: &Geometry) -> f64 {
    Proportions::new(&geometry.top).tip
}

/// Writes the messages of two runs, and their differences, into one Rerun recording.
pub struct PairSink {
    outlet: Outlet,
    a: Entities,
    b: Entities,
    difference: Difference,
    key: String,
}

impl PairSink {
    /// Opens the destinations and sends what doesn't change: layout, names, the scene's bodies.
    ///
    /// A viewer that isn't there is no error but a warning: see [`Self::take_warnings`].
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn new(identity: &PairIdentity, destinations: Destinations) -> Result<Self, RerunError> {
        let layout = blueprint::messages(identity)?;
        let (id, name) = (&identity.recording_id, &identity.name);
        let mut outlet = open(id, name, destinations, &layout)?;
        if let Some(geometry) = identity.stage() {
            scene::furnish(geometry, &Proportions::new(&geometry.top), &mut outlet)?;
        }
        let mut entities = |side| {
            let run = identity.with_common_scales(side);
            Entities::new(&run, &identity.look(side), &mut outlet)
        };
        let (a, b) = (entities(Side::A)?, entities(Side::B)?);
        let mut sink = Self {
            a,
            b,
            difference: Difference::new(identity, &mut outlet)?,
            key: identity.key(),
            outlet,
        };
        // Until the comparison has ended there is only the key to the colours.
        sink.summarize("")?;
        Ok(sink)
    }

    /// Takes a message of one run. Each run's come in the order of time; the runs take turns as they like.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&mut self, side: Side, message: &Message<'_>) -> Result<(), RerunError> {
        let run = match side {
            Side::A => &mut self.a,
            Side::B => &mut self.b,
        };
        run.write(message, &mut self.outlet)
    }

    /// Takes the differences B − A of the numbers of a channel, at the time of A; its texts don't matter.
    ///
    /// Channels that are neither sampled nor `/top/nutation` are passed over.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn difference(&mut self, message: &Message<'_>) -> Result<(), RerunError> {
        self.difference.write(message, &mut self.outlet)
    }

    /// Shows how the comparison ended, in Markdown, instead of what was there before.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn summarize(&mut self, markdown: &str) -> Result<(), RerunError> {
        let text = TextDocument::from_markdown(format!("{}{markdown}", self.key));
        self.outlet.send_static(blueprint::SUMMARY, &text)
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
    /// Gives back the file, written but not synced, and the warnings that were not taken yet.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self) -> Result<(Option<File>, Vec<String>), RerunError> {
        self.a.complete(&mut self.outlet)?;
        self.b.complete(&mut self.outlet)?;
        self.difference.complete(&mut self.outlet)?;
        self.outlet.finish()
    }
}

/// The differences of two runs.
struct Difference {
    plain: Plots,
    magnitude: Plots,
}

impl Difference {
    fn new(identity: &PairIdentity, outlet: &mut Outlet) -> Result<Self, RerunError> {
        let entity = |topic: &str, plot: &str| format!("{topic}/{plot}");
        let plain = |topic: &str, plot: &str| identity.has_difference_of(&entity(topic, plot));
        let magnitude = |topic: &str, plot: &str| identity.has_magnitude_of(&entity(topic, plot));
        Ok(Self {
            plain: Plots::new(plain, &Look::Difference, outlet)?,
            magnitude: Plots::new(magnitude, &Look::Magnitude, outlet)?,
        })
    }

    fn write(&mut self, message: &Message<'_>, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.plain.write(message, outlet)?;
        let magnitude = |number: f64| (number != 0.0).then(|| math::log10(number.abs()));
        self.magnitude.write_some(message, magnitude, outlet)
    }

    fn complete(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.plain.complete(outlet)?;
        self.magnitude.complete(outlet)
    }
}

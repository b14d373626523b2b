//! The entities of one run: what it is in words, its plots, its events and its scene.

use rerun::{Color, TextDocument, TextLog};

use super::destination::Outlet;
use super::look::Look;
use super::scene::{self, Scene};
use super::track::{Numbers, Texts, Track};
use super::{Identity, RerunError, arrow, blueprint, style};
use crate::telemetry::{ChannelInfo, Leaf, Message, channels};

/// The entities of one run, fed with its messages.
pub(super) struct Entities {
    plots: Plots,
    events: Option<EventTrack>,
    scene: Option<Scene>,
}

impl Entities {
    /// Sends what doesn't change: what there is to say about the run, names, the scene's bodies.
    pub(super) fn new(
        identity: &Identity,
        look: &Look,
        outlet: &mut Outlet,
    ) -> Result<Self, RerunError> {
        describe(identity, look, outlet)?;
        if let Look::Compared(_, run) = look
            && identity.has_topic(blueprint::EVENTS)
        {
            mark_events(run, look, outlet)?;
        }
        let has_scene = identity.has_topic(scene::POSE);
        Ok(Self {
            plots: Plots::new(|topic, _| identity.has_topic(topic), look, outlet)?,
            events: EventTrack::find(channels(), look),
            scene: has_scene
                .then(|| Scene::new(identity, look, channels(), outlet))
                .transpose()?,
        })
    }

    /// Takes a message of the run.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        outlet: &mut Outlet,
    ) -> Result<(), RerunError> {
        self.plots.write(message, outlet)?;
        if let Some(events) = &mut self.events {
            events.write(message, outlet)?;
        }
        if let Some(scene) = &mut self.scene {
            scene.write(message, outlet)?;
        }
        Ok(())
    }

    /// Shows the viewer what it does not have yet.
    pub(super) fn show(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.plots.show(outlet)?;
        if let Some(events) = &mut self.events {
            events.show(outlet)?;
        }
        if let Some(scene) = &mut self.scene {
            scene.show(outlet)?;
        }
        Ok(())
    }

    /// Sends all that is left.
    pub(super) fn complete(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.plots.complete(outlet)?;
        if let Some(events) = &mut self.events {
            events.complete(outlet)?;
        }
        if let Some(scene) = &mut self.scene {
            scene.complete(outlet)?;
        }
        Ok(())
    }
}

/// Sends what there is to say about the run.
fn describe(identity: &Identity, look: &Look, outlet: &mut Outlet) -> Result<(), RerunError> {
    let mut text = identity.description.clone();
    if identity.has_topic(scene::POSE) {
        text += &arrow::explanation(identity, look);
    }
    let about = TextDocument::from_markdown(text);
    outlet.send_static(look.entity(blueprint::ABOUT), &about)
}

/// Sends whose events they are: the list that shows both runs' has a column for their "level".
fn mark_events(run: &str, look: &Look, outlet: &mut Outlet) -> Result<(), RerunError> {
    let mark = TextLog::update_fields()
        .with_level(run)
        .with_color(Color::from_u32(look.color(u32::MAX, 0)));
    [blueprint::EVENTS, blueprint::NUTATION_EVENTS]
        .iter()
        .try_for_each(|path| outlet.send_static(look.entity(path), &mark))
}

/// The plots of all channels, in table order.
pub(super) struct Plots(Vec<Vec<PlotTrack>>);

/// One plot of a channel.
struct PlotTrack {
    leaves: Vec<usize>,
    track: Track<Numbers>,
}

impl Plots {
    /// The plots, by topic and name, that are `wanted`. Sends their names and colours.
    pub(super) fn new(
        wanted: impl Fn(&str, &str) -> bool,
        look: &Look,
        outlet: &mut Outlet,
    ) -> Result<Self, RerunError> {
        let mut all = Vec::new();
        for channel in channels() {
            let topic = channel.topic;
            let mut tracks = Vec::new();
            for (plot, leaves) in grouped(channel) {
                if !wanted(topic, plot) {
                    continue;
                }
                let entity = look.entity(&format!("{topic}/{plot}"));
                let chosen: Vec<&Leaf> = leaves.iter().map(|at| &channel.numbers[*at]).collect();
                outlet.send_static(entity.as_str(), &*style::of_plot(topic, &chosen, look))?;
                let track = Track::new(entity, Numbers::new(leaves.len()));
                tracks.push(PlotTrack { leaves, track });
            }
            all.push(tracks);
        }
        Ok(Self(all))
    }

    /// Takes the numbers of a message.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        outlet: &mut Outlet,
    ) -> Result<(), RerunError> {
        for plot in self.0.get_mut(message.channel).into_iter().flatten() {
            let row = plot.leaves.iter().map(|leaf| message.numbers[*leaf]);
            plot.track
                .push(outlet, message.time_ns, |rows| rows.extend(row))?;
        }
        Ok(())
    }

    /// Takes what `value` makes of the numbers of a message; rows in which it makes nothing of a number are
    /// left out.
    pub(super) fn write_some(
        &mut self,
        message: &Message<'_>,
        value: impl Fn(f64) -> Option<f64>,
        outlet: &mut Outlet,
    ) -> Result<(), RerunError> {
        for plot in self.0.get_mut(message.channel).into_iter().flatten() {
            let row = plot.leaves.iter().map(|leaf| value(message.numbers[*leaf]));
            if let Some(row) = row.collect::<Option<Vec<_>>>() {
                plot.track
                    .push(outlet, message.time_ns, |rows| rows.extend(row.into_iter()))?;
            }
        }
        Ok(())
    }

    fn show(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        let mut plots = self.0.iter_mut().flatten();
        plots.try_for_each(|plot| plot.track.show(outlet))
    }

    /// Sends all that is left.
    pub(super) fn complete(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        let mut plots = self.0.iter_mut().flatten();
        plots.try_for_each(|plot| plot.track.complete(outlet))
    }
}

/// The plots of a channel with their leaves, both in table order.
fn grouped(channel: &ChannelInfo) -> Vec<(&'static str, Vec<usize>)> {
    let mut plots: Vec<(&'static str, Vec<usize>)> = Vec::new();
    for (index, leaf) in channel.numbers.iter().enumerate() {
        match plots.iter_mut().find(|(plot, _)| *plot == leaf.plot) {
            Some((_, leaves)) => leaves.push(index),
            None => plots.push((leaf.plot, vec![index])),
        }
    }
    plots
}

/// The events, as sentences. Nutation extremes, hundreds of them, are an entity of their own: they would
/// bury the others in a log.
struct EventTrack {
    channel: usize,
    name: usize,
    description: usize,
    track: Track<Texts>,
    nutation: Track<Texts>,
}

impl EventTrack {
    fn find(channels: &[ChannelInfo], look: &Look) -> Option<Self> {
        let topic = blueprint::EVENTS;
        let channel = channels.iter().position(|channel| channel.topic == topic)?;
        let text = |path| {
            channels[channel]
                .texts
                .iter()
                .position(|leaf| leaf.path == path)
        };
        let track = |path| Track::new(look.entity(path), Texts::default());
        Some(Self {
            channel,
            name: text("name")?,
            description: text("description")?,
            track: track(topic),
            nutation: track(blueprint::NUTATION_EVENTS),
        })
    }

    fn write(&mut self, message: &Message<'_>, outlet: &mut Outlet) -> Result<(), RerunError> {
        if message.channel != self.channel {
            return Ok(());
        }
        let (name, description) = (&message.texts[self.name], &message.texts[self.description]);
        let track = if name.starts_with("nutation") {
            &mut self.nutation
        } else {
            &mut self.track
        };
        track.push(outlet, message.time_ns, |rows| {
            rows.push(description.clone());
        })
    }

    fn complete(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.track.complete(outlet)?;
        self.nutation.complete(outlet)
    }

    fn show(&mut self, outlet: &mut Outlet) -> Result<(), RerunError> {
        self.track.show(outlet)?;
        self.nutation.show(outlet)
    }
}

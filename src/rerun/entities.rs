//! The entities of one run: its description, its plots, its events and its scene.

use nalgebra::Vector3;
use rerun::TextDocument;

use super::blueprint;
use super::entity::ABOUT;
use super::events::Events;
use super::identity::Identity;
use super::look::Look;
use super::outlet::{Outlet, To};
use super::plots::Plots;
use super::scene::Scene;
use super::scene::{arrow, contact_path};
use super::track::{Collect, Content, Flush};
use crate::telemetry::Message;
use crate::telemetry::fields::{EVENTS, POSE};

/// The entities of one run, fed with its messages.
pub struct Entities {
    plots: Plots,
    events: Option<Events>,
    scene: Option<Scene>,
}

impl Entities {
    /// Sends what doesn't change: the description, names and colours, the scene's bodies.
    pub(super) fn new(identity: &Identity, look: &Look, outlet: &mut Outlet) -> Self {
        let has_scene = identity.has(POSE);
        let mut about = identity.description.clone();
        if has_scene {
            about += &arrow::explanation(identity, look);
            if identity.geometry.is_free {
                about += contact_path::EXPLANATION;
            }
        }
        outlet.send_static(look.entity(ABOUT), &TextDocument::from_markdown(about));
        Self {
            plots: Plots::new(|plot| identity.has(plot.topic()), look, outlet),
            events: identity
                .has(EVENTS)
                .then(|| Events::new(identity.geometry.top, look, outlet)),
            scene: has_scene.then(|| Scene::new(identity, look, outlet)),
        }
    }

    /// Centre of the peg as it is drawn, in the world frame, m; none without a scene.
    pub(super) fn peg(&self) -> Option<Vector3<f64>> {
        self.scene.as_ref().map(Scene::peg)
    }

    /// Adds the content of a message of the run.
    pub(super) fn write(&mut self, message: &Message<'_>, outlet: &mut Outlet) {
        self.plots.write(message, Some, outlet);
        if let Some(events) = &mut self.events {
            events.write(message, outlet);
        }
        if let Some(scene) = &mut self.scene {
            scene.write(message, outlet);
        }
    }
}

impl Content for Entities {
    /// In the file only: a viewer has been playing the run.
    fn change_layout(&self, duration: f64, outlet: &mut Outlet) {
        for message in blueprint::run::messages_at_end(outlet.store(), duration) {
            outlet.send_to(To::File, message);
        }
    }
}

impl Collect for Entities {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.plots.flush(outlet, flush);
        self.events.flush(outlet, flush);
        self.scene.flush(outlet, flush);
    }
}

//! The entities of two runs that are compared: each run below `/a` or `/b`, their difference below `/diff`, the
//! logarithm of its magnitude below `/diff_log10`.

use nalgebra::Vector3;
use rerun::TextDocument;

use super::blueprint;
use super::blueprint::pair::Extent;
use super::entities::Entities;
use super::entity::SUMMARY;
use super::look::Look;
use super::outlet::{Outlet, To};
use super::pair::PairIdentity;
use super::plots::Plots;
use super::scene;
use super::scene::focus::Focus;
use super::track::{Collect, Content, Flush};
use crate::physics::math;
use crate::telemetry::Message;
use crate::telemetry::fields::POSE;
use crate::telemetry::side::Side;

/// The entities of two runs, fed with their messages.
pub struct Comparison {
    a: Entities,
    b: Entities,
    difference: Plots,
    magnitude: Plots,
    /// Between the two, where one of them travels.
    focus: Option<Focus>,
    identity: PairIdentity,
    /// Time of the latest message, ns.
    end_ns: u64,
}

impl Comparison {
    /// Sends what doesn't change: what both runs share, and what [`Entities::new`] sends of each.
    pub(super) fn new(identity: &PairIdentity, outlet: &mut Outlet) -> Self {
        let stage = identity.stage();
        if let Some(geometry) = &stage {
            scene::furnish(geometry, outlet);
        }
        let travels = stage.filter(|geometry| geometry.is_free);
        let focus = travels.map(|geometry| Focus::new(&geometry, outlet));
        let mut entities = |side| {
            let run = identity.with_common_scales(side);
            Entities::new(&run, &identity.look(side), outlet)
        };
        let (a, b) = (entities(Side::A), entities(Side::B));
        let difference = |plot| identity.has_difference_of(plot);
        let magnitude = |plot| identity.has_magnitude_of(plot);
        let comparison = Self {
            a,
            b,
            difference: Plots::new(difference, &Look::Difference, outlet),
            magnitude: Plots::new(magnitude, &Look::Magnitude, outlet),
            focus,
            identity: identity.clone(),
            end_ns: 0,
        };
        // Until the comparison has ended there is only the key to the colours.
        comparison.summarize("", outlet);
        comparison
    }

    /// Takes a message of one run.
    pub(super) fn write(&mut self, side: Side, message: &Message<'_>, outlet: &mut Outlet) {
        self.end_ns = self.end_ns.max(message.time_ns);
        match side {
            Side::A => self.a.write(message, outlet),
            Side::B => self.b.write(message, outlet),
        }
        if let Some(focus) = &mut self.focus
            && message.topic() == POSE
        {
            let pegs = [self.a.peg(), self.b.peg()].into_iter().flatten();
            let (sum, count) = pegs.fold((Vector3::zeros(), 0.0), |(sum, count), peg| {
                (sum + peg, count + 1.0)
            });
            focus.write(message.time_ns, sum / count, outlet);
        }
    }

    /// Takes the differences of the numbers of a channel.
    pub(super) fn write_difference(&mut self, message: &Message<'_>, outlet: &mut Outlet) {
        // Zero has no logarithm.
        let magnitude = |number: f64| (number != 0.0).then(|| math::log10(number.abs()));
        self.difference.write(message, Some, outlet);
        self.magnitude.write(message, magnitude, outlet);
    }

    /// Replaces the text on the comparison, in Markdown.
    pub(super) fn summarize(&self, text: &str, outlet: &mut Outlet) {
        let text = TextDocument::from_markdown(format!("{}{text}", self.identity.key()));
        outlet.send_static(SUMMARY, &text);
    }
}

impl Content for Comparison {
    fn change_layout(&self, duration: f64, outlet: &mut Outlet) {
        let differences = &self.difference;
        let extent = Extent {
            duration,
            differences,
        };
        for message in blueprint::pair::messages(&self.identity, Some(&extent)) {
            outlet.send_to(To::Both, message);
        }
    }
}

impl Collect for Comparison {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        if let Flush::All = flush {
            self.difference.reach(self.end_ns, outlet);
            self.magnitude.reach(self.end_ns, outlet);
        }
        self.a.flush(outlet, flush);
        self.b.flush(outlet, flush);
        self.difference.flush(outlet, flush);
        self.magnitude.flush(outlet, flush);
        self.focus.flush(outlet, flush);
    }
}

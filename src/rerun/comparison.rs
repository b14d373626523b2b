//! The entities of two runs that are compared: each run below `/a` or `/b`, their difference below `/diff`, the
//! logarithm of its magnitude below `/diff_log10`.

use rerun::TextDocument;

use super::entities::Entities;
use super::entity::SUMMARY;
use super::look::Look;
use super::outlet::Outlet;
use super::pair::PairIdentity;
use super::plots::Plots;
use super::scene;
use super::track::{Collect, Flush};
use crate::physics::math;
use crate::telemetry::Message;
use crate::telemetry::side::Side;

/// The entities of two runs, fed with their messages.
pub struct Comparison {
    a: Entities,
    b: Entities,
    difference: Plots,
    magnitude: Plots,
    /// Which run is which, in Markdown.
    key: String,
}

impl Comparison {
    /// Sends what doesn't change: what both runs share, and what [`Entities::new`] sends of each.
    pub(super) fn new(identity: &PairIdentity, outlet: &mut Outlet) -> Self {
        if let Some(geometry) = identity.stage() {
            scene::furnish(&geometry, outlet);
        }
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
            key: identity.key(),
        };
        // Until the comparison has ended there is only the key to the colours.
        comparison.summarize("", outlet);
        comparison
    }

    /// Takes a message of one run.
    pub(super) fn write(&mut self, side: Side, message: &Message<'_>, outlet: &mut Outlet) {
        match side {
            Side::A => self.a.write(message, outlet),
            Side::B => self.b.write(message, outlet),
        }
    }

    /// Takes the differences of the numbers of a channel.
    pub(super) fn write_difference(&mut self, message: &Message<'_>, outlet: &mut Outlet) {
        // Zero has no logarithm.
        let magnitude = |number: f64| (number != 0.0).then(|| math::log10(number.abs()));
        self.difference.write(message, Some, outlet);
        self.magnitude.write(message, magnitude, outlet);
    }

    /// Replaces what there is to say about the comparison, in Markdown.
    pub(super) fn summarize(&self, text: &str, outlet: &mut Outlet) {
        let text = TextDocument::from_markdown(format!("{}{text}", self.key));
        outlet.send_static(SUMMARY, &text);
    }
}

impl Collect for Comparison {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.a.flush(outlet, flush);
        self.b.flush(outlet, flush);
        self.difference.flush(outlet, flush);
        self.magnitude.flush(outlet, flush);
    }
}

//! The recording of two runs that are compared: each run below `/a` or `/b`, their difference below `/diff`, the
//! logarithm of its magnitude below `/diff_log10`.

use crate::run::time::seconds;
use rerun::TextDocument;

use super::run::Entities;
use super::stream::{Stream, StreamContent};
use crate::physics::math;
use crate::rerun::blueprint;
use crate::rerun::blueprint::charts::compares;
use crate::rerun::blueprint::pair::Extent;
use crate::rerun::entity::SUMMARY;
use crate::rerun::output::{Destination, Destinations, Output};
use crate::rerun::pair::PairIdentity;
use crate::rerun::plots::Plots;
use crate::rerun::plots::curves::Curves;
use crate::rerun::role::Role;
use crate::rerun::scene::log_stage;
use crate::rerun::style::legible;
use crate::telemetry::Message;
use crate::telemetry::side::Side;

/// A sink that makes one Rerun recording of two runs and their differences.
pub type PairSink = Stream<Comparison>;

/// The entities of two runs, fed with their messages.
pub struct Comparison {
    /// Those of A and B.
    runs: [Entities; 2],
    /// Times of their last messages, ns.
    ends_ns: [u64; 2],
    difference: Plots,
    magnitude: Plots,
    identity: PairIdentity,
}

impl Stream<Comparison> {
    /// Opens the destinations and sends static content: layout, names, the scene's bodies.
    pub fn new(identity: &PairIdentity, destinations: Destinations) -> Self {
        Self::open(identity.store(), &identity.name, destinations, |output| {
            output.send_layout(Destination::Both, blueprint::pair::messages(identity, None));
            Comparison::new(identity, output)
        })
    }

    /// Adds a message of one run. The messages of each run must be in time order; the runs may be interleaved freely.
    pub fn write(&mut self, side: Side, message: &Message<'_>) {
        self.end_ns = self.end_ns.max(message.time_ns);
        let (content, output) = (&mut self.content, &mut self.output);
        content.runs[side.index()].write(message, output);
        content.ends_ns[side.index()] = message.time_ns;
    }

    /// Adds the differences B − A of the numbers of a message, at the time of A; texts are ignored.
    ///
    /// Channels that are neither sampled nor `/top/nutation` are ignored.
    pub fn difference(&mut self, message: &Message<'_>) {
        let (content, output) = (&mut self.content, &mut self.output);
        content.difference.write(message, Some, output);
        content.magnitude.write(message, log_magnitude, output);
    }

    /// Replaces the summary of the comparison, which is Markdown.
    pub fn summarize(&mut self, markdown: &str) {
        self.content.summarize(markdown, &mut self.output);
    }
}

impl Comparison {
    /// Sends static data: shared entities and those of each run.
    fn new(identity: &PairIdentity, output: &mut Output) -> Self {
        if let Some(geometry) = identity.common_geometry() {
            log_stage(&geometry, output);
        }
        let runs = Side::BOTH.map(|side| {
            let run = identity.with_common_scale(side);
            Entities::new(&run, &Role::Compared(side), output)
        });
        let comparison = Self {
            runs,
            ends_ns: [0; 2],
            difference: Plots::new(
                |plot| {
                    identity.has_difference_of(Curves::Field(plot)) && compares(Curves::Field(plot))
                },
                &Role::Difference,
                output,
            ),
            magnitude: Plots::new(
                |plot| identity.has_magnitude_of(Curves::Field(plot)),
                &Role::Magnitude,
                output,
            ),
            identity: identity.clone(),
        };
        // Until the comparison ends, the summary contains only the colour key.
        comparison.summarize("", output);
        comparison
    }

    fn summarize(&self, text: &str, output: &mut Output) {
        let text = format!("{}{}", self.identity.key(), legible(text));
        let text = TextDocument::from_markdown(text);
        output.send_static(SUMMARY, &text);
    }
}

/// The decimal logarithm of a number's magnitude; zero has none.
fn log_magnitude(number: f64) -> Option<f64> {
    (number != 0.0).then(|| math::log10(number.abs()))
}

impl StreamContent for Comparison {
    fn finish(&mut self, end_ns: u64, output: &mut Output) {
        // All charts share one time axis, and the differences end with the shorter run.
        self.difference.extend_to(end_ns, output);
        self.magnitude.extend_to(end_ns, output);
        for (run, own_end_ns) in self.runs.iter_mut().zip(self.ends_ns) {
            run.summarize_events(output);
            if own_end_ns < end_ns {
                run.end(own_end_ns, output);
            }
        }
        output.complete();
        let extent = Extent {
            duration: seconds(end_ns),
            runs: [0, 1].map(|run| self.runs[run].plots()),
            differences: &self.difference,
            logarithms: &self.magnitude,
        };
        let layout = blueprint::pair::messages(&self.identity, Some(&extent));
        output.send_layout(Destination::Both, layout);
    }
}

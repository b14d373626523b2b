//! ROS 2 channels for viewers.
//!
//! Rerun creates views automatically only for ROS 2 messages; Foxglove and Lichtblick support them, too. Some
//! quantities are therefore duplicated in that form at 100 Hz: shape and pose of the top, arrows, plots and the
//! event log. These channels are derived from the table and not part of the content digest.
//!
//! Nutating quantities are followed by their minimum and maximum in the last nutation, because viewers that average the
//! values of a pixel (Rerun from 0.41) would hide the nutation. As all views they follow from recorded topics: without
//! `/top/nutation` nutating quantities have no ranges.
//!
//! Rerun creates one plot per array of a `JointState`, one per `Float64MultiArray` (named after its topic), and at most
//! eight plots. It draws `MagneticField` as an arrow, and no `MarkerArray`; Foxglove and Lichtblick draw that, and no
//! `MagneticField`.

mod cdr;
mod envelope;
mod markers;
mod urdf;

use self::cdr::Cdr;
use self::envelope::Envelope;
use self::urdf::urdf;
use super::arrows::snapshot::{Snapshot, SnapshotReader};
use super::arrows::{Arrow, SampleArrows, Scales};
use super::event::recorded_sentence;
use super::fields::{
    CONTACT, EVENTS, NUTATION, POSE, STATE, TORQUE, contact, events, pose, state, torque,
};
use super::message::Message;
use super::proportions::Proportions;
use super::table::channels;
use super::topic::Topic;
use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::run::simulation::EventKind;
use nalgebra::Vector3;

/// Level of all log messages.
const INFO: u8 = 20;

/// Minimum time between two messages of a view, ns.
const PERIOD_NS: u64 = 10_000_000;

/// Number of views from one message of all arrows to the next: they are large, and 20 Hz are enough to see them move.
const ARROWS_STRIDE: u32 = 5;

/// A channel for viewers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ViewChannel {
    /// Topic.
    pub topic: &'static str,
    /// Name of the message type in ROS 2.
    pub schema: &'static str,
    /// The definition (`ros2msg`).
    pub definition: &'static str,
    /// Description of the channel.
    pub meaning: &'static str,
    /// Whether the channel exists only for a free peg.
    pub is_free_peg_only: bool,
    /// Source topics; a view message is emitted with each message of the last one.
    sources: &'static [Topic],
    kind: ViewKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ViewKind {
    Description,
    Transforms,
    Inclination,
    PrecessionRate,
    SpinRate,
    SlipSpeed,
    SlipVelocity,
    FrictionTorque,
    Arrows,
    NormalForce,
    Log,
}

impl ViewKind {
    /// The arrow that the view shows, if it shows one.
    fn arrow(self) -> Option<Arrow> {
        match self {
            Self::SlipVelocity => Some(Arrow::SlipVelocity),
            Self::FrictionTorque => Some(Arrow::FrictionTorque),
            Self::Description
            | Self::Transforms
            | Self::Inclination
            | Self::PrecessionRate
            | Self::SpinRate
            | Self::SlipSpeed
            | Self::Arrows
            | Self::NormalForce
            | Self::Log => None,
        }
    }
}

// The definitions are those of ROS 2, because readers find the fields by them.

const STRING: (&str, &str) = ("std_msgs/msg/String", include_str!("views/String.msg"));
const TRANSFORMS: (&str, &str) = (
    "tf2_msgs/msg/TFMessage",
    include_str!("views/TFMessage.msg"),
);
const JOINT: (&str, &str) = (
    "sensor_msgs/msg/JointState",
    include_str!("views/JointState.msg"),
);
const NUMBERS: (&str, &str) = (
    "std_msgs/msg/Float64MultiArray",
    include_str!("views/Float64MultiArray.msg"),
);
const FIELD: (&str, &str) = (
    "sensor_msgs/msg/MagneticField",
    include_str!("views/MagneticField.msg"),
);
const MARKERS: (&str, &str) = (
    "visualization_msgs/msg/MarkerArray",
    include_str!("views/MarkerArray.msg"),
);
const LOG: (&str, &str) = ("rcl_interfaces/msg/Log", include_str!("views/Log.msg"));

const fn view(
    kind: ViewKind,
    topic: &'static str,
    (schema, definition): (&'static str, &'static str),
    sources: &'static [Topic],
    meaning: &'static str,
) -> ViewChannel {
    ViewChannel {
        topic,
        schema,
        definition,
        meaning,
        is_free_peg_only: false,
        sources,
        kind,
    }
}

impl ViewChannel {
    /// A view that exists only for a free peg.
    const fn free_peg_only(self) -> Self {
        Self {
            is_free_peg_only: true,
            ..self
        }
    }
}

/// All channels for viewers.
#[rustfmt::skip]
pub const VIEW_CHANNELS: &[ViewChannel] = &[
    view(ViewKind::Description, "/robot_description", STRING, &[POSE],
        "shape of the top as URDF, and a legend of these channels; sent once"),
    view(ViewKind::Transforms, "/tf", TRANSFORMS, &[POSE],
        "frames `top` (body axes) and `contact` in `world`, m"),
    view(ViewKind::Inclination, "/view/inclination", JOINT, &[STATE, TORQUE],
        "θ in rad, θ̇ in rad/s, and as effort the total torque about the line of nodes in N m, \
         each with its minimum and maximum in the last nutation (of the torque's samples)"),
    view(ViewKind::PrecessionRate, "/view/precession_rate", NUMBERS, &[STATE],
        "φ̇, and its minimum and maximum in the last nutation, rad/s"),
    view(ViewKind::SpinRate, "/view/spin_rate", NUMBERS, &[STATE],
        "ψ̇, and its minimum and maximum in the last nutation, rad/s"),
    view(ViewKind::SlipSpeed, "/view/slip_speed", NUMBERS, &[CONTACT], "slip speed, m/s"),
    view(ViewKind::SlipVelocity, "/view/slip_velocity", FIELD, &[CONTACT],
        "arrow of the slip velocity in frame `contact`; its scale is in the legend"),
    view(ViewKind::FrictionTorque, "/view/friction_torque", FIELD, &[TORQUE],
        "arrow of the friction torque in frame `top`; its scale is in the legend"),
    view(ViewKind::Arrows, "/view/arrows", MARKERS, &[POSE],
        "all arrows of a sample with their symbols, in frame `world`, 20 Hz; their scales are in the legend"),
    view(ViewKind::NormalForce, "/view/normal_force", NUMBERS, &[CONTACT],
        "normal force of a free peg, N; 0 in the air").free_peg_only(),
    view(ViewKind::Log, "/log", LOG, &[EVENTS], "events (without nutation extremes) as log lines"),
];

/// Generates the view messages from table messages.
#[derive(Clone, Debug)]
pub struct Views {
    top: Top,
    scales: Scales,
    /// The arrows that are drawn.
    arrows: Vec<Arrow>,
    snapshots: SnapshotReader,
    /// The sample whose arrows are due.
    sample: Option<Snapshot>,
    /// Number of samples from one view to the next.
    stride: u32,
    /// For each view, the topic that triggers it; `None` if the view is not written.
    sources: Vec<Option<Topic>>,
    /// The description of the top's shape, until it has been sent.
    description: Option<String>,
    /// θ and θ̇ of the last state.
    state: [f64; 2],
    /// The ranges in the last nutation.
    envelope: Envelope,
    /// Number of values that are written, of value, minimum and maximum: the value alone if nutations are not recorded.
    parts: usize,
    cdr: Cdr,
}

impl Views {
    /// Prepares the views of a run of `scenario`. `is_enabled` returns whether a topic of the table is recorded.
    pub fn new(scenario: &Scenario, is_enabled: impl Fn(Topic) -> bool) -> Self {
        let top = scenario.model.top;
        let is_free = scenario.model.support.is_free();
        let proportions = Proportions::new(&top);
        let scales = Scales::new(scenario);
        let snapshots = SnapshotReader::new(top, is_free, &is_enabled);
        let arrows: Vec<_> = Arrow::ALL
            .into_iter()
            .filter(|arrow| arrow.is_drawn(&scales, &is_enabled))
            .collect();
        let mut sources = Vec::new();
        for view in VIEW_CHANNELS {
            let has_channel = is_free || !view.is_free_peg_only;
            let has_sources = view.sources.iter().all(|topic| is_enabled(*topic));
            let has_scale = (view.kind.arrow()).is_none_or(|arrow| arrow.scale(&scales) > 0.0);
            let is_written = has_channel && has_sources && has_scale;
            // The last source triggers the view: at one time, its message comes after those of the others.
            let last = match view.kind {
                ViewKind::Arrows => snapshots.last(),
                _ => view.sources.last().copied(),
            };
            sources.push(last.filter(|_| is_written));
        }
        let period = scenario.sample_period_ns.max(1);
        Self {
            sources,
            description: Some(urdf(&proportions, &arrows, &scales, is_free)),
            stride: u32::try_from(PERIOD_NS.div_ceil(period)).unwrap_or(u32::MAX),
            state: [f64::NAN; 2],
            envelope: Envelope::new(),
            parts: if is_enabled(NUTATION) { 3 } else { 1 },
            cdr: Cdr::default(),
            top,
            scales,
            arrows,
            snapshots,
            sample: None,
        }
    }

    /// Whether there will be messages of the view with this index.
    pub fn is_enabled(&self, view: usize) -> bool {
        self.sources[view].is_some()
    }

    /// Calls `emit` for each view triggered by a message, with its index in [`VIEW_CHANNELS`], sequence number and
    /// bytes. The time is that of the message.
    pub fn process(&mut self, message: &Message<'_>, mut emit: impl FnMut(usize, u32, &[u8])) {
        self.envelope.update(message);
        if channels()[message.channel].is_sampled {
            if !message.sequence.is_multiple_of(self.stride) {
                return;
            }
            let arrows_stride = self.stride.saturating_mul(ARROWS_STRIDE);
            if message.sequence.is_multiple_of(arrows_stride) {
                self.sample = self.snapshots.take(message).copied();
            }
        }
        if message.topic() == STATE {
            self.state = [state::THETA, state::THETA_DOT].map(|field| field.of(message));
        }
        for (index, view) in VIEW_CHANNELS.iter().enumerate() {
            if self.sources[index] == Some(message.topic()) && self.write(view.kind, message) {
                emit(index, message.sequence, self.cdr.bytes());
            }
        }
    }

    /// Encodes the view of a message into `cdr`. Returns false if the message has no view.
    fn write(&mut self, kind: ViewKind, message: &Message<'_>) -> bool {
        let (cdr, envelope, parts) = (&mut self.cdr, &self.envelope, self.parts);
        let time = message.time_ns;
        cdr.begin();
        match kind {
            ViewKind::Description => {
                let Some(text) = self.description.take() else {
                    return false;
                };
                cdr.string(&text);
            }
            ViewKind::Transforms => {
                let [x, y, z] = pose::PEG_POSITION.of(message).into();
                let turn = pose::ORIENTATION.of(message).coords;
                // Two transforms, each with its parent and child frame.
                cdr.u32(2).header(time, "world").string("top");
                cdr.f64s(&[x, y, z]).f64s(turn.as_slice());
                // The lowest point of the peg.
                let contact = [x, y, z - self.top.peg_radius];
                cdr.header(time, "world").string("contact");
                // Not rotated: the slip velocity has world axes.
                cdr.f64s(&contact).f64s(&[0.0, 0.0, 0.0, 1.0]);
            }
            ViewKind::Inclination => {
                let [theta, theta_dot] = self.state;
                let theta = envelope.around(state::THETA, theta);
                let theta_dot = envelope.around(state::THETA_DOT, theta_dot);
                let torque = envelope.around_torque(torque::TOTAL_NODE.x().of(message));
                let names = ["theta", "minimum in nutation", "maximum in nutation"];
                cdr.header(time, "").u32(parts as u32);
                for name in &names[..parts] {
                    cdr.string(name);
                }
                // ROS 2 asks for arrays of one length.
                for values in [theta, theta_dot, torque] {
                    cdr.sequence(&values[..parts]);
                }
            }
            ViewKind::PrecessionRate => {
                let rate = state::PHI_DOT.of(message);
                plot(cdr, &envelope.around(state::PHI_DOT, rate)[..parts]);
            }
            ViewKind::SpinRate => {
                let rate = state::PSI_DOT.of(message);
                plot(cdr, &envelope.around(state::PSI_DOT, rate)[..parts]);
            }
            ViewKind::SlipSpeed => plot(cdr, &[contact::SLIP_SPEED.of(message)]),
            ViewKind::NormalForce => plot(cdr, &[contact::NORMAL_FORCE.of(message)]),
            ViewKind::SlipVelocity => {
                let slip = contact::SLIP_WORLD.of(message);
                arrow(cdr.header(time, "contact"), slip / self.scales.slip);
            }
            ViewKind::FrictionTorque => {
                let torque = torque::FRICTION_BODY.of(message);
                arrow(
                    cdr.header(time, "top"),
                    torque / self.scales.friction_torque,
                );
            }
            ViewKind::Arrows => {
                let Some(sample) = self.sample.take() else {
                    return false;
                };
                let height = Proportions::new(&self.top).size();
                let drawn = SampleArrows::new(&sample, &self.scales, height);
                markers::write(cdr, time, &self.arrows, &drawn, height);
            }
            ViewKind::Log => {
                let name = events::NAME.of(message);
                if EventKind::find(name).is_some_and(EventKind::is_nutation_extreme) {
                    return false;
                }
                cdr.time(time).u8(INFO).string(name);
                cdr.string(&recorded_sentence(message, &self.top));
                // File, function and line of the logging code: unused.
                cdr.string("").string("").u32(0);
            }
        }
        true
    }
}

/// A `Float64MultiArray` with these elements and no layout.
fn plot(cdr: &mut Cdr, values: &[f64]) {
    // No dimensions, and no offset of the data.
    cdr.u32(0).u32(0).sequence(values);
}

/// The rest of a `MagneticField`: the vector, and no covariance.
fn arrow(cdr: &mut Cdr, vector: Vector3<f64>) {
    // By the definition of the message, a variance of 0 is unknown.
    cdr.f64s(vector.as_slice()).f64s(&[0.0; 9]);
}

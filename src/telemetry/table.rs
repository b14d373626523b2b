//! The channel table: the single definition of recorded data and of the field handles.

pub(super) mod channel;
pub(super) mod frame;
mod info;
pub(super) mod quantity;
mod sampled;

pub use info::channels;

use self::quantity::Quantity::{
    self, Acceleration, Angle, Direction, Energy, Flag, Force, Impulse, Jellett, Length,
    LinearAcceleration, Momentum, Number, Orientation, Power, Rate, ReferenceRate, Text, Time,
    Torque, Velocity,
};
use super::handle::{NumberField, RotationField, TextField, VectorField};
use super::topic::Topic;
use crate::run::simulation::{Event, FreeSample, ImpactRecord, NutationCycle, Sample};
use nalgebra::{UnitQuaternion, Vector3};

/// Version of the telemetry. It is increased if channels, fields or their values change.
///
/// 1. Not stored in recordings.
/// 2. Nutation cycles must have about the nutation period, and include ranges of the rates. New: integrals of the terms
///    of φ̈ and ψ̈, work per axis of the node frame, work of the friction force; views with ranges.
/// 3. Ranges of the rates are exact at impacts. φ and the rates at an exactly vertical axis are limits of the following
///    motion. Drilling friction of a free peg is smoothed.
/// 4. Descriptions of fields, keys and presets are reworded; values are those of version 3.
/// 5. Reversals of the precession and nutation cycles of rounding are omitted: cusps, cycles that an impact begins or ends,
///    half nutations. The slow rate of regular precession of a peg in the air is 0. The efforts of `/view/inclination`
///    are as many as its joints.
/// 6. Events have no description, and scenarios no comments: words are made by the version that reads. Tippe tops have
///    the event `inverts`.
pub const VERSION: u32 = 6;

/// A channel whose messages are made from values of type `S`.
#[derive(Debug)]
pub struct Channel<S: 'static> {
    /// Topic.
    pub topic: &'static str,
    /// Name of the message type.
    pub schema: &'static str,
    /// Description of the channel.
    pub meaning: &'static str,
    /// Whether the channel exists only for a free peg.
    pub is_free_peg_only: bool,
    /// Filter: whether a value produces a message (default: always).
    pub present: Option<fn(&S) -> bool>,
    /// The fields.
    pub fields: &'static [Field<S>],
}

/// A field of a channel. A dot in the name puts it into an object.
#[derive(Debug)]
pub struct Field<S> {
    /// Name.
    pub name: &'static str,
    /// The quantity, which determines the unit.
    pub quantity: Quantity,
    /// Frame of a vector's components; empty for others.
    pub frame: &'static str,
    /// Description, as in schemas.
    pub meaning: &'static str,
    /// Plot name.
    pub plot: &'static str,
    /// Name of the field that is its time derivative, if the channel has it.
    pub derivative: Option<&'static str>,
    /// The function that returns its value.
    pub source: Source<S>,
}

/// The function that returns a field's value from an `S`.
#[derive(Debug)]
pub enum Source<S> {
    /// A number.
    Number(fn(&S) -> f64),
    /// Three numbers x, y, z.
    Vector(fn(&S) -> Vector3<f64>),
    /// Four numbers x, y, z, w.
    Rotation(fn(&S) -> UnitQuaternion<f64>),
    /// A text.
    Text(fn(&S) -> &str),
}

impl<S> Channel<S> {
    /// Restricts the channel to a free peg.
    const fn free_peg_only(mut self) -> Self {
        self.is_free_peg_only = true;
        self
    }

    /// Sets the filter of values.
    const fn present_if(mut self, present: fn(&S) -> bool) -> Self {
        self.present = Some(present);
        self
    }
}

impl<S> Field<S> {
    const fn new(
        name: &'static str,
        quantity: Quantity,
        meaning: &'static str,
        source: Source<S>,
    ) -> Self {
        let (frame, plot, derivative) = ("", name, None);
        Self {
            name,
            quantity,
            frame,
            meaning,
            plot,
            derivative,
            source,
        }
    }

    const fn number(
        name: &'static str,
        quantity: Quantity,
        meaning: &'static str,
        get: fn(&S) -> f64,
    ) -> Self {
        Self::new(name, quantity, meaning, Source::Number(get))
    }

    const fn vector(
        name: &'static str,
        quantity: Quantity,
        frame: &'static str,
        meaning: &'static str,
        get: fn(&S) -> Vector3<f64>,
    ) -> Self {
        let mut field = Self::new(name, quantity, meaning, Source::Vector(get));
        field.frame = frame;
        field
    }

    const fn rotation(
        name: &'static str,
        meaning: &'static str,
        get: fn(&S) -> UnitQuaternion<f64>,
    ) -> Self {
        Self::new(name, Orientation, meaning, Source::Rotation(get))
    }

    const fn text(name: &'static str, meaning: &'static str, get: fn(&S) -> &str) -> Self {
        Self::new(name, Text, meaning, Source::Text(get))
    }

    /// Assigns the field to a shared plot.
    const fn in_plot(mut self, plot: &'static str) -> Self {
        self.plot = plot;
        self
    }

    /// Sets the field that is the time derivative.
    const fn with_derivative(mut self, derivative: &'static str) -> Self {
        self.derivative = Some(derivative);
        self
    }
}

/// The kinds of handles, by the names of the kinds of fields in the table.
#[allow(non_camel_case_types)]
mod handle {
    pub type number = super::NumberField;
    pub type vector = super::VectorField;
    pub type rotation = super::RotationField;
    pub type text = super::TextField;
}

/// The index of a field in messages, among the numbers or the texts.
const fn index<S>(fields: &[Field<S>], place: usize) -> usize {
    // A loop, because iterators don't work in constants.
    let (mut numbers, mut texts, mut at) = (0, 0, 0);
    while at < place {
        match fields[at].source {
            Source::Number(_) => numbers += 1,
            Source::Vector(_) => numbers += 3,
            Source::Rotation(_) => numbers += 4,
            Source::Text(_) => texts += 1,
        }
        at += 1;
    }
    match fields[place].source {
        Source::Text(_) => texts,
        Source::Number(_) | Source::Vector(_) | Source::Rotation(_) => numbers,
    }
}

/// Declares channels, grouped by the source type of their messages. Each becomes a row of a table, a [`Topic`], and a
/// module with the handles of its fields.
macro_rules! channels {
    ($(
        $(#[$doc:meta])*
        $TABLE:ident: $Source:ty {
            $($TOPIC:ident $fields:ident: channel($topic:literal, $schema:literal, $meaning:literal)
                $(.$option:ident($($value:expr)?))* {
                $($HANDLE:ident = $kind:ident($($argument:expr),*)$(.$method:ident($text:literal))*;)*
            })*
        }
    )*) => {
        /// The channels in the order of their indices.
        #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
        enum Order { $($($TOPIC),*),* }

        $(
            $(#[$doc])*
            pub const $TABLE: &[Channel<$Source>] = &[$($fields::CHANNEL),*];

            $(
                #[doc = concat!("`", $topic, "`.")]
                pub const $TOPIC: Topic = Topic::from_index(Order::$TOPIC as usize);

                #[doc = concat!("The fields of `", $topic, "`.")]
                pub mod $fields {
                    use $crate::telemetry::table::*;

                    /// The fields in the order of the channel.
                    #[allow(non_camel_case_types, clippy::upper_case_acronyms)]
                    enum Place { $($HANDLE),* }

                    pub(crate) const CHANNEL: Channel<$Source> = Channel::<$Source> {
                        topic: $topic,
                        schema: $schema,
                        meaning: $meaning,
                        is_free_peg_only: false,
                        present: None,
                        fields: &[$(Field::<$Source>::$kind($($argument),*)$(.$method($text))*),*],
                    }$(.$option($($value)?))*;

                    $(
                        #[doc = concat!("Handle of a field of `", $topic, "`.")]
                        pub const $HANDLE: handle::$kind = {
                            // The discriminants of the enums number channels and fields, so that handles are constants.
                            let place = Place::$HANDLE as usize;
                            let index = index(CHANNEL.fields, place);
                            handle::$kind::new($TOPIC, index, CHANNEL.fields[place].plot)
                        };
                    )*
                }
            )*
        )*
    };
}

channels! {
    /// The channels that have a message for each sample.
    SAMPLES: Sample {
        STATE state: channel("/top/state", "toprise.State",
            "Euler angles (z-x-z), their rates and accelerations; where the axis is exactly vertical, φ and the rates are those with which it leaves the vertical (φ unchanged and φ̇ = 0 if it does not), and φ̈ is 0") {
            PHI = number("phi", Angle, "precession angle φ, about the vertical, unwrapped", |s| s.angles.phi).with_derivative("phi_dot");
            THETA = number("theta", Angle, "nutation angle (inclination) θ, about the line of nodes", |s| s.angles.theta).with_derivative("theta_dot");
            PSI = number("psi", Angle, "spin angle ψ, about the symmetry axis, unwrapped", |s| s.angles.psi).with_derivative("psi_dot");
            PHI_DOT = number("phi_dot", Rate, "precession rate φ̇", |s| s.tilt.rates.phi).with_derivative("phi_ddot");
            THETA_DOT = number("theta_dot", Rate, "nutation rate θ̇", |s| s.tilt.rates.theta).with_derivative("theta_ddot");
            PSI_DOT = number("psi_dot", Rate, "spin rate ψ̇", |s| s.tilt.rates.psi).with_derivative("psi_ddot");
            PHI_DDOT = number("phi_ddot", Acceleration, "precession acceleration φ̈", |s| s.euler_accelerations.phi);
            THETA_DDOT = number("theta_ddot", Acceleration, "nutation acceleration θ̈", |s| s.euler_accelerations.theta);
            PSI_DDOT = number("psi_ddot", Acceleration, "spin acceleration ψ̈", |s| s.euler_accelerations.psi);
        }
        POSE pose: channel("/top/pose", "toprise.Pose",
            "orientation, symmetry axis, angular velocity and position") {
            ORIENTATION = rotation("orientation", "unit quaternion that transforms body components to world components", |s| s.pose.world_from_body);
            AXIS = vector("axis", Direction, frame::WORLD, "direction of the symmetry axis", |s| s.pose.axis);
            OMEGA_BODY = vector("omega_body", Rate, frame::BODY, "angular velocity ω", |s| s.pose.omega_body);
            OMEGA_WORLD = vector("omega_world", Rate, frame::WORLD, "angular velocity ω", |s| s.pose.omega_world);
            PEG_POSITION = vector("peg_position", Length, frame::WORLD, "centre of the peg; the table is z = 0", |s| s.pose.peg_position);
        }
        TORQUE torque: channel("/top/torque", "toprise.Torque",
            "torques about the centre of the peg") {
            GRAVITY_BODY = vector("gravity_body", Torque, frame::BODY, "torque of gravity", |s| s.torque.gravity.body);
            FRICTION_BODY = vector("friction_body", Torque, frame::BODY, "torque of friction and air drag", |s| s.torque.friction.body);
            TOTAL_BODY = vector("total_body", Torque, frame::BODY, "sum of the torques", |s| s.torque.total.body);
            GRAVITY_NODE = vector("gravity_node", Torque, frame::NODE, "torque of gravity", |s| s.torque.gravity.node);
            FRICTION_NODE = vector("friction_node", Torque, frame::NODE, "torque of friction and air drag", |s| s.torque.friction.node);
            TOTAL_NODE = vector("total_node", Torque, frame::NODE, "sum of the torques", |s| s.torque.total.node);
        }
        ACCELERATION acceleration: channel("/top/acceleration", "toprise.Acceleration",
            "terms of the equations of motion, and their time integrals since the start") {
            THETA_DDOT_GYROSCOPIC = number("theta_ddot.gyroscopic", Acceleration, "−(I_z/I_x) φ̇ sin θ (ψ̇ + φ̇ cos θ)", |s| s.accelerations.gyroscopic.theta).in_plot("theta_ddot");
            THETA_DDOT_CENTRIFUGAL = number("theta_ddot.centrifugal", Acceleration, "φ̇² sin θ cos θ", |s| s.accelerations.inertial.theta).in_plot("theta_ddot");
            THETA_DDOT_GRAVITATIONAL = number("theta_ddot.gravitational", Acceleration, "(M g l/I_x) sin θ", |s| s.accelerations.gravitational.theta).in_plot("theta_ddot");
            THETA_DDOT_FRICTIONAL = number("theta_ddot.frictional", Acceleration, "friction torque about the line of nodes, divided by I_x", |s| s.accelerations.frictional.theta).in_plot("theta_ddot");
            PHI_DDOT_GYROSCOPIC = number("phi_ddot.gyroscopic", Acceleration, "(I_z/I_x) θ̇ (ψ̇ + φ̇ cos θ)/sin θ", |s| s.accelerations.gyroscopic.phi).in_plot("phi_ddot");
            PHI_DDOT_CORIOLIS = number("phi_ddot.coriolis", Acceleration, "−2 θ̇ φ̇ cos θ/sin θ", |s| s.accelerations.inertial.phi).in_plot("phi_ddot");
            PHI_DDOT_FRICTIONAL = number("phi_ddot.frictional", Acceleration, "friction term; k M g R ψ̇ cos θ/(I_x |ω_⊥|) in the paper", |s| s.accelerations.frictional.phi).in_plot("phi_ddot");
            PSI_DDOT_GYROSCOPIC = number("psi_ddot.gyroscopic", Acceleration, "−(I_z/I_x) θ̇ (ψ̇ + φ̇ cos θ) cos θ/sin θ", |s| s.accelerations.gyroscopic.psi).in_plot("psi_ddot");
            PSI_DDOT_CORIOLIS = number("psi_ddot.coriolis", Acceleration, "2 θ̇ φ̇ cos² θ/sin θ + θ̇ φ̇ sin θ", |s| s.accelerations.inertial.psi).in_plot("psi_ddot");
            PSI_DDOT_FRICTIONAL = number("psi_ddot.frictional", Acceleration, "friction term; −k M g R ψ̇ (cos² θ/I_x + sin² θ/I_z)/|ω_⊥| in the paper", |s| s.accelerations.frictional.psi).in_plot("psi_ddot");
            PHI_DOT_GYROSCOPIC = number("phi_dot.gyroscopic", Rate, "change of φ̇ since the start due to the gyroscopic term of φ̈", |s| s.integrals.terms.phi_gyroscopic).in_plot("phi_dot");
            PHI_DOT_CORIOLIS = number("phi_dot.coriolis", Rate, "change of φ̇ since the start due to the Coriolis term of φ̈", |s| s.integrals.terms.phi_coriolis).in_plot("phi_dot");
            PHI_DOT_FRICTIONAL = number("phi_dot.frictional", Rate, "change of φ̇ since the start due to the friction term of φ̈", |s| s.integrals.terms.phi_frictional).in_plot("phi_dot");
            PSI_DOT_FRICTIONAL = number("psi_dot.frictional", Rate, "change of ψ̇ since the start due to the friction term of ψ̈", |s| s.integrals.terms.psi_frictional);
        }
        CONTACT contact: channel("/top/contact", "toprise.Contact",
            "slip and forces at the point of contact") {
            SLIP_BODY = vector("slip_body", Velocity, frame::BODY, "slip velocity: velocity of the contact point relative to the table", |s| s.slip.body);
            SLIP_WORLD = vector("slip_world", Velocity, frame::WORLD, "slip velocity: velocity of the contact point relative to the table", |s| s.slip.world);
            SLIP_SPEED = number("slip_speed", Velocity, "magnitude of the slip velocity", |s| s.contact.slip_speed);
            FRICTION_FORCE = vector("friction_force", Force, frame::WORLD, "friction force according to the law; values of friction.dissipation that drop a term of the equations do not change it", |s| s.slip.friction_force);
            NORMAL_FORCE = number("normal_force", Force, "normal force of the table", |s| s.contact.normal_force);
            CONTACT_POINT = vector("contact_point", Length, frame::WORLD, "point of contact", |s| s.slip.contact_point);
            SLIP_PATH = number("slip_path", Length, "slip path length since the start", |s| s.integrals.slip_path);
            REGIME = number("regime", Flag, "1 slipping, 0 sticking or rolling, 2 in the air", |s| s.regime().code());
            SLIP_WORK = number("slip_work", Energy, "work of the friction force along the slip path since the start", |s| s.integrals.slip_work);
        }
        ENERGY energy: channel("/top/energy", "toprise.Energy",
            "energies, and the power and work of friction and air drag") {
            KINETIC = number("kinetic", Energy, "kinetic energy", |s| s.energy.kinetic).in_plot("mechanical");
            POTENTIAL = number("potential", Energy, "potential energy M g z of the centre of mass, zero at the height of the centre of a peg on the table", |s| s.energy.potential);
            TOTAL = number("total", Energy, "total energy", |s| s.energy.total()).in_plot("mechanical");
            FRICTION_POWER = number("friction_power", Power, "power of friction and air drag", |s| s.energy.friction_power);
            FRICTION_WORK = number("friction_work", Energy, "work of friction, air drag and impacts since the start", |s| s.integrals.friction_work);
            FRICTION_WORK_NODE = vector("friction_work_node", Energy, frame::NODE, "work of the torque of friction and air drag about each axis since the start", |s| s.integrals.work_node);
        }
        MOMENTUM momentum: channel("/top/momentum", "toprise.Momentum",
            "angular momentum about the centre of the peg") {
            VERTICAL = number("vertical", Momentum, "about the vertical", |s| s.momentum.vertical).in_plot("components");
            AXIAL = number("axial", Momentum, "about the symmetry axis", |s| s.momentum.axial).in_plot("components");
            WORLD = vector("world", Momentum, frame::WORLD, "angular momentum", |s| s.momentum.world);
        }
        PRECESSION precession: channel("/top/precession", "toprise.Precession",
            "regular precession at the current θ and ψ̇; no message where its rates are not real or not finite").present_if(|s| s.precession.roots.is_some()) {
            SLOW_ROOT = number("slow_root", ReferenceRate, "slow rate of regular precession; 0 in the air, where no torque acts about the centre of mass", |s| s.precession.roots.map_or(f64::NAN, |r| r.slow));
            FAST_ROOT = number("fast_root", ReferenceRate, "fast rate of regular precession; infinite, and not recorded, for equal moments of inertia (a sphere)", |s| s.precession.roots.map_or(f64::NAN, |r| r.fast));
            EXCESS = number("excess", ReferenceRate, "φ̇ minus the slow rate", |s| s.precession.roots.map_or(f64::NAN, |r| s.tilt.rates.phi - r.slow));
            STRENGTH_RATIO = number("strength_ratio", Number, "|a|/√(4 M g |l|/I_x), a = I_z (ψ̇ + φ̇ cos θ)/I_x: below 1 the top is weak; for a free peg, I_x is about the centre of mass, I_x − M l²", |s| s.precession.strength_ratio);
        }
        CENTER_OF_MASS center_of_mass: channel("/top/center_of_mass", "toprise.CenterOfMass",
            "the centre of mass of a top with a free peg").free_peg_only().present_if(|s| s.free.is_some()) {
            POSITION = vector("position", Length, frame::WORLD, "position", |s| of_free(s, |f| f.center));
            VELOCITY = vector("velocity", Velocity, frame::WORLD, "velocity", |s| of_free(s, |f| f.center_velocity));
            ACCELERATION = vector("acceleration", LinearAcceleration, frame::WORLD, "acceleration", |s| of_free(s, |f| f.center_acceleration));
            ANGULAR_MOMENTUM = vector("angular_momentum", Momentum, frame::WORLD, "angular momentum about the centre of mass", |s| of_free(s, |f| f.central_momentum));
        }
        FREE_PEG free_peg: channel("/top/free_peg", "toprise.FreePeg",
            "height, velocity, integrals and energy losses of a free peg").free_peg_only().present_if(|s| s.free.is_some()) {
            GAP = number("gap", Length, "height of the peg above the table", |s| number_of_free(s, |f| f.gap));
            VELOCITY = vector("velocity", Velocity, frame::WORLD, "velocity of the peg's centre", |s| of_free(s, |f| f.peg_velocity));
            JELLETT = number("jellett", Jellett, "Jellett's integral l L_n + R L_z′ about the centre of mass, constant under any force at the point of contact", |s| number_of_free(s, |f| f.jellett));
            ROUTH = number("routh", Momentum, "Routh's integral, constant while a peg rolls without losses", |s| number_of_free(s, |f| f.routh));
            TRANSLATIONAL = number("translational", Energy, "translational kinetic energy (of the centre of mass)", |s| number_of_free(s, |f| f.translational_energy));
            LOST_SLIDING = number("lost.sliding", Energy, "energy dissipated by sliding friction since the start", |s| -s.integrals.slip_work).in_plot("lost");
            LOST_LOSSES = number("lost.losses", Energy, "energy dissipated by rolling resistance, drilling friction and air drag since the start", |s| number_of_free(s, |f| f.dissipated.losses)).in_plot("lost");
            LOST_RESTITUTION = number("lost.restitution", Energy, "energy lost to compression and restitution in impacts since the start", |s| number_of_free(s, |f| f.dissipated.impact_normal)).in_plot("lost");
            LOST_IMPACT_FRICTION = number("lost.impact_friction", Energy, "energy lost to friction in impacts since the start", |s| number_of_free(s, |f| f.dissipated.impact_friction)).in_plot("lost");
            DRIVEN_THETA_DDOT = number("driven.theta_ddot", Acceleration, "contribution of the peg's acceleration to the terms of θ̈", |s| number_of_free(s, |f| f.driven.theta)).in_plot("driven");
            DRIVEN_PHI_DDOT = number("driven.phi_ddot", Acceleration, "contribution of the peg's acceleration to the terms of φ̈", |s| number_of_free(s, |f| f.driven.phi)).in_plot("driven");
            DRIVEN_PSI_DDOT = number("driven.psi_ddot", Acceleration, "contribution of the peg's acceleration to the terms of ψ̈", |s| number_of_free(s, |f| f.driven.psi)).in_plot("driven");
        }
    }

    /// The channel with a message for each nutation, at its end.
    CYCLES: NutationCycle {
        NUTATION nutation: channel("/top/nutation", "toprise.Nutation",
            "averages and extremes over each nutation, from one maximum of θ̇ to the next") {
            CYCLE = number("cycle", Number, "number of the cycle, from 0", |c| f64::from(c.index));
            START = number("start", Time, "start of the cycle", |c| c.start);
            PERIOD = number("period", Time, "duration of the cycle", NutationCycle::period);
            THETA_MIN = number("theta_min", Angle, "minimum of θ", |c| c.theta_min).in_plot("theta_range");
            THETA_MAX = number("theta_max", Angle, "maximum of θ", |c| c.theta_max).in_plot("theta_range");
            THETA_MEAN = number("theta_mean", Angle, "mean of θ", |c| c.theta_mean);
            THETA_DOT_MEAN = number("theta_dot_mean", Rate, "mean of θ̇", |c| c.mean_rates.theta);
            PHI_DOT_MEAN = number("phi_dot_mean", Rate, "mean of φ̇", |c| c.mean_rates.phi);
            PSI_DOT_MEAN = number("psi_dot_mean", Rate, "mean of ψ̇", |c| c.mean_rates.psi);
            THETA_DOT_MIN = number("theta_dot_min", Rate, "minimum of θ̇", |c| c.least_rates.theta).in_plot("theta_dot_range");
            THETA_DOT_MAX = number("theta_dot_max", Rate, "maximum of θ̇", |c| c.greatest_rates.theta).in_plot("theta_dot_range");
            PHI_DOT_MIN = number("phi_dot_min", Rate, "minimum of φ̇", |c| c.least_rates.phi).in_plot("phi_dot_range");
            PHI_DOT_MAX = number("phi_dot_max", Rate, "maximum of φ̇", |c| c.greatest_rates.phi).in_plot("phi_dot_range");
            PSI_DOT_MIN = number("psi_dot_min", Rate, "minimum of ψ̇", |c| c.least_rates.psi).in_plot("psi_dot_range");
            PSI_DOT_MAX = number("psi_dot_max", Rate, "maximum of ψ̇", |c| c.greatest_rates.psi).in_plot("psi_dot_range");
            PHI_DDOT_FRICTIONAL_MEAN = number("phi_ddot_frictional_mean", Acceleration, "mean of the friction term of φ̈", |c| c.mean_phi_frictional);
        }
    }

    /// The channel with a message for each event.
    EVENT: Event {
        EVENTS events: channel("/events", "toprise.Event",
            "events, and the state at each") {
            NAME = text("name", "kind of event", |e| e.kind.name());
            TIME = number("time", Time, "time, not rounded to nanoseconds", |e| e.time);
            PHI = number("phi", Angle, "precession angle φ", |e| e.motion.angles.phi);
            THETA = number("theta", Angle, "nutation angle (inclination) θ", |e| e.motion.angles.theta);
            PSI = number("psi", Angle, "spin angle ψ", |e| e.motion.angles.psi);
            PHI_DOT = number("phi_dot", Rate, "precession rate φ̇", |e| e.motion.tilt.rates.phi);
            THETA_DOT = number("theta_dot", Rate, "nutation rate θ̇", |e| e.motion.tilt.rates.theta);
            PSI_DOT = number("psi_dot", Rate, "spin rate ψ̇", |e| e.motion.tilt.rates.psi);
        }
    }

    /// The channel with a message for each impact of a free peg.
    IMPACT: ImpactRecord {
        IMPACTS impacts: channel("/top/impact", "toprise.Impact",
            "each impact of a free peg on the table").free_peg_only() {
            TIME = number("time", Time, "time, not rounded to nanoseconds", |i| i.time);
            BOUNCE = number("bounce", Number, "number of impacts since the peg left the table (or since the start), including this one", |i| f64::from(i.bounce));
            STAYS = number("stays", Number, "1 if the peg stays on the table, 0 if it bounces", |i| f64::from(u8::from(i.stays)));
            POINT = vector("point", Length, frame::WORLD, "point of contact", |i| i.point);
            IMPULSE = vector("impulse", Impulse, frame::WORLD, "impulse exerted by the table", |i| i.impulse);
            BEFORE = vector("before", Velocity, frame::WORLD, "velocity of the contact point before the impact; its horizontal part is the slip velocity", |i| i.before);
            AFTER = vector("after", Velocity, frame::WORLD, "velocity of the contact point after the impact", |i| i.after);
            RESTITUTION = number("restitution", Number, "effective coefficient of restitution", |i| i.restitution);
            LOST_RESTITUTION = number("lost.restitution", Energy, "energy lost to compression and restitution", |i| i.normal_loss).in_plot("lost");
            LOST_FRICTION = number("lost.friction", Energy, "energy lost to friction", |i| i.friction_loss).in_plot("lost");
        }
    }
}

/// A vector that only a free peg has.
fn of_free(sample: &Sample, get: fn(&FreeSample) -> Vector3<f64>) -> Vector3<f64> {
    // Never recorded: `present_if` skips the samples of a fixed peg.
    let nothing = Vector3::repeat(f64::NAN);
    sample.free.as_ref().map_or(nothing, get)
}

/// A number that only a free peg has.
fn number_of_free(sample: &Sample, get: fn(&FreeSample) -> f64) -> f64 {
    sample.free.as_ref().map_or(f64::NAN, get)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_unique_and_objects_are_contiguous() {
        for channel in channels() {
            let mut closed: Vec<&str> = Vec::new();
            for leaf in channel.leaves() {
                let parent = leaf.path.split('.').next().unwrap_or_default();
                if closed.last() != Some(&parent) {
                    assert!(!closed.contains(&parent), "{} {}", channel.topic, leaf.path);
                    closed.push(parent);
                }
            }
            let mut paths: Vec<_> = channel.leaves().map(|leaf| &leaf.path).collect();
            paths.sort();
            paths.dedup();
            assert_eq!(paths.len(), channel.leaves().count(), "{}", channel.topic);
        }
    }
}

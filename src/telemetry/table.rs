//! The table of channels: the one place that defines what is logged.

use super::quantity::Quantity::{
    self, Acceleration, Angle, Direction, Energy, Flag, Force, Impulse, Jellett, Length,
    LinearAcceleration, Momentum, Number, Orientation, Power, Rate, ReferenceRate, Text, Time,
    Torque, Velocity,
};
use crate::run::simulation::{Event, FreeSample, Landing, NutationCycle, Sample};
use nalgebra::{UnitQuaternion, Vector3};

/// The version of the telemetry: of what is recorded, and how it is computed. A change of a channel, or of its
/// numbers for a motion, raises it.
///
/// 1. The first, whose recordings don't name it.
/// 2. Nutation cycles are only those whose period is that of a nutation, and have the ranges of the rates. Integrals of
///    the terms of φ̈ and ψ̈, the work about each axis of the node frame and that of the friction force are recorded.
///    Views have the ranges of the nutation.
/// 3. The ranges of the rates in a nutation hold what is before and after each impact in it, and nothing else. Where the axis
///    is exactly vertical, φ and the rates are those with which it goes on. Drilling that has stopped the spin of a top with a free peg holds it.
pub const VERSION: u32 = 3;

/// A channel whose messages are made from values of type `S`.
#[derive(Debug)]
pub struct Channel<S: 'static> {
    /// Topic.
    pub topic: &'static str,
    /// Name of the message type.
    pub schema: &'static str,
    /// Content of the channel.
    pub meaning: &'static str,
    /// Whether only the recordings of tops with a free peg have it.
    pub is_of_free_peg: bool,
    /// Whether a value makes a message; by default every value does.
    pub present: Option<fn(&S) -> bool>,
    /// Its fields.
    pub fields: &'static [Field<S>],
}

/// A field of a channel. A dot in the name puts it into an object.
#[derive(Debug)]
pub struct Field<S> {
    /// Name.
    pub name: &'static str,
    /// The kind of quantity, which has the unit.
    pub quantity: Quantity,
    /// Frame of a vector's components, empty for others.
    pub frame: &'static str,
    /// Meaning, as in schemas.
    pub meaning: &'static str,
    /// Name of the plot that shows it.
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

const BODY: &str = "body";
const WORLD: &str = "world";
const NODE: &str = "node: x line of nodes, y perpendicular n × e_N, z symmetry axis";

const fn number<S>(
    name: &'static str,
    quantity: Quantity,
    meaning: &'static str,
    get: fn(&S) -> f64,
) -> Field<S> {
    Field {
        name,
        quantity,
        frame: "",
        meaning,
        plot: name,
        derivative: None,
        source: Source::Number(get),
    }
}

const fn vector<S>(
    name: &'static str,
    quantity: Quantity,
    frame: &'static str,
    meaning: &'static str,
    get: fn(&S) -> Vector3<f64>,
) -> Field<S> {
    Field {
        name,
        quantity,
        frame,
        meaning,
        plot: name,
        derivative: None,
        source: Source::Vector(get),
    }
}

const fn text<S>(name: &'static str, meaning: &'static str, get: fn(&S) -> &str) -> Field<S> {
    Field {
        name,
        quantity: Text,
        frame: "",
        meaning,
        plot: name,
        derivative: None,
        source: Source::Text(get),
    }
}

/// Shows a field in a plot together with others.
const fn together<S>(plot: &'static str, mut field: Field<S>) -> Field<S> {
    field.plot = plot;
    field
}

/// Names the time derivative of a field.
const fn with_derivative<S>(derivative: &'static str, mut field: Field<S>) -> Field<S> {
    field.derivative = Some(derivative);
    field
}

/// The channels that have a message for each sample.
#[rustfmt::skip]
pub const SAMPLES: &[Channel<Sample>] = &[
    Channel {
        topic: "/top/state", schema: "toprise.State",
        meaning: "Euler angles (z-x-z), their rates and accelerations; where the axis is exactly vertical, φ and the rates are those with which it leaves the vertical, or else φ is kept and φ̇ is 0; φ̈ is 0 there",
        is_of_free_peg: false,
        present: None,
        fields: &[
            with_derivative("phi_dot", number("phi", Angle, "precession angle φ, about the vertical, unwrapped", |s| s.angles.phi)),
            with_derivative("theta_dot", number("theta", Angle, "nutation angle (inclination) θ, about the line of nodes", |s| s.angles.theta)),
            with_derivative("psi_dot", number("psi", Angle, "spin angle ψ, about the symmetry axis, unwrapped", |s| s.angles.psi)),
            with_derivative("phi_ddot", number("phi_dot", Rate, "precession rate φ̇", |s| s.tilt.rates.phi)),
            with_derivative("theta_ddot", number("theta_dot", Rate, "nutation rate θ̇", |s| s.tilt.rates.theta)),
            with_derivative("psi_ddot", number("psi_dot", Rate, "spin rate ψ̇", |s| s.tilt.rates.psi)),
            number("phi_ddot", Acceleration, "precession acceleration φ̈", |s| s.euler_accelerations.phi),
            number("theta_ddot", Acceleration, "nutation acceleration θ̈", |s| s.euler_accelerations.theta),
            number("psi_ddot", Acceleration, "spin acceleration ψ̈", |s| s.euler_accelerations.psi),
        ],
    },
    Channel {
        topic: "/top/pose", schema: "toprise.Pose",
        meaning: "orientation, symmetry axis, angular velocity and position",
        is_of_free_peg: false,
        present: None,
        fields: &[
            Field { name: "orientation", quantity: Orientation, frame: "", plot: "orientation", derivative: None,
                meaning: "unit quaternion that turns body components into world components",
                source: Source::Rotation(|s| s.pose.world_from_body) },
            vector("axis", Direction, WORLD, "direction of the symmetry axis", |s| s.pose.axis),
            vector("omega_body", Rate, BODY, "angular velocity ω", |s| s.pose.omega_body),
            vector("omega_world", Rate, WORLD, "angular velocity ω", |s| s.pose.omega_world),
            vector("peg_position", Length, WORLD, "centre of the peg; the table is z = 0", |s| s.pose.peg_position),
        ],
    },
    Channel {
        topic: "/top/torque", schema: "toprise.Torque",
        meaning: "torques about the centre of the peg",
        is_of_free_peg: false,
        present: None,
        fields: &[
            vector("gravity_body", Torque, BODY, "torque of gravity", |s| s.torque.gravity.body),
            vector("friction_body", Torque, BODY, "torque of friction", |s| s.torque.friction.body),
            vector("total_body", Torque, BODY, "sum of the torques", |s| s.torque.total.body),
            vector("gravity_node", Torque, NODE, "torque of gravity", |s| s.torque.gravity.node),
            vector("friction_node", Torque, NODE, "torque of friction", |s| s.torque.friction.node),
            vector("total_node", Torque, NODE, "sum of the torques", |s| s.torque.total.node),
        ],
    },
    Channel {
        topic: "/top/acceleration", schema: "toprise.Acceleration",
        meaning: "the terms of the equations of motion: why the top rises at this instant, and what they have added up to",
        is_of_free_peg: false,
        present: None,
        fields: &[
            together("theta_ddot", number("theta_ddot.gyroscopic", Acceleration, "−(I_z/I_x) φ̇ sin θ (ψ̇ + φ̇ cos θ)", |s| s.accelerations.gyroscopic.theta)),
            together("theta_ddot", number("theta_ddot.centrifugal", Acceleration, "φ̇² sin θ cos θ", |s| s.accelerations.inertial.theta)),
            together("theta_ddot", number("theta_ddot.gravitational", Acceleration, "(M g l/I_x) sin θ", |s| s.accelerations.gravitational.theta)),
            together("theta_ddot", number("theta_ddot.frictional", Acceleration, "torque of friction about the line of nodes over I_x", |s| s.accelerations.frictional.theta)),
            together("phi_ddot", number("phi_ddot.gyroscopic", Acceleration, "(I_z/I_x) θ̇ (ψ̇ + φ̇ cos θ)/sin θ", |s| s.accelerations.gyroscopic.phi)),
            together("phi_ddot", number("phi_ddot.coriolis", Acceleration, "−2 θ̇ φ̇ cos θ/sin θ", |s| s.accelerations.inertial.phi)),
            together("phi_ddot", number("phi_ddot.frictional", Acceleration, "the term of friction, k M g R ψ̇ cos θ/(I_x |ω_⊥|) in the paper", |s| s.accelerations.frictional.phi)),
            together("psi_ddot", number("psi_ddot.gyroscopic", Acceleration, "−(I_z/I_x) θ̇ (ψ̇ + φ̇ cos θ) cos θ/sin θ", |s| s.accelerations.gyroscopic.psi)),
            together("psi_ddot", number("psi_ddot.coriolis", Acceleration, "2 θ̇ φ̇ cos² θ/sin θ + θ̇ φ̇ sin θ", |s| s.accelerations.inertial.psi)),
            together("psi_ddot", number("psi_ddot.frictional", Acceleration, "the term of friction, −k M g R ψ̇ (cos² θ/I_x + sin² θ/I_z)/|ω_⊥| in the paper", |s| s.accelerations.frictional.psi)),
            together("phi_dot", number("phi_dot.gyroscopic", Rate, "what the gyroscopic term of φ̈ has changed φ̇ by since the start", |s| s.integrals.terms.phi_gyroscopic)),
            together("phi_dot", number("phi_dot.coriolis", Rate, "what the Coriolis term of φ̈ has changed φ̇ by since the start", |s| s.integrals.terms.phi_coriolis)),
            together("phi_dot", number("phi_dot.frictional", Rate, "what the frictional term of φ̈ has changed φ̇ by since the start", |s| s.integrals.terms.phi_frictional)),
            number("psi_dot.frictional", Rate, "what the frictional term of ψ̈ has changed ψ̇ by since the start", |s| s.integrals.terms.psi_frictional),
        ],
    },
    Channel {
        topic: "/top/contact", schema: "toprise.Contact",
        meaning: "slip and forces at the point of contact",
        is_of_free_peg: false,
        present: None,
        fields: &[
            vector("slip_body", Velocity, BODY, "slip velocity of the contact point over the table", |s| s.slip.body),
            vector("slip_world", Velocity, WORLD, "slip velocity of the contact point over the table", |s| s.slip.world),
            number("slip_speed", Velocity, "magnitude of the slip velocity", |s| s.contact.slip_speed),
            vector("friction_force", Force, WORLD, "friction force of the law; the ablations of the equations do not follow from a force and leave it as it is", |s| s.slip.friction_force),
            number("normal_force", Force, "normal force of the table", |s| s.contact.normal_force),
            vector("contact_point", Length, WORLD, "the point of contact", |s| s.slip.contact_point),
            number("slip_path", Length, "length of the path slipped since the start", |s| s.integrals.slip_path),
            number("regime", Flag, "1 slipping, 0 not slipping", Sample::regime),
            number("slip_work", Energy, "work of the friction force along the path slipped since the start", |s| s.integrals.slip_work),
        ],
    },
    Channel {
        topic: "/top/energy", schema: "toprise.Energy",
        meaning: "energies and what friction takes",
        is_of_free_peg: false,
        present: None,
        fields: &[
            together("mechanical", number("kinetic", Energy, "kinetic energy", |s| s.energy.kinetic)),
            number("potential", Energy, "potential energy, zero at the height of the peg's centre", |s| s.energy.potential),
            together("mechanical", number("total", Energy, "total energy", |s| s.energy.total())),
            number("friction_power", Power, "power of the torque of friction", |s| s.energy.friction_power),
            number("friction_work", Energy, "work of friction since the start", |s| s.integrals.friction_work),
            vector("friction_work_node", Energy, NODE, "work of friction about each axis since the start", |s| s.integrals.work_node),
        ],
    },
    Channel {
        topic: "/top/momentum", schema: "toprise.Momentum",
        meaning: "angular momentum about the centre of the peg",
        is_of_free_peg: false,
        present: None,
        fields: &[
            together("components", number("vertical", Momentum, "about the vertical", |s| s.momentum.vertical)),
            together("components", number("axial", Momentum, "about the symmetry axis", |s| s.momentum.axial)),
            vector("world", Momentum, WORLD, "angular momentum", |s| s.momentum.world),
        ],
    },
    Channel {
        topic: "/top/precession", schema: "toprise.Precession",
        meaning: "regular precession at this inclination and spin rate; no message where its rates are not real",
        is_of_free_peg: false,
        present: Some(|s| s.precession.roots.is_some()),
        fields: &[
            number("slow_root", ReferenceRate, "slow rate of regular precession", |s| s.precession.roots.map_or(f64::NAN, |r| r.slow)),
            number("fast_root", ReferenceRate, "fast rate of regular precession", |s| s.precession.roots.map_or(f64::NAN, |r| r.fast)),
            number("excess", ReferenceRate, "φ̇ less the slow rate", |s| s.precession.roots.map_or(f64::NAN, |r| s.tilt.rates.phi - r.slow)),
            number("strength_ratio", Number, "|a|/√(4 M g l/I_x), a = I_z (ψ̇ + φ̇ cos θ)/I_x: below 1 the top is weak", |s| s.precession.strength_ratio),
        ],
    },
    Channel {
        topic: "/top/center_of_mass", schema: "toprise.CenterOfMass",
        meaning: "the centre of mass of a top with a free peg",
        is_of_free_peg: true,
        present: Some(|s| s.free.is_some()),
        fields: &[
            vector("position", Length, WORLD, "position", |s| of_free(s, |f| f.center)),
            vector("velocity", Velocity, WORLD, "velocity", |s| of_free(s, |f| f.center_velocity)),
            vector("acceleration", LinearAcceleration, WORLD, "acceleration", |s| of_free(s, |f| f.center_acceleration)),
            vector("angular_momentum", Momentum, WORLD, "angular momentum about it", |s| of_free(s, |f| f.central_momentum)),
        ],
    },
    Channel {
        topic: "/top/free_peg", schema: "toprise.FreePeg",
        meaning: "what a free peg does on the table and above it",
        is_of_free_peg: true,
        present: Some(|s| s.free.is_some()),
        fields: &[
            number("gap", Length, "height of the peg above the table", |s| number_of_free(s, |f| f.gap)),
            vector("velocity", Velocity, WORLD, "velocity of the peg's centre", |s| of_free(s, |f| f.peg_velocity)),
            number("jellett", Jellett, "Jellett's integral l L_n + R L_z′ about the centre of mass, which no force at the point of contact changes", |s| number_of_free(s, |f| f.jellett)),
            number("routh", Momentum, "Routh's integral, constant while a peg rolls without losses", |s| number_of_free(s, |f| f.routh)),
            number("translational", Energy, "kinetic energy of the centre of mass; the rest is that of the rotation about it", |s| number_of_free(s, |f| f.translational_energy)),
            together("lost", number("lost.sliding", Energy, "energy that friction has taken along the path slipped since the start", |s| -s.integrals.slip_work)),
            together("lost", number("lost.losses", Energy, "energy that rolling resistance, drilling and air have taken since the start", |s| number_of_free(s, |f| f.dissipated.losses))),
            together("lost", number("lost.restitution", Energy, "energy lost by compression and restitution in impacts since the start", |s| number_of_free(s, |f| f.dissipated.impact_normal))),
            together("lost", number("lost.impact_friction", Energy, "energy lost by friction in impacts since the start", |s| number_of_free(s, |f| f.dissipated.impact_friction))),
            together("driven", number("driven.theta_ddot", Acceleration, "what the acceleration of the peg adds to the terms of θ̈", |s| number_of_free(s, |f| f.driven.theta))),
            together("driven", number("driven.phi_ddot", Acceleration, "what the acceleration of the peg adds to the terms of φ̈", |s| number_of_free(s, |f| f.driven.phi))),
            together("driven", number("driven.psi_ddot", Acceleration, "what the acceleration of the peg adds to the terms of ψ̈", |s| number_of_free(s, |f| f.driven.psi))),
        ],
    },
];

/// The channel with a message for each nutation, at its end.
#[rustfmt::skip]
pub const NUTATION: Channel<NutationCycle> = Channel {
    topic: "/top/nutation", schema: "toprise.Nutation",
    meaning: "each nutation, from one maximum of θ̇ to the next: the averaged motion",
    is_of_free_peg: false,
    present: None,
    fields: &[
        number("cycle", Number, "number of the cycle, from 0", |c| f64::from(c.index)),
        number("start", Time, "when the cycle began", |c| c.start),
        number("period", Time, "its duration", NutationCycle::period),
        together("theta_range", number("theta_min", Angle, "least θ in it", |c| c.theta_min)),
        together("theta_range", number("theta_max", Angle, "greatest θ in it", |c| c.theta_max)),
        number("theta_mean", Angle, "mean of θ", |c| c.theta_mean),
        number("theta_dot_mean", Rate, "mean of θ̇", |c| c.mean_rates.theta),
        number("phi_dot_mean", Rate, "mean of φ̇", |c| c.mean_rates.phi),
        number("psi_dot_mean", Rate, "mean of ψ̇", |c| c.mean_rates.psi),
        together("theta_dot_range", number("theta_dot_min", Rate, "least θ̇ in it", |c| c.least_rates.theta)),
        together("theta_dot_range", number("theta_dot_max", Rate, "greatest θ̇ in it", |c| c.greatest_rates.theta)),
        together("phi_dot_range", number("phi_dot_min", Rate, "least φ̇ in it", |c| c.least_rates.phi)),
        together("phi_dot_range", number("phi_dot_max", Rate, "greatest φ̇ in it", |c| c.greatest_rates.phi)),
        together("psi_dot_range", number("psi_dot_min", Rate, "least ψ̇ in it", |c| c.least_rates.psi)),
        together("psi_dot_range", number("psi_dot_max", Rate, "greatest ψ̇ in it", |c| c.greatest_rates.psi)),
        number("phi_ddot_frictional_mean", Acceleration, "mean of the frictional term of φ̈", |c| c.mean_phi_frictional),
    ],
};

/// The channel with a message for each event.
#[rustfmt::skip]
pub const EVENTS: Channel<Event> = Channel {
    topic: "/events", schema: "toprise.Event",
    meaning: "what happened, and the state at that moment",
    is_of_free_peg: false,
    present: None,
    fields: &[
        text("name", "kind of event", |e| e.kind.name()),
        text("description", "a sentence for people", |e| &e.description),
        number("time", Time, "when, more exactly than the timestamp", |e| e.time),
        number("phi", Angle, "precession angle φ", |e| e.motion.angles.phi),
        number("theta", Angle, "nutation angle (inclination) θ", |e| e.motion.angles.theta),
        number("psi", Angle, "spin angle ψ", |e| e.motion.angles.psi),
        number("phi_dot", Rate, "precession rate φ̇", |e| e.motion.tilt.rates.phi),
        number("theta_dot", Rate, "nutation rate θ̇", |e| e.motion.tilt.rates.theta),
        number("psi_dot", Rate, "spin rate ψ̇", |e| e.motion.tilt.rates.psi),
    ],
};

/// The channel with a message for each impact of a free peg.
#[rustfmt::skip]
pub const IMPACTS: Channel<Landing> = Channel {
    topic: "/top/impact", schema: "toprise.Impact",
    meaning: "each impact of a free peg on the table",
    is_of_free_peg: true,
    present: None,
    fields: &[
        number("time", Time, "when, more exactly than the timestamp", |i| i.time),
        number("bounce", Number, "impacts since the peg left the table, or since the start, this one counted", |i| f64::from(i.bounce)),
        number("stays", Number, "1 if the peg stays on the table, 0 if it bounces", |i| f64::from(u8::from(i.stays))),
        vector("point", Length, WORLD, "the point of contact", |i| i.point),
        vector("impulse", Impulse, WORLD, "impulse of the table", |i| i.impulse),
        vector("before", Velocity, WORLD, "velocity of the contact point before: its horizontal part is the slip", |i| i.before),
        vector("after", Velocity, WORLD, "velocity of the contact point after", |i| i.after),
        number("restitution", Number, "coefficient of restitution that acted", |i| i.restitution),
        together("lost", number("lost.restitution", Energy, "energy lost by compression and restitution", |i| i.normal_loss)),
        together("lost", number("lost.friction", Energy, "energy lost by friction", |i| i.friction_loss)),
    ],
};

/// A vector that only a free peg has.
fn of_free(sample: &Sample, get: fn(&FreeSample) -> Vector3<f64>) -> Vector3<f64> {
    let nothing = Vector3::repeat(f64::NAN);
    sample.free.as_ref().map_or(nothing, get)
}

/// A number that only a free peg has.
fn number_of_free(sample: &Sample, get: fn(&FreeSample) -> f64) -> f64 {
    sample.free.as_ref().map_or(f64::NAN, get)
}

//! Physical quantities and their units.

/// The quantity of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// A force.
    Force,
    /// A torque.
    Torque,
    /// An angular acceleration.
    Acceleration,
    /// An angular velocity or the rate of an angle.
    Rate,
    /// A velocity.
    Velocity,
    /// An angle.
    Angle,
    /// A direction, as a unit vector.
    Direction,
    /// An orientation, as a unit quaternion.
    Orientation,
    /// A position or a length.
    Length,
    /// An energy or work.
    Energy,
    /// A power.
    Power,
    /// An angular momentum.
    Momentum,
    /// An acceleration along a line.
    LinearAcceleration,
    /// An impulse.
    Impulse,
    /// Jellett's integral: an angular momentum times a length.
    Jellett,
    /// A reference rate, such as that of regular precession.
    ReferenceRate,
    /// A time.
    Time,
    /// A count or a ratio.
    Number,
    /// A flag or state code, constant between samples.
    Flag,
    /// A text.
    Text,
}

impl Quantity {
    /// The SI unit; empty for pure numbers and texts.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Torque => "N m",
            Self::Acceleration => "rad/s²",
            Self::Rate | Self::ReferenceRate => "rad/s",
            Self::Velocity => "m/s",
            Self::Angle => "rad",
            Self::Length => "m",
            Self::Energy => "J",
            Self::Power => "W",
            Self::Momentum => "kg m²/s",
            Self::LinearAcceleration => "m/s²",
            Self::Impulse => "N s",
            Self::Jellett => "kg m³/s",
            Self::Time => "s",
            Self::Direction | Self::Orientation | Self::Number | Self::Flag | Self::Text => "",
        }
    }
}

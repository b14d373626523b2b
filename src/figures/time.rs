//! The figures over time.

mod curves;
mod motion;
mod precession;
mod terms;

pub(super) use self::motion::{compared, motion};
pub(super) use self::precession::precession;
pub(super) use self::terms::{acceleration, energy, hops, slip, torque};

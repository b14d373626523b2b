//! The mechanics of a heavy symmetric top: its body, the friction at its peg, the equations of motion and the
//! integrator that solves them. Nothing here knows of time series, files or viewers.

pub mod dynamics;
pub mod friction;
pub mod integrate;
pub mod kinematics;
pub mod math;
pub mod top;

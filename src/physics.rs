//! The mechanics of a heavy symmetric top: its body, the friction at its peg, the equations of motion and the
//! integrator that solves them. Nothing here depends on time series, files or viewers.

#![deny(
    clippy::wildcard_enum_match_arm,
    clippy::match_wildcard_for_single_variants
)]

pub mod dynamics;
pub mod friction;
pub mod integrate;
pub mod kinematics;
pub mod math;
pub mod top;

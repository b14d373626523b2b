//! Mechanics of a heavy symmetric top: rigid body, friction, equations of motion, and the integrator. Independent of
//! time series, files and viewers.

#![deny(
    clippy::wildcard_enum_match_arm,
    clippy::match_wildcard_for_single_variants
)]
#![allow(
    clippy::inline_always,
    reason = "plain #[inline] does not inline the right-hand sides into the integrator's stages"
)]

pub mod dynamics;
pub mod formula;
pub mod friction;
pub mod integrate;
pub mod kinematics;
pub mod math;
pub mod top;

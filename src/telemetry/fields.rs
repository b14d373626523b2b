//! Typed handles for the topics and fields of the table.
//!
//! A handle has the name of its field in capitals, with `_` for the dot: [`state::THETA`] is `theta` of `/top/state`,
//! [`acceleration::THETA_DDOT_FRICTIONAL`] is `theta_ddot.frictional` of `/top/acceleration`. A misspelt topic or field
//! does not compile:
//!
//! ```
//! use toprise::telemetry::fields::{STATE, pose, state};
//!
//! assert_eq!(STATE.name(), "/top/state");
//! assert_eq!(state::THETA.path(), "theta");
//! assert_eq!(pose::AXIS.z().path(), "axis.z");
//! ```
//!
//! ```compile_fail
//! use toprise::telemetry::fields::state;
//!
//! let theta = state::TEHTA;
//! ```

pub use super::handle::{NumberField, Plot, RotationField, TextField, VectorField};
pub use super::table::{
    ACCELERATION, CENTER_OF_MASS, CONTACT, ENERGY, EVENTS, FREE_PEG, IMPACTS, MOMENTUM, NUTATION,
    POSE, PRECESSION, STATE, TORQUE, acceleration, center_of_mass, contact, energy, events,
    free_peg, impacts, momentum, nutation, pose, precession, state, torque,
};

/// State quantities with the fields of their minimum and maximum in a nutation.
pub(crate) const NUTATING: [[NumberField; 3]; 4] = [
    [state::THETA, nutation::THETA_MIN, nutation::THETA_MAX],
    [
        state::THETA_DOT,
        nutation::THETA_DOT_MIN,
        nutation::THETA_DOT_MAX,
    ],
    [state::PHI_DOT, nutation::PHI_DOT_MIN, nutation::PHI_DOT_MAX],
    [state::PSI_DOT, nutation::PSI_DOT_MIN, nutation::PSI_DOT_MAX],
];

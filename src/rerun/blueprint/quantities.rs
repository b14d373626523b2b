//! The quantities that a comparison of two runs shows.

use rerun::blueprint::components::Corner2D;

use crate::telemetry::fields::{Plot, contact, energy, nutation, precession, state, torque};

/// A quantity that is compared.
pub(super) struct Quantity {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    /// Plots that are shown of each run.
    pub(super) curves: &'static [Plot],
    /// Plots that are subtracted.
    pub(super) differences: &'static [Plot],
    /// The corner where a legend is out of the curves' way. Most charts go without: colours mean the same everywhere.
    pub(super) legend: Option<Corner2D>,
}

const fn quantity(
    name: &'static str,
    unit: &'static str,
    curves: &'static [Plot],
    differences: &'static [Plot],
    legend: Option<Corner2D>,
) -> Quantity {
    Quantity {
        name,
        unit,
        curves,
        differences,
        legend,
    }
}

const THETA: &[Plot] = &[state::THETA.plot(), nutation::THETA_MEAN.plot()];
const THETA_DOT: &[Plot] = &[state::THETA_DOT.plot(), nutation::THETA_DOT_MEAN.plot()];
const PHI_DOT: &[Plot] = &[state::PHI_DOT.plot(), nutation::PHI_DOT_MEAN.plot()];
const PSI_DOT: &[Plot] = &[state::PSI_DOT.plot(), nutation::PSI_DOT_MEAN.plot()];
const SLIP_SPEED: &[Plot] = &[contact::SLIP_SPEED.plot()];
const TORQUE: &[Plot] = &[torque::FRICTION_NODE.plot()];
const ENERGY: &[Plot] = &[energy::TOTAL.plot()];
const EXCESS: &[Plot] = &[precession::EXCESS.plot()];
const PERIOD: &[Plot] = &[nutation::PERIOD.plot()];

/// Quantities that tell whether and how the motions differ; each is a row of charts.
pub(super) const MOTION: [Quantity; 4] = [
    quantity(
        "θ",
        "rad",
        &[state::THETA.plot()],
        THETA,
        Some(Corner2D::RightTop),
    ),
    quantity("dθ/dt", "rad/s", THETA_DOT, THETA_DOT, None),
    quantity("dφ/dt", "rad/s", PHI_DOT, PHI_DOT, None),
    quantity("dψ/dt", "rad/s", &[state::PSI_DOT.plot()], PSI_DOT, None),
];

/// Effects of friction, in one row of charts.
pub(super) const FRICTION: [Quantity; 3] = [
    quantity("Slip speed", "m/s", SLIP_SPEED, &[], None),
    quantity(
        "Power of friction",
        "W",
        &[energy::FRICTION_POWER.plot()],
        &[],
        None,
    ),
    quantity(
        "Work of friction",
        "J",
        &[energy::FRICTION_WORK.plot()],
        &[],
        None,
    ),
];

/// Further quantities, on the second page; each is a row of charts.
#[rustfmt::skip]
pub(super) const MORE: [Quantity; 5] = [
    quantity("Slip speed", "m/s", SLIP_SPEED, SLIP_SPEED, None),
    quantity("Friction torque, node frame", "N m", TORQUE, TORQUE, Some(Corner2D::LeftBottom)),
    quantity("Energy, total and kinetic", "J", ENERGY, ENERGY, Some(Corner2D::LeftBottom)),
    quantity("dφ/dt − slow root", "rad/s", EXCESS, EXCESS, None),
    quantity("Nutation period", "s", PERIOD, PERIOD, None),
];

/// Whether the layout shows differences of a plot.
pub(in super::super) fn compares(plot: Plot) -> bool {
    let mut rows = MOTION.iter().chain(&MORE);
    rows.any(|quantity| quantity.differences.contains(&plot))
}

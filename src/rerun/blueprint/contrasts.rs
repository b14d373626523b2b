//! Quantities in the layout of a comparison.

use rerun::blueprint::components::Corner2D;

use crate::telemetry::fields::{
    Plot, center_of_mass, contact, energy, free_peg, momentum, nutation, precession, state, torque,
};

/// A quantity of both runs.
pub(super) struct Contrast {
    pub(super) name: &'static str,
    /// Plots that are shown of each run.
    pub(super) curves: &'static [Plot],
    /// Plots that are subtracted.
    pub(super) differences: &'static [Plot],
    /// The corner where a legend is out of the curves' way. Most charts go without: colours mean the same everywhere.
    pub(super) legend: Option<Corner2D>,
}

const fn contrast(
    name: &'static str,
    curves: &'static [Plot],
    differences: &'static [Plot],
) -> Contrast {
    Contrast {
        name,
        curves,
        differences,
        legend: None,
    }
}

impl Contrast {
    const fn legend(self, corner: Corner2D) -> Self {
        Self {
            legend: Some(corner),
            ..self
        }
    }
}

const THETA: &[Plot] = &[state::THETA.plot(), nutation::THETA_MEAN.plot()];
const THETA_DOT: &[Plot] = &[state::THETA_DOT.plot(), nutation::THETA_DOT_MEAN.plot()];
const PHI_DOT: &[Plot] = &[state::PHI_DOT.plot(), nutation::PHI_DOT_MEAN.plot()];
const PSI_DOT: &[Plot] = &[state::PSI_DOT.plot(), nutation::PSI_DOT_MEAN.plot()];
const SLIP_SPEED: &[Plot] = &[contact::SLIP_SPEED.plot()];
const TORQUE: &[Plot] = &[torque::FRICTION_NODE.plot()];
const POWER: &[Plot] = &[energy::FRICTION_POWER.plot()];
const WORK: &[Plot] = &[energy::FRICTION_WORK.plot()];
const ENERGY: &[Plot] = &[energy::TOTAL.plot()];
const EXCESS: &[Plot] = &[precession::EXCESS.plot()];
const MOMENTUM: &[Plot] = &[momentum::VERTICAL.plot()];
const CENTER: &[Plot] = &[center_of_mass::POSITION.plot()];
const NORMAL_FORCE: &[Plot] = &[contact::NORMAL_FORCE.plot()];
const GAP: &[Plot] = &[free_peg::GAP.plot()];
const REGIME: &[Plot] = &[contact::REGIME.plot()];
const PERIOD: &[Plot] = &[nutation::PERIOD.plot()];

/// Quantities that show the difference of the motions; each is a row of charts.
pub(super) const MOTION: [Contrast; 4] = [
    contrast("θ", &[state::THETA.plot()], THETA).legend(Corner2D::RightTop),
    contrast("dθ/dt", THETA_DOT, THETA_DOT),
    contrast("dφ/dt", PHI_DOT, PHI_DOT),
    contrast("dψ/dt", &[state::PSI_DOT.plot()], PSI_DOT),
];

/// The same where a peg is free: Euler rates, which are infinite at upright, are on a page of their own.
pub(super) const TRAVEL: [Contrast; 3] = [
    contrast("θ", &[state::THETA.plot()], THETA).legend(Corner2D::RightTop),
    contrast("Angular momentum, vertical and axial", MOMENTUM, MOMENTUM),
    contrast("Centre of mass", CENTER, CENTER),
];

/// Euler rates where a peg is free.
pub(super) const RATES: [Contrast; 3] = [
    contrast("dθ/dt", THETA_DOT, THETA_DOT),
    contrast("dφ/dt", PHI_DOT, PHI_DOT),
    contrast("dψ/dt", &[state::PSI_DOT.plot()], PSI_DOT),
];

/// Effects of friction, in one row of charts.
pub(super) const FRICTION: [Contrast; 3] = [
    contrast("Slip speed", SLIP_SPEED, &[]),
    contrast("Power of friction", POWER, &[]),
    contrast("Work of friction", WORK, &[]),
];

/// Further quantities, on the second page; each is a row of charts.
pub(super) const MORE: [Contrast; 5] = [
    contrast("Slip speed", SLIP_SPEED, SLIP_SPEED),
    contrast("Friction torque, node frame", TORQUE, TORQUE).legend(Corner2D::LeftBottom),
    contrast("Energy, total and kinetic", ENERGY, ENERGY).legend(Corner2D::LeftBottom),
    contrast("dφ/dt − slow root", EXCESS, EXCESS),
    contrast("Nutation period", PERIOD, PERIOD),
];

/// Motion of a free peg, on a page of its own; each is a row of charts.
pub(super) const TABLE: [Contrast; 3] = [
    contrast("Normal force", NORMAL_FORCE, NORMAL_FORCE),
    contrast("Height of the peg above the table", GAP, GAP),
    contrast("Regime: 1 slides, 0 rolls or sticks, 2 flies", REGIME, &[]),
];

/// Whether the layout shows differences of a plot.
pub(crate) fn compares(plot: Plot) -> bool {
    let mut shown = MOTION
        .iter()
        .chain(&TRAVEL)
        .chain(&RATES)
        .chain(&TABLE)
        .chain(&MORE);
    shown.any(|contrast| contrast.differences.contains(&plot))
}

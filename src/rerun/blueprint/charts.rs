//! The charts of the layouts, page by page.

use super::views::titled;
use crate::rerun::plots::curves::{Curves, Derived};
use crate::rerun::role::Role;
use crate::telemetry::fields::{
    Plot, center_of_mass, contact, energy, free_peg, momentum, nutation, precession, state, torque,
};

/// A chart of a run, or a row of charts for a quantity of two runs: both curves, and their difference.
pub(super) struct Chart {
    pub(super) name: &'static str,
    /// The curves that are shown of each run.
    pub(super) curves: &'static [Curves],
    /// The plots that are subtracted.
    pub(super) differences: &'static [Curves],
}

impl Chart {
    /// The title, with the unit.
    pub(super) fn title(&self) -> String {
        titled(self.name, self.curves[0].unit())
    }
}

/// A chart of one run.
const fn chart(name: &'static str, curves: &'static [Curves]) -> Chart {
    contrast(name, curves, &[])
}

/// A quantity of two runs.
const fn contrast(
    name: &'static str,
    curves: &'static [Curves],
    differences: &'static [Curves],
) -> Chart {
    Chart {
        name,
        curves,
        differences,
    }
}

/// The curves of a plot.
const fn of(plot: Plot) -> Curves {
    Curves::Field(plot)
}

const THETA_ALONE: &[Curves] = &[of(state::THETA.plot())];
const THETA: &[Curves] = &[of(state::THETA.plot()), of(nutation::THETA_MEAN.plot())];
const INCLINATION_CURVES: &[Curves] = &[THETA[0], THETA[1], Curves::Derived(Derived::EventMarks)];
const THETA_DOT: &[Curves] = &[
    of(state::THETA_DOT.plot()),
    of(nutation::THETA_DOT_MEAN.plot()),
];
const PHI_DOT: &[Curves] = &[of(state::PHI_DOT.plot()), of(nutation::PHI_DOT_MEAN.plot())];
const PHI_DOT_AND_ROOT: &[Curves] = &[PHI_DOT[0], PHI_DOT[1], of(precession::SLOW_ROOT.plot())];
const PSI_DOT_ALONE: &[Curves] = &[of(state::PSI_DOT.plot())];
const SPIN: &[Curves] = &[
    of(state::PSI_DOT.plot()),
    Curves::Derived(Derived::AxialRate),
];
const SLIP_SPEED: &[Curves] = &[of(contact::SLIP_SPEED.plot())];
const SLIP: &[Curves] = &[SLIP_SPEED[0], of(contact::SLIP_WORLD.plot())];
const TORQUE: &[Curves] = &[of(torque::FRICTION_NODE.plot())];
const GRAVITY: &[Curves] = &[of(torque::GRAVITY_NODE.plot())];
const POWER: &[Curves] = &[of(energy::FRICTION_POWER.plot())];
const WORK: &[Curves] = &[of(energy::FRICTION_WORK.plot())];
const LOST: &[Curves] = &[of(free_peg::LOST_SLIDING.plot())];
/// Kinetic and total energy.
const ENERGY: &[Curves] = &[of(energy::TOTAL.plot())];
/// All parts.
const ENERGY_PARTS: &[Curves] = &[ENERGY[0], of(energy::POTENTIAL.plot())];
const EXCESS: &[Curves] = &[of(precession::EXCESS.plot())];
const MOMENTUM: &[Curves] = &[of(momentum::VERTICAL.plot())];
const MOMENTUM_PARTS: &[Curves] = &[Curves::Derived(Derived::MomentumParts)];
const TORQUE_ALONG: &[Curves] = &[Curves::Derived(Derived::TorqueAlong)];
const CENTER: &[Curves] = &[of(center_of_mass::POSITION.plot())];
const CENTER_VELOCITY: &[Curves] = &[of(center_of_mass::VELOCITY.plot())];
const PEG_VELOCITY: &[Curves] = &[of(free_peg::VELOCITY.plot())];
const NORMAL_FORCE: &[Curves] = &[of(contact::NORMAL_FORCE.plot())];
const GAP: &[Curves] = &[of(free_peg::GAP.plot())];
const REGIME: &[Curves] = &[of(contact::REGIME.plot())];
const JELLETT: &[Curves] = &[Curves::Derived(Derived::JellettChange)];
const PERIOD: &[Curves] = &[of(nutation::PERIOD.plot())];

const MOMENTUM_NAME: &str = "Angular momentum";
pub(super) const GAP_NAME: &str = "Height of the peg";
const REGIME_NAME: &str = "0 rolls, 1 slides, 2 flies";
const PHI_DOT_NAME: &str = "dφ/dt, precession";
const ENERGY_NAME: &str = "Energy, 0 at the peg's centre";
const TORQUE_NAME: &str = "Friction torque";

const INCLINATION: Chart = chart("θ, inclination", INCLINATION_CURVES);
const THETA_RATE: Chart = chart("dθ/dt", THETA_DOT);
const PHI_RATE: Chart = chart(PHI_DOT_NAME, PHI_DOT_AND_ROOT);
const PSI_RATE: Chart = chart("Spin, dψ/dt and ω·n", SPIN);
const FRICTION_TORQUE: Chart = chart(TORQUE_NAME, TORQUE);
const SLIP_VELOCITY: Chart = chart("Slip velocity, world axes", SLIP);
// The components oscillate, and would fill the chart behind its legend.
const SLIDING: Chart = chart("Slip speed", SLIP_SPEED);
const ENERGIES: Chart = chart(ENERGY_NAME, ENERGY_PARTS);
const ANGULAR_MOMENTUM: Chart = chart(MOMENTUM_NAME, MOMENTUM);
const PARTS: Chart = chart("Parts of L", MOMENTUM_PARTS);
const SHORTENING: Chart = chart("τ along horizontal L", TORQUE_ALONG);

/// The rise of a top with a fixed peg.
pub(super) const RISE: [Chart; 8] = [
    INCLINATION,
    THETA_RATE,
    PHI_RATE,
    PSI_RATE,
    PARTS,
    SHORTENING,
    SLIDING,
    ENERGIES,
];

/// The travel of a top with a free peg, or the inversion of a tippe top. Euler rates, infinite when upright, are on a page of
/// their own.
pub(super) const TRAVEL: [Chart; 8] = [
    INCLINATION,
    ANGULAR_MOMENTUM,
    SLIDING,
    chart("Centre of mass", CENTER),
    PARTS,
    chart(GAP_NAME, GAP),
    SHORTENING,
    ENERGIES,
];

/// Events of a free peg on the table and above it.
pub(super) const TABLE: [Chart; 5] = [
    chart("Normal force", NORMAL_FORCE),
    chart("Energy lost since the start", LOST),
    chart("Velocity of the peg", PEG_VELOCITY),
    chart("Velocity, centre of mass", CENTER_VELOCITY),
    chart("Jellett's integral, change", JELLETT),
];

/// The Euler rates of a top with a free peg.
pub(super) const RATES: [Chart; 3] = [THETA_RATE, PHI_RATE, PSI_RATE];

/// The terms of the accelerations. Their legends are long: only wide charts leave room for the curves.
pub(super) const TERMS: [Chart; 3] = [
    chart(
        "d²θ/dt², nutation means",
        &[Curves::Derived(Derived::ThetaTerms)],
    ),
    chart(
        "d²φ/dt², nutation means",
        &[Curves::Derived(Derived::PhiTerms)],
    ),
    chart(
        "d²ψ/dt², nutation means",
        &[Curves::Derived(Derived::PsiTerms)],
    ),
];

/// Further quantities.
pub(super) const MORE: [Chart; 8] = [
    FRICTION_TORQUE,
    ANGULAR_MOMENTUM,
    chart("dφ/dt − slow rate", EXCESS),
    chart("Nutation period", PERIOD),
    chart("Gravity torque", GRAVITY),
    SLIP_VELOCITY,
    chart("Work of friction", WORK),
    chart("Power of friction", POWER),
];

const THETA_CONTRAST: Chart = contrast("θ", THETA_ALONE, THETA);
const THETA_DOT_CONTRAST: Chart = contrast("dθ/dt", THETA_DOT, THETA_DOT);
const PHI_DOT_CONTRAST: Chart = contrast("dφ/dt", PHI_DOT, PHI_DOT);
const PSI_DOT_CONTRAST: Chart = contrast("dψ/dt", PSI_DOT_ALONE, PSI_DOT_ALONE);

/// Quantities that show the difference of the motions.
pub(super) const MOTION_CONTRASTS: [Chart; 4] = [
    THETA_CONTRAST,
    THETA_DOT_CONTRAST,
    PHI_DOT_CONTRAST,
    PSI_DOT_CONTRAST,
];

/// The same for free pegs: Euler rates, which are infinite at upright, have their own page.
pub(super) const TRAVEL_CONTRASTS: [Chart; 3] = [
    THETA_CONTRAST,
    contrast(MOMENTUM_NAME, MOMENTUM, MOMENTUM),
    contrast("Centre of mass", CENTER, CENTER),
];

/// Euler rates of a free peg.
pub(super) const RATE_CONTRASTS: [Chart; 3] =
    [THETA_DOT_CONTRAST, PHI_DOT_CONTRAST, PSI_DOT_CONTRAST];

/// Effects of friction, on a page of their own.
pub(super) const FRICTION_CONTRASTS: [Chart; 4] = [
    contrast("Slip speed", SLIP_SPEED, SLIP_SPEED),
    contrast(TORQUE_NAME, TORQUE, TORQUE),
    contrast("Power of friction", POWER, &[]),
    contrast("Work of friction", WORK, &[]),
];

/// Motion of a free peg, on its own page.
pub(super) const TABLE_CONTRASTS: [Chart; 3] = [
    contrast("Normal force", NORMAL_FORCE, NORMAL_FORCE),
    contrast(GAP_NAME, GAP, GAP),
    contrast(REGIME_NAME, REGIME, &[]),
];

/// Further quantities, on the last page.
pub(super) const MORE_CONTRASTS: [Chart; 3] = [
    contrast(ENERGY_NAME, ENERGY, ENERGY),
    contrast("dφ/dt − slow rate", EXCESS, EXCESS),
    contrast("Nutation period", PERIOD, PERIOD),
];

/// Whether the layout of a run shows a plot.
pub(crate) fn shows(plot: Plot, role: &Role, is_free: bool) -> bool {
    let pages: &[&[Chart]] = match (role.is_alone(), is_free) {
        (true, false) => &[&RISE, &MORE],
        (true, true) => &[&TRAVEL, &TABLE, &RATES, &MORE],
        // Runs with and without a free peg are compared in the same charts.
        (false, _) => &[
            &MOTION_CONTRASTS,
            &TRAVEL_CONTRASTS,
            &FRICTION_CONTRASTS,
            &TABLE_CONTRASTS,
            &MORE_CONTRASTS,
        ],
    };
    let charts = pages.iter().copied().flatten();
    charts
        .flat_map(|chart| chart.curves.iter().chain(chart.differences))
        .any(|curves| *curves == Curves::Field(plot))
}

/// Whether the layout of two runs shows differences of these curves.
pub(crate) fn compares(curves: Curves) -> bool {
    // The rates of a free peg are among the contrasts of motion.
    let mut shown = MOTION_CONTRASTS
        .iter()
        .chain(&TRAVEL_CONTRASTS)
        .chain(&FRICTION_CONTRASTS)
        .chain(&TABLE_CONTRASTS)
        .chain(&MORE_CONTRASTS);
    shown.any(|contrast| contrast.differences.contains(&curves))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Maximum length of a title: what the viewer has room for in a window of 1366 points.
    const MAX_TITLE: usize = 33;

    #[test]
    fn titles_are_not_cut() {
        let pages = [&RISE[..], &TRAVEL, &TABLE, &RATES, &MORE, &TERMS];
        for chart in pages.into_iter().flatten() {
            let title = chart.title();
            assert!(title.chars().count() <= MAX_TITLE, "{title}");
        }
    }
}

//! Turning points just before the end of a phase that the motion does not complete.

use super::Runner;
use crate::physics::dynamics::{Formulation, Motion};
use crate::physics::integrate::{Dense, KNOTS, Slope};
use crate::run::simulation::watch::{Zero, ZeroKind, inclination_noise};

impl<F: Formulation<N>, const N: usize> Runner<F, N> {
    /// Discards reversals of the precession and extremes of θ just before the end of the phase, if the motion doesn't
    /// leave its noise in the rest of the phase. Only equations that no longer apply would complete them: the motion may
    /// stop for good, and if it does reverse, the next phase finds that.
    pub(super) fn discard_unfinished_turns(&mut self, dense: &Dense<N>, zeros: &mut Vec<Zero>) {
        let Some(Zero { s: end, .. }) = zeros.iter().find(|zero| zero.ends_phase()).copied() else {
            return;
        };
        // Before an earlier reversal is reversed, it has left the noise.
        if let Some(at) = last_before(zeros, ZeroKind::Precession, end)
            && !self.leaves_precession_noise(dense, zeros[at], end)
        {
            self.discard(zeros, at);
        }
        // Extremes have no such noise of their own: several may follow each other.
        while let Some(at) = last_before(zeros, ZeroKind::Nutation, end)
            && !self.leaves_inclination_noise(dense, zeros[at].s, end)
        {
            self.discard(zeros, at);
        }
    }

    /// Discards a zero; the tracker has the sign before it again.
    fn discard(&mut self, zeros: &mut Vec<Zero>, at: usize) {
        let zero = zeros.remove(at);
        self.reset_trackers(std::iter::once(zero));
    }

    /// Whether the precession leaves its noise between a reversal and the end of the phase.
    fn leaves_precession_noise(&self, dense: &Dense<N>, reversal: Zero, end: f64) -> bool {
        let kind = reversal.kind;
        let Some(function) = self.watched.iter().find(|known| known.kind == kind) else {
            return true;
        };
        let noise = function.tracker.noise_level();
        let motions = self.motions_between(dense, reversal.s, end);
        let values = kind.values(self.integrator.system(), self.sense, &motions);
        match reversal.slope {
            Slope::Rising => values.iter().any(|value| *value > noise),
            Slope::Falling => values.iter().any(|value| *value < -noise),
        }
    }

    /// Whether θ leaves its noise between an extreme and the end of the phase.
    fn leaves_inclination_noise(&self, dense: &Dense<N>, start: f64, end: f64) -> bool {
        let steps = self.integrator.statistics().accepted;
        let noise = inclination_noise(&self.tolerances, steps);
        let thetas = self
            .motions_between(dense, start, end)
            .map(|motion| motion.angles.theta);
        thetas.iter().any(|theta| (theta - thetas[0]).abs() > noise)
    }

    /// Motions at equal distances from one fraction of a step to another.
    fn motions_between(&self, dense: &Dense<N>, start: f64, end: f64) -> [Motion; KNOTS.len()] {
        KNOTS.map(|knot| self.motion_without_integrals(dense, start + knot * (end - start)))
    }

    /// Resets the trackers of crossings that are discarded because the step ends early.
    pub(super) fn reset_trackers(&mut self, discarded: impl DoubleEndedIterator<Item = Zero>) {
        // In reverse order, so that the sign before the first crossing remains.
        for Zero { kind, slope, .. } in discarded.rev() {
            if let Some(function) = self.watched.iter_mut().find(|known| known.kind == kind) {
                function.tracker = function.tracker.before(slope);
            }
        }
    }
}

/// Index of the last zero of a kind before a fraction of the step.
fn last_before(zeros: &[Zero], kind: ZeroKind, end: f64) -> Option<usize> {
    zeros
        .iter()
        .rposition(|zero| zero.kind == kind && zero.s <= end)
}

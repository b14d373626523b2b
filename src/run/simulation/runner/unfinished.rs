//! Turning points just before the end of a phase that the motion does not complete.

use super::Runner;
use crate::physics::dynamics::{Formulation, Motion};
use crate::physics::integrate::{Dense, KNOTS, Slope};
use crate::run::simulation::watch::{ZeroKind, inclination_floor};

/// A zero of a watched function in a step: the fraction of the step, its kind and its direction.
type Zero = (f64, ZeroKind, Slope);

impl<F: Formulation<N>, const N: usize> Runner<F, N> {
    /// Discards reversals of the precession and extremes of θ just before the end of the phase, if the motion doesn't
    /// leave its noise in the rest of the phase. Only equations that no longer apply would complete them: the motion may
    /// stop for good, and if it does reverse, the next phase finds that.
    pub(super) fn discard_unfinished_turns(&mut self, dense: &Dense<N>, zeros: &mut Vec<Zero>) {
        let Some(end) = zeros.iter().position(ends_phase) else {
            return;
        };
        let end = zeros[end].0;
        // Before an earlier reversal is reversed, it has left the noise.
        if let Some(at) = last_before(zeros, ZeroKind::Precession, end)
            && !self.leaves_precession_noise(dense, zeros[at], end)
        {
            self.discard(zeros, at);
        }
        // Extremes have no such noise of their own: several may follow each other.
        while let Some(at) = last_before(zeros, ZeroKind::Nutation, end)
            && !self.leaves_inclination_noise(dense, zeros[at].0, end)
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
    fn leaves_precession_noise(
        &self,
        dense: &Dense<N>,
        (start, kind, slope): Zero,
        end: f64,
    ) -> bool {
        let Some(watch) = self.watches.iter().find(|watch| watch.kind == kind) else {
            return true;
        };
        let floor = watch.tracker.noise_level();
        let motions = self.motions_between(dense, start, end);
        let values = kind.values(self.integrator.system(), self.sense, &motions);
        match slope {
            Slope::Rising => values.iter().any(|value| *value > floor),
            Slope::Falling => values.iter().any(|value| *value < -floor),
        }
    }

    /// Whether θ leaves its noise between an extreme and the end of the phase.
    fn leaves_inclination_noise(&self, dense: &Dense<N>, start: f64, end: f64) -> bool {
        let steps = self.integrator.statistics().accepted;
        let floor = inclination_floor(&self.tolerances, steps);
        let thetas = self
            .motions_between(dense, start, end)
            .map(|motion| motion.angles.theta);
        thetas.iter().any(|theta| (theta - thetas[0]).abs() > floor)
    }

    /// Motions at equal distances from one fraction of a step to another.
    fn motions_between(&self, dense: &Dense<N>, start: f64, end: f64) -> [Motion; KNOTS.len()] {
        KNOTS.map(|knot| self.motion_without_integrals(dense, start + knot * (end - start)))
    }

    /// Resets the trackers of crossings that are discarded because the step ends early.
    pub(super) fn reset_trackers(
        &mut self,
        crossings: impl DoubleEndedIterator<Item = (f64, ZeroKind, Slope)>,
    ) {
        // In reverse order, so that the sign before the first crossing remains.
        for (_, kind, slope) in crossings.rev() {
            let watch = self.watches.iter_mut().find(|watch| watch.kind == kind);
            if let Some(watch) = watch {
                watch.tracker = watch.tracker.before(slope);
            }
        }
    }
}

/// Index of the last zero of a kind before a fraction of the step.
fn last_before(zeros: &[Zero], kind: ZeroKind, end: f64) -> Option<usize> {
    zeros
        .iter()
        .rposition(|zero| zero.1 == kind && zero.0 <= end)
}

/// Whether a crossing ends the phase.
fn ends_phase((_, kind, slope): &(f64, ZeroKind, Slope)) -> bool {
    matches!(kind, ZeroKind::Guard(_)) && *slope == Slope::Falling
}

//! A formulation that carries few running integrals along: what an outcome needs costs less to integrate.

use super::bounds::EulerBounds;
use super::formulation::{Entry, Formulation, Guard, Passage};
use super::integrals::{INTEGRALS, Kept};
use super::model::Model;
use super::motion::{Motion, Start};
use super::support::Phase;
use crate::physics::integrate::{Dense, IntegrateError, System};
use crate::physics::kinematics::Euler;
use nalgebra::UnitQuaternion;

/// How many of the [`INTEGRALS`] are kept: the work of friction and the path slipped.
const FEW: usize = 2;

/// The formulation `F`, whose states have `FULL` numbers, with the work of friction and the path slipped as its only
/// running integrals. A motion's other integrals are 0; everything else is that of `F`, to the last bit, because
/// integrals don't influence the motion.
#[derive(Clone, Copy, Debug)]
pub struct FewIntegrals<F, const FULL: usize>(F);

impl<F: Formulation<FULL>, const FULL: usize, const N: usize> System<N> for FewIntegrals<F, FULL> {
    const CONTROLLED: usize = F::CONTROLLED;

    #[inline]
    fn derivative(&self, _t: f64, y: &[f64; N]) -> [f64; N] {
        self.slope(y, Kept::Few)
    }
}

impl<F: Formulation<FULL>, const FULL: usize, const N: usize> Formulation<N>
    for FewIntegrals<F, FULL>
{
    const ERROR_SHARE: f64 = F::ERROR_SHARE;

    fn start(model: &Model, start: &Start, may_hold: bool) -> (Self, [f64; N], Option<Passage>) {
        let (formulation, state, passage) = F::start(model, start, may_hold);
        (Self(formulation), narrowed(&state), passage)
    }

    #[inline]
    fn slope(&self, state: &[f64; N], _kept: Kept) -> [f64; N] {
        narrowed(&self.0.slope(&widened(state), Kept::Few))
    }

    #[inline]
    fn motion_without_turns(&self, state: &[f64; N], reference: Euler) -> Motion {
        self.0.motion_without_turns(&widened(state), reference)
    }

    #[inline]
    fn angles(&self, state: &[f64; N], reference: Euler) -> Euler {
        self.0.angles(&widened(state), reference)
    }

    #[inline]
    fn bounds<const M: usize>(&self, step: &Dense<M>) -> Option<EulerBounds> {
        self.0.bounds(step)
    }

    fn world_from_body(&self, state: &[f64; N]) -> UnitQuaternion<f64> {
        self.0.world_from_body(&widened(state))
    }

    fn model(&self) -> &Model {
        self.0.model()
    }

    fn phase(&self) -> Phase {
        self.0.phase()
    }

    fn guards(&self) -> &'static [Guard] {
        self.0.guards()
    }

    #[inline]
    fn guard(&self, guard: Guard, motion: &Motion) -> f64 {
        self.0.guard(guard, motion)
    }

    #[inline]
    fn guard_is_positive(&self, guard: Guard, bounds: &EulerBounds) -> bool {
        self.0.guard_is_positive(guard, bounds)
    }

    fn enter(
        &self,
        guard: Guard,
        state: &[f64; N],
        reference: Euler,
    ) -> Result<Entry<Self, N>, IntegrateError> {
        let entry = self.0.enter(guard, &widened(state), reference)?;
        Ok(Entry {
            formulation: Self(entry.formulation),
            state: narrowed(&entry.state),
            delay: entry.delay,
            passage: entry.passage,
            motion: entry.motion,
            first_step: entry.first_step,
        })
    }
}

/// A state with all integrals, of which those that are not kept are 0.
#[inline]
fn widened<const N: usize, const FULL: usize>(state: &[f64; N]) -> [f64; FULL] {
    const {
        assert!(N + INTEGRALS == FULL + FEW);
    }
    let mut full = [0.0; FULL];
    full[..N].copy_from_slice(state);
    full
}

/// A state without the integrals that are not kept.
#[inline]
fn narrowed<const FULL: usize, const N: usize>(full: &[f64; FULL]) -> [f64; N] {
    std::array::from_fn(|i| full[i])
}

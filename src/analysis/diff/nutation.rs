//! Where the nutation of a run ends.

use crate::analysis::course::Cycle;

/// A cycle that lasts so many times as long as the one before it is none. The period of a nutation follows from the
/// spin and the inclination, which change little in one turn: in no run does it grow by more than an eighth from one
/// nutation to the next, while θ̇ takes eight times as long and more to come to its next maximum in a fall.
const LONGEST: f64 = 2.0;

/// Leaves out what comes after the last nutation: a fall, or whatever is not a small swing about a slow motion. Then
/// the averages mean nothing, and recordings of earlier versions have cycles there nevertheless.
pub(super) fn end_with_nutation(cycles: &mut Vec<Cycle>) {
    let is_broken = |pair: &[Cycle]| {
        let ratio = pair[1].period / pair[0].period;
        // Where something else was in between, the next cycle doesn't begin where the last one ended.
        let gap = pair[1].start - (pair[0].start + pair[0].period);
        !(1.0 / LONGEST..=LONGEST).contains(&ratio) || gap.abs() > 0.5 * pair[0].period
    };
    if let Some(last) = cycles.windows(2).position(is_broken) {
        cycles.truncate(last + 1);
    }
}

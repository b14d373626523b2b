//! Section b of a report: what happened in one run and in the other.
//!
//! The rise, or the fall, is told twice: when the averaged motions passed a level of θ that both reach, which says by
//! how much one is ahead, and when θ itself first touched one, which depends on which dip of the nutation does.

use super::budget::{Budget, Energies};
use super::events::{EventKindDifference, EventMoment, EventPair, Events};
use super::floor::Floor;
use super::passage::{LevelPassage, ripple};
use super::touch::{CommonLevels, Levels, Touches};
use crate::analysis::course::Course;
use crate::run::simulation::EventKind;
use schemars::JsonSchema;
use serde::Serialize;

/// Section b: what happened.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Happened {
    /// Kinds of events that both or one of them have.
    pub kinds: Vec<EventKindDifference>,
    /// Pairs of events, without nutation extremes.
    pub matched: Vec<EventPair>,
    /// Events that only A has, with nutation extremes.
    pub only_in_a: Vec<EventMoment>,
    /// Events that only B has, with nutation extremes.
    pub only_in_b: Vec<EventMoment>,
    /// The farthest level of θ, averaged over each nutation, that both pass, rad.
    pub averaged_level: Option<f64>,
    /// When A's averaged θ passes it, s.
    pub averaged_crossing_a: Option<f64>,
    /// When B's averaged θ passes it, s.
    pub averaged_crossing_b: Option<f64>,
    /// By how much B's averaged motion is later there, s.
    pub averaged_shift: Option<f64>,
    /// How exactly that is known, s: up to the integrators' errors, the error of interpolating between averages, and
    /// what an average over one nutation keeps of it.
    pub averaged_shift_uncertainty: Option<f64>,
    /// The level at which a top counts as risen, rad: the higher one if the two runs have different ones.
    pub risen_level: Option<f64>,
    /// When A's θ first touches it, s.
    pub risen_a: Option<f64>,
    /// When B's θ first touches it, s.
    pub risen_b: Option<f64>,
    /// By how much B touches it later, s.
    pub rise_shift: Option<f64>,
    /// How much earlier (negative) and later the nutation can make A's θ touch a level than its average, s.
    pub rise_by_nutation_a: Option<[f64; 2]>,
    /// How much earlier (negative) and later the nutation can make B's θ touch a level than its average, s.
    pub rise_by_nutation_b: Option<[f64; 2]>,
    /// How far the nutations of both, and the integrators' errors, can move the shift down and up, s.
    pub rise_shift_uncertainty: Option<[f64; 2]>,
    /// The level at which a top counts as fallen, rad: the lower one if the two runs have different ones.
    pub fallen_level: Option<f64>,
    /// When A's θ first touches it, s.
    pub fallen_a: Option<f64>,
    /// When B's θ first touches it, s.
    pub fallen_b: Option<f64>,
    /// What A has lost by its end.
    pub budget_a: Option<Budget>,
    /// What B has lost by its end.
    pub budget_b: Option<Budget>,
    /// What A has lost by the end of the one that ends first; absent where equal times are not compared.
    pub common_budget_a: Option<Budget>,
    /// What B has lost by then.
    pub common_budget_b: Option<Budget>,
    /// A's θ, averaged over its first and its last nutation, rad.
    pub averaged_ends_a: Option<[f64; 2]>,
    /// B's θ, averaged over its first and its last nutation, rad.
    pub averaged_ends_b: Option<[f64; 2]>,
    /// A's θ in its first and its last sample, rad.
    pub theta_ends_a: Option<[f64; 2]>,
    /// B's θ in its first and its last sample, rad.
    pub theta_ends_b: Option<[f64; 2]>,
}

impl Happened {
    /// Whether the averaged motions are shifted by more than is uncertain; none where they pass no common level.
    #[must_use]
    pub fn is_averaged_shift_clear(&self) -> Option<bool> {
        Some(self.averaged_shift?.abs() > self.averaged_shift_uncertainty?)
    }

    /// When an event of a kind first was in A and in B, s.
    #[must_use]
    pub fn first(&self, kind: EventKind) -> [Option<f64>; 2] {
        let earliest = |times: &mut dyn Iterator<Item = f64>| times.reduce(f64::min);
        let pairs = || self.matched.iter().filter(|pair| pair.name == kind.name());
        let alone = |events: &[EventMoment]| -> Vec<f64> {
            let events = events.iter().filter(|event| event.name == kind.name());
            events.map(|event| event.time).collect()
        };
        let (of_a, of_b) = (alone(&self.only_in_a), alone(&self.only_in_b));
        [
            earliest(&mut pairs().map(|pair| pair.time_a).chain(of_a)),
            earliest(&mut pairs().map(|pair| pair.time_b).chain(of_b)),
        ]
    }

    /// Whether the first touches are apart by more than the nutation can move them; none where that isn't known.
    #[must_use]
    pub fn is_rise_shift_clear(&self) -> Option<bool> {
        let (shift, [least, greatest]) = (self.rise_shift?, self.rise_shift_uncertainty?);
        Some(!(least..=greatest).contains(&shift))
    }
}

/// What is known of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ran<'r> {
    pub(super) course: &'r Course,
    pub(super) touches: &'r Touches,
    pub(super) energies: &'r Energies,
    /// Its energies at the times of both, if these are equal.
    pub(super) common: Option<&'r Energies>,
}

impl Ran<'_> {
    /// When it ended, s.
    fn end(&self) -> Option<f64> {
        let stop = self.course.report().stop_time;
        stop.or_else(|| self.energies.end())
    }
}

/// Compares what happened; events only if both have recorded them.
pub(super) fn compare(
    runs: [Ran<'_>; 2],
    levels: CommonLevels,
    both_have_events: bool,
    floor: Option<&Floor>,
) -> Happened {
    let [a, b] = runs;
    let integrators = floor.map_or([0.0; 2], |floor| [floor.a.theta_mean, floor.b.theta_mean]);
    let passage = LevelPassage::find(a.course, b.course, integrators);
    let mut happened = Happened::default();
    if both_have_events {
        let events = Events::compare(a.course, b.course, passage.as_ref());
        happened.kinds = events.kinds;
        happened.matched = events.matched;
        happened.only_in_a = events.only_in_a;
        happened.only_in_b = events.only_in_b;
    }
    if let Some(passage) = &passage {
        let [x, y] = passage.times;
        happened.averaged_level = Some(passage.level);
        (happened.averaged_crossing_a, happened.averaged_crossing_b) = (Some(x), Some(y));
        happened.averaged_shift = Some(passage.shift());
        happened.averaged_shift_uncertainty = Some(passage.uncertainty);
    }
    [happened.averaged_ends_a, happened.averaged_ends_b] = runs.map(|ran| {
        let cycles = &ran.course.cycles;
        Some([cycles.first()?.means[0], cycles.last()?.means[0]])
    });
    touch(runs, levels, floor, &mut happened);
    let up_to = |energies: &Energies, end: Option<f64>| energies.up_to(end?);
    happened.budget_a = up_to(a.energies, a.end());
    happened.budget_b = up_to(b.energies, b.end());
    let end = a.end().zip(b.end()).map(|(a, b)| a.min(b));
    happened.common_budget_a = a.common.and_then(|common| up_to(common, end));
    happened.common_budget_b = b.common.and_then(|common| up_to(common, end));
    happened
}

/// When θ first touches the levels, and what the nutation can do to that.
fn touch(
    [a, b]: [Ran<'_>; 2],
    CommonLevels { common, own }: CommonLevels,
    floor: Option<&Floor>,
    happened: &mut Happened,
) {
    happened.fallen_level = common.fallen;
    happened.fallen_a = a.touches.fallen();
    happened.fallen_b = b.touches.fallen();
    // A run without events still tells when it ended, and why.
    let risen = |ran: Ran<'_>, own: Levels| {
        let at_end = || ran.course.report().rise_time;
        ran.touches
            .risen()
            .or_else(|| at_end().filter(|_| own.risen == common.risen))
    };
    happened.theta_ends_a = a.touches.ends();
    happened.theta_ends_b = b.touches.ends();
    happened.risen_level = common.risen;
    happened.risen_a = risen(a, own[0]);
    happened.risen_b = risen(b, own[1]);
    let (Some(x), Some(y)) = (happened.risen_a, happened.risen_b) else {
        return;
    };
    happened.rise_shift = Some(y - x);
    happened.rise_by_nutation_a = ripple(a.course, x);
    happened.rise_by_nutation_b = ripple(b.course, y);
    let errors = floor.map_or(0.0, |floor| floor.a.event_shift + floor.b.event_shift);
    let ripples = happened.rise_by_nutation_a.zip(happened.rise_by_nutation_b);
    happened.rise_shift_uncertainty = ripples.map(|([first_a, last_a], [first_b, last_b])| {
        [first_b - last_a - errors, last_b - first_a + errors]
    });
}

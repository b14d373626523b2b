//! What comes to rest, rests: slip, rocking and turning about the vertical, held by friction alone and together.

mod regularised;
mod release;
mod spin;

use self::regularised::{Kinetics, Regularised};
use crate::random_scenarios::{Random, count};
use crate::support::{Run, assert_near, scenario};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt::{self, Display, Formatter};
use toprise::physics::kinematics::Tilt;
use toprise::run::outcome::outcome;
use toprise::run::scenario::{Preset, Scenario, Values};
use toprise::run::simulation::{EventKind, StopReason};

/// More steps than this in a second of motion are too many.
const MAX_STEPS: f64 = 1e5;

/// At most one top in this number may need more steps. Friction is stiff where a top hardly turns under Coulomb–Contensou
/// friction, or begins to move so slowly that the direction of its motion follows that of the torque.
const RARE: usize = 100;

/// How a top starts.
#[derive(Clone, Copy, Debug)]
enum Beginning {
    /// At rest.
    Rest,
    /// Turning about the vertical only.
    Turning,
    /// Rocking in a plane.
    Planar,
    /// Slowly, so that it comes to rest.
    Slow,
}

/// A random top with set-valued friction that starts at rest, passes through it or comes to it.
fn scenario_near_rest(random: &mut Random, is_free: bool) -> Option<Scenario> {
    let preset = if is_free {
        "free-paper"
    } else {
        "full-coulomb"
    };
    let mut values = Preset::find(preset).unwrap().values().unwrap();
    for key in ["stop.theta_risen", "stop.theta_fallen"] {
        values.set(key, "").unwrap();
    }
    values.set("stop.duration", "0.3").unwrap();
    values.set("sampling.period", "0.1").unwrap();
    let is_euler = !is_free && random.below(3) == 0;
    values
        .set("formulation", if is_euler { "euler" } else { "body" })
        .unwrap();
    let hangs = random.below(2) == 0;
    if is_free && hangs {
        // A tippe top.
        for (key, value) in [
            ("top.mass", "0.020"),
            ("top.transverse_moment", "3.714285714285714e-6"),
            ("top.axial_moment", "3.2e-6"),
            ("top.center_distance", "-0.006"),
            ("top.peg_radius", "0.020"),
        ] {
            values.set(key, value).unwrap();
        }
    }
    set_friction(random, &mut values, is_free);
    let near = if random.below(2) == 0 { 0.05 } else { 1.2 };
    let inclined = near * random.unit() + 1e-3;
    let theta = if !is_free && hangs {
        PI - inclined
    } else {
        inclined
    };
    let beginning = [
        Beginning::Rest,
        Beginning::Turning,
        Beginning::Planar,
        Beginning::Slow,
    ][random.below(4)];
    let [phi, theta_dot, psi] = match beginning {
        Beginning::Rest => [0.0; 3],
        Beginning::Turning => [20.0 * random.symmetric(), 0.0, 0.0],
        Beginning::Planar => [0.0, 3.0 * random.symmetric(), 0.0],
        Beginning::Slow => [3.0, 3.0, 3.0].map(|size| size * random.symmetric()),
    };
    for (key, value) in [
        ("initial.theta", theta),
        ("initial.phi_dot", phi),
        ("initial.theta_dot", theta_dot),
        ("initial.psi_dot", psi),
    ] {
        values.set_value(key, value).unwrap();
    }
    Scenario::new(values.clone())
        .or_else(|_| {
            values.set("stop.on_stick", "").unwrap();
            Scenario::new(values)
        })
        .ok()
}

/// Random tops near rest, with either support.
fn scenarios_near_rest(random: &mut Random) -> impl Iterator<Item = Scenario> {
    std::iter::repeat_with(|| {
        let is_free = random.below(2) == 0;
        scenario_near_rest(random, is_free)
    })
    .flatten()
}

fn set_friction(random: &mut Random, values: &mut Values, is_free: bool) {
    // A free peg jams where k is above 2 (Painlevé).
    let largest = if is_free { 1.0 } else { 3.0 };
    let k = [0.03, 0.3, largest][random.below(3)] * (0.5 + random.unit());
    values.set_value("friction.k", k).unwrap();
    values.set("stop.on_stick", "continue").unwrap();
    match random.below(4) {
        0 => {
            values.set("friction.law", "viscous").unwrap();
            values.set("friction.viscous_speed", "0.5").unwrap();
        }
        1 => {
            values.set("friction.law", "none").unwrap();
            values.set("friction.k", "").unwrap();
            values.set("friction.dissipation", "").unwrap();
        }
        2 => {}
        _ => {
            values.set("friction.law", "contensou").unwrap();
            values.set("friction.patch_radius", "1e-3").unwrap();
        }
    }
    if random.below(3) > 0 {
        let arm = [1e-5, 1e-4, 1e-3][random.below(3)] * (0.5 + random.unit());
        values.set_value("rolling.arm", arm).unwrap();
    }
    // Coulomb–Contensou friction drills by itself.
    if random.below(3) > 0 && values.get("friction.patch_radius").is_none() {
        values
            .set_value("drilling.k", 0.05 + random.unit())
            .unwrap();
        let radius = [2e-4, 2e-3][random.below(2)];
        values.set_value("drilling.patch_radius", radius).unwrap();
    }
}

/// Result of a comparison.
enum Comparison {
    Agrees,
    /// The regularised model does not converge, or the peg leaves the table.
    Undecided(&'static str),
    /// The run needs more steps than [`MAX_STEPS`] a second.
    Slow,
    Wrong(String),
}

/// Compares the end of a run with the regularised model.
///
/// That model is computed with two smoothing speeds, of which one is a tenth of the other. Its error is proportional to
/// that speed (a jump is smoothed, and a top at rest creeps), so the error of the better one is a ninth of their
/// difference. The difference itself is allowed, and the integrator's errors: 1e-9 a step and unit.
fn compare(scenario: &Scenario) -> Comparison {
    let duration = scenario.stop.duration.unwrap();
    let mut steps = 0.0;
    let result = outcome(scenario, || {
        steps += 1.0;
        steps <= MAX_STEPS * duration
    });
    let found = match result {
        Err(error) => return Comparison::Wrong(error.to_string()),
        Ok(found) => found,
    };
    match found.end.stop {
        StopReason::Interrupted => {
            return Comparison::Slow;
        }
        StopReason::Duration | StopReason::Rest | StopReason::Pivot => {}
        StopReason::SlipStopped | StopReason::Singular | StopReason::Jam => {
            return Comparison::Undecided("ends otherwise");
        }
        other => return Comparison::Wrong(format!("ends with {other:?}")),
    }
    if found.tally.count_of(EventKind::LiftOff) > 0 {
        return Comparison::Undecided("lifts off");
    }
    let motion = found.end.motion;
    let slip = motion.slip_velocity(&scenario.model.top).norm();
    let end = Kinetics::new(motion.angles.theta, &motion.tilt, slip);
    let start = Tilt::from_rates(scenario.angles.theta, scenario.rates);
    let [rough, fine] = [1e-5, 1e-6].map(|speed| {
        Regularised::new(&scenario.model, speed).run(
            scenario.angles.theta,
            &start,
            scenario.start().peg_velocity,
            duration,
        )
    });
    let (Some(rough), Some(fine)) = (rough, fine) else {
        return Comparison::Undecided("the regularised model fails");
    };
    let spread = rough.distance(&fine);
    if spread > 0.05 {
        return Comparison::Undecided("the regularised model does not converge");
    }
    let gap = end.distance(&fine);
    if gap > spread + 1e-6 {
        Comparison::Wrong(format!(
            "{gap:e} > {spread:e}: {end:?}, regularised {fine:?}"
        ))
    } else {
        Comparison::Agrees
    }
}

/// Results of comparisons, counted.
#[derive(Debug, Default)]
struct Comparisons {
    agree: usize,
    slow: usize,
    undecided: BTreeMap<&'static str, usize>,
    wrong: Vec<String>,
}

impl Comparisons {
    /// Compares a scenario, and counts the result.
    fn compare(&mut self, number: usize, scenario: &Scenario) {
        match compare(scenario) {
            Comparison::Agrees => self.agree += 1,
            Comparison::Slow => {
                self.slow += 1;
                println!("slow: {number}\n{}", scenario.to_toml());
            }
            Comparison::Undecided(why) => *self.undecided.entry(why).or_insert(0) += 1,
            Comparison::Wrong(why) => {
                self.wrong
                    .push(format!("{number}: {why}\n{}", scenario.to_toml()));
            }
        }
    }
}

impl Display for Comparisons {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self {
            agree,
            slow,
            undecided,
            wrong,
        } = self;
        write!(
            f,
            "{agree} agree, {slow} slow, undecided {undecided:?}, {} wrong",
            wrong.len()
        )
    }
}

/// Compares random tops and returns those that are wrong. Few are slow.
fn find_wrong(seed: u64, tops: usize) -> Vec<String> {
    let mut random = Random(seed);
    let mut comparisons = Comparisons::default();
    for (number, scenario) in (1..=tops).zip(scenarios_near_rest(&mut random)) {
        comparisons.compare(number, &scenario);
    }
    println!("{tops} tops: {comparisons}");
    let slow = comparisons.slow;
    assert!(RARE * slow <= tops, "{slow} of {tops} are slow");
    comparisons.wrong
}

fn assert_none(wrong: &[String]) {
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn val_random_tops_agree_with_regularised_friction() {
    assert_none(&find_wrong(1, 60));
}

#[test]
#[ignore = "takes minutes"]
fn val_many_random_tops_agree_with_regularised_friction() {
    assert_none(&find_wrong(2, count().unwrap_or(1000)));
}

#[test]
#[ignore = "takes minutes"]
fn many_random_tops_near_rest_finish() {
    let mut random = Random(3);
    let tops = count().unwrap_or(10_000);
    let (mut ends, mut failed) = (BTreeMap::new(), Vec::new());
    for (number, scenario) in (1..=tops).zip(scenarios_near_rest(&mut random)) {
        let limit = MAX_STEPS * scenario.stop.duration.unwrap();
        let mut steps = 0.0;
        let result = outcome(&scenario, || {
            steps += 1.0;
            steps <= limit
        });
        match result {
            Ok(found) => {
                *ends.entry(found.end.stop.name()).or_insert(0) += 1;
                if found.end.stop == StopReason::Interrupted {
                    println!(
                        "slow: {number}: at {} s\n{}",
                        found.end.time,
                        scenario.to_toml()
                    );
                }
            }
            Err(error) => failed.push(format!("{number}: {error}\n{}", scenario.to_toml())),
        }
    }
    println!("{tops} tops: {ends:?}, {} failed", failed.len());
    assert_none(&failed);
    let slow = ends.get("interrupted").copied().unwrap_or_default();
    assert!(RARE * slow <= tops, "{slow} of {tops} are slow");
}

const AT_REST: [(&str, &str); 2] = [("initial.psi_dot", "0"), ("initial.phi_dot", "0")];

#[test]
fn rolling_resistance_below_gravity_does_not_hold_a_free_top() {
    let mut keys = AT_REST.to_vec();
    keys.push(("rolling.arm", "1e-4"));
    let run = Run::with("free-paper", &keys);
    assert_eq!(run.end.stop, StopReason::Fallen);
    assert_near("t", run.end.time, 0.105, 5e-4);
}

#[test]
fn val_rocking_tippe_top_turns_like_planar_model() {
    let mut keys = AT_REST[..1].to_vec();
    keys.extend([
        ("initial.theta", "1"),
        ("initial.theta_dot", "1"),
        ("rolling.arm", "1e-5"),
        ("stop.duration", "12"),
    ]);
    let run = Run::with("tippe-top", &keys);
    // Turning points of a planar model, to the digits it was computed to.
    let expected = [1.002, 0.736, 0.490];
    let maxima = run.events_of(EventKind::NutationMaximum);
    for (turn, expected) in maxima.zip(expected) {
        assert_near("θ", turn.motion.angles.theta, expected, 5e-4);
    }
    // It stops rocking where gravity's torque M g l sin θ is within δ N.
    assert!(libm::sin(run.end.motion.angles.theta) <= 1e-5 / 0.006);
    // It does not turn about the vertical.
    assert_eq!(run.events_of(EventKind::Pivot).count(), 0);
    let last = run.samples.last().unwrap();
    assert_eq!(last.tilt.omega_lean.norm(), 0.0);
}

#[test]
fn val_drilling_stops_upright_spin() {
    for law in ["coulomb", "stribeck", "coulomb-sqrt", "viscous"] {
        let mut keys = vec![
            ("formulation", "body"),
            ("friction.law", law),
            ("initial.theta", "0"),
            ("initial.phi_dot", "0"),
            ("initial.psi_dot", "5"),
            ("stop.theta_risen", ""),
            ("stop.theta_fallen", ""),
            ("drilling.k", "0.2"),
            ("drilling.patch_radius", "2e-3"),
            ("stop.duration", "3"),
        ];
        match law {
            "stribeck" => keys.extend([
                ("friction.static_k", "0.04"),
                ("friction.stribeck_speed", "0.05"),
                ("friction.viscous_slope", "0"),
            ]),
            "coulomb-sqrt" => keys.push(("friction.smoothing_speed", "0.05")),
            "viscous" => keys.push(("friction.viscous_speed", "0.5")),
            _ => {}
        }
        let run = Run::with("full-coulomb", &keys);
        let torque = 3.0 * PI / 16.0 * 0.2 * 0.110 * 9.81 * 2e-3;
        let stops = 5.0 * 7.25e-5 / torque;
        for sample in &run.samples {
            let left = (5.0 - torque / 7.25e-5 * sample.time_ns as f64 / 1e9).max(0.0);
            assert_near(law, sample.tilt.omega_lean.z, left, 1e-10);
        }
        // A smooth law can't hold the top, which stands exactly upright.
        let rests = matches!(law, "coulomb" | "stribeck");
        let expected = if rests {
            StopReason::Rest
        } else {
            StopReason::Duration
        };
        assert_eq!(run.end.stop, expected, "{law}");
        if rests {
            assert_near("t", run.end.time, stops, 1e-10);
        }
    }
}

#[test]
fn static_friction_holds_top_from_start() {
    for formulation in ["euler", "body"] {
        for on_stick in ["stop", "continue"] {
            let mut keys = AT_REST.to_vec();
            keys.extend([
                ("formulation", formulation),
                ("friction.k", "2"),
                ("stop.on_stick", on_stick),
                ("stop.duration", "3"),
            ]);
            let run = Run::with("full-coulomb", &keys);
            assert_eq!(run.end.stop, StopReason::Rest, "{formulation} {on_stick}");
            assert_eq!(run.end.time, 0.0);
        }
    }
}

#[test]
fn hanging_tops_come_to_rest_within_static_friction() {
    for (law, patch) in [("coulomb", ""), ("contensou", "1e-3")] {
        for (theta, theta_dot, phi_dot, psi_dot) in [
            ("3", "0", "0", "5"),
            ("2", "1", "0", "0"),
            ("2.5", "0", "4", "30"),
            ("3.1", "1", "2", "3"),
        ] {
            let mut keys = vec![
                ("formulation", "body"),
                ("friction.law", law),
                ("friction.patch_radius", patch),
                ("friction.k", "0.3"),
                ("initial.theta", theta),
                ("initial.theta_dot", theta_dot),
                ("initial.phi_dot", phi_dot),
                ("initial.psi_dot", psi_dot),
                ("stop.theta_risen", ""),
                ("stop.theta_fallen", ""),
                ("stop.on_stick", "continue"),
                ("stop.duration", "60"),
            ];
            if law == "coulomb" {
                keys.extend([("drilling.k", "0.3"), ("drilling.patch_radius", "1e-3")]);
            }
            let run = Run::with("full-coulomb", &keys);
            let what = format!("{law} {theta} {theta_dot} {phi_dot} {psi_dot}");
            assert_eq!(run.end.stop, StopReason::Rest, "{what}");
            assert_eq!(run.end.motion.tilt.omega_lean.norm(), 0.0, "{what}");
            // M g l sin θ ≤ k M g R.
            let sine = libm::sin(run.end.motion.angles.theta);
            assert!(sine <= 0.3 * 0.007 / 0.020 * (1.0 + 1e-9), "{what}: {sine}");
        }
    }
}

#[test]
fn on_stick_ignores_turning_points() {
    // The first turning point of a swing in a plane is no end.
    let keys = [
        ("formulation", "body"),
        ("initial.theta", "2"),
        ("initial.phi_dot", "0"),
        ("initial.psi_dot", "0"),
        ("stop.theta_risen", ""),
        ("stop.theta_fallen", ""),
        ("stop.duration", "60"),
    ];
    let run = Run::of(&scenario("full-coulomb", &keys));
    assert!(run.events_of(EventKind::SlipStops).count() > 3);
    assert!(matches!(
        run.end.stop,
        StopReason::SlipStopped | StopReason::Rest
    ));
    let sine = libm::sin(run.end.motion.angles.theta);
    assert!(sine <= 0.03 * 0.007 / 0.020 * (1.0 + 1e-6), "{sine}");
}

/// The inclination of a swinging top that sticks has its noise just before: 19 ns earlier, an extreme had an amplitude of
/// 1e-15 rad.
#[test]
fn sticking_tops_have_no_extreme_just_before() {
    let keys = [
        ("formulation", "body"),
        ("initial.theta", "3.1275672388414937"),
        ("initial.phi_dot", "1.5443960626411315"),
        ("initial.theta_dot", "1.3092817815849658"),
        ("initial.psi_dot", "2.5545591890678034"),
        ("friction.k", "0.2085091480983492"),
        ("rolling.arm", "5.697251105366981e-5"),
        ("stop.theta_risen", ""),
        ("stop.theta_fallen", ""),
        ("stop.on_stick", "continue"),
        ("stop.duration", "0.1"),
    ];
    let run = Run::with("full-coulomb", &keys);
    let names: Vec<_> = run.events.iter().map(|event| event.kind.name()).collect();
    let expected = ["start", "nutation_maximum", "looping_begins", "stick"];
    assert_eq!(names, expected);
}

/// Names of the events of a free top that starts with these keys and no precession, without those of the nutation.
fn events_near_rest(keys: &[(&str, &str)]) -> Vec<&'static str> {
    let mut all = vec![
        ("initial.phi_dot", "0"),
        ("initial.psi_dot", "0"),
        ("initial.theta", "0.3"),
        ("stop.theta_risen", ""),
        ("stop.theta_fallen", ""),
        ("stop.duration", "2"),
    ];
    all.extend(keys);
    let run = Run::with("free-paper", &all);
    let events = run.events.iter().map(|event| event.kind);
    let is_nutation = |kind: &EventKind| {
        matches!(
            kind,
            EventKind::NutationMinimum | EventKind::NutationMaximum
        )
    };
    let others = events.filter(|kind| !is_nutation(kind));
    others.map(EventKind::name).collect()
}

#[test]
fn stopping_precession_does_not_reverse() {
    for psi_dot in ["5", "-5"] {
        for arm in ["0.01", "0.02"] {
            let events = events_near_rest(&[
                ("initial.psi_dot", psi_dot),
                ("friction.k", "0.1"),
                ("rolling.arm", arm),
                ("drilling.k", "0.5"),
                ("drilling.patch_radius", "1e-3"),
            ]);
            let expected = ["start", "roll_begins", "pivot", "rest"];
            assert_eq!(events, expected, "{psi_dot} {arm}");
        }
    }
}

/// An upright top that doesn't move needs no friction to stay so.
#[test]
fn motionless_upright_free_tops_rest() {
    let upright = [("initial.theta", "0")];
    for (name, keys) in [
        ("coulomb", &[("friction.k", "0.3")][..]),
        (
            "contensou",
            &[
                ("friction.law", "contensou"),
                ("friction.patch_radius", "1e-3"),
            ],
        ),
        (
            "viscous",
            &[
                ("friction.law", "viscous"),
                ("friction.viscous_speed", "0.1"),
            ],
        ),
        (
            "none",
            &[
                ("friction.law", "none"),
                ("friction.k", ""),
                ("friction.dissipation", ""),
            ],
        ),
    ] {
        let events = events_near_rest(&[&upright, keys].concat());
        assert_eq!(events, ["start", "rest"], "{name}");
        let dropped = [("initial.height", "1e-3"), ("support.restitution", "0")];
        let events = events_near_rest(&[&upright, keys, &dropped].concat());
        assert_eq!(events, ["start", "landing", "rest"], "{name}");
        // Any tilt or rotation moves on.
        let turning = [("initial.psi_dot", "1")];
        let events = events_near_rest(&[&upright, keys, &turning].concat());
        assert_ne!(events.last(), Some(&"rest"), "{name}");
    }
}

#[test]
fn rest_events_name_held_components() {
    let frictionless = [
        ("friction.law", "none"),
        ("friction.k", ""),
        ("friction.dissipation", ""),
        ("rolling.arm", "0.01"),
    ];
    let sliding = [&frictionless[..], &[("initial.peg_x_dot", "0.1")]].concat();
    let held = [("friction.k", "0.3"), ("rolling.arm", "0.1")];
    let cases = [
        ("held as a whole", &held[..], &["start", "rest"][..]),
        (
            "at rest without friction",
            &frictionless,
            &["start", "rest"],
        ),
        ("slides without friction", &sliding, &["start"]),
    ];
    for (name, keys, expected) in cases {
        assert_eq!(events_near_rest(keys), expected, "{name}");
    }
}

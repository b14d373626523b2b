//! The causes that an explanation names are checked by the recorded numbers.

use crate::random_scenarios::{self, Random, free_tops, ordinary_held_tops};
use crate::support::{MemorySink, assert_near, scenario};
use nalgebra::Vector3;
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI};
use toprise::analysis::explain::{
    Claim, Explainer, Explanation, Fact, Hold, Inversion, Stopped, SufficientSpin, TimeSpan,
    explain,
};
use toprise::analysis::subject::ReadEnd;
use toprise::archive::format::end_entries;
use toprise::archive::sink::Sink as _;
use toprise::physics::math::{atan2, hypot, sin_cos};
use toprise::run::scenario::{PRESETS, Scenario};
use toprise::run::simulation::{EventKind, Simulation};
use toprise::telemetry::fields::{
    ACCELERATION, EVENTS, IMPACTS, NUTATION, NumberField, POSE, STATE, VectorField, acceleration,
    center_of_mass, contact, energy, events, free_peg, impacts, momentum, nutation, pose, state,
    torque,
};
use toprise::telemetry::{Message, Telemetry, Topic};

/// Maximum number of integrator steps of a random run: a hard one would take forever.
const MAX_STEPS: u32 = 3000;

/// The messages of a run, and its explanation from the same pass.
struct ExplainedRun {
    scenario: Scenario,
    messages: MemorySink,
    explanation: Explanation,
}

impl ExplainedRun {
    /// `None` if the motion can't be computed, or has fewer than two samples.
    fn run(scenario: &Scenario, max_steps: u32) -> Option<Self> {
        let mut steps = 0;
        let mut simulation = Simulation::new(scenario).ok()?.continue_while(move || {
            steps += 1;
            steps <= max_steps
        });
        let mut telemetry = Telemetry::default();
        let mut messages = MemorySink::default();
        let mut explainer = Explainer::new(scenario);
        for record in simulation.by_ref() {
            let sent = telemetry.messages(&record.ok()?, |message| {
                explainer.take(message);
                messages.write(message)?;
                Ok::<_, Box<dyn Error>>(())
            });
            sent.unwrap();
        }
        let ended = ReadEnd {
            end: Some(end_entries(&simulation.end())),
            ..ReadEnd::default()
        };
        Some(Self {
            scenario: scenario.clone(),
            explanation: explainer.finish(ended).ok()?,
            messages,
        })
    }

    fn of_topic(&self, topic: Topic) -> impl DoubleEndedIterator<Item = Message<'_>> {
        let index = topic.index();
        self.messages
            .messages
            .iter()
            .filter(move |message| message.channel == index)
            .map(|message| message.as_message())
    }

    fn numbers(&self, field: NumberField) -> Vec<f64> {
        self.of_topic(field.topic())
            .map(|message| field.of(&message))
            .collect()
    }

    fn vectors(&self, field: VectorField) -> Vec<Vector3<f64>> {
        self.of_topic(field.topic())
            .map(|message| field.of(&message))
            .collect()
    }

    fn times(&self) -> Vec<f64> {
        self.of_topic(STATE)
            .map(|message| message.time_ns as f64 / 1e9)
            .collect()
    }

    /// The indices of the samples at these times, s.
    fn samples_at(&self, times: [f64; 2]) -> [usize; 2] {
        let sampled = self.times();
        times.map(|time| sampled.iter().position(|other| *other == time).unwrap())
    }

    fn ends(&self, field: NumberField) -> [f64; 2] {
        let numbers = self.numbers(field);
        [numbers[0], numbers[numbers.len() - 1]]
    }

    /// Times of the events of a kind, s.
    fn times_of(&self, kind: EventKind) -> Vec<f64> {
        self.of_topic(EVENTS)
            .filter(|message| events::NAME.of(message) == kind.name())
            .map(|message| events::TIME.of(&message))
            .collect()
    }

    /// Angular momentum about the centre of a fixed peg, or the centre of mass.
    fn angular_momenta(&self) -> Vec<Vector3<f64>> {
        if self.scenario.model.support.is_free() {
            self.vectors(center_of_mass::ANGULAR_MOMENTUM)
        } else {
            self.vectors(momentum::WORLD)
        }
    }

    /// The axis, from the Euler angles.
    fn axes(&self) -> Vec<Vector3<f64>> {
        let phis = self.numbers(state::PHI);
        let thetas = self.numbers(state::THETA);
        let mut axes = Vec::new();
        for (phi, theta) in phis.into_iter().zip(thetas) {
            let ((sin_phi, cos_phi), (sin, cos)) = (sin_cos(phi), sin_cos(theta));
            axes.push(Vector3::new(sin * sin_phi, -sin * cos_phi, cos));
        }
        axes
    }

    /// Torque of friction and air drag about the point of the angular momenta, world frame. For a free peg that of the
    /// force at the point of contact; losses have others.
    fn friction_torques(&self) -> Vec<Vector3<f64>> {
        if self.scenario.model.support.is_free() {
            let points = self.vectors(contact::CONTACT_POINT);
            let centers = self.vectors(center_of_mass::POSITION);
            let forces = self.vectors(contact::FRICTION_FORCE);
            let levers = points.into_iter().zip(centers);
            return levers
                .zip(forces)
                .map(|((point, center), force)| (point - center).cross(&force))
                .collect();
        }
        let body = self.vectors(torque::FRICTION_BODY);
        let orientations: Vec<_> = self
            .of_topic(POSE)
            .map(|message| pose::ORIENTATION.of(&message))
            .collect();
        body.into_iter()
            .zip(orientations)
            .map(|(torque, q)| nalgebra::UnitQuaternion::from_quaternion(q) * torque)
            .collect()
    }
}

fn horizontal(vector: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(vector.x, vector.y, 0.0)
}

#[track_caller]
fn assert_same(name: &str, claimed: [f64; 2], recorded: [f64; 2]) {
    for (claimed, recorded) in claimed.into_iter().zip(recorded) {
        let tolerance = 1e-9 * recorded.abs().max(claimed.abs());
        assert!(
            (claimed - recorded).abs() <= tolerance,
            "{name}: claimed {claimed}, recorded {recorded}"
        );
    }
}

/// Checks a claim by the messages.
fn check(explained: &ExplainedRun, claim: &Claim) {
    match claim {
        Claim::Conserves { mean_theta, .. } => check_conserves(explained, *mean_theta),
        Claim::FrictionRaises {
            horizontal: part,
            vertical,
            is_vertical_constant,
            by_friction,
            theta,
            from,
            until,
            theta_at_end,
            ..
        } => {
            assert_eq!(*theta_at_end, explained.ends(state::THETA)[1]);
            let ends = explained.samples_at([*from, *until]);
            check_momentum(explained, *part, *vertical, ends);
            check_friction(explained, *part, *by_friction, [*from, *until]);
            let thetas = explained.numbers(state::THETA);
            assert_same("θ", *theta, ends.map(|at| thetas[at]));
            assert!(theta[1] < theta[0], "{claim:?}");
            if *is_vertical_constant {
                for momentum in explained.angular_momenta() {
                    assert!((momentum.z / vertical[0] - 1.0).abs() < 1e-6, "{claim:?}");
                }
            }
        }
        Claim::FrictionSpeedsPrecession {
            friction, within, ..
        } => check_precession(explained, *friction, *within),
        Claim::LossesAlign {
            energy: energies, ..
        } => {
            assert_same("energy", *energies, explained.ends(energy::TOTAL));
            assert!(energies[1] < energies[0]);
            let top = explained.scenario.model.nutating_top();
            assert!(top.axial_moment > top.transverse_moment);
            let [first, last] = explained.ends(state::THETA);
            assert!(last < first, "{claim:?}");
        }
        Claim::WeakTopFalls { axial, time, .. } => check_weak(explained, *axial, *time),
        Claim::FrictionLowers {
            from,
            until,
            angle_to_momentum,
            axial,
            theta,
            falls,
            ..
        } => {
            let ends = explained.samples_at([*from, *until]);
            check_descent(explained, ends, *angle_to_momentum, *axial, *theta);
            let fallen = explained.times_of(EventKind::Fallen);
            let time = fallen.first().copied().unwrap_or(f64::NAN);
            // A fall that ends the run comes after its last sample.
            let is_last = Some(until) == explained.times().last();
            assert_eq!(*falls, time > *from && (is_last || time <= *until));
        }
        Claim::MeanInclinationChanges {
            nutation_ends: [from, until],
            mean_theta,
            regular_theta,
            has_impacts,
            ..
        } => {
            check_drift(explained, [*from, *until], *mean_theta, *regular_theta);
            // These are times of samples: a nutation ends up to a period after its last one.
            let period = explained.scenario.sample_period_ns as f64 / 1e9;
            let any_within = |from: f64, until: f64| {
                explained
                    .of_topic(IMPACTS)
                    .any(|impact| (from..=until).contains(&(impact.time_ns as f64 / 1e9)))
            };
            assert!(
                !has_impacts || any_within(*from, until + period),
                "{claim:?}"
            );
            assert!(
                *has_impacts || !any_within(from + period, *until),
                "{claim:?}"
            );
        }
        Claim::SwingsDown {
            theta,
            time,
            kinetic,
            by_gravity,
        } => {
            assert_eq!(explained.times_of(EventKind::Fallen)[0], *time);
            assert!(theta[1] > theta[0]);
            check_swing(explained, *theta, *kinetic, *by_gravity);
        }
        Claim::EnergySpent {
            energy: total,
            needed,
        } => {
            assert_same("energy", *total, explained.ends(energy::TOTAL));
            assert!(*needed > total[1], "{claim:?}");
            assert!(explained.times_of(EventKind::Inverts).is_empty());
        }
        Claim::NotYetInverted {
            energy: total,
            slip_speed,
            ..
        } => {
            assert_eq!(*total, explained.ends(energy::TOTAL)[1]);
            assert_eq!(*slip_speed, explained.ends(contact::SLIP_SPEED)[1]);
            assert!(*slip_speed > 0.0);
            assert_eq!(explained.ends(contact::REGIME)[1], 1.0);
            assert!(explained.times_of(EventKind::Inverts).is_empty());
        }
        Claim::StaysUpright {
            energy: first,
            needed,
            needed_at,
            jellett,
            sufficient_spin,
            ..
        } => {
            check_barrier(explained, *first, *needed, *needed_at, *jellett);
            check_sufficient_spin(explained, *first, *sufficient_spin);
        }
        Claim::Inverts { vertical, .. } => check_inversion(explained, *vertical),
        Claim::SlipEnds {
            from,
            theta_range,
            stops,
            has_slipped,
            alternates,
            lasts,
            is_inclination_constant,
            inversion,
            rolls,
            ..
        } => {
            check_grip(explained, *from, *theta_range, *stops);
            if *rolls && *lasts && !is_inclination_constant {
                let starts = explained.numbers(nutation::START);
                assert!(starts.iter().any(|start| start >= from), "{claim:?}");
            }
            if *rolls && *has_slipped && !alternates {
                check_slips_at_first(explained);
            }
            let paths = explained.numbers(contact::SLIP_PATH);
            assert_eq!(*has_slipped, paths.iter().any(|path| *path > 0.0));
            let inversions = explained.times_of(EventKind::Inverts);
            match inversion {
                Some(Inversion::Absent) => assert!(inversions.is_empty(), "{claim:?}"),
                Some(Inversion::Complete) => assert!(inversions[0] <= *from, "{claim:?}"),
                None => {}
            }
        }
        Claim::Bounces {
            from,
            hops,
            impacts: count,
            lost,
            starts_in_air,
            lands,
            bounces_to_end,
        } => {
            assert!(!bounces_to_end || (*count >= 2 && lands.is_none()));
            let lift_offs = explained.times_of(EventKind::LiftOff);
            // It may lift off at once.
            let in_air = u64::from(explained.numbers(contact::REGIME)[0] == 2.0);
            assert!(*hops <= lift_offs.len() as u64 + in_air, "{claim:?}");
            assert_eq!(*count, explained.of_topic(IMPACTS).count() as u64);
            let mut sum = 0.0;
            for impact in explained.of_topic(IMPACTS) {
                sum += impacts::LOST_RESTITUTION.of(&impact) + impacts::LOST_FRICTION.of(&impact);
            }
            assert_same("impacts", [*lost; 2], [sum; 2]);
            // After the last landing, no sample is in the air; without one, the last event is a lift-off.
            for (time, regime) in explained
                .times()
                .into_iter()
                .zip(explained.numbers(contact::REGIME))
            {
                let is_down = lands.is_some_and(|lands| time > lands);
                assert!(!(is_down && regime == 2.0), "{claim:?} at {time}");
            }
            if *starts_in_air {
                assert_eq!(explained.numbers(contact::REGIME)[0], 2.0);
            }
            // It may lift off at once.
            assert!(*from == 0.0 || lift_offs.first() == Some(from), "{claim:?}");
        }
        Claim::RestsFromStart { .. } => {
            assert_eq!(explained.times_of(EventKind::Rest), [0.0]);
            assert_eq!(explained.ends(energy::KINETIC), [0.0; 2]);
        }
        Claim::ComesToRest { from, kinetic, .. } => {
            assert!(*from > 0.0);
            assert!(explained.times_of(EventKind::Rest).contains(from));
            assert_same("kinetic", *kinetic, explained.ends(energy::KINETIC));
            let rest = explained.of_topic(EVENTS).next_back().unwrap();
            assert_eq!(events::NAME.of(&rest), EventKind::Rest.name());
            assert_eq!(events::THETA_DOT.of(&rest), 0.0);
        }
    }
}

/// What raises the axis and what lowers it are told one after the other.
fn check_order(claims: &[Claim]) {
    let mut end = f64::NEG_INFINITY;
    for claim in claims {
        if let Claim::FrictionRaises { from, until, .. }
        | Claim::FrictionLowers { from, until, .. }
        | Claim::MeanInclinationChanges { from, until, .. } = claim
        {
            assert!(*from >= end && until > from, "{claims:?}");
            end = *until;
        }
    }
}

/// The kinetic energy at the start is that of the rotation across the axis and, of a free top, of the height of its centre of
/// mass.
fn check_swing(explained: &ExplainedRun, theta: [f64; 2], kinetic: f64, by_gravity: f64) {
    let top = explained.scenario.model.nutating_top();
    let (theta_dot, phi_dot) = (
        explained.numbers(state::THETA_DOT)[0],
        explained.numbers(state::PHI_DOT)[0],
    );
    let [(sin, cos), (_, cos_at_fall)] = theta.map(sin_cos);
    let across = hypot(theta_dot, phi_dot * sin);
    let mut expected = 0.5 * top.transverse_moment * across * across;
    if explained.scenario.model.support.is_free() {
        let lift = top.center_distance * sin * theta_dot;
        expected += 0.5 * top.mass * lift * lift;
    }
    assert_near("kinetic energy", kinetic, expected, 1e-12);
    let work = top.mass * top.gravity * top.center_distance * (cos - cos_at_fall);
    assert_near("work of gravity", by_gravity, work, 1e-12);
}

/// Claims are told in the order of time, each with its time where that is not the whole run.
fn check_order_of_time(explained: &ExplainedRun) {
    let story = &explained.explanation.story;
    let starts: Vec<f64> = story
        .claims
        .iter()
        .map(|claim| claim.interval().from.unwrap_or(0.0))
        .collect();
    assert!(starts.is_sorted(), "{starts:?}");
    let end = *explained.times().last().unwrap() + 1e-9;
    for (claim, sentence) in story.claims.iter().zip(story.sentences()) {
        let TimeSpan { from, until } = claim.interval();
        let is_whole =
            from.is_none_or(|from| from <= 0.0) && until.is_none_or(|until| until >= end);
        let text = sentence.to_string();
        let has_time = ["Until ", "From ", "At "]
            .iter()
            .any(|word| text.starts_with(word));
        let is_at_end = until.is_some_and(|until| until >= end - 2e-9 && from != Some(until));
        assert!(has_time != is_whole || is_at_end, "{claim:?}: {text}");
    }
}

/// The mean inclination is that of nutations, or that at the end; the other one is that at which the energy without θ̇ is
/// least, with the angular momenta at these times.
fn check_drift(
    explained: &ExplainedRun,
    times: [f64; 2],
    mean_theta: [f64; 2],
    regular_theta: [f64; 2],
) {
    let means = explained.numbers(nutation::THETA_MEAN);
    let thetas = explained.numbers(state::THETA);
    let axial = explained.numbers(momentum::AXIAL);
    let vertical: Vec<f64> = explained.angular_momenta().iter().map(|l| l.z).collect();
    assert!(means.contains(&mean_theta[0]), "{mean_theta:?}");
    for (time, regular) in times.into_iter().zip(regular_theta) {
        let at = explained
            .times()
            .iter()
            .position(|other| *other == time)
            .unwrap();
        // The least of a function is known to half of its digits.
        let expected = regular_inclination(explained, vertical[at], axial[at]);
        assert!((regular - expected).abs() < 1e-6, "{regular} {expected}");
    }
    let events = explained
        .of_topic(EVENTS)
        .map(|event| events::THETA.of(&event));
    let is_known = means
        .into_iter()
        .chain(thetas)
        .chain(events)
        .any(|theta| theta == mean_theta[1]);
    assert!(is_known, "{mean_theta:?}");
}

/// The inclination of least `(L_z′ − L_n cos θ)²/(2 I_x sin² θ) + M g l cos θ`, rad. The energy is convex in cos θ, so
/// that thirds of the interval without the minimum can be left out.
fn regular_inclination(explained: &ExplainedRun, vertical: f64, axial: f64) -> f64 {
    let top = explained.scenario.model.nutating_top();
    let gravity = top.mass * top.gravity * top.center_distance;
    let energy = |theta: f64| {
        let (sin, cos) = sin_cos(theta);
        let horizontal = (vertical - axial * cos) / sin;
        0.5 * horizontal * horizontal / top.transverse_moment + gravity * cos
    };
    let [mut least, mut greatest] = [0.0, PI];
    for _ in 0..100 {
        let third = (greatest - least) / 3.0;
        if energy(least + third) < energy(greatest - third) {
            greatest -= third;
        } else {
            least += third;
        }
    }
    0.5 * (least + greatest)
}

fn check_conserves(explained: &ExplainedRun, mean_theta: Option<[f64; 2]>) {
    let energies = explained.numbers(energy::TOTAL);
    let momenta = explained.angular_momenta();
    let axial = explained.numbers(momentum::AXIAL);
    for ((energy, momentum), axial_part) in energies.iter().zip(&momenta).zip(&axial) {
        let size = momenta[0].norm().max(momentum.norm());
        assert!((energy - energies[0]).abs() <= 1e-6 * energies[0].abs());
        assert!((momentum.z - momenta[0].z).abs() <= 2e-6 * size);
        assert!((axial_part - axial[0]).abs() <= 2e-6 * size);
    }
    let means = explained.numbers(nutation::THETA_MEAN);
    if mean_theta.is_some() {
        for mean in &means {
            assert!((mean - means[0]).abs() <= 1e-5 * means[0], "{means:?}");
        }
    }
}

fn check_momentum(
    explained: &ExplainedRun,
    part: [f64; 2],
    vertical: [f64; 2],
    [from, until]: [usize; 2],
) {
    let momenta = explained.angular_momenta();
    let recorded = [momenta[from], momenta[until]];
    assert_same("horizontal", part, recorded.map(|l| horizontal(&l).norm()));
    assert_same("vertical", vertical, recorded.map(|l| l.z));
    assert!(part[1] < part[0]);
    // The axis must have followed the angular momentum.
    let inclinations = recorded.map(|l| atan2(l.z.abs(), horizontal(&l).norm()));
    let mut largest = 0.0_f64;
    let sense = momenta[0].z.signum();
    for (momentum, axis) in momenta
        .iter()
        .zip(explained.axes())
        .skip(from)
        .take(until + 1 - from)
    {
        let line = sense * momentum;
        // An arc cosine of a small angle would lose half of the digits.
        largest = largest.max(atan2(line.cross(&axis).norm(), line.dot(&axis)));
    }
    assert!(inclinations[1] - inclinations[0] > 2.0 * largest - 1e-9);
}

fn check_friction(
    explained: &ExplainedRun,
    part: [f64; 2],
    by_friction: f64,
    [from, until]: [f64; 2],
) {
    // Couples of losses are not among these torques.
    if explained.scenario.model.support.is_free() && explained.scenario.model.friction.has_losses()
    {
        return;
    }
    let (times, momenta) = (explained.times(), explained.angular_momenta());
    let torques = explained.friction_torques();
    let shortening = |at: usize| torques[at].dot(&horizontal(&momenta[at]).normalize());
    let (mut sum, mut known) = (0.0, 1e-9 * by_friction.abs());
    for (at, window) in times.windows(2).enumerate() {
        if window[0] >= from && window[1] <= until {
            let period = window[1] - window[0];
            sum += period * shortening(at);
            // The claim has the trapezoidal rule.
            known += 0.5 * period * (shortening(at + 1) - shortening(at)).abs();
        }
    }
    sum += by_friction_in_impacts(explained, &times, &momenta, [from, until]);
    assert!((sum - by_friction).abs() <= known, "{sum} {by_friction}");
    assert!(by_friction < 0.5 * (part[1] - part[0]));
}

/// Change of the horizontal part of the angular momentum by the friction in impacts, which take no time, kg m²/s.
fn by_friction_in_impacts(
    explained: &ExplainedRun,
    times: &[f64],
    momenta: &[Vector3<f64>],
    [from, until]: [f64; 2],
) -> f64 {
    let centers = explained.vectors(center_of_mass::POSITION);
    let points = explained.vectors(contact::CONTACT_POINT);
    let mut sum = 0.0;
    for impact in explained.of_topic(IMPACTS) {
        let time = impacts::TIME.of(&impact);
        // The sample before it.
        let after = times.partition_point(|&sampled| sampled < time);
        if time < from || time > until || after == 0 {
            continue;
        }
        let lever = points[after - 1] - centers[after - 1];
        let torque = lever.cross(&horizontal(&impacts::IMPULSE.of(&impact)));
        sum += torque.dot(&horizontal(&momenta[after - 1]).normalize());
    }
    sum
}

/// The paper's argument, from its equation of θ̈ with a fixed ψ̇.
fn check_precession(explained: &ExplainedRun, friction: f64, within: f64) {
    let last = explained.of_topic(ACCELERATION).next_back().unwrap();
    assert_eq!(friction, acceleration::PHI_DOT_FRICTIONAL.of(&last));
    let top = &explained.scenario.model.top;
    let (transverse, axial) = (top.transverse_moment, top.axial_moment);
    let gravity = top.mass * top.gravity * top.center_distance;
    let mut thetas = Vec::new();
    for cycle in explained.of_topic(NUTATION) {
        let theta = nutation::THETA_MEAN.of(&cycle);
        let (phi_dot, psi_dot) = (
            nutation::PHI_DOT_MEAN.of(&cycle),
            nutation::PSI_DOT_MEAN.of(&cycle),
        );
        let (sin, cos) = sin_cos(theta);
        let (a, b) = ((transverse - axial) * cos, axial * psi_dot);
        let root = (b * b - 4.0 * a * gravity).sqrt() * b.signum();
        let (slow, fast) = (2.0 * gravity / (b + root), (b + root) / (2.0 * a));
        assert!((phi_dot - slow).abs() <= within * (1.0 + 1e-9));
        assert!(phi_dot * friction > 0.0);
        let between = 0.5 * (slow + fast);
        let theta_ddot = (a * between * between - b * between + gravity) * sin / transverse;
        assert!(theta_ddot < 0.0);
        thetas.push(theta);
    }
    assert!(thetas.last() < thetas.first());
}

/// The criterion of Klein and Sommerfeld, as the paper has it, at the fall.
fn check_weak(explained: &ExplainedRun, axial: [f64; 2], time: f64) {
    let top = explained.scenario.model.nutating_top();
    let fallen = explained
        .of_topic(EVENTS)
        .find(|event| events::NAME.of(event) == EventKind::Fallen.name())
        .unwrap();
    assert_eq!(events::TIME.of(&fallen), time);
    let theta = events::THETA.of(&fallen);
    let (_, cos) = sin_cos(theta);
    let spin = events::PSI_DOT.of(&fallen) + events::PHI_DOT.of(&fallen) * cos;
    let a = top.axial_moment * spin / top.transverse_moment;
    let gravity = top.mass * top.gravity * top.center_distance;
    assert!(a * a < 4.0 * gravity / top.transverse_moment);
    let [first, _] = explained.ends(momentum::AXIAL);
    assert_same("axial", axial, [first, top.axial_moment * spin]);
    assert!(theta > explained.numbers(state::THETA)[0]);
}

/// The angle to the angular momentum grows because the part about the axis shrinks.
fn check_descent(
    explained: &ExplainedRun,
    [at, last]: [usize; 2],
    angle: [f64; 2],
    axial: [f64; 2],
    theta: [f64; 2],
) {
    let thetas = explained.numbers(state::THETA);
    assert_same("θ", theta, [thetas[at], thetas[last]]);
    assert!(thetas[last] > thetas[at]);
    let spins = explained.numbers(momentum::AXIAL);
    assert_same("axial", axial, [spins[at], spins[last]]);
    assert!(spins[last].abs() < spins[at].abs());
    let (momenta, axes) = (explained.angular_momenta(), explained.axes());
    assert!(momenta[last].norm() <= momenta[at].norm());
    let sense = momenta[0].z.signum();
    let angles = [at, last].map(|index| (sense * momenta[index]).angle(&axes[index]));
    for (claimed, recorded) in angle.into_iter().zip(angles) {
        // Arc cosines of small angles lose half of the digits.
        assert!((claimed - recorded).abs() < 1e-7, "{claimed} {recorded}");
    }
    for momentum in &momenta[at..=last] {
        let inclination = (sense * momentum).angle(&Vector3::z());
        assert!(2.0 * inclination < angles[1] - angles[0] + 1e-7);
    }
}

/// The least energy is that of a rotation about `a = l n + R z′` with the moment of inertia about it.
fn check_barrier(explained: &ExplainedRun, energy: f64, needed: f64, needed_at: f64, jellett: f64) {
    assert!(explained.times_of(EventKind::Inverts).is_empty());
    for theta in explained.numbers(state::THETA) {
        assert!(theta < FRAC_PI_2, "{theta}");
    }
    let energies = explained.numbers(energy::TOTAL);
    assert_eq!(energies[0], energy);
    // Friction adds no energy: what the sum of kinetic and potential energy rounds to is left.
    let rounded = 1e-9 * needed.abs().max(energy.abs());
    assert!(energies.iter().all(|later| *later <= energy + rounded));
    for recorded in explained.numbers(free_peg::JELLETT) {
        assert!((recorded - jellett).abs() <= 1e-6 * jellett.abs().max(1e-9));
    }
    let top = explained.scenario.model.top.about_center();
    // π/2 isn't a floating-point number, and its cosine isn't zero.
    let (sin, cos) = if needed_at == FRAC_PI_2 {
        (1.0, 0.0)
    } else {
        sin_cos(needed_at)
    };
    let axis = Vector3::new(sin, 0.0, cos);
    let arm = top.center_distance * axis + top.peg_radius * Vector3::z();
    let along = arm.dot(&axis);
    let across = arm - along * axis;
    let moments = top.axial_moment * along * along + top.transverse_moment * across.norm_squared();
    let least =
        0.5 * jellett * jellett / moments + top.mass * top.gravity * top.center_distance * cos;
    // The claim takes the uncertainty of Jellett's integral off, 1e-6 of its terms, which cancel to a tenth at most.
    let kinetic = 0.5 * jellett * jellett / moments;
    assert!(needed <= least && least - needed <= 1e-4 * kinetic + 1e-15);
    assert!(needed > energy);
}

/// What the energy lacks with another spin, at inclinations up to the horizontal.
fn check_sufficient_spin(explained: &ExplainedRun, energy: f64, sufficient: SufficientSpin) {
    let Scenario { rates, angles, .. } = &explained.scenario;
    let (rates, start) = (*rates, angles.theta);
    let lacking = |spin: f64| {
        let top = &explained.scenario.model.top;
        let (sin, cos) = sin_cos(start);
        let (axis, vertical) = (Vector3::new(sin, 0.0, cos), Vector3::z());
        let axial_rates = [rates.psi, spin].map(|psi| psi + rates.phi * cos);
        let across = top.central_moment() * rates.phi * (vertical - cos * axis);
        let momentum = across + top.axial_moment * axial_rates[1] * axis;
        let jellett = momentum.dot(&(top.center_distance * axis + top.peg_radius * vertical));
        let [before, after] = axial_rates.map(|rate| 0.5 * top.axial_moment * rate * rate);
        let mut most = f64::NEG_INFINITY;
        for at in 0..100 {
            let theta = start + (f64::from(at) + 0.5) / 100.0 * (FRAC_PI_2 - start);
            let (sin, cos) = sin_cos(theta);
            most = most.max(top.least_energy(jellett, sin, cos) - (energy - before + after));
        }
        most
    };
    match sufficient {
        SufficientSpin::Faster => assert!(lacking(1e7_f64.copysign(rates.psi)) < 0.0),
        SufficientSpin::Absent => {
            for size in [0.0, 1.0, 10.0, 100.0, 1000.0] {
                assert!(lacking(size) > 0.0 && lacking(-size) > 0.0, "{size}");
            }
        }
        SufficientSpin::Unknown => {}
    }
}

/// A peg that slips before it rolls does not roll from the start.
fn check_slips_at_first(explained: &ExplainedRun) {
    let regimes = explained.numbers(contact::REGIME);
    let rolls = explained.times_of(EventKind::RollBegins);
    assert!(regimes[0] != 0.0 || rolls[0] > 0.0, "{rolls:?}");
}

fn check_inversion(explained: &ExplainedRun, vertical: [f64; 2]) {
    let [first, last] = explained.ends(state::THETA);
    assert!(first < FRAC_PI_2 && last > FRAC_PI_2);
    let momenta = explained.angular_momenta();
    assert_same(
        "vertical",
        vertical,
        [momenta[0].z, momenta[momenta.len() - 1].z],
    );
    assert!(vertical[0] * vertical[1] > 0.0);
    let [first, last] = explained.ends(momentum::AXIAL);
    assert!(first * last < 0.0);
    let [first, last] = explained.ends(center_of_mass::POSITION.z());
    assert!(last > first);
    let [first, last] = explained.ends(energy::KINETIC);
    assert!(last < first);
    let [first, last] = explained.ends(free_peg::LOST_SLIDING);
    assert!(last > first);
    let top = &explained.scenario.model.top;
    let jellett = explained.numbers(free_peg::JELLETT);
    for ((constant, momentum), axial) in jellett
        .iter()
        .zip(&momenta)
        .zip(explained.numbers(momentum::AXIAL))
    {
        let sum = top.center_distance * axial + top.peg_radius * momentum.z;
        let size = (top.center_distance * axial).abs() + (top.peg_radius * momentum.z).abs();
        assert!((sum - jellett[0]).abs() < 1e-6 * size && (sum - constant).abs() < 1e-9 * size);
    }
}

fn check_grip(explained: &ExplainedRun, from: f64, theta_range: [f64; 2], stops: Stopped) {
    let regimes = explained.numbers(contact::REGIME);
    let thetas = explained.numbers(state::THETA);
    let work = explained.numbers(contact::SLIP_WORK);
    let mut works = Vec::new();
    for (at, time) in explained.times().into_iter().enumerate() {
        if time > from {
            assert_eq!(regimes[at], 0.0, "at {time}");
            assert!((theta_range[0]..=theta_range[1]).contains(&thetas[at]));
            works.push(work[at]);
        }
    }
    for later in &works {
        assert_eq!(*later, works[0]);
    }
    match stops {
        Stopped::Rise => assert!(theta_range[1] < thetas[0]),
        Stopped::Nothing => {}
    }
}

fn kinds(claims: &[Claim]) -> Vec<&'static str> {
    claims
        .iter()
        .map(|claim| match claim {
            Claim::Conserves { .. } => "conserves",
            Claim::FrictionRaises { .. } => "friction raises",
            Claim::FrictionSpeedsPrecession { .. } => "friction speeds precession",
            Claim::LossesAlign { .. } => "losses align",
            Claim::WeakTopFalls { .. } => "weak top falls",
            Claim::FrictionLowers { .. } => "friction lowers",
            Claim::MeanInclinationChanges { .. } => "mean inclination changes",
            Claim::SwingsDown { .. } => "swings down",
            Claim::EnergySpent { .. } => "energy spent",
            Claim::NotYetInverted { .. } => "not yet inverted",
            Claim::StaysUpright { .. } => "stays upright",
            Claim::Inverts { .. } => "inverts",
            Claim::SlipEnds { .. } => "slip ends",
            Claim::Bounces { .. } => "bounces",
            Claim::RestsFromStart { .. } => "rests from start",
            Claim::ComesToRest { .. } => "comes to rest",
        })
        .collect()
}

#[test]
fn val_presets_have_their_causes() {
    let paper: &[&str] = &["friction raises", "friction speeds precession"];
    for (preset, expected) in [
        ("paper", paper),
        ("full-coulomb", paper),
        ("nutation-free", paper),
        ("tilt-torque-only", paper),
        ("viscous", paper),
        ("stribeck", paper),
        ("contensou", paper),
        // Not a torque: there is no argument with the angular momentum.
        ("paper-precession-term-only", &paper[1..]),
        ("paper-spin-term-only", &["weak top falls"]),
        ("spin-torque-only", &["weak top falls"]),
        ("frictionless", &["conserves"]),
        ("rise-by-loss-of-spin", &["losses align"]),
        ("lifecycle", &["friction raises", "weak top falls"]),
        ("free-paper", &["friction raises", "bounces", "slip ends"]),
        ("free-rolls", &["friction raises", "slip ends"]),
        ("free-viscous", &["friction raises"]),
        ("drop", &["bounces", "friction raises", "slip ends"]),
        ("tippe-top", &["inverts"]),
        ("tippe-top-hangs", &["slip ends"]),
    ] {
        let explained = ExplainedRun::run(&scenario(preset, &[]), u32::MAX).unwrap();
        let claims = &explained.explanation.story.claims;
        assert_eq!(kinds(claims), expected, "{preset}");
        for claim in claims {
            check(&explained, claim);
        }
    }
    assert_eq!(PRESETS.iter().count(), 19, "a preset without its causes");
}

/// A peg that bounces has most of its friction in impacts, between the samples.
#[test]
fn val_friction_in_impacts_raises_a_top() {
    for keys in [("friction.k", "0.3"), ("initial.psi_dot", "300")] {
        let explained = ExplainedRun::run(&scenario("drop", &[keys]), u32::MAX).unwrap();
        let claims = &explained.explanation.story.claims;
        assert_eq!(
            kinds(claims),
            ["bounces", "friction raises", "slip ends"],
            "{keys:?}"
        );
        for claim in claims {
            check(&explained, claim);
        }
    }
}

/// Any claim about any motion is carried by the numbers.
#[test]
fn random_tops_have_true_causes() {
    let count = random_scenarios::count().unwrap_or(40);
    let held = ordinary_held_tops(Random(38)).take(count);
    let free = free_tops(Random(38)).take(count);
    let mut claims = 0;
    for scenario in held.chain(free) {
        let Some(explained) = ExplainedRun::run(&scenario, MAX_STEPS) else {
            continue;
        };
        let of_run = &explained.explanation.story.claims;
        check_order(of_run);
        check_order_of_time(&explained);
        for claim in of_run {
            check(&explained, claim);
            claims += 1;
        }
    }
    assert!(claims >= count / 2, "{claims} claims");
}

#[test]
fn story_is_a_short_paragraph() {
    for preset in PRESETS.iter() {
        let story = explain(&scenario(&preset.name, &[])).unwrap().story;
        let text = story.text().unwrap();
        assert!(text.ends_with('.') && !text.contains('\n'), "{text}");
        assert!(text.split(' ').count() <= 140, "{text}");
    }
}

#[test]
fn says_if_no_cause_is_found() {
    let keys = [("stop.duration", "0.001")];
    let story = explain(&scenario("paper", &keys)).unwrap().story;
    assert!(story.claims.is_empty());
    let text = story.text().unwrap();
    assert!(text.contains("show none of the causes"), "{text}");
}

/// A top that static friction holds from the start has one sample, and is explained.
#[test]
fn explains_rest_from_the_start() {
    let keys = [
        ("initial.psi_dot", "0"),
        ("initial.phi_dot", "0"),
        ("friction.k", "20"),
        ("formulation", "body"),
    ];
    let explained = ExplainedRun::run(&scenario("full-coulomb", &keys), u32::MAX).unwrap();
    let claims = &explained.explanation.story.claims;
    assert_eq!(kinds(claims), ["rests from start"]);
    check(&explained, &claims[0]);
    let text = explained.explanation.story.text().unwrap();
    assert!(
        text.starts_with("The top was at rest from the start"),
        "{text}"
    );
}

#[test]
fn names_a_top_that_is_weak_from_the_start() {
    let keys = [("initial.psi_dot", "5"), ("initial.phi_dot", "0")];
    let explained = ExplainedRun::run(&scenario("full-coulomb", &keys), u32::MAX).unwrap();
    let claims = &explained.explanation.story.claims;
    assert_eq!(kinds(claims), ["weak top falls"]);
    check(&explained, &claims[0]);
    let text = explained.explanation.story.text().unwrap();
    assert!(text.contains("weak from the start"), "{text}");
}

/// The words of the causes of a run, which are checked by its numbers.
fn checked(preset: &str, keys: &[(&str, &str)]) -> (ExplainedRun, String) {
    let explained = ExplainedRun::run(&scenario(preset, keys), u32::MAX).unwrap();
    for claim in &explained.explanation.story.claims {
        check(&explained, claim);
    }
    let text = explained.explanation.story.text().unwrap_or_default();
    (explained, text)
}

/// A top that starts with no speed, moves and comes to rest did not start at rest.
#[test]
fn comes_to_rest_after_moving() {
    let slips: &[(&str, &str)] = &[
        ("initial.theta", "2"),
        ("initial.psi_dot", "0"),
        ("initial.phi_dot", "0"),
        ("stop.theta_risen", ""),
        ("stop.theta_fallen", ""),
        ("formulation", "body"),
        ("stop.on_stick", "continue"),
    ];
    let falls: &[(&str, &str)] = &[
        ("initial.theta", "1"),
        ("initial.psi_dot", "0"),
        ("initial.phi_dot", "0"),
        ("rolling.arm", "1e-4"),
        ("stop.theta_fallen", ""),
    ];
    let drops: &[(&str, &str)] = &[
        ("initial.theta", "0"),
        ("initial.psi_dot", "0"),
        ("initial.phi_dot", "0"),
        ("rolling.arm", "1e-4"),
        ("stop.theta_risen", ""),
        ("stop.theta_fallen", ""),
    ];
    for (preset, keys, hold) in [
        ("full-coulomb", slips, Hold::StaticFriction),
        ("free-paper", falls, Hold::RollingResistance),
        ("drop", drops, Hold::Balance),
    ] {
        let (explained, text) = checked(preset, keys);
        let claims = &explained.explanation.story.claims;
        let is_rest =
            |claim: &Claim| matches!(claim, Claim::ComesToRest { held_by, .. } if *held_by == hold);
        assert!(claims.iter().any(is_rest), "{preset}: {claims:?}");
        assert!(
            text.contains("came to rest: its kinetic energy was spent"),
            "{text}"
        );
        assert!(!text.contains("at rest from the start"), "{text}");
    }
}

/// A top that spins the other way moves as the mirror image.
#[test]
fn mirror_images_have_the_same_causes() {
    for preset in PRESETS.iter() {
        let run = scenario(&preset.name, &[]);
        let mirrored: Vec<(&str, String)> = [
            ("initial.psi_dot", run.rates.psi),
            ("initial.phi_dot", run.rates.phi),
        ]
        .map(|(key, rate)| (key, (-rate).to_string()))
        .into();
        let keys: Vec<(&str, &str)> = mirrored.iter().map(|(k, v)| (*k, v.as_str())).collect();
        let (explained, _) = checked(&preset.name, &keys);
        let story = explain(&run).unwrap().story;
        let claims = &explained.explanation.story.claims;
        assert_eq!(kinds(claims), kinds(&story.claims), "{}", preset.name);
    }
}

/// Gravity is not the cause of a fall to which the motion at the start leads without it.
#[test]
fn thrown_tops_do_not_fall_by_weakness() {
    let thrown: &[(&str, &[(&str, &str)])] = &[
        (
            "by precession",
            &[
                ("initial.psi_dot", "-90"),
                ("initial.phi_dot", "100"),
                ("initial.theta", "0.3"),
            ],
        ),
        (
            "by a kick",
            &[("initial.psi_dot", "30"), ("initial.theta_dot", "300")],
        ),
    ];
    for (name, keys) in thrown {
        for gravity in ["9.81", "1e-9"] {
            let mut keys = keys.to_vec();
            keys.push(("gravity", gravity));
            let (explained, _) = checked("paper", &keys);
            assert!(!explained.times_of(EventKind::Fallen).is_empty(), "{name}");
            let claims = &explained.explanation.story.claims;
            assert!(
                !kinds(claims).contains(&"weak top falls"),
                "{name}: {claims:?}"
            );
        }
    }
}

/// Friction is not the cause of a fall that happens without it.
#[test]
fn strong_top_that_falls_without_friction_is_not_slowed() {
    let keys = [
        ("initial.psi_dot", "37.5"),
        ("initial.phi_dot", "0"),
        ("initial.theta", "1.4"),
    ];
    for k in ["0", "0.03", "0.3"] {
        let mut keys = keys.to_vec();
        keys.push(("friction.k", k));
        let (explained, _) = checked("full-coulomb", &keys);
        assert!(!explained.times_of(EventKind::Fallen).is_empty());
        let claims = &explained.explanation.story.claims;
        assert!(!kinds(claims).contains(&"weak top falls"), "{claims:?}");
    }
}

/// Tops that rise at first and then fall in a fast precession, for the most part while they are strong.
#[test]
fn strong_top_that_falls_after_its_rise_is_not_weak() {
    let falling: &[(&str, &[(&str, &str)])] = &[
        (
            "lifecycle",
            &[
                ("initial.theta", "0.601"),
                ("initial.psi_dot", "-152.8"),
                ("initial.phi_dot", "-6.14"),
                ("friction.k", "1.5"),
                ("stop.duration", "6"),
            ],
        ),
        (
            "full-coulomb",
            &[
                ("initial.theta", "0.614"),
                ("initial.psi_dot", "-129.5"),
                ("initial.phi_dot", "7"),
                ("friction.k", "0.95"),
                ("stop.duration", "2"),
            ],
        ),
    ];
    for (preset, keys) in falling {
        let (explained, text) = checked(preset, keys);
        let claims = &explained.explanation.story.claims;
        let causes = ["friction raises", "friction lowers"];
        assert_eq!(kinds(claims), causes, "{preset}: {claims:?}");
        assert!(text.starts_with("Until "), "{preset}: {text}");
        let turned_away = "the axis turned away from the line of the angular momentum, and the top";
        assert!(text.contains(turned_away), "{text}");
        let chapters = &explained.explanation.chapters;
        let sentences: Vec<String> = chapters
            .iter()
            .flat_map(|chapter| &chapter.facts)
            .map(|fact| fact.sentence().to_string())
            .collect();
        let is_of_rise = |sentence: &String| {
            sentence.starts_with("During the rise, ") && sentence.contains("the horizontal part")
        };
        assert!(sentences.iter().any(is_of_rise), "{sentences:?}");
    }
}

/// A slow tippe top stays below the horizontal; a faster one turns over.
#[test]
fn slow_tippe_tops_lack_energy_for_inversion() {
    for (spin, cause) in [
        ("20", "stays upright"),
        ("-30", "stays upright"),
        ("150", "inverts"),
    ] {
        let (explained, text) = checked("tippe-top", &[("initial.psi_dot", spin)]);
        let claims = &explained.explanation.story.claims;
        assert_eq!(kinds(claims), [cause], "{spin}");
        let is_slow = cause == "stays upright";
        assert_eq!(text.contains("It spun too slowly"), is_slow, "{text}");
    }
}

/// Below (1 − |l|/R) times the axial moment, the transverse one lets no tippe top turn over (Rauch-Wojciechowski and
/// Rutstam, SIGMA 10 (2014) 017).
#[test]
fn val_slow_tippe_tops_invert_with_faster_spin() {
    // (I_x − M l²)/I_z, from either side of 0.7.
    for (ratio, expected) in [
        (0.516, SufficientSpin::Absent),
        (0.69, SufficientSpin::Absent),
        (0.71, SufficientSpin::Faster),
        (0.936, SufficientSpin::Faster),
    ] {
        let moment = (ratio * 3.2e-6 + 0.020 * 0.006 * 0.006).to_string();
        for spin in ["20", "-30"] {
            let keys = [
                ("top.transverse_moment", moment.as_str()),
                ("initial.psi_dot", spin),
                ("initial.theta", "0.001"),
                ("stop.duration", "1"),
            ];
            let (explained, text) = checked("tippe-top", &keys);
            let [
                Claim::StaysUpright {
                    sufficient_spin, ..
                },
            ] = explained.explanation.story.claims[..]
            else {
                panic!("{text}")
            };
            assert_eq!(sufficient_spin, expected, "{ratio} {spin}");
            let is_slow = expected == SufficientSpin::Faster;
            assert_eq!(text.contains("too slowly"), is_slow, "{text}");
            assert_eq!(text.contains("any other spin"), !is_slow, "{text}");
        }
    }
    for spin in ["80", "300", "1000"] {
        let keys = [
            ("top.transverse_moment", "2.37e-6"),
            ("initial.psi_dot", spin),
            ("stop.duration", "0.5"),
        ];
        let (_, text) = checked("tippe-top", &keys);
        assert!(text.contains("with any other spin"), "{spin}: {text}");
    }
}

/// A roll that is a part of a nutation, after many others.
#[test]
fn alternating_slip_and_roll_is_not_an_end_of_slip() {
    let keys = [
        ("top.mass", "181.8181818181818"),
        ("top.axial_moment", "0.029090909090909087"),
        ("top.transverse_moment", "0.052375217586550504"),
        ("top.center_distance", "-0.011364405867994596"),
        ("initial.theta", "0.46201908129004726"),
        ("initial.psi_dot", "35.75113322097055"),
        ("initial.phi_dot", "0"),
        ("friction.k", "0.1"),
        ("stop.duration", "12"),
    ];
    let (explained, text) = checked("tippe-top-hangs", &keys);
    let ends = explained.times_of(EventKind::RollEnds);
    let begins = explained.times_of(EventKind::RollBegins);
    assert!(ends.len() > 10 && begins.last() > ends.last());
    let start = begins.last().unwrap();
    assert!(
        text.contains(&format!("From {start:.4} s on, the peg rolled")),
        "{text}"
    );
}

/// The first slip ends in a roll of a few milliseconds.
#[test]
fn short_roll_begins_at_its_time() {
    let keys = [("stop.duration", "0.024")];
    let (explained, text) = checked("tippe-top-hangs", &keys);
    let [start] = explained.times_of(EventKind::RollBegins)[..] else {
        panic!("{text}")
    };
    assert!(
        text.contains(&format!("From {start:.4} s on, the peg rolled")),
        "{text}"
    );
}

/// That rolling prevents an inversion is not shown: these tops would not turn over if they slipped.
#[test]
fn rolling_does_not_explain_missing_inversion() {
    for spin in ["80", "5", "0"] {
        let keys = [("initial.psi_dot", spin), ("friction.k", "1")];
        let (_, text) = checked("tippe-top-hangs", &keys);
        assert!(!text.contains("because"), "{text}");
    }
}

/// A top that has turned over, and rolls then.
#[test]
fn rolling_after_inversion_mentions_both() {
    let keys = [
        ("initial.theta", "1.4"),
        ("initial.psi_dot", "138.85"),
        ("friction.k", "0.3"),
        ("top.axial_moment", "4.5e-6"),
        ("stop.duration", "3"),
    ];
    let (explained, text) = checked("tippe-top-hangs", &keys);
    assert_eq!(explained.times_of(EventKind::Inverts).len(), 1);
    assert!(text.contains("s on, the peg rolled"), "{text}");
    let is_complete = |claim: &Claim| {
        matches!(
            claim,
            Claim::Inverts { .. }
                | Claim::SlipEnds {
                    inversion: Some(Inversion::Complete),
                    ..
                }
        )
    };
    assert!(explained.explanation.story.claims.iter().any(is_complete));
}

#[test]
fn one_impact_is_no_bouncing() {
    let (explained, text) = checked("drop", &[("stop.duration", "0.0325")]);
    assert_eq!(explained.of_topic(IMPACTS).count(), 1);
    assert!(text.contains("hit the table once"), "{text}");
}

/// A contact point on the axis never slips, although no event says that it stops.
#[test]
fn top_that_never_slips_does_not_still_slip() {
    let (explained, _) = checked("tippe-top", &[("initial.theta", "0")]);
    assert_eq!(explained.ends(contact::SLIP_SPEED), [0.0; 2]);
    let claims = &explained.explanation.story.claims;
    assert!(!kinds(claims).contains(&"not yet inverted"), "{claims:?}");
}

/// A loss of any size takes no claim away that its own numbers carry.
#[test]
fn tiny_loss_leaves_the_end_of_slip() {
    let (explained, _) = checked("tippe-top-hangs", &[("air.axial", "1e-12")]);
    let claims = &explained.explanation.story.claims;
    assert!(kinds(claims).contains(&"slip ends"), "{claims:?}");
}

/// Why tops fall: by weakness from the start or by losses, by their motion at the start, or by gravity with it.
#[test]
fn falls_have_their_causes() {
    for (preset, keys, expected) in [
        (
            "frictionless",
            &[("initial.psi_dot", "0"), ("stop.duration", "1")][..],
            "weak from the start",
        ),
        (
            "full-coulomb",
            &[("initial.psi_dot", "0")],
            "weak from the start",
        ),
        (
            "full-coulomb",
            &[("friction.k", "0.06"), ("initial.psi_dot", "30")],
            "slowed the spin further",
        ),
        (
            "frictionless",
            &[
                ("initial.psi_dot", "60"),
                ("initial.theta", "1.5"),
                ("initial.phi_dot", "0"),
            ],
            "its motion across the axis had 0 J",
        ),
        (
            "frictionless",
            &[
                ("initial.theta", "0.5"),
                ("initial.theta_dot", "200"),
                ("initial.phi_dot", "0"),
            ],
            "as it would have without friction",
        ),
        (
            "rise-by-loss-of-spin",
            &[("initial.theta", "1.45")],
            "as it would have without friction",
        ),
    ] {
        let (_, text) = checked(preset, keys);
        assert!(text.contains(expected), "{preset}, {keys:?}: {text}");
    }
}

/// Rises and falls that no other cause explains.
#[test]
fn mean_inclination_changes_are_named() {
    for (preset, keys, senses) in [
        ("lifecycle", &[("initial.theta", "1.45")][..], "-+"),
        ("spin-torque-only", &[("initial.theta", "1.45")], "+"),
        ("paper-precession-term-only", &[("friction.k", "0.3")], "-"),
        ("tilt-torque-only", &[("initial.psi_dot", "30")], "-+"),
        ("paper-spin-term-only", &[("initial.phi_dot", "30")], "+"),
        ("free-paper", &[("initial.psi_dot", "30")], "+"),
        (
            "paper",
            &[("stop.theta_risen", ""), ("stop.duration", "40")],
            "+",
        ),
        (
            "paper",
            &[("initial.theta", "2.9"), ("stop.theta_fallen", "")],
            "+-",
        ),
        (
            "free-viscous",
            &[("initial.theta", "2.0"), ("stop.theta_fallen", "")],
            "-",
        ),
        (
            "rise-by-loss-of-spin",
            &[("initial.theta", "2.9"), ("stop.theta_fallen", "")],
            "+",
        ),
    ] {
        let (explained, text) = checked(preset, keys);
        let mut found = String::new();
        for claim in &explained.explanation.story.claims {
            if let Claim::MeanInclinationChanges {
                mean_theta: [first, last],
                ..
            } = claim
            {
                found.push(if last > first { '+' } else { '-' });
            }
        }
        assert_eq!(found, senses, "{preset}, {keys:?}: {text}");
    }
}

/// A part of a nutation is not a fall after a rise.
#[test]
fn nutation_is_not_a_drift() {
    for duration in ["1.3", "1.5", "2", "2.5", "4.3"] {
        for key in [("initial.theta_dot", "15"), ("initial.phi_dot", "-10")] {
            let (explained, _) = checked("paper", &[key, ("stop.duration", duration)]);
            for claim in &explained.explanation.story.claims {
                if let Claim::MeanInclinationChanges { mean_theta, .. } = claim {
                    assert!(
                        mean_theta[1] < mean_theta[0],
                        "{key:?}, {duration}: {claim:?}"
                    );
                }
            }
        }
    }
}

/// A contact point that sticks and slips by turns.
#[test]
fn counts_stops_of_slip() {
    let keys = [
        ("initial.theta", "2.2"),
        ("initial.phi_dot", "20"),
        ("initial.psi_dot", "0"),
        ("friction.k", "1.848"),
        ("drilling.k", "0.5"),
        ("drilling.patch_radius", "2e-3"),
        ("formulation", "body"),
        ("stop.on_stick", "continue"),
        ("stop.theta_risen", ""),
        ("stop.theta_fallen", ""),
        ("stop.duration", "2"),
    ];
    let (explained, _) = checked("full-coulomb", &keys);
    let resumes = explained.times_of(EventKind::SlipResumes);
    let stops = explained.times_of(EventKind::Stick);
    assert!(!resumes.is_empty());
    let facts = explained.explanation.chapters.iter().flat_map(|c| &c.facts);
    let found: Vec<&Fact> = facts
        .filter(|fact| matches!(fact, Fact::Sticks { .. }))
        .collect();
    let [
        Fact::Sticks {
            time,
            count,
            slips_at_end,
        },
    ] = found[..]
    else {
        panic!("{found:?}")
    };
    assert_eq!((*time, *count), (stops[0], stops.len() as u64));
    assert_eq!(*slips_at_end, resumes.last() > stops.last());
    let sentence = found[0].sentence().to_string();
    assert!(
        sentence.contains("first at") || sentence.contains("slipped again"),
        "{sentence}"
    );
}

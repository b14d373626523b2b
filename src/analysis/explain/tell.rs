//! Turns the facts of a run into sentences.

use super::facts::Facts;
use super::stages::{Stage, Total};
use super::story::{Chapter, PrecessionReport, StageReport, Story};
use crate::analysis::course::{CourseReport, Event};
use crate::analysis::phrase::{duration, list, moment, quantity, significant};
use crate::physics::friction::Dissipation;
use crate::physics::kinematics::Tilt;
use crate::run::scenario::Scenario;
use crate::run::simulation::{EventKind, Simulation, StopReason};
use std::f64::consts::{PI, TAU};

/// The number of stages that are told.
const STAGES: usize = 6;
/// The least change of the averaged θ that counts as one, rad.
const STEADY: f64 = 1e-3;
/// The greatest mean difference of φ̇ to the slow root, as a part of it, with which φ̇ keeps to the root.
const NEAR: f64 = 0.05;
/// The greatest mean difference of φ̇ to the slow root, as a part of it, that counts as none.
const BALANCED: f64 = 1e-7;
/// The duration for which the top is followed with the whole torque, as a multiple of the run's.
const LONGER: f64 = 3.0;
/// The greatest work, as a part of the energy, that counts as none.
const NO_WORK: f64 = 1e-12;
/// The greatest difference of two works, as a part of them, with which they count as equal.
const SAME_WORK: f64 = 0.01;

pub(super) fn tell(facts: &Facts) -> Story {
    let course = facts.course.report();
    let stages: Vec<_> = facts.stages.in_stages(STAGES).iter().map(stage).collect();
    let balance = balance(facts);
    let chapters = [
        beginning(&facts.scenario),
        balance
            .as_ref()
            .and_then(|balance| precession(facts, balance)),
        motion(facts, &stages),
        energy(facts, &course),
        dropped(facts, &course),
        events(facts),
    ];
    Story {
        title: title(facts, &course),
        chapters: chapters.into_iter().flatten().collect(),
        course,
        stages,
        precession: balance,
        losses: facts.losses.clone(),
    }
}

fn title(facts: &Facts, course: &CourseReport) -> String {
    let name = facts.scenario.name();
    let whole = facts.stages.whole();
    let end = seconds(whole.to);
    match (course.rise_time, course.stop_reason.as_deref()) {
        (Some(time), _) => format!("{name}: the top rises in {}", moment(time)),
        (None, Some(reason)) if reason == StopReason::Fallen.name() => {
            let time = course.stop_time.unwrap_or(end);
            format!("{name}: the top falls, at {}", moment(time))
        }
        (None, _) if facts.is_cut => {
            format!("{name}: what is there of the run, up to {}", moment(end))
        }
        (None, _) => format!("{name}: {} of a top's life", duration(end)),
    }
}

fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

fn chapter(heading: &'static str, sentences: Vec<String>) -> Option<Chapter> {
    let chapter = Chapter {
        heading,
        sentences,
        ..Chapter::default()
    };
    Some(chapter).filter(|chapter| !chapter.sentences.is_empty())
}

fn beginning(scenario: &Scenario) -> Option<Chapter> {
    let (top, theta, rates) = (&scenario.model.top, scenario.angles.theta, &scenario.rates);
    let mut sentences = vec![
        format!(
            "A top of {} leans by θ = {} ({}°), spins at ψ̇ = {} ({} turns a minute) and precesses at φ̇ = {}.",
            quantity(top.mass, 3, "kg"),
            quantity(theta, 3, "rad"),
            significant(theta * 180.0 / PI, 3),
            quantity(rates.psi, 4, "rad/s"),
            significant(rates.psi.abs() * 60.0 / TAU, 3),
            quantity(rates.phi, 3, "rad/s"),
        ),
        format!(
            "It stands on a ball with a radius of {}, whose lowest point slips over the table at {}.",
            quantity(1e3 * top.peg_radius, 2, "mm"),
            quantity(scenario.slip_speed_at_start(), 3, "m/s"),
        ),
    ];
    let start = Tilt::from_rates(theta, *rates);
    let force = scenario.model.contact(&start).force.norm();
    if force > 0.0 {
        sentences.push(format!(
            "Friction pulls at that point with {}, {} % of the weight.",
            quantity(force, 3, "N"),
            significant(100.0 * force / top.weight(), 2)
        ));
    } else if scenario.is_frictionless() {
        sentences.push("Nothing resists the slip.".to_owned());
    }
    chapter("The top", sentences)
}

fn stage(stage: &Stage) -> StageReport {
    let roots = stage.roots();
    StageReport {
        from: seconds(stage.from),
        to: seconds(stage.to),
        theta: stage.theta(),
        theta_dot: stage.theta_dot(),
        theta_dot_demanded: stage.cancelling(),
        phi_dot: stage.phi_dot(),
        slow_root: roots.map(|[slow, _]| slow),
        excess: roots.map(|[_, excess]| excess),
        psi_dot: stage.psi_dot(),
        rising: stage.rising(),
    }
}

/// What changed the precession rate, in all.
fn balance(facts: &Facts) -> Option<PrecessionReport> {
    let stages = &facts.stages;
    Some(PrecessionReport {
        gyroscopic: stages.total(Total::PrecessionGyroscopic)?,
        coriolis: stages.total(Total::PrecessionCoriolis)?,
        frictional: stages.total(Total::PrecessionFrictional)?,
        spin_frictional: stages.total(Total::SpinFrictional)?,
        upright: stages.upright.map(seconds),
    })
}

/// The chapter on what friction did to φ̇.
fn precession(facts: &Facts, balance: &PrecessionReport) -> Option<Chapter> {
    let whole = facts.stages.whole();
    let &PrecessionReport {
        gyroscopic,
        coriolis,
        frictional: friction,
        spin_frictional: spin,
        upright,
    } = balance;
    let mut sentences = Vec::new();
    let span = match upright {
        Some(time) => format!("until the axis came near upright, at {}", moment(time)),
        None => format!(
            "in {}",
            duration(seconds(whole.to.saturating_sub(whole.from)))
        ),
    };
    if friction == 0.0 {
        sentences.push("There is no friction in the equation of the precession.".to_owned());
    } else {
        let verb = if friction > 0.0 {
            "quickened"
        } else {
            "slowed"
        };
        sentences.push(format!(
            "By itself, friction would have {verb} the precession by {} {span}: that is the integral of its term in φ̈. \
             The other terms, above all the gyroscopic one, answered with {}, so that φ̇ changed by {} only. They can \
             answer only while θ changes: pushed in the sense of its precession, a spinning top gives way at right \
             angles.",
            quantity(friction.abs(), 3, "rad/s"),
            quantity(gyroscopic + coriolis, 4, "rad/s"),
            quantity(friction + gyroscopic + coriolis, 3, "rad/s"),
        ));
    }
    if spin != 0.0 {
        sentences.push(format!(
            "Friction's term in ψ̈ amounts to {}.",
            quantity(spin, 3, "rad/s")
        ));
    }
    chapter("What friction does to the precession", sentences)
}

/// The chapter on how φ̇ compared with the slow root, and what θ did.
fn motion(facts: &Facts, stages: &[StageReport]) -> Option<Chapter> {
    let mut sentences = roots(facts);
    sentences.extend(course_of_theta(facts.scenario.rates.theta, stages));
    if facts.stages.upright.is_none() {
        sentences.extend(cancelling(&facts.stages.whole()));
    }
    Some(Chapter {
        heading: "Why the axis moves",
        sentences,
        table: Some((header(), stages.iter().map(row).collect())),
        ..Chapter::default()
    })
}

/// Tells what the averaged θ did.
fn course_of_theta(start: f64, stages: &[StageReport]) -> Option<String> {
    let (first, last) = (stages.first()?, stages.last()?);
    let lowest = stages.iter().min_by(|x, y| x.theta.total_cmp(&y.theta))?;
    let angle = |stage: &StageReport| quantity(stage.theta, 3, "rad");
    let rate = |rate: f64| quantity(rate, 3, "rad/s");
    let has_risen = first.theta - lowest.theta > STEADY;
    if has_risen && last.theta - lowest.theta > STEADY {
        return Some(format!(
            "Averaged over nutations the axis first rose, from {} in the first part of the table to {} in that from {} on, \
             and then sank again, to {} in the last.",
            angle(first),
            angle(lowest),
            moment(lowest.from),
            angle(last),
        ));
    }
    if (last.theta - first.theta).abs() < STEADY {
        let angle = quantity(first.theta, 4, "rad");
        return Some(format!(
            "The axis neither rose nor sank: averaged over nutations it stayed at θ = {angle}."
        ));
    }
    let way = if has_risen { "rose" } else { "sank" };
    let sign = |change: f64| if change < 0.0 { "negative" } else { "positive" };
    let (begun, ended) = (first.theta_dot, last.theta_dot);
    Some(format!(
        "Averaged over nutations the axis {way}, from {} in the first part of the table to {} in the last. θ̈ was {} on \
         average at first, which brought θ̇ from {} to {}; then it was {} on average and θ̇ came to {}.",
        angle(first),
        angle(last),
        sign(begun - start),
        rate(start),
        rate(begun),
        sign(ended - begun),
        rate(ended),
    ))
}

/// Compares the θ̇ that friction demands with the θ̇ that there was.
fn cancelling(whole: &Stage) -> Option<String> {
    let demanded = whole.cancelling().filter(|rate| *rate != 0.0)?;
    Some(format!(
        "For the gyroscopic and Coriolis terms of φ̈ to cancel friction's, θ̇ has to be {} on average; it was {}.",
        quantity(demanded, 4, "rad/s"),
        quantity(whole.theta_dot(), 4, "rad/s"),
    ))
}

/// Compares φ̇ with the rates of regular precession.
fn roots(facts: &Facts) -> Vec<String> {
    let whole = facts.stages.whole();
    let (Some([slow, excess]), Some(fast)) = (whole.roots(), facts.stages.fast_root) else {
        let why = if facts.stages.upright.is_some() {
            "An upright top has no rates of regular precession."
        } else {
            "There was no real rate of regular precession: the top is too weak."
        };
        return vec![why.to_owned()];
    };
    let rule = if facts.stages.are_opposed {
        "They lie on different sides of zero: between them θ̈ is positive and the axis sinks, outside of them it is \
         negative and the axis rises."
    } else {
        "Between them θ̈ is negative and the axis rises; outside of them θ̈ is positive and it sinks."
    };
    let span = match facts.stages.upright {
        Some(time_ns) => format!(
            ", until the axis came near upright at {}",
            moment(seconds(time_ns))
        ),
        None => String::new(),
    };
    let mut sentences = vec![format!(
        "At two rates a top precesses regularly, without nodding. The slow one was {} on average, the fast one at least \
         {}{span}. {rule}",
        quantity(slow, 4, "rad/s"),
        quantity(fast, 3, "rad/s"),
    )];
    sentences.push(if excess.abs() > NEAR * slow.abs() {
        let side = if excess > 0.0 { "above" } else { "below" };
        let excess = quantity(excess.abs(), 3, "rad/s");
        format!("On average φ̇ was {excess} {side} the slow rate.")
    } else {
        let how = if excess.abs() < BALANCED * slow.abs() {
            "exactly".to_owned()
        } else {
            format!("to {}", quantity(excess.abs(), 2, "rad/s"))
        };
        format!(
            "Averaged over nutations φ̇ kept to the slow rate, {how}: the axis moves as soon as φ̇ leaves it, and takes the \
             slow rate along."
        )
    });
    sentences.push(format!(
        "At single instants the nodding hides this: φ̇ was above the slow rate for {} % of the time, and θ̈ negative for \
         {} %.",
        significant(100.0 * whole.above(), 3),
        significant(100.0 * whole.rising(), 3),
    ));
    sentences
}

fn header() -> Vec<String> {
    [
        "time [s]",
        "θ [rad]",
        "θ̇ [rad/s]",
        "θ̇ demanded",
        "φ̇ [rad/s]",
        "slow root",
        "ψ̇ [rad/s]",
    ]
    .map(str::to_owned)
    .to_vec()
}

fn row(stage: &StageReport) -> Vec<String> {
    let known = |value: Option<f64>, digits| {
        value.map_or("–".to_owned(), |value| significant(value, digits))
    };
    vec![
        format!("{:.2} to {:.2}", stage.from, stage.to),
        significant(stage.theta, 4),
        significant(stage.theta_dot, 3),
        known(stage.theta_dot_demanded, 3),
        significant(stage.phi_dot, 5),
        known(stage.slow_root, 5),
        significant(stage.psi_dot, 5),
    ]
}

fn energy(facts: &Facts, course: &CourseReport) -> Option<Chapter> {
    let (first, last) = (course.energy_first?, course.energy_last?);
    let mut sentences = Vec::new();
    let change = last - first;
    if facts.scenario.is_frictionless() || change == 0.0 {
        sentences.push(format!(
            "The energy stayed at {}, to {}.",
            quantity(first, 6, "J"),
            quantity(course.energy_imbalance?, 2, "J")
        ));
    } else {
        let verb = if change < 0.0 { "fell" } else { "grew" };
        sentences.push(format!(
            "The mechanical energy {verb} from {} to {}; what friction did accounts for all of it but {}.",
            quantity(first, 4, "J"),
            quantity(last, 4, "J"),
            quantity(course.energy_imbalance?, 2, "J"),
        ));
        if let Some([nutation, precession, spin]) = course.friction_work_node {
            let told = |work: f64, what: &str| {
                let verb = if work < 0.0 { "took" } else { "gave" };
                let way = if work < 0.0 { "from" } else { "to" };
                format!("{verb} {} {way} {what}", quantity(work.abs(), 3, "J"))
            };
            let works = [
                (spin, "the spin"),
                (precession, "the precession"),
                (nutation, "the nutation"),
            ];
            let some = works
                .into_iter()
                .filter(|(work, _)| work.abs() > NO_WORK * first.abs());
            let some: Vec<String> = some.map(|(work, what)| told(work, what)).collect();
            sentences.push(format!(
                "About the axes of the node frame, friction {}.",
                list(&some)
            ));
        }
        if let Some(path) = course.slip_path {
            sentences.push(format!(
                "The point of contact slipped {} in all.",
                quantity(path, 3, "m")
            ));
        }
    }
    sentences.extend(
        course
            .vertical_momentum_drift
            .map(|drift| momentum(facts, drift)),
    );
    chapter("Where the energy goes", sentences)
}

/// Tells what became of the angular momentum about the vertical.
fn momentum(facts: &Facts, drift: f64) -> String {
    let friction = &facts.scenario.model.friction;
    let start = Tilt::from_rates(facts.scenario.angles.theta, facts.scenario.rates);
    if !drift.is_finite()
        || facts
            .scenario
            .model
            .top
            .angular_momentum_node(&start)
            .norm()
            == 0.0
    {
        return "There was no angular momentum about the vertical at first.".to_owned();
    }
    if drift < 1e-6 {
        return format!(
            "The angular momentum about the vertical stayed as it was, to {} of itself: no torque acts about the \
             vertical.",
            significant(drift, 2)
        );
    }
    let is_whole = friction.dissipation.is_of_force();
    let cause = match (is_whole, friction.turns_about_vertical()) {
        (false, _) => {
            "that is what leaving out a part of friction does, which whole has no torque about the vertical"
        }
        (true, true) => "drilling or air did that, the force of sliding cannot",
        (true, false) => "by no torque that is known here",
    };
    format!(
        "The angular momentum about the vertical changed by up to {} % of itself: {cause}.",
        significant(100.0 * drift, 3)
    )
}

/// The chapter on what a model leaves out, if it leaves out anything.
fn dropped(facts: &Facts, course: &CourseReport) -> Option<Chapter> {
    let dissipation = facts.scenario.model.friction.dissipation;
    if dissipation == Dissipation::Full || facts.scenario.is_frictionless() {
        return None;
    }
    let mut sentences = Vec::new();
    if dissipation.drops_euler_terms() {
        sentences.push(
            "This model drops a term of the equations in Euler angles. That is not dropping a torque: no torque \
             changes φ̈ alone or ψ̈ alone, because the axes of φ and ψ are not at right angles."
                .to_owned(),
        );
    } else {
        sentences.push("This model leaves out a part of the torque of friction.".to_owned());
    }
    // The work of other losses is not that of the force.
    let of_force = facts.stages.total(Total::ContactWork);
    let of_force = of_force.filter(|_| !facts.scenario.model.friction.has_losses());
    if let (Some(force), Some(work)) = (of_force, course.friction_work) {
        let is_same = (work - force).abs() <= SAME_WORK * force.abs();
        if is_same {
            sentences.push(format!(
                "What acts is still a torque of a force at the point of contact: its work, {}, is that of the force \
                 along the path that the point slipped.",
                quantity(work, 4, "J")
            ));
        } else {
            let verdict = if work > 0.0 {
                "a force against the slip can only take energy, and here the top gained some: the model pumps it in"
            } else {
                "it is not the work of any force at the point of contact"
            };
            sentences.push(format!(
                "The energy tells: along this motion the force of the law would have done {}, but what the model \
                 applied did {}; {verdict}.",
                quantity(force, 4, "J"),
                quantity(work, 4, "J"),
            ));
        }
    }
    sentences.extend(with_all_parts(facts));
    chapter("What the model leaves out", sentences)
}

/// How the top ends when nothing is left out, if that happens within a few times the duration of the run.
fn with_all_parts(facts: &Facts) -> Option<String> {
    let longest = LONGER * seconds(facts.stages.whole().to);
    let planned = facts.scenario.stop.duration.unwrap_or(f64::INFINITY);
    let whole = facts.scenario.with([
        ("friction.dissipation", "full".into()),
        ("stop.duration", longest.min(planned).into()),
    ]);
    let mut simulation = Simulation::new(&whole.ok()?).ok()?;
    // The times in a damaged file may be ages.
    let most = usize::try_from(facts.course.messages).ok()?;
    let records = simulation
        .by_ref()
        .take(most.saturating_mul(LONGER as usize));
    records.take_while(Result::is_ok).for_each(drop);
    let outcome = simulation.outcome();
    let rates = quantity(outcome.motion.tilt.rates.psi, 4, "rad/s");
    let time = moment(outcome.time);
    let is_on_its_way = matches!(outcome.stop, StopReason::Duration | StopReason::Interrupted);
    Some(if is_on_its_way {
        format!(
            "With the whole torque the same top is still on its way at {time}, with ψ̇ = {rates}."
        )
    } else {
        let end = outcome.stop.sentence();
        format!("With the whole torque the same top ends so: {end}, at {time}, with ψ̇ = {rates}.")
    })
}

/// The chapter on the events: the first of each kind, and how many more there were.
fn events(facts: &Facts) -> Option<Chapter> {
    let mut kinds: Vec<(&Event, u64, f64)> = Vec::new();
    for event in facts
        .course
        .events
        .iter()
        .filter(|event| !EventKind::find(&event.name).is_some_and(EventKind::is_of_nutation))
    {
        match kinds
            .iter_mut()
            .find(|(first, ..)| first.name == event.name)
        {
            Some((_, more, last)) => (*more, *last) = (*more + 1, event.time),
            None => kinds.push((event, 0, event.time)),
        }
    }
    let told = |(event, more, last): (&Event, u64, f64)| {
        let again = match more {
            0 => String::new(),
            1 => format!(" Once more at {}.", moment(last)),
            _ => format!(" So {more} times more, until {}.", moment(last)),
        };
        format!("{}  {}{again}", moment(event.time), event.description)
    };
    let chapter = chapter("What happened", kinds.into_iter().map(told).collect())?;
    Some(Chapter {
        is_list: true,
        ..chapter
    })
}

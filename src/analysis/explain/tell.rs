//! Turns the facts of a run into sentences.

use super::facts::Facts;
use super::peg;
use super::stages::{Kind, Stage};
use super::story::{Chapter, Story, chapter};
use super::why;
use crate::analysis::course::{CourseReport, Cycle, Event};
use crate::analysis::phrase::{list, moment, pair, quantity, significant, span, with_minus_signs};
use crate::physics::friction::Dissipation;
use crate::physics::kinematics::Tilt;
use crate::run::simulation::{EventKind, Simulation, StopReason};
use crate::telemetry::fields::{CENTER_OF_MASS, CONTACT, FREE_PEG, IMPACTS, MOMENTUM, NUTATION};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The duration for which the top is followed with the whole torque, as a multiple of the run's. The presets that leave out
/// a part of it end no later with the whole, to a thousandth; three times leave room for others.
const LONGER: f64 = 3.0;

pub(super) fn tell(facts: &Facts) -> Story {
    let course = facts.course.report();
    let is_free = facts.scenario.model.support.is_free();
    // The acceleration of a free peg is in φ̈ beside the terms.
    let precession = (!is_free).then(|| why::precession_report(facts)).flatten();
    let chapters = if is_free {
        [
            beginning(facts),
            axis(facts),
            peg::course(facts),
            peg::motion(facts),
            peg::energy(facts, &course),
            None,
            events(facts),
            left_out(facts, false),
        ]
    } else {
        [
            beginning(facts),
            axis(facts),
            precession
                .as_ref()
                .and_then(|report| why::precession(facts, report)),
            why::motion(facts),
            energy(facts, &course),
            dropped(facts, &course),
            events(facts),
            left_out(facts, precession.is_none()),
        ]
    };
    Story {
        title: title(facts, &course),
        chapters: chapters.into_iter().flatten().collect(),
        course,
        stages: why::reports(facts),
        precession,
        losses: facts.losses.clone(),
    }
}

fn title(facts: &Facts, course: &CourseReport) -> String {
    let name = facts.scenario.name();
    let end = course.stop_time.unwrap_or(facts.last_time());
    let mut verbs: Vec<String> = Vec::new();
    let starts_upright = |index: usize, kind: Kind| index == 0 && kind == Kind::Passes;
    let stages = facts.stages.iter().enumerate();
    let told = stages.filter(|(index, stage)| {
        // One nutation doesn't tell where the axis goes.
        let is_moment = stage.kind == Kind::Stays && stage.from == stage.to;
        !starts_upright(*index, stage.kind) && !is_moment
    });
    let is_tippe = facts.scenario.model.top.center_distance < 0.0;
    let verb = |stage: &Stage| {
        let verb = stage.kind.verb()?;
        Some(if is_tippe {
            peg::tippe_verb(verb, stage.thetas)
        } else {
            verb
        })
    };
    for verb in told.filter_map(|(_, stage)| verb(stage)) {
        if verbs.last().is_none_or(|last| last != verb) {
            verbs.push(verb.to_owned());
        }
    }
    // What comes to roll and stays as it is has risen before.
    if facts.course.peg.is_some() && verbs.len() > 1 {
        verbs.retain(|verb| Some(verb.as_str()) != Kind::Stays.verb());
    }
    // A life of many turns is told below.
    if verbs.len() > 6 {
        verbs.drain(3..verbs.len() - 3);
        verbs.dedup();
    }
    let is_rise = verbs.len() == 1 && verbs[0] == "rises";
    match course.rise_time {
        Some(time) if is_rise && facts.course.peg.is_none() => {
            return format!("{name}: the top rises in {}", moment(time));
        }
        _ => {}
    }
    let told = if verbs.is_empty() {
        format!("{} of a top's life", moment(end))
    } else {
        format!("in {} the top {}", moment(end), list(&verbs))
    };
    let told = match peg::verbs(facts) {
        Some(peg) => format!("{told}; {peg}"),
        None => told,
    };
    if facts.is_cut {
        return format!(
            "{name}: what is there of the run, up to {}: {told}",
            moment(facts.last_time())
        );
    }
    format!("{name}: {told}")
}

fn beginning(facts: &Facts) -> Option<Chapter> {
    let scenario = &facts.scenario;
    let (top, theta, rates) = (&scenario.model.top, scenario.angles.theta, &scenario.rates);
    let start = scenario.start();
    let is_free = scenario.model.support.is_free();
    let starts_aloft = start.peg_position.z > top.peg_radius || start.peg_velocity.z > 0.0;
    let rests = is_free && scenario.slip_speed_at_start() == 0.0;
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
            "It {} a ball with a radius of {}, whose lowest point {}.",
            if starts_aloft { "ends in" } else { "stands on" },
            quantity(1e3 * top.peg_radius, 2, "mm"),
            match quantity(scenario.slip_speed_at_start(), 3, "m/s") {
                speed if starts_aloft => format!("moves over the table below at {speed}"),
                _ if rests => "is at rest on the table".to_owned(),
                speed => format!("slips over the table at {speed}"),
            },
        ),
    ];
    if scenario.model.support.is_free() {
        sentences.extend(peg::beginning(scenario));
        return chapter("The top", sentences);
    }
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

/// The chapter on what the axis did, stage by stage.
fn axis(facts: &Facts) -> Option<Chapter> {
    let mut stages: Vec<&Stage> = facts.stages.iter().collect();
    stages.sort_by(|a, b| a.from.total_cmp(&b.from));
    let mut sentences: Vec<String> = stages.into_iter().filter_map(stage).collect();
    if facts.scenario.model.top.center_distance < 0.0 {
        sentences = stages_of_tippe(facts);
    }
    if facts.pieces.path.is_empty() {
        sentences.insert(0, no_nutation(facts)?);
    }
    let chapter = chapter("What the axis did", sentences)?;
    Some(Chapter {
        is_list: true,
        ..chapter
    })
}

/// Tells of a run that ends before a nutation does: a part of one has no mean.
fn no_nutation(facts: &Facts) -> Option<String> {
    let [(start, first), (end, last)] = facts.pieces.ends?;
    let [least, greatest] = facts.pieces.range;
    let maxima = facts.count(EventKind::NutationMaximum);
    let minima = facts.count(EventKind::NutationMinimum) + facts.count(EventKind::UprightPassage);
    // Extremes that are not of a nutation are no events.
    let nods = maxima.max(minima);
    let nodded = if nods > 1 {
        format!("the axis nodded {} or more: θ", peg::times(nods))
    } else if facts.has(NUTATION) {
        "the top completed no nutation, so there is no averaged motion: θ".to_owned()
    } else {
        "θ".to_owned()
    };
    Some(format!(
        "{} {nodded} went from {} to {}, between {} and {} in samples.",
        span(start, end),
        significant(first, 4),
        quantity(last, 4, "rad"),
        significant(least, 4),
        quantity(greatest, 4, "rad"),
    ))
}

/// What the axis of a tippe top did: its centre of mass is lowest upright, so it does not rise toward there.
fn stages_of_tippe(facts: &Facts) -> Vec<String> {
    let mut stages: Vec<&Stage> = facts.stages.iter().collect();
    stages.sort_by(|a, b| a.from.total_cmp(&b.from));
    let told = |one: &Stage| {
        let sentence = stage(one)?;
        let turns = match one.kind {
            Kind::Rises => "straightened up",
            Kind::Sinks | Kind::Falls if one.thetas[0] < FRAC_PI_2 && one.thetas[1] > FRAC_PI_2 => {
                "turned over"
            }
            Kind::Sinks | Kind::Falls => "leaned farther",
            Kind::Stays | Kind::Swings => {
                let stays = "the top neither turned over nor straightened up";
                return Some(sentence.replace("the axis neither rose nor sank", stays));
            }
            _ => return Some(sentence),
        };
        let verbs = ["the axis rose", "the axis sank", "the top fell"];
        Some(verbs.iter().fold(sentence, |told, verb| {
            told.replace(verb, &format!("the top {turns}"))
        }))
    };
    stages.into_iter().filter_map(told).collect()
}

fn stage(stage: &Stage) -> Option<String> {
    let Stage {
        kind,
        from,
        to,
        thetas,
        least,
        range,
        is_mean,
    } = *stage;
    let span = span(from, to);
    let averaged = if is_mean {
        ", averaged over nutations,"
    } else {
        ""
    };
    let [first, last] = pair(thetas);
    Some(match kind {
        Kind::Rises => {
            format!("{span} the axis rose: θ{averaged} fell from {first} to {last} rad.")
        }
        Kind::Sinks => {
            format!("{span} the axis sank: θ{averaged} grew from {first} to {last} rad.")
        }
        Kind::Falls => format!("{span} the top fell: θ grew from {first} to {last} rad."),
        Kind::Stays if from == to => format!(
            "In the one nutation around {}, θ averaged {}.",
            moment(from),
            quantity(thetas[0], 6, "rad"),
        ),
        Kind::Stays => format!(
            "{span} the axis neither rose nor sank: θ{averaged} stayed at {}, to {}.",
            quantity(thetas[0], 6, "rad"),
            quantity(range, 1, "rad"),
        ),
        Kind::Swings => format!(
            "{span} the axis neither rose nor sank: the peg rolled, and θ averaged {} over a nutation.",
            quantity(thetas[0], 4, "rad"),
        ),
        Kind::Sleeps => format!(
            "{span} the top slept: θ{averaged} stayed below 0.01 rad and was least, {}, at {}.",
            quantity(least.0, 2, "rad"),
            moment(least.1),
        ),
        Kind::Passes => format!(
            "{span} the axis was near upright: θ{averaged} came down to {}.",
            quantity(least.0, 2, "rad"),
        ),
        Kind::Sticks => format!(
            "{span} the contact point stuck, and the top turned as a whole, inclined by {}.",
            quantity(thetas[0], 4, "rad"),
        ),
        Kind::Moment(kind) => {
            let what = match kind {
                EventKind::Risen => "had risen",
                EventKind::Fallen => "had fallen",
                EventKind::WeakTop => "had become too weak to stand upright by its spin",
                EventKind::SlipStops => "stopped slipping",
                EventKind::Rest => "came to rest",
                _ => return None,
            };
            format!(
                "At {} the top {what}, at θ = {}.",
                moment(from),
                quantity(thetas[0], 4, "rad")
            )
        }
    })
}

fn energy(facts: &Facts, course: &CourseReport) -> Option<Chapter> {
    let (first, last) = (course.energy_first?, course.energy_last?);
    let mut sentences = Vec::new();
    let change = last - first;
    if let Some(stayed) = facts.energy_stayed(course) {
        sentences.push(stayed);
    } else {
        let verb = if change < 0.0 { "fell" } else { "grew" };
        let [begun, ended] = pair([first, last]);
        sentences.push(format!(
            "The mechanical energy {verb} by {}, from {begun} to {ended} J; what friction did accounts for all of it but \
             {}.",
            quantity(change.abs(), 4, "J"),
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
                .filter(|(work, _)| work.abs() > facts.floor(first));
            let some: Vec<String> = some.map(|(work, what)| told(work, what)).collect();
            if !some.is_empty() {
                sentences.push(format!(
                    "About the axes of the node frame, friction {}.",
                    list(&some)
                ));
            }
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
    // A relative change: of 1, as it were.
    let floor = facts.floor(1.0).max(4.0 * f64::EPSILON);
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
    if drift <= floor {
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
    let of_force = facts.pieces.totals.slip_work;
    let of_force = of_force.filter(|_| !facts.scenario.model.friction.has_losses());
    let floor = facts.floor(course.energy_first.unwrap_or(0.0));
    if let (Some(force), Some(work)) = (of_force, course.friction_work)
        && force.abs().max(work.abs()) > floor
    {
        // The integrator sums both along the same motion.
        let is_same = (work - force).abs() <= floor;
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
    let longest = LONGER * facts.last_time();
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
    let end = simulation.end();
    let rates = quantity(end.motion.tilt.rates.psi, 4, "rad/s");
    let time = moment(end.time);
    let is_on_its_way = matches!(end.stop, StopReason::Duration | StopReason::Interrupted);
    Some(if is_on_its_way {
        format!(
            "With the whole torque the same top is still on its way at {time}, with ψ̇ = {rates}."
        )
    } else {
        let end = end.stop.sentence();
        format!("With the whole torque the same top ends so: {end}, at {time}, with ψ̇ = {rates}.")
    })
}

/// Whether an event of looping tells of a cusp: in its nutation φ̇ goes past zero by no more than the errors of the
/// integrator.
fn is_cusp(facts: &Facts, event: &Event) -> bool {
    let is_looping = [EventKind::LoopingBegins, EventKind::LoopingEnds]
        .iter()
        .any(|kind| kind.name() == event.name);
    let cycles = &facts.course.cycles;
    let later = cycles.partition_point(|cycle| cycle.start <= event.time);
    let range = later
        .checked_sub(1)
        .and_then(|index| cycles.get(index))
        .and_then(Cycle::precession_range);
    is_looping
        && range.is_some_and(|[least, greatest]| {
            least.abs().min(greatest.abs()) <= facts.floor(least.abs().max(greatest.abs()))
        })
}

/// What an event says, where its own words are not right for every top.
fn described(facts: &Facts, event: &Event) -> String {
    let is_tippe = facts.scenario.model.top.center_distance < 0.0;
    let theta = significant(event.theta, 4);
    match EventKind::find(&event.name) {
        // They take it for granted that the spin has fallen.
        Some(EventKind::Fallen) => format!(
            "The top has fallen to {} rad, spinning at {}.",
            significant(event.theta, 5),
            quantity(facts.or_zero(event.rates[1], 1.0), 4, "rad/s")
        ),
        // Regular precession of a tippe top is backward by itself: that makes no loops.
        Some(EventKind::LoopingBegins) if is_tippe => {
            format!("The precession turns backward, at {theta} rad.")
        }
        Some(EventKind::LoopingEnds) if is_tippe => {
            format!("The precession turns forward, at {theta} rad.")
        }
        _ => with_minus_signs(&event.description),
    }
}

/// The chapter on the events: the first of each kind, and how many more there were.
fn events(facts: &Facts) -> Option<Chapter> {
    let mut kinds: Vec<(&Event, u64, f64)> = Vec::new();
    for event in facts
        .course
        .events
        .iter()
        .filter(|event| !EventKind::find(&event.name).is_some_and(EventKind::is_of_nutation))
        .filter(|event| !is_cusp(facts, event))
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
        format!("{}  {}{again}", moment(event.time), described(facts, event))
    };
    let chapter = chapter("What happened", kinds.into_iter().map(told).collect())?;
    Some(Chapter {
        is_list: true,
        ..chapter
    })
}

/// What can't be told of this run, and why.
fn left_out(facts: &Facts, lacks_precession: bool) -> Option<Chapter> {
    let mut sentences = Vec::new();
    let totals = &facts.pieces.totals;
    if lacks_precession {
        let why = if totals.first.is_none() {
            "precession and spin could not be told apart from the start on".to_owned()
        } else if facts.pieces.samples < 2 {
            "there are fewer than two samples".to_owned()
        } else if totals.changes().is_some() {
            "the integrals of its terms don't add up to its change, because the axis came too near the vertical"
                .to_owned()
        } else {
            "this recording of an older version doesn't hold the integrals of the terms, and samples are missing in \
             between or not finite"
                .to_owned()
        };
        sentences.push(format!("What friction does to the precession: {why}."));
    }
    let always = [
        (MOMENTUM, "How the angular momenta incline the axis"),
        (NUTATION, "The averaged motion"),
        (CONTACT, "The path that the contact point slipped"),
    ];
    let of_free_peg = [
        (
            CENTER_OF_MASS,
            "The angular momentum about the centre of mass",
        ),
        (
            FREE_PEG,
            "The height of the peg, Jellett's integral and what took the energy",
        ),
        (IMPACTS, "The impacts"),
    ];
    let is_free = facts.scenario.model.support.is_free();
    for (topic, what) in always.iter().chain(of_free_peg.iter().filter(|_| is_free)) {
        if !facts.has(*topic) {
            sentences.push(format!("{what}: {topic} is not recorded."));
        }
    }
    let chapter = chapter("What can't be told", sentences)?;
    Some(Chapter {
        is_list: true,
        ..chapter
    })
}

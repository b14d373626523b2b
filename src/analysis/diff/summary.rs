//! The findings of a comparison in a few sentences, from its numbers.

use super::averages::{Averaged, Deviation};
use super::floor::Floor;
use super::happened::Happened;
use super::report::Report;
use super::setup::KeyDifference;
use super::verdict::Verdict;
use crate::analysis::course::CourseReport;
use crate::analysis::phrase::{duration, list, moment, quantity, significant, symbol};
use crate::run::simulation::EventKind;
use crate::telemetry::fields::{NumberField, nutation};

/// Keys of a scenario that don't change the run.
const NAMES: [&str; 2] = ["name", "description"];
/// A nutation whose amplitude differs by less than this factor is called equally strong.
const NOTABLE_RATIO: f64 = 1.25;
/// Runs that are farther apart than this part of a nutation are said to be.
const NOTABLE_PHASE: f64 = 1e-6;
/// Averages that differ by no more than this part of their size agree.
const ALIKE: f64 = 0.02;
/// The averages that are told.
const AVERAGED: [NumberField; 3] = [
    nutation::THETA_MEAN,
    nutation::PHI_DOT_MEAN,
    nutation::PSI_DOT_MEAN,
];
/// Most keys that are told one by one.
const KEYS_TOLD: usize = 3;

/// The report that is told, and what the two runs are called.
#[derive(Clone, Copy)]
struct Tale<'r> {
    report: &'r Report,
    a: &'r str,
    b: &'r str,
}

impl Report {
    /// The findings in a few sentences, with the runs called by these names.
    #[must_use]
    pub fn sentences(&self, [a, b]: [&str; 2]) -> Vec<String> {
        let tale = Tale { report: self, a, b };
        let mut sentences: Vec<String> = verdict(self).into_iter().collect();
        sentences.extend(incomplete(tale));
        if self.verdict == Verdict::Identical {
            return sentences;
        }
        if self.happened.is_some() {
            sentences.extend(setup(tale));
            sentences.extend(rise(tale));
            sentences.extend(self.averaged.as_ref().and_then(averaged));
            sentences.extend(nutation(tale));
            sentences.extend(discrepancy(tale));
            sentences.extend(self.floor.as_ref().and_then(|found| floor(self, found)));
        } else if self.verdict == Verdict::Different {
            sentences.extend(largest(self));
        }
        sentences
    }
}

/// A number of things.
fn counted(count: u64, thing: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {thing}{ending}")
}

fn verdict(report: &Report) -> Option<String> {
    let channels = &report.signals.channels;
    let pairs: u64 = channels.iter().map(|channel| channel.pairs).sum();
    let what = format!(
        "{} in {}",
        counted(pairs, "message"),
        counted(channels.len() as u64, "topic")
    );
    let is_exact = channels
        .iter()
        .all(|channel| channel.identical == channel.pairs);
    match report.verdict {
        Verdict::Identical => Some(format!("Identical, bit for bit: {what}.")),
        Verdict::Equal => Some(format!("Equal within the tolerances: {what}.")),
        Verdict::Agreeing if is_exact => Some(format!(
            "All that was compared is the same, but not every message was: {what}."
        )),
        Verdict::Agreeing => Some(format!(
            "What was compared agrees within the tolerances, but not every message was: {what}."
        )),
        // What scenarios with other keys differ in, and what follows, is told below.
        Verdict::Different if keys(report).next().is_some() => None,
        Verdict::Different => Some(first_difference(report)),
    }
}

/// Where two runs that should be the same part.
fn first_difference(report: &Report) -> String {
    let fields = report
        .signals
        .fields()
        .filter(|(_, field)| !field.is_derived);
    let differing = fields.filter_map(|(topic, field)| Some((field.first_beyond?, topic, field)));
    let differing: Vec<_> = differing.collect();
    let count = differing.len();
    let first = differing.into_iter().min_by(|x, y| x.0.total_cmp(&y.0));
    let Some((time, topic, field)) = first else {
        return lonely(report);
    };
    let ulp = field
        .ulp
        .filter(|ulp| *ulp > 0)
        .map_or(String::new(), |ulp| format!(" ({ulp} ulp)"));
    let others = match count {
        1 => "no other field differs".to_owned(),
        _ => format!("in all {count} fields differ"),
    };
    let by = if field.other_values > 0 {
        format!("{} of its values", field.other_values)
    } else if field.largest == 0.0 {
        "it is a number in one of them only".to_owned()
    } else {
        let size = quantity(field.largest.abs(), 3, &field.unit);
        format!("by at most {size}{ulp}")
    };
    format!(
        "First {topic}.{} differs, at {time} s: {by}; {others}.",
        field.field
    )
}

/// Why two runs without a different number are not the same.
fn lonely(report: &Report) -> String {
    let setup = &report.setup;
    let topics = [&setup.topics_only_in_a, &setup.topics_only_in_b];
    let fields = [&setup.fields_only_in_a, &setup.fields_only_in_b];
    let is_some = |lists: [&Vec<String>; 2]| lists.iter().any(|list| !list.is_empty());
    let what = match (is_some(topics), is_some(fields)) {
        (true, _) => "some topics are in one of them only",
        (_, true) => "some fields are in one of them only",
        _ => "some messages are in one of them only, or say something else",
    };
    format!("What both have is the same, but {what}.")
}

/// The keys of the scenarios that change the run.
fn keys(report: &Report) -> impl Iterator<Item = &KeyDifference> {
    let keys = report.setup.scenario.iter();
    keys.filter(|key| !NAMES.contains(&key.key.as_str()))
}

fn incomplete(Tale { report, a, b }: Tale<'_>) -> Option<String> {
    if report.is_complete {
        return None;
    }
    let names = [(&report.a, a), (&report.b, b)];
    let cut = names.iter().filter(|(run, _)| !run.losses.is_empty());
    let cut: Vec<String> = cut.map(|(_, name)| (*name).to_owned()).collect();
    let whom = if cut.is_empty() {
        "One of them".to_owned()
    } else {
        list(&cut)
    };
    Some(format!(
        "{whom} could not be read as a whole: this is about the rest."
    ))
}

fn setup(tale: Tale<'_>) -> Option<String> {
    let keys: Vec<_> = keys(tale.report).collect();
    let told = keys.iter().take(KEYS_TOLD).map(|key| told(key, tale));
    let told: Vec<String> = told.collect();
    match keys.len() {
        0 => None,
        count if count > KEYS_TOLD => Some(format!(
            "The scenarios differ in {count} keys, first in {}.",
            list(&told)
        )),
        _ => Some(format!("The scenarios differ in {}.", list(&told))),
    }
}

fn told(key: &KeyDifference, Tale { a, b, .. }: Tale<'_>) -> String {
    let value = |value: &Option<String>| match value {
        Some(value) if key.unit.is_empty() => value.clone(),
        Some(value) => format!("{value} {}", key.unit),
        None => "nothing".to_owned(),
    };
    let (x, y) = (value(&key.a), value(&key.b));
    format!("{} ({a}: {x}, {b}: {y})", key.key)
}

fn rise(Tale { report, a, b }: Tale<'_>) -> Option<String> {
    let courses = (report.a.course.as_ref()?, report.b.course.as_ref()?);
    let happened = report.happened.as_ref()?;
    let end = |name: &str, course: &CourseReport| match (&course.stop_reason, course.stop_time) {
        (Some(reason), Some(time)) => {
            let reason = reason.replace('_', " ");
            format!("{name} doesn't rise ({reason} at {})", moment(time))
        }
        _ => format!("{name} doesn't rise as far as it is known"),
    };
    match (courses.0.rise_time, courses.1.rise_time) {
        (Some(x), Some(y)) if x == y => Some(format!("Both rise at {}.", moment(x))),
        (Some(x), Some(y)) => {
            let order = if y > x { "later" } else { "earlier" };
            let times = format!("{}, not {}", moment(y), moment(x));
            let shift = duration(y - x);
            let average = average_rise(happened, b);
            Some(format!("{b} rises {shift} {order} ({times}){average}."))
        }
        (Some(x), None) => Some(format!(
            "{a} rises at {}; {}.",
            moment(x),
            end(b, courses.1)
        )),
        (None, Some(y)) => Some(format!(
            "{}; {b} rises at {}.",
            end(a, courses.0),
            moment(y)
        )),
        (None, None) => None,
    }
}

/// What the averaged θ says of a shift that the nutation can have caused.
fn average_rise(happened: &Happened, name: &str) -> String {
    let (Some(shift), Some(uncertainty)) = (happened.rise_shift, happened.rise_shift_uncertainty)
    else {
        return String::new();
    };
    if shift.abs() > uncertainty {
        return String::new();
    }
    let by_nutation = format!(
        "; the nutation alone can shift that by {}",
        duration(uncertainty)
    );
    let (Some(x), Some(y), Some(level)) = (
        happened.averaged_crossing_a,
        happened.averaged_crossing_b,
        happened.averaged_level,
    ) else {
        return by_nutation;
    };
    let order = if y > x { "later" } else { "earlier" };
    let average = format!(
        ", and on average {name} passes {} {} {order}",
        quantity(level, 3, "rad"),
        duration(y - x)
    );
    by_nutation + &average
}

fn averaged(averaged: &Averaged) -> Option<String> {
    let of = |field: NumberField| {
        let mut means = averaged.means.iter();
        means.find(|mean| mean.quantity == field.path())
    };
    let means: Vec<&Deviation> = AVERAGED.into_iter().filter_map(of).collect();
    if means.iter().all(|mean| mean.largest == 0.0) {
        return Some("The averaged motions are the same.".to_owned());
    }
    let told = |mean: &&Deviation| {
        let size = quantity(mean.largest.abs(), 2, &mean.unit);
        format!("{size} in {}", symbol(&mean.quantity))
    };
    let told: Vec<String> = means.iter().map(told).collect();
    let is_alike = |mean: &&Deviation| mean.largest.abs() <= ALIKE * mean.scale;
    let verb = if means.iter().all(is_alike) {
        "agree to"
    } else {
        "differ by up to"
    };
    Some(format!(
        "Averaged over nutations, the motions {verb} {}.",
        list(&told)
    ))
}

/// Amplitude, looping and phase of the nutation.
fn nutation(tale: Tale<'_>) -> Option<String> {
    let Tale { report, b, .. } = tale;
    let averaged = report.averaged.as_ref()?;
    let mut told = Vec::new();
    if let Some(ratio) = averaged.amplitude_ratio_last {
        if ratio > NOTABLE_RATIO {
            told.push(format!(
                "is {} times stronger at the end",
                significant(ratio, 2)
            ));
        } else if ratio < 1.0 / NOTABLE_RATIO {
            told.push(format!(
                "is {} times weaker at the end",
                significant(1.0 / ratio, 2)
            ));
        }
    }
    if averaged.phase_last.abs() > NOTABLE_PHASE {
        let order = if averaged.phase_last > 0.0 {
            "ahead"
        } else {
            "behind"
        };
        let phase = significant(averaged.phase_last.abs(), 2);
        let out_of_step = averaged.decorrelated.map_or(String::new(), |time| {
            format!(", out of step from {} on", moment(time))
        });
        told.push(format!("is {phase} cycles {order} by then{out_of_step}"));
    }
    let looping = report
        .happened
        .as_ref()
        .and_then(|happened| looping(tale, happened));
    let nutation = (!told.is_empty()).then(|| format!("{b}'s nutation {}.", list(&told)));
    match (nutation, looping) {
        (None, None) => None,
        (nutation, looping) => {
            let both: Vec<String> = nutation.into_iter().chain(looping).collect();
            Some(both.join(" "))
        }
    }
}

fn looping(Tale { report, a, b }: Tale<'_>, happened: &Happened) -> Option<String> {
    let mut kinds = happened.kinds.iter();
    let kind = kinds.find(|kind| kind.name == EventKind::LoopingBegins.name())?;
    let (only, name, other, run) = match (kind.count_a, kind.count_b) {
        (1.., 0) => (&happened.only_in_a, a, b, &report.b),
        (0, 1..) => (&happened.only_in_b, b, a, &report.a),
        _ => return None,
    };
    let first = only.iter().find(|event| event.name == kind.name)?.time;
    // What had ended before then, or can't be read, may have looped or not.
    let is_known = run.losses.is_empty() && run.last >= first;
    is_known.then(|| {
        format!(
            "{name} loops from {} on, {other} never does.",
            moment(first)
        )
    })
}

fn discrepancy(Tale { report, a, .. }: Tale<'_>) -> Option<String> {
    let found = report.discrepancy.as_ref()?;
    let torque = found.quantities.first()?;
    if found
        .quantities
        .iter()
        .all(|residual| residual.largest == 0.0)
    {
        return Some("At equal states both models do the same.".to_owned());
    }
    if torque.largest == 0.0 {
        return Some("At equal states both models have the same friction torque.".to_owned());
    }
    let part = if torque.rms_a > 0.0 {
        format!(
            ", {} % of {a}'s",
            significant(100.0 * torque.largest / torque.rms_a, 2)
        )
    } else {
        String::new()
    };
    Some(format!(
        "At the states that {a} goes through, the models' friction torques differ by up to {}{part}.",
        quantity(torque.largest, 2, &torque.unit)
    ))
}

fn floor(report: &Report, floor: &Floor) -> Option<String> {
    let (differing, below) = report.signals.at_floor();
    if differing == 0 {
        return None;
    }
    let same = keys(report).next().is_none();
    if below == differing && same {
        let text = "No difference is larger than the integrators' own errors: it is not physics.";
        return Some(text.to_owned());
    }
    let error = floor.a.theta_mean + floor.b.theta_mean;
    let means = report
        .averaged
        .as_ref()
        .and_then(|averaged| averaged.means.first());
    let against = means
        .filter(|mean| mean.largest != 0.0)
        .map(|mean| mean.largest.abs() / error);
    let below = match below {
        0 => String::new(),
        1 => "; 1 field differs by no more than them".to_owned(),
        some => format!("; {some} fields differ by no more than them"),
    };
    against.filter(|times| times.is_finite()).map(|times| {
        let (times, order) = if times < 1.0 {
            (1.0 / times, "larger")
        } else {
            (times, "smaller")
        };
        let times = significant(times, 2);
        format!("The integrators' own errors are {times} times {order} in the mean of θ{below}.")
    })
}

/// For files that are not ours: where the largest difference is.
fn largest(report: &Report) -> Option<String> {
    let fields = report.signals.fields();
    let differing = fields.filter(|(_, field)| field.largest != 0.0);
    let largest = differing.max_by(|(_, x), (_, y)| x.relative.total_cmp(&y.relative));
    let (topic, field) = largest?;
    Some(format!(
        "The largest difference for its size is in {topic}.{}: {} at {} s, {} % of it, from {} s on.",
        field.field,
        significant(field.largest, 3),
        field.at,
        significant(100.0 * field.relative, 2),
        field.first_different.unwrap_or_default()
    ))
}

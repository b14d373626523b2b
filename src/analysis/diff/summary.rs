//! The findings of a comparison in a few sentences, from its numbers.

use super::floor::Floor;
use super::report::Report;
use super::setup::KeyDifference;
use super::tale::Tale;
use super::told_average::{averaged, nutation};
use super::told_motion::motion;
use super::told_peg::finding;
use super::tolerance::full_name;
use super::topic::ChannelDifference;
use super::verdict::Verdict;
use crate::analysis::phrase::{self, counted, list, quantity, significant};

/// The key that says what holds the peg.
const SUPPORT: &str = "support.kind";
/// Most keys that are told one by one.
const KEYS_TOLD: usize = 3;
/// Most topics or fields that are named in a list.
const NAMED: usize = 3;
/// Most things that are told to differ beside values that are the same.
const BESIDE_TOLD: usize = 8;

impl Report {
    /// The findings in a few sentences, with the runs called by these names.
    #[must_use]
    pub fn sentences(&self, [a, b]: [&str; 2]) -> Vec<String> {
        let tale = Tale { report: self, a, b };
        let mut sentences: Vec<String> = verdict(tale).into_iter().collect();
        sentences.extend(incomplete(tale));
        if self.verdict.has_same_values() {
            return sentences;
        }
        if self.verdict == Verdict::Agreeing && is_exact(self) {
            sentences.extend(setup(tale));
            return sentences;
        }
        if self.happened.is_some() {
            match same_motion(self) {
                Some(same) => {
                    sentences.extend(setup(tale));
                    sentences.push(same);
                }
                None => {
                    sentences.extend(finding(tale));
                    sentences.extend(setup(tale));
                    sentences.extend(differences(tale));
                }
            }
        } else if self.verdict == Verdict::Different {
            sentences.extend(largest(self));
        }
        sentences
    }
}

/// What differs between the motions.
fn differences(tale: Tale<'_>) -> Vec<String> {
    let mut told = motion(tale);
    if is_exact(tale.report) && tale.report.signals.differing() == 0 {
        told.push("The messages that both have are the same, bit for bit.".to_owned());
        return told;
    }
    told.extend(averaged(tale));
    told.extend(nutation(tale));
    told.extend(discrepancy(tale));
    told.extend(
        tale.report
            .floor
            .as_ref()
            .and_then(|found| floor(tale.report, found)),
    );
    told
}

/// Whether all messages that were compared are the same, to the last bit.
fn is_exact(report: &Report) -> bool {
    let channels = &report.signals.channels;
    channels
        .iter()
        .all(|channel| channel.identical == channel.pairs)
}

/// That no difference is larger than the errors, if none is: then nothing of it is physics.
fn same_motion(report: &Report) -> Option<String> {
    let (differing, below) = report.signals.at_floor();
    let happened = report.happened.as_ref()?;
    let differing_in_all = report.signals.differing();
    if differing == 0 || below < differing_in_all {
        return None;
    }
    let shifts = happened.kinds.iter().filter_map(|kind| kind.largest_shift);
    let shifts = shifts.chain(happened.averaged_shift).map(f64::abs);
    let largest = shifts.fold(0.0, f64::max);
    let to = if largest > 0.0 {
        format!(", to {} s", power_of_ten(largest))
    } else {
        String::new()
    };
    let errors = if report.signals.is_interpolated() {
        "the errors of the integrators and of interpolation"
    } else {
        "the integrators' own errors"
    };
    Some(format!(
        "The same motion{to}: no difference is larger than {errors}."
    ))
}

/// The next larger power of ten.
fn power_of_ten(value: f64) -> String {
    let exponent = crate::physics::math::log10(value).ceil();
    format!("1e{exponent}")
}

fn verdict(tale: Tale<'_>) -> Option<String> {
    let report = tale.report;
    let channels = &report.signals.channels;
    let pairs: u64 = channels.iter().map(|channel| channel.pairs).sum();
    let what = format!(
        "{} in {}",
        counted(pairs, "message"),
        counted(channels.len() as u64, "topic")
    );
    let is_exact = is_exact(report);
    match report.verdict {
        Verdict::Identical => Some(format!("Identical, bit for bit: {what}.")),
        Verdict::SameValues => Some(same_values(report, &what)),
        Verdict::Equal => Some(format!("Equal within the tolerances: {what}.")),
        Verdict::Agreeing if is_exact && !report.is_complete => Some(format!(
            "All that could be read of both is the same: {what}."
        )),
        Verdict::Agreeing if is_exact => Some(format!(
            "All that was compared is the same, but not every message was: {what}."
        )),
        Verdict::Agreeing => Some(format!(
            "What was compared agrees within the tolerances, but not every message was: {what}."
        )),
        // What scenarios with other keys differ in, and what follows, is told below.
        Verdict::Different if tale.keys().next().is_some() => None,
        Verdict::Different => Some(first_difference(tale)),
    }
}

/// That all values are the same to the last bit, and what differs beside them.
fn same_values(report: &Report, what: &str) -> String {
    let mut beside = report.beside.clone();
    let more = beside.len().saturating_sub(BESIDE_TOLD);
    beside.truncate(BESIDE_TOLD);
    if more > 0 {
        beside.push(format!("{more} more"));
    }
    format!(
        "The same values: {what}. What differs beside them: {}.",
        list(&beside)
    )
}

/// Where two runs that should be the same part.
fn first_difference(tale: Tale<'_>) -> String {
    let report = tale.report;
    let fields = report
        .signals
        .fields()
        .filter(|(_, field)| !field.is_derived);
    let differing = fields.filter_map(|(topic, field)| Some((field.first_beyond?, topic, field)));
    let differing: Vec<_> = differing.collect();
    let count = differing.len();
    let first = differing.into_iter().min_by(|x, y| x.0.total_cmp(&y.0));
    let Some((time, topic, field)) = first else {
        return lonely(tale);
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
    } else if field.largest.abs() == f64::MAX {
        format!("by more than {}", quantity(f64::MAX, 3, &field.unit))
    } else if field.largest == 0.0 {
        "it is a number in one of them only".to_owned()
    } else {
        let size = quantity(field.largest.abs(), 3, &field.unit);
        format!("by at most {size}{ulp}")
    };
    format!(
        "First {topic}.{} differs, at {}: {by}; {others}.",
        field.field,
        report.moment(time)
    )
}

/// Why two runs without a different number are not the same.
fn lonely(Tale { report, a, b }: Tale<'_>) -> String {
    let setup = &report.setup;
    let channels = &report.signals.channels;
    let mut alone = Vec::new();
    for (name, topics, fields) in [
        (a, &setup.topics_only_in_a, &setup.fields_only_in_a),
        (b, &setup.topics_only_in_b, &setup.fields_only_in_b),
    ] {
        for (thing, list) in [("topic", topics), ("field", fields)] {
            if !list.is_empty() {
                let count = counted(list.len() as u64, thing);
                alone.push(format!("only {name} has {count} ({})", shortened(list)));
            }
        }
    }
    type Count = fn(&ChannelDifference) -> u64;
    type First = fn(&ChannelDifference) -> Option<f64>;
    let counts: [(_, _, Count, First); 2] = [
        (
            a,
            b,
            |channel| channel.only_in_a + channel.beyond_in_a,
            |channel| channel.first_alone_in_a,
        ),
        (
            b,
            a,
            |channel| channel.only_in_b + channel.beyond_in_b,
            |channel| channel.first_alone_in_b,
        ),
    ];
    for (name, other, count, first) in counts {
        let (topics, counts) = counted_on(channels, count);
        if let Some(first) = channels.iter().filter_map(first).reduce(f64::min) {
            let messages = counted(counts, "message");
            let first = report.moment(first);
            alone.push(format!(
                "{name} has {messages} that {other} has not ({topics}), first at {first}"
            ));
        }
    }
    let mut otherwise = Vec::new();
    // A field that only one has is told as that.
    let is_in_one = |name: &String| {
        setup.fields_only_in_a.contains(name) || setup.fields_only_in_b.contains(name)
    };
    for channel in channels {
        let texts = channel.texts.as_ref();
        if let Some(texts) =
            texts.filter(|texts| !is_in_one(&full_name(&channel.topic, &texts.field)))
        {
            otherwise.push(format!(
                "{} on {} differ, first at {}",
                counted(texts.count, "text"),
                channel.topic,
                report.moment(texts.time)
            ));
        }
        if let Some(bytes) = &channel.bytes {
            otherwise.push(format!(
                "the bytes of {} on {} differ, first at {}",
                counted(bytes.count, "message"),
                channel.topic,
                report.moment(bytes.time)
            ));
        }
    }
    let more = otherwise.len().saturating_sub(NAMED);
    otherwise.truncate(NAMED);
    if more > 0 {
        otherwise.push(format!("{more} other topics differ"));
    }
    let (topics, sequences) = counted_on(channels, |channel| channel.other_sequences);
    if report.happened.is_some() && sequences > 0 {
        let messages = counted(sequences, "message");
        otherwise.push(format!(
            "the sequence numbers of {messages} differ ({topics})"
        ));
    }
    if otherwise.is_empty() && alone.is_empty() {
        "No byte differs, but the encodings of messages that can't be decoded do.".to_owned()
    } else if otherwise.is_empty() {
        format!("What both have is the same, but {}.", list(&alone))
    } else {
        format!(
            "No number differs, but {}.",
            list(&[otherwise, alone].concat())
        )
    }
}

/// Some of a list, and how many more there are.
fn shortened(items: &[String]) -> String {
    let more = items.len().saturating_sub(NAMED);
    let mut named = items[..items.len() - more].to_vec();
    if more > 0 {
        named.push(format!("{more} more"));
    }
    list(&named)
}

/// The topics on which there are any of what is counted, and how many in all.
fn counted_on(
    channels: &[ChannelDifference],
    count: impl Fn(&ChannelDifference) -> u64,
) -> (String, u64) {
    let topics = channels.iter().filter(|channel| count(channel) > 0);
    let topics: Vec<String> = topics.map(|channel| channel.topic.clone()).collect();
    (shortened(&topics), channels.iter().map(count).sum())
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
    let mut keys: Vec<_> = tale.keys().collect();
    // Nothing changes a run as much as what holds the peg.
    keys.sort_by_key(|key| key.key != SUPPORT);
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
        None if key.key == SUPPORT => "fixed".to_owned(),
        Some(value) if key.unit.is_empty() => value.clone(),
        Some(value) => format!("{value} {}", key.unit),
        None => "nothing".to_owned(),
    };
    let (x, y) = (value(&key.a), value(&key.b));
    format!("{} ({a}: {x}, {b}: {y})", key.key)
}

/// Why models are not compared at equal states.
fn moving(report: &Report, a: &str, b: &str) -> Option<String> {
    let [of_a, of_b] = [&report.a, &report.b].map(|run| run.course.as_ref());
    let is_undefined = of_a?.peg.is_some() && of_b?.peg.is_none();
    is_undefined.then(|| {
        format!(
            "The models are not compared at {a}'s states, in which the peg moves: {b}'s is held."
        )
    })
}

fn discrepancy(Tale { report, a, b }: Tale<'_>) -> Option<String> {
    let Some(found) = report.discrepancy.as_ref() else {
        return moving(report, a, b);
    };
    let torque = found.quantities.first()?;
    if found
        .quantities
        .iter()
        .all(|residual| residual.largest == 0.0)
    {
        return Some(
            "At equal states both models do the same while the contact point slips.".to_owned(),
        );
    }
    if torque.largest == 0.0 {
        return Some("At equal states both models have the same friction torque.".to_owned());
    }
    let own = if torque.rms_a > 0.0 {
        format!(
            "the RMS of {a}'s is {}",
            quantity(torque.rms_a, 2, &torque.unit)
        )
    } else {
        format!("{a} has none")
    };
    Some(format!(
        "At the states that {a} goes through, the models' friction torques differ by up to {}; {own}.",
        quantity(torque.largest, 2, &torque.unit)
    ))
}

fn floor(report: &Report, floor: &Floor) -> Option<String> {
    let (differing, below) = report.signals.at_floor();
    if differing == 0 {
        return None;
    }
    let error = floor.a.theta_mean + floor.b.theta_mean;
    let averaged = report.averaged.as_ref();
    let mean = averaged.and_then(|averaged| averaged.either_way.means.first());
    let below = match below {
        0 => String::new(),
        1 => "; 1 field differs by no more than them".to_owned(),
        some => format!("; {some} fields differ by no more than them"),
    };
    let times = mean.map(|mean| mean / error);
    times
        .filter(|times| times.is_finite() && *times > 1.0)
        .map(|times| {
            let times = phrase::times(times);
            format!(
                "The integrators' own errors are {times} times smaller in the mean of θ{below}."
            )
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

//! What the report says, section by section.

use crate::analysis::diff::{
    Budget, ChannelDifference, ComparedRun, CourseReport, Deviation, EventKindDifference,
    EventMoment, FieldDifference, Growth, GrowthLaw, Happened, IntegratorError, KeyDifference,
    Matrix, MessageTimes, PairContext, Parting, PegReport, QuantityKind, Report, Residual, Signals,
    TextDifference, Verdict, full_name,
};
use crate::analysis::phrase::{
    counts_from_1970, date, duration, quantity, signed_duration, significant, symbol,
};
use crate::archive::recording::Condition;
use crate::cli::numbers;
use crate::cli::page::{Page, Section, Tone};
use crate::cli::table::Table;
use crate::cli::text::{clipped, end_of};
use crate::run::simulation::EventKind;
use crate::telemetry::fields::{NumberField, state};
use std::collections::BTreeMap;

/// The number of entries that are shown of a long list.
const SHOWN: usize = 8;

/// How much to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Detail {
    /// The field that differs most, of each topic.
    Short,
    /// Every field.
    AllFields,
}

/// The page of a report.
pub(super) fn page(report: &Report, detail: Detail) -> Page {
    let (title, tone) = match report.verdict {
        Verdict::Identical => ("Identical", Tone::Good),
        Verdict::SameValues => ("The same values", Tone::Good),
        Verdict::Equal => ("Equal", Tone::Good),
        Verdict::Agreeing => ("Agreeing", Tone::Weak),
        Verdict::Different => ("Different", Tone::Weak),
    };
    let title = if report.is_complete {
        title.to_owned()
    } else {
        format!("{title} as far as both can be read")
    };
    let mut sections = vec![setup(report), topics(report), divergence(report)];
    sections.extend([happened(report), averaged(report)]);
    sections.extend([
        signals(report, detail),
        models(report),
        errors(report),
        remarks(report),
    ]);
    sections.retain(|section| !section.parts.is_empty());
    Page {
        title,
        tone,
        subjects: runs(report),
        summary: report.summary.clone(),
        sections,
    }
}

fn runs(report: &Report) -> Table {
    let row = |letter: &str, run: &ComparedRun| {
        let what = match &run.condition {
            None => "simulated now",
            Some(Condition::Whole | Condition::Foreign) if run.losses.is_empty() => "",
            // Damaged, or so long that the rest was left: the remarks say which.
            Some(Condition::Whole | Condition::Foreign) => "read in part",
            Some(condition) => condition.name(),
        };
        vec![
            letter.to_owned(),
            run.file
                .as_ref()
                .map_or_else(|| run.name.clone(), |file| end_of(file, 50)),
            what.to_owned(),
            format!("{} messages", numbers::count(run.messages)),
            match (run.first_ns, run.last_ns) {
                (Some(first), Some(last)) if counts_from_1970(first) => {
                    let length = last.saturating_sub(first) as f64 / 1e9;
                    format!("{} + {length:.3} s", date(first))
                }
                _ => format!("{:.3} s", run.last),
            },
        ]
    };
    Table {
        header: Vec::new(),
        rows: vec![row("A", &report.a), row("B", &report.b)],
        left: 3,
    }
}

fn cells<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

fn setup(report: &Report) -> Section {
    let found = &report.setup;
    let mut section = Section::new("Set-up");
    let value = |value: &Option<String>, unit: &str| match value {
        Some(value) if unit.is_empty() => clipped(value, 32),
        Some(value) => clipped(&format!("{value} {unit}"), 32),
        None => "–".to_owned(),
    };
    let row = |key: &KeyDifference| {
        vec![
            clipped(&key.key, 32),
            value(&key.a, &key.unit),
            value(&key.b, &key.unit),
        ]
    };
    // Counts and digests follow from the rest; the sections below say more of them.
    let is_setup = |key: &&KeyDifference| {
        !key.key.starts_with("toprise.end: ") && key.key != "toprise.run: scenario_digest"
    };
    let told = found.files.iter().filter(is_setup);
    section.table(Table {
        header: cells(["", "A", "B"]),
        rows: found.scenario.iter().chain(told).map(row).collect(),
        left: 3,
    });
    if found.equal_keys > 0 && !section.parts.is_empty() {
        section.line(format!(
            "{} other keys of the scenarios are equal",
            found.equal_keys
        ));
    }
    for (what, list) in [
        ("topics only in A", &found.topics_only_in_a),
        ("topics only in B", &found.topics_only_in_b),
        ("fields only in A", &found.fields_only_in_a),
        ("fields only in B", &found.fields_only_in_b),
        ("schemas", &found.schemas),
        ("channels", &found.channels),
        ("attachments", &found.attachments),
    ] {
        if !list.is_empty() {
            section.line(format!("{what}: {}", shortened(list)));
        }
    }
    section
}

/// When the messages of each topic are, in files that toprise did not write.
fn topics(report: &Report) -> Section {
    let mut section = Section::new("Topics");
    if report.verdict.has_same_values() {
        return section;
    }
    let rate = |times: &Option<MessageTimes>| {
        let rate = times.as_ref().and_then(|times| times.rate);
        rate.map_or("–".to_owned(), |rate| {
            format!("{} Hz", significant(rate, 4))
        })
    };
    let gap = |times: &Option<MessageTimes>| {
        let gap = times.as_ref().and_then(|times| times.longest_gap);
        gap.map_or("–".to_owned(), duration)
    };
    let row = |channel: &ChannelDifference| {
        let (a, b) = (&channel.times_a, &channel.times_b);
        vec![
            channel.topic.clone(),
            numbers::count(channel.messages_a),
            numbers::count(channel.messages_b),
            numbers::count(channel.pairs),
            rate(a),
            rate(b),
            gap(a),
            gap(b),
        ]
    };
    let channels = report.signals.channels.iter();
    let foreign = channels.filter(|c| c.times_a.is_some() || c.times_b.is_some());
    section.table(Table {
        header: cells([
            "",
            "in A",
            "in B",
            "pairs",
            "rate of A",
            "of B",
            "longest gap of A",
            "of B",
        ]),
        rows: foreign.map(row).collect(),
        left: 1,
    });
    section
}

fn shortened(list: &[String]) -> String {
    let shown = list
        .iter()
        .take(SHOWN)
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    match list.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// The first difference of runs that should be the same, with the messages before and after.
fn divergence(report: &Report) -> Section {
    let mut section = Section::new("First difference");
    let Some(found) = &report.divergence else {
        return section;
    };
    let row = |pair: &PairContext| {
        let mark = if pair.is_first { "▸ " } else { "  " };
        let bits = pair
            .bits
            .as_ref()
            .map_or(String::new(), |bits| format!("0x{bits}"));
        let [a, b] = [&pair.a, &pair.b].map(|value| clipped(value, 28));
        vec![format!("{mark}{} s", pair.time), a, b, bits]
    };
    for field in &found.fields {
        let name = clipped(&full_name(&found.topic, &field.field), 50);
        section.table(Table {
            header: vec![
                name,
                "A".to_owned(),
                "B".to_owned(),
                "bits that differ".to_owned(),
            ],
            rows: field.pairs.iter().map(row).collect(),
            left: 1,
        });
    }
    if found.more_fields > 0 {
        section.line(format!("{} more fields differ there", found.more_fields));
    }
    for channel in &report.signals.channels {
        for (name, first) in [
            ("A", channel.first_alone_in_a),
            ("B", channel.first_alone_in_b),
        ] {
            if let Some(first) = first.filter(|first| *first < found.time) {
                section.line(format!(
                    "before that, at {first} s, only {name} has a message on {}",
                    channel.topic
                ));
            }
        }
    }
    section
}

fn happened(report: &Report) -> Section {
    let mut section = Section::new("What happened");
    let (Some(found), Some(a), Some(b)) = (&report.happened, &report.a.course, &report.b.course)
    else {
        return section;
    };
    section.table(Table {
        header: cells(["", "A", "B", "B − A"]),
        rows: [
            first_rows(a, b),
            level_rows(found),
            budget_rows(found, a, b),
        ]
        .concat(),
        left: 1,
    });
    section.table(Table {
        header: cells([
            "events",
            "in A",
            "in B",
            "matched",
            "mean shift",
            "largest shift",
        ]),
        rows: found
            .kinds
            .iter()
            .filter(|kind| kind.name != EventKind::Start.name())
            .map(kind_row)
            .collect(),
        left: 1,
    });
    for (name, only) in [("A", &found.only_in_a), ("B", &found.only_in_b)] {
        let told: Vec<&EventMoment> = only
            .iter()
            .filter(|event| !EventKind::find(&event.name).is_some_and(EventKind::is_of_nutation))
            .collect();
        if !told.is_empty() {
            let moment = |event: &&EventMoment| format!("{} at {:.4} s", event.name, event.time);
            let told: Vec<String> = told.iter().map(moment).collect();
            section.line(format!("only in {name}: {}", shortened(&told)));
        }
    }
    section
}

fn shift(a: Option<f64>, b: Option<f64>) -> String {
    let Some((a, b)) = a.zip(b) else {
        return String::new();
    };
    signed_duration(b - a)
}

fn signed(value: f64) -> String {
    let text = significant(value, 3);
    if value > 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

fn time_cell(time: Option<f64>) -> String {
    time.map_or("–".to_owned(), |time| format!("{time:.6}"))
}

fn first_rows(a: &CourseReport, b: &CourseReport) -> Vec<Vec<String>> {
    let reason =
        |course: &CourseReport| course.stop_reason.clone().unwrap_or("not known".to_owned());
    let mut rows = vec![
        vec!["end".to_owned(), reason(a), reason(b), String::new()],
        vec![
            "  at [s]".to_owned(),
            time_cell(a.stop_time),
            time_cell(b.stop_time),
            shift(a.stop_time, b.stop_time),
        ],
    ];
    if a.last_sample != b.last_sample {
        rows.push(vec![
            "last sample [s]".to_owned(),
            time_cell(a.last_sample),
            time_cell(b.last_sample),
            shift(a.last_sample, b.last_sample),
        ]);
    }
    rows
}

/// When the averaged motions passed a level, and when θ first touched one.
fn level_rows(found: &Happened) -> Vec<Vec<String>> {
    let row = |name: &str, level: Option<f64>, [a, b]: [Option<f64>; 2], uncertainty: String| {
        let level = level.filter(|_| a.is_some() || b.is_some())?;
        Some(vec![
            format!("{name} {} rad [s]", significant(level, 4)),
            time_cell(a),
            time_cell(b),
            shift(a, b) + &uncertainty,
        ])
    };
    let within =
        |error: Option<f64>| error.map_or(String::new(), |e| format!(" ± {}", duration(e)));
    let by_nutation = |range: Option<[f64; 2]>| {
        range.map_or(String::new(), |[least, greatest]| {
            format!(
                " ({} to {})",
                signed_duration(least),
                signed_duration(greatest)
            )
        })
    };
    [
        row(
            "mean θ at",
            found.averaged_level,
            [found.averaged_crossing_a, found.averaged_crossing_b],
            within(found.averaged_shift_uncertainty),
        ),
        row(
            "θ first at",
            found.risen_level,
            [found.risen_a, found.risen_b],
            by_nutation(found.rise_shift_uncertainty),
        ),
        row(
            "θ first at",
            found.fallen_level,
            [found.fallen_a, found.fallen_b],
            String::new(),
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn budget_rows(found: &Happened, a: &CourseReport, b: &CourseReport) -> Vec<Vec<String>> {
    let count = |count: Option<u64>| count.map(|count| count as f64);
    let lost = |budget: &Option<Budget>| budget.map(|budget| budget.energy_lost);
    let friction = |budget: &Option<Budget>| budget.map(|budget| budget.friction_work);
    let (common_a, common_b) = (&found.common_budget_a, &found.common_budget_b);
    let time = common_a.map_or(0.0, |budget| budget.time);
    let lost_by = format!("energy lost by {time:.4} s [J]");
    let work_by = format!("work of friction by {time:.4} s [J]");
    let has_common =
        found.budget_a.map(|budget| budget.time) != found.budget_b.map(|budget| budget.time);
    let in_common = |value: Option<f64>| value.filter(|_| has_common);
    let work = |budget: &Option<Budget>, course: &CourseReport, axis: usize| {
        let recorded = budget.and_then(|budget| budget.friction_work_node);
        recorded
            .filter(|_| course.peg.is_none())
            .or(course.friction_work_node)
            .map(|work| work[axis])
    };
    let peg = |of: fn(&PegReport) -> Option<f64>| [a, b].map(|run| run.peg.as_ref().and_then(of));
    let [flights_a, flights_b] = peg(|peg| peg.flights.map(|flights| flights as f64));
    let [impacts_a, impacts_b] = peg(|peg| peg.impacts.map(|impacts| impacts as f64));
    let [air_a, air_b] = peg(|peg| peg.time_in_air);
    let [rolling_a, rolling_b] = peg(|peg| peg.time_rolling);
    let [roll_a, roll_b] = peg(|peg| peg.first_roll);
    let [jellett_a, jellett_b] = peg(|peg| Some(peg.jellett_drift? / peg.jellett_terms?));
    let work_of_a = |axis: usize| work(&found.budget_a, a, axis);
    let work_of_b = |axis: usize| work(&found.budget_b, b, axis);
    let quantities = [
        ("nutation cycles", count(a.nutations), count(b.nutations)),
        (
            "energy lost [J]",
            lost(&found.budget_a),
            lost(&found.budget_b),
        ),
        (
            "work of friction [J]",
            friction(&found.budget_a),
            friction(&found.budget_b),
        ),
        ("  against the nutation", work_of_a(0), work_of_b(0)),
        ("  on the precession", work_of_a(1), work_of_b(1)),
        ("  against the spin", work_of_a(2), work_of_b(2)),
        (
            &lost_by,
            in_common(lost(common_a)),
            in_common(lost(common_b)),
        ),
        (
            &work_by,
            in_common(friction(common_a)),
            in_common(friction(common_b)),
        ),
        ("flights of the peg", flights_a, flights_b),
        ("impacts of the peg", impacts_a, impacts_b),
        ("time in the air [s]", air_a, air_b),
        ("first rolls at [s]", roll_a, roll_b),
        ("time rolling [s]", rolling_a, rolling_b),
        (
            "path slipped by the last sample [m]",
            a.slip_path,
            b.slip_path,
        ),
        (
            "precession in the last sample [rad/s]",
            a.precession_rate_last,
            b.precession_rate_last,
        ),
        (
            "spin in the last sample [rad/s]",
            a.spin_rate_last,
            b.spin_rate_last,
        ),
        (
            "drift of L_z, relative",
            a.vertical_momentum_drift,
            b.vertical_momentum_drift,
        ),
        (
            "drift of Jellett's integral, relative",
            jellett_a,
            jellett_b,
        ),
        (
            "energy unaccounted for [J]",
            a.energy_imbalance,
            b.energy_imbalance,
        ),
    ];
    let known = quantities
        .into_iter()
        .filter(|(_, a, b)| a.is_some() || b.is_some());
    known
        .map(|(name, a, b)| {
            let is_count = [
                "nutation cycles",
                "flights of the peg",
                "impacts of the peg",
            ]
            .contains(&name);
            let cell = |value: Option<f64>| match value {
                None => "–".to_owned(),
                Some(value) if is_count => format!("{value}"),
                Some(value) => significant(value, 6),
            };
            let difference = a.zip(b).map_or(String::new(), |(a, b)| match b - a {
                0.0 => "0".to_owned(),
                difference if is_count => format!("{difference:+}").replace('-', "−"),
                difference => signed(difference),
            });
            vec![name.to_owned(), cell(a), cell(b), difference]
        })
        .collect()
}

fn kind_row(kind: &EventKindDifference) -> Vec<String> {
    vec![
        kind.name.replace('_', " "),
        kind.count_a.to_string(),
        kind.count_b.to_string(),
        kind.matched.to_string(),
        kind.mean_shift.map_or("–".to_owned(), signed_duration),
        kind.largest_shift.map_or("–".to_owned(), signed_duration),
    ]
}

fn averaged(report: &Report) -> Section {
    let Some(found) = &report.averaged else {
        return Section::new("Averaged motion");
    };
    let note = format!(
        "over {} nutations, from {:.3} s to {:.3} s",
        found.cycles, found.from, found.to
    );
    let mut section = Section::new("Averaged motion");
    section.note = note;
    let row = |deviation: &Deviation| {
        vec![
            readable(&deviation.quantity),
            quantity(deviation.largest, 3, &deviation.unit),
            format!("{:.3} s", deviation.at),
            significant(deviation.rms, 3),
            significant(deviation.scale, 3),
        ]
    };
    let phase = &found.phase;
    let all = found
        .means
        .iter()
        .chain(&found.envelopes)
        .chain([&found.frequency, phase]);
    section.table(Table {
        header: cells(["", "largest B − A", "at", "RMS", "of"]),
        rows: all.map(row).collect(),
        left: 1,
    });
    if let (Some(first), Some(last)) = (found.amplitude_ratio_first, found.amplitude_ratio_last) {
        section.line(format!(
            "amplitude of the nutation, B over A: {} at first, {} at the end",
            significant(first, 4),
            significant(last, 4)
        ));
    }
    let ahead = found.phase_last;
    let order = if ahead < 0.0 { "behind" } else { "ahead" };
    let mut line = format!(
        "phase: B is {} nutations {order} at the end",
        significant(ahead.abs(), 3)
    );
    if let Some(time) = found.decorrelated {
        line += &format!("; a quarter and more from {time:.3} s on");
    }
    section.line(line);
    section
}

/// The name of a quantity for people.
fn readable(name: &str) -> String {
    for (ending, word) in [
        ("_mean", "mean "),
        ("_min", "least "),
        ("_max", "greatest "),
    ] {
        if let Some(base) = name.strip_suffix(ending) {
            return format!("{word}{}", symbol(base));
        }
    }
    name.replace('_', " ")
}

fn signals(report: &Report, detail: Detail) -> Section {
    let found = &report.signals;
    let mut note = format!(
        "{:.3} s to {:.3} s: {}",
        found.from, found.to, found.alignment
    );
    if let Some(clock) = &report.clock {
        let origin = match &clock.origin {
            Some(date) => format!("; times from {date} on"),
            None => String::new(),
        };
        let offset = match clock.offset_ns {
            0 => String::new(),
            ns => format!("; B's clock is put forward by {} s", ns as f64 / 1e9),
        };
        note = note + &origin + &offset;
    }
    let mut section = Section::new("Signals");
    if report.verdict.has_same_values() {
        return section;
    }
    section.line(note);
    let mut rows = Vec::new();
    for channel in found
        .channels
        .iter()
        .filter(|channel| is_by_itself(channel))
    {
        rows.extend(channel_rows(channel, detail));
    }
    section.table(Table {
        header: cells([
            "topic and field",
            "largest B − A",
            "at",
            "RMS",
            "relative",
            "first at",
            "beyond",
        ]),
        rows,
        left: 1,
    });
    for line in unmatched(&found.channels) {
        section.line(line);
    }
    if let Some(line) = parted(&found.parted) {
        section.line(line);
    }
    let growths: Vec<String> = found.growth.iter().map(growth).collect();
    if !growths.is_empty() {
        section.line(format!("growth: {}", growths.join("; ")));
    }
    if let Some(error) = interpolation(found) {
        section.line(error);
    }
    section
}

fn channel_rows(channel: &ChannelDifference, detail: Detail) -> Vec<Vec<String>> {
    let own = || channel.fields.iter().filter(|field| !field.is_derived);
    let differs = |field: &&FieldDifference| field.first_different.is_some();
    let counts = |field: &&FieldDifference| differs(field) && !field.is_below_floor;
    let (differing, counting) = (own().filter(differs).count(), own().filter(counts).count());
    if differing == 0 {
        let what = match channel.pairs {
            0 if channel.is_empty() => "no messages",
            0 => "no common times",
            _ if channel.bytes.is_some() => "other bytes",
            _ => "equal",
        };
        return vec![vec![channel.topic.clone(), what.to_owned()]];
    }
    let fields: Vec<&FieldDifference> = match detail {
        Detail::AllFields => channel.fields.iter().filter(differs).collect(),
        Detail::Short if counting == 0 => {
            return vec![vec![
                channel.topic.clone(),
                "equal but for errors ≈".to_owned(),
            ]];
        }
        Detail::Short => {
            let order = |x: &&FieldDifference, y: &&FieldDifference| {
                importance(x, channel).total_cmp(&importance(y, channel))
            };
            let worst = own().filter(counts).max_by(order);
            let derived = channel.fields.iter().filter(|field| field.is_derived);
            worst.into_iter().chain(derived.filter(differs)).collect()
        }
    };
    let mut rows = Vec::new();
    rows.push(vec![
        channel.topic.clone(),
        format!("{counting} of {} fields", own().count()),
    ]);
    rows.extend(fields.into_iter().map(field_row));
    rows
}

/// How much a field differs for the size of the fields with its unit; infinite where one of two numbers is none.
fn importance(field: &FieldDifference, channel: &ChannelDifference) -> f64 {
    if field.not_numbers + field.other_values > 0 {
        return f64::INFINITY;
    }
    if field.unit.is_empty() {
        return field.relative;
    }
    // What is nearly zero throughout differs by a large part of itself, which means nothing.
    let alike = channel
        .fields
        .iter()
        .filter(|other| other.unit == field.unit);
    let scale = alike.map(|other| other.scale).fold(0.0, f64::max);
    if scale > 0.0 {
        field.largest.abs() / scale
    } else {
        0.0
    }
}

fn field_row(field: &FieldDifference) -> Vec<String> {
    let mark = if field.is_below_floor { " ≈" } else { "" };
    let name = clipped(&field.field, 30);
    let first = field
        .first_different
        .map_or(String::new(), |time| format!("{time:.3} s"));
    let at = if field.largest == 0.0 {
        first.clone()
    } else {
        format!("{:.3} s", field.at)
    };
    let largest = if field.largest != 0.0 {
        quantity(field.largest, 3, &field.unit) + mark
    } else if let Some((count, what)) = odd(field) {
        format!("{} {what}", numbers::count(count))
    } else {
        quantity(field.largest, 3, &field.unit) + mark
    };
    let relative = match field.ulp {
        _ if field.is_derived => String::new(),
        Some(ulp) if ulp > 0 && field.relative < 1e-12 => format!("{ulp} ulp"),
        _ => significant(field.relative, 2),
    };
    vec![
        format!("  {name}"),
        largest,
        at,
        significant(field.rms, 2),
        relative,
        first,
        if field.is_derived {
            String::new()
        } else {
            numbers::count(field.beyond)
        },
    ]
}

/// What differs in a field whose numbers don't, and how often.
fn odd(field: &FieldDifference) -> Option<(u64, &'static str)> {
    let kinds = [
        (field.not_numbers, "no finite number in one"),
        (field.other_values, "values differ"),
        (field.signs_of_zero, "zeros with other signs"),
        (field.nan_bits, "NaNs with other bits"),
    ];
    kinds.into_iter().find(|(count, _)| *count > 0)
}

/// Whether its messages can be compared in their order; events that came in another order are matched above.
fn is_by_itself(channel: &ChannelDifference) -> bool {
    !(channel.fields.is_empty() && channel.texts.is_some())
}

/// So many messages.
fn messages(count: u64) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{} message{ending}", numbers::count(count))
}

/// Messages without a counterpart, topics with as many of them together.
fn unmatched(channels: &[ChannelDifference]) -> Vec<String> {
    let mut lines: Vec<(String, Vec<String>)> = Vec::new();
    let mut known: BTreeMap<String, usize> = BTreeMap::new();
    let mut add = |what: String, topic: &str| {
        let at = *known.entry(what.clone()).or_insert(lines.len());
        if at == lines.len() {
            lines.push((what, Vec::new()));
        }
        lines[at].1.push(topic.to_owned());
    };
    for channel in channels.iter().filter(|channel| is_by_itself(channel)) {
        for (name, within, beyond, before) in [
            (
                "A",
                channel.only_in_a,
                channel.beyond_in_a,
                channel.before_in_a,
            ),
            (
                "B",
                channel.only_in_b,
                channel.beyond_in_b,
                channel.before_in_b,
            ),
        ] {
            let after = beyond - before.min(beyond);
            if within > 0 {
                add(
                    format!("only in {name}: {} messages", numbers::count(within)),
                    &channel.topic,
                );
            }
            for (what, count) in [("begins with", before), ("goes on for", after)] {
                if count > 0 && channel.pairs > 0 {
                    let count = numbers::count(count);
                    add(
                        format!("{name} {what} {count} messages that the other has not"),
                        &channel.topic,
                    );
                }
            }
        }
        for (name, between) in [("A", channel.between_in_a), ("B", channel.between_in_b)] {
            if between > 0 {
                add(
                    format!("{name} has {} in between", messages(between)),
                    &channel.topic,
                );
            }
        }
        if let Some(bytes) = &channel.bytes {
            let length = |length: Option<u64>| length.map_or("none".to_owned(), numbers::count);
            add(
                format!(
                    "{} of the pairs differ byte by byte, first at {} s: from byte {} on ({} in A, {} in B)",
                    numbers::count(bytes.count),
                    bytes.time,
                    bytes.offset,
                    length(bytes.length_a),
                    length(bytes.length_b)
                ),
                &channel.topic,
            );
        }
        let is_alone = |text: &&TextDifference| {
            let mut fields = channel.fields.iter();
            !text.field.is_empty() || fields.all(|field| field.first_different.is_none())
        };
        if let Some(text) = channel.texts.as_ref().filter(is_alone) {
            let (a, b) = (clipped(&text.a, 60), clipped(&text.b, 60));
            let first = format!("first at {} s: {a:?} in A, {b:?} in B", text.time);
            let field = match text.field.as_str() {
                "" => String::new(),
                field => format!(" in {field}"),
            };
            add(
                format!("{} texts differ, {first}{field}", text.count),
                &channel.topic,
            );
        }
    }
    lines
        .into_iter()
        .map(|(what, topics)| format!("{what} ({})", shortened(&topics)))
        .collect()
}

/// The first field of each kind that parted.
fn parted(partings: &[Parting]) -> Option<String> {
    let mut first: Vec<&Parting> = Vec::new();
    for parting in partings
        .iter()
        .filter(|parting| parting.kind != QuantityKind::Other)
    {
        if !first.iter().any(|known| known.kind == parting.kind) {
            first.push(parting);
        }
    }
    let told: Vec<String> = first
        .iter()
        .map(|parting| {
            format!(
                "{} ({} at {} s)",
                parting.kind.name(),
                parting.field,
                parting.time
            )
        })
        .collect();
    (!told.is_empty()).then(|| format!("parted in this order: {}", told.join(", ")))
}

fn growth(growth: &Growth) -> String {
    let field = growth.field.rsplit('.').next().unwrap_or_default();
    let name = symbol(field);
    let law = match growth.law {
        GrowthLaw::Bounded => "bounded".to_owned(),
        GrowthLaw::Power => format!("as t^{:.2}", growth.parameter),
        GrowthLaw::Exponential => format!("as e^({} t)", significant(growth.parameter, 3)),
    };
    match growth.law {
        // A constant explains no part of the variance.
        GrowthLaw::Bounded => format!("{name} {law}"),
        _ => format!("{name} {law} (R² {:.3})", growth.quality),
    }
}

fn interpolation(signals: &Signals) -> Option<String> {
    let fields = signals.fields();
    let known = fields.filter_map(|(topic, field)| {
        let error = field.interpolation_error? / field.scale;
        error.is_finite().then_some((topic, field, error))
    });
    let (topic, field, error) = known.max_by(|x, y| x.2.total_cmp(&y.2))?;
    Some(format!(
        "interpolated to at most {} of a field's size ({topic}.{})",
        significant(error, 2),
        field.field
    ))
}

fn models(report: &Report) -> Section {
    let Some(found) = &report.discrepancy else {
        return Section::new("Models");
    };
    let note = format!(
        "B's less A's, at the {} states that A goes through",
        numbers::count(found.states)
    );
    let mut section = Section::new("Models");
    section.note = note;
    let row = |residual: &Residual| {
        vec![
            residual.quantity.clone(),
            quantity(residual.largest, 3, &residual.unit),
            format!("{:.3} s", residual.at),
            significant(residual.rms, 3),
            significant(residual.rms_a, 3),
        ]
    };
    let differing = found
        .quantities
        .iter()
        .filter(|residual| residual.largest > 0.0);
    section.table(Table {
        header: cells(["", "largest", "at", "RMS", "RMS of A's own"]),
        rows: differing.map(row).collect(),
        left: 1,
    });
    if section.parts.is_empty() && !report.verdict.has_same_values() {
        section.line("both do the same there".to_owned());
    }
    section
}

fn errors(report: &Report) -> Section {
    let Some(found) = &report.floor else {
        return Section::new("Integrator errors");
    };
    let mut section = Section::new("Integrator errors");
    "each run against itself with tighter tolerances".clone_into(&mut section.note);
    let of = |error: &IntegratorError, field: NumberField| {
        let name = field.to_string();
        let found = error.fields.iter().find(|(field, _)| *field == name);
        found.map_or(String::new(), |(_, error)| significant(*error, 2))
    };
    let row = |letter: &str, error: &IntegratorError| {
        vec![
            letter.to_owned(),
            format!("{:e} → {:e}", error.relative_tolerance, error.compared_with),
            of(error, state::THETA),
            of(error, state::PHI_DOT),
            of(error, state::PSI),
            duration(error.event_shift),
        ]
    };
    section.table(Table {
        header: cells(["", "tolerance", "θ [rad]", "φ̇ [rad/s]", "ψ [rad]", "events"]),
        rows: vec![row("A", &found.a), row("B", &found.b)],
        left: 2,
    });
    let (differing, below) = report.signals.at_floor();
    if below > 0 {
        section.line(format!(
            "{below} of {differing} fields differ by no more than that (marked ≈)"
        ));
    }
    section
}

fn remarks(report: &Report) -> Section {
    let mut section = Section::new("Remarks");
    for (name, run) in [("A", &report.a), ("B", &report.b)] {
        for loss in run.losses.iter().take(SHOWN) {
            section.line(format!("{name}: without {loss}"));
        }
        if run.losses.len() > SHOWN {
            section.line(format!("{name}: {} more losses", run.losses.len() - SHOWN));
        }
    }
    for note in &report.notes {
        section.line(note.clone());
    }
    section
}

/// The page of three or more runs.
pub(super) fn matrix_page(matrix: &Matrix) -> Page {
    let letters: Vec<String> = (0..matrix.runs.len()).map(letter).collect();
    let mut runs = Section::new("Runs");
    runs.table(Table {
        header: cells(["", "run", "end", "rise [s]", "energy lost [J]", "nutations"]),
        rows: matrix
            .runs
            .iter()
            .zip(&letters)
            .map(|(run, letter)| {
                vec![
                    letter.clone(),
                    clipped(&run.name, 40),
                    run.stop_reason.clone().unwrap_or("–".to_owned()),
                    time_cell(run.rise_time),
                    run.energy_lost
                        .map_or("–".to_owned(), |lost| significant(lost, 6)),
                    run.nutations
                        .map_or("–".to_owned(), |count| count.to_string()),
                ]
            })
            .collect(),
        left: 3,
    });
    let mut distances = Section::new("Averaged distance");
    "root mean square difference of the mean θ [rad]".clone_into(&mut distances.note);
    let cell = |distance: &Option<f64>| distance.map_or("–".to_owned(), |d| significant(d, 3));
    distances.table(Table {
        header: std::iter::once(String::new())
            .chain(letters.iter().cloned())
            .collect(),
        rows: matrix
            .theta_distance
            .iter()
            .zip(&letters)
            .map(|(row, letter)| {
                std::iter::once(letter.clone())
                    .chain(row.iter().map(cell))
                    .collect()
            })
            .collect(),
        left: 1,
    });
    let mut against = Section::new("Each against A");
    for (report, letter) in matrix.against_first.iter().zip(&letters[1..]) {
        let summary = report.sentences([&letters[0], letter]).join(" ");
        against.line(format!("{letter}  {summary}"));
    }
    let verdicts = || matrix.against_first.iter().map(|report| report.verdict);
    let all_same = verdicts().all(Verdict::has_same_messages);
    Page {
        title: if all_same { "Equal" } else { "Different" }.to_owned(),
        tone: if all_same { Tone::Good } else { Tone::Weak },
        subjects: Table::default(),
        summary: vec![format!(
            "{} of {} runs are equal to the first.",
            verdicts()
                .filter(|verdict| verdict.has_same_messages())
                .count(),
            verdicts().count()
        )],
        sections: vec![runs, distances, against],
    }
}

/// A, B, …, Z, AA, AB, …
fn letter(at: usize) -> String {
    let of = |at: usize| char::from(b'A' + (at % 26) as u8);
    if at < 26 {
        of(at).to_string()
    } else {
        format!("{}{}", letter(at / 26 - 1), of(at))
    }
}

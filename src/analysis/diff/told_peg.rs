//! Sentences about what free pegs did: hop, land and roll, and what came of it.

use super::happened::Happened;
use super::tale::{Tale, angle};
use super::told_motion::event_error;
use crate::analysis::course::{CourseReport, Doing, PegReport};
use crate::analysis::phrase::{list, moment, pair};
use crate::run::simulation::EventKind;

/// A top whose θ swings by no more than this part of itself while it rolls has one inclination, to three digits.
const ONE_INCLINATION: f64 = 0.005;

/// One of two runs.
#[derive(Clone, Copy)]
struct Side<'r> {
    name: &'r str,
    course: &'r CourseReport,
    /// Its place in pairs.
    index: usize,
}

/// What both did, in one sentence, if the peg of one is free. What both did at the same times is left out.
pub(super) fn finding(tale: Tale<'_>) -> Option<String> {
    let happened = tale.report.happened.as_ref()?;
    let [(a, of_a), (b, of_b)] = tale.courses()?;
    let is_free = [of_a, of_b].map(|course| course.peg.is_some());
    if is_free == [false; 2] {
        return None;
    }
    let sides = [
        Side {
            name: a,
            course: of_a,
            index: 0,
        },
        Side {
            name: b,
            course: of_b,
            index: 1,
        },
    ];
    let told = sides.map(|side| clauses(tale, happened, side));
    let differs = is_free[0] != is_free[1];
    if !differs && (told[0] == told[1] || is_same(tale, happened)) {
        return None;
    }
    let sentence = |side: Side<'_>, clauses: &[String]| {
        let peg = match (differs, side.course.peg.is_some()) {
            (false, _) => "",
            (true, true) => ", whose peg is free,",
            (true, false) => ", whose peg is held,",
        };
        format!("{}{peg} {}", side.name, list(clauses))
    };
    let [one, other] = [0, 1].map(|index| sentence(sides[index], &told[index]));
    Some(format!("{one}; {other}."))
}

/// Whether what pegs did happened to both alike, within the errors of its times.
fn is_same(tale: Tale<'_>, happened: &Happened) -> bool {
    let kinds = [
        EventKind::LiftOff,
        EventKind::Landing,
        EventKind::RollBegins,
        EventKind::RollEnds,
        EventKind::Jam,
        EventKind::Pivot,
        EventKind::Risen,
        EventKind::Fallen,
    ];
    let error = event_error(tale);
    kinds.iter().all(|kind| {
        let of_kind = happened.kinds.iter().filter(|of| of.name == kind.name());
        of_kind.into_iter().all(|of| {
            let is_matched = of.matched == of.count_a && of.matched == of.count_b;
            is_matched && of.largest_shift.is_none_or(|shift| shift.abs() <= error)
        })
    })
}

/// What one run did, each with a verb, in the order of time.
fn clauses(tale: Tale<'_>, happened: &Happened, side: Side<'_>) -> Vec<String> {
    let mut told: Vec<(f64, String)> = Vec::new();
    let (risen, fallen) = match side.index {
        0 => (happened.risen_a, happened.fallen_a),
        _ => (happened.risen_b, happened.fallen_b),
    };
    for (time, level, verb) in [
        (risen, happened.risen_level, "rises"),
        (fallen, happened.fallen_level, "falls"),
    ] {
        if let (Some(time), Some(level)) = (time, level) {
            let clause = format!("{verb} to {} at {}", angle(level), moment(time));
            told.push((time, clause));
        }
    }
    let end = side.course.stop_time.unwrap_or(f64::INFINITY);
    let reaches_end = |clause: &mut String, preposition: &str| {
        if tale.is_whole(side.name) && end.is_finite() {
            clause.push_str(&format!("{preposition} its end at {}", moment(end)));
        }
    };
    let mut is_settled = !told.is_empty();
    if let Some(peg) = &side.course.peg {
        told.extend(flying(peg));
        if let Some((time, clause, settles)) = rolling(peg) {
            let mut clause = clause;
            if settles {
                reaches_end(&mut clause, ", to");
            }
            is_settled |= settles;
            told.push((time, clause));
        }
    }
    if !is_settled {
        let ends = match side.index {
            0 => happened.averaged_ends_a,
            _ => happened.averaged_ends_b,
        };
        let theta = ends.map(|[_, last]| last);
        let (mut clause, preposition) = theta.map_or_else(
            || ("goes on".to_owned(), " to"),
            |theta| (format!("has come to {}, averaged", angle(theta)), ", by"),
        );
        reaches_end(&mut clause, preposition);
        told.push((f64::INFINITY, clause));
    }
    told.sort_by(|one, other| one.0.total_cmp(&other.0));
    told.into_iter().map(|(_, clause)| clause).collect()
}

/// How a peg was in the air, and from when on, s.
fn flying(peg: &PegReport) -> Option<(f64, String)> {
    let first = peg.first_flight?;
    let from = match first {
        0.0 => " from the start".to_owned(),
        first => format!(" from {} on", moment(first)),
    };
    let has_landed = peg.doing_last != Some(Doing::Flies);
    let told = match (peg.flights?, peg.impacts) {
        (0, _) => return None,
        (flights, Some(impacts)) if impacts > flights => format!("bounces {impacts} times{from}"),
        (1, None | Some(0)) if !has_landed => format!("flies{from}"),
        (1, _) => format!("hops once{from}"),
        (flights, _) => format!("hops {flights} times{from}"),
    };
    Some((first, told))
}

/// From when on a peg rolls, and whether it keeps its inclination from there on.
fn rolling(peg: &PegReport) -> Option<(f64, String, bool)> {
    let first = peg.first_roll?;
    let (Some(from), Some(at)) = (peg.rolls_from, peg.rolls_at) else {
        let clause = format!("rolls from {} on, but not to its end", moment(first));
        return Some((first, clause, false));
    };
    // What losses take while the peg rolls lets the axis rise on, or sink.
    if peg.lost_losses.is_none_or(|lost| lost != 0.0) {
        return Some((from, format!("rolls from {} on", moment(from)), false));
    }
    let clause = match peg.rolling_swing {
        // Nothing may keep a top that hardly spins from falling.
        None => return Some((from, format!("rolls from {} on", moment(from)), false)),
        Some([least, greatest]) if greatest - least <= ONE_INCLINATION * greatest => {
            let rises = if peg.is_tippe {
                ""
            } else {
                ", and rises no further"
            };
            format!(
                "rolls from {} on, inclined by {}{rises}",
                moment(from),
                angle(at)
            )
        }
        Some(swing) => {
            let [least, greatest] = pair(swing);
            format!(
                "rolls from {} on, with θ between {least} and {greatest} rad",
                moment(from)
            )
        }
    };
    Some((from, clause, true))
}

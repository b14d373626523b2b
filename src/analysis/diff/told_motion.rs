//! Sentences about what the tops did: how they rose, fell, looped, stuck and came to rest.
//!
//! Nothing is said of a run beyond its end: what it has not done by then it may do later.

use super::happened::Happened;
use super::tale::{Tale, angle, order};
use crate::analysis::course::CourseReport;
use crate::analysis::phrase::{duration, moment, quantity, signed_duration};
use crate::run::simulation::{EventKind, StopReason};

/// Something that may happen once in a while.
struct Happening {
    kind: EventKind,
    /// What the top does.
    verb: &'static str,
    /// Whether it goes on for some time.
    goes_on: bool,
}

const fn at(kind: EventKind, verb: &'static str) -> Happening {
    Happening {
        kind,
        verb,
        goes_on: false,
    }
}

const fn from(kind: EventKind, verb: &'static str) -> Happening {
    Happening {
        kind,
        verb,
        goes_on: true,
    }
}

/// What is told where it happened.
const HAPPENINGS: [Happening; 9] = [
    from(EventKind::LoopingBegins, "loops"),
    from(EventKind::UprightPassage, "swings through upright"),
    from(EventKind::WeakTop, "spins too slowly to stand upright"),
    from(EventKind::StrongTop, "spins fast enough to stand upright"),
    at(EventKind::SlipStops, "stops slipping"),
    at(EventKind::Stick, "sticks"),
    from(EventKind::SlipResumes, "slips again"),
    at(EventKind::Rest, "comes to rest"),
    at(
        EventKind::Singular,
        "meets the singularity of the Euler angles",
    ),
];

/// What both tops did.
pub(super) fn motion(tale: Tale<'_>) -> Vec<String> {
    let Some(happened) = &tale.report.happened else {
        return Vec::new();
    };
    let mut told = Vec::new();
    told.extend(passage(tale, happened));
    // What only one of two did, one of them with a free peg, stands in the finding.
    let has_free_peg = tale
        .courses()
        .is_some_and(|courses| courses.iter().any(|(_, course)| course.peg.is_some()));
    let is_told = |times: &Reaching| has_free_peg && times.times.contains(&None);
    let [rise, fall] = [Reaching::rise(happened), Reaching::fall(happened)]
        .map(|times| reaching(tale, times, is_told));
    let is_told = |name: &str| rise.as_ref().is_some_and(|rise| rise.tells_end_of(name));
    let falls = [(tale.a, happened.fallen_a), (tale.b, happened.fallen_b)];
    let are_told = falls
        .iter()
        .all(|(name, time)| time.is_none() || is_told(name));
    let levels = rise.into_iter().chain(fall.filter(|_| !are_told));
    told.extend(levels.map(|level| level.sentence));
    let tells_way = !told.is_empty();
    let mut others: Vec<_> = HAPPENINGS
        .iter()
        .filter_map(|happening| event(tale, happened, happening))
        .collect();
    others.sort_by(|x, y| x.0.total_cmp(&y.0));
    told.extend(others.into_iter().map(|(_, sentence)| sentence));
    if !tells_way {
        told.extend(drift(tale, happened));
    }
    told
}

/// How the averaged motions pass a level that both pass.
fn passage(Tale { b, .. }: Tale<'_>, happened: &Happened) -> Option<String> {
    let level = angle(happened.averaged_level?);
    let (shift, uncertainty) = (
        happened.averaged_shift?,
        happened.averaged_shift_uncertainty?,
    );
    let by = duration(shift);
    let within = duration(uncertainty);
    Some(if happened.is_averaged_shift_clear()? {
        let order = order(shift);
        format!("Averaged over a nutation, {b} passes {level} {by} {order} (± {within}).")
    } else {
        let time = moment(happened.averaged_crossing_a?);
        let both = format!("Averaged over a nutation, both pass {level} at {time}");
        if shift == 0.0 {
            format!("{both}.")
        } else {
            format!("{both}: the shift, {by}, is not distinguishable from none (± {within}).")
        }
    })
}

/// A level that θ reaches.
struct Reaching {
    level: Option<f64>,
    times: [Option<f64>; 2],
    verb: &'static str,
    /// What the nutation can do to the shift.
    by_nutation: Option<[f64; 2]>,
}

impl Reaching {
    fn rise(happened: &Happened) -> Self {
        Self {
            level: happened.risen_level,
            times: [happened.risen_a, happened.risen_b],
            verb: "rises",
            by_nutation: happened.rise_shift_uncertainty,
        }
    }

    fn fall(happened: &Happened) -> Self {
        Self {
            level: happened.fallen_level,
            times: [happened.fallen_a, happened.fallen_b],
            verb: "falls",
            by_nutation: None,
        }
    }
}

/// A sentence about a level, and which run's end it tells.
struct Reached {
    sentence: String,
    ended: Option<String>,
}

impl Reached {
    fn tells_end_of(&self, name: &str) -> bool {
        self.ended.as_deref() == Some(name)
    }
}

/// When θ first touches a level in one and in the other.
fn reaching(
    tale: Tale<'_>,
    reaching: Reaching,
    is_told: impl Fn(&Reaching) -> bool,
) -> Option<Reached> {
    if is_told(&reaching) {
        return None;
    }
    let level = angle(reaching.level?);
    let verb = reaching.verb;
    let [(a, of_a), (b, of_b)] = tale.courses()?;
    let one = |first: &str, time: f64, other: &str, course: &CourseReport| {
        let otherwise = otherwise(tale, other, course, time)?;
        Some(Reached {
            sentence: format!(
                "{first} {verb} to {level} at {}; {otherwise}.",
                moment(time)
            ),
            ended: Some(other.to_owned()),
        })
    };
    match reaching.times {
        [None, None] => None,
        [Some(x), None] => one(a, x, b, of_b),
        [None, Some(y)] => one(b, y, a, of_a),
        [Some(x), Some(y)] => Some(Reached {
            sentence: both(tale, &reaching, &level, [x, y]),
            ended: None,
        }),
    }
}

fn both(tale: Tale<'_>, reaching: &Reaching, level: &str, [x, y]: [f64; 2]) -> String {
    let b = tale.b;
    let shift = y - x;
    if shift.abs() <= event_error(tale) {
        let time = moment(x);
        return if reaching.verb == "falls" {
            format!("Both fall to {level} at {time}.")
        } else {
            format!("θ first touches {level} at {time} in both.")
        };
    }
    let by = duration(shift);
    let order = order(shift);
    let times = if moment(x) == moment(y) {
        format!("at {}", moment(x))
    } else {
        format!("{}, not {}", moment(y), moment(x))
    };
    if reaching.verb == "falls" {
        return format!("{b} falls to {level} {by} {order} ({times}).");
    }
    let touch = format!("In {b} θ first touches {level} {by} {order} ({times})");
    match reaching.by_nutation {
        None => format!("{touch}."),
        Some([least, greatest]) => {
            let range = format!(
                "{} to {}",
                signed_duration(least),
                signed_duration(greatest)
            );
            if (least..=greatest).contains(&shift) {
                format!(
                    "{touch}, which is not distinguishable from what the nutation does to it ({range})."
                )
            } else {
                format!("{touch}, more than the nutation can do to it ({range}).")
            }
        }
    }
}

/// Clocks of recordings count nanoseconds: what is closer is at the same time, s.
const CLOCK: f64 = 1e-9;

/// By how much events can be apart without its meaning anything, s: the integrators' errors, where they are known.
pub(super) fn event_error(tale: Tale<'_>) -> f64 {
    let floor = tale.report.floor.as_ref();
    CLOCK + floor.map_or(0.0, |floor| floor.a.event_shift + floor.b.event_shift)
}

/// How a run ended instead of reaching what another reached at a time (s); none if that isn't known.
fn otherwise(tale: Tale<'_>, name: &str, course: &CourseReport, time: f64) -> Option<String> {
    let end = course.stop_time.filter(|_| tale.is_whole(name))?;
    let is = |reason: StopReason| course.stop_reason.as_deref() == Some(reason.name());
    if is(StopReason::Fallen) {
        Some(format!("{name} falls, at {}", moment(end)))
    } else if is(StopReason::Rest) {
        Some(format!("{name} comes to rest, at {}", moment(end)))
    } else {
        not_by_its_end(tale, name, course, time)
    }
}

/// That a run had not done by its end what another did at a time (s); none if that isn't known.
fn not_by_its_end(tale: Tale<'_>, name: &str, course: &CourseReport, time: f64) -> Option<String> {
    let end = course.stop_time.filter(|_| tale.is_whole(name))?;
    let at = moment(end);
    Some(if end < time {
        format!("{name} ended before, at {at}")
    } else {
        format!("{name} does not by its end, at {at}")
    })
}

/// When something first happened, in one and in the other; the earlier time comes with the sentence, s.
fn event(tale: Tale<'_>, happened: &Happened, happening: &Happening) -> Option<(f64, String)> {
    let [(a, of_a), (b, of_b)] = tale.courses()?;
    // Regular precession of a tippe top is backward by itself: that makes no loops.
    let is_tippe = |course: &CourseReport| course.peg.as_ref().is_some_and(|peg| peg.is_tippe);
    let (verb, goes_on) = match happening.kind {
        EventKind::LoopingBegins if is_tippe(of_a) || is_tippe(of_b) => {
            ("first precesses backward", false)
        }
        _ => (happening.verb, happening.goes_on),
    };
    let when = |time: f64| {
        let time = moment(time);
        if goes_on {
            format!("from {time} on")
        } else {
            format!("at {time}")
        }
    };
    let one = |first: &str, time: f64, other: &str, course: &CourseReport| {
        let otherwise = not_by_its_end(tale, other, course, time)?;
        let sentence = format!("{first} {verb} {}; {otherwise}.", when(time));
        Some((time, sentence))
    };
    match happened.first(happening.kind) {
        [None, None] => None,
        [Some(x), None] => one(a, x, b, of_b),
        [None, Some(y)] => one(b, y, a, of_a),
        [Some(x), Some(y)] if (y - x).abs() <= event_error(tale) => None,
        [Some(x), Some(y)] => {
            let other = if moment(x) == moment(y) {
                format!("{} {}", duration(y - x), order(y - x))
            } else {
                when(y)
            };
            let sentence = format!("{a} {verb} {}; {b} {other}.", when(x));
            Some((x.min(y), sentence))
        }
    }
}

/// From where to where θ went, where the averaged motions pass no common level.
fn drift(tale: Tale<'_>, happened: &Happened) -> Option<String> {
    let averages = happened.averaged_ends_a.zip(happened.averaged_ends_b);
    let (a, b) = averages.or(happened.theta_ends_a.zip(happened.theta_ends_b))?;
    let digits = |value: f64| quantity(value, 4, "rad");
    let went = |name: &str, [from, to]: [f64; 2]| {
        let (from, to) = (digits(from), digits(to));
        if from == to {
            format!("stays at {to} in {name}")
        } else {
            format!("goes from {from} to {to} in {name}")
        }
    };
    let what = averages.map_or("θ", |_| "Averaged over a nutation, θ");
    let [stays, other] = [a, b].map(|[from, to]| (digits(from) == digits(to)).then(|| digits(to)));
    if let Some(stays) = stays.filter(|stays| other.as_ref() == Some(stays)) {
        return Some(format!("{what} stays at {stays} in both."));
    }
    Some(format!(
        "{what} {} and {}.",
        went(tale.a, a),
        went(tale.b, b)
    ))
}

//! From a request to a problem, with the checks that come before a fit.

use super::degeneracy::pronoun;
use super::model::Problem;
use super::parameter::{PROFILE, SelectedParameter, Target};
use super::plausibility::{check_signals, check_span, check_steps};
use super::request::Request;
use super::{identify, parameter};
use crate::fit::error::{FitError, bare_time, nothing_free, time, too_few};
use crate::fit::note::Note;
use crate::measured::Place;
use crate::measured::Signal;
use crate::telemetry::fields::state;
use crate::words::{Piece, Sentence, sentence};

/// A problem whose data determine its parameters.
pub(in crate::fit) struct Prepared {
    pub problem: Problem,
    /// Remarks on the data and on what they determine.
    pub notes: Vec<Note>,
    /// Time in the data at which the scenario starts, s.
    pub origin: f64,
}

/// The problem of a request, after the check of what its data can determine.
pub(in crate::fit) fn prepare(request: &Request) -> Result<Prepared, FitError> {
    let scenario = &request.scenario;
    let data = &request.data;
    let mut selected = parameter::select(&request.free, &request.bounds, scenario, data.files)?;
    // A wrong name is reported before anything is fitted.
    for name in &request.profile {
        parameter::find_free(&mut selected, name, PROFILE, scenario)?;
    }
    let origin = request.origin.unwrap_or_else(|| data.origin());
    let mut signals = data.signals.clone();
    align_clocks(&mut selected, &mut signals, origin);
    let parameters = selected
        .iter()
        .map(|selected| selected.parameter.clone())
        .collect();
    // An angle may be measured from another whole turn than the scenario's start.
    for signal in &mut signals {
        for (field, start) in [
            (state::PHI, scenario.angles.phi),
            (state::PSI, scenario.angles.psi),
        ] {
            if signal.field == field {
                signal.turn_towards(start);
            }
        }
    }
    check_values(&signals)?;
    check_gaps(&signals, origin, request.until)?;
    let mut problem = Problem::new(scenario, parameters, signals, request.loss, origin)?;
    // A cut leaves few of the times by which their unit is judged.
    check_steps(&problem)?;
    problem.keep_until(request.until);
    check_range(&problem, origin, request.until)?;
    check_duration(&problem, origin)?;
    check_span(&problem)?;
    check_signals(&problem)?;
    if selected.is_empty() {
        return Err(nothing_free());
    }
    let identified = identify::identify(&problem, &selected)?;
    problem.parameters = identified.parameters;
    if problem.points.len() <= problem.parameters.len() {
        return Err(too_few(problem.points.len(), problem.parameters.len()));
    }
    let mut notes = notes_on_clocks(&problem.signals);
    notes.extend(identified.notes);
    Ok(Prepared {
        problem,
        notes,
        origin,
    })
}

/// Remarks on files with several columns that are named like times.
fn notes_on_clocks(signals: &[Signal]) -> Vec<Note> {
    let mut notes = Vec::new();
    for (at, signal) in signals.iter().enumerate() {
        // Signals of one file share its clock.
        let is_first = signals[..at].iter().all(|other| other.file != signal.file);
        if let Some(clock) = &signal.clock
            && is_first
            && !clock.others.is_empty()
        {
            notes.push(Note::Clock {
                column: clock.name.clone(),
                others: clock.others.clone(),
            });
        }
    }
    notes
}

/// Lets the first sample of each further file be at the start of the motion, and offsets count from there.
fn align_clocks(selected: &mut [SelectedParameter], signals: &mut [Signal], origin: f64) {
    for SelectedParameter { parameter, .. } in selected {
        let Target::Offset(file) = parameter.target else {
            continue;
        };
        let mut first = f64::INFINITY;
        for signal in signals.iter().filter(|signal| signal.file == file) {
            // Times are ascending.
            first = signal.times.first().map_or(first, |time| first.min(*time));
        }
        parameter.shift_by(origin - first);
        for signal in signals.iter_mut().filter(|signal| signal.file == file) {
            for time in &mut signal.times {
                *time = origin + (*time - first);
            }
        }
    }
}

/// Refuses values that the sums of squares can't hold.
fn check_values(signals: &[Signal]) -> Result<(), FitError> {
    /// Well below the residual of a refused motion, and its square is finite.
    const MAX_SIZE: f64 = 1e25;
    for signal in signals {
        for (at, value) in signal.values.iter().enumerate() {
            let size = value.abs().max((value / signal.sigmas[at]).abs());
            if size.is_nan() || size > MAX_SIZE {
                return Err(FitError::refused(sentence!(
                    "{}: the value {} at t = {}, with the standard deviation {}, is too large to be fitted: remove it",
                    signal.value_place(at),
                    format!("{value:e}"),
                    time(signal.times[at]),
                    format!("{:e}", signal.sigmas[at])
                )));
            }
        }
    }
    Ok(())
}

/// Refuses data with a gap that no motion can be followed through: a mistaken time of one row would otherwise make the
/// simulation many times longer than the data.
fn check_gaps(signals: &[Signal], origin: f64, until: Option<f64>) -> Result<(), FitError> {
    /// Usual steps that a camera may lose without being suspected of a wrong time.
    const MAX_LOST_STEPS: f64 = 100.0;
    /// So few values don't determine a motion by themselves.
    const MAX_STRAY: usize = 3;
    /// Gap beyond which so few values count as stray, relative to the time of all others.
    const MAX_STRAY_GAP: f64 = 0.1;
    let end = origin + until.unwrap_or(f64::INFINITY);
    let mut times: Vec<f64> = Vec::new();
    for signal in signals.iter().filter(|signal| signal.file == 0) {
        let is_fitted = |time: &&f64| (origin..=end).contains(*time);
        times.extend(signal.times.iter().filter(is_fitted));
    }
    times.sort_by(f64::total_cmp);
    // Signals of one file share its rows.
    times.dedup();
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let Some(longest) = (0..steps.len()).max_by(|a, b| steps[*a].total_cmp(&steps[*b])) else {
        return Ok(());
    };
    let (before, after) = (longest + 1, times.len() - longest - 1);
    let [from, to] = [times[longest], times[longest + 1]];
    let gap = to - from;
    let [first, last] = [times[0], times[times.len() - 1]];
    let rest = (from - first) + (last - to);
    steps.sort_by(f64::total_cmp);
    let usual = steps[steps.len() / 2];
    let limit = if before.min(after) <= MAX_STRAY {
        MAX_STRAY_GAP * rest
    } else {
        rest
    };
    if gap <= MAX_LOST_STEPS * usual || gap <= limit {
        return Ok(());
    }
    let is_stray_first = before < after;
    let (nearest, side, cut) = if is_stray_first {
        let start = Piece::argument_with("start", to.to_string());
        (from, "before it", start)
    } else {
        // Half of a usual step: a decimal fraction may be rounded.
        let until = rounded(from - origin + usual / 2.0);
        let until = Piece::argument_with("until", until.to_string());
        (to, "after it", until)
    };
    let stray = before.min(after);
    let them = pronoun(stray);
    Err(FitError::refused(sentence!(
        "the data have no values from t = {} to {}, and are only {} long without this gap; a time may be wrong ({} {}{}); remove {}, or leave {} out with {}",
        bare_time(from),
        time(to),
        time(rest),
        Piece::count(stray as u64, "row"),
        side,
        stray_place(stray, find_time(signals, nearest)),
        them,
        them,
        cut
    )))
}

/// Where stray rows are, after their number; `place` is that of the one next to the gap.
fn stray_place(stray: usize, place: Option<Place>) -> Sentence {
    match place {
        Some(place) if stray == 1 => sentence!(": {}", place.to_string()),
        Some(place) => sentence!(", next to it {}", place.to_string()),
        None => Sentence::default(),
    }
}

/// The line of a time of the first file.
fn find_time(signals: &[Signal], time: f64) -> Option<Place> {
    for signal in signals.iter().filter(|signal| signal.file == 0) {
        // Times are ascending.
        let at = signal.times.partition_point(|earlier| *earlier < time);
        if signal.times.get(at) == Some(&time) {
            return signal.place(at);
        }
    }
    None
}

/// A time to the microsecond.
fn rounded(time: f64) -> f64 {
    (time * 1e6).round() / 1e6
}

/// Refuses signals of the first file without a value in the time that is fitted.
fn check_range(problem: &Problem, origin: f64, until: Option<f64>) -> Result<(), FitError> {
    for (index, signal) in problem.signals.iter().enumerate() {
        let mut points = problem.points.iter();
        if signal.file == 0 && !points.any(|point| point.signal == index) {
            let [first, last] = [signal.times.first(), signal.times.last()]
                .map(|time| time.copied().unwrap_or(f64::NAN));
            return Err(FitError::refused(sentence!(
                "{} has no value from t = {}{}: its times are {} to {}; see {} and {}",
                Piece::field(signal.field.to_string()),
                time(origin),
                match until {
                    Some(until) => sentence!(" to {}", time(origin + until)),
                    None => Sentence::default(),
                },
                bare_time(first),
                time(last),
                Piece::argument("start"),
                Piece::argument("until")
            )));
        }
    }
    Ok(())
}

/// Refuses data that end where they start: no friction has acted yet. A single sample is the usual case.
fn check_duration(problem: &Problem, origin: f64) -> Result<(), FitError> {
    let mut samples = 0;
    for point in &problem.points {
        if problem.signals[point.signal].file > 0 {
            continue;
        }
        if point.time > 0.0 {
            return Ok(());
        }
        samples += 1;
    }
    Err(FitError::refused(sentence!(
        "{} at t = {}, where the scenario starts, can't determine a motion: measure at several times",
        match samples {
            1 => Piece::from("a single sample"),
            _ => Piece::count(samples, "sample"),
        },
        time(origin)
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_long_gaps() {
        /// A time, s, at 100 Hz.
        fn hundredths(range: std::ops::Range<i32>) -> Vec<f64> {
            range.map(|i| f64::from(i) / 100.0).collect()
        }
        let camera = hundredths(0..500);
        let [all, early, late, far] = [vec![], vec![-5.0], vec![55.0], vec![1e18]]
            .map(|stray| [stray, camera.clone()].concat());
        let paused = [hundredths(0..300), hundredths(500..800)].concat();
        let far_apart = [hundredths(0..300), hundredths(2000..2300)].concat();
        let lost_frames = [hundredths(0..497), hundredths(590..593)].concat();
        for (name, times, until, expected) in [
            ("none", all, None, None),
            ("an early row", early, None, Some("start = 0")),
            ("a late row", late.clone(), None, Some("until = 4.995")),
            ("a late row that is left out", late, Some(6.0), None),
            ("a row in the far future", far, None, Some("until = 4.995")),
            ("a pause", paused, None, None),
            (
                "a pause longer than the data",
                far_apart,
                None,
                Some("until = 2.995"),
            ),
            ("lost frames before the end", lost_frames, None, None),
            ("few values", vec![0.0, 1.0, 50.0], None, None),
        ] {
            let values = vec![0.5; times.len()];
            let signal = Signal::from_values(state::THETA, &times, &values, Some(1e-3)).unwrap();
            let origin = signal.times[0];
            let error = check_gaps(&[signal], origin, until).err();
            let message = error.map(|error| error.to_string());
            match (&message, expected) {
                (None, None) => {}
                (Some(message), Some(part)) => {
                    assert!(message.ends_with(part), "{name}: {message}");
                }
                (Some(_) | None, Some(_) | None) => panic!("{name}: {message:?}"),
            }
        }
    }
}

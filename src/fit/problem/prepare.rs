//! From a request to a problem, with the checks that come before a fit.

use super::degeneracy::pronoun;
use super::meeting::{check_precession, check_rest};
use super::model::Problem;
use super::parameter::{PROFILE, SelectedParameter, Target};
use super::plausibility::check_ranges;
use super::request::Request;
use super::{identify, parameter};
use crate::fit::error::{FitError, bare_time, nothing_free, time, too_few};
use crate::fit::note::Note;
use crate::measured::{Data, Place, Signal};
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
    let mut selected =
        parameter::select(&request.free, &request.bounds, scenario, data.files.len())?;
    // A wrong name is reported before anything is fitted.
    for name in &request.profile {
        parameter::find_free(&mut selected, name, PROFILE, scenario)?;
    }
    let own_clocks = own_clocks(&selected);
    let clock = SharedClock::new(data, &own_clocks);
    let origin = clock.origin(request)?;
    let mut signals = data.signals.clone();
    align_clocks(&mut selected, &mut signals, origin);
    let parameters = selected
        .iter()
        .map(|selected| selected.parameter.clone())
        .collect();
    check_values(&signals)?;
    check_gaps(&signals, data, &own_clocks, origin, request.until)?;
    let signals = joined(signals, &own_clocks);
    let mut problem = Problem::new(scenario, parameters, signals, request.loss, origin)?;
    check_ranges(&problem, &data.signals, &data.files)?;
    problem.keep_until(request.until.map(|until| until - origin));
    check_duration(&problem, origin)?;
    check_range(&problem, origin, request.until)?;
    check_rest(&problem, origin)?;
    check_precession(&problem)?;
    if selected.is_empty() {
        return Err(nothing_free());
    }
    let identified = identify::identify(&problem, &selected)?;
    problem.parameters = identified.parameters;
    problem.kept = identified.kept;
    if problem.points.len() <= problem.parameters.len() {
        return Err(too_few(problem.points.len(), problem.parameters.len()));
    }
    Ok(Prepared {
        problem,
        notes: identified.notes,
        origin,
    })
}

/// The time in the data at which the scenario of a request starts, s.
pub(in crate::fit) fn origin(request: &Request) -> Result<f64, FitError> {
    let Request {
        free,
        bounds,
        scenario,
        data,
        ..
    } = request;
    let selected = parameter::select(free, bounds, scenario, data.files.len())?;
    SharedClock::new(data, &own_clocks(&selected)).origin(request)
}

/// The files that have a clock of their own.
fn own_clocks(selected: &[SelectedParameter]) -> Vec<usize> {
    let mut files = Vec::new();
    for one in selected {
        if let Target::Offset(file) = one.parameter.target {
            files.push(file);
        }
    }
    files
}

/// The times on the clock that files share.
pub(super) struct SharedClock {
    first: f64,
    last: f64,
    /// Whether it is that of a run of toprise.
    starts_with_run: bool,
}

impl SharedClock {
    pub(super) fn new(data: &Data, own_clocks: &[usize]) -> Self {
        let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
        for signal in &data.signals {
            // Times are ascending.
            if let ([start, ..], [.., end]) = (&signal.times[..], &signal.times[..])
                && !own_clocks.contains(&signal.file)
            {
                (first, last) = (first.min(*start), last.max(*end));
            }
        }
        Self {
            first,
            last,
            starts_with_run: data.starts_with_run,
        }
    }

    /// The time in the data at which the scenario starts, s.
    fn origin(&self, request: &Request) -> Result<f64, FitError> {
        let Some(origin) = request.origin else {
            let start = if self.starts_with_run {
                0.0
            } else {
                self.first
            };
            return Ok(if start.is_finite() { start } else { 0.0 });
        };
        // A release may be known to be somewhat before the first value.
        let earliest = self.first - (self.last - self.first).max(1.0);
        if (earliest..=self.last).contains(&origin) {
            return Ok(origin);
        }
        Err(FitError::refused(sentence!(
            "{}: the data are from t = {} to {}",
            Piece::argument_with("start", origin.to_string()),
            bare_time(self.first),
            time(self.last)
        )))
    }

    /// The time from the first value to the last, s.
    pub(super) fn duration(&self) -> f64 {
        (self.last - self.first).max(0.0)
    }
}

/// Signals of one field that go on in another file are one.
fn joined(signals: Vec<Signal>, own_clocks: &[usize]) -> Vec<Signal> {
    let mut joined: Vec<Signal> = Vec::new();
    for signal in signals {
        let is_shared = |signal: &Signal| !own_clocks.contains(&signal.file);
        let part = joined.iter_mut().find(|part| {
            let is_alike =
                part.field == signal.field && part.is_sigma_estimated == signal.is_sigma_estimated;
            is_alike && is_shared(part) && is_shared(&signal) && !part.overlaps(&signal)
        });
        match part {
            Some(part) => part.join(signal),
            None => joined.push(signal),
        }
    }
    joined
}

/// Lets the first sample of each file with a clock of its own be at the start of the motion, and offsets count from there.
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
fn check_gaps(
    signals: &[Signal],
    data: &Data,
    own_clocks: &[usize],
    origin: f64,
    until: Option<f64>,
) -> Result<(), FitError> {
    /// Usual steps that a camera may lose without being suspected of a wrong time.
    const MAX_LOST_STEPS: f64 = 100.0;
    /// So few values don't determine a motion by themselves.
    const MAX_STRAY: usize = 3;
    /// Gap beyond which so few values count as stray, relative to the time of all others.
    const MAX_STRAY_GAP: f64 = 0.1;
    let end = until.unwrap_or(f64::INFINITY);
    let mut times: Vec<f64> = Vec::new();
    for signal in signals
        .iter()
        .filter(|signal| !own_clocks.contains(&signal.file))
    {
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
    if let Some(apart) = files_apart(signals, data, own_clocks, [from, to]) {
        return Err(apart);
    }
    let is_stray_first = before < after;
    let (nearest, side, cut) = if is_stray_first {
        let start = Piece::argument_with("start", to.to_string());
        (from, "before it", start)
    } else {
        // Half of a usual step: a decimal fraction may be rounded.
        let until = rounded(from + usual / 2.0);
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

/// The error of files between which a gap is: they don't share a clock.
fn files_apart(
    signals: &[Signal],
    data: &Data,
    own_clocks: &[usize],
    [from, to]: [f64; 2],
) -> Option<FitError> {
    let (mut before, mut after) = (None, None);
    for signal in signals
        .iter()
        .filter(|signal| !own_clocks.contains(&signal.file))
    {
        let is_early = signal.times.iter().all(|time| *time <= from);
        let is_late = signal.times.iter().all(|time| *time >= to);
        match (is_early, is_late) {
            (true, false) => before = Some(signal.file),
            (false, true) => after = Some(signal.file),
            (true | false, _) => return None,
        }
    }
    let [before, after] = [before?, after?].map(|file| data.files[file].file.clone());
    Some(FitError::refused(sentence!(
        "{} ends at t = {}, {} begins at {}: files share one clock; if these don't, add offset to {}",
        before,
        bare_time(from),
        after,
        time(to),
        Piece::argument("free")
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

/// The line of a time.
fn find_time(signals: &[Signal], time: f64) -> Option<Place> {
    for signal in signals {
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

/// Refuses signals without a value in the time that is fitted.
fn check_range(problem: &Problem, origin: f64, until: Option<f64>) -> Result<(), FitError> {
    for (index, signal) in problem.signals.iter().enumerate() {
        let mut points = problem.points.iter();
        let has_own_clock = problem.has_own_clock(signal.file);
        if !has_own_clock && !points.any(|point| point.signal == index) {
            let [first, last] = [signal.times.first(), signal.times.last()]
                .map(|time| time.copied().unwrap_or(f64::NAN));
            return Err(FitError::refused(sentence!(
                "{} has no value from t = {}{}: its times are {} to {}; see {} and {}",
                Piece::field(signal.field.to_string()),
                time(origin),
                match until {
                    Some(until) => sentence!(" to {}", time(until)),
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
        if !problem.is_on_clock(point) {
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
    use crate::telemetry::fields::state;

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
            let error = check_gaps(&[signal], &Data::default(), &[], origin, until).err();
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

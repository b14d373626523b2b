//! Times in seconds, and in whole nanoseconds, as recorded.

/// Nanoseconds in a second.
pub(crate) const NANOSECONDS: u64 = 1_000_000_000;

/// Whole nanoseconds in seconds, correctly rounded.
pub(crate) fn seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

/// The nearest whole number of nanoseconds to a time (s) that is not negative.
pub(crate) fn nanoseconds(time: f64) -> u64 {
    (time * 1e9).round() as u64
}

/// A time split into whole seconds and the remaining nanoseconds, as in timestamps.
pub(crate) fn seconds_and_nanoseconds(time_ns: u64) -> (u64, u64) {
    (time_ns / NANOSECONDS, time_ns % NANOSECONDS)
}

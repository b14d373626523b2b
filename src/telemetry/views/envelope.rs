//! Ranges of nutating quantities.

use crate::telemetry::fields::{NUTATING, NUTATION, NumberField, TORQUE, nutation, torque};
use crate::telemetry::message::Message;

/// Number of nutation periods for which the ranges of a nutation are valid, unless the next one ends before.
const MAX_AGE: f64 = 2.0;

/// The ranges of nutating quantities in the last nutation.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    /// Least and greatest values, in the order of [`NUTATING`].
    ranges: [[f64; 2]; 4],
    /// Range of the torque about the line of nodes, of which nutations record none, since the last nutation ended.
    growing: [f64; 2],
    /// Range of its samples in the last nutation.
    torque: [f64; 2],
    /// End of the ranges' validity, ns.
    until_ns: u64,
    /// The time of the last message, ns.
    now_ns: u64,
}

impl Envelope {
    pub(super) fn new() -> Self {
        Self {
            ranges: [[f64::NAN; 2]; 4],
            growing: [f64::NAN; 2],
            torque: [f64::NAN; 2],
            until_ns: 0,
            now_ns: 0,
        }
    }

    /// Processes a message of any channel.
    pub(super) fn update(&mut self, message: &Message<'_>) {
        self.now_ns = message.time_ns;
        if message.topic() == TORQUE {
            let value = torque::TOTAL_NODE.x().of(message);
            let [least, greatest] = self.growing;
            // The other number, if one is NaN.
            self.growing = [least.min(value), greatest.max(value)];
        }
        if message.topic() == NUTATION {
            self.ranges = NUTATING
                .map(|[_, least, greatest]| [least, greatest].map(|field| field.of(message)));
            self.torque = std::mem::replace(&mut self.growing, [f64::NAN; 2]);
            let lasting = (1e9 * MAX_AGE * nutation::PERIOD.of(message)) as u64;
            self.until_ns = message.time_ns.saturating_add(lasting);
        }
    }

    /// A value of a quantity, and its minimum and maximum in the last nutation; without nutation, the value itself.
    pub(super) fn around(&self, field: NumberField, value: f64) -> [f64; 3] {
        let place = NUTATING.iter().position(|[known, ..]| *known == field);
        match place.filter(|_| self.now_ns < self.until_ns) {
            Some(place) => [value, self.ranges[place][0], self.ranges[place][1]],
            None => [value; 3],
        }
    }

    /// A torque about the line of nodes, and the minimum and maximum of its samples in the last nutation; without
    /// nutation, the torque itself.
    pub(super) fn around_torque(&self, value: f64) -> [f64; 3] {
        let [least, greatest] = self.torque;
        if self.now_ns < self.until_ns && least <= greatest {
            [value, least, greatest]
        } else {
            [value; 3]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::{STATE, state};
    use crate::telemetry::table::channels;

    fn state(envelope: &mut Envelope, sequence: u32) {
        let channel = STATE.index();
        envelope.update(&Message {
            channel,
            sequence,
            time_ns: 1_000_000 * u64::from(sequence),
            numbers: &vec![0.0; channels()[channel].numbers.len()],
            texts: &[],
        });
    }

    /// A nutation of 20 ms in which every quantity goes from −1 to 1.
    fn nutation(envelope: &mut Envelope, sequence: u32, time_ns: u64) {
        let channel = NUTATION.index();
        let value = |path: &str| match path {
            "period" => 0.02,
            path if path.ends_with("_min") => -1.0,
            _ => 1.0,
        };
        let numbers = channels()[channel].numbers.iter();
        let numbers: Vec<f64> = numbers.map(|leaf| value(&leaf.path)).collect();
        let message = Message {
            channel,
            sequence,
            time_ns,
            numbers: &numbers,
            texts: &[],
        };
        envelope.update(&message);
    }

    #[test]
    fn range_lasts_until_next_nutation_or_two_periods() {
        let mut envelope = Envelope::new();
        let around = |envelope: &Envelope| envelope.around(state::PHI_DOT, 0.5);
        state(&mut envelope, 0);
        assert_eq!(around(&envelope), [0.5; 3]);
        nutation(&mut envelope, 0, 500_000);
        state(&mut envelope, 1);
        assert_eq!(around(&envelope), [0.5, -1.0, 1.0]);
        (2..41).for_each(|sequence| state(&mut envelope, sequence));
        assert_eq!(around(&envelope), [0.5, -1.0, 1.0]);
        state(&mut envelope, 41);
        assert_eq!(around(&envelope), [0.5; 3]);
    }
}

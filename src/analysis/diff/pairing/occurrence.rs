//! Partners of messages that record occurrences: events, impacts, nutation cycles.
//!
//! Partners are found by what the messages contain. Sequence numbers are the container's: other software may number
//! messages anew, and an extra message shifts all later numbers.

use crate::archive::memory::Owned;
use crate::run::simulation::EventKind;
use crate::telemetry::Topic;
use crate::telemetry::fields::{EVENTS, NUTATION, events, nutation};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// A message and its partner, as positions in the lists of A and B.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Occurrence {
    /// A message of both runs.
    Both(usize, usize),
    /// An unmatched message of A.
    OnlyA(usize),
    /// An unmatched message of B.
    OnlyB(usize),
}

/// Properties that two messages must share to be partners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum PartnerKey {
    /// The kind of event; `None` for names of other versions.
    Event(Option<&'static str>),
    /// The number of the nutation cycle, as bits.
    Cycle(u64),
    /// The topic alone.
    Topic,
}

/// Finds the partners of the messages of a topic, which are in the order of time. If messages may be missing
/// (`is_whole` is false), those of different times are partners only if their sequence numbers agree, too.
pub(super) fn match_occurrences(
    topic: Topic,
    a: &[Owned],
    b: &[Owned],
    is_whole: bool,
) -> Vec<Occurrence> {
    let mut matching = Matching {
        a,
        b,
        is_whole,
        found: Vec::new(),
    };
    // With cycles by number and others by topic, partners would be in different groups.
    let has_cycles = topic == NUTATION && a.iter().chain(b).all(has_cycle_number);
    let mut groups: BTreeMap<PartnerKey, [Vec<usize>; 2]> = BTreeMap::new();
    for (side, messages) in [a, b].into_iter().enumerate() {
        for (position, message) in messages.iter().enumerate() {
            let group = group(topic, has_cycles, message);
            groups.entry(group).or_default()[side].push(position);
        }
    }
    for [of_a, of_b] in groups.into_values() {
        matching.match_group(&of_a, &of_b);
    }
    matching.into_order_of_time()
}

/// Whether a nutation cycle has its number, which recordings of other versions may lack.
fn has_cycle_number(message: &Owned) -> bool {
    !nutation::CYCLE.of(&message.as_message()).is_nan()
}

fn group(topic: Topic, has_cycles: bool, message: &Owned) -> PartnerKey {
    if topic == EVENTS {
        let kind = EventKind::find(events::NAME.of(&message.as_message()));
        PartnerKey::Event(kind.map(EventKind::name))
    } else if has_cycles {
        PartnerKey::Cycle(nutation::CYCLE.of(&message.as_message()).to_bits())
    } else {
        PartnerKey::Topic
    }
}

/// The search for partners.
struct Matching<'m> {
    a: &'m [Owned],
    b: &'m [Owned],
    is_whole: bool,
    found: Vec<Occurrence>,
}

impl Matching<'_> {
    /// Matches the messages of a group: those of equal times first, then those between them.
    fn match_group(&mut self, a: &[usize], b: &[usize]) {
        let (mut next_a, mut next_b) = (0, 0);
        let (mut from_a, mut from_b) = (0, 0);
        while let (Some(&of_a), Some(&of_b)) = (a.get(next_a), b.get(next_b)) {
            match self.a[of_a].time_ns.cmp(&self.b[of_b].time_ns) {
                Ordering::Less => next_a += 1,
                Ordering::Greater => next_b += 1,
                Ordering::Equal => {
                    self.match_between(&a[from_a..next_a], &b[from_b..next_b]);
                    self.found.push(Occurrence::Both(of_a, of_b));
                    (next_a, next_b) = (next_a + 1, next_b + 1);
                    (from_a, from_b) = (next_a, next_b);
                }
            }
        }
        self.match_between(&a[from_a..], &b[from_b..]);
    }

    /// Matches messages of a group that have different times in both runs: one by one if both runs have as many,
    /// otherwise the nearest in time.
    fn match_between(&mut self, a: &[usize], b: &[usize]) {
        let (mut next_a, mut next_b) = (0, 0);
        while let (Some(&of_a), Some(&of_b)) = (a.get(next_a), b.get(next_b)) {
            // With losses, the nearest message may be that of another occurrence.
            let order = if !self.is_whole {
                self.a[of_a].sequence.cmp(&self.b[of_b].sequence)
            // The same events happen in both runs, at other times.
            } else if a.len() == b.len() {
                Ordering::Equal
            } else {
                self.nearer(of_a, of_b, a.get(next_a + 1), b.get(next_b + 1))
            };
            self.found.push(match order {
                Ordering::Less => Occurrence::OnlyA(of_a),
                Ordering::Greater => Occurrence::OnlyB(of_b),
                Ordering::Equal => Occurrence::Both(of_a, of_b),
            });
            next_a += usize::from(order != Ordering::Greater);
            next_b += usize::from(order != Ordering::Less);
        }
        self.found
            .extend(a[next_a..].iter().map(|&of_a| Occurrence::OnlyA(of_a)));
        self.found
            .extend(b[next_b..].iter().map(|&of_b| Occurrence::OnlyB(of_b)));
    }

    /// `Equal` if two messages are partners; `Less` or `Greater` if the earlier one, of A or of B, has none because the
    /// message that follows it in its run is nearer to the other.
    fn nearer(
        &self,
        of_a: usize,
        of_b: usize,
        after_a: Option<&usize>,
        after_b: Option<&usize>,
    ) -> Ordering {
        let (time_a, time_b) = (self.a[of_a].time_ns, self.b[of_b].time_ns);
        let distance = time_a.abs_diff(time_b);
        let (next, to, alone) = if time_a < time_b {
            (after_a.map(|&after| &self.a[after]), time_b, Ordering::Less)
        } else {
            (
                after_b.map(|&after| &self.b[after]),
                time_a,
                Ordering::Greater,
            )
        };
        match next {
            Some(next) if next.time_ns.abs_diff(to) < distance => alone,
            _ => Ordering::Equal,
        }
    }

    /// All messages in the order of time; a pair counts at its earlier time.
    fn into_order_of_time(mut self) -> Vec<Occurrence> {
        let (a, b) = (self.a, self.b);
        self.found.sort_by_key(|occurrence| match *occurrence {
            Occurrence::Both(of_a, of_b) => (a[of_a].time_ns.min(b[of_b].time_ns), of_a.min(of_b)),
            Occurrence::OnlyA(of_a) => (a[of_a].time_ns, of_a),
            Occurrence::OnlyB(of_b) => (b[of_b].time_ns, of_b),
        });
        self.found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::IMPACTS;

    /// Impacts at these times (ns), numbered from a first number on.
    fn impacts(times: &[u64], first: u32) -> Vec<Owned> {
        let impact = |(sequence, &time_ns)| Owned {
            channel: IMPACTS.index(),
            sequence,
            time_ns,
            numbers: Vec::new(),
            texts: Vec::new(),
        };
        (first..).zip(times).map(impact).collect()
    }

    /// A name, the times in A and B, and how they are paired.
    type Case = (
        &'static str,
        &'static [u64],
        &'static [u64],
        &'static [Occurrence],
    );

    #[test]
    fn matches_occurrences_by_time() {
        use Occurrence::{Both, OnlyA, OnlyB};
        let cases: [Case; 7] = [
            ("equal", &[1, 2], &[1, 2], &[Both(0, 0), Both(1, 1)]),
            ("shifted", &[10, 20], &[19, 29], &[Both(0, 0), Both(1, 1)]),
            (
                "one more in B",
                &[10, 20, 30],
                &[10, 12, 20, 30],
                &[Both(0, 0), OnlyB(1), Both(1, 2), Both(2, 3)],
            ),
            (
                "one more in A of slightly different times",
                &[10, 15, 20, 30],
                &[11, 21, 31],
                &[Both(0, 0), OnlyA(1), Both(2, 1), Both(3, 2)],
            ),
            (
                "one each between equal ones",
                &[10, 13, 20, 30],
                &[10, 20, 27, 30],
                &[Both(0, 0), OnlyA(1), Both(2, 1), OnlyB(2), Both(3, 3)],
            ),
            ("simultaneous", &[5, 5], &[5], &[Both(0, 0), OnlyA(1)]),
            ("none in A", &[], &[5], &[OnlyB(0)]),
        ];
        for (name, a, b, expected) in cases {
            let [a, b] = [impacts(a, 0), impacts(b, 7)];
            let found = match_occurrences(IMPACTS, &a, &b, true);
            assert_eq!(found, expected, "{name}");
        }
    }

    #[test]
    fn lossy_runs_match_by_sequence_number() {
        use Occurrence::{Both, OnlyA, OnlyB};
        // A lost its third impact, and B its fourth.
        let mut a = impacts(&[10, 20, 40, 50], 0);
        for later in &mut a[2..] {
            later.sequence += 1;
        }
        let mut b = impacts(&[10, 20, 30, 50], 0);
        b[3].sequence += 1;
        let found = match_occurrences(IMPACTS, &a, &b, false);
        let expected = [Both(0, 0), Both(1, 1), OnlyB(2), OnlyA(2), Both(3, 3)];
        assert_eq!(found, expected);
    }
}

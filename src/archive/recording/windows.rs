//! Windows of time in which sections that overlap are sorted.
//!
//! Sorting a file by time needs all messages of a time in memory. If its chunks overlap, e.g. because they are ordered by
//! topic, the whole file may be needed at once. Its messages are therefore sorted in windows of time, and each window
//! reads all sections that overlap it. A window is as long as its messages fit into memory, so the sections are read
//! as often as their messages are larger than a window: once, in most files.

use super::batch::LoadedMessages;
use std::vec;

/// The times of the first and last message of a section, ns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Span {
    pub(super) first: u64,
    pub(super) last: u64,
    /// Index of the section.
    pub(super) section: u32,
}

/// The sections of a file, and how far they have been read.
#[derive(Debug, Default)]
pub(super) struct Windows {
    /// By their first times.
    spans: Vec<Span>,
    /// Number of spans at the start that have been read completely.
    done: usize,
    /// Start of the next window, ns; `None` after the last possible time.
    from_ns: Option<u64>,
    /// A time whose messages are larger than a window.
    instant: Option<Instant>,
    /// Maximum size of a window's messages, bytes.
    max_size: usize,
}

/// A time whose messages don't fit into memory together. They are read section by section, in the order of the file.
#[derive(Debug)]
struct Instant {
    time_ns: u64,
    sections: vec::IntoIter<u32>,
}

/// A span of time, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    first: u64,
    last: u64,
}

impl Window {
    pub(super) fn includes(&self, time_ns: u64) -> bool {
        (self.first..=self.last).contains(&time_ns)
    }

    /// Ends earlier, and drops the messages after that. Returns false if the window is a single instant.
    fn shrink(&mut self, batch: &mut LoadedMessages) -> bool {
        // A selection, not a sort: it takes linear time, and a window may hold millions of messages.
        let mut times: Vec<u64> = batch.entries.iter().map(|entry| entry.time_ns).collect();
        // Three quarters stay, so that little is read twice.
        let cut = times.len() * 3 / 4;
        let (earlier, cut, _) = times.select_nth_unstable(cut);
        let earliest = earlier.iter().copied().min().unwrap_or(*cut);
        let last = if *cut > earliest { *cut - 1 } else { earliest };
        if last < self.last {
            self.last = last;
        } else if self.first < earliest {
            // Sections that are not loaded yet may have earlier messages.
            self.last = earliest - 1;
        } else {
            return false;
        }
        batch.drop_after(self.last);
        true
    }
}

impl Windows {
    pub(super) fn new(mut spans: Vec<Span>, max_size: usize) -> Self {
        spans.sort_unstable();
        Self {
            spans,
            done: 0,
            from_ns: Some(0),
            instant: None,
            max_size,
        }
    }

    /// Share of the sections that have been read completely.
    pub(super) fn progress(&self) -> f64 {
        self.done as f64 / self.spans.len().max(1) as f64
    }

    /// Loads the next messages into an empty batch, unsorted; `None` at the end. The batch may stay empty.
    ///
    /// `append` adds a section's messages of a window to the batch.
    pub(super) fn load_next(
        &mut self,
        batch: &mut LoadedMessages,
        append: &mut dyn FnMut(u32, Window, &mut LoadedMessages),
    ) -> Option<()> {
        if let Some(instant) = &mut self.instant {
            let window = Window {
                first: instant.time_ns,
                last: instant.time_ns,
            };
            match instant.sections.next() {
                Some(section) => append(section, window, batch),
                None => self.instant = None,
            }
            return Some(());
        }
        let first = self.from_ns?;
        if self.spans[self.done..].iter().all(|span| span.last < first) {
            return None;
        }
        let last = u64::MAX;
        let window = self.fill(Window { first, last }, batch, append);
        self.from_ns = window.last.checked_add(1);
        self.done += self.spans[self.done..]
            .iter()
            .take_while(|span| span.last <= window.last)
            .count();
        Some(())
    }

    /// Loads the messages of a window, which becomes shorter until they fit. Returns the window that was loaded.
    fn fill(
        &mut self,
        mut window: Window,
        batch: &mut LoadedMessages,
        append: &mut dyn FnMut(u32, Window, &mut LoadedMessages),
    ) -> Window {
        for span in &self.spans[self.done..] {
            if span.first > window.last {
                break;
            }
            if span.last < window.first {
                continue;
            }
            append(span.section, window, batch);
            while batch.records.len() > self.max_size {
                if !window.shrink(batch) {
                    self.instant = Some(self.instant_at(window.first));
                    batch.clear();
                    return window;
                }
            }
        }
        window
    }

    fn instant_at(&self, time_ns: u64) -> Instant {
        let mut sections: Vec<u32> = self.spans[self.done..]
            .iter()
            .filter(|span| (span.first..=span.last).contains(&time_ns))
            .map(|span| span.section)
            .collect();
        // The order of the file, which decides between messages of the same time.
        sections.sort_unstable();
        Instant {
            time_ns,
            sections: sections.into_iter(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::archive::recording::batch::BatchEntry;
    use mcap::records::op;
    use proptest::prelude::*;

    /// Log time and number of a message.
    type Numbered = (u64, u32);

    /// A message record of 31 bytes.
    fn record((time_ns, number): Numbered) -> Vec<u8> {
        let mut record = vec![op::MESSAGE];
        record.extend(22_u64.to_le_bytes());
        record.extend([0; 2]);
        record.extend(number.to_le_bytes());
        record.extend(time_ns.to_le_bytes());
        record.extend(time_ns.to_le_bytes());
        record
    }

    /// Numbers the messages of all sections in the order of the file.
    fn numbered(times: &[Vec<u64>]) -> Vec<Vec<Numbered>> {
        let mut number = 0;
        let mut count = |time: &u64| {
            number += 1;
            (*time, number)
        };
        times
            .iter()
            .map(|section| section.iter().map(&mut count).collect())
            .collect()
    }

    /// The messages as the windows return them, and the size of the largest batch.
    fn read(sections: &[Vec<Numbered>], max_size: usize) -> (Vec<Numbered>, usize) {
        let spans = (0..).zip(sections).filter_map(|(section, messages)| {
            let times = || messages.iter().map(|(time, _)| *time);
            Some(Span {
                first: times().min()?,
                last: times().max()?,
                section,
            })
        });
        let mut windows = Windows::new(spans.collect(), max_size);
        let (mut batch, mut found, mut largest) = (LoadedMessages::default(), Vec::new(), 0);
        loop {
            let loaded = windows.load_next(&mut batch, &mut |section, window, batch| {
                for message in &sections[section as usize] {
                    if window.includes(message.0) {
                        batch.entries.push(BatchEntry {
                            time_ns: message.0,
                            section,
                            start: batch.records.len() as u32,
                        });
                        batch.records.extend(record(*message));
                    }
                }
                largest = largest.max(batch.records.len());
            });
            if loaded.is_none() {
                return (found, largest);
            }
            batch.entries.sort();
            for entry in &batch.entries {
                let message = batch.message(entry).unwrap();
                found.push((message.log_time, message.sequence));
            }
            batch.clear();
        }
    }

    proptest! {
        #[test]
        fn windows_sort_any_sections_in_bounded_memory(
            times in prop::collection::vec(prop::collection::vec(0..30_u64, 0..12), 1..20),
            max_size in 31..1000_usize,
        ) {
            let sections = numbered(&times);
            let (found, largest) = read(&sections, max_size);
            let mut expected = sections.concat();
            // Messages of the same time keep the order of the file.
            expected.sort_by_key(|message| message.0);
            prop_assert_eq!(found, expected);
            let longest = sections.iter().map(Vec::len).max().unwrap_or(0) * 31;
            prop_assert!(largest <= max_size + longest, "{} bytes", largest);
        }
    }

    #[test]
    fn reads_the_last_possible_time() {
        let sections = vec![vec![(u64::MAX, 1), (0, 2)], vec![(u64::MAX, 3)]];
        let (found, _) = read(&sections, 31);
        assert_eq!(found, [(0, 2), (u64::MAX, 1), (u64::MAX, 3)]);
    }
}

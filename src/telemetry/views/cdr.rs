//! Serialization of ROS 2 messages: CDR version 1, little-endian (OMG DDSI-RTPS 2.3, section 10).
//!
//! Values are aligned to their size, counted from the end of the four bytes of the header.

use crate::run::time::seconds_and_nanoseconds;

/// The representation identifier `CDR_LE`, and two bytes of options, which are not used.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// A buffer for one message at a time.
#[derive(Clone, Debug, Default)]
pub(super) struct Cdr(Vec<u8>);

impl Cdr {
    /// Begins a message.
    pub(super) fn begin(&mut self) -> &mut Self {
        self.0.clear();
        self.0.extend_from_slice(&HEADER);
        self
    }

    /// The message.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    fn align(&mut self, size: usize) {
        while !(self.0.len() - HEADER.len()).is_multiple_of(size) {
            self.0.push(0);
        }
    }

    pub(super) fn u8(&mut self, value: u8) -> &mut Self {
        self.0.push(value);
        self
    }

    pub(super) fn u32(&mut self, value: u32) -> &mut Self {
        self.align(4);
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    /// Numbers without a length, as in a struct or a fixed-length array.
    pub(super) fn f64s(&mut self, values: &[f64]) -> &mut Self {
        for value in values {
            self.align(8);
            self.0.extend_from_slice(&value.to_le_bytes());
        }
        self
    }

    /// Single-precision numbers without a length.
    pub(super) fn f32s(&mut self, values: &[f32]) -> &mut Self {
        for value in values {
            self.u32(value.to_bits());
        }
        self
    }

    /// A sequence of numbers, with its length.
    pub(super) fn sequence(&mut self, values: &[f64]) -> &mut Self {
        self.u32(values.len() as u32).f64s(values)
    }

    /// A text; its length counts the zero byte at its end.
    pub(super) fn string(&mut self, text: &str) -> &mut Self {
        self.u32(text.len() as u32 + 1);
        self.0.extend_from_slice(text.as_bytes());
        self.u8(0)
    }

    /// A `builtin_interfaces/Time`.
    pub(super) fn time(&mut self, time_ns: u64) -> &mut Self {
        let (seconds, nanoseconds) = seconds_and_nanoseconds(time_ns);
        self.u32(seconds as u32).u32(nanoseconds as u32)
    }

    /// A `std_msgs/Header`.
    pub(super) fn header(&mut self, time_ns: u64, frame: &str) -> &mut Self {
        self.time(time_ns).string(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(hex: &str) -> Vec<u8> {
        let digits: Vec<u8> = hex.bytes().filter(|b| *b != b' ').collect();
        let pairs = digits
            .chunks(2)
            .map(|pair| std::str::from_utf8(pair).unwrap());
        pairs
            .map(|pair| u8::from_str_radix(pair, 16).unwrap())
            .collect()
    }

    /// Messages written in Python, which @foxglove/rosmsg2-serialization and Rerun read as these.
    #[test]
    fn val_messages_are_those_of_ros() {
        let mut cdr = Cdr::default();
        cdr.begin().u32(0).u32(0).sequence(&[0.5]);
        let array = "00010000 00000000 00000000 01000000 00000000 00000000 0000e03f";
        assert_eq!(cdr.bytes(), bytes(array));
        cdr.begin().header(0, "").u32(1).string("psi");
        let effort = f64::from_le_bytes([0x5f, 0x77, 0x1d, 0x42, 0xea, 0x7a, 0x1c, 0xbf]);
        cdr.sequence(&[0.0]).sequence(&[170.0]).sequence(&[effort]);
        let joint = "00010000 00000000 00000000 01000000 00000000 01000000 04000000 70736900 \
                     01000000 00000000 00000000 01000000 00000000 00000000 00406540 01000000 \
                     00000000 5f771d42 ea7a1cbf";
        let joint = bytes(joint);
        assert_eq!(cdr.bytes(), joint);
    }
}

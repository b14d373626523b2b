//! What stands in the fields of messages.

use std::fmt;

/// The value of a field in a message.
///
/// Integers keep all their digits, whatever they are compared with.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Value {
    /// Nothing: the message doesn't have the field.
    #[default]
    Absent,
    /// A floating-point number.
    Real(f64),
    /// An integer, or the number of an enum.
    Integer(i64),
    /// An integer beyond those of 64 bits with a sign.
    Large(u64),
    /// True or false.
    Bool(bool),
    /// A text.
    Text(Box<str>),
    /// Bytes that mean nothing here.
    Bytes(Box<[u8]>),
    /// JSON's `null`.
    Null,
    /// A list or a message with nothing in it.
    Empty,
    /// A JSON object with nothing in it.
    EmptyObject,
}

/// Bytes that are shown of a value that is longer.
const SHOWN: usize = 24;

impl Value {
    /// An integer of up to 64 bits.
    pub(super) fn integer(integer: i128) -> Self {
        match (i64::try_from(integer), u64::try_from(integer)) {
            (Ok(small), _) => Self::Integer(small),
            (_, Ok(large)) => Self::Large(large),
            _ => Self::Real(integer as f64),
        }
    }

    /// The nearest double of a number; booleans count as 0 and 1. NaN for what is none.
    #[must_use]
    pub fn number(&self) -> f64 {
        match self {
            Self::Real(number) => *number,
            Self::Integer(integer) => *integer as f64,
            Self::Large(integer) => *integer as f64,
            Self::Bool(is_true) => f64::from(u8::from(*is_true)),
            Self::Absent
            | Self::Text(_)
            | Self::Bytes(_)
            | Self::Null
            | Self::Empty
            | Self::EmptyObject => f64::NAN,
        }
    }

    /// The integer that it is, if it is one.
    #[must_use]
    pub fn as_integer(&self) -> Option<i128> {
        match self {
            Self::Integer(integer) => Some((*integer).into()),
            Self::Large(integer) => Some((*integer).into()),
            _ => None,
        }
    }

    /// Whether it is an integer or a floating-point number.
    #[must_use]
    pub fn is_number(&self) -> bool {
        matches!(self, Self::Real(_) | Self::Integer(_) | Self::Large(_))
    }

    /// Whether the message doesn't have the field.
    #[must_use]
    pub fn is_absent(&self) -> bool {
        matches!(self, Self::Absent)
    }

    /// How much memory it takes beside itself, bytes.
    #[must_use]
    pub fn memory(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::Bytes(bytes) => bytes.len(),
            _ => 0,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absent => f.write_str("nothing"),
            Self::Real(number) => write!(f, "{number}"),
            Self::Integer(integer) => write!(f, "{integer}"),
            Self::Large(integer) => write!(f, "{integer}"),
            Self::Bool(is_true) => write!(f, "{is_true}"),
            Self::Text(text) => f.write_str(text),
            Self::Bytes(bytes) => {
                let shown = bytes.iter().take(SHOWN);
                shown
                    .map(|byte| format!("{byte:02x}"))
                    .try_for_each(|byte| f.write_str(&byte))?;
                match bytes.len().saturating_sub(SHOWN) {
                    0 => Ok(()),
                    more => write!(f, "… and {more} bytes more"),
                }
            }
            Self::Null => f.write_str("null"),
            Self::Empty => f.write_str("an empty list or message"),
            Self::EmptyObject => f.write_str("an empty object"),
        }
    }
}

//! The protobuf wire format: decoding of fields.

use super::decoding::WireError;
use prost::encoding::{DecodeContext, WireType, decode_key, decode_varint, skip_field};

/// Content of a field, by its wire type.
#[derive(Clone, Copy, Debug)]
pub(super) enum Wire<'a> {
    Varint(u64),
    Eight(u64),
    Four,
    Bytes(&'a [u8]),
    Group,
    /// The end of a group.
    End,
}

/// Removes the first field. Returns its number and content.
#[inline]
pub(super) fn take_field<'a>(data: &mut &'a [u8]) -> Result<(u32, Wire<'a>), WireError> {
    let (number, wire) = match **data {
        // Most field numbers are below 16, and their keys one byte. A key below 8 has the field number 0, which
        // `decode_key` rejects.
        [key @ 8..0x80, ..] => {
            *data = &data[1..];
            (u32::from(key >> 3), WireType::try_from(u64::from(key & 7))?)
        }
        _ => decode_key(data)?,
    };
    let wire = match wire {
        WireType::Varint => Wire::Varint(decode_varint(data)?),
        WireType::SixtyFourBit => Wire::Eight(u64::from_le_bytes(take_array(data)?)),
        WireType::ThirtyTwoBit => {
            // No field of the table has this type, so its value is not needed.
            take_array::<4>(data)?;
            Wire::Four
        }
        WireType::LengthDelimited => {
            let length = usize::try_from(decode_varint(data)?).unwrap_or(usize::MAX);
            let (bytes, rest) = data.split_at_checked(length).ok_or(WireError::Truncated)?;
            *data = rest;
            Wire::Bytes(bytes)
        }
        WireType::StartGroup => {
            skip_field(wire, number, data, DecodeContext::default())?;
            Wire::Group
        }
        WireType::EndGroup => Wire::End,
    };
    Ok((number, wire))
}

#[inline]
fn take_array<const N: usize>(data: &mut &[u8]) -> Result<[u8; N], WireError> {
    let (array, rest) = data.split_first_chunk().ok_or(WireError::Truncated)?;
    *data = rest;
    Ok(*array)
}

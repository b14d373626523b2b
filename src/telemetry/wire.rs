//! The protobuf wire format: decoding of fields.

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
pub(super) fn take_field<'a>(data: &mut &'a [u8]) -> Result<(u32, Wire<'a>), String> {
    let (number, wire) = match **data {
        // Most field numbers are small.
        [key @ 8..0x80, ..] => {
            *data = &data[1..];
            let wire = WireType::try_from(u64::from(key & 7));
            (
                u32::from(key >> 3),
                wire.map_err(|error| error.to_string())?,
            )
        }
        _ => decode_key(data).map_err(|error| error.to_string())?,
    };
    let wire = match wire {
        WireType::Varint => Wire::Varint(varint(data)?),
        WireType::SixtyFourBit => Wire::Eight(u64::from_le_bytes(take_array(data)?)),
        WireType::ThirtyTwoBit => {
            take_array::<4>(data)?;
            Wire::Four
        }
        WireType::LengthDelimited => {
            let length = varint(data)?;
            let length = usize::try_from(length).map_err(|error| error.to_string())?;
            let (bytes, rest) = data.split_at_checked(length).ok_or(CUT)?;
            *data = rest;
            Wire::Bytes(bytes)
        }
        WireType::StartGroup => {
            skip_field(wire, number, data, DecodeContext::default())
                .map_err(|error| error.to_string())?;
            Wire::Group
        }
        WireType::EndGroup => Wire::End,
    };
    Ok((number, wire))
}

#[inline]
fn varint(data: &mut &[u8]) -> Result<u64, String> {
    decode_varint(data).map_err(|error| error.to_string())
}

const CUT: &str = "it ends within a field";

#[inline]
fn take_array<const N: usize>(data: &mut &[u8]) -> Result<[u8; N], String> {
    let (array, rest) = data.split_first_chunk().ok_or(CUT)?;
    *data = rest;
    Ok(*array)
}

//! The fields in messages of channels that aren't ours.

use proptest::prelude::*;
use prost::Message as _;
use prost::encoding::{WireType, encode_key, encode_varint};
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet, MessageOptions,
};
use serde_json::{Map, Value as Json};
use std::collections::BTreeMap;
use std::path::Path;
use toprise::archive::recording::{Condition, Recording, Selection};
use toprise::telemetry::Topics;
use toprise::telemetry::payload::{MAX_FIELDS, PayloadDecoder, PayloadError, Schema, Value};

fn json() -> PayloadDecoder {
    PayloadDecoder::new("json", None).unwrap()
}

/// Decodes a message into its fields and values.
#[track_caller]
fn values(decoder: &mut PayloadDecoder, data: impl AsRef<[u8]>) -> Vec<(String, Value)> {
    let mut values = Vec::new();
    decoder.decode(data.as_ref(), &mut values).unwrap();
    assert_eq!(values.len(), decoder.fields().len());
    decoder.fields().iter().cloned().zip(values).collect()
}

/// Decodes a message into fields and numbers; what is no number is written as none.
#[track_caller]
fn decode(decoder: &mut PayloadDecoder, data: impl AsRef<[u8]>) -> Vec<(String, Option<f64>)> {
    let values = values(decoder, data).into_iter();
    let number = |value: Value| Some(value.number()).filter(|number| !number.is_nan());
    values.map(|(path, value)| (path, number(value))).collect()
}

#[track_caller]
fn assert_fields(found: &[(String, Option<f64>)], expected: &[(&str, Option<f64>)]) {
    let found: Vec<_> = found.iter().map(|(path, v)| (path.as_str(), *v)).collect();
    assert_eq!(found, expected);
}

fn reason(decoder: &mut PayloadDecoder, data: impl AsRef<[u8]>) -> String {
    let error = decoder.decode(data.as_ref(), &mut Vec::new()).unwrap_err();
    error.to_string()
}

#[test]
fn json_is_flattened() {
    let text = r#"{"pose":{"position":{"x":1,"y":-2.5e-3}},"ok":true,"off":false,"name":"a",
        "ranges":[1,[2,3],{"min":4}],"empty":{},"none":[],"é\n.":5}"#;
    let found = decode(&mut json(), text);
    assert_fields(
        &found,
        &[
            ("pose.position.x", Some(1.0)),
            ("pose.position.y", Some(-2.5e-3)),
            ("ok", Some(1.0)),
            ("off", Some(0.0)),
            ("name", None),
            ("ranges.0", Some(1.0)),
            ("ranges.1.0", Some(2.0)),
            ("ranges.1.1", Some(3.0)),
            ("ranges.2.min", Some(4.0)),
            ("empty", None),
            ("none", None),
            ("é\n\\.", Some(5.0)),
        ],
    );
}

#[test]
fn a_json_message_need_not_be_an_object() {
    assert_fields(&decode(&mut json(), "7"), &[("", Some(7.0))]);
    assert_fields(&decode(&mut json(), "[7]"), &[("0", Some(7.0))]);
    let text = values(&mut json(), "\"text\"");
    assert_eq!(text, [(String::new(), Value::Text("text".into()))]);
    assert_eq!(values(&mut json(), "null")[0].1, Value::Null);
}

#[test]
fn fields_grow_and_stay() {
    let mut decoder = json();
    assert!(decoder.fields().is_empty());
    let found = decode(&mut decoder, r#"{"a":1,"l":["x",2]}"#);
    let expected = [("a", Some(1.0)), ("l.0", None), ("l.1", Some(2.0))];
    assert_fields(&found, &expected);
    let found = decode(&mut decoder, r#"{"l":[3],"b":{"c":4}}"#);
    let expected = [
        ("a", None),
        ("l.0", Some(3.0)),
        ("l.1", None),
        ("b.c", Some(4.0)),
    ];
    assert_fields(&found, &expected);
    // What was a number may be an object, and the other way round.
    let found = decode(&mut decoder, r#"{"b":5,"a":{"b":6},"l":[7,8]}"#);
    let expected = [
        ("a", None),
        ("l.0", Some(7.0)),
        ("l.1", Some(8.0)),
        ("b.c", None),
        ("b", Some(5.0)),
        ("a.b", Some(6.0)),
    ];
    assert_fields(&found, &expected);
}

#[test]
fn null_is_not_a_number() {
    let mut decoder = json();
    assert_fields(&decode(&mut decoder, r#"{"a":null}"#), &[("a", None)]);
    assert_fields(&decode(&mut decoder, r#"{"a":1}"#), &[("a", Some(1.0))]);
    assert_fields(&decode(&mut decoder, r#"{"a":null}"#), &[("a", None)]);
    assert_fields(&decode(&mut decoder, r#"{"a":"1"}"#), &[("a", None)]);
    // The empty object is a field of its own.
    let found = values(&mut decoder, "{}");
    assert_eq!(found[0], ("a".to_owned(), Value::Absent));
    assert_eq!(found[1], (String::new(), Value::EmptyObject));
}

#[test]
fn of_members_with_the_same_name_the_last_counts() {
    let mut decoder = json();
    let there = |found: Vec<(String, Option<f64>)>| -> Vec<_> {
        let there = found.into_iter().filter(|(_, number)| number.is_some());
        there.collect()
    };
    for _ in 0..2 {
        let data = r#"{"a":{"b":1,"c":2,"c":3},"a":{"b":4},"d":[5],"d":6}"#;
        let found = decode(&mut decoder, data);
        assert_fields(&there(found), &[("a.b", Some(4.0)), ("d", Some(6.0))]);
        // What counts for nothing is not forgotten.
        assert_eq!(decoder.unsaid(data.as_bytes()), Some(data.as_bytes()));
        let found = decode(&mut decoder, r#"{"a":{"b":1},"a":null,"d":7,"d":"x"}"#);
        assert_fields(&there(found), &[]);
    }
    decode(&mut decoder, r#"{"a":1}"#);
    assert_eq!(decoder.unsaid(b""), None);
    // No two ways lead to one path.
    let found = decode(&mut json(), r#"{"a.b":1,"a":{"b":2,"0":3,"":4},"l":[5]}"#);
    let expected = [
        ("a\\.b", Some(1.0)),
        ("a.b", Some(2.0)),
        ("a.\\0", Some(3.0)),
        ("a.\"\"", Some(4.0)),
        ("l.0", Some(5.0)),
    ];
    assert_fields(&found, &expected);
}

#[test]
fn integers_keep_their_digits() {
    let text = r"[9007199254740993,18446744073709551615,-9223372036854775808,1e300,100000000000000000000,-0]";
    let mut values = Vec::new();
    json().decode(text.as_bytes(), &mut values).unwrap();
    let expected = [
        Value::Integer(9007199254740993),
        Value::Large(u64::MAX),
        Value::Integer(i64::MIN),
        Value::Real(1e300),
        // No 64 bits hold it.
        Value::Real(1e20),
        Value::Real(-0.0),
    ];
    assert_eq!(values, expected);
    assert!(values[5].number().is_sign_negative());
}

#[test]
fn what_python_writes_for_numbers_that_json_lacks_is_read() {
    let text = r#"{"a":NaN,"b":[Infinity,-Infinity,1],"c":"NaN \" NaN","d":2}"#;
    let found = decode(&mut json(), text);
    assert_fields(
        &found,
        &[
            ("a", None),
            ("b.0", Some(f64::INFINITY)),
            ("b.1", Some(f64::NEG_INFINITY)),
            ("b.2", Some(1.0)),
            ("c", None),
            ("d", Some(2.0)),
        ],
    );
    // The largest double stays what it is beside them, and a null too.
    let text = r#"[NaN,1.7976931348623157e308,-1.7976931348623157e308,null,Infinity,"null"]"#;
    let found: Vec<Value> = values(&mut json(), text)
        .into_iter()
        .map(|(_, v)| v)
        .collect();
    assert!(found[0].number().is_nan() && found[0].is_number());
    let others = [
        Value::Real(f64::MAX),
        Value::Real(f64::MIN),
        Value::Null,
        Value::Real(f64::INFINITY),
        Value::Text("null".into()),
    ];
    assert_eq!(found[1..], others);
    // A message without them is read as it is, and one with a fault stays faulty.
    assert!(reason(&mut json(), "{\"a\":NaN").contains("EOF"));
}

#[test]
fn broken_json_is_an_error() {
    let mut decoder = json();
    for text in [
        "",
        "{",
        "{\"a\":}",
        "[1e999]",
        "[NaNa]",
        "[-]",
        "{} {}",
        "[1,]",
        "\"\\ud800\"",
        "\u{feff}{}",
        "{1:2}",
    ] {
        let reason = reason(&mut decoder, text);
        assert!(
            reason.starts_with("not a json message: "),
            "{text}: {reason}"
        );
    }
    reason(&mut decoder, b"\"\xff\"");
    let deep = "[".repeat(100_000);
    assert!(reason(&mut decoder, deep).contains("recursion limit"));
    // It is about one message; what was read before the fault stays a field.
    let found = decode(&mut decoder, r#"{"a":1}"#);
    let expected = [("0", None), ("", None), ("a", Some(1.0))];
    assert_fields(&found, &expected);
}

#[test]
fn fields_are_not_without_end() {
    let mut decoder = json();
    let mut values = Vec::new();
    let long = format!("[{}0]", "0,".repeat(99_999));
    decoder.decode(long.as_bytes(), &mut values).unwrap();
    assert_eq!(decoder.fields().len(), MAX_FIELDS);
    assert_eq!(decoder.left_out(), 100_000 - MAX_FIELDS as u64);
    // Those that are known are still read, and others are not.
    decoder.decode(br#"[1,2,{"a":3}]"#, &mut values).unwrap();
    assert_eq!(values[..2], [Value::Integer(1), Value::Integer(2)]);
    assert!(values[2..].iter().all(Value::is_absent));
    assert_eq!(decoder.left_out(), 100_000 - MAX_FIELDS as u64);
    // One path that is too long ends it, too.
    let mut decoder = json();
    let long = format!(r#"{{"a":1,"{}":2,"b":3}}"#, "x".repeat(1 << 20));
    assert_fields(&decode(&mut decoder, &long), &[("a", Some(1.0))]);
    assert_eq!(decoder.left_out(), 2);
    // So do many that are deep: each part of a path takes memory.
    let mut decoder = json();
    let deep = format!("{}1{}", "[".repeat(120), "]".repeat(120));
    let wide = format!("[{}]", vec![deep; 1000].join(","));
    decoder.decode(wide.as_bytes(), &mut values).unwrap();
    assert!(decoder.fields().len() > 100 && decoder.left_out() > 100);
    assert_eq!(decoder.fields().len() as u64 + decoder.left_out(), 1000);
}

/// Megabytes that say nothing are read a few times, not for each message.
#[test]
fn a_channel_with_endless_fields_is_given_up() {
    let mut decoder = json();
    let mut values = Vec::new();
    let long = format!("[{}0]", "0,".repeat(1 << 21));
    let mut decodes = |text: &str| decoder.decode(text.as_bytes(), &mut values).is_ok();
    let decoded: Vec<bool> = (0..4).map(|_| decodes(&long)).collect();
    assert_eq!(decoded, [true, true, false, false]);
    // What fits into its fields still is read.
    assert!(decodes("[1,2,3]"));
}

/// Objects and lists of numbers, nulls and texts.
fn nested() -> impl Strategy<Value = Json> {
    let leaf = prop_oneof![
        8 => (-1e9..1e9f64).prop_map(Json::from),
        2 => any::<i64>().prop_map(Json::from),
        1 => any::<bool>().prop_map(Json::from),
        1 => Just(Json::Null),
        1 => "[a-z\"\\\\é]{0,4}".prop_map(Json::from),
    ];
    leaf.prop_recursive(5, 60, 6, |inner| {
        let key = "[a-z\"\\\\é]{0,3}";
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..6).prop_map(Json::from),
            prop::collection::vec((key, inner), 0..6)
                .prop_map(|members| Json::Object(members.into_iter().collect::<Map<_, _>>())),
        ]
    })
}

fn flatten(value: &Json, path: &str, numbers: &mut BTreeMap<String, f64>) {
    let join = |name: &str| match path {
        "" => name.to_owned(),
        path => format!("{path}.{name}"),
    };
    match value {
        Json::Object(members) => {
            for (name, member) in members {
                let escaped = name.replace('\\', "\\\\").replace('"', "\\\"");
                let name = if name.is_empty() { "\"\"" } else { &escaped };
                flatten(member, &join(name), numbers);
            }
        }
        Json::Array(elements) => {
            for (position, element) in elements.iter().enumerate() {
                flatten(element, &join(&position.to_string()), numbers);
            }
        }
        Json::Number(number) => {
            numbers.insert(path.to_owned(), number.as_f64().unwrap());
        }
        Json::Bool(value) => {
            numbers.insert(path.to_owned(), f64::from(u8::from(*value)));
        }
        Json::Null | Json::String(_) => {}
    }
}

proptest! {
    #[test]
    fn json_gives_back_its_numbers(messages in prop::collection::vec(nested(), 1..6)) {
        let mut decoder = json();
        for message in messages {
            // A message that is no object has a path without a name.
            let message = Json::Object([("m".to_owned(), message)].into_iter().collect());
            let mut expected = BTreeMap::new();
            flatten(&message, "", &mut expected);
            let found = decode(&mut decoder, message.to_string());
            let found: BTreeMap<_, _> = found.into_iter().filter_map(|(k, v)| Some((k, v?))).collect();
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn no_bytes_make_it_panic(
        schema in prop::collection::vec(any::<u8>(), 0..40),
        data in prop::collection::vec(any::<u8>(), 0..60),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
    ) {
        let _ = json().decode(&data, &mut Vec::new());
        let _ = protobuf_channel("M", schema);
        let mut schema = shapes().encode_to_vec();
        if let Ok(mut decoder) = protobuf_channel("t.Shapes", schema.clone()) {
            let _ = decoder.decode(&data, &mut Vec::new());
        }
        for (at, byte) in flips {
            *at.get_mut(&mut schema) = byte;
        }
        if let Ok(mut decoder) = protobuf_channel("t.Shapes", schema) {
            let mut values = Vec::new();
            for message in [&data[..], &message()] {
                if decoder.decode(message, &mut values).is_ok() {
                    assert_eq!(values.len(), decoder.fields().len());
                }
            }
        }
    }
}

#[test]
fn other_encodings_are_named() {
    for encoding in ["ros1", "cbor", ""] {
        let error = PayloadDecoder::new(encoding, None).unwrap_err();
        assert_eq!(error, PayloadError::Encoding(encoding.to_owned()));
        assert!(
            error.to_string().contains("json, protobuf and cdr"),
            "{error}"
        );
    }
}

fn protobuf_channel(name: &str, data: Vec<u8>) -> Result<PayloadDecoder, PayloadError> {
    let schema = Schema {
        name,
        encoding: "protobuf",
        data: &data,
    };
    PayloadDecoder::new("protobuf", Some(schema))
}

fn field(name: &str, number: i32, kind: Type) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        label: Some(Label::Optional.into()),
        r#type: Some(kind.into()),
        ..FieldDescriptorProto::default()
    }
}

fn of(type_name: &str, field: FieldDescriptorProto) -> FieldDescriptorProto {
    FieldDescriptorProto {
        type_name: Some(type_name.to_owned()),
        ..field
    }
}

fn repeated(field: FieldDescriptorProto) -> FieldDescriptorProto {
    FieldDescriptorProto {
        label: Some(Label::Repeated.into()),
        ..field
    }
}

fn optional(field: FieldDescriptorProto) -> FieldDescriptorProto {
    FieldDescriptorProto {
        proto3_optional: Some(true),
        oneof_index: Some(0),
        ..field
    }
}

fn message_type(name: &str, field: Vec<FieldDescriptorProto>) -> DescriptorProto {
    DescriptorProto {
        name: Some(name.to_owned()),
        field,
        ..DescriptorProto::default()
    }
}

fn map_entry(name: &str, key: Type, value: FieldDescriptorProto) -> DescriptorProto {
    DescriptorProto {
        options: Some(MessageOptions {
            map_entry: Some(true),
            ..MessageOptions::default()
        }),
        ..message_type(name, vec![field("key", 1, key), value])
    }
}

fn set(syntax: &str, message_type: Vec<DescriptorProto>) -> FileDescriptorSet {
    FileDescriptorSet {
        file: vec![FileDescriptorProto {
            name: Some("t.proto".to_owned()),
            package: Some("t".to_owned()),
            message_type,
            syntax: Some(syntax.to_owned()),
            ..FileDescriptorProto::default()
        }],
    }
}

/// A message type with all that there is.
fn shapes() -> FileDescriptorSet {
    let mut shapes = message_type(
        "Shapes",
        vec![
            field("d", 1, Type::Double),
            field("text", 2, Type::String),
            of(".t.Shapes.Point", field("point", 3, Type::Message)),
            repeated(field("list", 4, Type::Sint32)),
            optional(field("maybe", 5, Type::Float)),
            repeated(of(".t.Shapes.Point", field("points", 6, Type::Message))),
            repeated(of(".t.Shapes.ByName", field("by_name", 7, Type::Message))),
            repeated(of(".t.Shapes.ById", field("by_id", 8, Type::Message))),
            of(".t.Shapes", field("inner", 9, Type::Message)),
            of(".t.Color", field("color", 10, Type::Enum)),
            repeated(field("fixed", 11, Type::Fixed64)),
        ],
    );
    shapes.nested_type = vec![
        message_type(
            "Point",
            vec![field("x", 1, Type::Int64), field("ok", 2, Type::Bool)],
        ),
        map_entry("ByName", Type::String, field("value", 2, Type::Uint32)),
        map_entry(
            "ById",
            Type::Int32,
            of(".t.Shapes.Point", field("value", 2, Type::Message)),
        ),
    ];
    set("proto3", vec![shapes])
}

fn shapes_decoder() -> PayloadDecoder {
    protobuf_channel("t.Shapes", shapes().encode_to_vec()).unwrap()
}

fn varint(number: u32, value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_key(number, WireType::Varint, &mut bytes);
    encode_varint(value, &mut bytes);
    bytes
}

fn double(number: u32, value: f64) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_key(number, WireType::SixtyFourBit, &mut bytes);
    bytes.extend(value.to_le_bytes());
    bytes
}

fn delimited(number: u32, inner: impl AsRef<[u8]>) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_key(number, WireType::LengthDelimited, &mut bytes);
    encode_varint(inner.as_ref().len() as u64, &mut bytes);
    bytes.extend(inner.as_ref());
    bytes
}

fn message() -> Vec<u8> {
    [
        double(1, 0.5),
        delimited(2, "text"),
        delimited(3, [varint(1, u64::MAX), varint(2, 1)].concat()),
        delimited(4, [1, 2, 3]),
        varint(4, 4),
        delimited(6, varint(1, 7)),
        delimited(6, []),
        delimited(7, [delimited(1, "a"), varint(2, 8)].concat()),
        delimited(7, []),
        delimited(
            8,
            [varint(1, u64::MAX), delimited(2, varint(1, 9))].concat(),
        ),
        delimited(9, double(1, 10.0)),
        varint(10, 3),
        delimited(11, 11u64.to_le_bytes()),
        // Not in the schema.
        varint(99, 1),
    ]
    .concat()
}

#[test]
fn a_field_that_comes_twice_is_not_forgotten() {
    let mut decoder = shapes_decoder();
    let inner = |value| delimited(3, varint(1, value));
    for twice in [
        [double(1, 0.5), double(1, 1.5)].concat(),
        [inner(1), inner(2)].concat(),
        delimited(7, [varint(2, 1), varint(2, 2)].concat()),
    ] {
        decode(&mut decoder, &twice);
        assert_eq!(decoder.unsaid(&twice), Some(&twice[..]));
    }
    // Parts of one message, and elements of a list, say nothing twice.
    let parts = [
        delimited(3, varint(1, 1)),
        delimited(3, varint(2, 1)),
        delimited(4, [1, 2]),
        varint(4, 4),
    ];
    let parts = parts.concat();
    decode(&mut decoder, &parts);
    assert_eq!(decoder.unsaid(&parts), None);
}

#[test]
fn protobuf_is_flattened() {
    let mut decoder = shapes_decoder();
    let foreseen = ["d", "text", "point.x", "point.ok", "maybe", "color"];
    assert_eq!(decoder.fields(), foreseen);
    let found = decode(&mut decoder, message());
    let expected = [
        ("d", Some(0.5)),
        ("text", None),
        ("point.x", Some(-1.0)),
        ("point.ok", Some(1.0)),
        ("maybe", None),
        ("color", Some(3.0)),
        ("list.0", Some(-1.0)),
        ("list.1", Some(1.0)),
        ("list.2", Some(-2.0)),
        ("list.3", Some(2.0)),
        ("points.0.x", Some(7.0)),
        ("points.0.ok", Some(0.0)),
        ("points.1.x", Some(0.0)),
        ("points.1.ok", Some(0.0)),
        ("by_name.a", Some(8.0)),
        ("by_name.\"\"", Some(0.0)),
        ("by_id.-1.x", Some(9.0)),
        ("by_id.-1.ok", Some(0.0)),
        ("inner.d", Some(10.0)),
        ("inner.text", None),
        ("inner.color", Some(0.0)),
        ("fixed.0", Some(11.0)),
    ];
    assert_fields(&found, &expected);
    // The field that the schema doesn't know.
    assert_eq!(decoder.unsaid(&message()), Some(&varint(99, 1)[..]));
    assert_eq!(decode(&mut decoder, message()), found);
    let others = decode(&mut decoder, []).into_iter();
    let zeros: Vec<_> = others.filter(|(_, value)| value.is_some()).collect();
    assert_fields(&zeros, &[("d", Some(0.0)), ("color", Some(0.0))]);
    assert_eq!(decoder.left_out(), 0);
}

#[test]
fn pieces_of_a_protobuf_message_are_put_together() {
    let data = [
        delimited(3, varint(1, 1)),
        delimited(4, [2]),
        delimited(7, [delimited(1, "a"), varint(2, 8)].concat()),
        delimited(3, varint(2, 1)),
        delimited(4, [4]),
        delimited(7, [varint(2, 9), delimited(1, "a")].concat()),
        varint(10, 1),
        varint(10, 2),
    ];
    let mut decoder = shapes_decoder();
    for _ in 0..2 {
        let found = decode(&mut decoder, data.concat()).into_iter();
        let there: Vec<_> = found.filter(|(_, value)| value.is_some()).collect();
        let expected = [
            ("d", Some(0.0)),
            ("point.x", Some(1.0)),
            ("point.ok", Some(1.0)),
            ("color", Some(2.0)),
            ("list.0", Some(1.0)),
            ("by_name.a", Some(9.0)),
            ("list.1", Some(2.0)),
        ];
        assert_fields(&there, &expected);
    }
}

#[test]
fn of_map_entries_with_the_same_key_the_last_counts() {
    let entry = |value: Vec<u8>| delimited(8, [varint(1, 1), delimited(2, value)].concat());
    let data = [entry(varint(1, 5)), entry(varint(2, 1))].concat();
    let mut decoder = shapes_decoder();
    for _ in 0..2 {
        let found = decode(&mut decoder, &data);
        let expected = [("by_id.1.x", Some(0.0)), ("by_id.1.ok", Some(1.0))];
        assert_fields(&found[6..], &expected);
    }
}

#[test]
fn what_proto2_does_not_set_is_not_a_number() {
    let mut outer = message_type(
        "M",
        vec![
            field("a", 1, Type::Int32),
            of(".t.M.G", field("g", 2, Type::Group)),
        ],
    );
    outer.nested_type = vec![message_type("G", vec![field("b", 2, Type::Fixed32)])];
    let mut decoder = protobuf_channel("t.M", set("proto2", vec![outer]).encode_to_vec()).unwrap();
    let found = decode(&mut decoder, []);
    assert_fields(&found, &[("a", None), ("g.b", None)]);
    // A group: 2 << 3 | 3, its field, 2 << 3 | 4.
    let group = [&[0x13, 0x15, 7, 0, 0, 0, 0x14][..], &varint(1, 1)].concat();
    let found = decode(&mut decoder, group);
    assert_fields(&found, &[("a", Some(1.0)), ("g.b", Some(7.0))]);
    let stray = [&varint(1, 1)[..], &[0x14]].concat();
    assert!(reason(&mut decoder, stray).contains("a group 2 ends that has not begun"));
}

#[test]
fn integers_are_read_as_their_types_say() {
    let kinds = [
        (Type::Int32, -5.0),
        (Type::Int64, -5.0),
        (Type::Uint32, 4294967291.0),
        (Type::Uint64, 18446744073709551611.0),
        (Type::Sint32, -2147483646.0),
        (Type::Sint64, -9223372036854775806.0),
        (Type::Bool, 1.0),
        (Type::Enum, -5.0),
    ];
    for (kind, expected) in kinds {
        let schema = set("proto3", vec![message_type("M", vec![field("a", 1, kind)])]);
        let mut decoder = protobuf_channel("t.M", schema.encode_to_vec()).unwrap();
        let found = decode(&mut decoder, varint(1, -5i64 as u64));
        assert_fields(&found, &[("a", Some(expected))]);
    }
}

fn cdr(name: &str, definition: &str) -> Result<PayloadDecoder, PayloadError> {
    let schema = Schema {
        name,
        encoding: "ros2msg",
        data: definition.as_bytes(),
    };
    PayloadDecoder::new("cdr", Some(schema))
}

/// Against what the Python package `mcap-ros2-support` wrote: `tests/data/foreign/write.py`.
#[test]
fn val_messages_of_ros_2_are_read() {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/foreign");
    let recording = Recording::open(&directory.join("ros2_b.mcap")).unwrap();
    let mut decoder = recording.channels()[0].payload_decoder().unwrap();
    let mut reader = recording.reader(Selection::default());
    let mut found = Vec::new();
    for index in 0..=33 {
        let message = reader.next_undecoded().unwrap();
        found = values(&mut decoder, message.data);
        assert_eq!(decoder.unsaid(message.data), None, "{index}");
    }
    let found: BTreeMap<_, _> = found.into_iter().collect();
    let text = |text: &str| Value::Text(text.into());
    for (path, value) in [
        ("header.stamp.sec", Value::Integer(0)),
        ("header.stamp.nanosec", Value::Integer(660_000_000)),
        ("header.frame_id", text("base")),
        ("on", Value::Bool(false)),
        ("flags", Value::Integer(33)),
        ("mode", Value::Integer(1)),
        ("small", Value::Integer(-33)),
        ("wide", Value::Real(-0.66)),
        ("short_count", Value::Integer(65502)),
        ("ticks", Value::Integer((1 << 60) + 33)),
        ("huge", Value::Large(u64::MAX - 33)),
        ("temperature", Value::Real(20.66015625)),
        ("name", text("walkér")),
        ("joints.0", Value::Real(0.7899922314973651)),
        ("joints.1", Value::Real(0.0825)),
        ("triple.1", Value::Integer(-33)),
        ("words.0", text("a")),
        ("words.1", Value::Absent),
        ("contacts", Value::Empty),
        ("feet.0.id", Value::Integer(-4)),
        ("feet.1.force", Value::Real(0.66)),
        ("image", Value::Bytes([0, 1, 2, 3, 4, 5, 6, 7, 8, 0].into())),
        ("nothing", Value::Empty),
        ("switches.0", Value::Bool(true)),
        ("switches.1", Value::Bool(false)),
    ] {
        assert_eq!(found[path], value, "{path}");
    }
}

#[test]
fn hostile_messages_of_ros_2_cost_nothing() {
    // More elements than there are bytes; a text that is too long; what is cut.
    for (definition, body) in [
        ("P[] list\n===\nMSG: a/P\nfloat64 x", &[0xff; 8][..]),
        ("uint8[] list", &[0xff; 8]),
        ("string s", &[0xff; 8]),
        ("float64[4000000000] list", &[0; 16]),
        ("E[] list\n===\nMSG: a/E\n", &[0xff, 0xff, 0xff, 0x7f, 0]),
        ("float64 x", &[0; 7]),
    ] {
        let mut decoder = cdr("a/msg/M", definition).unwrap();
        let data = [&[0, 1, 0, 0], body].concat();
        let reason = reason(&mut decoder, data);
        assert!(
            reason.contains("ends within a field"),
            "{definition}: {reason}"
        );
    }
    let mut decoder = cdr("a/msg/M", "int32 x").unwrap();
    assert!(reason(&mut decoder, [0, 7, 0, 0, 1, 0, 0, 0]).contains("CDR version 1"));
    // The other order of bytes.
    let found = values(&mut decoder, [0, 0, 0, 0, 0, 0, 1, 2]);
    assert_eq!(found, [("x".to_owned(), Value::Integer(258))]);
    // What stands behind the fields is not forgotten.
    let longer = [0, 1, 0, 0, 1, 0, 0, 0, 9];
    values(&mut decoder, longer);
    assert_eq!(decoder.unsaid(&longer), Some(&[9][..]));
    for (definition, part) in [
        ("M m", "nested more than"),
        (
            "P p\n===\nMSG: a/P\nb/Q q\n===\nMSG: b/Q\na/P p",
            "nested more than",
        ),
        ("Gone gone", "no message Gone"),
        ("wstring s", "wstring"),
        ("int32", "declares no field"),
        ("int32[x] list", "no length"),
    ] {
        let reason = cdr("a/msg/M", definition).unwrap_err().to_string();
        assert!(reason.contains(part), "{definition}: {reason}");
    }
}

proptest! {
    #[test]
    fn no_message_of_ros_2_makes_it_panic(
        definition in "((bool|int8|uint16|float64|string|P|a/P|Q)(\\[(|2|<=3)\\])? [a-c](=1)?( 1)?\n|===\nMSG: a/[PQ]\n|#\n){0,12}",
        data in prop::collection::vec(any::<u8>(), 0..80),
    ) {
        if let Ok(mut decoder) = cdr("a/msg/M", &definition) {
            let data = [&[0, 1, 0, 0], data.as_slice()].concat();
            let mut values = Vec::new();
            if decoder.decode(&data, &mut values).is_ok() {
                prop_assert_eq!(values.len(), decoder.fields().len());
            }
        }
    }
}

#[test]
fn a_schema_that_cannot_be_used_is_told() {
    let reason = |name: &str, data: Vec<u8>| protobuf_channel(name, data).unwrap_err().to_string();
    let schema = shapes().encode_to_vec();
    assert!(reason("t.Other", schema.clone()).ends_with("it has no message t.Other"));
    assert!(reason("t.Shapes", vec![1, 2, 3]).starts_with("its schema can't be used: "));
    let missing = of(".u.Gone", field("a", 1, Type::Message));
    let schema = set("proto3", vec![message_type("M", vec![missing])]);
    assert!(reason("t.M", schema.encode_to_vec()).ends_with("it has no message u.Gone"));
    let none = PayloadDecoder::new("protobuf", None).unwrap_err();
    assert_eq!(none, PayloadError::Schema("there is none".to_owned()));
    // Each of the names begins with the package's.
    let small = (0..100_000).map(|_| message_type("M", Vec::new()));
    let mut schema = set("proto3", small.collect());
    schema.file[0].package = Some("p".repeat(1 << 20));
    assert!(reason("t.M", schema.encode_to_vec()).contains("names are longer"));
}

/// Descriptors come with files of strangers. Why they are not given to a reflection crate.
#[test]
fn descriptors_that_prost_reflect_does_not_survive_are_refused() {
    // One file, without a name and with an empty syntax.
    let nameless = [0x0a, 0x04, 0x0a, 0x00, 0x62, 0x00];
    let decoded = std::panic::catch_unwind(|| prost_reflect::DescriptorPool::decode(&nameless[..]));
    assert!(
        decoded.is_err(),
        "prost-reflect no longer panics: see whether it can replace our own walk over messages"
    );
    // A file that publicly imports itself overflows its stack, which can't be shown in this process.
    let imports_itself = [0x0a, 0x08, 0x0a, 0x01, b'f', 0x1a, 0x01, b'f', 0x50, 0x00];
    for descriptors in [&nameless[..], &imports_itself] {
        let refused = protobuf_channel("M", descriptors.to_vec());
        assert!(
            matches!(refused, Err(PayloadError::Schema(_))),
            "{refused:?}"
        );
    }
}

#[test]
fn broken_protobuf_is_an_error() {
    let mut decoder = shapes_decoder();
    let whole = message();
    let mut failures = 0;
    for end in 0..whole.len() {
        let found = decoder.decode(&whole[..end], &mut Vec::new());
        failures += usize::from(found.is_err());
    }
    assert!(failures > 40, "{failures} failures");
    assert!(reason(&mut decoder, varint(1, 1)).contains("d is not written as its type"));
    assert!(reason(&mut decoder, [0x0c, 0x08]).contains("not a protobuf message"));
    let mut deep = Vec::new();
    for _ in 0..200 {
        deep = delimited(9, deep);
    }
    assert!(reason(&mut decoder, deep).contains("nested more than 100 deep"));
    // It is about one message.
    let there = |decoder: &mut PayloadDecoder| -> BTreeMap<_, _> {
        let found = decode(decoder, &whole).into_iter();
        found.filter_map(|(path, v)| Some((path, v?))).collect()
    };
    assert_eq!(there(&mut decoder), there(&mut shapes_decoder()));
}

#[test]
fn types_within_types_do_not_unfold_without_end() {
    // Each type has the next one ten times: ten to the power of twenty fields, or of none.
    for leaf in [Type::Double, Type::String] {
        let types = (0..20).map(|depth| {
            let inner = format!(".t.M{}", depth + 1);
            let fields = (1..=10).map(|n| of(&inner, field(&format!("f{n}"), n, Type::Message)));
            message_type(&format!("M{depth}"), fields.collect())
        });
        let last = message_type("M20", vec![field("x", 1, leaf)]);
        let schema = set("proto3", types.chain([last]).collect()).encode_to_vec();
        let mut decoder = protobuf_channel("t.M0", schema).unwrap();
        assert!(decoder.fields().len() <= 1024);
        let data = (0..20).fold(Vec::new(), |inner, _| delimited(10, inner));
        let found = decode(&mut decoder, data).into_iter();
        let there: Vec<_> = found.filter(|(_, value)| value.is_some()).collect();
        assert_eq!(there.len(), usize::from(leaf == Type::Double));
        assert_eq!(decoder.left_out(), 0);
    }
}

#[test]
fn fields_beyond_the_most_are_counted_and_not_decoded() {
    // Thirty thousand numbers that are zero in each of a hundred thousand messages.
    let numbers = (1..=30_000).map(|n| field(&format!("n{n}"), n, Type::Int32));
    let outer = message_type(
        "M",
        vec![repeated(of(".t.Many", field("m", 1, Type::Message)))],
    );
    let types = vec![outer, message_type("Many", numbers.collect())];
    let schema = set("proto3", types).encode_to_vec();
    let mut decoder = protobuf_channel("t.M", schema).unwrap();
    let data = delimited(1, []).repeat(100_000);
    let mut values = Vec::new();
    for _ in 0..2 {
        decoder.decode(&data, &mut values).unwrap();
        assert_eq!(values, vec![Value::Integer(0); MAX_FIELDS]);
    }
    assert_eq!(decoder.left_out(), 30_000 * 100_000 - MAX_FIELDS as u64);
}

/// A topic of a file of `tests/data/foreign`: for each field its values over time.
#[track_caller]
fn columns(file: &str, topic: &str) -> BTreeMap<String, BTreeMap<u64, f64>> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/foreign");
    let recording = Recording::open(&directory.join(file)).unwrap();
    assert_eq!(recording.condition(), Condition::Foreign);
    let mut channels = recording.channels().iter();
    let channel = channels.find(|channel| channel.topic == topic).unwrap();
    let mut decoder = channel.payload_decoder().unwrap();
    let mut reader = recording.reader(Selection {
        topics: Topics::Only(vec![topic.to_owned()]),
        ..Selection::default()
    });
    let mut columns: BTreeMap<String, BTreeMap<u64, f64>> = BTreeMap::new();
    let mut values = Vec::new();
    while let Some(message) = reader.next_undecoded() {
        decoder.decode(message.data, &mut values).unwrap();
        for (field, value) in decoder.fields().iter().zip(&values) {
            let number = value.number();
            if !number.is_nan() {
                let column = columns.entry(field.clone()).or_default();
                column.insert(message.log_time / 1_000_000, number);
            }
        }
    }
    assert!(reader.losses().is_empty());
    assert_eq!(decoder.left_out(), 0);
    columns
}

/// Where two files differ in a topic: for each field how often, from when on, ms, and by how much at most.
#[track_caller]
fn differences(a: &str, b: &str, topic: &str) -> Vec<(String, usize, u64, f64)> {
    let (a, b) = (columns(a, topic), columns(b, topic));
    let mut differences = Vec::new();
    for (field, values) in &a {
        let others = b.get(field).unwrap_or_else(|| panic!("only a has {field}"));
        let common = values
            .iter()
            .filter_map(|(t, v)| Some((*t, others.get(t)? - v)));
        let found: Vec<_> = common.filter(|(_, by)| *by != 0.0).collect();
        if let Some((start, _)) = found.first() {
            let most = found
                .iter()
                .fold(0.0, |most: f64, (_, by)| most.max(by.abs()));
            differences.push((field.clone(), found.len(), *start, most));
        }
    }
    differences
}

#[track_caller]
fn assert_differences(found: &[(String, usize, u64, f64)], expected: &[(&str, usize, u64, f64)]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(
            (found.0.as_str(), found.1, found.2),
            (expected.0, expected.1, expected.2)
        );
        assert!((found.3 - expected.3).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn val_json_files_of_others_differ_as_they_were_written() {
    let imu = differences("json_a.mcap", "json_b.mcap", "/imu");
    assert_differences(&imu, &[("angular_velocity.z", 100, 1000, 1e-3)]);
    assert_eq!(columns("json_a.mcap", "/imu").len(), 8);
    // Every 100 ms both have a message.
    let odom = differences("json_a.mcap", "json_b.mcap", "/odom");
    assert_differences(&odom, &[("x", 20, 0, 1e-4)]);
    assert_differences(&differences("json_a.mcap", "json_b.mcap", "/nan"), &[]);
    let counts = |file| {
        columns(file, "/nan")
            .into_values()
            .map(|column| column.len())
    };
    assert!(counts("json_a.mcap").eq([17, 20]));
    assert!(counts("json_b.mcap").eq([17, 19]));
    assert!(columns("json_a.mcap", "/empty").is_empty());
    let state = differences("schemaless_a.mcap", "schemaless_b.mcap", "/state");
    assert_differences(&state, &[("theta", 1, 840, 0.25)]);
    assert!(differences("json_a.mcap", "later.mcap", "/imu").is_empty());
    assert_eq!(columns("no_common.mcap", "/elsewhere")["x"].len(), 100);
}

#[test]
fn val_protobuf_files_of_others_differ_as_they_were_written() {
    let robot = differences("protobuf_a.mcap", "protobuf_b.mcap", "/robot");
    let expected = [
        ("joints.1", 1, 1000, 0.5),
        ("mode", 1, 400, 1.0),
        ("position.y", 100, 0, 1e-6),
        ("ticks", 25, 1500, 1.0),
    ];
    assert_differences(&robot, &expected);
    let a = columns("protobuf_a.mcap", "/robot");
    let lengths = ["quality", "target", "height", "angle", "offsets.bias"];
    let lengths = lengths.map(|field| a[field].len());
    assert_eq!(lengths, [97, 50, 50, 50, 100]);
    assert!(!a.contains_key("contacts.1.id") && !a.contains_key("never.x"));
    let b = columns("protobuf_b.mcap", "/robot");
    assert_eq!(b["contacts.1.force"].len(), 10);
    assert_differences(
        &differences("protobuf_a.mcap", "protobuf_b.mcap", "/pose"),
        &[],
    );
}

#[test]
fn val_the_encoding_makes_no_difference() {
    for topic in ["/robot", "/pose"] {
        let json = columns("protobuf_as_json.mcap", topic);
        assert_eq!(columns("protobuf_a.mcap", topic), json);
        assert!(json.len() > 2);
    }
}

"""Checks what `toprise diff A B` wrote with the public libraries, and prints what was checked as JSON.

    python diff.py A.mcap B.mcap DIFFERENCES.mcap REPORT.json SCHEMA.json

A and B are JSON recordings, the differences either JSON or protobuf. Each difference must be B - A to the last
bit, at the times that both have; the report must be valid by the schema, and be the one in the file.
"""

import json
import sys

import jsonschema
from google.protobuf.json_format import MessageToDict
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory


def leaves(value, name=""):
    for key, item in value.items():
        if isinstance(item, dict):
            yield from leaves(item, name + key + ".")
        elif isinstance(item, float):
            yield name + key, item


def recorded(path, topic):
    with open(path, "rb") as file:
        messages = make_reader(file).iter_messages(topics=[topic])
        return {message.log_time: dict(leaves(json.loads(message.data))) for _, _, message in messages}


def differences(path, topic):
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message in reader.iter_messages(topics=["/diff" + topic]):
            if channel.message_encoding == "json":
                yield message.log_time, json.loads(message.data)
            else:
                decoded = DecoderFactory().decoder_for("protobuf", schema)(message.data)
                yield message.log_time, MessageToDict(
                    decoded, preserving_proto_field_name=True, always_print_fields_with_no_presence=True
                )


def main():
    a_path, b_path, path, report_path, schema_path = sys.argv[1:]
    checked = {}
    for topic in ["/top/state", "/top/torque", "/top/precession"]:
        a, b = recorded(a_path, topic), recorded(b_path, topic)
        count = 0
        for time, message in differences(path, topic):
            found = dict(leaves(message))
            expected = {name: value - a[time][name] for name, value in b[time].items()}
            assert found == expected, f"{topic} at {time}: {found} is not {expected}"
            count += 1
        checked[topic] = count
    with open(path, "rb") as file:
        for record in make_reader(file).iter_metadata():
            if "report" in record.metadata:
                inside = json.loads(record.metadata["report"])
    with open(report_path, encoding="utf-8") as file:
        report = json.load(file)
    assert inside == report, "the file has another report"
    with open(schema_path, encoding="utf-8") as file:
        jsonschema.validate(report, json.load(file))
    print(json.dumps(checked))


main()

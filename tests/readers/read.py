"""Reads a recording with the public MCAP libraries and prints what it found as one line of JSON.

Nothing here comes from toprise but the definition of its content digest, so an equal digest means
that the file says to others what it says to us, to the last bit of every number.
"""

import hashlib
import json
import struct
import sys
import zlib

from mcap.reader import make_reader
from mcap.records import DataEnd, Footer
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory as ProtobufDecoderFactory
from mcap_ros2.decoder import DecoderFactory as Ros2DecoderFactory

MAGIC_AND_CRC = 8 + 4


def check_all_bytes(path):
    """The indexed reader passes over what it doesn't need; here every checksum is compared."""
    found = set()
    with open(path, "rb") as file:
        for record in StreamReader(file, validate_crcs=True).records:
            if isinstance(record, DataEnd):
                assert record.data_section_crc != 0, "the data section has no checksum"
                found.add(DataEnd)
            elif isinstance(record, Footer):
                assert record.summary_crc != 0, "the summary section has no checksum"
                footer = record
                found.add(Footer)
        assert found == {DataEnd, Footer}, "the file has no end"
        # The library leaves this one out.
        file.seek(footer.summary_start)
        summary = file.read()[:-MAGIC_AND_CRC]
        assert zlib.crc32(summary) == footer.summary_crc, "the summary section is damaged"


class Json:
    """Messages of a channel by its JSON Schema: it gives the order, whatever that of the messages."""

    def __init__(self, schema):
        assert schema.encoding == "jsonschema", schema.encoding
        self.texts, self.numbers = [], []
        self._collect(json.loads(schema.data), ())

    def _collect(self, schema, path):
        assert set(schema["required"]) == set(schema["properties"]), path
        for name, inner in schema["properties"].items():
            at = (*path, name)
            if inner["type"] == "object" and at != ("timestamp",):
                self._collect(inner, at)
            elif inner["type"] == "string":
                self.texts.append(at)
            elif inner["type"] == "number":
                self.numbers.append(at)

    def read(self, data, _decoded):
        message = json.loads(data)
        stamp = message["timestamp"]
        return stamp["sec"], stamp["nsec"], self._get(message, self.numbers), self._get(message, self.texts)

    @staticmethod
    def _get(message, paths):
        for path in paths:
            value = message
            for name in path:
                value = value[name]
            yield value


class Protobuf:
    """Messages of a channel by their descriptor."""

    def __init__(self, schema):
        assert schema.encoding == "protobuf", schema.encoding

    def read(self, _data, decoded):
        numbers, texts = [], []
        self._collect(decoded, numbers, texts)
        stamp = decoded.timestamp
        return stamp.seconds, stamp.nanos, numbers, texts

    def _collect(self, message, numbers, texts):
        for field in message.DESCRIPTOR.fields:
            if field.name == "timestamp":
                continue
            value = getattr(message, field.name)
            if field.type == field.TYPE_MESSAGE:
                assert message.HasField(field.name), field.full_name
                self._collect(value, numbers, texts)
            elif field.type == field.TYPE_STRING:
                texts.append(value)
            else:
                assert field.type == field.TYPE_DOUBLE, field.full_name
                numbers.append(value)


ENCODINGS = {"json": Json, "protobuf": Protobuf}


class JsonDecoderFactory:
    """Lets JSON pass: it needs no factory."""

    def decoder_for(self, message_encoding, _schema):
        return (lambda data: None) if message_encoding == "json" else None


def content(message, numbers, texts):
    """What the digest takes in of a message."""
    out = bytearray(struct.pack("<IQ", message.sequence, message.log_time))
    for number in numbers:
        out += struct.pack("<d", number)
    for text in texts:
        text = text.encode()
        out += struct.pack("<Q", len(text)) + text
    return out


def stamps(decoded):
    """The times that a ROS 2 message carries itself."""
    if hasattr(decoded, "transforms"):
        return [transform.header.stamp for transform in decoded.transforms]
    if hasattr(decoded, "header"):
        return [decoded.header.stamp]
    return [decoded.stamp] if hasattr(decoded, "stamp") else []


def read(path):
    check_all_bytes(path)
    readers, digests, counts, views = {}, {}, {}, {}
    with open(path, "rb") as file:
        factories = [JsonDecoderFactory(), ProtobufDecoderFactory(), Ros2DecoderFactory()]
        reader = make_reader(file, validate_crcs=True, decoder_factories=factories)
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert message.publish_time == message.log_time, channel.topic
            if channel.message_encoding not in ENCODINGS:
                for stamp in stamps(decoded):
                    assert stamp.sec * 10**9 + stamp.nanosec == message.log_time, channel.topic
                views[channel.topic] = views.get(channel.topic, 0) + 1
                continue
            if channel.id not in readers:
                readers[channel.id] = ENCODINGS[channel.message_encoding](schema)
                digests[channel.id] = hashlib.sha256()
                counts[channel.id] = 0
            sec, nsec, numbers, texts = readers[channel.id].read(message.data, decoded)
            assert sec * 10**9 + nsec == message.log_time, channel.topic
            digests[channel.id].update(content(message, numbers, texts))
            counts[channel.id] += 1
        channels = reader.get_summary().channels
        recorded = reader.get_summary().statistics.message_count
    whole = hashlib.sha256()
    # The ids ascend in the order of the table.
    for channel in sorted(digests):
        whole.update(channels[channel].topic.encode() + b"\0")
        whole.update(struct.pack("<Q", counts[channel]) + digests[channel].digest())
    messages = sum(counts.values())
    assert messages + sum(views.values()) == recorded, "the index does not lead to every message"
    return {
        "content_digest": whole.hexdigest(),
        "messages": messages,
        "topics": {channels[channel].topic: counts[channel] for channel in sorted(counts)},
        "views": views,
    }


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: read.py RECORDING.mcap")
    print(json.dumps(read(sys.argv[1])))

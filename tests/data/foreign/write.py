"""Writes the MCAP files in this directory with other people's software: the package mcap.

    eval "$(tests/readers/setup)"
    "$TOPRISE_READERS_PYTHON" tests/data/foreign/write.py

"Difference" in a comment names each difference of the two. All other numbers are equal. Times are in seconds from zero on. The messages are the same each time; the compressed bytes
depend on the versions of the compressors.
"""

import json
from math import cos, sin
from pathlib import Path

from mcap.writer import CompressionType, Writer

HERE = Path(__file__).resolve().parent
# Small, so that there are several.
CHUNK = 8192


def nanoseconds(time):
    return round(time * 1e9)


def times(rate, duration=2):
    """So many per second, from 0 on: with 100 the last is 1.99."""
    return [index / rate for index in range(rate * duration)]


def json_schema(message):
    """The JSON Schema of a message."""
    if isinstance(message, dict):
        inner = {name: json_schema(member) for name, member in message.items()}
        return {"type": "object", "properties": inner}
    if isinstance(message, list):
        return {"type": "array", "items": json_schema(message[0])}
    kinds = {bool: "boolean", int: "integer", float: "number", str: "string"}
    return {"type": kinds[type(message)]}


def write_json(name, channels, compression):
    """Writes {topic: (example, [(time, message)])}, in the order of time."""
    with open(HERE / name, "wb") as file:
        writer = Writer(
            file,
            chunk_size=CHUNK,
            compression=compression,
        )
        writer.start(library="write.py")
        ids = {}
        for topic, (example, _) in channels.items():
            data = json.dumps(json_schema(example)).encode()
            schema = writer.register_schema(topic.strip("/"), "jsonschema", data)
            ids[topic] = writer.register_channel(topic, "json", schema)
        messages = [
            (time, topic, sequence, message)
            for topic, (_, listed) in channels.items()
            for sequence, (time, message) in enumerate(listed)
        ]
        for time, topic, sequence, message in sorted(messages, key=lambda m: m[0]):
            writer.add_message(
                channel_id=ids[topic],
                log_time=nanoseconds(time),
                publish_time=nanoseconds(time),
                sequence=sequence,
                data=json.dumps(message, allow_nan=False).encode(),
            )
        writer.finish()


def imu(time, side):
    # Difference: angular_velocity.z is larger by 1e-3 in b from 1 s on. The texts differ throughout.
    shift = 1e-3 if side == "b" and time >= 1 else 0.0
    return {
        "header": {"frame_id": f"imu_{side}", "seq": round(time * 100)},
        "angular_velocity": {"x": sin(3 * time), "y": cos(3 * time), "z": 0.5 * sin(time) + shift},
        "linear_acceleration": [0.1 * sin(20 * time), 0.1 * cos(20 * time), 9.81],
        "calibrated": time >= 0.5,
    }


def odom(time, side):
    # Difference: x is larger by 1e-4 in b. All are linear in time: 50 Hz in a and 20 Hz in b can be compared.
    shift = 1e-4 if side == "b" else 0.0
    return {"x": 0.5 + 2 * time + shift, "yaw": 0.25 * time, "speed": 2.0}


def with_nulls(index, side):
    # `both` is null in messages 3, 4 and 10 of either. Difference: `one` is null in message 7 of b alone.
    return {
        "both": None if index in (3, 4, 10) else index / 4,
        "one": None if index == 7 and side == "b" else float(index),
    }


def json_channels(side):
    """Difference: /only_a and /only_b are in one of the files only. /empty has no messages."""
    rate = {"a": 50, "b": 20}[side]
    messages = {
        "/imu": [(t, imu(t, side)) for t in times(100)],
        "/odom": [(t, odom(t, side)) for t in times(rate)],
        f"/only_{side}": [(t, {"value": t}) for t in times(10)],
        "/nan": [(t, with_nulls(i, side)) for i, t in enumerate(times(10))],
    }
    channels = {
        topic: (listed[0][1], listed)
        for topic, listed in messages.items()
    }
    return {**channels, "/empty": ({"value": 0.0}, [])}


def main():
    write_json("json_a.mcap", json_channels("a"), CompressionType.ZSTD)
    write_json("json_b.mcap", json_channels("b"), CompressionType.LZ4)


if __name__ == "__main__":
    main()

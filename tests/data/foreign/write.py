"""Writes the MCAP files in this directory with other people's packages: mcap, mcap-protobuf-support and mcap-ros2-support.

    eval "$(tests/readers/setup)"
    "$TOPRISE_READERS_PYTHON" tests/data/foreign/write.py

Files come in pairs whose differences are known; "difference" in a comment tells each. All other numbers
are equal. Times are in seconds from zero on. The messages are the same each time; the compressed bytes
depend on the versions of the compressors.
"""

import json
import tempfile
from math import cos, nan, sin
from pathlib import Path

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from grpc_tools import protoc
from mcap.writer import CompressionType, Writer
from mcap_protobuf.writer import Writer as ProtobufWriter
from mcap_ros2.writer import Writer as Ros2Writer

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


def write_json(name, channels, compression, with_schemas=True):
    """Writes {topic: (example, [(time, message)])}, in the order of time."""
    with open(HERE / name, "wb") as file:
        writer = Writer(
            file,
            chunk_size=CHUNK,
            compression=compression or CompressionType.NONE,
            use_chunking=compression is not None,
        )
        writer.start(library="write.py")
        ids = {}
        for topic, (example, _) in channels.items():
            schema = 0
            if with_schemas:
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


def json_channels(side, start=0):
    """Difference: /only_a and /only_b are in one of the files only. /empty has no messages."""
    rate = {"a": 50, "b": 20}[side]
    messages = {
        "/imu": [(t, imu(t, side)) for t in times(100)],
        "/odom": [(t, odom(t, side)) for t in times(rate)],
        f"/only_{side}": [(t, {"value": t}) for t in times(10)],
        "/nan": [(t, with_nulls(i, side)) for i, t in enumerate(times(10))],
    }
    channels = {
        topic: (listed[0][1], [(start + t, message) for t, message in listed])
        for topic, listed in messages.items()
    }
    return {**channels, "/empty": ({"value": 0.0}, [])}


def schemaless_channels(side):
    # Difference: theta is larger by 0.25 in message 42 of b, which is at 0.84 s.
    def message(index, time):
        shift = 0.25 if side == "b" and index == 42 else 0.0
        return {"theta": cos(time) + shift, "omega": -sin(time), "mode": index // 40}

    return {"/state": ({}, [(t, message(i, t)) for i, t in enumerate(times(50))])}


PROTO = """
syntax = "proto3";
package foreign;
import "google/protobuf/timestamp.proto";

enum Mode { IDLE = 0; WALK = 1; FALL = 2; }

message Vector { double x = 1; double y = 2; double z = 3; }

message Contact { int32 id = 1; float force = 2; }

message Robot {
  google.protobuf.Timestamp stamp = 1;
  string name = 2;
  Vector position = 3;
  repeated double joints = 4;
  repeated Contact contacts = 5;
  Mode mode = 6;
  int64 ticks = 7;
  float temperature = 8;
  optional double target = 9;
  double quality = 10;
  map<string, double> offsets = 11;
  bytes raw = 12;
  oneof command { double height = 13; double angle = 14; }
  Vector never = 15;
}
"""


def compile_proto():
    """The message classes of PROTO."""
    with tempfile.TemporaryDirectory() as directory:
        source = Path(directory) / "foreign.proto"
        source.write_text(PROTO)
        target = Path(directory) / "set"
        well_known = Path(protoc.__file__).parent / "_proto"
        arguments = ["", f"-I{directory}", f"-I{well_known}", "--include_imports"]
        assert protoc.main([*arguments, f"--descriptor_set_out={target}", str(source)]) == 0
        files = descriptor_pb2.FileDescriptorSet.FromString(target.read_bytes()).file
    pool = descriptor_pool.DescriptorPool()
    for file in files:
        pool.Add(file)
    return message_factory.GetMessageClassesForFiles(["foreign.proto"], pool)


def single(value):
    """A number near this one that a float of 32 bits has exactly."""
    return round(value * 1024) / 1024


def robot(index, time, side):
    """A message as JSON has it; what is not set in protobuf is missing or null."""
    is_b = side == "b"
    message = {
        "stamp": {"seconds": int(time), "nanos": nanoseconds(time) % 10**9},
        "name": "walker",
        # Difference: position.y is larger by 1e-6 in b.
        "position": {"x": time, "y": sin(time) + (1e-6 if is_b else 0.0), "z": 0.75},
        # Difference: joints.1 is larger by 0.5 in message 50 of b, at 1 s.
        "joints": [cos(time), time / 8 + (0.5 if is_b and index == 50 else 0.0), 0.0],
        "contacts": [{"id": 4, "force": single(30 + sin(9 * time))}],
        # Difference: 2 instead of 1 in message 20 of b, at 0.4 s.
        "mode": 2 if is_b and index == 20 else int(index >= 10),
        # Difference: larger by 1 in b from message 75 on, at 1.5 s.
        "ticks": 2**40 + 1000 * index + (1 if is_b and index >= 75 else 0),
        "temperature": single(20 + time),
        # NaN in messages 10, 11 and 12 of either.
        "quality": None if index in (10, 11, 12) else 1 - time / 4,
        "offsets": {"bias": 0.25},
    }
    # Difference: a second contact in b from message 90 on, at 1.8 s: contacts.1.id and contacts.1.force
    # are fields of b alone.
    if is_b and index >= 90:
        message["contacts"].append({"id": 5, "force": 1.5})
    # The target is not set in the first second; the command changes with each message.
    if time >= 1:
        message["target"] = time - 1
    message["height" if index % 2 == 0 else "angle"] = time / 2
    return message


def robots(side):
    return [(t, robot(i, t, side)) for i, t in enumerate(times(50))]


def poses():
    """No difference."""
    return [(t, {"x": t, "y": 2 * t, "z": -0.0}) for t in times(10)]


def write_protobuf(name, side, compression):
    classes = compile_proto()

    def as_protobuf(robot):
        numbers = {**robot, "quality": nan if robot["quality"] is None else robot["quality"]}
        return classes["foreign.Robot"](**numbers, raw=bytes(range(16)))

    messages = [(t, "/robot", as_protobuf(message)) for t, message in robots(side)]
    messages += [(t, "/pose", classes["foreign.Vector"](**message)) for t, message in poses()]
    with open(HERE / name, "wb") as file:
        writer = ProtobufWriter(file, chunk_size=CHUNK, compression=compression)
        for time, topic, message in sorted(messages, key=lambda m: m[0]):
            writer.write_message(topic, message, nanoseconds(time), nanoseconds(time))
        writer.finish()


ROS2 = """
# Everything that there is.
uint8 IDLE=0
uint8 WALK = 1   # a constant
string NAME="a # b"
std_msgs/Header header
bool on
byte flags
uint8 mode 1
int8 small
float64 wide
uint16 short_count
int64 ticks
uint64 huge
float32 temperature
string<=20 name "none"
float64[] joints
int16[3] triple
string[<=4] words
Contact[] contacts
foreign_msgs/Contact[2] feet
uint8[] image
std_msgs/Empty nothing
bool[] switches
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: foreign_msgs/Contact
int32 id
float64 force
================================================================================
MSG: std_msgs/Empty
"""


def ros2_robot(index, time, side):
    is_b = side == "b"
    contact = {"id": -4, "force": 30 + sin(9 * time)}
    return {
        "header": {
            "stamp": {"sec": int(time), "nanosec": nanoseconds(time) % 10**9},
            "frame_id": "base",
        },
        "on": index % 2 == 0,
        "flags": index % 200,
        "mode": int(index >= 10),
        "small": -index,
        "wide": -time,
        "short_count": 65535 - index,
        # Difference: larger by 1 in b from message 75 on, at 1.5 s: beyond what doubles tell apart.
        "ticks": 2**60 + index + (1 if is_b and index >= 75 else 0),
        "huge": 2**64 - 1 - index,
        "temperature": single(20 + time),
        # Difference: another name in message 33 of b, at 0.66 s.
        "name": "walkér" if is_b and index == 33 else "walker",
        # Difference: joints.1 is larger by 0.5 in message 50 of b, at 1 s.
        "joints": [cos(time), time / 8 + (0.5 if is_b and index == 50 else 0.0)],
        "triple": [index, -index, 7],
        "words": ["a", "", "ccc"][: index % 4],
        "contacts": [contact] * (index % 3),
        "feet": [contact, {"id": 5, "force": time}],
        # Difference: the last byte in message 60 of b, at 1.2 s.
        "image": bytes(range(9)) + bytes([1 if is_b and index == 60 else 0]),
        "nothing": {},
        "switches": [True, False],
    }


def write_ros2(name, side, compression):
    with open(HERE / name, "wb") as file:
        writer = Ros2Writer(file, chunk_size=CHUNK, compression=compression)
        schema = writer.register_msgdef("foreign_msgs/msg/Robot", ROS2)
        for index, time in enumerate(times(50)):
            writer.write_message(
                "/robot",
                schema,
                ros2_robot(index, time, side),
                log_time=nanoseconds(time),
                publish_time=nanoseconds(time),
                sequence=index,
            )
        writer.finish()


def main():
    write_json("json_a.mcap", json_channels("a"), CompressionType.ZSTD)
    write_json("json_b.mcap", json_channels("b"), CompressionType.LZ4)
    # The messages of json_a, 1000 s later: there is no time at which both have any.
    write_json("later.mcap", json_channels("a", start=1000), CompressionType.ZSTD)
    # No topic of any other file.
    elsewhere = {"/elsewhere": ({"x": 0.0}, [(t, {"x": sin(t)}) for t in times(50)])}
    write_json("no_common.mcap", elsewhere, CompressionType.LZ4)

    # The first has no chunks.
    write_json("schemaless_a.mcap", schemaless_channels("a"), None, with_schemas=False)
    write_json("schemaless_b.mcap", schemaless_channels("b"), CompressionType.ZSTD, with_schemas=False)

    write_protobuf("protobuf_a.mcap", "a", CompressionType.LZ4)
    write_protobuf("protobuf_b.mcap", "b", CompressionType.ZSTD)
    write_ros2("ros2_a.mcap", "a", CompressionType.ZSTD)
    write_ros2("ros2_b.mcap", "b", CompressionType.LZ4)
    # The numbers of protobuf_a: no difference.
    as_json = {
        "/robot": ({}, robots("a")),
        "/pose": ({}, poses()),
    }
    write_json("protobuf_as_json.mcap", as_json, CompressionType.ZSTD, with_schemas=False)


if __name__ == "__main__":
    main()

"""Compiles the committed .proto files and compares with the descriptors that recordings carry.

So code generated from the .proto files reads what the recordings contain.
"""

import pathlib
import sys
import tempfile

import grpc_tools
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from grpc_tools import protoc
from mcap.reader import make_reader

SCHEMAS = pathlib.Path(__file__).resolve().parents[2] / "schemas"


def compiled():
    """The compiler's descriptors by the name of their file."""
    files = sorted(path.name for path in SCHEMAS.glob("*.proto"))
    with tempfile.TemporaryDirectory() as directory:
        out = pathlib.Path(directory) / "all"
        well_known = pathlib.Path(grpc_tools.__file__).parent / "_proto"
        arguments = [f"-I{SCHEMAS}", f"-I{well_known}", "--include_imports", f"--descriptor_set_out={out}"]
        if protoc.main(["protoc", *arguments, *files]) != 0:
            sys.exit("the .proto files don't compile")
        found = FileDescriptorSet.FromString(out.read_bytes())
    return {file.name: file for file in found.file}


def recorded(path):
    """The descriptors of each channel: topic, name of the message, and files."""
    with open(path, "rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
    for channel in summary.channels.values():
        schema = summary.schemas[channel.schema_id]
        if channel.message_encoding == "protobuf":
            yield channel.topic, schema.name, FileDescriptorSet.FromString(schema.data).file


def essence(file):
    """A file without its options, which say what generated code is called, and without its source."""
    file.ClearField("options")
    file.ClearField("source_code_info")
    return file


def messages(file):
    return {f"{file.package}.{message.name}" for message in file.message_type}


def main(recordings):
    truth = compiled()
    of_ours = {name for name in truth if not name.startswith("google/")}
    compared, seen = 0, set()
    for topic, name, files in (channel for recording in recordings for channel in recorded(recording)):
        if not any(name in messages(file) for file in files):
            sys.exit(f"{topic}: its descriptors have no {name}")
        for file in files:
            if file.name not in truth:
                sys.exit(f"{topic}: there is no {file.name} in {SCHEMAS}")
            mine, theirs = essence(file), essence(truth[file.name])
            if mine != theirs:
                sys.exit(f"{topic}: {file.name} differs\n--- recorded\n{mine}\n--- compiled\n{theirs}")
            seen.add(file.name)
        compared += 1
    if missing := of_ours - seen:
        sys.exit(f"no channel of the recordings has {', '.join(sorted(missing))}")
    print(compared)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: protos.py RECORDING.mcap...")
    main(sys.argv[1:])

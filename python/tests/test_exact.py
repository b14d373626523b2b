"""Tables hold what recordings hold, to the last bit."""

import hashlib
import json
import re
import struct
from collections import defaultdict

import numpy as np
import pytest
from conftest import ROOT
from mcap.reader import make_reader

import toprise

#: Content digests of the presets' recordings, which toprise's own tests hold.
GOLDEN = dict(
    re.findall(
        r'\("([\w-]+)", \d+, \d+, "([0-9a-f]{64})"\)',
        (ROOT / "tests/suite/golden.rs").read_text(),
    )
)


def fields(table):
    """The columns that are fields of messages."""
    own = {"time_ns", "sequence"}
    if table.name not in ("/events", "/top/impact"):
        own.add("time")
    return [name for name in table.column_names if name not in own]


def content_digest(run):
    """The content digest by its definition (src/telemetry/digest.rs), from nothing but the tables' columns."""
    whole = hashlib.sha256()
    for topic in run:
        table = run[topic]
        if len(table) == 0:
            continue
        columns = [table.numpy(name) for name in fields(table)]
        numbers = [column for column in columns if column.dtype.kind == "f"]
        texts = [column for column in columns if column.dtype.kind == "U"]
        rows = np.empty(
            len(table),
            dtype=[("sequence", "<u4"), ("time", "<u8"), ("numbers", "<f8", (len(numbers),))],
        )
        rows["sequence"] = table.numpy("sequence")
        rows["time"] = table.numpy("time_ns")
        rows["numbers"] = np.stack(numbers, axis=1)
        content = hashlib.sha256()
        if not texts:
            content.update(rows.tobytes())
        for row, *words in zip(rows, *texts) if texts else ():
            content.update(row.tobytes())
            for word in words:
                word = str(word).encode()
                content.update(struct.pack("<Q", len(word)) + word)
        whole.update(topic.encode() + b"\0" + struct.pack("<Q", len(table)) + content.digest())
    return whole.hexdigest()


@pytest.mark.parametrize("preset", ["paper", "drop", "tippe-top-hangs", "lifecycle"])
def test_val_every_bit_of_a_run_is_that_of_its_recording(preset):
    run = toprise.run(preset)
    assert content_digest(run) == GOLDEN[preset]
    assert run.content_digest == GOLDEN[preset]


def test_val_a_run_is_what_another_reader_finds_in_the_recording(reference):
    path = reference / "paper.mcap"
    found = defaultdict(list)
    with open(path, "rb") as file:
        for _, channel, message in make_reader(file).iter_messages():
            if channel.message_encoding == "json":
                found[channel.topic].append((message, json.loads(message.data)))
    simulated, recorded = toprise.run(path), toprise.read(path)
    assert simulated.topics == recorded.topics
    for topic in simulated:
        messages = found[topic]
        for table in (simulated[topic], recorded[topic]):
            assert len(table) == len(messages) > 0
            assert table.numpy("sequence").tolist() == [m.sequence for m, _ in messages]
            assert table.numpy("time_ns").tolist() == [m.log_time for m, _ in messages]
            names = fields(table)
            for name in names:
                values = [leaf(content, name) for _, content in messages]
                # Bits: -0.0 is not 0.0.
                column = table.numpy(name)
                assert column.tobytes() == np.array(values, dtype=column.dtype).tobytes()
            assert len(names) == sum(map(count, messages[0][1].values())) - 2, "sec and nsec"


def leaf(content, name):
    """The value in a message that a column's name means: `omega_body_x` is `x` of `omega_body`."""
    for key, value in content.items():
        if key == name:
            return value
        if isinstance(value, dict) and name.startswith(key + "_") and name[len(key) + 1 :] in value:
            return value[name[len(key) + 1 :]]
    raise KeyError(name)


def count(value):
    return len(value) if isinstance(value, dict) else 1


def test_a_recording_reads_like_the_run_that_it_is_of(reference, paper):
    read = toprise.read(reference / "paper.mcap")
    run = toprise.run("paper", {"sampling.period": 0.01})
    assert read.scenario == run.scenario != paper.scenario
    assert read.content_digest == run.content_digest
    assert (read.path, run.path) == (str(reference / "paper.mcap"), None)
    for topic in run:
        for name in run[topic].column_names:
            assert np.array_equal(read[topic].numpy(name), run[topic].numpy(name))


def test_topics_can_be_chosen(reference):
    chosen = ["/top/state", "/events"]
    assert toprise.run("paper", {"stop.duration": 0.1}, topics=chosen).topics == chosen
    assert toprise.read(reference / "paper.mcap", topics=chosen).topics == chosen
    assert toprise.run("paper", {"stop.duration": 0.1}, topics=[]).topics == []

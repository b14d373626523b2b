"""Subtract one topic of two MCAP recordings with NumPy.

    pip install mcap numpy
    python mcap_numpy_diff.py A.mcap B.mcap [TOPIC]

Both files are read wholly.  All number fields of the topic's JSON messages (default /top/state)
become arrays, nested ones under dotted names.  The two are aligned on the log times they share.
Printed per field: max |B - A| and the time of it in seconds.  Angles are subtracted as they are,
without unwrapping.  The wall time goes to stderr.
"""

import json
import sys
import time

import numpy as np
from mcap.reader import make_reader


def numbers(value, name=""):
    """Number fields of a message under dotted names; the message's own timestamp is left out."""
    for key, item in value.items():
        if isinstance(item, dict):
            if key != "timestamp":
                yield from numbers(item, name + key + ".")
        elif isinstance(item, (int, float)) and not isinstance(item, bool):
            yield name + key, item


def load(path, topic):
    times, rows = [], []
    with open(path, "rb") as stream:
        for _, channel, message in make_reader(stream).iter_messages(topics=[topic]):
            if channel.message_encoding != "json":
                sys.exit(f"{path}: {topic} is encoded as {channel.message_encoding}, not json")
            times.append(message.log_time)
            rows.append(dict(numbers(json.loads(message.data))))
    if not rows:
        sys.exit(f"{path}: no messages on {topic}")
    times = np.array(times, dtype=np.int64)
    if len(np.unique(times)) != len(times):
        sys.exit(f"{path}: {topic} has several messages with one log time")
    # A field absent from a message becomes NaN.
    fields = dict.fromkeys(name for row in rows for name in row)
    return times, {name: np.array([row.get(name, np.nan) for row in rows], dtype=float) for name in fields}


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    begin = time.perf_counter()
    topic = sys.argv[3] if len(sys.argv) == 4 else "/top/state"
    times_a, a = load(sys.argv[1], topic)
    times_b, b = load(sys.argv[2], topic)
    common, in_a, in_b = np.intersect1d(times_a, times_b, assume_unique=True, return_indices=True)
    print(f"{topic}: {len(times_a)} and {len(times_b)} messages, {len(common)} common log times")
    if len(common) == 0:
        sys.exit("no common log times")
    for name in sorted(a.keys() ^ b.keys()):
        print(f"{name}: only in {'A' if name in a else 'B'}")
    for name in a:
        if name in b:
            difference = np.abs(b[name][in_b] - a[name][in_a])
            if np.all(np.isnan(difference)):
                print(f"{name}: no common values")
                continue
            i = np.nanargmax(difference)
            print(f"{name}: max |B - A| = {float(difference[i])!r} at {int(common[i]) / 1e9!r} s")
    print(f"{time.perf_counter() - begin:.3f} s", file=sys.stderr)


if __name__ == "__main__":
    main()

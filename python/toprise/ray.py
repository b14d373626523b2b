"""Sweeps on a Ray cluster: `pip install toprise[ray]`.

Ray schedules and retries the tasks. Finished parts are stored as files, so that no row is lost or duplicated if a task is
killed. All nodes need a shared file system.
"""

from __future__ import annotations

import json
import os
from typing import Any

import ray

from . import _toprise
from ._sweeps import Spec, read
from ._sweeps import sweep as sweep_here


def sweep(spec: Spec, out: str | os.PathLike[str], *, retries: int = 5) -> dict[str, Any]:
    """Computes a sweep with one Ray task per part and merges the table. Its bytes are those of a local sweep.

    `out` must be in a directory shared by all nodes. A task whose worker or node dies is retried up to `retries` times.
    If the driver dies, repeat the call to resume. Returns the same dictionary as `toprise.sweep`; its counts include
    the runs of all tasks.
    """
    text, folder = read(spec)
    rows, part_rows = _toprise.rows(text, folder)
    parts = -(-rows // part_rows)
    path = os.path.abspath(out)

    def compute(part: int) -> int:
        # A shard of one part; an existing part is not recomputed.
        answer = _toprise.sweep(
            text, folder, path, threads=1, shard=(part, parts), fail_fast=False, progress=None
        )
        return int(json.loads(answer)["computed"])

    computed = 0
    if not os.path.exists(path):
        task: Any = ray.remote(num_cpus=1, max_retries=retries)(compute)
        computed = sum(ray.get([task.remote(part) for part in range(parts)]))
    answer = sweep_here(spec, path)
    answer["computed"] += computed
    answer["kept"] = answer["runs"] - answer["computed"]
    return answer

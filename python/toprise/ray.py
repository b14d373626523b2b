"""Sweeps on a Ray cluster: `pip install toprise[ray]`.

Ray schedules, retries and moves the work. The files of the parts record what is done, so that no row is missing or there twice,
whatever is killed. All nodes need one file system.
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
    """Computes a sweep with one Ray task for each part of it, and merges its table: the bytes of a local sweep.

    `out` lies in a folder that all nodes share. A task whose worker or node dies is tried again, `retries` times. If the program itself
    dies, the same call goes on where it was. The answer is that of `toprise.sweep`, and its counts include the runs of all tasks.
    """
    text, folder = read(spec)
    rows, part_rows = _toprise.rows(text, folder)
    parts = -(-rows // part_rows)
    path = os.path.abspath(out)

    def compute(part: int) -> int:
        # A share of one part; it is left alone if it is there.
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

"""Reading and writing clips by pybvh: the best seconds of each, and copies of clips without an edit.

Arguments: the long clip to time, where to write it, then any number of pairs of a clip and where its copy goes.
"""

from __future__ import annotations

import json
import sys
import time
from importlib.metadata import version
from typing import TYPE_CHECKING

import pybvh

if TYPE_CHECKING:
    from collections.abc import Callable

SECONDS = 1.0


def best(run: Callable[[], object]) -> float:
    """Return the least seconds of several runs."""
    least, until = float("inf"), time.perf_counter() + SECONDS
    while time.perf_counter() < until:
        start = time.perf_counter()
        run()
        least = min(least, time.perf_counter() - start)
    return least


def main() -> None:
    """Time reading and writing, then copy the clips."""
    source, output, *pairs = sys.argv[1:]
    clip = pybvh.read_bvh_file(source)
    read = best(lambda: pybvh.read_bvh_file(source))
    write = best(lambda: pybvh.write_bvh_file(clip, output))
    refused = {}
    for one, copy in zip(pairs[::2], pairs[1::2], strict=True):
        try:
            pybvh.write_bvh_file(pybvh.read_bvh_file(one), copy)
        except Exception as error:  # noqa: BLE001
            refused[one] = str(error)
    print(json.dumps({"versions": {"pybvh": version("pybvh")}, "read": read, "write": write, "refused": refused}))


if __name__ == "__main__":
    main()

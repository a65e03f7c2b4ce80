"""Timing on a busy machine: contenders take turns, the best of each counts, and a row sets one beside the other."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

# A turn lasts at least this many seconds: something short runs often in it.
TURN = 0.4
HEADINGS = ("what", "ours", "reference", "ratio", "aim", "")


@dataclass(frozen=True)
class Row:
    """A line of the table, as printed."""

    what: str
    ours: str
    reference: str = ""
    ratio: str = ""
    aim: str = ""
    verdict: str = ""

    @property
    def cells(self) -> tuple[str, ...]:
        """The texts under HEADINGS."""
        return self.what, self.ours, self.reference, self.ratio, self.aim, self.verdict


def cells(rows: Iterable[Row]) -> list[tuple[str, ...]]:
    """Return rows as the texts of a table, under HEADINGS."""
    return [HEADINGS, *(row.cells for row in rows)]


def best_of(
    contenders: Mapping[str, Callable[[], object]], *, rounds: int, clock: Callable[[], float] = time.perf_counter
) -> dict[str, float]:
    """Return the least seconds of each contender over rounds in which all of them take a turn.

    Whatever else the machine does only ever adds time, and it adds to all that are measured in the same seconds.

    Parameters
    ----------
    clock : callable
        Returns seconds; `time.process_time` those of the processor, of what is done in this process alone.
    """
    seconds = dict.fromkeys(contenders, float("inf"))
    gc.collect()
    gc.disable()
    try:
        for _ in range(rounds):
            for name, run in contenders.items():
                until = clock() + TURN
                while True:
                    start = clock()
                    run()
                    stop = clock()
                    seconds[name] = min(seconds[name], stop - start)
                    if stop > until:
                        break
    finally:
        gc.enable()
    return seconds


def process(command: Sequence[str | Path], folder: Path) -> Callable[[], object]:
    """Return a function that runs a command to its end; it fails where the command does.

    Compiled modules are kept between runs, as an installed package has them.
    """
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)

    def run() -> object:
        return subprocess.run(list(map(str, command)), cwd=folder, env=environment, check=True, capture_output=True)

    return run


# A new process counts the memory of the one that started it as its own peak, so that a small one must start what is
# measured.
_WATCH = """\
import os, subprocess, sys, time
start = time.perf_counter()
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(child.pid, 0)
child.returncode = os.waitstatus_to_exitcode(status)
print(time.perf_counter() - start, usage.ru_maxrss)
sys.exit(child.returncode)
"""


def peak_of(command: Sequence[str | Path], folder: Path) -> tuple[float, int]:
    """Return the seconds and the peak of resident bytes of a command that is run to its end; not on Windows.

    Raises
    ------
    OSError
        The system does not tell the peak of a process that has ended.
    """
    if not hasattr(os, "wait4"):
        raise OSError("this system does not tell the peak memory of a process that has ended")
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    watch = [sys.executable, "-c", _WATCH, *map(str, command)]
    done = subprocess.run(watch, cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, text=True)
    seconds, peak = done.stdout.split()
    # In bytes on a Mac, in kilobytes elsewhere.
    return float(seconds), int(peak) * (1 if sys.platform == "darwin" else 1024)


def duration(seconds: float) -> str:
    """Return a time in the unit that suits it: ``48.1 us``, ``3.20 ms``, ``1.04 s``."""
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e6:.3g} us"


def at_most(what: str, seconds: float, aim: float | None) -> Row:
    """Return the row of a time that may have a limit in seconds."""
    if aim is None:
        return Row(what, duration(seconds))
    return Row(what, duration(seconds), "", "", f"<= {duration(aim)}", _verdict(met=seconds <= aim))


def faster(what: str, ours: float, reference: float, *, aim: float | None, than: str) -> Row:
    """Return the row of how many times faster than the reference ours is."""
    ratio = reference / ours
    wanted, verdict = ("", "") if aim is None else (f">= {aim:g} x", _verdict(met=ratio >= aim))
    return Row(what, duration(ours), f"{duration(reference)} {than}", f"{ratio:.1f} x faster", wanted, verdict)


def longer(what: str, ours: float, reference: float, *, aim: float, than: str) -> Row:
    """Return the row of how many times as long as the reference ours takes."""
    ratio = ours / reference
    verdict = _verdict(met=ratio <= aim)
    return Row(what, duration(ours), f"{duration(reference)} {than}", f"{ratio:.2f} x", f"<= {aim:g} x", verdict)


def _verdict(*, met: bool) -> str:
    return "met" if met else "MISSED"

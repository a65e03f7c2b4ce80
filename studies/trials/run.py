"""`make trials`: many edits of many clips, a line each, and the figures that matter.

strict   how far a constraint that is met is moved by adding a `com` below it (mm at a leg of 0.85 m)
pop      a joint's change against the input steps by more than 10 degrees in a frame (at 60 Hz), and by more than the
         joint's own largest step in the input
jerk     root mean square third difference of all joints, edited over input
broken   neck or spine more than 60, clavicle or ankle more than 45 degrees beyond their own range in the input; a knee
         or an elbow bent back by more than 5
"""

from __future__ import annotations

import argparse
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from studies.lab import Lab
from studies.trials.bodies import SOURCES, body_of, names_of
from studies.trials.edits import EDITS, GIVING_WAY, SWITCHING
from studies.trials.trial import Trial, trial

if TYPE_CHECKING:
    from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each edit of each clip, then the summary."""
    clips = os.environ.get("MOTIONEDIT_CLIPS")
    folder = Path(clips) if clips else None
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--clips", nargs="+", choices=SOURCES, default=names_of(folder))
    parser.add_argument("--edits", nargs="+", choices=EDITS, default=list(EDITS))
    options = parser.parse_args(arguments)
    done = []
    for name in options.clips:
        body = body_of(name, folder)
        for edit in options.edits:
            with tempfile.TemporaryDirectory() as scratch:
                done.append(trial(Lab(Path(scratch)), body, edit))
            print(line(done[-1]), flush=True)
    print("", *summary(done), sep="\n")


def line(one: Trial) -> str:
    """Return a trial as a line of the table."""
    found = one.measured
    pop = f"{found.pop:.0f} degrees {found.where}" if found.pop else "-"
    strict = "" if one.strict is None else f"{one.strict:.2f} mm"
    left = " ".join(f"{name}:{error:.1f}" for name, error in one.errors.items() if error > 0.5)
    said = f"{one.status}{', warns' if one.warned else ''}"
    cells = f"{one.clip:9} {one.edit:18} {said:25} jerk {found.jerk:6.2f}  pop {pop:34} strict {strict:10}"
    return f"{cells} {','.join(found.broken):24} {left}".rstrip()


def summary(trials: Sequence[Trial]) -> list[str]:
    """Return the figures that matter, a line each."""
    strict = [one.strict for one in trials if one.strict is not None]
    quiet = [one.measured for one in trials if one.is_quiet]
    lines = [f"{len(trials)} edits"]
    if strict:
        over = sum(millimetres > 0.1 for millimetres in strict)
        lines.append(f"strict: a met constraint is moved by at most {max(strict):.2f} mm, over 0.1 mm in {over}")
    for what, edits in (("giving way", GIVING_WAY), ("switching", SWITCHING)):
        found = [one.measured for one in trials if one.edit in edits]
        if found:
            jerk, neck = ([getattr(each, key) for each in found] for key in ("jerk", "neck"))
            pops = sum(each.pop > 0.0 for each in found)
            lines.append(
                f"{what}: jerk median {np.median(jerk):.2f} x, worst {max(jerk):.2f} x; neck past its range, median "
                f"{np.median(neck):.0f} degrees; pops in {pops} of {len(found)}"
            )
    back = max((one.measured.back for one in trials), default=0.0)
    seen = sum(each.is_seen for each in quiet)
    return [*lines, f"bent back: worst {back:.0f} degrees", f"ok and not a word: {len(quiet)}; of these seen {seen}"]


if __name__ == "__main__":
    main()

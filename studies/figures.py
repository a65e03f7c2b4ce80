"""Print the accuracy figures that the documentation quotes: golf swings of data/, and real strokes where they are.

Run it with `make figures`. The real clips are read from the folder that MOTIONEDIT_CLIPS names.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from studies import figures_golf, figures_prioritized, figures_strokes
from studies.lab import Lab, print_table


def main() -> None:
    """Print every table."""
    with tempfile.TemporaryDirectory() as scratch:
        lab = Lab(Path(scratch))
        print_table("Golf: reconstruction of the club head (cm)", figures_golf.reconstruction(lab))
        print_table("Golf: edits at the hit", figures_golf.golf_edits(lab))
        print_table("Golf: smoothness, noise-free 120 Hz clips on a 25 Hz timeline", figures_golf.smoothness(lab))
        print_table(
            "Prioritized constraints: the demonstrations of [PRIO] on data/", figures_prioritized.demonstrations(lab)
        )
        print_table("Prioritized constraints: what holds of any edit", figures_prioritized.laws(lab))
        clips = os.environ.get("MOTIONEDIT_CLIPS")
        if clips is None or not Path(clips).is_dir():
            print("\nReal strokes: left out, MOTIONEDIT_CLIPS names no folder")
            return
        strokes = Path(clips) / "strokes"
        print_table(
            "Real smashes (18 joints, 100 Hz), the clip left out of the database", figures_strokes.smashes(lab, strokes)
        )
        print_table(
            "Real smashes cut at differing lengths from one take, left out", figures_strokes.cut_smashes(lab, strokes)
        )
        print_table("Real serves, the clip left out of the database", figures_strokes.serves(lab, strokes))
        print_table(
            "Real strokes brought to where another met the ball, both left out", figures_strokes.to_others(lab, strokes)
        )
        print_table("Prioritized constraints: the same on real clips", figures_prioritized.real(lab, Path(clips)))


if __name__ == "__main__":
    main()

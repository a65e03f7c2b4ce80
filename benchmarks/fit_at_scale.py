"""One fit of many made motions, as a process of its own: `fit_at_scale.py COUNT gram|streaming [COMPONENTS]`.

Prints seconds of the processor, for making the motions and for their fit, and the peak of memory, as JSON.
"""

from __future__ import annotations

import json
import sys
import time
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from motionedit.core import rotations as rot
from motionedit.core.body.ground import axis_vector
from motionedit.core.motion import Motion
from motionedit.core.pca import vectors
from motionedit.core.pca.database import DatabaseMotion, FitSettings, build_model, database_space
from motionedit.core.pca.fit import ComponentCount
from motionedit.core.pca.model import DatabaseClip
from motionedit.core.skeleton import Skeleton
from motionedit.core.timeline.warp import Timeline
from motionedit.core.units import STANDARD_LEG

if TYPE_CHECKING:
    from collections.abc import Iterator

# A motion of 132 x (3 + 30 x 3) = 12,276 values, as the paper's golf swings.
FRAMES, JOINTS = 132, 30
# Ways in which the motions differ, each of them less than the one before, and noise of every value (rad), of which
# there are only so many: it would take longer to make than to fit.
FACTORS, FALL, NOISE, NOISES = 24, 0.8, 1e-3, 61


def motions(count: int, spent: list[float]) -> Iterator[DatabaseMotion]:
    """Yield smooth motions of one skeleton that differ in 24 ways; the seconds that each took go to `spent`."""
    start = time.process_time()
    rng = np.random.default_rng(17)
    turning = ("Zrotation", "Xrotation", "Yrotation")
    skeleton = Skeleton(
        names=tuple(f"Joint{j}" for j in range(JOINTS)),
        parents=np.arange(-1, JOINTS - 1),
        offsets=rng.normal(scale=10.0, size=(JOINTS, 3)),
        channels=(("Xposition", "Yposition", "Zposition", *turning), *(turning,) * (JOINTS - 1)),
    )
    time_of_frame = np.linspace(0.0, 1.0, FRAMES)[:, None]
    waves = [np.sin(rng.uniform(1.0, 12.0, 3 * JOINTS) * time_of_frame + rng.uniform(0.0, 6.0, 3 * JOINTS))]
    waves += [np.sin(rng.uniform(1.0, 12.0, 3 * JOINTS) * time_of_frame + k) for k in range(FACTORS)]
    each = np.stack(waves[1:]).reshape(FACTORS, -1)
    sizes = 0.3 * FALL ** np.arange(FACTORS)
    noises = NOISE * rng.normal(size=(NOISES, FRAMES, JOINTS, 3))
    same = np.arange(JOINTS)
    for m in range(count):
        turns = waves[0].reshape(-1) + (rng.normal(size=FACTORS) * sizes) @ each
        turns = turns.reshape(FRAMES, JOINTS, 3) + noises[m % NOISES]
        travel = rng.normal(size=3) * time_of_frame
        motion = Motion(skeleton, rot.exp(turns), travel[:, None], 0.04)
        made = DatabaseMotion(DatabaseClip(f"clip{m}", "", ()), motion, same)
        spent.append(time.process_time() - start)
        yield made
        start = time.process_time()


def _peak() -> int:
    """Return the peak of resident bytes since this program began (Linux); getrusage counts who started it, too."""
    words = Path("/proc/self/status").read_text().split()
    return int(words[words.index("VmHWM:") + 1]) * 1024


def main() -> None:
    """Fit, and print what it took."""
    count, how = int(sys.argv[1]), sys.argv[2]
    components = int(sys.argv[3]) if len(sys.argv) > 3 else None
    spent: list[float] = []
    start = time.process_time()
    most = count if how == "gram" else 1
    vectors.MOST_IN_MEMORY = most
    made, settings = motions(count, spent), FitSettings(components=ComponentCount(components))
    first = next(made)
    space = database_space(first.motion, travel=0, leg_length=STANDARD_LEG, settings=settings)
    fitted = build_model(
        map(space.vector, chain((first,), made)),
        count,
        of=space,
        timeline=Timeline(FRAMES, 25.0),
        up=axis_vector("y"),
        settings=settings,
        rules={},
    )
    stop = time.process_time()
    told = {
        "making": sum(spent),
        "fit": stop - start - sum(spent),
        "peak": _peak(),
        "components": len(fitted.model.components.components),
        "share": float(fitted.model.components.explained_variance_ratio.sum()),
        "passes": None if fitted.streamed is None else fitted.streamed.passes,
        "residual": None if fitted.streamed is None else fitted.streamed.residual,
    }
    print(json.dumps(told))


if __name__ == "__main__":
    main()

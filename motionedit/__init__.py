"""Batch motion editing of BVH clips: motion principal coefficients [PC] and prioritized constraints [PRIO].

A clip is edited in three lines; the bytes are those that the command line writes for the same clip and spec:

>>> import motionedit
>>> raise_hand = {"name": "hand", "type": "position", "effector": "LeftHand", "priority": 1,
...               "points": [{"hold": [40, 60], "shift": [0, 15, 0]}]}
>>> edit = motionedit.edit_prioritized("data/walk.bvh", {"constraints": [raise_hand]})
>>> path = edit.write("walk-hand.bvh")

`read` reads a clip; `normalize`, `fit_pca`, `edit_pc` and `edit_prioritized` do what the commands of these names do.
Nothing is printed. What a user can cause is raised as `MotionEditError`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from motionedit.errors import MotionEditError, MotionEditErrors
from motionedit.version import __version__

if TYPE_CHECKING:
    from motionedit.library.edit_pc import edit_pc
    from motionedit.library.edit_prioritized import edit_prioritized
    from motionedit.library.edited import Edited
    from motionedit.library.fit_pca import Fitted, fit_pca
    from motionedit.library.normalize import Normalized, normalize
    from motionedit.library.read import read

__all__ = [
    "Edited",
    "Fitted",
    "MotionEditError",
    "MotionEditErrors",
    "Normalized",
    "__version__",
    "edit_pc",
    "edit_prioritized",
    "fit_pca",
    "normalize",
    "read",
]

# Where each name is found when it is first asked for: the import alone loads no numpy.
_HOMES = {
    "Edited": "edited",
    "Fitted": "fit_pca",
    "Normalized": "normalize",
    "edit_pc": "edit_pc",
    "edit_prioritized": "edit_prioritized",
    "fit_pca": "fit_pca",
    "normalize": "normalize",
    "read": "read",
}


if not TYPE_CHECKING:  # checkers see the imports above, and that there is nothing else

    def __getattr__(name: str) -> object:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = getattr(import_module(f"{__name__}.library.{_HOMES[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})

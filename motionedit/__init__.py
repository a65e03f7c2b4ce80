"""Batch motion editing of BVH clips: motion principal coefficients [PC] and prioritized constraints [PRIO].

A clip is edited in a few lines; the bytes are those that the command line writes for the same clip and spec. Here a
hand is raised by 15 cm for twenty frames, while the feet ride the way that they have:

>>> import motionedit
>>> feet = {"type": "position", "effector": ["LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase"], "priority": 10}
>>> hand = {"type": "position", "effector": "LeftHand", "priority": 4,
...         "points": [{"during": [40, 60], "shift": [0, 15, 0]}]}
>>> edit = motionedit.edit_prioritized("data/walk.bvh", {"constraints": [feet, hand]})
>>> edit.report["status"], edit.warnings
('ok', ())
>>> path = edit.write("walk-hand.bvh")

`read` reads a clip, `write` writes one; `normalize`, `fit_pca`, `edit_pc` and `edit_prioritized` do what the commands
of these names do. Nothing is printed. What a user can cause is raised as `MotionEditError`. The specs that they take:
`docs/spec.md`, and ``motionedit schema COMMAND``.
"""

from __future__ import annotations

from importlib import import_module

from motionedit.version import __version__

# Not typing's: Python loads this file before the program can answer Ctrl-C, so that it loads next to nothing.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from motionedit.core.bvh import Clip
    from motionedit.errors import (
        BvhError,
        ClipError,
        ModelError,
        MotionEditError,
        MotionEditErrors,
        SpecError,
        UsageError,
    )
    from motionedit.library.edit_pc import edit_pc
    from motionedit.library.edit_prioritized import edit_prioritized
    from motionedit.library.edited import Edited
    from motionedit.library.fit_pca import Fitted, fit_pca
    from motionedit.library.normalize import Normalized, normalize
    from motionedit.library.read import read
    from motionedit.library.write import write

__all__ = [
    "BvhError",
    "Clip",
    "ClipError",
    "Edited",
    "Fitted",
    "ModelError",
    "MotionEditError",
    "MotionEditErrors",
    "Normalized",
    "SpecError",
    "UsageError",
    "__version__",
    "edit_pc",
    "edit_prioritized",
    "fit_pca",
    "normalize",
    "read",
    "write",
]

# Where each name is found when it is first asked for: the import alone loads no numpy.
_HOMES = {
    "BvhError": "errors",
    "Clip": "core.bvh",
    "ClipError": "errors",
    "Edited": "library.edited",
    "Fitted": "library.fit_pca",
    "ModelError": "errors",
    "MotionEditError": "errors",
    "MotionEditErrors": "errors",
    "Normalized": "library.normalize",
    "SpecError": "errors",
    "UsageError": "errors",
    "edit_pc": "library.edit_pc",
    "edit_prioritized": "library.edit_prioritized",
    "fit_pca": "library.fit_pca",
    "normalize": "library.normalize",
    "read": "library.read",
    "write": "library.write",
}


if not TYPE_CHECKING:  # checkers see the imports above, and that there is nothing else

    def __getattr__(name: str) -> object:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})

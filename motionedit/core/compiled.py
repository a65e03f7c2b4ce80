"""The compiled part of the core, where it could be built: the layered solver, forward kinematics, smoothing."""

from __future__ import annotations

from functools import partial
from typing import Any

# Set to ``numpy``, it keeps the compiled part out, as where none could be built.
CHOICE = "MOTIONEDIT_SOLVER"

try:
    from motionedit.core import _compiled  # type: ignore[attr-defined]
except ImportError:
    _compiled = None


def _nothing() -> None:
    return None


# Returns the compiled module, which has no types; None where there is none, or numpy alone is wanted. A short edit asks
# a hundred times.
compiled: Any = _nothing if _compiled is None else partial(_compiled.unless_set, CHOICE, "numpy")


def room(count: int) -> bytes:
    """Return so many bytes, for a stream that alone has them and writes them: what they are is not told."""
    module = compiled()
    found: bytes = bytes(count) if module is None else module.room(count)
    return found


def solver_name() -> str:
    """Return which solver runs: ``compiled`` or ``numpy``."""
    return "numpy" if compiled() is None else "compiled"

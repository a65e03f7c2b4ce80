"""The compiled part of the core, where it could be built: the layered solver, forward kinematics, smoothing."""

from __future__ import annotations

from functools import cache
from typing import Any

# Set to ``numpy``, it keeps the compiled part out, as where none could be built.
CHOICE = "MOTIONEDIT_SOLVER"


@cache
def _module() -> Any:  # noqa: ANN401  a module without types
    try:
        from motionedit.core import _compiled  # type: ignore[attr-defined]
    except ImportError:
        return None
    return _compiled


def compiled() -> Any:  # noqa: ANN401  as above
    """Return the compiled module, or None where there is none or numpy alone is wanted."""
    module = _module()
    return None if module is None or module.is_set(CHOICE, "numpy") else module


def room(count: int) -> bytes:
    """Return so many bytes, for a stream that alone has them and writes them: what they are is not told."""
    module = compiled()
    found: bytes = bytes(count) if module is None else module.room(count)
    return found


def solver_name() -> str:
    """Return which solver runs: ``compiled`` or ``numpy``."""
    return "numpy" if compiled() is None else "compiled"

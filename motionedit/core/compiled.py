"""The compiled part of the core, where it could be built: the layered solver, forward kinematics, smoothing."""

from __future__ import annotations

import os
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


# The environment as the system has it: asked hundreds of times a clip, `os.environ.get` takes as long as what it is
# asked for.
_KEY, _NUMPY = os.environ.encodekey(CHOICE), os.environ.encodevalue("numpy")


def compiled() -> Any:  # noqa: ANN401  as above
    """Return the compiled module, or None where there is none or numpy alone is wanted."""
    return None if os.environ._data.get(_KEY) == _NUMPY else _module()  # type: ignore[attr-defined]  # noqa: SLF001


def solver_name() -> str:
    """Return which solver runs: ``compiled`` or ``numpy``."""
    return "numpy" if compiled() is None else "compiled"

"""How long the solvers of an edit take, apart from reading and writing: lines 2 to 8 of [PC]'s Algorithm 1."""

from __future__ import annotations

import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from motionedit.core.coefficients import edit as coefficient_edit

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def solver_seconds() -> Iterator[list[float]]:
    """Give a list that grows by the seconds of each solve in coefficient space inside the block."""
    seconds: list[float] = []
    solvers = {name: getattr(coefficient_edit, name) for name in ("solve_damped", "solve_goals")}

    def timed(name: str) -> None:
        def run(*arguments: Any, **settings: Any) -> object:  # noqa: ANN401  as the solver's own
            start = time.perf_counter()
            try:
                return solvers[name](*arguments, **settings)
            finally:
                seconds.append(time.perf_counter() - start)

        setattr(coefficient_edit, name, run)

    try:
        for name in solvers:
            timed(name)
        yield seconds
    finally:
        for name, solver in solvers.items():
            setattr(coefficient_edit, name, solver)
